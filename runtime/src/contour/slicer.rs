//! A model that can be looked at in a plane, again and again.

use jbt_ir::memory::NoMemory;
use jbt_model::check::CheckedTree;
use jbt_model::diagnostic::Diagnostics;
use jbt_model::query::{AnswerKind, Query};
use thiserror::Error;

use super::grid::{Rectangle, RectangleError};
use super::plane::{Plane, PlaneKind, others};
use crate::boxes::Box3;
use crate::compiled::{Compiled, Task};
use crate::compiler::Compiler;
use crate::counter::Counters;
use crate::debug::brief_debug;
use crate::divide::Edit;
use crate::error::{Classified, CompileError, ErrorKind, EvalError, compiled_within_memory};
use crate::evaluator::Evaluator;
use crate::job::JobError;
use crate::kernel::Engine;
use crate::mesh::LatticeError;
use crate::progress::Cancelled;
use crate::prune::{PruneCounters, Pruner, Region};
use crate::support::MARGIN;

/// A compiled model and a plane: makes contours and images, any number of them, from any thread.
///
/// In a plane across a coordinate axis the answers have the bits of the model itself. For any other plane the
/// model is moved, so that the plane becomes z = 0: that is another model, whose last digits differ.
pub struct Slicer {
    plane: Plane,
    /// Where coordinates of points of the plane count from, in coordinates of the plane.
    origin: [f64; 2],
    view: PlaneView,
    /// Where the field may differ from zero, in coordinates of the plane from the origin.
    support: PlaneSupport,
    pub(super) iso: f32,
    pub(super) pruner: Pruner,
    pub(super) field: Evaluator,
    /// Field and attributes, if they were asked for.
    pub(super) full: Option<Evaluator>,
}

brief_debug!(Slicer, "Slicer", this: plane = this.plane, engine = this.field.engine());

/// The part of a plane in which the field may differ from zero.
#[derive(Clone, Copy, PartialEq, Debug)]
enum PlaneSupport {
    Empty,
    Unbounded,
    Rectangle([[f64; 2]; 2]),
}

/// Which coordinates of the compiled model are those of the plane.
#[derive(Clone, Copy, Debug)]
struct PlaneView {
    /// Along u and v.
    axes: [usize; 2],
    /// The value of the third one.
    at: f32,
}

/// Why there is no contour or image.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum SliceError {
    /// The model's field is zero everywhere, and no rectangle was given.
    #[error("the model is empty: its field is zero everywhere")]
    Empty,
    /// The model's field may differ from zero arbitrarily far away, and no rectangle was given.
    #[error("the model is unbounded: its slice needs a region")]
    Unbounded,
    /// The rectangle cannot be.
    #[error(transparent)]
    Rectangle(#[from] RectangleError),
    /// The lattice cannot be, or is beyond a limit.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The side of the smallest squares is no power of two, or beyond [`MAX_BLOCK`](super::MAX_BLOCK).
    #[error("the side of a block is a power of two up to {}, and {block} was asked for", super::MAX_BLOCK)]
    Block {
        /// What was asked for.
        block: usize,
    },
    /// The points of a pixel: none, or too many.
    #[error(
        "a pixel has from 1 x 1 to {0} x {0} points, and {samples} x {samples} were asked for",
        super::MAX_SAMPLES
    )]
    Samples {
        /// Along a side.
        samples: usize,
    },
    /// More points than [`MAX_PIXELS`](jbt_ir::limits::MAX_PIXELS).
    #[error("the image has more than {limit} points")]
    TooManyPixels {
        /// How many there may be.
        limit: usize,
    },
    /// More squares than [`MAX_SQUARES`](jbt_ir::limits::MAX_SQUARES) were left to be evaluated.
    #[error("the contour may pass through more than {limit} squares of the lattice")]
    TooManySquares {
        /// How many there may be.
        limit: u64,
    },
    /// More vertices than [`MAX_CONTOUR_VERTICES`](jbt_ir::limits::MAX_CONTOUR_VERTICES).
    #[error("the contour has more than {limit} vertices")]
    TooManyVertices {
        /// How many there may be.
        limit: u64,
    },
    /// There is no attribute of this name, or attributes were not asked for.
    #[error("there is no attribute `{name}`: there are {}", names.join(", "))]
    Attribute {
        /// What was asked for.
        name: String,
        /// What there is.
        names: Vec<String>,
    },
    /// The model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The field could not be evaluated.
    #[error("the field cannot be evaluated: {0}")]
    Eval(#[from] EvalError),
    /// The memory for the work is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// It was told to stop.
    #[error("the work was cancelled")]
    Cancelled,
}

impl JobError for SliceError {
    fn told(self) -> Self {
        if self.kind() == ErrorKind::Cancelled { Self::Cancelled } else { self }
    }
}

impl Classified for SliceError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Empty => ErrorKind::Model,
            Self::Unbounded => ErrorKind::Unbounded,
            Self::Block { .. } | Self::Samples { .. } | Self::Attribute { .. } => ErrorKind::Argument,
            Self::TooManyPixels { .. }
            | Self::TooManySquares { .. }
            | Self::TooManyVertices { .. }
            | Self::Memory(_) => ErrorKind::Limit,
            Self::Rectangle(error) => error.kind(),
            Self::Lattice(error) => error.kind(),
            Self::Compile(error) => error.kind(),
            Self::Eval(error) => error.kind(),
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}

impl From<Cancelled> for SliceError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl Slicer {
    /// A slicer for a model of which nothing else is asked: see [`of`](Self::of).
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn new(
        compiler: &Compiler,
        tree: &CheckedTree,
        plane: &Plane,
        query: Query,
    ) -> Result<Self, CompileError> {
        Self::of(&compiler.compile(tree), plane, query)
    }

    /// A slicer for a compiled model and a plane. With `attributes` in the query contours have them, and
    /// there are images of them; the gradient is never needed. For a plane that is not across an axis,
    /// another model is compiled.
    ///
    /// # Errors
    /// The model is beyond a limit, or the engine cannot be had.
    pub fn of(compiled: &Compiled, plane: &Plane, query: Query) -> Result<Self, CompileError> {
        compiled_within_memory(|| match plane.0 {
            PlaneKind::Across { .. } => Self::looking(compiled, plane, query),
            PlaneKind::Spanned { .. } => {
                let moved = compiled.compiler().compile(&compiled.tree().mapped(plane.rows()));
                Self::looking(&moved, plane, query)
            }
        })
    }

    /// A slicer for another model, usually an edited one, and the same plane: see [`Compiled::updated`]. The
    /// origin of coordinates stays.
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        let compiled = self.pruner.compiled();
        let query = if self.full.is_some() { Query::ATTRIBUTES } else { Query::FIELD };
        compiled_within_memory(|| {
            let updated = match self.plane.0 {
                PlaneKind::Across { .. } => compiled.updated(tree),
                PlaneKind::Spanned { .. } => compiled.updated(&tree.mapped(self.plane.rows())),
            };
            Self::looking(&updated, &self.plane, query)
        })
    }

    /// A slicer for a compiled model that has the plane across an axis.
    fn looking(compiled: &Compiled, plane: &Plane, query: Query) -> Result<Self, CompileError> {
        let (axes, across, at) = match plane.0 {
            PlaneKind::Across { axis, at } => (others(axis), axis, at),
            PlaneKind::Spanned { .. } => ([0, 1], 2, 0.0),
        };
        let tree = compiled.tree();
        let view = PlaneView { axes, at: tree.origin().rounded([at; 3])[across] };
        let has_attributes = query.contains(AnswerKind::Attributes);
        let asked = if has_attributes { Query::ATTRIBUTES } else { Query::FIELD };
        compiled.prepare(&Task::Slices(asked).needs())?;
        let full = has_attributes.then(|| compiled.regional(Query::ATTRIBUTES)).transpose()?;
        Ok(Self {
            plane: *plane,
            origin: view.axes.map(|axis| tree.origin().point()[axis]),
            view,
            support: support(tree, &view),
            iso: tree.iso() as f32,
            pruner: compiled.pruner()?,
            field: compiled.regional(Query::FIELD)?,
            full,
        })
    }

    /// The plane.
    #[must_use]
    pub fn plane(&self) -> &Plane {
        &self.plane
    }

    /// What runs the field.
    #[must_use]
    pub fn engine(&self) -> Engine {
        self.field.engine()
    }

    /// The rectangle of the plane that holds all of the model's support, and a little more.
    ///
    /// # Errors
    /// [`SliceError::Empty`] and [`SliceError::Unbounded`]: it needs a rectangle then.
    pub fn rectangle(&self) -> Result<Rectangle, SliceError> {
        match self.support {
            PlaneSupport::Empty => Err(SliceError::Empty),
            PlaneSupport::Unbounded => Err(SliceError::Unbounded),
            PlaneSupport::Rectangle([low, high]) => {
                let margin = MARGIN * (high[0] - low[0]).max(high[1] - low[1]);
                let local = Rectangle::new(low.map(|side| side - margin), high.map(|side| side + margin))?;
                Ok(local.moved(self.origin)?)
            }
        }
    }

    /// Where the coordinates of vertices and squares count from, in coordinates of the plane: 0 but for
    /// models that are far away.
    #[must_use]
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }

    /// A rectangle in coordinates from the origin.
    pub(super) fn local(&self, rectangle: &Rectangle) -> Result<Rectangle, RectangleError> {
        rectangle.moved(self.origin.map(|shift| -shift))
    }

    /// What was evaluated so far: ranges in squares, the field at points, and field and attributes at points.
    #[must_use]
    pub fn counters(&self) -> (PruneCounters, Counters, Counters) {
        let full = self.full.as_ref().map(Evaluator::counters).unwrap_or_default();
        (self.pruner.counters(), self.field.counters(), full)
    }

    /// The names and widths of the attributes that it answers.
    pub fn attributes(&self) -> impl Iterator<Item = (&str, usize)> {
        self.full.iter().flat_map(|full| full.layout().attributes().map(|(name, _, width)| (name, width)))
    }

    /// The first plane of an attribute among the answers, and its width.
    pub(super) fn attribute(&self, name: &str) -> Result<(&Evaluator, usize, usize), SliceError> {
        let found = self
            .full
            .as_ref()
            .and_then(|full| full.layout().attribute(name).map(|(plane, width)| (full, plane, width)));
        found.ok_or_else(|| SliceError::Attribute {
            name: name.to_owned(),
            names: self.attributes().map(|(name, _)| name.to_owned()).collect(),
        })
    }

    /// The flat box over a rectangle of the plane.
    pub(super) fn bounds(&self, [low, high]: [[f32; 2]; 2]) -> Box3 {
        let corner = |[u, v]: [f32; 2]| {
            let mut corner = [self.view.at; 3];
            (corner[self.view.axes[0]], corner[self.view.axes[1]]) = (u, v);
            corner
        };
        Box3::new(corner(low), corner(high))
    }

    /// The part of the plane in a box; `None` if the plane is beside the box.
    fn flat(&self, Box3 { low, high }: &Box3) -> Option<[[f32; 2]; 2]> {
        let across = 3 - self.view.axes[0] - self.view.axes[1];
        // A NaN meets everything.
        let is_beside = low[across] > self.view.at || high[across] < self.view.at;
        (!is_beside).then(|| [low, high].map(|corner| self.view.axes.map(|axis| corner[axis])))
    }

    /// The rectangles, in coordinates from the origin, in which the contour may differ from that of an
    /// earlier model; `None` if that is anywhere.
    pub(crate) fn edit(&self, before: &Self) -> Option<Vec<[[f32; 2]; 2]>> {
        if self.iso.to_bits() != before.iso.to_bits() || self.origin != before.origin {
            return None;
        }
        let (now, old) =
            (self.full.as_ref().unwrap_or(&self.field), before.full.as_ref().unwrap_or(&before.field));
        match now.edit(&self.pruner, (old, &before.pruner)) {
            Edit::Boxes(boxes) => Some(boxes.iter().filter_map(|bounds| self.flat(bounds)).collect()),
            Edit::Everywhere => None,
        }
    }

    /// Evaluates points of the plane in a region.
    pub(super) fn eval(
        &self,
        evaluator: &Evaluator,
        region: &Region,
        [u, v]: [&[f32]; 2],
        answers: &mut [&mut [f32]],
    ) -> Result<(), EvalError> {
        let across = vec![self.view.at; u.len()];
        let mut planes = [&across[..]; 3];
        (planes[self.view.axes[0]], planes[self.view.axes[1]]) = (u, v);
        evaluator.eval_region(region, planes, answers)
    }

    /// The field at points of the plane in a region.
    pub(super) fn values(
        &self,
        region: &Region,
        points: [&[f32]; 2],
        values: &mut Vec<f32>,
    ) -> Result<(), EvalError> {
        values.resize(points[0].len(), 0.0);
        self.eval(&self.field, region, points, &mut [values])
    }
}

/// The support in coordinates of the plane. Where the plane misses it, the field is zero, and the rectangle
/// is where the support would be seen.
fn support(tree: &CheckedTree, view: &PlaneView) -> PlaneSupport {
    let support = tree.local_support();
    if support.is_empty() {
        return PlaneSupport::Empty;
    }
    let [low, high] = [support.low(), support.high()].map(|corner| view.axes.map(|axis| corner[axis]));
    let is_finite = low.iter().chain(&high).all(|side| side.is_finite());
    if is_finite { PlaneSupport::Rectangle([low, high]) } else { PlaneSupport::Unbounded }
}
