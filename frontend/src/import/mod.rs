//! Importers: scene files of other systems become models.
//!
//! An importer reads bytes, never files, and reports every error with its place in those bytes. What the format of this project
//! cannot say is an error that names it, never a silent approximation.

mod parsip;
mod vm;

use crate::diagnostic::Diagnostic;
use crate::model::Model;

pub use parsip::parsip;
pub use vm::vm;

/// A model from a file of another system.
#[derive(Clone, PartialEq, Debug)]
pub struct Imported {
    /// The model.
    pub model: Model,
    /// What in the file is odd, and was read as best it could be.
    pub warnings: Vec<Diagnostic>,
}
