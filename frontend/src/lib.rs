//! What a model is: BlobTrees, how they are written, checked and lowered to programs.
//!
//! ```text
//! text | builder | importer  ->  Model  ->  check: CheckedTree  ->  lower: ir::Function + Tables
//! ```
//!
//! This crate knows no lanes and no machine code; it writes its formulas over [`jbt_ir::Domain`].

pub mod affine;
mod angle;
pub mod attribute;
pub mod axis;
pub mod bounds;
pub mod builder;
pub mod check;
pub mod combine;
mod descent;
pub mod diagnostic;
pub mod expression;
pub mod falloff;
pub mod field;
mod function;
pub mod import;
#[cfg(any(feature = "glam", feature = "mint"))]
mod interop;
pub mod kind;
pub mod lower;
pub mod map;
pub mod member;
pub mod model;
pub mod number;
pub mod origin;
pub mod owner;
pub mod parameter;
mod power;
pub mod query;
mod report;
pub mod scopes;
pub mod skeleton;
pub mod term;
pub mod text;
pub mod texture;
pub mod traverse;
pub mod tree;
pub mod walk;
pub mod warp;
mod word;
pub mod written;
