//! The walk down: decide the parts of a box, then divide those that are split.

use std::error::Error;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::parallel::*;
use jbt_ir::memory::NoMemory;
use jbt_ir::watch;
use thiserror::Error;

use super::cell::{Cell, Siblings};
use super::decide::{Decide, Decision};
use super::node::{Division, DivisionNode, Outcome};
use crate::boxes::{Box3, Divisible, MAX_PARTS};
use crate::error::{Classified, ErrorKind, EvalError};
use crate::limits;

/// How far a division may go.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// How often a box may be split on the way to a part of it; at most [`limits::MAX_DIVISION_DEPTH`].
    pub depth: usize,
    /// Boxes that may be decided; at most [`limits::MAX_DIVISION_BOXES`].
    pub boxes: u64,
}

impl Limits {
    /// The stricter of these and the limits of the project.
    pub(super) fn capped(self) -> Self {
        let most = Self::default();
        Self { depth: self.depth.min(most.depth), boxes: self.boxes.min(most.boxes) }
    }
}

impl Default for Limits {
    /// As far as anything may go.
    fn default() -> Self {
        Self { depth: limits::MAX_DIVISION_DEPTH, boxes: limits::MAX_DIVISION_BOXES }
    }
}

/// Why a box was not divided. `E` is the error of the field.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DivideError<E: Error + 'static> {
    /// The box is infinite, not a number, or not in order.
    #[error("a box to divide has finite corners in order, and this one goes from {:?} to {:?}", bounds.low, bounds.high)]
    Bounds {
        /// What was given.
        bounds: Box3,
    },
    /// A place that is not strictly inside of its box along the axis, or an axis that is none.
    #[error("a box from {low} to {high} along axis {axis} cannot be split at {at}")]
    Place {
        /// What was given.
        axis: usize,
        /// What was given.
        at: f32,
        /// Where the box begins.
        low: f32,
        /// Where the box ends.
        high: f32,
    },
    /// The decider split too often.
    #[error("a box was split {depth} times and its part was to be split again: the limit of depth")]
    Depth {
        /// The limit.
        depth: usize,
    },
    /// The decider made too many boxes.
    #[error("the division has more than {boxes} boxes: the limit of boxes")]
    Boxes {
        /// The limit.
        boxes: u64,
    },
    /// The memory for the boxes is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// The field could not be evaluated, or the decider gave up.
    #[error("the field cannot be evaluated")]
    Field(#[source] E),
}

impl Classified for DivideError<EvalError> {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Bounds { .. } | Self::Place { .. } => ErrorKind::Argument,
            Self::Depth { .. } | Self::Boxes { .. } | Self::Memory(_) => ErrorKind::Limit,
            Self::Field(error) => error.kind(),
        }
    }
}

pub(super) type DivisionFailure<F> = DivideError<<F as Divisible>::Error>;

/// A subtree, to be appended to what comes before it.
pub(super) struct Subtree<R, D> {
    pub(super) nodes: Vec<DivisionNode<D>>,
    pub(super) regions: Vec<R>,
}

impl<R, D> Subtree<R, D> {
    const fn new() -> Self {
        Self { nodes: Vec::new(), regions: Vec::new() }
    }

    fn append(&mut self, mut other: Self) {
        watch::take_for(&self.nodes, other.nodes.len());
        self.nodes.append(&mut other.nodes);
        watch::take_for(&self.regions, other.regions.len());
        self.regions.append(&mut other.regions);
    }
}

/// What there was before an edit.
pub(super) trait Previous<R, D>: Sync {
    /// The subtree of a node that the edit does not touch, as it is now.
    fn untouched(&self, node: usize) -> Option<Subtree<R, D>>;

    /// The parts of a node, if they are these boxes with these data.
    fn parts(&self, node: usize, boxes: &[Box3], data: &[D]) -> Option<[usize; MAX_PARTS]>;
}

pub(super) struct DivisionRun<'a, F: Divisible, D> {
    pub(super) field: &'a F,
    pub(super) limits: Limits,
    pub(super) decide: &'a Decide<'a, F, D>,
    pub(super) boxes: AtomicU64,
    pub(super) previous: Option<&'a dyn Previous<F::Region, D>>,
}

/// Levels of boxes whose parts are divided in parallel: more tasks than any machine has threads.
const PARALLEL_DEPTH: usize = 12;

/// What a box keeps besides its place in the lists, and what is needed to decide it. An estimate: rows of
/// regions are counted by themselves.
const BOX_BYTES: usize = 256;

/// Boxes to be decided together: the parts of one.
struct Parts<D> {
    boxes: Vec<Box3>,
    data: Vec<D>,
    /// How often a box was split to get here.
    depth: usize,
    /// The nodes that they were before an edit.
    old: Option<[usize; MAX_PARTS]>,
}

/// A part once it is decided.
enum Decided<R, D> {
    Untouched(Subtree<R, D>),
    Node { node: DivisionNode<D>, region: Option<R>, split: Option<Parts<D>> },
}

impl<F: Divisible, D: Send + Sync> DivisionRun<'_, F, D> {
    /// Divides the whole box.
    pub(super) fn start(&self, bounds: Box3, data: D) -> Result<Division<F::Region, D>, DivisionFailure<F>> {
        if !bounds.is_proper() {
            return Err(DivideError::Bounds { bounds });
        }
        let region = self.field.region(bounds).map_err(DivideError::Field)?;
        let old = self.previous.map(|_| [0; MAX_PARTS]);
        let whole = Parts { boxes: vec![bounds], data: vec![data], depth: 0, old };
        let Subtree { nodes, regions } = self.parts(&region, whole)?;
        Ok(Division { nodes, regions, decisions: self.boxes.load(Ordering::Relaxed) })
    }

    /// The subtrees of all parts, one after the other.
    fn parts(
        &self,
        around: &F::Region,
        parts: Parts<D>,
    ) -> Result<Subtree<F::Region, D>, DivisionFailure<F>> {
        let depth = parts.depth;
        let decided = self.decide(around, parts)?;
        let subtrees: Vec<_> = if depth < PARALLEL_DEPTH {
            scatter(|watches| {
                let parts = decided.into_par_iter();
                parts.map(|part| watches.hold(|| self.subtree(part))).collect::<Result<_, _>>()
            })?
        } else {
            decided.into_iter().map(|part| self.subtree(part)).collect::<Result<_, _>>()?
        };
        let mut all = Subtree::new();
        for subtree in subtrees {
            all.append(subtree);
        }
        Ok(all)
    }

    fn subtree(&self, decided: Decided<F::Region, D>) -> Result<Subtree<F::Region, D>, DivisionFailure<F>> {
        match decided {
            Decided::Untouched(subtree) => Ok(subtree),
            Decided::Node { node, region, split: None } => {
                Ok(Subtree { nodes: vec![node], regions: region.into_iter().collect() })
            }
            Decided::Node { mut node, region, split: Some(parts) } => {
                let region = region.expect("a box that is split has a region");
                let mut below = self.parts(&region, parts)?;
                // At most MAX_DIVISION_BOXES.
                node.size = 1 + below.nodes.len() as u32;
                watch::take((1 + below.nodes.len()) * size_of::<DivisionNode<D>>());
                let mut subtree =
                    Subtree { nodes: Vec::with_capacity(1 + below.nodes.len()), regions: Vec::new() };
                subtree.nodes.push(node);
                subtree.nodes.append(&mut below.nodes);
                subtree.regions = below.regions;
                Ok(subtree)
            }
        }
    }

    /// Asks about every part that an edit touches, and finds the regions of those that go on.
    fn decide(
        &self,
        around: &F::Region,
        parts: Parts<D>,
    ) -> Result<Vec<Decided<F::Region, D>>, DivisionFailure<F>> {
        let Parts { boxes, data, depth, old } = parts;
        watch::take(BOX_BYTES * boxes.len());
        let siblings = Siblings::new(self.field, around, &boxes);
        let mut wanted = [false; MAX_PARTS];
        let mut decisions = Vec::with_capacity(boxes.len());
        for (part, data) in data.into_iter().enumerate() {
            let untouched = self.previous.zip(old).and_then(|(previous, old)| previous.untouched(old[part]));
            if let Some(subtree) = untouched {
                decisions.push(Err(subtree));
                continue;
            }
            if self.boxes.fetch_add(1, Ordering::Relaxed) >= self.limits.boxes {
                return Err(DivideError::Boxes { boxes: self.limits.boxes });
            }
            let cell = Cell { siblings: &siblings, part, depth };
            let decision = (self.decide)(&cell, &data).map_err(DivideError::Field)?;
            wanted[part] = !matches!(decision, Decision::Stop);
            decisions.push(Ok((data, decision)));
        }
        let ranges: Vec<_> = (0..boxes.len()).map(|part| siblings.known_range(part)).collect();
        let mut regions =
            siblings.into_regions(&wanted[..boxes.len()]).map_err(DivideError::Field)?.into_iter();
        let mut decided = Vec::with_capacity(boxes.len());
        for (part, decision) in decisions.into_iter().enumerate() {
            let (data, decision) = match decision {
                Ok(decision) => decision,
                Err(subtree) => {
                    decided.push(Decided::Untouched(subtree));
                    continue;
                }
            };
            let region = if wanted[part] { regions.next() } else { None };
            let bounds = boxes[part];
            let (outcome, split) = match decision {
                Decision::Stop => (Outcome::Stop, None),
                Decision::Leaf => (Outcome::Leaf, None),
                Decision::Split { .. } | Decision::Octants { .. } => {
                    (Outcome::Split, Some(self.split(&bounds, depth, decision, old.map(|old| old[part]))?))
                }
            };
            let node =
                DivisionNode { bounds, range: ranges[part], data, outcome, depth: depth as u16, size: 1 };
            decided.push(Decided::Node { node, region, split });
        }
        Ok(decided)
    }

    /// The parts of a box.
    fn split(
        &self,
        bounds: &Box3,
        depth: usize,
        decision: Decision<D>,
        old: Option<usize>,
    ) -> Result<Parts<D>, DivisionFailure<F>> {
        if depth >= self.limits.depth {
            return Err(DivideError::Depth { depth: self.limits.depth });
        }
        let (boxes, data): (Vec<Box3>, Vec<D>) = match decision {
            Decision::Split { axis, at, data } => {
                check_place(bounds, axis, at)?;
                let (mut below, mut above) = (*bounds, *bounds);
                below.high[axis] = at;
                above.low[axis] = at;
                (vec![below, above], data.into())
            }
            Decision::Octants { at, data } => {
                for (axis, &at) in at.iter().enumerate() {
                    check_place(bounds, axis, at)?;
                }
                ((0..8).map(|octant| octant_of(bounds, at, octant)).collect(), data.into())
            }
            Decision::Leaf | Decision::Stop => unreachable!("only splits have parts"),
        };
        let old = self.previous.zip(old).and_then(|(previous, old)| previous.parts(old, &boxes, &data));
        Ok(Parts { boxes, data, depth: depth + 1, old })
    }
}

/// One of the eight parts around a point: bit 0 is x, bit 1 y, bit 2 z; a one is above.
fn octant_of(bounds: &Box3, at: [f32; 3], octant: usize) -> Box3 {
    let mut part = *bounds;
    for (axis, &at) in at.iter().enumerate() {
        let side = if octant >> axis & 1 == 1 { &mut part.low } else { &mut part.high };
        side[axis] = at;
    }
    part
}

fn check_place<E: Error>(bounds: &Box3, axis: usize, at: f32) -> Result<(), DivideError<E>> {
    let [low, high] = if axis < 3 { [bounds.low[axis], bounds.high[axis]] } else { [f32::NAN; 2] };
    if low < at && at < high { Ok(()) } else { Err(DivideError::Place { axis, at, low, high }) }
}
