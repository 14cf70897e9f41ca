//! Measures: volume, area and centre of mass of a solid, by division of a box, and what the division is like.
//!
//! ```text
//! +-------+---+---+      solid     every point is inside:  its volume counts
//! |  air  |   |s /|      air       no point is
//! |       +---+-/-+      surface   as small as boxes get:  between nothing and all of it counts. For the estimates
//! |       |s /| in|                its field is taken as linear: a plane cuts the box
//! +-------+---+---+
//! ```
//!
//! The bounds of the volume are proven. The estimates converge at least with the square of the edge of the
//! smallest boxes where the surface is smooth, and with the edge at creases. The area is that of crossings
//! with lines (`crossings.rs`); where the surface is a wall, a jump of the field, the volume is that of the
//! same lines.

use crate::parallel::*;
use jbt_model::diagnostic::Diagnostics;

use jbt_ir::limits::{MAX_MEASURE_BOXES, MAX_RESOLUTION};
use jbt_ir::memory::NoMemory;

use super::crossings::crossed;
use super::cut::{self, LinearField};
use super::{RegionError, Solid, SolidBatch};
use crate::boxes::Box3;
use crate::divide::{Cell, Decision, DivideError, Division, DivisionNode, Limits, Outcome, divide};
use crate::error::{Classified, CompileError, ErrorKind, EvalError};
use crate::evaluator::Evaluator;
use crate::job::{Hook, Job, JobError};
use crate::polygonize::Fineness;
use crate::progress::{Cancelled, Progress, SOME};
use crate::prune::{Pruner, Region};

/// Where to measure a solid, and how finely.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measure {
    /// The box to measure in, about the origin of the model; `None` is the model's support, grown a little.
    pub region: Option<Box3>,
    /// How small boxes get where the surface may be: their longest side is at most a cell.
    pub fineness: Fineness,
}

/// Bounds and an estimate of a volume, in units of the model, cubed.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Volume {
    /// It is at least this much: the boxes that are all inside.
    pub low: f64,
    /// It is at most this much: with the boxes that may hold surface.
    pub high: f64,
    /// About this much.
    pub estimate: f64,
}

/// The boxes that were split equally often.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeasureLevel {
    /// Boxes that were split.
    pub splits: u64,
    /// Boxes that are all inside.
    pub solid: u64,
    /// Boxes that are all outside.
    pub air: u64,
    /// Boxes that may hold surface and were not split.
    pub surface: u64,
}

/// How much of a model matters in boxes that may hold surface: primitives that a point there takes.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Contents {
    /// On average; 0 without such boxes.
    pub mean: f64,
    /// At most.
    pub most: u64,
}

/// What was measured.
#[derive(Clone, PartialEq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Measures {
    /// Where, about the origin of the model.
    pub region: Box3,
    /// The longest side that was allowed to boxes that may hold surface.
    pub cell: f64,
    /// The volume of the solid in the region.
    pub volume: Volume,
    /// The area of the surface in the region, about; where the region cuts the solid, the cut does not count.
    pub area: f64,
    /// The centre of mass of a solid of one density, about, in the world; `None` if the estimated volume
    /// is 0.
    pub center: Option<[f64; 3]>,
    /// Boxes by how often they were split and what became of them.
    pub levels: Vec<MeasureLevel>,
    /// The volume of the boxes that are all outside.
    pub air: f64,
    /// The volume of the boxes that may hold surface.
    pub surface: f64,
    /// What matters in those.
    pub contents: Contents,
}

impl Measures {
    /// The volume of the region.
    #[must_use]
    pub fn total(&self) -> f64 {
        volume_of(&self.region)
    }

    /// All boxes.
    #[must_use]
    pub fn boxes(&self) -> MeasureLevel {
        self.levels.iter().fold(MeasureLevel::default(), |all, level| MeasureLevel {
            splits: all.splits + level.splits,
            solid: all.solid + level.solid,
            air: all.air + level.air,
            surface: all.surface + level.surface,
        })
    }
}

/// Why a solid was not measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// There is no region to measure in.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// The edge of a cell is zero, negative, infinite or not a number.
    #[error("the edge of a cell must be a finite number greater than 0, and it is {cell}")]
    Cell {
        /// What was given.
        cell: f64,
    },
    /// No cells, or more than [`MAX_RESOLUTION`], along the longest side.
    #[error("the longest side has {cells} cells; there must be from 1 to {MAX_RESOLUTION}")]
    Resolution {
        /// How many it would have.
        cells: f64,
    },
    /// The region could not be divided so finely.
    #[error(transparent)]
    Divide(#[from] DivideError<EvalError>),
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// The gradient, for normals, could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The memory for the work is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// It was told to stop.
    #[error("measuring was cancelled")]
    Cancelled,
}

impl JobError for MeasureError {
    fn told(self) -> Self {
        if self.kind() == ErrorKind::Cancelled { Self::Cancelled } else { self }
    }
}

impl Classified for MeasureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Region(error) => error.kind(),
            Self::Cell { .. } => ErrorKind::Argument,
            Self::Resolution { .. } | Self::Memory(_) => ErrorKind::Limit,
            Self::Divide(error) => error.kind(),
            Self::Eval(error) => error.kind(),
            Self::Compile(error) => error.kind(),
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}

impl From<Cancelled> for MeasureError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// A box may be longer than a cell by this part of it: sides are rounded to f32.
const SLACK: f64 = 1e-3;

/// How far a field may be from a linear one, as a part of its rise along an edge of the box.
const MAX_RESIDUAL: f64 = 0.05;
/// A linear field that is farther than so many residuals from the iso-value all over a box has no surface
/// there.
const REACH: f64 = 4.0;
/// How often a box is cut into eight where no linear field fits.
const MAX_REFINEMENT: u32 = 2;

/// The share of the division in the whole work. A guess, for a progress bar.
const DIVISION_SHARE: f64 = 0.7;

impl Solid {
    /// Measures the solid.
    ///
    /// The answer does not depend on the threads.
    ///
    /// # Errors
    /// A region or a cell that cannot be; an empty or an unbounded model without a region; more than
    /// [`MAX_MEASURE_BOXES`] boxes; it was cancelled.
    pub fn measure(&self, settings: &Measure) -> Job<'_, Measures, MeasureError> {
        let settings = *settings;
        Job::new(move |hook| self.measure_hooked(&settings, hook))
    }

    fn measure_hooked(&self, settings: &Measure, hook: Hook<'_>) -> Result<Measures, MeasureError> {
        let bounds = self.region(settings.region)?;
        let cell = cell(&bounds, settings.fineness)?;
        let progress = Progress::new(hook, SOME);
        let total = volume_of(&bounds);
        let decide = |cell_: &Cell<'_, Pruner>, &(): &()| {
            let decision = self.decide(cell_, cell * (1.0 + SLACK))?;
            let go_on = match decision {
                Decision::Leaf | Decision::Stop => {
                    progress.add(DIVISION_SHARE * volume_of(&cell_.bounds()) / total)
                }
                Decision::Split { .. } | Decision::Octants { .. } => progress.check(),
            };
            Ok(if go_on.is_ok() { decision } else { Decision::Stop })
        };
        let limits = Limits { boxes: MAX_MEASURE_BOXES, ..Limits::default() };
        let division = divide(&self.pruner, bounds, (), &limits, &decide)?;
        progress.check()?;
        let normals = self.normals()?;
        let leaves: Vec<(&DivisionNode<()>, &Region)> = division.leaves().collect();
        let share = (1.0 - DIVISION_SHARE) / leaves.len() as f64;
        let piece = |(node, region): &(&DivisionNode<()>, &Region)| {
            progress.add(share)?;
            self.piece(normals, &node.bounds, region).map_err(MeasureError::Eval)
        };
        let pieces: Vec<MeasurePiece> = scatter(|watches| {
            leaves.par_iter().map(|leaf| watches.hold(|| piece(leaf))).collect::<Result<_, _>>()
        })?;
        let empty = Measures { region: bounds, cell, ..Measures::default() };
        Ok(self.sum(empty, &division, &pieces))
    }

    /// Splits boxes that may hold surface along their longer sides.
    fn decide(&self, cell: &Cell<'_, Pruner>, longest: f64) -> Result<Decision<()>, EvalError> {
        if self.side(cell.range()?).is_some() {
            return Ok(Decision::Stop);
        }
        let bounds = cell.bounds();
        let side = |axis: usize| bounds.high[axis] - bounds.low[axis];
        let at = bounds.center();
        let splits = |axis: usize| bounds.low[axis] < at[axis] && at[axis] < bounds.high[axis];
        let axis = (1..3).fold(0, |best, axis| if side(axis) > side(best) { axis } else { best });
        if f64::from(side(axis)) <= longest || !splits(axis) {
            return Ok(Decision::Leaf);
        }
        if (0..3).all(|other| splits(other) && side(other) > 0.5 * side(axis)) {
            return Ok(Decision::Octants { at, data: [(); 8] });
        }
        Ok(Decision::Split { axis, at: at[axis], data: [(); 2] })
    }

    /// What a box that may hold surface holds, about.
    fn piece(&self, normals: &Evaluator, bounds: &Box3, region: &Region) -> Result<MeasurePiece, EvalError> {
        let crossed = crossed(self, normals, bounds, region)?;
        let volume = match crossed.walled_part {
            Some(part) => part * volume_of(bounds),
            None => self.linear_volume(bounds, region)?,
        };
        Ok(MeasurePiece { volume, area: crossed.area, primitives: self.field.evaluations_in(region) })
    }

    /// The volume of the solid in a box that may hold surface, about. The box is cut where the linear field
    /// that fits best is zero; where none fits well, as at creases, its parts are asked.
    fn linear_volume(&self, bounds: &Box3, region: &Region) -> Result<f64, EvalError> {
        let mut volume = 0.0;
        let mut batch = SolidBatch::default();
        let mut parts = vec![(*bounds, 0)];
        while let Some((bounds, depth)) = parts.pop() {
            let places = [0, 1, 2].map(|axis| cut::gauss(bounds.low[axis], bounds.high[axis]));
            batch.clear();
            for point in 0..8 {
                batch.push([0, 1, 2].map(|axis| places[axis][point >> axis & 1]));
            }
            let linear = LinearField::fit(&places, batch.values(self, region)?);
            let sides = [0, 1, 2].map(|axis| f64::from(bounds.high[axis]) - f64::from(bounds.low[axis]));
            let middle = linear.middle - f64::from(self.iso);
            let rises = [0, 1, 2].map(|axis| sides[axis] * linear.gradient[axis].abs());
            let steepest = rises.iter().fold(0.0, |most: f64, &rise| most.max(rise));
            let reached = middle.abs() < 0.5 * rises.iter().sum::<f64>() + REACH * linear.residual;
            if depth < MAX_REFINEMENT && reached && linear.residual > MAX_RESIDUAL * steepest {
                parts.extend(bounds.cut([2; 3]).into_iter().map(|part| (part, depth + 1)));
                continue;
            }
            volume += cut::fraction(sides, middle, linear.gradient) * volume_of(&bounds);
        }
        Ok(volume)
    }

    /// Adds everything up, in the order of the division.
    fn sum(&self, mut sums: Measures, division: &Division<Region, ()>, pieces: &[MeasurePiece]) -> Measures {
        let mut pieces = pieces.iter();
        let mut moment = [0.0; 3];
        let mut primitives = 0_u64;
        for node in division.nodes() {
            let depth = usize::from(node.depth);
            if sums.levels.len() <= depth {
                sums.levels.resize(depth + 1, MeasureLevel::default());
            }
            let level = &mut sums.levels[depth];
            let volume = volume_of(&node.bounds);
            let inside = match node.outcome {
                Outcome::Split => {
                    level.splits += 1;
                    continue;
                }
                Outcome::Leaf => {
                    let piece = pieces.next().expect("a piece for each leaf");
                    level.surface += 1;
                    sums.surface += volume;
                    sums.area += piece.area;
                    primitives = primitives.saturating_add(piece.primitives);
                    sums.contents.most = sums.contents.most.max(piece.primitives);
                    piece.volume
                }
                Outcome::Stop if node.range.and_then(|range| self.side(range)) == Some(true) => {
                    level.solid += 1;
                    sums.volume.low += volume;
                    volume
                }
                Outcome::Stop => {
                    level.air += 1;
                    sums.air += volume;
                    0.0
                }
            };
            sums.volume.estimate += inside;
            for (axis, sum) in moment.iter_mut().enumerate() {
                let middle = 0.5 * (f64::from(node.bounds.low[axis]) + f64::from(node.bounds.high[axis]));
                *sum += inside * middle;
            }
        }
        sums.volume.high = sums.volume.low + sums.surface;
        let surfaces = sums.boxes().surface;
        sums.contents.mean = if surfaces == 0 { 0.0 } else { primitives as f64 / surfaces as f64 };
        let mass = sums.volume.estimate;
        sums.center = (mass > 0.0).then(|| self.tree().origin().world(moment.map(|sum| sum / mass)));
        sums
    }
}

/// What a box that may hold surface holds, about.
struct MeasurePiece {
    volume: f64,
    area: f64,
    primitives: u64,
}

/// The edge of a cell.
fn cell(bounds: &Box3, fineness: Fineness) -> Result<f64, MeasureError> {
    let longest = f64::from(bounds.longest_side());
    let cell = match fineness {
        Fineness::Cell(cell) if cell > 0.0 && cell.is_finite() => cell,
        Fineness::Cell(cell) => return Err(MeasureError::Cell { cell }),
        Fineness::Resolution(0) => return Err(MeasureError::Resolution { cells: 0.0 }),
        Fineness::Resolution(cells) => longest / cells as f64,
    };
    let cells = longest / cell;
    if cells > MAX_RESOLUTION as f64 * (1.0 + SLACK) {
        return Err(MeasureError::Resolution { cells });
    }
    Ok(cell)
}

pub(super) fn volume_of(bounds: &Box3) -> f64 {
    (0..3).map(|axis| f64::from(bounds.high[axis]) - f64::from(bounds.low[axis])).product()
}
