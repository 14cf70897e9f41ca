//! Meshes and contours that follow edits.

mod contour;
mod mesh;
mod scene;
