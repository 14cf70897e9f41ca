//! Solids: questions about the set where the field is at least the iso-value, and not about single values of
//! the field.
//!
//! ```text
//! membership     which side a point is on, and whether the surface may pass within some distance of it
//! owner          the leaf that decides at a point; the leaves that may matter in a box
//! tight_bounds   a box around the solid, as narrow as wanted
//! PartSolids     the parts of a model: membership, volumes, overlaps and distances
//! measure        volume between bounds, area, centre of mass, and what the division that found them is like
//! ```
//!
//! The field is that of the compiled kernels, in f32, and the iso-value is rounded to f32, as meshing has
//! them. What is said to hold in a box is proven by enclosing ranges
//! ([`Divisible`](crate::boxes::Divisible)), so it holds for every value that a kernel gives there. What is
//! estimated says so. After Bowyer's svLis (1999): its membership test, its tight fit and the report of its
//! divisions.

mod bounds;
mod crossings;
mod cut;
mod gap;
mod measure;
mod membership;
mod overlap;
mod parts;
mod ranges;

pub use bounds::{BoundsError, TightBounds};
pub use gap::Gap;
pub use jbt_model::check::NodeId;
pub use jbt_model::owner::Owner;
pub use measure::{Contents, Measure, MeasureError, MeasureLevel, Measures, Volume};
pub use membership::{Membership, MembershipError};
pub use parts::{PartError, PartPair, PartSolids, Relation};

use std::sync::OnceLock;

use jbt_model::check::CheckedTree;
use jbt_model::owner;
use jbt_model::query::Query;

use crate::boxes::{Box3, Divisible as _, Range};
use crate::compiled::{Compiled, Task};
use crate::compiler::Compiler;
use crate::counter::Counters;
use crate::debug::brief_debug;
use crate::error::{Classified, CompileError, ErrorKind, EvalError, compiled_within_memory, within_memory};
use crate::evaluator::Evaluator;
use crate::prune::{Pruner, Region};
use crate::support::{NoBox, around_in_f32};

/// A model, compiled for questions about its solid: the set where `field >= iso`.
///
/// It is `Send + Sync`: threads may share it and ask at once. Boxes, and points in f32, count from the
/// [origin](CheckedTree::origin) of the model; points in f64 are in the world.
///
/// ```
/// use jbt::solid::{Membership, Solid};
/// # let tree = jbt::text::parse(b"jbt 1 point { surface_radius 1 }", &Default::default()).unwrap().check().unwrap();
/// let ball = Solid::new(&jbt::Compiler::new(), &tree).unwrap();
/// assert_eq!(ball.membership([0.0, 0.0, 0.8], 0.1).unwrap(), Membership::Inside);
/// assert_eq!(ball.membership([0.0, 0.0, 0.95], 0.1).unwrap(), Membership::Surface);
/// let bounds = ball.tight_bounds(None, 0.001).unwrap();
/// assert!((bounds.outer.unwrap().high[0] - 1.0).abs() <= 0.001);
/// ```
pub struct Solid {
    compiled: Compiled,
    /// The iso-value as kernels compare with it.
    iso: f32,
    pruner: Pruner,
    field: Evaluator,
    /// What answers the field and its gradient, from the first measure on.
    normals: OnceLock<Evaluator>,
}

brief_debug!(Solid, "Solid", this: iso = this.iso, engine = this.field.engine());

/// Why a question has no region.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RegionError {
    /// The region is infinite, not a number, flat, or not in order.
    #[error("a region has finite corners, each number of the first below that of the second, and this one goes from {:?} to {:?}", bounds.low, bounds.high)]
    Bounds {
        /// What was given.
        bounds: Box3,
    },
    /// The model's field is zero everywhere, and no region was given.
    #[error("the model is empty: its field is zero everywhere")]
    Empty,
    /// The model's field may differ from zero arbitrarily far away, and no region was given.
    #[error("the model is unbounded: it needs a region")]
    Unbounded,
}

impl Classified for RegionError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Bounds { .. } => ErrorKind::Argument,
            Self::Empty => ErrorKind::Model,
            Self::Unbounded => ErrorKind::Unbounded,
        }
    }
}

impl Solid {
    /// The solid of a model of which nothing else is asked: see [`of`](Self::of).
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn new(compiler: &Compiler, tree: &CheckedTree) -> Result<Self, CompileError> {
        Self::of(&compiler.compile(tree))
    }

    /// The solid of a compiled model.
    ///
    /// # Errors
    /// The model is beyond a limit, or the engine cannot be had.
    pub fn of(compiled: &Compiled) -> Result<Self, CompileError> {
        compiled.prepare(&Task::Solid.needs())?;
        Ok(Self {
            compiled: compiled.clone(),
            iso: compiled.tree().iso() as f32,
            pruner: compiled.pruner()?,
            field: compiled.regional(Query::FIELD)?,
            normals: OnceLock::new(),
        })
    }

    /// The solid of another model, usually an edited one: see [`Compiled::updated`].
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        compiled_within_memory(|| Self::of(&self.compiled.updated(tree)))
    }

    /// The model.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        self.compiled.tree()
    }

    /// What encloses the field in boxes. Its counters tell what the questions so far took of that.
    #[must_use]
    pub fn pruner(&self) -> &Pruner {
        &self.pruner
    }

    /// What evaluates the field at points.
    #[must_use]
    pub fn evaluator(&self) -> &Evaluator {
        &self.field
    }

    /// What the questions so far took at points: of the field, and of the field with its gradient.
    #[must_use]
    pub fn counters(&self) -> [Counters; 2] {
        [self.field.counters(), self.normals.get().map(Evaluator::counters).unwrap_or_default()]
    }

    /// What answers the field and its gradient.
    fn normals(&self) -> Result<&Evaluator, CompileError> {
        if self.normals.get().is_none() {
            let made = self.compiled.regional(Query::GRADIENT)?;
            // Another thread may have been quicker; both are the same.
            let _ = self.normals.set(made);
        }
        Ok(self.normals.get().expect("it has just been set"))
    }

    /// The leaf that decides the field at a point of the world, in f64 by a plain walk: see
    /// [`jbt_model::owner`].
    ///
    /// `None` where the field is 0, or where it is negative because nothing with a positive field is left.
    /// Cost: all paths of the tree.
    #[must_use]
    pub fn owner(&self, point: [f64; 3]) -> Option<Owner> {
        owner::owner(self.tree(), point)
    }

    /// The leaves that may matter in a box, ascending: whatever the others are, the field in the box is the
    /// same to the bit.
    ///
    /// A leaf that is shared between parents at the same place may be named where it does not matter.
    ///
    /// # Errors
    /// A box that is infinite, not a number, or not in order; it may be flat. Want of memory.
    pub fn owners_in(&self, bounds: Box3) -> Result<Vec<NodeId>, OwnersError> {
        if !bounds.is_proper() {
            return Err(OwnersError::Bounds { bounds });
        }
        within_memory(|| Ok(self.field.leaves_in(&self.pruner.region(bounds)?)))
    }

    /// Which side of the surface all values of a range are on: true is inside. `None` if the range does not
    /// tell.
    fn side(&self, [low, high]: Range) -> Option<bool> {
        if low >= self.iso {
            Some(true)
        } else if high < self.iso {
            Some(false)
        } else {
            None
        }
    }

    /// The region of a question: the one that was given, or the model's support and a little more.
    fn region(&self, given: Option<Box3>) -> Result<Box3, RegionError> {
        let bounds = match given {
            Some(bounds) => bounds,
            None => around_in_f32(self.tree()).map_err(|reason| match reason {
                NoBox::Empty => RegionError::Empty,
                NoBox::Unbounded => RegionError::Unbounded,
            })?,
        };
        if bounds.is_full() { Ok(bounds) } else { Err(RegionError::Bounds { bounds }) }
    }
}

/// Why the leaves in a box are not known.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OwnersError {
    /// The box is infinite, not a number, or not in order.
    #[error("a box has finite corners in order, and this one goes from {:?} to {:?}", bounds.low, bounds.high)]
    Bounds {
        /// What was given.
        bounds: Box3,
    },
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

impl Classified for OwnersError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Bounds { .. } => ErrorKind::Argument,
            Self::Eval(error) => error.kind(),
        }
    }
}

/// Points by coordinates, as kernels read them, and their fields.
#[derive(Default)]
struct SolidBatch {
    points: [Vec<f32>; 3],
    field: Vec<f32>,
}

impl SolidBatch {
    fn clear(&mut self) {
        self.points.iter_mut().for_each(Vec::clear);
    }

    fn push(&mut self, point: [f32; 3]) {
        for (plane, coordinate) in self.points.iter_mut().zip(point) {
            plane.push(coordinate);
        }
    }

    fn point(&self, index: usize) -> [f32; 3] {
        self.points.each_ref().map(|plane| plane[index])
    }

    /// The field at each point; all are in a region.
    fn values(&mut self, solid: &Solid, region: &Region) -> Result<&[f32], EvalError> {
        self.field.resize(self.points[0].len(), 0.0);
        let planes = self.points.each_ref().map(Vec::as_slice);
        solid.field.eval_region(region, planes, &mut [&mut self.field])?;
        Ok(&self.field)
    }

    /// Whether each point is inside; all are in a region.
    fn sides(&mut self, solid: &Solid, region: &Region) -> Result<Vec<bool>, EvalError> {
        Ok(self.values(solid, region)?.iter().map(|&field| field >= solid.iso).collect())
    }
}
