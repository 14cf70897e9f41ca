//! Lowering: a checked tree and a query become a program and its numbers.
//!
//! ```text
//! tree ──occurrence──► occurrences ──shape──► shapes ──emit──► ir::Function      the shape of the tree becomes code,
//!      what stands where,            which of them            one body a shape
//!      sharing                       are alike       ──rows──► ir::Tables         its numbers become rows
//! ```
//!
//! * `occurrence`: affine and attribute nodes dissolve into the position and the attribute bindings of the leaves below them;
//!   a node that is met twice at one position is one occurrence.
//! * `shape`: nested operators of a kind flatten; occurrences that differ in numbers alone have one shape.
//! * `emit`: children of one operator that have one shape are the rows of one table, under one fold. Field and attribute
//!   weights come out of the same traversal; the gradient is the business of a later pass.
//! * `rows`: walks the occurrences in the order of `emit` and writes down their numbers.
//! * `support`: finds for each occurrence where it can be anything but zero, in the program's own arithmetic.
//! * [`guide`]: what somebody has to know who leaves rows out: supports, rules, and a function of probes.
//!
//! The tables, their rows and the order of these are the same for every query; only columns differ.
//!
//! The program's body is a fold over the one row of the table `scene`, which holds the numbers of whatever is there once.

mod emit;
pub mod guide;
mod leaves;
mod mixing;
mod occurrence;
mod position;
mod rows;
mod shape;
mod support;

use jbt_ir::{Function, Tables};

use crate::check::CheckedTree;
use crate::diagnostic::Diagnostic;
use crate::query::Query;

pub use guide::{Guide, Guided, lower_guided};
pub use leaves::LeafOccurrences;

/// A program, before any pass, and its numbers.
#[derive(Clone, Debug)]
pub struct Lowered {
    /// The shape of the model as code. Outputs: `field`, then the channels of every attribute group in order.
    pub function: Function,
    /// The numbers of the model. Nodes of rows are [`crate::check::NodeId`]s.
    pub tables: Tables,
}

/// Lowers a model for a query.
///
/// Trees of one shape give equal functions, whatever their numbers; their tables may be exchanged.
///
/// # Errors
/// Located diagnostics: numbers that leave the range of f32 once all transforms are applied, or a program beyond
/// [`jbt_ir::limits`].
pub fn lower(tree: &CheckedTree, query: Query) -> Result<Lowered, Vec<Diagnostic>> {
    let scene = occurrence::Scene::new(tree);
    let shapes = shape::Shapes::new(&scene);
    let code = emit::emit(&scene, &shapes, query)?;
    let rows = rows::rows(&scene, &shapes, query, &code)?;
    Ok(Lowered { function: code.function, tables: rows.tables })
}
