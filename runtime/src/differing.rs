//! Where the fields of two models differ: boxes outside of which they are proven equal, and what is known
//! about each.
//!
//! ```text
//! d = a model that is 0 where both fields are equal            (jbt::text::field_difference)
//! cut the largest box; parts in which d is proven 0 are left out
//! boxes that touch are one place; its points are asked for both fields
//! ```

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use jbt_ir::watch;
use jbt_model::bounds::Bounds;
use jbt_model::check::CheckedTree;
use jbt_model::diagnostic::Diagnostics;
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_text::field_difference;

use crate::boxes::{Box3, Divisible as _, Range};
use crate::compiled::Compiled;
use crate::compiler::Compiler;
use crate::error::{Classified, CompileError, ErrorKind, EvalError, within_memory};
use crate::ordered::ordered;
use crate::points::Points;
use crate::prune::{Pruner, Region};
use crate::support::MARGIN;
use crate::union_find::root;

/// Boxes that are cut at most, and that are left.
const MAX_BOXES: usize = 1 << 13;

/// Fields that are nearer to each other than this part of their size, plus it, are the same: the last digits
/// depend on the order of sums, and on where a model has its origin.
const TOLERANCE: f32 = 1e-6;

/// A box in which two fields may differ.
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub struct DifferingPlace {
    /// The box, in the world.
    pub bounds: Box3<f64>,
    /// Of the points that were asked, that at which the fields differ most, in the world.
    pub at: [f64; 3],
    /// By how much they differ there; 0 if no point was found at which they differ by more than rounding.
    pub most: f32,
}

/// Why fields were not compared.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DifferingError {
    /// The fields may differ arbitrarily far away, and no region was given.
    #[error("the fields may differ arbitrarily far away: the comparison needs a region")]
    Unbounded,
    /// A model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

impl Classified for DifferingError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unbounded => ErrorKind::Unbounded,
            Self::Compile(error) => error.kind(),
            Self::Eval(error) => error.kind(),
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        match self {
            Self::Compile(error) => error.diagnostics(),
            Self::Unbounded | Self::Eval(_) => None,
        }
    }
}

/// The places at which the fields of two models may differ, those first at which they differ most. Outside of
/// them, in the region (all of space without one), both fields are proven equal, but for the last digits of
/// sums in another order.
///
/// ```
/// use jbt::build::point;
/// use jbt::{Compiler, Model, differing::differing_places};
/// let ball = |at: [f64; 3]| point(at, 1.0);
/// let [a, b] = [&[[0.0; 3]][..], &[[0.0; 3], [0.0, 0.0, 5.0], [9.0, 0.0, 0.0]]]
///     .map(|all| Model::new(jbt::Tree::union(all.iter().map(|&at| ball(at)))).check().unwrap());
/// let found = differing_places(&Compiler::new(), [&a, &b], None)?;
/// assert_eq!(found.len(), 2);
/// assert!(found.iter().all(|place| place.most > 0.5));
/// # Ok::<(), jbt::differing::DifferingError>(())
/// ```
///
/// Cost: at most 8,192 boxes are cut, and nine points asked in each that is left; both are few where few
/// subtrees differ.
///
/// # Errors
/// See [`DifferingError`].
pub fn differing_places(
    compiler: &Compiler,
    models: [&CheckedTree; 2],
    region: Option<Box3<f64>>,
) -> Result<Vec<DifferingPlace>, DifferingError> {
    within_memory(|| differing_in(compiler, models, region))
}

fn differing_in(
    compiler: &Compiler,
    models: [&CheckedTree; 2],
    region: Option<Box3<f64>>,
) -> Result<Vec<DifferingPlace>, DifferingError> {
    let [first, second] = models;
    let mut whole = first.support().hull(second.support());
    if let Some(Box3 { low, high }) = region {
        whole = whole.intersection(Bounds::new(low.into(), high.into()));
    }
    let exact = field_difference(first, second).and_then(|model| model.check().ok());
    let exact = exact.map(|tree| compiler.compile(&tree));
    let (compiled, pruner) = match exact.map(|compiled| (compiled.pruner(), compiled)) {
        Some((Ok(pruner), compiled)) => (compiled, pruner),
        Some((Err(error @ (CompileError::Memory(_) | CompileError::Cancelled)), _)) => {
            return Err(error.into());
        }
        // Of what is too large for a difference, nothing but its size is known.
        Some((Err(_), _)) | None => {
            let compiled = compiler.compile(&anywhere(whole));
            let pruner = compiled.pruner()?;
            (compiled, pruner)
        }
    };
    let bounds = whole.intersection(compiled.tree().support());
    if bounds.is_empty() {
        return Ok(Vec::new());
    }
    if !bounds.is_finite() {
        return Err(DifferingError::Unbounded);
    }
    let open = open_boxes(&pruner, around(&compiled, bounds))?;
    let apart = apart(compiler, models, &compiled, &open)?;
    Ok(places(&compiled, &open, &apart))
}

/// A model that is 0 nowhere in a box.
fn anywhere(whole: Bounds) -> CheckedTree {
    let root = if whole.is_empty() {
        Tree::empty()
    } else if whole.is_finite() {
        Tree::expression_within(1.0, whole.low(), whole.high())
    } else {
        Tree::expression(1.0)
    };
    Model::new(root).check().expect("a number in a box is a model")
}

/// A box about the origin of a model, and a little more, which has a volume.
fn around(compiled: &Compiled, bounds: Bounds) -> Box3 {
    let local = compiled.tree().origin().local_bounds(bounds);
    let grown = local.grown((local.longest_side() * MARGIN).max(f64::from(f32::MIN_POSITIVE)));
    let [low, high] = [grown.low(), grown.high()];
    Box3::new(low.map(|side| (side as f32).next_down()), high.map(|side| (side as f32).next_up()))
}

/// A box in which the fields may differ.
struct DifferingBox {
    bounds: Box3,
    region: Region,
    number: usize,
}

impl Ord for DifferingBox {
    /// The largest is the greatest; of equals the one that was found first.
    fn cmp(&self, other: &Self) -> Ordering {
        let sides = self.bounds.longest_side().total_cmp(&other.bounds.longest_side());
        sides.then(other.number.cmp(&self.number))
    }
}

ordered! { DifferingBox }

/// Boxes in which a model is not proven 0, in the order in which they were found.
fn open_boxes(pruner: &Pruner, whole: Box3) -> Result<Vec<Box3>, EvalError> {
    let mut open =
        BinaryHeap::from([DifferingBox { bounds: whole, region: pruner.region(whole)?, number: 0 }]);
    let mut smallest = Vec::new();
    let mut count = 0;
    for _ in 0..MAX_BOXES {
        if open.len() + smallest.len() >= MAX_BOXES {
            break;
        }
        let Some(DifferingBox { bounds, region, number }) = open.pop() else { break };
        watch::go_on()?;
        let parts = bounds.halved();
        if parts.len() == 1 {
            smallest.push((number, bounds));
            continue;
        }
        let (mut left, mut regions) = (Vec::new(), Vec::new());
        let mut wants = |part: usize, [_, high]: Range| {
            let may_differ = high > 0.0;
            left.extend(may_differ.then_some(parts[part]));
            may_differ
        };
        pruner.split(&region, &parts, &mut wants, &mut regions)?;
        for (bounds, region) in left.into_iter().zip(regions) {
            count += 1;
            open.push(DifferingBox { bounds, region, number: count });
        }
    }
    smallest.extend(open.into_vec().into_iter().map(|one| (one.number, one.bounds)));
    smallest.sort_unstable_by_key(|&(number, _)| number);
    Ok(smallest.into_iter().map(|(_, bounds)| bounds).collect())
}

/// Points that are asked in a box: its middle, and those of its eighths.
const ASKED: usize = 9;

/// The points of a box, about the origin of the difference.
fn asked(bounds: &Box3) -> [[f32; 3]; ASKED] {
    let at = |axis: usize, part: f32| bounds.low[axis] + (bounds.high[axis] - bounds.low[axis]) * part;
    std::array::from_fn(|index| {
        let part = |axis: usize| if index == 0 { 0.5 } else { 0.25 + 0.5 * ((index - 1) >> axis & 1) as f32 };
        [0, 1, 2].map(|axis| at(axis, part(axis)))
    })
}

/// How far apart the fields are at each point of each box; 0 for what is rounding.
fn apart(
    compiler: &Compiler,
    models: [&CheckedTree; 2],
    difference: &Compiled,
    open: &[Box3],
) -> Result<Vec<f32>, DifferingError> {
    let origin = difference.tree().origin();
    let mut fields = Vec::new();
    for tree in models {
        let evaluator = compiler.compile(tree).evaluator(Query::FIELD)?;
        let mut points: Points = evaluator.points();
        for point in open.iter().flat_map(asked) {
            points.push_world(origin.world(point.map(f64::from)));
        }
        let mut samples = evaluator.samples();
        evaluator.par_eval(&points, &mut samples)?;
        fields.push(samples.field().to_vec());
    }
    let apart = |(&a, &b): (&f32, &f32)| {
        let apart = (a - b).abs();
        if apart > TOLERANCE * (1.0 + a.abs().max(b.abs())) { apart } else { 0.0 }
    };
    Ok(fields[0].iter().zip(&fields[1]).map(apart).collect())
}

/// Boxes that touch as one place each.
fn places(difference: &Compiled, open: &[Box3], apart: &[f32]) -> Vec<DifferingPlace> {
    let origin = difference.tree().origin();
    let mut found: Vec<Option<(Box3, [f32; 3], f32)>> = vec![None; open.len()];
    for ((bounds, apart), cluster) in open.iter().zip(apart.chunks(ASKED)).zip(clusters(open)) {
        let place = found[cluster].get_or_insert((*bounds, asked(bounds)[0], 0.0));
        place.0 = place.0.joined(bounds);
        for (point, &apart) in asked(bounds).into_iter().zip(apart) {
            if apart > place.2 {
                (place.1, place.2) = (point, apart);
            }
        }
    }
    let place = |(bounds, at, most): (Box3, [f32; 3], f32)| DifferingPlace {
        bounds: bounds.map(|corner| origin.world(corner.map(f64::from))),
        at: origin.world(at.map(f64::from)),
        most,
    };
    let mut places: Vec<DifferingPlace> = found.into_iter().flatten().map(place).collect();
    // It is stable: of equals the one that was found first.
    places.sort_by(|a, b| b.most.total_cmp(&a.most));
    places
}

/// For each box the first of those that it touches, or that touch one that it touches, and so on.
fn clusters(boxes: &[Box3]) -> Vec<usize> {
    let mut parents: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[a].low[0].total_cmp(&boxes[b].low[0]));
    // Boxes that reach as far as the one that the sweep is at.
    let mut reached: Vec<usize> = Vec::new();
    for at in order {
        reached.retain(|&one| boxes[one].high[0] >= boxes[at].low[0]);
        for &one in reached.iter().filter(|&&one| boxes[one].meets(&boxes[at])) {
            let [a, b] = [one, at].map(|one| root(&mut parents, one as u32));
            parents[a.max(b) as usize] = a.min(b);
        }
        reached.push(at);
    }
    (0..boxes.len() as u32).map(|one| root(&mut parents, one) as usize).collect()
}
