//! Particles have the bits of the sum of points that they mean: the same program with the same rows, and so
//! the same answers, ranges, regions and meshes, by every engine.

mod alike;
#[path = "../common/mod.rs"]
mod common;
mod edits;
mod scenes;
mod text;
