//! Importers: scene files of other systems become models.
//!
//! An importer reads bytes, never files, and reports every error with its place in those bytes. A feature
//! that this project lacks is an error that names it, never a silent approximation.

mod format;
mod imported;
mod jbt;
mod parsip;
mod pov;
mod rib;
mod srgb;
mod tally;
mod threejs;
mod vm;

pub use format::SceneFormat;
pub use imported::Imported;
pub use parsip::parsip;
pub use pov::pov;
pub use rib::rib;
pub use threejs::threejs;
pub use vm::vm;
