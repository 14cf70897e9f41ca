//! Statistics: how many evaluations of primitives a question takes, in old ways and in ours, and how many of
//! them matter.
//!
//! ```text
//! separate   walks(query) x uses of leaves           each walk goes down every path: shared subtrees again at each use
//! cached     places(query) x instances of leaves   a memory for each point: a leaf at a position once for each place asked
//! fused      what the compiled program evaluates
//! matters    pairs of a point and an instance where the point is inside of the primitive's support
//! ```
//!
//! An *evaluation* is one distance to one skeleton at one place. A *use* of a leaf is a path from the root to
//! it; an *instance* is a leaf at a position, whatever the number of paths that lead there.

use jbt_ir::memory::NoMemory;
use jbt_model::diagnostic::Diagnostics;
use std::collections::BTreeMap;

use crate::parallel::*;
use jbt_lower::LeafInstances;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;

use crate::compiler::Compiler;
pub use crate::counter::walks;
use crate::debug::brief_debug;
use crate::error::{Classified, CompileError, ErrorKind, EvalError};
use crate::evaluator::Evaluator;
use crate::job::{Hook, Job, JobError};
use crate::mesh::{Lattice, LatticeError};

/// Different places that those walks ask about: the point, and the ends of the three steps of a gradient by
/// differences.
#[must_use]
pub fn places(query: Query) -> u64 {
    query.answers().map(|answer| answer.row().places.0).sum()
}

/// Uses of leaves: paths from the root to a leaf, through the chosen child of a selector alone.
#[must_use]
pub fn leaf_uses(tree: &CheckedTree) -> u64 {
    tree.leaf_uses()
}

/// Evaluations of primitives for one point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PerPoint {
    /// By separate walks of the tree.
    pub separate: u64,
    /// By separate walks that remember, for each point, the field of every leaf at every position.
    pub cached: u64,
    /// By the compiled program.
    pub fused: u64,
}

/// What is known about the leaves of a model.
pub struct Statistics<'a> {
    uses: u64,
    instances: LeafInstances<'a>,
}

brief_debug!(Statistics<'_>, "Statistics", this: uses = this.uses, instances = this.instances());

/// How far around a leaf's support lattice points are tried, as a part of the largest coordinate: more than
/// f32 is off by.
const ROUNDING: f64 = 1.0 / (1 << 18) as f64;
/// Points that are evaluated at once.
const BATCH: usize = 1 << 13;
/// Instances between two reports of progress.
const STRIDE: usize = 64;

impl<'a> Statistics<'a> {
    /// The statistics of a model. Cost: all paths of the tree at worst.
    #[must_use]
    pub fn new(tree: &'a CheckedTree) -> Self {
        Self { uses: leaf_uses(tree), instances: LeafInstances::new(tree) }
    }

    /// Uses of leaves: paths from the root to a leaf.
    #[must_use]
    pub fn uses(&self) -> u64 {
        self.uses
    }

    /// Instances of leaves: a leaf at a position once.
    #[must_use]
    pub fn instances(&self) -> u64 {
        self.instances.len() as u64
    }

    /// The evaluations for one point of the query of an evaluator for this model.
    #[must_use]
    pub fn per_point(&self, evaluator: &Evaluator) -> PerPoint {
        let query = evaluator.query();
        PerPoint {
            separate: walks(query).saturating_mul(self.uses),
            cached: places(query).saturating_mul(self.instances()),
            fused: evaluator.evaluations_per_point(),
        }
    }

    /// Counts the pairs of a lattice point and an instance where the point is inside of the primitive's
    /// support, nearer to its skeleton than its radius.
    ///
    /// Every point near the box of a support is tried by the compiled field of that leaf alone, in the same
    /// f32 arithmetic as in the whole model; points far from the box are outside. Maps and warps are those
    /// above the leaf; operators and strengths, which may silence a leaf, do not count. The answer does not
    /// depend on the threads.
    ///
    /// # Errors
    /// It was cancelled, a leaf could not be compiled, or the lattice has too many points to visit all.
    pub fn supports<'b>(
        &'b self,
        compiler: &'b Compiler,
        lattice: &'b Lattice,
    ) -> Job<'b, SupportCounts, SupportsError> {
        Job::new(move |hook| self.supports_hooked(compiler, lattice, hook))
    }

    fn supports_hooked(
        &self,
        compiler: &Compiler,
        lattice: &Lattice,
        hook: Hook<'_>,
    ) -> Result<SupportCounts, SupportsError> {
        lattice.check_points()?;
        let axes = lattice.axes();
        let mut supports =
            SupportCounts { points: lattice.point_count(), pairs: 0, by_node: BTreeMap::new() };
        let count = self.instances.len();
        for start in (0..count).step_by(STRIDE) {
            if !hook(start as f32 / count as f32) {
                return Err(SupportsError::Cancelled);
            }
            let some = start..count.min(start + STRIDE);
            let of = |index| inside(compiler, &self.instances.alone(index), lattice.spacing(), &axes);
            let pairs: Vec<u64> = scatter(|watches| {
                some.clone().into_par_iter().map(|index| watches.hold(|| of(index))).collect::<Result<_, _>>()
            })?;
            for (index, pairs) in some.zip(pairs) {
                supports.pairs += pairs;
                *supports.by_node.entry(self.instances.node(index).0).or_default() += pairs;
            }
        }
        Ok(supports)
    }
}

/// What matters on a lattice: how many points are inside of supports.
#[derive(Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SupportCounts {
    /// Points of the lattice.
    pub points: u64,
    /// Pairs of a point and an instance whose support it is inside of.
    pub pairs: u64,
    /// The pairs by tree node: every leaf is here, with all its instances.
    pub by_node: BTreeMap<u32, u64>,
}

impl SupportCounts {
    /// The waste: the evaluations that were done for each one that matters, 1 at best; `None` if none
    /// matters.
    #[must_use]
    pub fn waste(&self, evaluations: u64) -> Option<f64> {
        (self.pairs > 0).then(|| evaluations as f64 / self.pairs as f64)
    }
}

/// Why supports were not counted.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SupportsError {
    /// A leaf could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The lattice has too many points.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// A leaf could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// The memory for the work is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// It was told to stop.
    #[error("cancelled")]
    Cancelled,
}

impl JobError for SupportsError {
    fn told(self) -> Self {
        if self.kind() == ErrorKind::Cancelled { Self::Cancelled } else { self }
    }
}

impl Classified for SupportsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Compile(error) => error.kind(),
            Self::Lattice(error) => error.kind(),
            Self::Eval(error) => error.kind(),
            Self::Memory(_) => ErrorKind::Limit,
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}

/// Lattice points inside of the support of a model of one leaf.
fn inside(
    compiler: &Compiler,
    leaf: &CheckedTree,
    spacing: f64,
    axes: &[Vec<f32>; 3],
) -> Result<u64, SupportsError> {
    let support = leaf.support();
    let [low, high] = [support.low(), support.high()];
    let farthest = low.iter().chain(&high).fold(0.0, |most: f64, side| most.max(side.abs()));
    let margin = spacing + ROUNDING * farthest;
    let [xs, ys, zs]: [&[f32]; 3] = std::array::from_fn(|axis| {
        let below = |side: f64| axes[axis].partition_point(|&at| f64::from(at) < side);
        // An infinite side has an infinite margin, and their difference would be no number.
        let side = |side: f64, margin: f64| if side.is_finite() { side + margin } else { side };
        let first = below(side(low[axis], -margin));
        &axes[axis][first..below(side(high[axis], margin)).max(first)]
    });
    if xs.is_empty() || ys.is_empty() || zs.is_empty() {
        return Ok(0);
    }
    let evaluator = compiler.evaluator(leaf, Query::FIELD)?;
    let count = |slab: &mut Slab, &z: &f32| slab.count(&evaluator, xs, ys, z);
    let rooms = Rooms::new(Slab::default);
    let slabs = scatter(|watches| {
        let slabs = zs.par_iter().map_init(|| rooms.take(), |slab, z| watches.hold(|| count(slab, z)));
        slabs.collect::<Result<Vec<u64>, _>>()
    })?;
    Ok(slabs.into_iter().sum())
}

/// Points and their fields.
#[derive(Default)]
struct Slab {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    field: Vec<f32>,
}

impl Slab {
    /// The points with a positive field among `xs` x `ys` x {z}.
    fn count(&mut self, evaluator: &Evaluator, xs: &[f32], ys: &[f32], z: f32) -> Result<u64, EvalError> {
        let mut found = 0;
        for ys in ys.chunks((BATCH / xs.len()).max(1)) {
            self.x.clear();
            self.y.clear();
            for &y in ys {
                self.x.extend_from_slice(xs);
                self.y.resize(self.x.len(), y);
            }
            self.z.clear();
            self.z.resize(self.x.len(), z);
            self.field.resize(self.x.len(), 0.0);
            let planes = [&self.x[..], &self.y, &self.z];
            evaluator.eval_planes(planes, &mut [&mut self.field])?;
            found += self.field.iter().filter(|&&field| field > 0.0).count() as u64;
        }
        Ok(found)
    }
}
