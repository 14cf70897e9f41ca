//! A mesh that is kept brick by brick, and of which bricks are made again where the field has changed.
//!
//! ```text
//! renewal:  division of the touched boxes ► field at their points ► crossed cells     as for any mesh, of fewer bricks
//!           faces are flipped anew along chains of pinched faces that touch them       (flips)
//!           vertices of these bricks, and of others with another flip
//! commit:   vertices go to the slots of their bricks                                   (commit, slots)
//!           vertices on edges go back where triangles are folded, around such bricks   (join)
//!           triangles of bricks with other vertices, and of those just above them      (join)
//!           doubtful normals of bricks with other triangles, and of those just below   (join)
//! ```
//!
//! How far the field at a point reaches:
//!
//! | part of the mesh | what it depends on |
//! |---|---|
//! | crossed cells | the field in the closed box of their brick |
//! | flips of faces | the crossed cells, along a chain of faces that are pinched in both of their cells |
//! | vertices, attributes | the field in the closed box of their brick, and flips of their own cell |
//! | where vertices on edges go back to | vertices of their brick and of the 26 bricks around |
//! | triangles | vertices of their brick and of the seven bricks below |
//! | normals that triangles decide | triangles of their brick and of the seven bricks above |
//!
//! Everything that may fail is in the renewal, which changes nothing; the commit cannot fail.

mod bricks;
mod commit;
mod compact;
mod flips;
mod join;
mod renewal;
mod slots;

pub(crate) use bricks::{BrickMesh, BrickPlace};
pub(crate) use commit::BrickChanges;
