//! Where an instruction comes from: which leaf of the model, and which part of its work.
//!
//! A function knows nothing of trees. It knows *slots*: a slot is a leaf of the shape that it was lowered
//! from, and the tables say which tree node stands in a slot for a given row (see [`crate::table::Tables`]).
//! The counters multiply the two to say how often each leaf of a model was evaluated.

use std::fmt;

use crate::entity::OneAndIndex;

/// The part of a leaf's or an operator's work that an instruction does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub enum Part {
    /// Anything that belongs to no leaf: combination, warps, attributes.
    Shared,
    /// Bringing the point into the leaf's space, and the insides of its distance.
    Position,
    /// The instruction that yields the squared distance to the skeleton: one per evaluation of a primitive.
    Distance,
    /// The falloff of the distance.
    Falloff,
    /// Work whose decisions may bend the surface sharply: that of set operations, of mirrors, of formulas.
    Crease,
    /// A derivative of any of these, added by the gradient pass.
    Gradient,
}

impl Part {
    /// All parts.
    pub const ALL: [Self; 6] =
        [Self::Shared, Self::Position, Self::Distance, Self::Falloff, Self::Crease, Self::Gradient];

    /// The name in the text form.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shared => "shared",
            Self::Position => "position",
            Self::Distance => "distance",
            Self::Falloff => "falloff",
            Self::Crease => "crease",
            Self::Gradient => "gradient",
        }
    }
}

/// The origin of an instruction.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct Origin {
    slot: Option<OneAndIndex>,
    /// What the instruction does for its slot.
    pub part: Part,
}

impl Origin {
    /// Work that belongs to no single leaf.
    pub const SHARED: Self = Self { slot: None, part: Part::Shared };

    /// Work of several leaves that may bend the surface sharply.
    pub const CREASE: Self = Self { slot: None, part: Part::Crease };

    /// The largest number of a leaf slot.
    pub const MAX_SLOT: u32 = u32::MAX - 1;

    /// Work for a leaf slot, or for no single one.
    ///
    /// # Panics
    /// If the slot is beyond [`MAX_SLOT`](Self::MAX_SLOT).
    #[must_use]
    pub fn new(slot: Option<u32>, part: Part) -> Self {
        Self { slot: slot.map(|slot| OneAndIndex::of(slot as usize)), part }
    }

    /// Work for one leaf slot.
    ///
    /// # Panics
    /// As [`new`](Self::new).
    #[must_use]
    pub fn leaf(slot: u32, part: Part) -> Self {
        Self::new(Some(slot), part)
    }

    /// The leaf slot, counted over the whole function; `None` for work that belongs to no single leaf.
    #[must_use]
    pub fn slot(self) -> Option<u32> {
        self.slot.map(|slot| slot.index() as u32)
    }

    /// The origin of a derivative of this.
    #[must_use]
    pub const fn gradient(self) -> Self {
        Self { slot: self.slot, part: Part::Gradient }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.slot() {
            Some(slot) => write!(f, "@{slot}.{}", self.part.name()),
            None => write!(f, "@{}", self.part.name()),
        }
    }
}
