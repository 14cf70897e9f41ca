//! What an importer gives back: a model, and what was odd about the file.

use jbt_model::diagnostic::{Diagnostic, Diagnostics, SourceText};
use jbt_model::model::Model;

/// A model from a file of another system.
#[derive(Clone, PartialEq, Debug)]
pub struct Imported {
    /// The model.
    pub model: Model,
    /// What in the file is odd, and was read as best it could be.
    pub warnings: Diagnostics,
}

impl Imported {
    /// What was read from these bytes.
    pub(super) fn from(
        bytes: &[u8],
        read: Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>>,
    ) -> Result<Self, Diagnostics> {
        let source = Some(SourceText::new(SourceText::UNNAMED, bytes));
        match read {
            Ok((model, warnings)) => {
                let warnings = Diagnostics::new(warnings, source.clone());
                Ok(Self { model: Model { source, ..model }, warnings })
            }
            Err(list) => Err(Diagnostics::new(list, source)),
        }
    }
}
