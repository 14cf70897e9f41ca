//! Lowering: a checked tree and a query become a program and its numbers.
//!
//! ```text
//! tree ──instance──► instances ──shape──► shapes ──emit──► ir::Function      the shape of the tree becomes code,
//!      what stands where,            which of them            one body a shape
//!      sharing                       are alike       ──rows──► ir::Tables         its numbers become rows, by recipe
//! ```
//!
//! * `instance`: affine and attribute nodes dissolve into the position and the attribute bindings of the
//!   leaves below them; a node that is met twice at one position is one instance.
//! * `shape`: an operator inside an equal one dissolves into it; instances that differ in numbers alone have
//!   one shape.
//! * `emit`: children of one operator that have one shape are the rows of one table, under one fold. Field
//!   and attribute weights come out of the same traversal. The gradient is added by a later pass; lowering
//!   only asks whether there will be one, because then ties have to be decided.
//! * `slopes`: how a formula's value follows its children's, for the weights of their attributes.
//! * `computed`: attribute values that are functions of the point.
//! * `demand`: what selectors leave out has code, in folds whose rows are not active.
//! * `columns`: what each column is called, and its number.
//! * `recipe`: how the rows of a table are filled: `emit` writes that down as it declares columns.
//! * `run`: particles that have one code are one leaf, which stands for many rows.
//! * `rows`: fills every row by the recipe of its table; those of particles in parts, which `workers` do at
//!   once.
//! * `support`: finds for each instance where it can be anything but zero, in the program's own arithmetic.
//! * [`prune_info`]: what pruning has to know: supports, rules, and the range function; `ranges` makes
//!   it.
//! * `names`: the names that all of them use.
//!
//! The tables, their rows and the order of these are the same for every query; only columns differ.
//!
//! The program's body is a fold over the one row of the table `scene`, which holds the numbers of whatever is
//! there once.

mod columns;
mod computed;
mod demand;
mod emit;
mod instance;
mod leaves;
mod mixing;
mod names;
mod position;
pub mod prune_info;
mod ranges;
mod recipe;
mod rows;
mod run;
mod shape;
mod slopes;
mod support;
mod workers;

use std::fmt;

use jbt_ir::{Function, Tables};

use jbt_model::check::CheckedTree;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::query::Query;

pub use leaves::LeafInstances;
pub use prune_info::{PruneInfo, RangeFunction};
pub use workers::{Serial, Workers};

/// A program, before any pass, and its numbers.
#[derive(Clone, Debug)]
pub struct Lowered {
    /// The shape of the model as code. Outputs: `field`; then, if the query has attributes, the channels of
    /// every group in order. The gradient pass puts `gx`, `gy`, `gz` right behind `field`.
    pub function: Function,
    /// The numbers of the model. Nodes of rows are [`jbt_model::check::NodeId`]s.
    pub tables: Tables,
}

/// A model on its way to programs: what stands where, and which parts are alike. It is found once, for all
/// that is asked of the model.
pub struct Lowering<'a> {
    scene: instance::Scene<'a>,
    shapes: shape::Shapes,
    /// Who fills the rows of particles.
    workers: &'a dyn Workers,
}

impl fmt::Debug for Lowering<'_> {
    /// The tree, and not what was found in it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lowering").field("tree", self.tree()).finish_non_exhaustive()
    }
}

impl<'a> Lowering<'a> {
    /// Cost: all paths of the tree that do not lead to the same place.
    #[must_use]
    pub fn new(tree: &'a CheckedTree) -> Self {
        Self::with(tree, &Serial)
    }

    /// The same, with workers for the rows of particles. They change no bit.
    #[must_use]
    pub fn with(tree: &'a CheckedTree, workers: &'a dyn Workers) -> Self {
        let scene = instance::Scene::new(tree);
        let shapes = shape::Shapes::new(&scene);
        Self { scene, shapes, workers }
    }

    /// The model.
    #[must_use]
    pub fn tree(&self) -> &'a CheckedTree {
        self.scene.tree
    }

    /// The program for a query.
    ///
    /// Trees of one shape give equal functions, whatever their numbers; their tables may be exchanged.
    ///
    /// # Errors
    /// Located diagnostics: numbers that leave the range of f32 once all transforms are applied, or a program
    /// beyond [`jbt_ir::limits`].
    pub fn answers(&self, query: Query) -> Result<Lowered, Vec<Diagnostic>> {
        let code = emit::emit(&self.scene, &self.shapes, query)?;
        let rows = rows::rows(&self.scene, &self.shapes, &code, self.workers)?;
        Ok(Lowered { function: code.function, tables: rows.tables })
    }

    /// The range function, and what there is to know about the tables of all queries.
    ///
    /// # Errors
    /// Those of [`answers`](Self::answers).
    pub fn ranges(&self) -> Result<RangeFunction, Vec<Diagnostic>> {
        ranges::ranges(&self.scene, &self.shapes, self.workers)
    }
}

/// Lowers a model for one query: see [`Lowering`].
///
/// # Errors
/// Those of [`Lowering::answers`].
pub fn lower(tree: &CheckedTree, query: Query) -> Result<Lowered, Vec<Diagnostic>> {
    Lowering::new(tree).answers(query)
}

/// Lowers a model to its range function, and says what there is to know about its tables: see [`Lowering`].
///
/// # Errors
/// Those of [`Lowering::ranges`].
pub fn lower_ranges(tree: &CheckedTree) -> Result<RangeFunction, Vec<Diagnostic>> {
    Lowering::new(tree).ranges()
}
