//! The result of an importer: a model, and warnings about the file.

use jbt_model::diagnostic::{Diagnostic, Diagnostics, SourceText};
use jbt_model::model::Model;

/// A model from a file of another system.
#[derive(Clone, PartialEq, Debug)]
pub struct Imported {
    /// The model.
    pub model: Model,
    /// Oddities of the file that were read in the most plausible way.
    pub warnings: Diagnostics,
}

impl Imported {
    /// The result of reading these bytes.
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
