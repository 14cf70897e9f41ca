//! Tracing a packet of rays: cells, from the nearest to the farthest.
//!
//! ```text
//! cell = a run of rays, from one coarse place of their lattice to another, and the rows that matter there
//! take the next cell; without the rays that have their answer
//!     few points left in it    ask all of them, and what is between them                          (sample, refine)
//!     else                     cut it, along or across, into up to 8 parts; ask for ranges          (divide)
//!                                  all of a part on one side: dropped, no neighbours differ there
//!                                  else: its rows, and onto the list, the nearest part on top
//! ```
//!
//! Cells are closed: both parts at a cut evaluate the place of the cut, and get the same bits, because
//! leaving rows out changes none. So every pair of neighbouring coarse places belongs to one cell, and the
//! result equals that of evaluating all places.

use std::ops::Range;

use super::batch::{TraceBatch, WorkLimit};
use super::beam::Beam;
use super::error::TraceError;
use super::found::FoundHits;
use super::polish::{RayBracket, polish};
use super::ray::RayLine;
use super::refine::{RaySegment, RayStretch, Refiner};
use super::target::Target;
use crate::boxes::{Box3, Divisible as _, MAX_PARTS};
use crate::error::EvalError;
use crate::prune::Region;

use jbt_ir::limits::MAX_RAY_WORK;

/// The question about rays.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Want {
    /// The first hit of each.
    First,
    /// All hits.
    All,
    /// Whether there is a hit.
    Any,
}

/// A part of a packet that is still to be examined.
struct PacketCell {
    /// The lines; some of them may be done.
    lines: Range<usize>,
    /// The beam around the lines that were not done when the cell was made.
    beam: Beam,
    places: [i64; 2],
    region: Region,
    /// The number of consecutive divisions that dropped nothing.
    fruitless: u32,
}

/// A part of a cell, before its ranges are known.
#[derive(Clone)]
struct PacketPart {
    lines: Range<usize>,
    beam: Beam,
    places: [i64; 2],
}

/// The state of tracing a packet.
pub(super) struct PacketTrace<'a> {
    tracer: &'a Target,
    want: Want,
    /// Steps of the lattice from one coarse place to the next.
    stride: i64,
    tolerance: f64,
    /// The rays that may hit the model; rays with the same step are neighbours.
    lines: Vec<RayLine>,
    /// For each line, whether its answer is complete.
    done: Vec<bool>,
    cells: Vec<PacketCell>,
    batch: TraceBatch,
    /// The times of the places of a cell.
    lattice: Vec<f64>,
    brackets: Vec<RayBracket>,
    /// The stretches of a cell: neighbouring coarse places on one side.
    stretches: Vec<RayStretch>,
    /// The segments of a cell whose ends are on different sides.
    segments: Vec<RaySegment>,
    found: FoundHits,
    work: WorkLimit,
}

/// The cost of dividing a cell without its distances, in distances at points: boxes, rows, calls.
const DIVISION: u64 = 2500;
/// The cost of the ranges of eight boxes, with their rows, for each distance, in distances at points.
const RANGES: u64 = 34;
/// The cost of a point without its distances, in distances at points.
const POINT: u64 = 6;
/// The number of consecutive divisions that drop nothing after which a cell is sampled.
const MOST_FRUITLESS: u32 = 3;

/// The number of points up to which sampling a cell is faster than dividing it, where a point takes `each`
/// distances. Based on rough counts of instructions; only time depends on it.
fn worth_asking(each: u64) -> u64 {
    RANGES.saturating_mul(each).saturating_add(DIVISION) / each.saturating_add(POINT)
}

impl<'a> PacketTrace<'a> {
    pub(super) fn new(
        tracer: &'a Target,
        (want, stride): (Want, i64),
        tolerance: f64,
        rays: usize,
        mut lines: Vec<RayLine>,
    ) -> Self {
        if lines.windows(2).any(|pair| pair[0].step != pair[1].step) {
            lines.sort_by(|a, b| a.step.total_cmp(&b.step));
        }
        Self {
            tracer,
            want,
            stride,
            tolerance,
            done: vec![false; lines.len()],
            lines,
            cells: Vec::new(),
            batch: TraceBatch::default(),
            lattice: Vec::new(),
            brackets: Vec::new(),
            stretches: Vec::new(),
            segments: Vec::new(),
            found: FoundHits::new(rays, tracer.layout.names().len()),
            // Hits are counted in 32 bits, and each hit takes a point.
            work: WorkLimit { left: MAX_RAY_WORK.saturating_mul(rays as u64).min(u32::MAX.into()), rays },
        }
    }

    /// Traces all rays to their ends.
    pub(super) fn finish(mut self) -> Result<FoundHits, TraceError> {
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
                self.cells.push(PacketCell { lines, places: beam.places, beam, region, fruitless: 0 });
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

    fn visit(&mut self, mut cell: PacketCell) -> Result<(), TraceError> {
        let open = self.open(cell.lines.clone()).count();
        if open == 0 {
            return Ok(());
        }
        if open < cell.beam.rays - cell.beam.rays / 4
            && let Some(beam) = self.beam(cell.lines.clone())
        {
            cell.beam = beam;
        }
        cell.places = common(cell.places, cell.beam.places);
        let [first, last] = cell.places;
        if first >= last {
            return Ok(());
        }
        let points = (open as u64).saturating_mul(last.abs_diff(first).saturating_add(1));
        let each = self.tracer.field.evaluations_in(&cell.region);
        if points <= worth_asking(each) << cell.fruitless.min(MOST_FRUITLESS) {
            self.work.spend(points)?;
            self.sample(&cell, each)?;
        } else {
            self.work.spend(MAX_PARTS as u64)?;
            self.divide(&cell, open)?;
        }
        Ok(())
    }

    /// Cuts a cell across if that makes it shorter, otherwise along its rays, of which `open` are not done.
    fn divide(&mut self, cell: &PacketCell, open: usize) -> Result<(), EvalError> {
        let steps = cell.places[1] - cell.places[0];
        let [length, width] = cell.beam.proportions(cell.places);
        let mut parts: Vec<PacketPart> = Vec::with_capacity(MAX_PARTS);
        if open > 1 && (width >= length || steps == 1) {
            let count = cell.lines.len().min(MAX_PARTS);
            let cut = |part: usize| cell.lines.start + cell.lines.len() * part / count;
            for lines in (0..count).map(|part| cut(part)..cut(part + 1)) {
                let Some(beam) = self.beam(lines.clone()) else { continue };
                let places = common(cell.places, beam.places);
                if places[0] < places[1] {
                    parts.push(PacketPart { lines, beam, places });
                }
            }
        } else {
            // A part shorter than the beam's width has no smaller box.
            let count = ((length / width).clamp(2.0, MAX_PARTS as f64) as i64).max(2).min(steps);
            let (most, rest) = (steps / count, steps % count);
            let cut = |part: i64| cell.places[0] + most * part + rest.min(part);
            for places in (0..count).map(|part| [cut(part), cut(part + 1)]) {
                parts.push(PacketPart { lines: cell.lines.clone(), beam: cell.beam, places });
            }
        }
        if parts.is_empty() { Ok(()) } else { self.push_parts(cell, open, &parts) }
    }

    /// Puts the parts that may hold the surface onto the list.
    fn push_parts(&mut self, cell: &PacketCell, open: usize, parts: &[PacketPart]) -> Result<(), EvalError> {
        let mut boxes = [Box3::default(); MAX_PARTS];
        for (bounds, part) in boxes.iter_mut().zip(parts) {
            *bounds = part.beam.bounds(part.places);
        }
        let iso = self.tracer.iso;
        let (mut kept, mut regions) = (Vec::with_capacity(MAX_PARTS), Vec::with_capacity(MAX_PARTS));
        let mut undecided = |part: usize, [low, high]: [f32; 2]| {
            let is_open = !(low >= iso || high < iso);
            kept.extend(is_open.then_some(part));
            is_open
        };
        let pruner = &self.tracer.pruner;
        pruner.split(&cell.region, &boxes[..parts.len()], &mut undecided, &mut regions)?;
        let evaluations = pruner.range_evaluations(&cell.region, parts.len());
        let fruitless = if kept.len() == parts.len() { cell.fruitless + 1 } else { 0 };
        for (part, region) in kept.into_iter().zip(regions).rev() {
            let PacketPart { lines, beam, places } = parts[part].clone();
            self.cells.push(PacketCell { lines, beam, places, region, fruitless });
        }
        let share = evaluations as f32 / open as f32;
        for line in cell.lines.clone().filter(|&line| !self.done[line]) {
            self.found.count(self.lines[line].ray, share);
        }
        Ok(())
    }

    /// Evaluates the field at all places of a cell, and finds the hits between them.
    fn sample(&mut self, cell: &PacketCell, each: u64) -> Result<(), TraceError> {
        let mut batch = std::mem::take(&mut self.batch);
        batch.clear();
        // Most rays have all places of the cell, so the times of these are computed once.
        let [start, end] = cell.places;
        self.lattice.clear();
        self.lattice.extend(
            (0..=(end - start) as i32).map(|place| (start as f64 + f64::from(place)) * cell.beam.step),
        );
        let mut asked = Vec::with_capacity(cell.lines.len());
        for index in self.open(cell.lines.clone()) {
            let line = &self.lines[index];
            let [first, last] = common(cell.places, line.places);
            if first < last {
                asked.push((index, first, batch.points[0].len()));
                let times = &self.lattice[(first - start) as usize..=(last - start) as usize];
                push_places(&mut batch, line, [first, last], times);
            }
        }
        batch.ask(self.tracer, &cell.region)?;
        let ends = asked.iter().skip(1).map(|&(.., start)| start).chain([batch.field.len()]);
        for (&(line, place, start), end) in asked.iter().zip(ends) {
            self.found.count(self.lines[line].ray, (end - start) as f32 * each as f32);
            self.find_changes(line, place, &batch.field, start..end);
        }
        self.refine(&cell.region, &mut batch)?;
        self.close(&cell.region, each, &mut batch)?;
        self.batch = batch;
        Ok(())
    }

    /// Finds neighbouring coarse places of one ray on different sides, and the stretches between such places.
    /// `of` is the range of the ray's fields, `first` the place of the first of them.
    fn find_changes(&mut self, line: usize, first: i64, fields: &[f32], of: Range<usize>) {
        let iso = self.tracer.iso;
        let here = &self.lines[line];
        let place = |at: usize| first + (at - of.start) as i64;
        let known = self.stretches.len();
        let mut start = of.start;
        for at in of.start..of.end - 1 {
            let ends = [fields[at], fields[at + 1]];
            if (ends[0] >= iso) == (ends[1] >= iso) {
                continue;
            }
            if self.want == Want::Any {
                self.stretches.truncate(known);
                self.found.block(here.ray);
                self.done[line] = true;
                return;
            }
            if self.stride == 1 {
                let times = [place(at), place(at + 1)].map(|place| here.time(place));
                self.brackets.push(RayBracket::new(line, here, self.tolerance, iso, times, ends));
            } else {
                if start < at {
                    let places = [place(start), place(at)];
                    self.stretches.push(RayStretch { line, places, field: start });
                }
                self.segments.push(RaySegment { line, place: place(at), fields: ends });
            }
            start = at + 1;
            if self.want == Want::First {
                return;
            }
        }
        if self.stride > 1 && start + 1 < of.end {
            let places = [place(start), place(of.end - 1)];
            self.stretches.push(RayStretch { line, places, field: start });
        }
    }

    /// Finds the hits between coarse places; the batch holds the fields at these.
    fn refine(&mut self, region: &Region, batch: &mut TraceBatch) -> Result<(), TraceError> {
        if self.stretches.is_empty() && self.segments.is_empty() {
            return Ok(());
        }
        let mut refiner = Refiner {
            tracer: self.tracer,
            region,
            lines: &self.lines,
            stride: self.stride,
            tolerance: self.tolerance,
            all: self.want == Want::All,
            found: &mut self.found,
            work: &mut self.work,
        };
        refiner.refine(&self.stretches, &mut self.segments, batch, &mut self.brackets)?;
        self.stretches.clear();
        self.segments.clear();
        let order = |a: &RayBracket, b: &RayBracket| {
            a.line().cmp(&b.line()).then_with(|| a.start().total_cmp(&b.start()))
        };
        self.brackets.sort_by(order);
        if self.want != Want::All {
            self.brackets.dedup_by_key(|bracket| bracket.line());
        }
        Ok(())
    }

    /// Makes hits of the brackets of a cell, as far as they are wanted.
    fn close(&mut self, region: &Region, each: u64, batch: &mut TraceBatch) -> Result<(), EvalError> {
        for bracket in &self.brackets {
            self.done[bracket.line()] = self.want != Want::All;
            if self.want == Want::Any {
                self.found.block(self.lines[bracket.line()].ray);
            }
        }
        if self.want != Want::Any && !self.brackets.is_empty() {
            polish(self.tracer, region, &self.lines, &mut self.brackets, batch)?;
            for bracket in &self.brackets {
                let evaluations = u64::from(bracket.rounds()) * each;
                self.found.count(self.lines[bracket.line()].ray, evaluations as f32);
            }
            self.found.add(self.tracer, region, &self.lines, &self.brackets)?;
        }
        self.brackets.clear();
        Ok(())
    }
}

/// The intersection of two ranges of places.
fn common(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Adds the points of a ray from one place to another, both included. Times are the lattice's, except for the
/// ray's ends.
fn push_places(batch: &mut TraceBatch, line: &RayLine, places: [i64; 2], times: &[f64]) {
    let ends = [0, 1].map(|end| (places[end] == line.places[end]).then(|| line.position(line.span[end])));
    for (axis, plane) in batch.points.iter_mut().enumerate() {
        let (origin, direction) = (line.origin[axis], line.direction[axis]);
        let start = plane.len();
        plane.extend(times.iter().map(|t| (origin + t * direction) as f32));
        let last = plane.len() - 1;
        for (place, position) in [start, last].into_iter().zip(&ends) {
            if let Some(position) = position {
                plane[place] = position[axis];
            }
        }
    }
}
