//! The three operations on sets.

use super::member::SideGrowth;
use crate::field::FieldValue;
use crate::member::ParameterType;

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

    /// The words of the text format, in the order of [`ALL`](Self::ALL).
    pub const WORDS: &'static [&'static str] = &["union", "intersection", "difference"];

    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        Self::WORDS[self as usize]
    }

    /// How fields of the operation follow their sides.
    pub(super) const fn growth(self) -> [SideGrowth; 2] {
        match self {
            Self::Union | Self::Intersection => [SideGrowth::Rises; 2],
            Self::Difference => [SideGrowth::Rises, SideGrowth::Falls],
        }
    }

    /// It as the value of a parameter: its place among the [words](Self::WORDS).
    pub(crate) fn to_field(self) -> FieldValue {
        FieldValue::Real(f64::from(self as u8))
    }
}

impl ParameterType for SetOperation {
    fn read(value: &FieldValue) -> Self {
        Self::ALL[(value.real() as usize).min(2)]
    }

    fn write(&self) -> FieldValue {
        self.to_field()
    }
}
