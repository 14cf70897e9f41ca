//! Faults of the machine around the binary: kills, full disks, closed pipes, little memory, few threads,
//! small stacks, no terminal, closed folders, memory that never becomes executable.
//!
//! `JBT_FAULTS=1` runs them, as `.ci/run` does: they take some minutes. What a machine does not have (another
//! user, a file system of its own) is skipped and said.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod disk;
mod kills;
mod limits;
mod machine;
mod pipes;
mod signals;
mod threads;
mod work;
