//! What selectors leave out: which occurrences are asked for now, and which whatever is chosen.
//!
//! A selector asks one of its children, and its code has all of them, each in a fold over one row that is active or not. What several
//! places share is computed in front of them, where its space begins, so that needs a row of its own: unless the space is never
//! entered without asking for it, whatever is chosen.
//!
//! ```text
//! sum { use a  select 0 { use a  use b  sum { use b  use c } } }
//!
//! a   asked for by the sum, always            computed in front
//! b   asked for by the selector's children    computed in front, in a fold over one row; not now, so its row is not active
//! ```

use super::occurrence::{FieldId, OccurrenceId, OccurrenceKind, Scene, SpaceId, children};
use super::shape::Lift;

/// Who asks for something.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct Asked {
    /// Whenever its space is entered.
    always: bool,
    /// For the present choices.
    now: bool,
}

impl Asked {
    fn also(&mut self, other: Self) {
        self.always |= other.always;
        self.now |= other.now;
    }
}

/// What is asked for. Without selectors it is everything, and nothing is kept.
pub(super) struct Demand {
    occurrences: Vec<Asked>,
    fields: Vec<Asked>,
    spaces: Vec<Asked>,
    /// Of each occurrence, whether its answer can be the model's as it is.
    bare: Vec<bool>,
    selects: bool,
}

impl Demand {
    /// Everything is asked for.
    pub(super) const ALL: Self = Self {
        occurrences: Vec::new(),
        fields: Vec::new(),
        spaces: Vec::new(),
        bare: Vec::new(),
        selects: false,
    };

    /// What is asked for in a scene with selectors.
    pub(super) fn new(scene: &Scene<'_>) -> Self {
        let mut demand = Self {
            occurrences: vec![Asked::default(); scene.occurrences.len()],
            fields: vec![Asked::default(); scene.fields.len()],
            spaces: vec![Asked::default(); scene.insides.len() + 1],
            bare: vec![false; scene.occurrences.len()],
            selects: true,
        };
        demand.bare[scene.root.0 as usize] = true;
        demand.occurrences[scene.root.0 as usize] = Asked { always: true, now: true };
        // Parents come after their children.
        for index in (0..scene.occurrences.len()).rev() {
            let asked = demand.occurrences[index];
            let bare = demand.bare[index];
            let kind = &scene.occurrences[index].kind;
            match kind {
                OccurrenceKind::Leaf { field, .. } => demand.fields[field.0 as usize].also(asked),
                OccurrenceKind::Warp { inside, child, weight, .. } => {
                    if let Some(weight) = weight {
                        demand.occurrences[weight.0 as usize].also(asked);
                    }
                    demand.spaces[inside.0 as usize].also(asked);
                    demand.bare[child.0 as usize] |= bare;
                    let always = asked.always || !scene.is_shared(*inside);
                    demand.occurrences[child.0 as usize].also(Asked { always, ..asked });
                }
                OccurrenceKind::Select { children, chosen } => {
                    for child in children {
                        demand.bare[child.0 as usize] |= bare;
                    }
                    demand.occurrences[children[*chosen].0 as usize].also(Asked { always: false, ..asked });
                }
                OccurrenceKind::Reduce { .. }
                | OccurrenceKind::Difference { .. }
                | OccurrenceKind::Expression { .. }
                | OccurrenceKind::Map { .. } => {
                    for child in children(kind) {
                        demand.occurrences[child.0 as usize].also(asked);
                    }
                }
            }
        }
        demand
    }

    fn asked(&self, lift: Lift) -> Asked {
        if !self.selects {
            return Asked { always: true, now: true };
        }
        match lift {
            Lift::Field(FieldId(id)) => self.fields[id as usize],
            Lift::Space(SpaceId(id)) => self.spaces[id as usize],
            Lift::Occurrence(OccurrenceId(id)) => self.occurrences[id as usize],
            // It has no row of its own.
            Lift::Computed(_) => Asked { always: true, now: true },
        }
    }

    /// Whether what is lifted needs a row of its own, because some choices do without it.
    pub(super) fn is_guarded(&self, lift: Lift) -> bool {
        !self.asked(lift).always
    }

    /// Whether an answer can be the model's as it is, with nothing but warps and selectors between: then its attributes are seen even where
    /// its field is zero. Without selectors nobody asks.
    pub(super) fn is_bare(&self, OccurrenceId(id): OccurrenceId) -> bool {
        self.selects && self.bare[id as usize]
    }

    /// Whether anybody asks for it now.
    pub(super) fn is_asked(&self, lift: Lift) -> bool {
        self.asked(lift).now
    }
}
