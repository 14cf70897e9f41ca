//! Meshes and contours that follow the edits of their model.
//!
//! ```text
//! set, replace ──► edited model ──► Edit: the boxes in which it differs     (prune/edit.rs)
//!                                     └─► bricks that meet these boxes, made anew   (mesh/local)
//!                                           └─► LiveChange: which bricks, which ranges of the buffers
//! ```
//!
//! A live contour is the same in a plane, with the squares of its division in place of bricks
//! (contour/kept).
//!
//! The lattice is that of the first model. Where a later model reaches further, the lattice grows by whole
//! bricks; its corners keep their coordinates.

mod change;
mod contour;
mod mesh;
mod model;

pub use change::{BrickRanges, BrickUpdate, LiveChange};
pub use contour::{ContourChange, LiveContour, LiveSection};
pub use mesh::LiveMesh;
pub use model::ModelState;
