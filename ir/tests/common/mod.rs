//! What the tests of this crate share.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod random;
pub mod sample;
