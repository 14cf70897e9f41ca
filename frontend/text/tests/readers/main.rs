//! Readers of files of other systems: every sample against independently computed tables, own example files,
//! and what strangers send.
//!
//! The samples are those of the folders `rib`, `pov` and `threejs`, see `jbt_testkit::samples`.

mod common;
mod mutation;
mod pov;
mod rib;
mod threejs;
