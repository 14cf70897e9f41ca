//! Particles and atoms of other systems: points that become one node, [`particles`](jbt_model::particles).
//!
//! ```text
//! .xyz .pdb .cif             ──► atoms: an element each, so a radius and a colour   (atoms, elements) ─┐
//! .csv .npy .ply .vtk .vtu   ──► bare points, with a radius of their own or from an option    (cloud) ─┴─► a Model
//! ```
//!
//! The model is the sum of the points. Each alone has its surface at its radius r, in one of two
//! [forms](ParticleForm).

mod anisotropic;
mod atoms;
mod bytes;
pub(super) mod cif;
mod cloud;
pub(super) mod csv;
mod elements;
pub(super) mod npy;
mod options;
pub(super) mod pdb;
pub(super) mod ply;
mod scan;
pub(super) mod vtk;
pub(super) mod vtu;
mod xml;
pub(super) mod xyz;

pub use elements::{ELEMENTS, ElementFacts, element};
pub(crate) use options::ParticleUse;
pub use options::{ParticleForm, ParticleOptions};

/// The most bytes of a file of particles: those that spans can name.
pub(super) const MAX_PARTICLE_BYTES: usize = u32::MAX as usize;
