//! The result of an importer: a model, and warnings about the file.

use jbt_model::diagnostic::{Diagnostic, Diagnostics, SourceText};
use jbt_model::model::Model;

/// What a reader finds: a model with oddities of its file, or all errors of it.
pub(crate) type ReadModel = Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>>;

/// A model from a file of another system.
#[derive(Clone, PartialEq, Debug)]
pub struct Imported {
    /// The model.
    pub model: Model,
    /// Oddities of the file that were read in the most plausible way.
    pub warnings: Diagnostics,
}

impl Imported {
    /// The result of reading particles. Their nodes have no places in the file, so a model without warnings
    /// keeps none of it.
    pub(super) fn of_particles(bytes: &[u8], read: ReadModel) -> Result<Self, Diagnostics> {
        let source = || Some(SourceText::new(SourceText::UNNAMED, bytes));
        match read {
            Ok((model, warnings)) => {
                let source = if warnings.is_empty() { None } else { source() };
                Ok(Self { model, warnings: Diagnostics::new(warnings, source) })
            }
            Err(list) => Err(Diagnostics::new(list, source())),
        }
    }

    /// The result of reading these bytes.
    pub(super) fn from(bytes: &[u8], read: ReadModel) -> Result<Self, Diagnostics> {
        Self::of(SourceText::new(SourceText::UNNAMED, bytes), read)
    }

    /// The result of reading this text.
    pub(super) fn of(source: SourceText, read: ReadModel) -> Result<Self, Diagnostics> {
        let source = Some(source);
        match read {
            Ok((model, warnings)) => {
                let warnings = Diagnostics::new(warnings, source.clone());
                Ok(Self { model: Model { source, ..model }, warnings })
            }
            Err(list) => Err(Diagnostics::new(list, source)),
        }
    }
}
