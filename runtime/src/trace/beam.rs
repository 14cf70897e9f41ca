//! A beam: bounds of the origins and directions of some rays, and boxes around parts of these rays.
//!
//! A position is `f32(origin + t * direction)` with each operation rounded in f64. Rounding is monotone. So
//! for t between two ends, and origins and directions between two bounds, every coordinate is between the
//! results of the same operations for ends and bounds: boxes need no margin.

use super::ray::RayLine;
use crate::boxes::Box3;

/// What is known of some rays with one step.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Beam {
    origin: [[f64; 2]; 3],
    direction: [[f64; 2]; 3],
    /// The common step.
    pub(super) step: f64,
    /// The first and the last place of any ray.
    pub(super) places: [i64; 2],
    /// The number of rays.
    pub(super) rays: usize,
}

impl Beam {
    /// The beam of some rays; `None` if there are none.
    pub(super) fn around<'a>(lines: impl IntoIterator<Item = &'a RayLine>) -> Option<Self> {
        let mut lines = lines.into_iter();
        let first = lines.next()?;
        let mut beam = Self {
            origin: first.origin.map(|x| [x, x]),
            direction: first.direction.map(|x| [x, x]),
            step: first.step,
            places: first.places,
            rays: 1,
        };
        for line in lines {
            debug_assert_eq!(line.step, beam.step, "rays of a run have one lattice");
            for axis in 0..3 {
                widen(&mut beam.origin[axis], line.origin[axis]);
                widen(&mut beam.direction[axis], line.direction[axis]);
            }
            beam.places[0] = beam.places[0].min(line.places[0]);
            beam.places[1] = beam.places[1].max(line.places[1]);
            beam.rays += 1;
        }
        Some(beam)
    }

    /// A box that holds the positions of all rays between two places, both included.
    pub(super) fn bounds(&self, places: [i64; 2]) -> Box3 {
        let times = places.map(|place| place as f64 * self.step);
        let mut bounds = Box3::default();
        for axis in 0..3 {
            let [low, high] = self.sides(axis, times);
            // A corner of the box is the corner of no ray, and may be beyond f32 though no ray is.
            let near = |side: f64| (side as f32).clamp(f32::MIN, f32::MAX);
            (bounds.low[axis], bounds.high[axis]) = (near(low), near(high));
        }
        bounds
    }

    /// The length of the rays between two places, and their distance from each other in the middle, both
    /// along the longest side of a box.
    pub(super) fn proportions(&self, places: [i64; 2]) -> [f64; 2] {
        let length = |axis: usize| {
            let [low, high] = self.direction[axis];
            low.abs().max(high.abs())
        };
        let longest = (0..3).map(length).fold(0.0, f64::max);
        let middle = 0.5 * (places[0] as f64 + places[1] as f64) * self.step;
        let width = |axis: usize| {
            let [low, high] = self.sides(axis, [middle, middle]);
            high - low
        };
        let steps = (places[1] - places[0]) as f64;
        [steps * self.step * longest, (0..3).map(width).fold(0.0, f64::max)]
    }

    /// The bounds of a coordinate between two times.
    fn sides(&self, axis: usize, [from, to]: [f64; 2]) -> [f64; 2] {
        let ([low, high], [least, most]) = (self.origin[axis], self.direction[axis]);
        let products = [from * least, from * most, to * least, to * most];
        let [from, to] = [
            products.iter().copied().fold(f64::INFINITY, f64::min),
            products.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ];
        [low + from, high + to]
    }
}

fn widen([low, high]: &mut [f64; 2], number: f64) {
    // One instruction each, because no number is NaN.
    *low = if number < *low { number } else { *low };
    *high = if number > *high { number } else { *high };
}
