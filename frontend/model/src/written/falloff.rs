//! The written of a falloff.

use super::field::{FieldNumber, as_written};
use crate::falloff::{Falloff, FalloffKind};
use crate::field::FieldValue;
use crate::number::Number;

/// A falloff before its formulas are evaluated.
#[derive(Clone, PartialEq, Debug)]
pub struct WrittenFalloff {
    /// The kind, with variant 0.
    kind: FalloffKind,
    /// Its parameters, in the order of [`FalloffKind::fields`].
    fields: Vec<FieldNumber>,
}

impl WrittenFalloff {
    /// The falloff of this kind, whatever its variant, with these parameters, in the order of
    /// [`FalloffKind::fields`].
    #[must_use]
    pub fn new(kind: FalloffKind, fields: Vec<FieldNumber>) -> Self {
        Self { kind: kind.base(), fields }
    }

    /// The kind, with variant 0.
    #[must_use]
    pub fn kind(&self) -> FalloffKind {
        self.kind
    }

    /// The parameters.
    #[must_use]
    pub fn fields(&self) -> &[FieldNumber] {
        &self.fields
    }

    pub(super) fn fields_mut(&mut self) -> &mut [FieldNumber] {
        &mut self.fields
    }

    /// The falloff, with the present values of its numbers.
    #[must_use]
    pub fn falloff(&self) -> Falloff {
        let values: Vec<FieldValue> = self.fields.iter().map(FieldNumber::value).collect();
        self.kind.from_fields(&values)
    }

    /// Whether one of its numbers depends on a parameter.
    #[must_use]
    pub fn depends_on_parameters(&self) -> bool {
        self.fields.iter().flat_map(FieldNumber::numbers).any(Number::depends_on_parameters)
    }
}

impl<T: Into<Falloff>> From<T> for WrittenFalloff {
    fn from(falloff: T) -> Self {
        let falloff = falloff.into();
        Self::new(falloff.kind(), as_written(falloff.to_fields()))
    }
}
