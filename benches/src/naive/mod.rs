//! Naive baselines: trees that are walked at each point.
//!
//! [`Walker`] is such a system as one would write it today, [`separate()`] one that walks again for each
//! answer. Both are scalar f32 code without culling, in the same language and built by the same compiler as
//! everything else here.

mod compact;
mod mixing;
mod separate;
mod skeleton;
mod walk;

pub use separate::{STEP, WALKS, differences, separate};
pub use walk::Walker;

#[cfg(test)]
mod tests;
