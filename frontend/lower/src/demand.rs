//! What selectors leave out: which instances are asked for now, and which whatever is chosen.
//!
//! A selector asks one of its children, and its code has all of them, each in a fold over one row that is
//! active or not. What several places share is computed in front of them, where its space begins, so that
//! needs a row of its own: unless the space is never entered without asking for it, whatever is chosen.
//!
//! ```text
//! sum { use a  select 0 { use a  use b  sum { use b  use c } } }
//!
//! a   asked for by the sum, always            computed in front
//! b   asked for by the selector's children    computed in front, in a fold over one row; not now, so its row is not active
//! ```

use super::names::{FieldId, Hoist, InstanceId, SpaceId};

/// Who asks for something.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Asked {
    /// Whenever its space is entered.
    pub(super) always: bool,
    /// For the present choices.
    pub(super) now: bool,
}

impl Asked {
    pub(super) fn also(&mut self, other: Self) {
        self.always |= other.always;
        self.now |= other.now;
    }
}

/// What is asked for. Without selectors it is everything, and nothing is kept.
pub(super) struct Demand {
    pub(super) instances: Vec<Asked>,
    pub(super) fields: Vec<Asked>,
    pub(super) spaces: Vec<Asked>,
    /// Of each instance, whether its answer can be the model's as it is.
    pub(super) bare: Vec<bool>,
    pub(super) selects: bool,
}

impl Demand {
    /// Everything is asked for.
    pub(super) const ALL: Self = Self {
        instances: Vec::new(),
        fields: Vec::new(),
        spaces: Vec::new(),
        bare: Vec::new(),
        selects: false,
    };

    fn asked(&self, hoist: Hoist) -> Asked {
        if !self.selects {
            return Asked { always: true, now: true };
        }
        match hoist {
            Hoist::Field(FieldId(id)) => self.fields[id as usize],
            Hoist::Space(SpaceId(id)) => self.spaces[id as usize],
            Hoist::Instance(InstanceId(id)) => self.instances[id as usize],
            // It has no row of its own.
            Hoist::Computed(_) => Asked { always: true, now: true },
        }
    }

    /// Whether what is hoisted needs a row of its own, because some choices do without it.
    pub(super) fn is_guarded(&self, hoist: Hoist) -> bool {
        !self.asked(hoist).always
    }

    /// Whether an answer can be the model's as it is, with nothing but warps and selectors between: then its
    /// attributes are seen even where its field is zero. Without selectors nobody asks.
    pub(super) fn is_bare(&self, InstanceId(id): InstanceId) -> bool {
        self.selects && self.bare[id as usize]
    }

    /// Whether anybody asks for it now.
    pub(super) fn is_asked(&self, hoist: Hoist) -> bool {
        self.asked(hoist).now
    }
}
