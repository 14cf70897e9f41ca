//! What strangers may send, and what has to hold then: a function from bytes for each target.
//!
//! ```text
//!                          ┌─ fuzz_targets/*.rs   libFuzzer, on nightly Rust
//! targets() ── name, run ──┼─ tests/replay.rs     every input that ever failed, and seeds, in `cargo test`
//!                          └─ src/bin/seeds.rs    the folders of seeds and words for libFuzzer
//! ```
//!
//! A target panics if something does not hold. Errors are answers; panics, hangs and differing bits are not.
//! There is one target for each format of scenes, by the list of formats.

mod commit;
mod engines;
mod function;
mod mesh;
mod model;
mod print;
mod prune;
mod read;
mod table;

pub use commit::commit;
pub use read::{format_word, read};
pub use table::{FuzzTarget, target, targets};

/// CSV points: the reader of the binary, which has no library.
#[path = "../../../cli/src/points.rs"]
#[allow(dead_code, unreachable_pub, missing_debug_implementations, reason = "it is a file of the binary")]
mod points;
