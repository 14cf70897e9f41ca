//! Refinement: hits between neighbouring coarse places of rays.
//!
//! ```text
//! coarse places  |-------------------------------|-------------------------------|     all on one side: a stretch of two segments
//! places         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
//!
//! a group, stretches of rays side by side    a range of the field on one side of iso: nothing is there
//!                                            else: cut, along or across, until few segments are left
//! a segment                                  all of its places are asked, and neighbours on different sides hold a hit
//! ```
//!
//! A segment whose ends are on different sides is evaluated without a range. The result equals that of
//! evaluating all places: ranges only save evaluations whose results they prove.

use std::ops::Range;

use super::batch::{TraceBatch, WorkLimit};
use super::error::TraceError;
use super::found::FoundHits;
use super::polish::RayBracket;
use super::ray::RayLine;
use super::target::Target;
use crate::boxes::Box3;
use crate::prune::Region;

/// Neighbouring coarse places of a ray that are on one side.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct RayStretch {
    pub(super) line: usize,
    /// The first and the last place.
    pub(super) places: [i64; 2],
    /// The index of the field at the first place; the fields at the other places follow.
    pub(super) field: usize,
}

/// Stretches of neighbouring rays, clipped to two coarse places.
struct StretchGroup {
    stretches: Range<usize>,
    places: [i64; 2],
    /// The number of its segments, once it is tight.
    segments: usize,
}

/// From a coarse place of a ray to the next one.
pub(super) struct RaySegment {
    pub(super) line: usize,
    pub(super) place: i64,
    /// The fields at both ends.
    pub(super) fields: [f32; 2],
}

/// The number of stretches that begin as one group: about the rays of a pixel.
const TOGETHER: usize = 4;
/// The number of boxes whose ranges cost as much as one.
const LANES: usize = 16;
/// The number of places up to which evaluating them is faster than one more run of ranges. Only time depends
/// on it.
const WORTH_ASKING: usize = 140;

/// The inputs of the refinement of a cell.
pub(super) struct Refiner<'a> {
    pub(super) tracer: &'a Target,
    /// The region of all stretches.
    pub(super) region: &'a Region,
    pub(super) lines: &'a [RayLine],
    /// Steps of the lattice from one coarse place to the next, on all lines.
    pub(super) stride: i64,
    pub(super) tolerance: f64,
    /// Whether all changes of a ray are wanted, or only the first.
    pub(super) all: bool,
    pub(super) found: &'a mut FoundHits,
    pub(super) work: &'a mut WorkLimit,
}

impl Refiner<'_> {
    /// Finds the changes of side in segments and in stretches, in no particular order. The fields of the
    /// stretches are among those in the batch.
    pub(super) fn refine(
        &mut self,
        stretches: &[RayStretch],
        segments: &mut Vec<RaySegment>,
        batch: &mut TraceBatch,
        brackets: &mut Vec<RayBracket>,
    ) -> Result<(), TraceError> {
        let fields = std::mem::take(&mut batch.field);
        self.undecided(stretches, &fields, segments)?;
        batch.field = fields;
        if segments.is_empty() {
            return Ok(());
        }
        batch.clear();
        for &RaySegment { line, place, .. } in &*segments {
            self.lines[line].push_between(place, batch.planes());
        }
        let inner = self.stride as usize - 1;
        self.work.spend((segments.len() * inner) as u64)?;
        batch.ask(self.tracer, self.region)?;
        let each = self.tracer.field.evaluations_in(self.region) as f32;
        for (segment, asked) in segments.iter().zip(batch.field.chunks_exact(inner)) {
            self.found.count(self.lines[segment.line].ray, inner as f32 * each);
            self.find(segment, asked, brackets);
        }
        Ok(())
    }

    /// Adds the segments of stretches whose ranges do not prove one side.
    fn undecided(
        &mut self,
        stretches: &[RayStretch],
        fields: &[f32],
        segments: &mut Vec<RaySegment>,
    ) -> Result<(), TraceError> {
        let iso = self.tracer.iso;
        let starts = (0..stretches.len()).step_by(TOGETHER);
        let mut groups: Vec<StretchGroup> = starts
            .map(|start| StretchGroup {
                stretches: start..(start + TOGETHER).min(stretches.len()),
                places: [i64::MIN, i64::MAX],
                segments: 0,
            })
            .collect();
        let known = |(stretch, place): (&RayStretch, i64)| {
            let field = stretch.field + (place - stretch.places[0]) as usize;
            RaySegment { line: stretch.line, place, fields: [fields[field], fields[field + 1]] }
        };
        let worth_asking = WORTH_ASKING / (self.stride as usize - 1);
        let mut boxes = Vec::with_capacity(groups.len());
        loop {
            boxes.clear();
            groups.retain_mut(|group| {
                let bounds = group.tighten(stretches, self.lines);
                boxes.extend(bounds);
                bounds.is_some()
            });
            let asked: usize = groups.iter().map(|group| group.segments).sum();
            if asked <= worth_asking * boxes.len().div_ceil(LANES) {
                groups.iter().for_each(|group| segments.extend(group.segments(stretches).map(known)));
                return Ok(());
            }
            self.work.spend(boxes.len() as u64)?;
            let (ranges, each) = self.tracer.pruner.many_ranges(self.region, &boxes)?;
            let mut parts = Vec::new();
            for (group, [low, high]) in groups.iter().zip(ranges) {
                let share = each as f32 / group.stretches.len() as f32;
                for stretch in &stretches[group.stretches.clone()] {
                    self.found.count(self.lines[stretch.line].ray, share);
                }
                if low >= iso || high < iso {
                    continue;
                }
                if group.is_segment() {
                    segments.extend(group.segments(stretches).map(known));
                } else {
                    group.cut(&mut parts);
                }
            }
            groups = parts;
        }
    }

    /// The changes of side in a segment, from the fields at the places in it.
    fn find(&self, segment: &RaySegment, asked: &[f32], brackets: &mut Vec<RayBracket>) {
        let iso = self.tracer.iso;
        let line = &self.lines[segment.line];
        let [start, end] = segment.fields;
        let mut before = start;
        for (place, &field) in (segment.place * self.stride..).zip(asked.iter().chain([&end])) {
            if (before >= iso) != (field >= iso) {
                let times = [place, place + 1].map(|place| line.time_between(place));
                brackets.push(RayBracket::new(
                    segment.line,
                    line,
                    self.tolerance,
                    iso,
                    times,
                    [before, field],
                ));
                if !self.all {
                    return;
                }
            }
            before = field;
        }
    }
}

impl StretchGroup {
    /// Shrinks the group to its segments; `None` if it has none, else the box around them.
    fn tighten(&mut self, stretches: &[RayStretch], lines: &[RayLine]) -> Option<Box3> {
        let mut bounds: Option<Box3> = None;
        let (mut members, mut places) = (self.stretches.end..self.stretches.start, [i64::MAX, i64::MIN]);
        self.segments = 0;
        for index in self.stretches.clone() {
            let RayStretch { line, places: mine, .. } = stretches[index];
            let [first, last] = [mine[0].max(self.places[0]), mine[1].min(self.places[1])];
            if first >= last {
                continue;
            }
            members = members.start.min(index)..index + 1;
            places = [places[0].min(first), places[1].max(last)];
            self.segments += (last - first) as usize;
            let [start, end] = lines[line].ends([first, last]);
            let bounds = bounds.get_or_insert(Box3::new(start, start));
            for axis in 0..3 {
                let [low, high] = in_order(start[axis], end[axis]);
                bounds.low[axis] = in_order(bounds.low[axis], low)[0];
                bounds.high[axis] = in_order(bounds.high[axis], high)[1];
            }
        }
        (self.stretches, self.places) = (members, places);
        bounds
    }

    /// Its segments, each with its stretch.
    fn segments<'a>(
        &self,
        stretches: &'a [RayStretch],
    ) -> impl Iterator<Item = (&'a RayStretch, i64)> + use<'a> {
        let [first, last] = self.places;
        stretches[self.stretches.clone()].iter().flat_map(move |stretch| {
            let [from, to] = [stretch.places[0].max(first), stretch.places[1].min(last)];
            (from..to).map(move |place| (stretch, place))
        })
    }

    fn is_segment(&self) -> bool {
        self.stretches.len() == 1 && self.places[1] - self.places[0] == 1
    }

    /// Adds its quarters, as far as they exist: it is cut across if it is longer than wide, counted in
    /// segments and rays.
    fn cut(&self, parts: &mut Vec<Self>) {
        for half in self.halves() {
            parts.extend(half.halves());
        }
    }

    fn halves(&self) -> impl Iterator<Item = Self> + use<> {
        let [first, last] = self.places;
        let Range { start, end } = self.stretches;
        let halves = if (last - first) as usize >= end - start {
            let cut = first + (last - first) / 2;
            [(start..end, [first, cut]), (start..end, [cut, last])]
        } else {
            let cut = start + (end - start) / 2;
            [(start..cut, [first, last]), (cut..end, [first, last])]
        };
        let halves = halves.into_iter().map(|(stretches, places)| Self { stretches, places, segments: 0 });
        halves.filter(|half| half.places[0] < half.places[1] && !half.stretches.is_empty())
    }
}

/// The smaller and the larger one of two numbers, which are no NaN.
fn in_order(a: f32, b: f32) -> [f32; 2] {
    [if b < a { b } else { a }, if b > a { b } else { a }]
}
