//! Sampling: the answers of a query at the points of a lattice, all of them or only where something is.
//!
//! ```text
//! divide the lattice into blocks of 16^3 points, with the rows that reach each:
//!     nothing reaches a block         it is constant: one point is evaluated            (it may be huge; not where there are formulas)
//!     all of it is in or out          skipped, where only the surface is wanted
//!     else                            its points are evaluated with its rows
//! ```
//!
//! Coordinates are those of the [`Lattice`], so that the bits are those of any other way to ask at these
//! points.

mod band;
mod block;
mod leaf;
mod npy;
mod vdb;

pub use block::Block;
pub use npy::write_npy;
pub use vdb::{VdbField, VdbVolume, write_vdb};

use crate::parallel::*;
use jbt_model::diagnostic::Diagnostics;

use jbt_ir::limits::MAX_LATTICE_POINTS;
use jbt_ir::memory::{self, NoMemory};
use jbt_ir::watch;
use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;
use jbt_model::query::Query;

use crate::boxes::Box3;
use crate::buffer::Layout;
use crate::compiled::{Compiled, Task};
use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::divide::{Cell, Decision, DivideError, Limits, divide};
use crate::error::{Classified, CompileError, ErrorKind, EvalError};
use crate::evaluator::Evaluator;
use crate::job::{Hook, Job, JobError};
use crate::mesh::Lattice;
use crate::progress::{Cancelled, Progress, SOME};
use crate::prune::{Pruner, Region};

/// Which blocks of a lattice are sampled.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Wanted {
    /// All.
    Everywhere,
    /// Those that some primitive or formula reaches: elsewhere the field is zero.
    Support,
    /// Those in which the field may have this value: the others are known to be inside or outside.
    Surface(f32),
}

/// Samples models. The evaluator and the pruner are those of one model.
pub struct Sampler {
    evaluator: Evaluator,
    pruner: Pruner,
    /// Whether the model has formulas: their fields change from place to place where no primitive reaches.
    formulas: bool,
}

brief_debug!(Sampler, "Sampler", this: evaluator = this.evaluator);

/// Why a lattice was not sampled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// The model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// More numbers than fit into memory that anybody has.
    #[error(
        "{points} lattice points with {planes} answers each are more than {MAX_LATTICE_POINTS} numbers: \
         the cells are too small, or the region too large"
    )]
    TooMany {
        /// Points of the lattice.
        points: u128,
        /// Answers of the query.
        planes: usize,
    },
    /// The memory for the work is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// The lattice could not be divided.
    #[error(transparent)]
    Divide(#[from] DivideError<EvalError>),
    /// It was told to stop.
    #[error("sampling was cancelled")]
    Cancelled,
}

impl From<Cancelled> for SampleError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl JobError for SampleError {
    fn told(self) -> Self {
        if self.kind() == ErrorKind::Cancelled { Self::Cancelled } else { self }
    }
}

impl Classified for SampleError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Compile(error) => error.kind(),
            Self::TooMany { .. } | Self::Memory(_) => ErrorKind::Limit,
            Self::Divide(error) => error.kind(),
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}

/// Points along the edge of a block.
const BLOCK: usize = 16;
/// Blocks between two reports of progress.
const STRIDE: usize = 256;

/// A range of indices along each axis: the points of a block. From the first to before the end.
type Indices = [[u32; 2]; 3];

impl Sampler {
    /// A sampler of a model of which nothing else is asked: see [`of`](Self::of).
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn new(compiler: &Compiler, tree: &CheckedTree, query: Query) -> Result<Self, CompileError> {
        Self::of(&compiler.compile(tree), query)
    }

    /// A sampler of a compiled model.
    ///
    /// # Errors
    /// The model is beyond a limit, or the engine cannot be had.
    pub fn of(compiled: &Compiled, query: Query) -> Result<Self, CompileError> {
        let is_formula = |kind: &NodeKind| matches!(kind, NodeKind::Expression(_));
        Self::with(compiled, query, compiled.tree().nodes().iter().any(|node| is_formula(&node.kind)))
    }

    /// A sampler of a model that has formulas or has none.
    pub(crate) fn with(compiled: &Compiled, query: Query, formulas: bool) -> Result<Self, CompileError> {
        compiled.prepare(&Task::Samples(query).needs())?;
        Ok(Self { evaluator: compiled.regional(query)?, pruner: compiled.pruner()?, formulas })
    }

    /// What answers.
    #[must_use]
    pub fn evaluator(&self) -> &Evaluator {
        &self.evaluator
    }

    /// What finds the rows that matter.
    #[must_use]
    pub fn pruner(&self) -> &Pruner {
        &self.pruner
    }

    /// The wanted blocks of a lattice, in the order of a walk down its octree. No two have a point in common.
    ///
    /// Memory: the answers at the points of the wanted blocks. The answers do not depend on the threads.
    ///
    /// # Errors
    /// See [`SampleError`].
    pub fn blocks<'a>(&'a self, lattice: &'a Lattice, wanted: Wanted) -> Job<'a, Vec<Block>, SampleError> {
        Job::new(move |hook| {
            let mut blocks = Vec::new();
            self.each_block(lattice, wanted, hook, &mut |block| blocks.push(block))?;
            Ok(blocks)
        })
    }

    /// The answers at all points of a lattice: a plane for each name of the [`layout`](Evaluator::layout), x
    /// fastest, then y, then z.
    ///
    /// # Errors
    /// See [`SampleError`]. The number of numbers is checked before memory is taken.
    pub fn dense<'a>(&'a self, lattice: &'a Lattice) -> Job<'a, Vec<Vec<f32>>, SampleError> {
        Job::new(move |hook| self.dense_hooked(lattice, hook))
    }

    fn dense_hooked(&self, lattice: &Lattice, hook: Hook<'_>) -> Result<Vec<Vec<f32>>, SampleError> {
        let count = self.check_size(lattice)?;
        let planes = self.layout().names().len();
        let mut dense = Vec::with_capacity(planes);
        for _ in 0..planes {
            let mut plane = memory::room(count)?;
            plane.resize(count, 0.0);
            dense.push(plane);
        }
        let points = lattice.points();
        self.each_block(lattice, Wanted::Everywhere, hook, &mut |block| block.copy_to(points, &mut dense))?;
        Ok(dense)
    }

    /// The number of points of a lattice, if all answers at them are not too many.
    fn check_size(&self, lattice: &Lattice) -> Result<usize, SampleError> {
        let points: u128 = lattice.points().iter().map(|&points| points as u128).product();
        let planes = self.layout().names().len();
        if points.saturating_mul(planes as u128) > MAX_LATTICE_POINTS as u128 {
            return Err(SampleError::TooMany { points, planes });
        }
        Ok(points as usize)
    }

    fn layout(&self) -> &Layout {
        self.evaluator.layout()
    }

    fn each_block(
        &self,
        lattice: &Lattice,
        wanted: Wanted,
        hook: Hook<'_>,
        take: &mut dyn FnMut(Block),
    ) -> Result<(), SampleError> {
        let progress = Progress::new(hook, SOME);
        progress.check().map_err(SampleError::from)?;
        let axes = lattice.axes();
        let all: Indices = lattice.points().map(|points| [0, points as u32]);
        // What has been told to stop has nothing more to divide.
        let decide = |cell: &Cell<'_, Pruner>, indices: &Indices| match progress.check() {
            Ok(()) => self.decide(&axes, wanted, cell, indices),
            Err(Cancelled) => Ok(Decision::Stop),
        };
        let division = divide(&self.pruner, box_of(&axes, &all), all, &Limits::default(), &decide)?;
        let leaves: Vec<(Indices, &Region)> =
            division.leaves().map(|(node, region)| (node.data, region)).collect();
        progress.check()?;
        let share = 1.0 / leaves.len() as f64;
        for some in leaves.chunks(STRIDE) {
            let sample = |at_once: &mut usize, (indices, region): &(Indices, &Region)| {
                let block = self.block(&axes, *indices, region, (&progress, at_once))?;
                progress.add(share)?;
                Ok::<_, SampleError>(block)
            };
            let blocks: Vec<Block> = scatter(|watches| {
                let sample = |at_once: &mut usize, some: &_| watches.hold(|| sample(at_once, some));
                some.par_iter().map_init(usize::default, sample).collect::<Result<_, _>>()
            })?;
            blocks.into_iter().for_each(&mut *take);
        }
        Ok(progress.finish()?)
    }

    fn decide(
        &self,
        axes: &[Vec<f32>; 3],
        wanted: Wanted,
        cell: &Cell<'_, Pruner>,
        indices: &Indices,
    ) -> Result<Decision<Indices>, EvalError> {
        let constant = self.is_constant(cell.region()?);
        match wanted {
            Wanted::Everywhere if constant => return Ok(Decision::Leaf),
            Wanted::Support | Wanted::Surface(_) if constant => return Ok(Decision::Stop),
            Wanted::Support if self.formulas && cell.range()? == [0.0; 2] => return Ok(Decision::Stop),
            Wanted::Everywhere | Wanted::Support => {}
            Wanted::Surface(iso) => {
                let [low, high] = cell.range()?;
                if high < iso || low >= iso {
                    return Ok(Decision::Stop);
                }
            }
        }
        let small = indices.iter().all(|[first, end]| (end - first) as usize <= BLOCK);
        Ok(if small { Decision::Leaf } else { halve(axes, indices) })
    }

    /// Whether the answers are the same everywhere in a region, because nothing reaches it.
    fn is_constant(&self, region: &Region) -> bool {
        !self.formulas && self.evaluator.evaluations_in(region) == 0
    }

    fn block(
        &self,
        axes: &[Vec<f32>; 3],
        indices: Indices,
        region: &Region,
        (progress, at_once): (&Progress<'_>, &mut usize),
    ) -> Result<Block, SampleError> {
        let axis = |axis: usize| &axes[axis][indices[axis][0] as usize..indices[axis][1] as usize];
        let [xs, ys, zs] = [axis(0), axis(1), axis(2)];
        let [xs, ys, zs] =
            if self.is_constant(region) { [&xs[..1], &ys[..1], &zs[..1]] } else { [xs, ys, zs] };
        let count = xs.len() * ys.len() * zs.len();
        let numbers = count * (3 + self.layout().names().len());
        watch::take(numbers * size_of::<f32>());
        let (mut x, mut y, mut z) =
            (Vec::with_capacity(count), Vec::with_capacity(count), Vec::with_capacity(count));
        for &at_z in zs {
            for &at_y in ys {
                x.extend_from_slice(xs);
                y.resize(x.len(), at_y);
            }
            z.resize(x.len(), at_z);
        }
        let mut planes = vec![vec![0.0; count]; self.layout().names().len()];
        progress.paced(count, at_once, |some| {
            let points = [&x[some.clone()], &y[some.clone()], &z[some.clone()]];
            let mut answers: Vec<&mut [f32]> =
                planes.iter_mut().map(|plane| &mut plane[some.clone()]).collect();
            let evaluated = self.evaluator.eval_region(region, points, &mut answers);
            evaluated.map_err(|error| SampleError::Divide(DivideError::Field(error)))
        })?;
        Ok(Block::new(indices, planes))
    }
}

/// The closed box of some points.
fn box_of(axes: &[Vec<f32>; 3], indices: &Indices) -> Box3 {
    let side = |last: bool| {
        [0, 1, 2].map(|axis| {
            axes[axis][if last { indices[axis][1] as usize - 1 } else { indices[axis][0] as usize }]
        })
    };
    Box3::new(side(false), side(true))
}

/// Two parts along the axis with the most points, at a multiple of the block.
fn halve(axes: &[Vec<f32>; 3], indices: &Indices) -> Decision<Indices> {
    let length = |axis: usize| indices[axis][1] - indices[axis][0];
    let axis = [1, 2].into_iter().fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
    let [first, end] = indices[axis].map(|index| index as usize);
    let middle = (first + (end - first) / 2).next_multiple_of(BLOCK).min(end - 2);
    let mut data = [*indices; 2];
    data[0][axis][1] = middle as u32;
    data[1][axis][0] = middle as u32;
    // The points below the place belong to the first part, the others to the second one.
    Decision::Split { axis, at: axes[axis][middle], data }
}
