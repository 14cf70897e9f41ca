//! The compiler's own crates, for programs that look inside: that print code, count its instructions or
//! compare engines. No version promises anything about what is here; everything else of this crate is the
//! front, and does without it.

pub use jbt_ir as ir;
#[cfg(feature = "jit")]
pub use jbt_jit as jit;
pub use jbt_lower as lower;
pub use jbt_model as model;

/// From a lowered function to what an engine runs.
pub mod kernel {
    pub use crate::kernel::{Purpose, form, forms, optimise, optimise_straight, passes, straighten};
}
