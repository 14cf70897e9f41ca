//! Falloffs and textures: members that stand by themselves.

use jbt::tree::{FalloffKind, Field, TextureKind};
use jbt_model::written::{FieldNumber, WrittenFalloff};
use pyo3::prelude::*;

use crate::error::refused;
use crate::fields::field_value;

/// A falloff: its kind and its numbers.
#[pyclass(frozen, module = "jbt", name = "Falloff")]
#[derive(Clone)]
pub(crate) struct PyFalloff(pub(crate) WrittenFalloff);

/// A texture: its kind and its numbers.
#[pyclass(frozen, module = "jbt", name = "Pattern")]
#[derive(Clone)]
pub(crate) struct PyPattern {
    pub(crate) texture: TextureKind,
    pub(crate) fields: Vec<FieldNumber>,
}

/// The member of a list with the name of a constructor.
macro_rules! named {
    ($kind:ident, $name:expr) => {{
        let name: &str = $name;
        let found = $kind::ALL.iter().copied().find(|kind| kind.constructor() == name);
        found.ok_or_else(|| refused(format!("there is no {} {name:?}", stringify!($kind))))
    }};
}

pub(crate) use named;

/// Values for all parameters of a member.
pub(crate) fn values(fields: &[Field], given: &[Bound<'_, PyAny>]) -> PyResult<Vec<FieldNumber>> {
    if fields.len() != given.len() {
        return Err(refused(format!("expected {} parameters, got {}", fields.len(), given.len())));
    }
    fields.iter().zip(given).map(|(field, given)| field_value(field, given)).collect()
}

#[pymethods]
impl PyFalloff {
    #[new]
    fn new(name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let kind = named!(FalloffKind, name)?;
        Ok(Self(WrittenFalloff::new(kind, values(kind.fields(), &given)?)))
    }

    /// The falloff that a word of the text format names.
    #[staticmethod]
    fn named(word: &str) -> PyResult<Self> {
        let known = || {
            let words: Vec<&str> = FalloffKind::ALL.iter().map(|kind| kind.name()).collect();
            refused(format!("falloff: expected one of {}, got {word:?}", words.join(", ")))
        };
        let kind = FalloffKind::named(word).ok_or_else(known)?;
        let defaults = kind.fields().iter().map(|field| field.default.clone().map(FieldNumber::from));
        let defaults: Option<Vec<FieldNumber>> = defaults.collect();
        let needed =
            || refused(format!("falloff: {word:?} needs numbers; call jbt.{}(..)", kind.constructor()));
        Ok(Self(WrittenFalloff::new(kind, defaults.ok_or_else(needed)?)))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().0 == self.0)
    }

    fn __repr__(&self) -> String {
        format!("<jbt.Falloff {}>", self.0.kind().text(self.0.fields()))
    }
}

#[pymethods]
impl PyPattern {
    #[new]
    fn new(name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let texture = named!(TextureKind, name)?;
        Ok(Self { texture, fields: values(texture.fields(), &given)? })
    }

    fn __repr__(&self) -> String {
        format!("<jbt.Pattern {}>", self.texture.name())
    }
}
