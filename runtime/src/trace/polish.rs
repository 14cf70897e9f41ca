//! From two places on different sides to the change of side: guarded false position, for all brackets of a
//! cell at once.
//!
//! ```text
//! while a bracket is too long:
//!     try where the line through its ends meets the iso-value; an end that stays a second time has counted double (Illinois, Dowell and Jarratt 1971)
//!         not nearer to an end than half of the wanted length: so a good guess closes the bracket with the next one
//!         in the middle, if the last three tries have not halved it, or if the fields are no numbers
//!     the half in which the side changes is the new bracket
//! ```
//!
//! The final bracket depends only on the field along its ray.

use super::batch::TraceBatch;
use super::ray::{RayLine, spacing};
use super::target::Target;
use crate::error::EvalError;
use crate::prune::Region;

/// The wanted length of a bracket, as a part of the tolerance.
const PRECISION: f64 = 1.0 / 1024.0;
/// The number of tries after which a bracket must be at most half as long.
const CHECKED: u32 = 3;

/// A stretch of a ray whose ends are on different sides.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct RayBracket {
    line: usize,
    times: [f64; 2],
    /// The fields at the ends minus the iso-value, as weights of false position: the weight of an end that
    /// stays is halved.
    weighed: [f64; 2],
    /// The end that stayed last.
    stayed: Option<usize>,
    entering: bool,
    /// The length, in t, at which the bracket is short enough.
    wanted: f64,
    rounds: u32,
    /// The length to be halved by the next check.
    checked: f64,
}

impl RayBracket {
    pub(super) fn new(
        index: usize,
        line: &RayLine,
        tolerance: f64,
        iso: f32,
        times: [f64; 2],
        fields: [f32; 2],
    ) -> Self {
        let positions = times.map(|t| line.position(t));
        let farthest = positions.as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        let wanted = (PRECISION * tolerance).max(spacing(f64::from(farthest))) / line.length;
        let weighed = fields.map(|field| f64::from(field) - f64::from(iso));
        Self {
            line: index,
            times,
            weighed,
            stayed: None,
            entering: fields[1] >= iso,
            wanted,
            rounds: 0,
            checked: times[1] - times[0],
        }
    }

    /// The line.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Its first t.
    pub(super) fn start(&self) -> f64 {
        self.times[0]
    }

    /// Whether the ray enters.
    pub(super) fn entering(&self) -> bool {
        self.entering
    }

    /// The number of evaluations of the field.
    pub(super) fn rounds(&self) -> u32 {
        self.rounds
    }

    /// The hit: the inner end. Where a field jumps, the outer end would not see the solid.
    pub(super) fn best(&self) -> f64 {
        self.times[usize::from(self.entering)]
    }

    fn width(&self) -> f64 {
        self.times[1] - self.times[0]
    }

    fn middle(&self) -> f64 {
        self.times[0] + 0.5 * self.width()
    }

    /// The next t to evaluate; `None` if the bracket is short enough, or f64 has no t between its ends.
    fn next(&mut self) -> Option<f64> {
        let [low, high] = self.times;
        let (width, middle) = (self.width(), self.middle());
        if width <= self.wanted || middle <= low || middle >= high {
            return None;
        }
        self.rounds += 1;
        let mut halve = false;
        if self.rounds.is_multiple_of(CHECKED) {
            halve = width > 0.5 * self.checked;
            self.checked = width;
        }
        let guess = meet(self.times, self.weighed);
        if halve || !guess.is_finite() {
            return Some(middle);
        }
        let guard = 0.5 * self.wanted;
        let guess = guess.max(low + guard).min(high - guard);
        Some(if low < guess && guess < high { guess } else { middle })
    }

    /// Replaces an end by a t with this field.
    fn take(&mut self, time: f64, field: f32, iso: f32) {
        let replaced = usize::from((field >= iso) == self.entering);
        let stays = 1 - replaced;
        self.times[replaced] = time;
        self.weighed[replaced] = f64::from(field) - f64::from(iso);
        if self.stayed == Some(stays) {
            self.weighed[stays] *= 0.5;
        }
        self.stayed = Some(stays);
    }
}

/// The zero of the line through two points. Not finite if their heights are equal.
fn meet(times: [f64; 2], heights: [f64; 2]) -> f64 {
    times[0] + (times[1] - times[0]) * (heights[0] / (heights[0] - heights[1]))
}

/// Shortens brackets. All are in the region.
pub(super) fn polish(
    tracer: &Target,
    region: &Region,
    lines: &[RayLine],
    brackets: &mut [RayBracket],
    batch: &mut TraceBatch,
) -> Result<(), EvalError> {
    let mut open: Vec<usize> = (0..brackets.len()).collect();
    let mut times = Vec::with_capacity(open.len());
    while !open.is_empty() {
        batch.clear();
        times.clear();
        open.retain(|&index| {
            let bracket = &mut brackets[index];
            let next = bracket.next();
            if let Some(time) = next {
                batch.push(lines[bracket.line].position(time));
                times.push(time);
            }
            next.is_some()
        });
        batch.ask(tracer, region)?;
        for ((&index, &time), &field) in open.iter().zip(&times).zip(&batch.field) {
            brackets[index].take(time, field, tracer.iso);
        }
    }
    Ok(())
}
