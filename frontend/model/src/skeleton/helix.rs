//! The helix: a screw line, any part of it.
//!
//! In the pose it begins on the x axis and rises about the z axis, with b the rise for each radian:
//!
//! ```text
//! c(t) = (R cos t, R sin t, b t),   0 <= t <= T = 2 pi turns,   b = pitch / 2 pi
//! ```
//!
//! # The nearest place
//!
//! Of a point at the distance rho from the axis, the angle phi and the height z, the squared distance from
//! c(phi + 2 pi n + s) is, but for a part without s, `b^2 (2 A (1 - cos s) + (s - sigma)^2)`, with `A = rho R
//! / b^2` and `sigma = z / b - phi - 2 pi n`. It is stationary where
//!
//! ```text
//! g(s) = A sin s + s - sigma = 0                                             (Kepler's equation, if A were below 0)
//! ```
//!
//! *Which turn.* On an endless helix it is the turn with |sigma| <= pi: by the mirror images of s in 0 and in
//! pi, the nearest place has an s in [0, sigma]. (Signs are taken off: sigma >= 0 from here on.) If that
//! place is beyond an end, the end is nearer than all turns behind it, with one exception: if the end cuts
//! off the place s = 0 as well, before its turn comes nearest, the first whole turn is next. So n is rounded,
//! and clamped to turns whose s = 0 is on the helix. A turn that is cut off before s = 0 is allowed if the
//! helix begins (or ends) towards the point, not beyond the point's height, and not at a farthest place (A
//! cos s < -1). The candidates are that turn, clamped, and the two ends.
//!
//! *Which place.* Up to the first root, g is below 0, and g is concave in [0, pi]: Newton's steps from the
//! left of the root stay there, and each is nearer. They start at the larger of two places that are never
//! beyond the root, since `sin s <= s` and `sin s <= 4 s (pi - s) / pi^2`:
//!
//! ```text
//! sigma / (1 + A)     and     2 sigma / (q + sqrt(q^2 - 4 k sigma)),   k = 4 A / pi^2,   q = 1 + pi k
//! ```
//!
//! **Error.** The answer is the distance of a place of the curve, so except for rounding it is never too
//! small. After [`STEPS`] steps it is too large by at most 2^-19 of the larger of R and b: at the centres of
//! curvature, where A = 1, sigma = pi and the root is threefold. Elsewhere steps converge quadratically, down
//! to rounding. The tests measure both.
//!
//! The place is computed from the small angle phi + s and the whole number n, so that its rounding does not
//! grow with the number of turns: it is less than 8 units of R and of the height. (With less than one turn n
//! is 0, because the helix is lower than a turn.) The angle is held constant: with a fixed place, the
//! gradient is the gradient of the distance from that place.

use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DVec3};
use jbt_ir::{Domain, limits};

use super::points::{self, NearestPlace};
use super::{SkeletonMember, Symmetry};
use crate::affine::sin_cos_degrees;
use crate::angle::atan2;
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::member::{Member as _, member};

/// Newton's steps of the program.
const STEPS: usize = 5;
/// The largest number of turns.
const MAX_TURNS: f64 = 4096.0;
/// The largest A: above it, s is too small to matter.
const MOST: f32 = 1e18;
/// The largest height, in turns.
const HIGHEST: f32 = 1e9;
/// The least slope that a step divides by.
const LEAST_SLOPE: f32 = 1e-6;
/// 1.5 * 2^23: adding and subtracting it rounds a number below 2^22 to a whole one.
const ROUND: f32 = 12_582_912.0;

member! {
    /// A screw line about an axis. With 0 turns it is a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Helix = "helix" {
        /// The middle of its axis.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction of its axis, of any length but 0: the helix rises along it, counterclockwise as seen
        /// from its tip.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// The direction from the axis to where the helix begins: only the part across the normal counts.
        pub start: DVec3 [Direction] = Vector([1.0, 0.0, 0.0]),
        /// How far it is from its axis.
        pub radius: f64 [NonNegative],
        /// How far it rises in a turn, not 0: below 0 it falls, and is left-handed.
        pub pitch: f64 [Real],
        /// How many turns it has, from 0 to 4096: any number, whole or not.
        pub turns: f64 [Within { least: 0.0, most: MAX_TURNS }],
    }
}

impl Helix {
    /// The angle at its end.
    fn last(&self) -> f64 {
        TAU * self.turns
    }

    /// The rise for each radian.
    fn rise(&self) -> f64 {
        self.pitch / TAU
    }

    /// The place at an angle, in the pose.
    fn at(&self, t: f64) -> DVec3 {
        DVec3::new(self.radius * t.cos(), self.radius * t.sin(), self.rise() * t)
    }

    /// Half the derivative of the squared distance of the place at an angle.
    fn slope(&self, q: DVec3, t: f64) -> f64 {
        self.radius * (q.x * t.sin() - q.y * t.cos()) + self.rise() * (self.rise() * t - q.z)
    }

    /// The nearest places of all turns that may hold the nearest of all, and ends; `q` is in the pose. With
    /// `all`, both ends; otherwise only ends that are nearer than the curve next to them.
    fn places(&self, q: DVec3, all: bool) -> Vec<NearestPlace> {
        let (rho, phi, b) = (q.x.hypot(q.y), q.y.atan2(q.x), self.rise());
        let stretch = rho * self.radius / (b * b);
        let place = |t: f64| NearestPlace {
            distance: q.distance(self.at(t)),
            foot: self.at(t),
            firmness: (rho * self.radius * (t - phi).cos() + b * b) / (self.radius.powi(2) + b * b),
        };
        let nearest = ((q.z / b - phi) / TAU).round();
        let (first, last) = ((-phi / TAU).round(), ((self.last() - phi) / TAU).round());
        let mut turns: Vec<f64> = [nearest.clamp(first, last), first, last]
            .into_iter()
            .flat_map(|turn| [turn - 1.0, turn, turn + 1.0])
            .collect();
        turns.sort_by(f64::total_cmp);
        turns.dedup();
        let place_of = |turn: f64| {
            let middle = phi + TAU * turn;
            let sigma = q.z / b - middle;
            root(stretch, sigma.abs()).map(|s| middle + s.copysign(sigma))
        };
        let inside = |t: &f64| *t >= 0.0 && *t <= self.last();
        let mut places: Vec<NearestPlace> =
            turns.into_iter().filter_map(place_of).filter(inside).map(place).collect();
        let [begins, ends] = [0.0, self.last()].map(|t| self.slope(q, t));
        let all = all || places.is_empty();
        for (t, is_nearest) in [(0.0, all || begins >= 0.0), (self.last(), all || ends <= 0.0)] {
            places.extend(is_nearest.then(|| NearestPlace { firmness: 1.0, ..place(t) }));
        }
        places
    }

    /// The position in the pose.
    fn posed(&self, p: DVec3) -> DVec3 {
        let n = self.normal.normalize();
        let start = (self.start - self.start.dot(n) * n).normalize();
        let v = p - self.center;
        DVec3::new(v.dot(start), v.dot(n.cross(start)), v.dot(n) + 0.5 * self.pitch * self.turns)
    }
}

/// The first root of `a sin s + s - sigma`, for `sigma >= 0`, if it is in [0, pi]: in f64, by bisection.
fn root(a: f64, sigma: f64) -> Option<f64> {
    let value = |s: f64| a * s.sin() + s - sigma;
    // Where g is largest.
    let mut high = if a > 1.0 { (-1.0 / a).acos() } else { PI };
    // Rounding must not lose a root at the end of [0, pi].
    if value(high) < -1e-14 * (a + sigma) {
        return None;
    }
    let mut low = 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if value(middle) < 0.0 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

impl SkeletonMember for Helix {
    // The end; the height of a turn and of a radian, the turns for each height and R / b; the number of
    // turns, the nearest whole number, and the rest as an angle from -pi to pi.
    const COLUMNS: &'static [&'static str] = &[
        "radius", "end_x", "end_y", "end_z", "pitch", "rise", "inv_pitch", "lead", "turns", "whole", "rest",
    ];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn fault(&self) -> Option<Diagnostic> {
        let flat = || {
            let error = Diagnostic::error(None, format!("the `pitch` of the helix is {}", self.pitch));
            error.expected(format!("expected {:e} or more, or as much below 0: an `arc` is flat", limits::MIN_LENGTH))
        };
        let fault = super::along_normal(Self::NAME, "start", self.normal, self.start);
        fault.or_else(|| (self.pitch.abs() < limits::MIN_LENGTH).then(flat))
    }

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let pose = *map * self.pose();
        let mut bounds = Bounds::around([0.0, self.last()].map(|t| pose.transform_point3(self.at(t))));
        for axis in 0..3 {
            // A coordinate is a cos (t - top) + c t: stationary where sin (t - top) = c / a, in each turn;
            // farthest in the first or the last of them.
            let row = pose.matrix3.row(axis);
            let (top, reach) = (row.y.atan2(row.x), self.radius * row.x.hypot(row.y));
            let lean = row.z * self.rise() / reach;
            if lean.is_nan() || lean.abs() >= 1.0 {
                continue;
            }
            for angle in [top + lean.asin(), top + PI - lean.asin()] {
                let (first, last) = ((-angle / TAU).ceil(), ((self.last() - angle) / TAU).floor());
                for turn in [first, last].into_iter().filter(|_| first <= last) {
                    let value = pose.transform_point3(self.at(angle + TAU * turn))[axis];
                    bounds.min[axis] = bounds.min[axis].min(value);
                    bounds.max[axis] = bounds.max[axis].max(value);
                }
            }
        }
        bounds
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        points::distance_squared(self.places(self.posed(p), true))
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        points::kink_distance(&self.places(self.posed(p), false))
    }

    fn pose(&self) -> DAffine3 {
        let turn = super::frame(self.normal, self.start);
        let begin = self.center - 0.5 * self.pitch * self.turns * turn.z_axis;
        DAffine3::from_mat3_translation(turn, begin)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        let (sin, cos) = sin_cos_degrees(360.0 * self.turns);
        let (radius, pitch) = (scale * self.radius, scale * self.pitch);
        let whole = self.turns.round();
        row.extend([radius, radius * cos, radius * sin, pitch * self.turns, pitch, scale * self.rise()]);
        row.extend([1.0 / pitch, self.radius / self.rise(), self.turns, whole, TAU * (self.turns - whole)]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let (radius, end) = (row[0], [row[1], row[2], row[3]]);
        let (pitch, rise, turns, whole, rest) = (row[4], row[5], row[8], row[9], row[10]);
        let curve = HelixCurve::<D> { radius, end, pitch, rise, turns, whole, rest };
        let (phi, height) = (atan2(d, p[1], p[0]), d.mul(p[2], row[6]));
        let height = clamped(d, height, HIGHEST);
        let turn = curve.turn(d, p, phi, height);
        let turn = d.stop_gradient(turn);

        let rho = super::emit_off_axis(d, p);
        // R / b and 1 / b, which is 2 pi / pitch.
        let tau = d.constant(TAU as f32);
        let inverse = d.mul(row[6], tau);
        let stretch = d.mul(rho, inverse);
        let stretch = d.mul(stretch, row[7]);
        let stretch = d.abs(stretch);
        let most = d.constant(MOST);
        let stretch = d.min(stretch, most);
        let above = d.sub(height, turn);
        let back = d.neg(phi);
        let sigma = d.fma(above, tau, back);
        let off = offset(d, stretch, sigma);
        let angle = d.add(phi, off);
        let place = curve.place(d, turn, angle);

        let mut candidates = [place, end].map(|place| {
            let off = std::array::from_fn(|axis| d.sub(p[axis], place[axis]));
            super::length_squared(d, off)
        });
        candidates.reverse();
        let from_begin = d.sub(p[0], radius);
        let begin = super::length_squared(d, [from_begin, p[1], p[2]]);
        candidates.into_iter().fold(begin, |best, square| d.min(square, best))
    }
}

/// `x` in [-most, most]; never NaN.
fn clamped<D: Domain>(d: &mut D, x: D::Real, most: f32) -> D::Real {
    let (least, most) = (d.constant(-most), d.constant(most));
    let x = d.max(x, least);
    d.min(x, most)
}

/// The s of the nearest place, with the sign of sigma: see the module.
fn offset<D: Domain>(d: &mut D, a: D::Real, sigma: D::Real) -> D::Real {
    let (zero, one, pi) = (d.constant(0.0), d.constant(1.0), d.constant(PI as f32));
    let below = d.lt(sigma, zero);
    let sigma = d.abs(sigma);
    let sum = d.add(one, a);
    let linear = d.div(sigma, sum);
    let (ratio, two, four) = (d.constant((4.0 / PI / PI) as f32), d.constant(2.0), d.constant(4.0));
    let k = d.mul(a, ratio);
    let q = d.fma(k, pi, one);
    let (square, product) = (d.mul(q, q), d.mul(k, sigma));
    let product = d.mul(four, product);
    let rest = d.sub(square, product);
    let rest = super::positive_part(d, rest);
    let root = d.sqrt(rest);
    let (twice, sum) = (d.mul(two, sigma), d.add(q, root));
    let parabola = d.div(twice, sum);
    let start = d.max(parabola, linear);
    let most = d.min(sigma, pi);
    let mut s = d.min(start, most);
    let least = d.constant(LEAST_SLOPE);
    for _ in 0..STEPS {
        let (sin, cos) = (d.sin(s), d.cos(s));
        let left = d.sub(sigma, s);
        let minus = d.neg(a);
        let (miss, slope) = (d.fma(minus, sin, left), d.fma(a, cos, one));
        let slope = d.max(slope, least);
        let by = d.div(miss, slope);
        let next = d.add(s, by);
        let next = super::positive_part(d, next);
        s = d.min(next, most);
    }
    let minus = d.neg(s);
    d.select(below, minus, s)
}

/// A helix as the program sees it: see [`Helix::COLUMNS`](SkeletonMember::COLUMNS).
struct HelixCurve<D: Domain> {
    radius: D::Real,
    end: [D::Real; 3],
    pitch: D::Real,
    rise: D::Real,
    turns: D::Real,
    whole: D::Real,
    rest: D::Real,
}

impl<D: Domain> HelixCurve<D> {
    /// The number of the turn that may hold the nearest place; `height` is in turns.
    fn turn(&self, d: &mut D, p: [D::Real; 3], phi: D::Real, height: D::Real) -> D::Real {
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        // Half the derivatives of the squared distance at both ends.
        let (beside, up) = (d.mul(p[1], self.radius), d.mul(p[2], self.rise));
        let minus_begin = d.add(beside, up);
        let (across, along) = (d.mul(p[0], self.end[1]), d.mul(p[1], self.end[0]));
        let across = d.sub(across, along);
        let above = d.sub(self.end[2], p[2]);
        let ends = d.fma(self.rise, above, across);

        // The part of the second derivatives that decides: below 0, the place is farthest.
        let square = d.mul(self.rise, self.rise);
        let begin_bends = d.fma(p[0], self.radius, square);
        let end_bends = d.fma(p[0], self.end[0], square);
        let end_bends = d.fma(p[1], self.end[1], end_bends);
        let (begin_near, end_near) = (d.le(zero, begin_bends), d.le(zero, end_bends));

        let (enters, above) = (d.le(zero, minus_begin), d.le(zero, height));
        let enters = d.both(enters, above);
        let (enters, cut) = (d.both(enters, begin_near), d.lt(phi, zero));
        let first = d.select(cut, one, zero);
        let earlier = d.sub(first, one);
        let first = d.select(enters, earlier, first);
        let (leaves, below) = (d.le(zero, ends), d.le(height, self.turns));
        let leaves = d.both(leaves, below);
        let (leaves, cut) = (d.both(leaves, end_near), d.lt(self.rest, phi));
        let before = d.sub(self.whole, one);
        let last = d.select(cut, before, self.whole);
        let later = d.add(last, one);
        let last = d.select(leaves, later, last);

        let part = d.constant((-1.0 / TAU) as f32);
        let turn = d.fma(phi, part, height);
        let turn = clamped(d, turn, (MAX_TURNS + 8.0) as f32);
        let round = d.constant(ROUND);
        let turn = d.add(turn, round);
        let turn = d.sub(turn, round);
        let turn = d.min(turn, last);
        d.max(turn, first)
    }

    /// The place at an angle in a turn, clamped to the ends, with zero derivative.
    fn place(&self, d: &mut D, turn: D::Real, angle: D::Real) -> [D::Real; 3] {
        let (zero, one, tau) = (d.constant(0.0), d.constant(1.0), d.constant(TAU as f32));
        // With less than a turn, the roundings of a whole turn would be too large.
        let is_part = d.lt(self.turns, one);
        let shift = d.select(is_part, turn, zero);
        let (turn, angle) = (d.sub(turn, shift), d.fma(shift, tau, angle));
        let left = d.sub(self.whole, turn);
        let most = d.fma(left, tau, self.rest);
        let behind = d.mul(turn, tau);
        let least = d.neg(behind);
        let angle = d.min(angle, most);
        let angle = d.max(angle, least);
        let angle = d.stop_gradient(angle);
        let (cos, sin) = (d.cos(angle), d.sin(angle));
        let below = d.mul(turn, self.pitch);
        [d.mul(self.radius, cos), d.mul(self.radius, sin), d.fma(self.rise, angle, below)]
    }
}

#[cfg(test)]
mod tests;
