//! The division of a rectangle of cells or pixels into squares: those that are inside or outside as a whole
//! are dropped.
//!
//! ```text
//! visit(square):      parts of it, 2 x 2 or more at once: their ranges and regions from one call     (survey)
//!     all inside, all outside      done with
//!     small, or nothing is in it   leaf: its points are evaluated with its rows
//!     else                         visit(part)
//! ```
//!
//! Unlike the boxes of [`divide`](crate::divide), of which two or eight are decided at once, these are flat,
//! and as many parts of one square are asked about in one call as fill the lanes of a kernel. What comes out
//! is in the order of a walk down the tree, so it does not depend on threads.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::parallel::*;

use jbt_ir::limits::MAX_SQUARES;

use super::SliceError;
use crate::boxes::{Box3, Range};
use crate::error::EvalError;
use crate::progress::Progress;
use crate::prune::{Pruner, Region};
use crate::touched::Touched;

/// A square of cells, cut off where the grid ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct CellSquare {
    /// Its lowest cell.
    pub(super) first: [u32; 2],
    /// The cell behind its last one, along each axis.
    pub(super) end: [u32; 2],
    /// Cells along its side, if it were whole: a power of two.
    pub(super) size: u32,
}

impl CellSquare {
    fn cells(&self) -> f64 {
        [0, 1].map(|axis| f64::from(self.end[axis] - self.first[axis])).iter().product()
    }
}

/// Where a square is, as far as its range tells.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Verdict {
    Inside,
    Outside,
    Open,
}

impl Verdict {
    /// What a range says. A NaN says nothing.
    pub(super) fn of([low, high]: Range, iso: f32) -> Self {
        match (low >= iso, high < iso) {
            (true, _) => Self::Inside,
            (_, true) => Self::Outside,
            (false, false) => Self::Open,
        }
    }
}

/// What became of a square.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Fate {
    /// It was divided.
    Divided,
    /// It is inside as a whole: proven by its range.
    Inside,
    /// It is outside as a whole: proven by its range.
    Outside,
    /// Its points were evaluated, and the contour passes through it.
    Crossed,
    /// Its points were evaluated.
    Evaluated,
}

/// A square of the division, in coordinates of the plane.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DividedSquare {
    /// Its lowest corner.
    pub low: [f32; 2],
    /// Its highest corner.
    pub high: [f32; 2],
    /// How often the side of the whole was halved to get its side.
    pub depth: u8,
    /// What became of it.
    pub fate: Fate,
}

/// How many squares of one size have which fate.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContourLevel {
    /// How often the side of the whole was halved to get theirs.
    pub depth: u8,
    /// Cells along their sides.
    pub cells: u32,
    /// Squares that were divided.
    pub divided: u64,
    /// Squares that are inside as a whole.
    pub inside: u64,
    /// Squares that are outside as a whole.
    pub outside: u64,
    /// Squares that were evaluated, and are crossed by the contour.
    pub crossed: u64,
    /// Squares that were evaluated, and are not.
    pub evaluated: u64,
}

impl ContourLevel {
    /// All squares of this size.
    #[must_use]
    pub fn squares(&self) -> u64 {
        self.divided + self.inside + self.outside + self.crossed + self.evaluated
    }
}

/// What is made of squares.
pub(super) trait SquareWork: Sync {
    /// What a square leaves.
    type Piece: Send;

    /// The closed box of its points.
    fn bounds(&self, square: &CellSquare) -> Box3;

    /// Whether a square is done with, by the range of the field in it.
    fn verdict(&self, range: Range) -> Verdict;

    /// Adds what a square leaves that is done with. `around` is the region of a square around it.
    fn dropped(
        &self,
        square: &CellSquare,
        inside: bool,
        around: &Region,
        pieces: &mut Vec<Self::Piece>,
    ) -> Result<(), EvalError>;

    /// Whether a square is a leaf before it is small, because its points are evaluated sooner than it is
    /// divided.
    fn is_told(&self, square: &CellSquare, region: &Region) -> bool;

    /// A leaf, and whether the contour crosses it.
    fn leaf(&self, square: &CellSquare, region: &Region) -> Result<(Option<Self::Piece>, bool), SliceError>;
}

/// How to divide.
#[derive(Clone, Copy)]
pub(super) struct DivisionPlan<'a> {
    /// Cells along u and v.
    pub(super) cells: [u32; 2],
    /// Cells along the side of leaves: a power of two.
    pub(super) leaf: u32,
    /// Halvings of a side at once.
    pub(super) step: u32,
    /// Whether to keep all squares.
    pub(super) keep: bool,
    /// The leaves to look at, if not all.
    pub(super) touched: Option<&'a Touched<2>>,
}

impl DivisionPlan<'_> {
    fn is_touched(&self, square: &CellSquare) -> bool {
        let has = |touched: &Touched<2>| {
            touched.has(square.first.map(|first| first as usize), square.size as usize)
        };
        self.touched.is_none_or(has)
    }
}

/// What came out.
pub(super) struct Divided<P> {
    pub(super) pieces: Vec<P>,
    /// The squares by size, largest first, without sizes of which there are none.
    pub(super) levels: Vec<ContourLevel>,
    pub(super) squares: Vec<(CellSquare, u8, Fate)>,
}

/// The halvings of 2^20 cells, and the whole.
const LEVELS: usize = 22;

impl<P> Divided<P> {
    fn new() -> Self {
        Self { pieces: Vec::new(), levels: Vec::new(), squares: Vec::new() }
    }

    fn append(&mut self, mut other: Self) {
        self.pieces.append(&mut other.pieces);
        self.squares.append(&mut other.squares);
    }
}

/// Counts of squares of one size, by fate.
#[derive(Default)]
struct FateCounts([AtomicU64; 5]);

impl FateCounts {
    fn of(&self, fate: Fate) -> &AtomicU64 {
        &self.0[match fate {
            Fate::Divided => 0,
            Fate::Inside => 1,
            Fate::Outside => 2,
            Fate::Crossed => 3,
            Fate::Evaluated => 4,
        }]
    }

    fn level(&self, depth: usize, cells: u32) -> ContourLevel {
        let count = |fate| self.of(fate).load(Ordering::Relaxed);
        ContourLevel {
            depth: depth as u8,
            cells,
            divided: count(Fate::Divided),
            inside: count(Fate::Inside),
            outside: count(Fate::Outside),
            crossed: count(Fate::Crossed),
            evaluated: count(Fate::Evaluated),
        }
    }
}

struct SquareDivider<'a, 'hook, W> {
    pruner: &'a Pruner,
    work: &'a W,
    plan: DivisionPlan<'a>,
    /// Halvings from the whole to one cell.
    depth: u32,
    progress: &'a Progress<'hook>,
    leaves: AtomicU64,
    tallies: [FateCounts; LEVELS],
}

/// The side, in leaves, of the smallest squares whose parts are visited in parallel.
const PARALLEL: u32 = 2;

/// Divides all cells, on the threads of the rayon pool in which this is called.
pub(super) fn divide<W: SquareWork>(
    pruner: &Pruner,
    work: &W,
    plan: DivisionPlan<'_>,
    progress: &Progress<'_>,
) -> Result<Divided<W::Piece>, SliceError> {
    let most = plan.cells[0].max(plan.cells[1]);
    let size = most.next_power_of_two().max(plan.leaf);
    let depth = size.ilog2();
    let (leaves, tallies) = (AtomicU64::new(0), Default::default());
    let run = SquareDivider { pruner, work, plan, depth, progress, leaves, tallies };
    let whole = CellSquare { first: [0; 2], end: plan.cells, size };
    let mut divided =
        if plan.is_touched(&whole) { run.parts(&pruner.everywhere(), &[whole])? } else { Divided::new() };
    let levels = run.tallies.iter().enumerate().take(1 + depth as usize);
    divided.levels = levels.map(|(depth, tally)| tally.level(depth, size >> depth)).collect();
    divided.levels.retain(|level| level.squares() > 0);
    Ok(divided)
}

impl<W: SquareWork> SquareDivider<'_, '_, W> {
    fn depth(&self, square: &CellSquare) -> usize {
        (self.depth - square.size.ilog2()) as usize
    }

    fn note(&self, found: &mut Divided<W::Piece>, square: &CellSquare, fate: Fate) {
        let depth = self.depth(square);
        self.tallies[depth].of(fate).fetch_add(1, Ordering::Relaxed);
        if self.plan.keep {
            found.squares.push((*square, depth as u8, fate));
        }
    }

    /// Some squares in a region.
    fn parts(&self, around: &Region, squares: &[CellSquare]) -> Result<Divided<W::Piece>, SliceError> {
        let boxes: Vec<Box3> = squares.iter().map(|square| self.work.bounds(square)).collect();
        let wanted = |range| self.work.verdict(range) == Verdict::Open;
        let surveyed = self.pruner.survey(around, &boxes, &wanted)?;
        let visit = |(square, (range, region)): (&CellSquare, (Range, Option<Region>))| {
            self.visit(square, range, region.as_ref(), around)
        };
        let all = squares.iter().zip(surveyed);
        let found: Vec<_> = if squares[0].size >= PARALLEL * self.plan.leaf {
            let all: Vec<_> = all.collect();
            scatter(|watches| {
                all.into_par_iter().map(|one| watches.hold(|| visit(one))).collect::<Result<_, _>>()
            })?
        } else {
            all.map(visit).collect::<Result<_, _>>()?
        };
        let mut found = found.into_iter();
        let mut together = found.next().unwrap_or_else(Divided::new);
        found.for_each(|more| together.append(more));
        Ok(together)
    }

    fn visit(
        &self,
        square: &CellSquare,
        range: Range,
        region: Option<&Region>,
        around: &Region,
    ) -> Result<Divided<W::Piece>, SliceError> {
        let mut found = Divided::new();
        let Some(region) = region else {
            let inside = self.work.verdict(range) == Verdict::Inside;
            self.note(&mut found, square, if inside { Fate::Inside } else { Fate::Outside });
            self.work.dropped(square, inside, around, &mut found.pieces)?;
            self.finish(square)?;
            return Ok(found);
        };
        if square.size <= self.plan.leaf || self.work.is_told(square, region) {
            if self.leaves.fetch_add(1, Ordering::Relaxed) >= MAX_SQUARES {
                return Err(SliceError::TooManySquares { limit: MAX_SQUARES });
            }
            let (piece, crossed) = self.work.leaf(square, region)?;
            self.note(&mut found, square, if crossed { Fate::Crossed } else { Fate::Evaluated });
            found.pieces.extend(piece);
            self.finish(square)?;
            return Ok(found);
        }
        self.note(&mut found, square, Fate::Divided);
        let parts = self.split(square);
        if !parts.is_empty() {
            found.append(self.parts(region, &parts)?);
        }
        Ok(found)
    }

    /// Tells that a square is done.
    fn finish(&self, square: &CellSquare) -> Result<(), SliceError> {
        let all = f64::from(self.plan.cells[0]) * f64::from(self.plan.cells[1]);
        Ok(self.progress.add(square.cells() / all)?)
    }

    /// The parts of a square that are in the grid, and are touched, u fastest.
    fn split(&self, square: &CellSquare) -> Vec<CellSquare> {
        let size = (square.size >> self.plan.step).max(self.plan.leaf).min(square.size / 2);
        let starts = |axis: usize| (square.first[axis]..square.end[axis]).step_by(size as usize);
        let part = |u: u32, v: u32| {
            let end = [(u + size).min(square.end[0]), (v + size).min(square.end[1])];
            CellSquare { first: [u, v], end, size }
        };
        let parts = starts(1).flat_map(|v| starts(0).map(move |u| part(u, v)));
        parts.filter(|part| self.plan.is_touched(part)).collect()
    }
}
