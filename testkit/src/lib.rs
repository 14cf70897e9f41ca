//! What tests of several packages share. Only tests and benches depend on this package.
//!
//! It is a package and no file included by path: its code is compiled once instead of once for each test
//! program. The packages that it depends on have it as a dev-dependency. Cargo allows that circle, and
//! integration tests see one and the same library on both ways.

pub mod points;
pub mod random;
pub mod samples;
pub mod scene;
pub mod skip;
