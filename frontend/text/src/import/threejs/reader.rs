//! Values of a file, with the errors about them.

use glam::DVec3;
use jbt_model::diagnostic::Diagnostic;

use super::json::{Json, JsonKind, JsonValue};
use crate::import::tally::LeftOut;

/// What materials have beside a colour: the members of a file and the attributes. An attribute is there if
/// any material has a number other than 0.
pub(super) const SURFACE: [(&str, &str); 2] = [("roughness", "rough"), ("metalness", "metal")];

/// Which attributes of [`SURFACE`] there are.
pub(super) type Surface = [bool; SURFACE.len()];

/// A file that is being read.
pub(super) struct TreeReader<'a> {
    pub(super) json: Json<'a>,
    pub(super) left_out: LeftOut,
    /// Whether a field may be negative somewhere.
    pub(super) negative: bool,
    /// What materials have beside colours.
    pub(super) surface: Surface,
}

impl TreeReader<'_> {
    pub(super) fn error(&self, value: JsonValue, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(Some(self.json.span(value)), message)
    }

    /// A member that has to be there.
    pub(super) fn needed(&self, object: JsonValue, name: &str) -> Result<JsonValue, Diagnostic> {
        if self.json.kind(object) != JsonKind::Object {
            let error = self.error(object, "this is no object");
            return Err(error.expected(format!("expected an object with \"{name}\"")));
        }
        let found = self.json.member(object, name);
        found.ok_or_else(|| self.error(object, format!("the object has no \"{name}\"")))
    }

    /// A finite number.
    pub(super) fn number(&self, value: JsonValue) -> Result<f64, Diagnostic> {
        let found = self.json.number(value).filter(|number| number.is_finite());
        found.ok_or_else(|| self.error(value, "this is no finite number"))
    }

    /// A number that has to be there.
    pub(super) fn needed_number(&self, object: JsonValue, name: &str) -> Result<f64, Diagnostic> {
        self.number(self.needed(object, name)?)
    }

    /// A number, if it is there.
    pub(super) fn number_or(&self, object: JsonValue, name: &str, default: f64) -> Result<f64, Diagnostic> {
        self.json.member(object, name).map_or(Ok(default), |value| self.number(value))
    }

    /// A number above 0 that has to be there.
    pub(super) fn positive(&self, object: JsonValue, name: &str) -> Result<f64, Diagnostic> {
        let value = self.needed(object, name)?;
        let number = self.number(value)?;
        if number > 0.0 {
            return Ok(number);
        }
        Err(self.error(value, format!("the {name} is {number}")).expected("expected a number above 0"))
    }

    /// A text that has to be there.
    pub(super) fn needed_text(&self, object: JsonValue, name: &str) -> Result<(&str, JsonValue), Diagnostic> {
        let value = self.needed(object, name)?;
        if self.json.kind(value) == JsonKind::Text {
            return Ok((self.json.text(value), value));
        }
        Err(self.error(value, format!("the {name} is no text")))
    }

    /// A point `{"x", "y", "z"}` that has to be there.
    pub(super) fn point(&self, object: JsonValue, name: &str) -> Result<DVec3, Diagnostic> {
        let value = self.needed(object, name)?;
        let [x, y, z] = ["x", "y", "z"].map(|axis| self.needed_number(value, axis));
        Ok(DVec3::new(x?, y?, z?))
    }
}
