//! Rays: their hits with the surface of a model. No stretch that is longer than a tolerance is missed.
//!
//! A *hit* is a change of side along a ray, from `field < iso` to `field >= iso` or back. The side is
//! computed at places of the ray that are no farther apart than the tolerance. So a longer stretch inside or
//! outside holds one of them, and its ends are found:
//!
//! ```text
//! outside  ------+            +------------------+    +------          shorter than the tolerance: this dent may be missed
//! inside         +------------+                  +-..-+
//! places   |  |  |  |  |  |  |  |  |  |  |  |  |  |  |  |  |          no farther apart than the tolerance
//!                ^            ^
//! ```
//!
//! Only every 16th place, a coarse place, is evaluated at first. A stretch between two coarse places on one
//! side is shorter than 16 tolerances, if it exists at all: ranges of short boxes prove that there is none,
//! and where they cannot, the places between are evaluated. So a tolerance much finer than the model's
//! details costs little more, and a sheet, a rod or a speck is found if it is as thick along the ray as the
//! tolerance.
//!
//! Most places are never evaluated: ranges of the field ([`Divisible`](crate::boxes::Divisible)) prove for
//! whole boxes that all places are on one side. The result is, to the bit, the result of evaluating all
//! places. All of this is about the field that the kernels compute in f32, at positions rounded to f32:
//! between the ends of a part of a ray each coordinate stays between the coordinates of the ends, rounding
//! included, so the box of the ends holds all positions between them.
//!
//! * Between two places on different sides the change is found by false position, to 1/1024 of the tolerance
//!   or the next f32. If there are three changes, one of them is found.
//! * Packets are faster than single rays: neighbouring rays share boxes, rows and calls. In any packet, each
//!   ray gets the same bits as alone. Neighbouring rays should be adjacent in the packet, as in the tiles of
//!   a picture.
//! * All answers about a hit come from one evaluation at its position.
//! * Rays are in the world, in f64; the f32 positions of hits are relative to the model's origin
//!   ([`jbt_model::origin`]), which is 0 for most models.

mod batch;
mod beam;
mod error;
mod found;
mod hits;
mod packet;
mod polish;
mod ray;
mod refine;
mod target;

pub use error::TraceError;
pub use hits::{Blocked, Hit, Hits};
pub use jbt_model::owner::Owner;
pub use ray::Ray;

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use jbt_ir::limits::MAX_PACKET_RAYS;
use jbt_ir::watch;
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::owner;
use jbt_model::query::Query;

use crate::boxes::{Box3, Divisible as _};
use crate::buffer::Layout;
use crate::compiled::{Compiled, Task};
use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::error::{CompileError, EvalError, compiled_within_memory, within_memory};
use crate::evaluator::Evaluator;
use crate::prune::Region;

use found::FoundHits;
use packet::{PacketTrace, Want};
use ray::{RayLine, RayReach, STRIDE};
use target::Target;

/// A model, compiled for rays.
///
/// It is `Send + Sync`: threads may share it and ask at once.
///
/// ```
/// use jbt::trace::{Ray, Tracer};
/// use jbt::{Compiler, Query};
/// # let tree = jbt::text::parse(b"jbt 1 color (1 0 0) { point { surface_radius 1 } }", &Default::default()).unwrap().check().unwrap();
/// let tracer = Tracer::new(&Compiler::new(), &tree, Query::ALL).unwrap();
/// let ray = Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0], span: [0.0, 10.0] };
/// let hit = tracer.first(&ray, 0.01).unwrap().expect("the ball is there");
/// assert!(hit.entering && (hit.t - 4.0).abs() < 1e-4);
/// assert_eq!(hit.normal(), Some([0.0, 0.0, 1.0]));
/// assert_eq!(hit.color(), Some([1.0, 0.0, 0.0]));
/// // In and out, each within a thousandth of the tolerance.
/// assert_eq!(tracer.all(&ray, 0.01).unwrap().len(), 2);
/// assert!(!tracer.any(&Ray { span: [0.0, 3.9], ..ray }, 0.01).unwrap());
/// ```
pub struct Tracer {
    compiled: Compiled,
    target: Target,
    rays: AtomicU64,
    hits: AtomicU64,
}

brief_debug!(Tracer, "Tracer", this: engine = this.target.field.engine(), counters = this.counters());

/// What is kept for a ray: its line, which may be sorted, its answers, its place in a cell. An estimate.
const RAY_BYTES: usize = 2 * size_of::<RayLine>() + 32;

/// The work of a tracer so far. A snapshot: see [`Tracer::counters`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TraceCounters {
    /// Rays that were given.
    pub rays: u64,
    /// Hits that were returned.
    pub hits: u64,
    /// Boxes for which a range was computed.
    pub boxes: u64,
    /// Interval evaluations of distances to skeletons for these boxes.
    pub interval_evaluations: u64,
    /// Points that were evaluated: the field along rays, everything at hits.
    pub points: u64,
    /// Evaluations of distances to skeletons at these points.
    pub primitive_evaluations: u64,
}

impl Tracer {
    /// A tracer for a model of which nothing else is asked: see [`of`](Self::of).
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn new(compiler: &Compiler, tree: &CheckedTree, query: Query) -> Result<Self, CompileError> {
        Self::of(&compiler.compile(tree), query)
    }

    /// A tracer for a compiled model. The query is what is told about hits.
    ///
    /// # Errors
    /// The model is beyond a limit, or the engine cannot be had.
    pub fn of(compiled: &Compiled, query: Query) -> Result<Self, CompileError> {
        compiled.prepare(&Task::Rays(query).needs())?;
        let (pruner, field) = (compiled.pruner()?, compiled.regional(Query::FIELD)?);
        let full = (query != Query::FIELD).then(|| compiled.regional(query)).transpose()?;
        let tree = compiled.tree();
        let target = Target {
            iso: tree.iso() as f32,
            origin: tree.origin(),
            reach: RayReach::new(tree.local_support()),
            layout: Arc::new(full.as_ref().unwrap_or(&field).layout().clone()),
            pruner,
            field,
            full,
        };
        Ok(Self { compiled: compiled.clone(), target, rays: AtomicU64::new(0), hits: AtomicU64::new(0) })
    }

    /// A tracer for another model, usually an edited one: see [`Compiled::updated`].
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        let query = self.target.full().query();
        compiled_within_memory(|| Self::of(&self.compiled.updated(tree), query))
    }

    /// The compiled model.
    #[must_use]
    pub fn compiled(&self) -> &Compiled {
        &self.compiled
    }

    /// The model.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        self.compiled.tree()
    }

    /// The layout of the samples of hits.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.target.layout
    }

    /// The iso-value in f32, as kernels compare with it.
    #[must_use]
    pub fn iso(&self) -> f32 {
        self.target.iso
    }

    /// The first hit of a ray. A ray that begins inside hits the surface where it leaves.
    ///
    /// The tolerance is a length in space: no longer stretch is missed. Cost: away from the surface it grows
    /// with the logarithm of length by tolerance.
    ///
    /// # Errors
    /// See [`TraceError`].
    pub fn first(&self, ray: &Ray, tolerance: f64) -> Result<Option<Hit>, TraceError> {
        let hits = self.first_of(std::slice::from_ref(ray), tolerance)?;
        Ok((!hits.is_empty()).then(|| hits.get(0, &self.target.layout)))
    }

    /// All hits of a ray, by t.
    ///
    /// # Errors
    /// See [`TraceError`].
    pub fn all(&self, ray: &Ray, tolerance: f64) -> Result<Vec<Hit>, TraceError> {
        let hits = self.all_of(std::slice::from_ref(ray), tolerance)?;
        Ok((0..hits.len()).map(|index| hits.get(index, &self.target.layout)).collect())
    }

    /// Whether a ray has a hit. The hit itself is neither located nor evaluated.
    ///
    /// # Errors
    /// See [`TraceError`].
    pub fn any(&self, ray: &Ray, tolerance: f64) -> Result<bool, TraceError> {
        Ok(self.any_of(std::slice::from_ref(ray), tolerance)?.blocked[0])
    }

    /// The first hit of each ray, or none: see [`first`](Self::first).
    ///
    /// # Errors
    /// See [`TraceError`].
    pub fn first_of(&self, rays: &[Ray], tolerance: f64) -> Result<Hits, TraceError> {
        within_memory(|| self.hits(Want::First, STRIDE, &self.localized(rays), tolerance))
    }

    /// As [`first_of`](Self::first_of), for rays relative to the model's origin, with `stride` tolerances, 1
    /// to [`STRIDE`], from one coarse place to the next.
    pub(crate) fn first_of_local(
        &self,
        rays: &[Ray],
        tolerance: f64,
        stride: i64,
    ) -> Result<Hits, TraceError> {
        self.hits(Want::First, stride, rays, tolerance)
    }

    /// All hits of each ray.
    ///
    /// # Errors
    /// See [`TraceError`].
    pub fn all_of(&self, rays: &[Ray], tolerance: f64) -> Result<Hits, TraceError> {
        within_memory(|| self.hits(Want::All, STRIDE, &self.localized(rays), tolerance))
    }

    /// Whether each ray has a hit.
    ///
    /// # Errors
    /// See [`TraceError`].
    pub fn any_of(&self, rays: &[Ray], tolerance: f64) -> Result<Blocked, TraceError> {
        within_memory(|| self.blocked(STRIDE, &self.localized(rays), tolerance))
    }

    /// As [`any_of`](Self::any_of), for rays relative to the model's origin, with a tolerance about as long
    /// as the shortest stretch that matters.
    pub(crate) fn any_of_local(&self, rays: &[Ray], tolerance: f64) -> Result<Blocked, TraceError> {
        self.blocked(1, rays, tolerance)
    }

    /// The work so far.
    #[must_use]
    pub fn counters(&self) -> TraceCounters {
        let boxes = self.target.pruner.counters();
        let points = self.target.field.counters();
        let hits = self.target.full.as_ref().map(Evaluator::counters).unwrap_or_default();
        TraceCounters {
            rays: self.rays.load(Ordering::Relaxed),
            hits: self.hits.load(Ordering::Relaxed),
            boxes: boxes.boxes,
            interval_evaluations: boxes.interval_evaluations,
            points: points.points + hits.points,
            primitive_evaluations: points.primitive_evaluations + hits.primitive_evaluations,
        }
    }

    /// The leaf that decides at a position, and the path to it: see [`jbt_model::owner`]. The position is
    /// relative to the model's origin, as the positions of hits are.
    ///
    /// `None` where the field is 0, or negative because no positive field is left: never at hits. Cost: a
    /// plain walk over all paths of the tree.
    #[must_use]
    pub fn owner(&self, position: [f32; 3]) -> Option<Owner> {
        owner::owner(self.tree(), self.tree().origin().world(position.map(f64::from)))
    }

    /// The part of the model at a hit: its place among the [parts](CheckedTree::parts), or nothing if the
    /// model is one solid.
    #[must_use]
    pub fn part(&self, position: [f32; 3]) -> Option<usize> {
        if self.tree().parts().is_empty() {
            return None;
        }
        Some(self.owner(position)?.above.first()?.1 as usize)
    }

    /// The leaf that decides at a position: the leaf of [`owner`](Self::owner). If only one leaf matters at
    /// the position, no walk is needed.
    ///
    /// # Errors
    /// Those of the evaluation.
    pub fn leaf(&self, position: [f32; 3]) -> Result<Option<NodeId>, EvalError> {
        let here = Box3::new(position, position);
        if here.is_proper() {
            let leaves = within_memory(|| {
                Ok::<_, EvalError>(self.target.field.leaves_in(&self.target.pruner.region(here)?))
            })?;
            if let [leaf] = leaves.as_slice() {
                return Ok(Some(*leaf));
            }
        }
        Ok(self.owner(position).map(|owner| owner.node))
    }

    /// The field at points near each other, relative to the model's origin, and the region around them.
    /// `None` without points, or if a point is not finite.
    pub(crate) fn fields(&self, points: &[[f32; 3]]) -> Result<Option<(Region, Vec<f32>)>, EvalError> {
        let Some(bounds) = Box3::around(points) else { return Ok(None) };
        let region = self.target.pruner.region(bounds)?;
        let mut field = vec![0.0; points.len()];
        let planes = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f32>>());
        self.target.field.eval_region(&region, planes.each_ref().map(Vec::as_slice), &mut [&mut field])?;
        Ok(Some((region, field)))
    }

    /// The number of distances to skeletons for the field at a point of a region.
    pub(crate) fn evaluations_in(&self, region: &Region) -> u64 {
        self.target.field.evaluations_in(region)
    }

    /// The rays relative to the model's origin.
    fn localized<'a>(&self, rays: &'a [Ray]) -> Cow<'a, [Ray]> {
        let origin = self.tree().origin();
        if origin.is_world() {
            return Cow::Borrowed(rays);
        }
        watch::take(size_of_val(rays));
        rays.iter().map(|ray| Ray { origin: origin.local(ray.origin), ..*ray }).collect()
    }

    fn blocked(&self, stride: i64, rays: &[Ray], tolerance: f64) -> Result<Blocked, TraceError> {
        let found = self.follow(Want::Any, stride, rays, tolerance)?;
        Ok(Blocked { blocked: found.blocked, evaluations: found.evaluations })
    }

    fn hits(&self, want: Want, stride: i64, rays: &[Ray], tolerance: f64) -> Result<Hits, TraceError> {
        let hits = self.follow(want, stride, rays, tolerance)?.into_hits(&self.target);
        self.hits.fetch_add(hits.len() as u64, Ordering::Relaxed);
        Ok(hits)
    }

    fn follow(&self, want: Want, stride: i64, rays: &[Ray], tolerance: f64) -> Result<FoundHits, TraceError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(TraceError::Tolerance { tolerance });
        }
        if rays.len() > MAX_PACKET_RAYS {
            return Err(TraceError::Rays { rays: rays.len() });
        }
        self.rays.fetch_add(rays.len() as u64, Ordering::Relaxed);
        watch::take(rays.len() * RAY_BYTES);
        let mut lines = Vec::with_capacity(rays.len());
        for (index, ray) in rays.iter().enumerate() {
            lines.extend(RayLine::new(index, ray, tolerance, stride, self.target.reach.as_ref())?);
        }
        PacketTrace::new(&self.target, (want, stride), tolerance, rays.len(), lines).finish()
    }
}
