//! Importers: scene files of other systems become models.
//!
//! An importer reads bytes, never files, and reports every error with its place in those bytes. A feature
//! that this project lacks is an error that names it, never a silent approximation.

mod brlcad;
mod format;
mod imported;
mod jbt;
mod parsip;
pub mod particles;
mod pov;
mod rib;
mod srgb;
mod tally;
mod threejs;
mod vm;

pub use brlcad::brlcad;
pub use format::SceneFormat;
pub use imported::Imported;
pub use parsip::parsip;
pub use pov::pov;
pub use rib::rib;
pub use threejs::threejs;
pub use vm::vm;

use particles::{cif, csv, npy, pdb, ply, vtk, vtu, xyz};
