//! What tests of several packages share. Only tests and benches depend on this package.
//!
//! It is a package and no file included by path: its code is compiled once instead of once for each test
//! program. The packages that it depends on have it as a dev-dependency. Cargo allows that circle, and
//! integration tests see one and the same library on both ways. What knows models is a feature, `models`:
//! without it tests of `ir` and `jit` need not wait for the packages of the frontend. What knows programs is
//! the feature `ir`; without both the kit depends on no other package of the project.

pub mod bits;
pub mod boxes;
#[cfg(feature = "models")]
pub mod gaps;
pub mod golden;
#[cfg(feature = "ir")]
pub mod ops;
pub mod points;
#[cfg(feature = "models")]
pub mod random;
pub mod samples;
#[cfg(feature = "models")]
pub mod scene;
pub mod skip;
pub mod surface;
pub mod vector;
