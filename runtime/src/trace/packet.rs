//! Following a packet of rays: cells, from the nearest to the farthest.
//!
//! ```text
//! cell = a run of rays, from one place of their lattice to another, and the rows that matter there
//! take the next cell; without the rays that have their answer
//!     few points left in it    ask all of them: two neighbours on different sides hold a hit        (sample)
//!     else                     cut it, along or across, into up to 8 parts; ask for ranges          (divide)
//!                                  all of a part on one side: dropped, no neighbours differ there
//!                                  else: its rows, and onto the list, the nearest part on top
//! ```
//!
//! Cells are closed: both sides of a cut ask the place of the cut, and get the same bits, because leaving rows out changes none. So every pair of neighbouring places
//! belongs to one cell, and what is found is what asking all places would find.

use std::ops::Range;

use super::Tracer;
use super::beam::Beam;
use super::error::TraceError;
use super::found::Found;
use super::polish::{Bracket, polish};
use super::ray::Line;
use crate::error::EvalError;
use crate::prune::Region;
use crate::region::{Box3, Divisible as _, MAX_PARTS};

use jbt_ir::limits::MAX_RAY_WORK;

/// What is asked of rays.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Want {
    /// The first hit of each.
    First,
    /// All hits.
    All,
    /// Whether there is one.
    Any,
}

/// A part of a packet that is still to be looked at.
struct Cell {
    /// The lines, of which some may be done.
    lines: Range<usize>,
    places: [i64; 2],
    region: Region,
    /// How many divisions in a row have dropped nothing.
    fruitless: u32,
}

/// Points by coordinates, their times and their fields.
#[derive(Default)]
pub(super) struct Batch {
    pub(super) times: Vec<f64>,
    pub(super) points: [Vec<f32>; 3],
    pub(super) field: Vec<f32>,
}

impl Batch {
    pub(super) fn clear(&mut self) {
        self.times.clear();
        self.points.iter_mut().for_each(Vec::clear);
    }

    pub(super) fn push(&mut self, line: &Line, time: f64) {
        self.times.push(time);
        for (plane, x) in self.points.iter_mut().zip(line.position(time)) {
            plane.push(x);
        }
    }

    /// Asks the field at all points, which are in the region.
    pub(super) fn ask(&mut self, tracer: &Tracer, region: &Region) -> Result<(), EvalError> {
        self.field.resize(self.times.len(), 0.0);
        tracer.field.eval_region(region, self.points.each_ref().map(Vec::as_slice), &mut [&mut self.field])
    }
}

/// A packet that is being followed.
pub(super) struct Run<'a> {
    tracer: &'a Tracer,
    want: Want,
    tolerance: f64,
    /// The rays that may hit something; those with the same step are neighbours.
    lines: Vec<Line>,
    /// For each line, whether its answer is complete.
    done: Vec<bool>,
    cells: Vec<Cell>,
    batch: Batch,
    brackets: Vec<Bracket>,
    found: Found,
    /// Points and boxes that may still be asked.
    work: u64,
}

/// What dividing a cell costs beside its distances, in distances at points: finding boxes, rows, calls.
const DIVISION: u64 = 2500;
/// What the ranges of eight boxes and their rows cost for each distance, in distances at points.
const RANGES: u64 = 34;
/// What a point costs beside its distances, in distances at points.
const POINT: u64 = 6;
/// Dividing has to save some of the points before it saves anything: so many times its cost are asked at once.
const PATIENCE: u64 = 3;
/// Divisions that drop nothing, after which not more points are asked at once.
const MOST_FRUITLESS: u32 = 3;

/// The points of a cell up to which asking them is quicker than dividing it, where a point takes so many distances.
fn worth_asking(each: u64) -> u64 {
    PATIENCE * RANGES.saturating_mul(each).saturating_add(DIVISION) / each.saturating_add(POINT)
}

impl<'a> Run<'a> {
    pub(super) fn new(
        tracer: &'a Tracer,
        want: Want,
        tolerance: f64,
        rays: usize,
        mut lines: Vec<Line>,
    ) -> Self {
        if lines.windows(2).any(|pair| pair[0].step != pair[1].step) {
            lines.sort_by(|a, b| a.step.total_cmp(&b.step));
        }
        Self {
            tracer,
            want,
            tolerance,
            done: vec![false; lines.len()],
            lines,
            cells: Vec::new(),
            batch: Batch::default(),
            brackets: Vec::new(),
            found: Found::new(rays, tracer.layout().names().len()),
            // Hits are counted by 32 bits, and each takes a point.
            work: MAX_RAY_WORK.saturating_mul(rays as u64).min(u32::MAX.into()),
        }
    }

    /// Follows all rays to their ends.
    pub(super) fn finish(mut self) -> Result<Found, TraceError> {
        self.start()?;
        while let Some(cell) = self.cells.pop() {
            self.visit(cell)?;
        }
        Ok(self.found)
    }

    /// Makes a cell of all rays that have the same step.
    fn start(&mut self) -> Result<(), EvalError> {
        let mut first = 0;
        while first < self.lines.len() {
            let step = self.lines[first].step;
            let count = self.lines[first..].iter().take_while(|line| line.step == step).count();
            let lines = first..first + count;
            first += count;
            let Some(beam) = self.beam(lines.clone()) else { continue };
            if beam.places[0] < beam.places[1] {
                let region = self.tracer.pruner.region(beam.bounds(beam.places))?;
                self.cells.push(Cell { lines, places: beam.places, region, fruitless: 0 });
            }
        }
        Ok(())
    }

    /// The beam of the lines that are not done.
    fn beam(&self, lines: Range<usize>) -> Option<Beam> {
        Beam::around(self.open(lines).map(|line| &self.lines[line]))
    }

    /// The lines that are not done.
    fn open(&self, lines: Range<usize>) -> impl Iterator<Item = usize> + '_ {
        lines.filter(|&line| !self.done[line])
    }

    fn visit(&mut self, mut cell: Cell) -> Result<(), TraceError> {
        let Some(beam) = self.beam(cell.lines.clone()) else { return Ok(()) };
        cell.places = common(cell.places, beam.places);
        let [first, last] = cell.places;
        if first >= last {
            return Ok(());
        }
        let points = (beam.rays as u64).saturating_mul(last.abs_diff(first).saturating_add(1));
        let each = self.tracer.field.evaluations_in(&cell.region);
        if points <= worth_asking(each) << cell.fruitless.min(MOST_FRUITLESS) {
            self.spend(points)?;
            self.sample(&cell, each)?;
        } else {
            self.spend(MAX_PARTS as u64)?;
            self.divide(&cell, &beam)?;
        }
        Ok(())
    }

    fn spend(&mut self, work: u64) -> Result<(), TraceError> {
        let rays = self.found.rays();
        self.work = self.work.checked_sub(work).ok_or(TraceError::Work { rays })?;
        Ok(())
    }

    /// Cuts a cell across if that makes it shorter, else along its rays.
    fn divide(&mut self, cell: &Cell, beam: &Beam) -> Result<(), EvalError> {
        let steps = cell.places[1] - cell.places[0];
        let [length, width] = beam.proportions(cell.places);
        let mut parts: Vec<(Range<usize>, [i64; 2])> = Vec::with_capacity(MAX_PARTS);
        let mut boxes: Vec<Box3> = Vec::with_capacity(MAX_PARTS);
        if beam.rays > 1 && (width >= length || steps == 1) {
            let count = cell.lines.len().min(MAX_PARTS);
            let cut = |part: usize| cell.lines.start + cell.lines.len() * part / count;
            for lines in (0..count).map(|part| cut(part)..cut(part + 1)) {
                let Some(beam) = self.beam(lines.clone()) else { continue };
                let places = common(cell.places, beam.places);
                if places[0] < places[1] {
                    boxes.push(beam.bounds(places));
                    parts.push((lines, places));
                }
            }
        } else {
            // A part shorter than the beam is wide has no smaller a box.
            let count = ((length / width).clamp(2.0, MAX_PARTS as f64) as i64).max(2).min(steps);
            let (most, rest) = (steps / count, steps % count);
            let cut = |part: i64| cell.places[0] + most * part + rest.min(part);
            for places in (0..count).map(|part| [cut(part), cut(part + 1)]) {
                boxes.push(beam.bounds(places));
                parts.push((cell.lines.clone(), places));
            }
        }
        self.push_parts(cell, beam, &parts, &boxes)
    }

    /// Puts the parts in which the surface may be onto the list.
    fn push_parts(
        &mut self,
        cell: &Cell,
        beam: &Beam,
        parts: &[(Range<usize>, [i64; 2])],
        boxes: &[Box3],
    ) -> Result<(), EvalError> {
        if boxes.is_empty() {
            return Ok(());
        }
        let iso = self.tracer.iso;
        let (kept, evaluations) =
            self.tracer.pruner.split(&cell.region, boxes, &|[low, high]| low < iso && high >= iso)?;
        let fruitless = if kept.len() == parts.len() { cell.fruitless + 1 } else { 0 };
        for (part, region) in kept.into_iter().rev() {
            let (lines, places) = parts[part].clone();
            self.cells.push(Cell { lines, places, region, fruitless });
        }
        let share = evaluations as f32 / beam.rays as f32;
        for line in cell.lines.clone().filter(|&line| !self.done[line]) {
            self.found.count(self.lines[line].ray, share);
        }
        Ok(())
    }

    /// Asks the field at all places of a cell, and finds what is between them.
    fn sample(&mut self, cell: &Cell, each: u64) -> Result<(), EvalError> {
        let mut batch = std::mem::take(&mut self.batch);
        batch.clear();
        let mut ranges = Vec::with_capacity(cell.lines.len());
        for index in self.open(cell.lines.clone()) {
            let line = &self.lines[index];
            let [first, last] = common(cell.places, line.places);
            if first < last {
                ranges.push((index, batch.times.len()));
                push_places(&mut batch, line, [first, last]);
            }
        }
        batch.ask(self.tracer, &cell.region)?;
        let ends = ranges.iter().skip(1).map(|&(_, start)| start).chain([batch.times.len()]);
        for (&(line, start), end) in ranges.iter().zip(ends) {
            self.found.count(self.lines[line].ray, (end - start) as f32 * each as f32);
            self.find_changes(line, &batch.times[start..end], &batch.field[start..end]);
        }
        if !self.brackets.is_empty() {
            let mut brackets = std::mem::take(&mut self.brackets);
            polish(self.tracer, &cell.region, &self.lines, &mut brackets, &mut batch)?;
            let evaluations = |bracket: &Bracket| u64::from(bracket.rounds()) * each;
            for bracket in &brackets {
                self.found.count(self.lines[bracket.line()].ray, evaluations(bracket) as f32);
            }
            self.found.add(self.tracer, &cell.region, &self.lines, &brackets)?;
            brackets.clear();
            self.brackets = brackets;
        }
        self.batch = batch;
        Ok(())
    }

    /// Finds neighbouring places of one ray that are on different sides.
    fn find_changes(&mut self, line: usize, times: &[f64], field: &[f32]) {
        let iso = self.tracer.iso;
        for (pair, times) in field.windows(2).zip(times.windows(2)) {
            if (pair[0] >= iso) == (pair[1] >= iso) {
                continue;
            }
            match self.want {
                Want::Any => self.found.block(self.lines[line].ray),
                Want::First | Want::All => {
                    let (fields, times) = ([pair[0], pair[1]], [times[0], times[1]]);
                    self.brackets.push(Bracket::new(
                        line,
                        &self.lines[line],
                        self.tolerance,
                        iso,
                        times,
                        fields,
                    ));
                }
            }
            if self.want != Want::All {
                self.done[line] = true;
                return;
            }
        }
    }
}

/// The places that two ranges have in common.
fn common(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Adds the points of a ray from one place to another, both included.
fn push_places(batch: &mut Batch, line: &Line, [first, last]: [i64; 2]) {
    let start = batch.times.len();
    // Place numbers are exact in f64.
    let base = first as f64;
    batch.times.extend((0..=(last - first) as u32).map(|offset| line.time(base + f64::from(offset))));
    for (axis, plane) in batch.points.iter_mut().enumerate() {
        let (origin, direction) = (line.origin[axis], line.direction[axis]);
        plane.extend(batch.times[start..].iter().map(|t| (origin + t * direction) as f32));
    }
}
