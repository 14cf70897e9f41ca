//! Recursive division of a box: what is asked where, is decided where it is asked.
//!
//! ```text
//! divide(box, decide):    decide(box) = split   divide the parts, each with the rows that reach it
//!                                       leaf    somebody wants to look at this box: its region is kept
//!                                       stop    nobody does
//! +-------------+------+--+--+
//! |             |      |  |  |
//! |    stop     | stop +--+--+        sampling, meshing, measuring, tracing are deciders;
//! |             |      |  |//|        users write theirs
//! |             +------+--+--+
//! |             |      |//|//|
//! +-------------+------+--+--+
//! ```
//!
//! After Bowyer's svLis (1999), where a decision procedure divides a set-theoretic model. A decision sees the
//! box, a range of the field, and how much of the model is left there; both are found when they are asked
//! for, and not before. Parts are in a fixed order (x fastest, then y, then z), so a division is the same for
//! every number of threads, and its leaves are in the order of a walk down the tree.
//!
//! After an edit, [`Division::redivide`] asks again only where rows or numbers have changed.

mod cell;
mod decide;
mod edit;
mod node;
mod ray;
mod run;

pub use cell::Cell;
pub use decide::{Decide, Decision};
pub use edit::Edit;
pub use node::{Division, DivisionNode, Outcome, Tally};
pub use ray::Passage;
pub use run::{DivideError, Limits};

use std::sync::atomic::AtomicU64;

use jbt_ir::watch;
use run::DivisionRun;

use crate::boxes::{Box3, Divisible};

/// Divides a box.
///
/// `decide` is asked once for each box, on the threads of the rayon pool in which this is called. If it
/// depends on the cell and the data alone, so does the division.
///
/// ```
/// use jbt::divide::{Decision, Limits, divide};
/// use jbt::{Box3, Pruner};
/// # let tree = jbt::text::parse(b"jbt 1 point { radius 2 }", &Default::default()).unwrap().check().unwrap();
/// let pruner = Pruner::new(&jbt::Compiler::new(), &tree).unwrap();
/// // Halve along the longest side, down to a quarter, where the surface may be.
/// let halves = divide(&pruner, Box3::new([-2.0; 3], [2.0; 3]), (), &Limits::default(), &|cell, ()| {
///     let bounds = cell.bounds();
///     let [low, high] = cell.range()?;
///     if high < 0.5 || low >= 0.5 {
///         return Ok(Decision::Stop);
///     }
///     if bounds.longest_side() <= 0.25 {
///         return Ok(Decision::Leaf);
///     }
///     let side = |axis: &usize| bounds.high[*axis] - bounds.low[*axis];
///     let axis = (0..3).max_by(|a, b| side(a).total_cmp(&side(b))).unwrap();
///     Ok(Decision::Split { axis, at: bounds.middle(axis), data: [(), ()] })
/// })
/// .unwrap();
/// assert!(halves.leaves().all(|(node, _)| node.range.unwrap()[0] < 0.5));
/// ```
///
/// Where there is no memory, the stack is unwound through `decide`: what it locks then is poisoned.
///
/// # Errors
/// A box that is not finite or not in order; a place that is not strictly inside its box; more boxes or depth
/// than the limits allow, which is what becomes of a decider that never stops; want of memory; and whatever
/// the field or the decider report.
pub fn divide<F: Divisible, D: Send + Sync>(
    field: &F,
    bounds: Box3,
    data: D,
    limits: &Limits,
    decide: &Decide<'_, F, D>,
) -> Result<Division<F::Region, D>, DivideError<F::Error>> {
    let run =
        DivisionRun { field, limits: limits.capped(), decide, boxes: AtomicU64::new(0), previous: None };
    watch::guarded_once(|| run.start(bounds, data)).unwrap_or_else(|error| Err(error.into()))
}
