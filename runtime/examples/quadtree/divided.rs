//! The same scene divided by jbt: blocks are halved where a range of the field says that the contour may be
//! in them.
//!
//! ```text
//! block:  wider than 16 cells, or no square      halve it; nothing is asked
//!         its range is all below 1/2, or none    stop: it is outside, or inside
//!         a single cell                          leaf
//!         any other                              halve it
//! then evaluate the corners of the leaves, each once, with the circles that reach its leaf
//! ```
//!
//! A range encloses every value that the field takes in the block, so no crossing cell can be missed,
//! whatever its size. A range costs an interval evaluation of each circle that reaches the block that was
//! halved. It says little where the block is large, and halves of squares are about to be halved again: so
//! only small squares are asked about, which saves a quarter of what asking everywhere costs.

use std::error::Error;

use jbt::build::point;
use jbt::divide::{Cell, Decision, Division, Limits, Outcome, divide};
use jbt::{Box3, Compiler, EvalError, Evaluator, Model, Points, Pruner, Query, Region, Tree};

use super::circles::{Circle, ISO};
use super::lattice::{Block, Lattice, Place, coordinate, crossing_cells, is_crossed, points};

/// Cells along a side of the largest squares whose ranges are asked for.
const LARGEST_ASKED: u32 = 16;

/// What the division finds, and what that took.
pub struct Divided {
    /// Blocks that were decided, the whole among them.
    pub decided: usize,
    /// Those that were not halved: they fill the whole.
    pub blocks: Vec<Block>,
    /// How often a block was halved at most to get to one of them.
    pub depth: u64,
    /// The cells in which the contour may be, by their ranges.
    pub leaves: usize,
    /// The cells that it crosses, in order.
    pub found: Vec<Place>,
    /// Crossing cells of the lattice that were not found, in order; all points were evaluated to find them.
    pub missed: Vec<Place>,
    /// Blocks for which a range was computed.
    pub ranges: u64,
    /// Ranges of circles that were computed for them.
    pub interval_evaluations: u64,
    /// Lattice points that were evaluated.
    pub evaluated: u64,
    /// How often a circle was, at these points.
    pub circle_evaluations: u64,
}

/// The circles as points of the plane z = 0, and the sum of their fields.
pub fn model(circles: &[Circle]) -> Model {
    let leaf = |circle: &Circle| point([circle.center[0], circle.center[1], 0.0], circle.radius);
    let root = Tree::sum(circles.iter().map(leaf));
    Model { iso: ISO.into(), ..Model::new(root) }
}

/// Divides the square.
///
/// # Errors
/// The model is not a good one, or cannot be compiled or evaluated.
pub fn run(compiler: &Compiler, circles: &[Circle]) -> Result<Divided, Box<dyn Error>> {
    let tree = model(circles).check()?;
    let compiled = compiler.compile(&tree);
    let (pruner, evaluator) = (compiled.pruner()?, compiled.evaluator(Query::FIELD)?);
    let division = divide(&pruner, bounds(&Block::WHOLE), Block::WHOLE, &Limits::default(), &decide)?;
    let asked = pruner.counters();
    let samples = corners(&evaluator, &division)?;
    let mut inside = samples.inside;
    let leaves = || division.leaves().map(|(node, _)| node.data);
    let mut found: Vec<Place> = leaves()
        .filter(|leaf| is_crossed(leaf, |corner| *inside.at(corner) == Some(true)))
        .map(|leaf| leaf.low)
        .collect();
    found.sort_unstable();
    let mut missed = all_crossing_cells(&evaluator)?;
    missed.retain(|cell| found.binary_search(cell).is_err());
    let ends = division.nodes().iter().filter(|node| node.outcome != Outcome::Split);
    Ok(Divided {
        decided: division.nodes().len(),
        blocks: ends.map(|node| node.data).collect(),
        depth: division.tally().depth as u64,
        leaves: leaves().count(),
        found,
        missed,
        ranges: asked.boxes,
        interval_evaluations: asked.interval_evaluations,
        evaluated: samples.evaluated,
        circle_evaluations: samples.circle_evaluations,
    })
}

fn bounds(block: &Block) -> Box3 {
    let [[left, right], [low, high]] = [block.extent(0), block.extent(1)].map(|ends| ends.map(exactly));
    Box3::new([left, low, 0.0], [right, high, 0.0])
}

/// A coordinate of the lattice, which f32 holds.
fn exactly(coordinate: f64) -> f32 {
    coordinate as f32
}

fn decide(cell: &Cell<'_, Pruner>, block: &Block) -> Result<Decision<Block>, EvalError> {
    let [width, height] = block.sides;
    if width == height && width <= LARGEST_ASKED {
        let iso = ISO as f32;
        let [low, high] = cell.range()?;
        if high < iso || low >= iso {
            return Ok(Decision::Stop);
        }
        if width == 1 {
            return Ok(Decision::Leaf);
        }
    }
    let axis = if width >= height { 0 } else { 1 };
    let data = block.halves(axis);
    Ok(Decision::Split { axis, at: exactly(data[1].extent(axis)[0]), data })
}

/// Which lattice points are inside, as far as they were evaluated.
struct Samples {
    inside: Lattice<Option<bool>>,
    evaluated: u64,
    circle_evaluations: u64,
}

/// Evaluates the corners of the leaves. The first leaf that has a corner owns it.
fn corners(evaluator: &Evaluator, division: &Division<Region, Block>) -> Result<Samples, EvalError> {
    let mut samples = Samples { inside: Lattice::filled(None), evaluated: 0, circle_evaluations: 0 };
    for (node, region) in division.leaves() {
        let mut owned: Vec<Place> = node.data.corners().into();
        owned.retain(|&corner| samples.inside.at(corner).is_none());
        let positions: Points = owned.iter().copied().map(position).collect();
        let mut values = vec![0.0; owned.len()];
        evaluator.eval_region(region, positions.planes(), &mut [&mut values])?;
        for (&corner, value) in owned.iter().zip(&values) {
            *samples.inside.at(corner) = Some(f64::from(*value) >= ISO);
        }
        samples.evaluated += owned.len() as u64;
        samples.circle_evaluations += owned.len() as u64 * evaluator.evaluations_in(region);
    }
    Ok(samples)
}

fn position(point: Place) -> [f32; 3] {
    let [x, y] = point.map(|index| exactly(coordinate(index)));
    [x, y, 0.0]
}

/// The crossing cells as the field at all lattice points has them.
fn all_crossing_cells(evaluator: &Evaluator) -> Result<Vec<Place>, EvalError> {
    let positions: Points = points().map(position).collect();
    let mut samples = evaluator.samples();
    evaluator.eval(&positions, &mut samples)?;
    let mut inside = Lattice::filled(false);
    for (point, &value) in points().zip(samples.field()) {
        *inside.at(point) = f64::from(value) >= ISO;
    }
    Ok(crossing_cells(|point| *inside.at(point)))
}
