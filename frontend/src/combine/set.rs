//! The three operations on sets.

/// What is made of sets.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SetOperation {
    /// What is in any.
    Union,
    /// What is in all.
    Intersection,
    /// What is in the first and in none of the others.
    Difference,
}

impl SetOperation {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Union, Self::Intersection, Self::Difference];

    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
        }
    }
}
