//! A part of a model: a shape and rows, compiled.

use std::sync::Arc;

use jbt_ir::table::{Rows, TableError, Tables};
use jbt_ir::{Entity as _, Function, Store};
use jbt_lower::RangeFunction;
use jbt_lower::prune_info::PruneInfo;
use jbt_model::attribute::AttributeGroup;
use jbt_model::check::NodeId;
use jbt_model::query::Query;

use super::error::RemoteError;
use super::rows::ModelRows;
use super::shape::ModelShape;
use crate::boxes::Box3;
use crate::buffer::Layout;
use crate::compiled::Compiled;
use crate::compiler::Compiler;
use crate::error::compiled_within_memory;
use crate::evaluator::Evaluator;
use crate::job::Job;
use crate::kernel::Purpose;
use crate::mesh::{Lattice, LatticeBlock, MeshBlock};
use crate::polygonize::{Polygonize, PolygonizeError};
use crate::program::AnswerProgram;
use crate::prune::Pruner;
use crate::prune::program::RangeProgram;
use crate::sample::{SampleError, Sampler};

/// A part of a model, in whose box all answers have the bits of the whole. Elsewhere they mean nothing.
#[derive(Debug)]
pub struct ModelPart {
    compiled: Compiled,
    bounds: Box3,
    queries: Vec<Query>,
    formulas: bool,
}

/// A part of a model from the shape of the whole and from the rows that reach a box. The programs are those
/// of the whole, so a compiler makes them once for all parts.
///
/// ```
/// use jbt::remote::{ModelRows, ModelShape, RowSource, from_rows};
/// use jbt::{Box3, Compiler, Model, Query, build::point};
/// let tree = Model::new(point([0, 0, 0], 1) + point([9, 0, 0], 1)).check()?;
/// let source = RowSource::new(&Compiler::new().compile(&tree), &[Query::FIELD])?;
/// let rows = source.rows(Box3::new([-1.0; 3], [1.0; 3]))?;
///
/// // In another process.
/// let shape = ModelShape::from_bytes(source.shape().bytes())?;
/// let rows = ModelRows::from_bytes(&rows.to_bytes())?;
/// let part = from_rows(&Compiler::new(), &shape, &rows)?;
/// let evaluator = part.evaluator(Query::FIELD)?;
/// let mut samples = evaluator.samples();
/// evaluator.eval(&[[0.0, 0.0, 0.0]], &mut samples)?;
/// assert_eq!(samples.field(), [1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`RemoteError`]: rows of another shape, or that do not fit it.
pub fn from_rows(
    compiler: &Compiler,
    shape: &ModelShape,
    rows: &ModelRows,
) -> Result<ModelPart, RemoteError> {
    compiled_within_memory(|| part_of(compiler, shape, rows))
}

fn part_of(compiler: &Compiler, shape: &ModelShape, rows: &ModelRows) -> Result<ModelPart, RemoteError> {
    if rows.shape != shape.fingerprint() {
        return Err(RemoteError::Shape { rows: rows.shape, shape: shape.fingerprint() });
    }
    let programs = 1 + shape.answers.len();
    let count = shape.ranges.tables.len();
    if rows.tables.len() != count || rows.tables.iter().any(|table| table.numbers.len() != programs) {
        let table = jbt_ir::Table::new(rows.tables.len().min(count.saturating_sub(1)));
        let problem = "there have to be rows of each table for each program";
        return Err(TableError { table, problem }.into());
    }
    // Nothing of the tree is looked at: all programs are there.
    let compiled = compiler.compile(&shape.tree);
    let tables = tables_of(&shape.ranges, rows, 0)?;
    let function = shape.ranges.copied();
    let ranges = RangeFunction { function, tables, info: info(shape, rows) };
    let ranges = RangeProgram::new(compiler, ranges, None)?;
    let mut answers = Vec::with_capacity(shape.answers.len());
    // Programs call their outputs by channels, whatever the titles of columns are.
    let channels = |group: &AttributeGroup| AttributeGroup { titles: Arc::default(), ..group.clone() };
    let channels: Vec<AttributeGroup> = shape.tree.attributes().iter().map(channels).collect();
    for (index, (query, function)) in shape.answers.iter().enumerate() {
        let tables = tables_of(function, rows, 1 + index)?;
        let kernel = compiler.kernel(function.copied(), Purpose::Answers(*query), None)?;
        let layout = Layout::new(*query, &channels);
        if layout.names() != kernel.function.function().outputs {
            return Err(RemoteError::Query { query: query.name().into_owned() });
        }
        let bound = compiler.bind(&kernel, tables);
        answers.push(AnswerProgram::with_uses(&shape.tree, *query, bound, rows.uses));
    }
    compiled.fill(ranges, answers);
    Ok(ModelPart {
        compiled,
        bounds: rows.bounds,
        queries: shape.queries().collect(),
        formulas: shape.formulas,
    })
}

/// The rows for a program.
fn tables_of(function: &Function, rows: &ModelRows, program: usize) -> Result<Tables, TableError> {
    let mut tables = Store::new();
    for (schema, part) in function.tables.values().zip(&rows.tables) {
        let count = part.len();
        tables.push(Rows {
            count,
            stride: schema.columns.len(),
            numbers: part.numbers(program).to_vec(),
            active: (0..count as u32).collect(),
            starts: part.starts.clone(),
            // Whoever has the whole model finds them by the numbers of rows.
            nodes: vec![0; count * schema.slots.len()],
        });
    }
    let tables = Tables { tables };
    tables.check(function)?;
    Ok(tables)
}

/// What pruning has to know about the rows.
fn info(shape: &ModelShape, rows: &ModelRows) -> PruneInfo {
    let mut info = shape.info.clone();
    for (table, part) in info.tables.keys().collect::<Vec<_>>().into_iter().zip(&rows.tables) {
        info.tables[table].supports = Arc::new(part.supports());
        info.tables[table].nodes = vec![NodeId(0); part.len()];
    }
    info
}

impl ModelPart {
    /// The box in which it answers, in coordinates about the model's origin.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// What answers a query, at points of the box.
    ///
    /// # Errors
    /// The shape has no program for the query.
    pub fn evaluator(&self, query: Query) -> Result<Evaluator, RemoteError> {
        self.check(query)?;
        Ok(self.compiled.regional(query)?)
    }

    /// What is asked about boxes within the box.
    ///
    /// # Errors
    /// Those of [`Compiled::pruner`].
    pub fn pruner(&self) -> Result<Pruner, RemoteError> {
        Ok(self.compiled.pruner()?)
    }

    /// A sampler, for lattices within the box.
    ///
    /// # Errors
    /// The shape has no program for the query.
    pub fn sampler(&self, query: Query) -> Result<Sampler, RemoteError> {
        self.check(query)?;
        Ok(Sampler::with(&self.compiled, query, self.formulas)?)
    }

    /// The answers at all points of a lattice within the box: see [`Sampler::dense`].
    ///
    /// # Errors
    /// The lattice is not within the box, or one of [`SampleError`].
    pub fn dense<'a>(
        &self,
        sampler: &'a Sampler,
        lattice: &'a Lattice,
    ) -> Result<Job<'a, Vec<Vec<f32>>, SampleError>, RemoteError> {
        let points = lattice.points();
        let corner = |last: bool| {
            [0, 1, 2].map(|axis| lattice.coordinate(axis, if last { points[axis] - 1 } else { 0 }))
        };
        self.check_bounds(Box3::new(corner(false), corner(true)))?;
        Ok(sampler.dense(lattice))
    }

    /// The part of a mesh that belongs to a block: see [`Polygonize::block`]. The rows have to be those of
    /// the block's [bounds](LatticeBlock::bounds) with this reach.
    ///
    /// # Errors
    /// The shape has no programs for meshes, or the rows are those of another box. The job has the error
    /// [`MeshError::Reach`](crate::mesh::MeshError::Reach) if the block needs rows of a larger reach.
    pub fn block<'a>(
        &'a self,
        lattice: &'a Lattice,
        block: LatticeBlock,
        reach: usize,
    ) -> Result<Job<'a, MeshBlock, PolygonizeError>, RemoteError> {
        [Query::FIELD, Query::GRADIENT, Query::SURFACE]
            .into_iter()
            .try_for_each(|query| self.check(query))?;
        self.check_bounds(block.bounds(lattice, reach))?;
        Ok(Job::new(move |hook| {
            Polygonize::default().block_hooked(&self.compiled, lattice, (block, reach), hook)
        }))
    }

    fn check(&self, query: Query) -> Result<(), RemoteError> {
        if self.queries.contains(&query) {
            return Ok(());
        }
        Err(RemoteError::Query { query: query.name().into_owned() })
    }

    fn check_bounds(&self, asked: Box3) -> Result<(), RemoteError> {
        let known = self.bounds;
        let inside =
            (0..3).all(|axis| asked.low[axis] >= known.low[axis] && asked.high[axis] <= known.high[axis]);
        if inside { Ok(()) } else { Err(RemoteError::Bounds { asked, known }) }
    }
}
