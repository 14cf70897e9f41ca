//! Who asks for what, in a scene with selectors.

use super::{OccurrenceKind, Scene, children};
use crate::demand::{Asked, Demand};

/// What is asked for in a scene with selectors.
pub(super) fn demand(scene: &Scene<'_>) -> Demand {
    let mut demand = Demand {
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
                for &child in children(kind).iter() {
                    demand.occurrences[child.0 as usize].also(asked);
                }
            }
        }
    }
    demand
}
