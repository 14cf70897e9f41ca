//! The value of a member's parameter, before its formulas are evaluated.

use crate::field::{FieldOf, FieldValue};
use crate::number::Number;

/// The value of a member's parameter, before its formulas are evaluated.
pub type FieldNumber = FieldOf<Number>;

impl FieldNumber {
    /// The present value.
    #[must_use]
    pub fn value(&self) -> FieldValue {
        self.map(Number::value)
    }

    pub(super) fn numbers_mut(&mut self) -> &mut [Number] {
        match self {
            Self::Real(number) => std::slice::from_mut(number),
            Self::Vector(numbers) => numbers,
            Self::Reals(numbers) => numbers,
            Self::Vectors(vectors) => vectors.as_flattened_mut(),
        }
    }
}

/// Plain values, as they are written.
pub fn as_written(values: Vec<FieldValue>) -> Vec<FieldNumber> {
    values.into_iter().map(FieldNumber::from).collect()
}

impl From<FieldValue> for FieldNumber {
    fn from(value: FieldValue) -> Self {
        value.map(|&number| Number::from(number))
    }
}
