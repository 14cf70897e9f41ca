//! What a program means: the intermediate representation of jbt.
//!
//! A [`Function`] takes planes of numbers (x, y, z) to planes of answers (field, gradient, attributes). It is
//! SSA over three lane types, and its only control flow is the fold over the rows of a table. This crate
//! knows no trees and no machine.

#![deny(unsafe_code)]

pub mod alone;
pub mod builder;
pub mod domain;
pub mod engine;
pub mod entity;
pub mod environment;
mod facts;
pub mod function;
pub mod interpret;
pub mod level;
pub mod limits;
pub mod math;
pub mod memory;
pub mod op;
pub mod origin;
pub mod pass;
pub mod plan;
pub mod selection;
pub mod straight;
pub mod table;
pub mod text;
pub mod translate;
pub mod verify;
pub mod watch;

pub use alone::RowFunction;
pub use builder::FunctionBuilder;
pub use entity::{Block, Entity, Inst, Results, Store, Table, Value, Values};
pub use function::{BlockData, Fold, FoldKind, Function, InstData, InstKind, Rule, Schema};
pub use level::Level;
pub use op::{Any, Domain, Op, Type, apply};
pub use origin::{Origin, Part};
pub use selection::Selection;
pub use straight::Straight;
pub use table::{Rows, TableError, Tables};
pub use text::{ParseError, parse};
pub use verify::{Place, Verified, VerifyError, verify};
