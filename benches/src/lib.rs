//! How fast, compared with what: models, the checks that answers have to pass before anything is timed, and
//! what we compare with.

#![allow(missing_debug_implementations, reason = "nobody but the benches here sees these types")]

pub mod check;
#[cfg(feature = "peers")]
pub mod compare;
pub mod files;
pub mod limit;
pub mod memory;
pub mod model;
pub mod naive;
#[cfg(feature = "peers")]
pub mod peers;
