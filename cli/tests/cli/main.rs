//! Tests that run the binary `jbt` on files of temporary folders.

mod commands;
mod folder;
mod hostile;
