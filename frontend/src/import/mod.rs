//! Importers: scene files of other systems become models.
//!
//! An importer reads bytes, never files, and reports every error with its place in those bytes. What the format of this project
//! cannot say is an error that names it, never a silent approximation.

mod parsip;
mod vm;

use crate::diagnostic::{Diagnostic, Diagnostics, SourceText};
use crate::model::Model;

pub use parsip::parsip;
pub use vm::vm;

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
    fn from(
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
