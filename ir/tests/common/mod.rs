//! What the tests of this crate share.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod golden;
pub mod random;
pub mod sample;
pub mod spicy;
