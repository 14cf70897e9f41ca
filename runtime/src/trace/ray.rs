//! Rays, and the places on them where the field is evaluated.
//!
//! ```text
//! span     [------------------------------------------------]          what was given
//! clipped        [----------------------------]                        where the field may differ from 0
//! lattice     |  *--+-----+-----+-----+-----+-*   |     |     |        multiples of the step; the ends of the span close it
//! ```
//!
//! A place of the lattice is evaluated only if it matters. One of each `stride` places is a *coarse place*;
//! cells consist of coarse places. Answers do not depend on the stride.
//!
//! The step is the tolerance divided by the length of the direction, cut to four binary digits. So rays with
//! directions of about the same length have the same step, and one lattice of t. The product of a place's
//! number and the step is exact. The lattice begins at t = 0, so a ray's places depend on the ray alone, not
//! on its packet or its span.

use jbt_model::bounds::Bounds;

use super::error::TraceError;
use crate::boxes::Box3;
use crate::support::MARGIN;

/// The points `origin + t * direction` for t in the span. The direction may have any length but 0; t counts
/// in units of that length.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ray {
    /// The point at t = 0.
    pub origin: [f64; 3],
    /// The vector from t = 0 to t = 1.
    pub direction: [f64; 3],
    /// The smallest and the largest t, both finite and included.
    pub span: [f64; 2],
}

/// Steps of the lattice from one coarse place to the next, where the tolerance is much finer than the model.
/// Only time depends on it.
pub(super) const STRIDE: i64 = 16;

/// A box outside of which the field is 0, with a margin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct RayReach(Box3<f64>);

/// The part of a coordinate by which the box exceeds it at least.
const ROUNDING: f64 = 1.0 / (1 << 20) as f64;
/// The shortest step whose multiples have all digits of f64.
const SHORTEST: f64 = 1e-300;
/// The longest step: every multiple in use is finite.
const LONGEST: f64 = 1e300;
/// The range of squared lengths with all digits.
const SQUARES: [f64; 2] = [1e-200, 1e200];
/// A bound of the error of a product and a sum in f64, as a part of the terms.
const TINY: f64 = 1.0 / (1_u64 << 48) as f64;

impl RayReach {
    /// `None` if the field is 0 everywhere.
    pub(super) fn new(support: Bounds) -> Option<Self> {
        if support.is_empty() {
            return None;
        }
        let (low, high) = (support.low(), support.high());
        let sides = low.iter().zip(&high).map(|(low, high)| high - low);
        let margin = MARGIN * sides.filter(|side| side.is_finite()).fold(0.0, f64::max);
        let beyond = |side: f64| margin + ROUNDING * if side.is_finite() { side.abs() } else { 0.0 };
        Some(Self(Box3::new(low.map(|side| side - beyond(side)), high.map(|side| side + beyond(side)))))
    }

    /// The part of a ray's span that is in the box (Kay and Kajiya 1986, "Ray tracing complex scenes":
    /// slabs).
    fn clip(&self, ray: &Ray) -> Option<[f64; 2]> {
        let [mut enter, mut exit] = ray.span;
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
            let rounding = TINY * origin.abs();
            let low = self.0.low[axis] - rounding - origin;
            let high = self.0.high[axis] + rounding - origin;
            if direction == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let [a, b] = [low / direction, high / direction];
            enter = enter.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        (enter <= exit).then_some([enter, exit])
    }
}

/// A ray that may hit something, with its lattice.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct RayLine {
    /// The index of the ray in the packet.
    pub(super) ray: u32,
    pub(super) origin: [f64; 3],
    pub(super) direction: [f64; 3],
    /// The clipped span.
    pub(super) span: [f64; 2],
    /// The difference of t between coarse places.
    pub(super) step: f64,
    /// The coarse places at the ends of the span, which stand for the ends.
    pub(super) places: [i64; 2],
    /// The number of lattice steps between coarse places.
    stride: i64,
    /// The length of the direction.
    pub(super) length: f64,
}

impl RayLine {
    /// Checks a ray; `None` if it does not come near the model.
    pub(super) fn new(
        index: usize,
        ray: &Ray,
        tolerance: f64,
        stride: i64,
        reach: Option<&RayReach>,
    ) -> Result<Option<Self>, TraceError> {
        let Ray { origin, direction, span } = *ray;
        if !origin.iter().chain(&direction).chain(&span).all(|number| number.is_finite()) {
            return Err(TraceError::NotFinite { ray: index, origin, direction, span });
        }
        if direction == [0.0; 3] {
            return Err(TraceError::Direction { ray: index });
        }
        if span[0] > span[1] {
            return Err(TraceError::Span { ray: index, span });
        }
        let Some(span) = reach.and_then(|reach| reach.clip(ray)) else { return Ok(None) };
        let length = length(direction);
        let resolution = resolution(index, ray, span)?.max(SHORTEST * length);
        if tolerance < resolution {
            return Err(TraceError::Resolution { ray: index, tolerance, resolution });
        }
        let step = four_digits((tolerance / length).min(LONGEST)) * stride as f64;
        let places = [last_before(span[0], step), -last_before(-span[1], step)];
        // Ray numbers are below 2^32: MAX_PACKET_RAYS.
        Ok(Some(Self { ray: index as u32, origin, direction, span, step, places, stride, length }))
    }

    /// The t of a coarse place: its lattice t, or an end of the span.
    pub(super) fn time(&self, place: i64) -> f64 {
        match self.places.iter().position(|&end| end == place) {
            Some(end) => self.span[end],
            None => place as f64 * self.step,
        }
    }

    /// The t of a place of the lattice, numbered in single steps. Places beyond the span have the t of its
    /// ends. Monotone in the place.
    pub(super) fn time_between(&self, place: i64) -> f64 {
        self.within(place as f64 * (self.step / self.stride as f64))
    }

    /// The positions of two coarse places, where the field is evaluated.
    pub(super) fn ends(&self, places: [i64; 2]) -> [[f32; 3]; 2] {
        // Places at the ends are clamped to the span, so this is `time`.
        places.map(|place| self.position(self.within(place as f64 * self.step)))
    }

    /// Adds the positions at the places between a coarse place and the next one, by coordinates.
    pub(super) fn push_between(&self, place: i64, planes: &mut [Vec<f32>; 3]) {
        let (fine, first) = (self.step / self.stride as f64, (place * self.stride) as f64);
        let mut times = [0.0; STRIDE as usize];
        for (step, time) in times.iter_mut().enumerate() {
            *time = (first + f64::from(step as u32)) * fine;
        }
        if place <= self.places[0] || place + 1 >= self.places[1] {
            times.iter_mut().for_each(|time| *time = self.within(*time));
        }
        let times = &times[1..self.stride as usize];
        for (axis, plane) in planes.iter_mut().enumerate() {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            plane.extend(times.iter().map(|t| (origin + t * direction) as f32));
        }
    }

    /// The t clamped to the span.
    fn within(&self, t: f64) -> f64 {
        let t = if t < self.span[0] { self.span[0] } else { t };
        if t > self.span[1] { self.span[1] } else { t }
    }

    /// The position at t, where the field is evaluated: each coordinate is monotone in t.
    pub(super) fn position(&self, t: f64) -> [f32; 3] {
        let at = |axis: usize| (self.origin[axis] + t * self.direction[axis]) as f32;
        [at(0), at(1), at(2)]
    }
}

/// The last place of the lattice that is not after t. Places strictly between the first and the last place of
/// a ray are inside of its span.
fn last_before(t: f64, step: f64) -> i64 {
    // Below 2^50, because the tolerance is above the resolution. The product with the step is exact, but the
    // quotient is rounded.
    let quotient = t / step;
    let whole = quotient as i64 as f64;
    let near = if whole > quotient { whole - 1.0 } else { whole };
    let place = if near * step > t {
        near - 1.0
    } else if (near + 1.0) * step <= t {
        near + 1.0
    } else {
        near
    };
    place as i64
}

/// The length of a vector, finite whatever the vector is.
fn length(vector: [f64; 3]) -> f64 {
    let square = vector.iter().map(|x| x * x).sum::<f64>();
    if (SQUARES[0]..=SQUARES[1]).contains(&square) {
        return square.sqrt();
    }
    vector[0].hypot(vector[1]).hypot(vector[2]).min(f64::MAX)
}

/// A number's first four binary digits.
fn four_digits(number: f64) -> f64 {
    f64::from_bits(number.to_bits() & !((1 << 49) - 1))
}

/// The smallest tolerance that the positions of a clipped ray allow.
fn resolution(index: usize, ray: &Ray, span: [f64; 2]) -> Result<f64, TraceError> {
    let (mut farthest, mut terms): (f64, f64) = (0.0, 0.0);
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    for t in span {
        let way = ray.direction.map(|along| t * along);
        let position = [0, 1, 2].map(|axis| ray.origin[axis] + way[axis]);
        for axis in 0..3 {
            farthest = larger(farthest, position[axis].abs());
            terms = larger(larger(terms, ray.origin[axis].abs()), way[axis].abs());
        }
        if farthest >= f64::from(f32::MAX) {
            return Err(TraceError::Far { ray: index, position });
        }
    }
    Ok(spacing(farthest).max(TINY * terms))
}

/// The distance from a coordinate to the next f32.
pub(super) fn spacing(coordinate: f64) -> f64 {
    let near = (coordinate.abs() as f32).min(f32::MAX.next_down());
    f64::from(near.next_up()) - f64::from(near)
}
