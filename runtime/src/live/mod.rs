//! A mesh that follows the edits of its model.
//!
//! ```text
//! set, replace ──► edited model ──► Edit: the boxes in which it differs     (prune/edit.rs)
//!                                     └─► bricks that meet these boxes, made anew   (mesh/local)
//!                                           └─► LiveChange: which bricks, which ranges of the buffers
//! ```
//!
//! The lattice is that of the first model. Where a later model reaches further, the lattice grows by whole
//! bricks; its corners keep their coordinates.

mod change;
mod mesh;

pub use change::{BrickRanges, BrickUpdate, LiveChange};
pub use mesh::{LiveMesh, ModelState};
