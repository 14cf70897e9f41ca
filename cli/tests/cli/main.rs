//! Tests that run the binary `jbt` on files of temporary folders.

mod check;
mod commands;
mod contour;
mod far;
mod files;
mod folder;
mod hostile;
mod manual;
mod names;
mod outputs;
mod readers;
mod render;
mod signals;
mod timeline;
