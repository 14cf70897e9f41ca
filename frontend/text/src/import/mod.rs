//! Importers: scene files of other systems become models.
//!
//! An importer reads bytes, never files, and reports every error with its place in those bytes. A feature
//! that this project lacks is an error that names it, never a silent approximation.

mod format;
mod imported;
mod jbt;
mod parsip;
mod vm;

pub use format::SceneFormat;
pub use imported::Imported;
pub use parsip::parsip;
pub use vm::vm;
