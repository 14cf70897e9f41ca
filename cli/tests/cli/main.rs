//! Tests that run the binary `jbt` on files of temporary folders.

mod commands;
mod contour;
mod folder;
mod hostile;
mod outputs;
mod render;
