//! What a model is and what it means: members, trees of them, the check, the oracle.
//!
//! ```text
//! builder | jbt_text: text, importers  ->  Model  ->  check: CheckedTree  ->  jbt_lower: ir::Function + Tables
//! ```
//!
//! This crate knows no text format, no lanes and no machine code; members write their formulas over
//! [`jbt_ir::Domain`]. Much here is public for `jbt_text` and `jbt_lower` alone: `jbt` exports what users
//! need.

pub mod affine;
mod angle;
pub mod attribute;
pub mod axis;
pub mod bounds;
pub mod builder;
pub mod check;
pub mod combine;
pub mod constant;
mod descent;
pub mod diagnostic;
pub mod eigen;
pub mod expression;
pub mod falloff;
pub mod field;
pub mod function;
#[cfg(any(feature = "glam", feature = "mint"))]
mod interop;
pub mod kind;
pub mod label;
pub mod map;
pub mod member;
pub mod model;
pub mod number;
pub mod orientation;
pub mod origin;
pub mod owner;
pub mod parameter;
pub mod particles;
pub mod path;
mod power;
pub mod precedence;
pub mod query;
pub mod report;
pub mod scopes;
pub mod skeleton;
pub mod term;
pub mod texture;
pub mod tour;
pub mod traverse;
pub mod tree;
pub mod walk;
pub mod warp;
pub mod weights;
pub mod word;
pub mod written;
