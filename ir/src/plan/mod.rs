//! Plans of generators of machine code, made from the IR alone: where a long function is cut ([`strips`]),
//! and how many values are alive at once ([`pressure`]).

pub mod pressure;
pub mod strips;

pub use strips::{Column, Piece, Plan, Slot, Then};
