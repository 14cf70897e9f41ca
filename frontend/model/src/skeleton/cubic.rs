//! A curved piece of a tube: all balls with centres on a cubic Bezier curve, whose radii are a cubic of the
//! same parameter.
//!
//! # The nearest ball
//!
//! With centre c(t) and radius r(t), the tube's distance from p is the minimum over t of
//! `g(t) = |p - c(t)| - r(t)`. There is no closed form. On the host the curve is halved until each piece is
//! nearly a [`Cone`]: the piece's second differences bound how far its balls are from the balls of the cone
//! over its chord, at the same parameter,
//!
//! ```text
//! |c(t) - chord(t)| + |r(t) - taper(t)| <= deviation = 3/4 max over i of |c_i - 2 c_(i+1) + c_(i+2)| + |r_i - 2 r_(i+1) + r_(i+2)|
//! ```
//!
//! The program starts at the nearest ball of the cone, takes [`STEPS`] of Newton's steps along g', clamped to
//! the piece, and answers with the best ball on the way (to within 2^-20 of its distance for each step).
//!
//! **Error.** The answer is the distance of a ball of the tube, so it is never too small. The start alone is
//! too large by at most twice the deviation:
//! `g(start) <= cone(start) + deviation <= cone(best) + deviation <= g(best) + 2 deviation`. A piece is
//! accepted with a deviation of at most [`COARSE`] support radii, so the distance is wrong by at most
//! `2 COARSE` of the radius, or by 2^-23 of the whole cubic's deviation where [`MAX_CURVE_HALVINGS`] end the
//! division. The steps do far better where the curve turns little: accepted pieces turn by at most [`TURN`]
//! (or deviate by less than [`FINE`]), and at a point nearer than the centre of curvature each step squares
//! the error. At 10^5 random points within reach of random curves and tubes the error is below 1e-5 of the
//! support radius (and rounding) for all but a few, which are near a centre of curvature, and 6e-5 at worst.
//!
//! The place is held constant, so the gradient is the unit vector from the ball's centre: it is off from the
//! normal by as much as the place is off. That is rounding, except where the nearest place is close to the
//! end of a piece: within the root of a rounding, half a thousandth of the distance. There the distances of
//! both pieces are alike, and either piece may answer. So gradients are off by half a milliradian at worst,
//! where the minimum is firm.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;
use jbt_ir::limits::MAX_CURVE_HALVINGS;

use super::points::NearestPlace;
use super::tapered::Cone;
use super::tube::TubePart;
use crate::bounds::Bounds;

/// Newton's steps.
pub(super) const STEPS: usize = 3;
/// A piece may deviate by this part of the support radius.
pub(super) const COARSE: f64 = 1.0 / 32.0;
/// A piece may turn, and change its speed, by about this much (radians, and parts), ...
const TURN: f64 = 0.5;
/// ... unless it deviates by less than this part of the support radius: at cusps.
const FINE: f64 = 1.0 / (1 << 14) as f64;
/// The least part of the squared speed that a step divides by: where the minimum is flat or near a maximum, a
/// step must be short.
const DAMPING: f32 = 0.25;

/// Distances of places that differ by less than this part count as equal.
const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// The balls along a cubic Bezier curve.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Cubic {
    pub(super) centers: [DVec3; 4],
    pub(super) radii: [f64; 4],
}

impl Cubic {
    /// The cone over the chord.
    fn chord(&self) -> Cone {
        Cone { centers: [self.centers[0], self.centers[3]], radii: [self.radii[0], self.radii[3]] }
    }

    /// A bound of the distance from its chord: see the module.
    pub(super) fn deviation(&self) -> f64 {
        let second = |i: usize| {
            let center = self.centers[i] - 2.0 * self.centers[i + 1] + self.centers[i + 2];
            let radius = self.radii[i] - 2.0 * self.radii[i + 1] + self.radii[i + 2];
            center.length() + radius.abs()
        };
        0.75 * second(0).max(second(1))
    }

    fn is_straight(&self, reach: f64) -> bool {
        let deviation = self.deviation();
        // The second derivative is at most 8 deviations long.
        let turns = 8.0 * deviation > TURN * self.centers[0].distance(self.centers[3]);
        deviation <= FINE * reach || (deviation <= COARSE * reach && !turns)
    }

    /// Both halves, by de Casteljau's midpoints.
    fn halves(&self) -> [Self; 2] {
        let (c, r) = (&self.centers, &self.radii);
        let c1 = [0, 1, 2].map(|i| c[i].midpoint(c[i + 1]));
        let c2 = [0, 1].map(|i| c1[i].midpoint(c1[i + 1]));
        let c3 = c2[0].midpoint(c2[1]);
        let half = |a: f64, b: f64| 0.5 * (a + b);
        let r1 = [0, 1, 2].map(|i| half(r[i], r[i + 1]));
        let r2 = [0, 1].map(|i| half(r1[i], r1[i + 1]));
        let r3 = half(r2[0], r2[1]);
        [
            Self { centers: [c[0], c1[0], c2[0], c3], radii: [r[0], r1[0], r2[0], r3] },
            Self { centers: [c3, c2[1], c1[2], c[3]], radii: [r3, r2[1], r1[2], r[3]] },
        ]
    }

    /// The coefficients of the powers of t, for centres and for radii.
    fn powers(&self) -> ([DVec3; 4], [f64; 4]) {
        let [c0, c1, c2, c3] = self.centers;
        let [r0, r1, r2, r3] = self.radii;
        (
            [c0, 3.0 * (c1 - c0), 3.0 * (c0 - 2.0 * c1 + c2), c3 - c0 + 3.0 * (c1 - c2)],
            [r0, 3.0 * (r1 - r0), 3.0 * (r0 - 2.0 * r1 + r2), r3 - r0 + 3.0 * (r1 - r2)],
        )
    }

    /// The ball at a place.
    pub(super) fn at(&self, t: f64) -> (DVec3, f64) {
        let s = 1.0 - t;
        let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        let center = self.centers.iter().zip(weights).map(|(c, w)| w * *c).sum();
        (center, self.radii.iter().zip(weights).map(|(r, w)| w * r).sum())
    }

    /// The distance from the ball at a place.
    pub(super) fn distance_at(&self, p: DVec3, t: f64) -> f64 {
        let (center, radius) = self.at(t);
        p.distance(center) - radius
    }

    /// How firmly a nearest ball is held at its place: the second derivative of the distance, divided by its
    /// value on a straight line. It is 0 at a centre of curvature.
    pub(super) fn firmness(&self, p: DVec3, t: f64) -> f64 {
        let ([_, c1, c2, c3], [_, _, r2, r3]) = self.powers();
        let e = self.at(t).0 - p;
        let speed = (c1 + t * (2.0 * c2 + 3.0 * t * c3)).length_squared();
        let bend = e.dot(2.0 * c2 + 6.0 * t * c3) - (2.0 * r2 + 6.0 * t * r3) * e.length();
        if speed > 0.0 { 1.0 + bend / speed } else { 0.0 }
    }
}

impl TubePart for Cubic {
    const COLUMNS: &'static [&'static str] = &[
        "px", "py", "pz", "c1x", "c1y", "c1z", "c2x", "c2y", "c2z", "c3x", "c3y", "c3z", "r0", "r1", "r2",
        "r3", //
        "gx", "gy", "gz", "lean",
    ];

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let image = self.centers.map(|center| map.transform_point3(center));
        let side = |axis: usize, sign: f64| {
            let reach = map.matrix3.row(axis).length();
            // The reach of a ball is a cubic too.
            let values = [0, 1, 2, 3].map(|i| sign * image[i][axis] + reach * self.radii[i]);
            sign * largest(values)
        };
        let corner = |sign: f64| DVec3::from_array([0, 1, 2].map(|axis| side(axis, sign)));
        Bounds::new(corner(-1.0), corner(1.0))
    }

    fn columns(&self, to_pose: &DAffine3, scale: f64, row: &mut Vec<f64>) {
        let mut own = *self;
        if self.chord().taper() == Err(1) {
            // The start of the piece is its larger end.
            own.centers.reverse();
            own.radii.reverse();
        }
        own.centers = own.centers.map(|center| scale * to_pose.transform_point3(center));
        own.radii = own.radii.map(|radius| scale * radius);
        let (centers, radii) = own.powers();
        row.extend(centers.iter().flat_map(DVec3::to_array));
        row.extend(radii);
        // The map from a point to its place along the chord, and from its distance from the chord to the
        // shift by the taper.
        let chord = own.centers[3] - own.centers[0];
        let (along, lean) = match own.chord().taper() {
            Ok((_, lean)) => (super::unit(chord) / chord.length(), lean / chord.length()),
            Err(_) => (DVec3::ZERO, 0.0),
        };
        row.extend(along.to_array());
        row.push(lean);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], piece: &[D::Real]) -> D::Real {
        let curve = CubicCurve::new(d, p, piece);
        let mut t = curve.start(d, [piece[16], piece[17], piece[18]], piece[19]);
        let at = curve.ball(d, t);
        let mut best = (at.distance, t);
        t = curve.step(d, t, &at);
        for _ in 1..STEPS {
            let at = curve.ball(d, t);
            best = nearer(d, (&at, t), best);
            t = curve.step(d, t, &at);
        }
        let at = curve.ball(d, t);
        let (_, t) = nearer(d, (&at, t), best);
        let t = d.stop_gradient(t);
        curve.ball(d, t).distance
    }

    fn places(parts: impl Iterator<Item = Self>, p: DVec3) -> Vec<NearestPlace> {
        let mut places = Vec::new();
        for cubic in parts {
            let at = |i: usize| i as f64 / SAMPLES as f64;
            let distances: Vec<f64> = (0..=SAMPLES).map(|i| cubic.distance_at(p, at(i))).collect();
            for i in 0..=SAMPLES {
                let (before, behind) = (i.saturating_sub(1), (i + 1).min(SAMPLES));
                if distances[i] <= distances[before] && distances[i] <= distances[behind] {
                    let t = minimum(at(before), at(behind), |t| cubic.distance_at(p, t));
                    let t = if cubic.distance_at(p, at(i)) < cubic.distance_at(p, t) { at(i) } else { t };
                    let firmness = if t > 0.0 && t < 1.0 { cubic.firmness(p, t) } else { 1.0 };
                    places.push(NearestPlace {
                        distance: cubic.distance_at(p, t),
                        foot: cubic.at(t).0,
                        firmness,
                    });
                }
            }
        }
        places
    }

    fn divided(parts: impl Iterator<Item = Self>, reach: f64) -> impl Iterator<Item = Self> {
        parts.flat_map(move |cubic| {
            let mut waiting = vec![(cubic, 0)];
            std::iter::from_fn(move || {
                loop {
                    let (cubic, halvings) = waiting.pop()?;
                    if halvings == MAX_CURVE_HALVINGS || cubic.is_straight(reach) {
                        return Some(cubic);
                    }
                    let [first, second] = cubic.halves();
                    waiting.extend([(second, halvings + 1), (first, halvings + 1)]);
                }
            })
        })
    }
}

/// The distance and the place of the nearer ball, the later one if they are alike: where the distance is
/// flat, its rounding must not choose the place farther from the minimum, where the gradient has another
/// direction.
fn nearer<D: Domain>(
    d: &mut D,
    (later, t): (&Ball<D>, D::Real),
    (best, best_t): (D::Real, D::Real),
) -> (D::Real, D::Real) {
    let slack = d.constant(-SLACK);
    let least = d.fma(later.length, slack, later.distance);
    let is_later = d.le(least, best);
    (d.select(is_later, later.distance, best), d.select(is_later, t, best_t))
}

/// The largest value of a cubic with these Bezier coefficients in [0, 1].
fn largest([a, b, c, d]: [f64; 4]) -> f64 {
    let value = |t: f64| {
        let s = 1.0 - t;
        s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
    };
    // Its derivative, in Bernstein's form u s^2 + 2 v s t + w t^2, has roots s : t = (-v +- root) : u,
    // written without cancellation.
    let (u, v, w) = (b - a, c - b, d - c);
    let root = (v * v - u * w).max(0.0).sqrt();
    let q = -(v + v.signum() * root);
    [(u, q), (q, w)].into_iter().fold(a.max(d), |most, (x, y)| {
        // u s = q t, or q s = w t.
        let t = x / (x + y);
        if (0.0..=1.0).contains(&t) { most.max(value(t)) } else { most }
    })
}

/// A piece, as seen from a point.
struct CubicCurve<D: Domain> {
    /// From the first end to the point.
    from_start: [D::Real; 3],
    /// Coefficients of the first, second and third power.
    powers: [[D::Real; 3]; 3],
    /// Coefficients of the radius.
    radii: [D::Real; 4],
}

/// A ball at a place, seen from a point.
struct Ball<D: Domain> {
    /// From the point to the centre.
    center: [D::Real; 3],
    /// The length of `center`.
    length: D::Real,
    /// The distance of the ball.
    distance: D::Real,
}

impl<D: Domain> CubicCurve<D> {
    fn new(d: &mut D, p: [D::Real; 3], piece: &[D::Real]) -> Self {
        Self {
            from_start: std::array::from_fn(|axis| d.sub(p[axis], piece[axis])),
            powers: [3, 6, 9].map(|at| [piece[at], piece[at + 1], piece[at + 2]]),
            radii: [piece[12], piece[13], piece[14], piece[15]],
        }
    }

    /// The place of the nearest ball of the cone over the chord.
    fn start(&self, d: &mut D, along: [D::Real; 3], lean: D::Real) -> D::Real {
        let [first, second, third] = self.powers;
        let chord = std::array::from_fn(|axis| {
            let two = d.add(first[axis], second[axis]);
            d.add(two, third[axis])
        });
        let t = super::dot(d, self.from_start, along);
        let beside = super::minus_multiple(d, self.from_start, t, chord);
        let beside = super::length(d, beside);
        let t = d.fma(beside, lean, t);
        unit_interval(d, t)
    }

    fn ball(&self, d: &mut D, t: D::Real) -> Ball<D> {
        let center = std::array::from_fn(|axis| {
            let [first, second, third] = self.powers.map(|power| power[axis]);
            let at = d.fma(t, third, second);
            let at = d.fma(t, at, first);
            let from_start = d.neg(self.from_start[axis]);
            d.fma(t, at, from_start)
        });
        let length = super::length(d, center);
        let [zeroth, first, second, third] = self.radii;
        let radius = d.fma(t, third, second);
        let radius = d.fma(t, radius, first);
        let radius = d.fma(t, radius, zeroth);
        Ball { center, length, distance: d.sub(length, radius) }
    }

    /// The first and second derivative of a cubic with these coefficients of its first to third power.
    fn derivatives(d: &mut D, t: D::Real, [first, second, third]: [D::Real; 3]) -> [D::Real; 2] {
        let (two, three) = (d.constant(2.0), d.constant(3.0));
        let (twice, thrice) = (d.mul(two, second), d.mul(three, third));
        let half_more = d.fma(t, thrice, twice);
        let once = d.fma(t, half_more, first);
        [once, d.fma(t, thrice, half_more)]
    }

    /// Newton's step for `|p - c| g' = (c - p) c' - r' |p - c| = 0`. At a root, the derivative of the left
    /// side is `c'^2 - r'^2 + (c - p) c'' - r'' |p - c|`.
    fn step(&self, d: &mut D, t: D::Real, at: &Ball<D>) -> D::Real {
        let of_axis: [[D::Real; 2]; 3] = std::array::from_fn(|axis| {
            let powers = self.powers.map(|power| power[axis]);
            Self::derivatives(d, t, powers)
        });
        let (velocity, bend) = (of_axis.map(|[once, _]| once), of_axis.map(|[_, twice]| twice));
        let [growth, swell] = Self::derivatives(d, t, [self.radii[1], self.radii[2], self.radii[3]]);
        let along = super::dot(d, at.center, velocity);
        let growing = d.mul(growth, at.length);
        let off = d.sub(along, growing);
        let speed = super::length_squared(d, velocity);
        let bending = super::dot(d, at.center, bend);
        let swelling = d.mul(swell, at.length);
        let bent = d.sub(bending, swelling);
        let taper = d.mul(growth, growth);
        let slope = d.sub(speed, taper);
        let slope = d.add(slope, bent);
        let damping = d.constant(DAMPING);
        let least = d.mul(damping, speed);
        let slope = d.max(slope, least);
        let by = d.div(off, slope);
        let next = d.sub(t, by);
        unit_interval(d, next)
    }
}

/// `t` clamped to [0, 1]: 0 for NaN.
fn unit_interval<D: Domain>(d: &mut D, t: D::Real) -> D::Real {
    let t = super::positive_part(d, t);
    let one = d.constant(1.0);
    d.min(t, one)
}

/// The number of samples of a cubic before its minima are bracketed.
const SAMPLES: usize = 64;

/// The minimum of a function between two places, by golden sections.
fn minimum(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..42 {
        let [a, b] = [high - ratio * (high - low), low + ratio * (high - low)];
        if value(a) < value(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use jbt_ir::domain::scalar::Scalar;

    use super::*;
    use crate::skeleton::testing::{direction, position};

    /// The smallest distance that the program finds in f32, over the pieces for a support radius.
    fn found(cubic: Cubic, reach: f64, p: DVec3) -> f64 {
        let nearest = Cubic::divided([cubic].into_iter(), reach).map(|piece| {
            let mut row = Vec::new();
            piece.columns(&DAffine3::IDENTITY, 1.0, &mut row);
            assert_eq!(row.len(), Cubic::COLUMNS.len());
            let row: Vec<f32> = row.into_iter().map(|x| x as f32).collect();
            f64::from(Cubic::emit(&mut Scalar, p.as_vec3().to_array(), &row))
        });
        nearest.fold(f64::INFINITY, f64::min)
    }

    /// The smallest distance from many balls of the tube: an upper bound of the tube's distance.
    fn brute_force(cubic: &Cubic, p: DVec3, balls: u32) -> f64 {
        let at = |i| cubic.distance_at(p, f64::from(i) / f64::from(balls));
        (0..=balls).map(at).fold(f64::INFINITY, f64::min)
    }

    fn random(rng: &mut fastrand::Rng) -> Cubic {
        let radius = if rng.bool() { 0.0 } else { 0.3 };
        Cubic {
            centers: std::array::from_fn(|_| 0.2 * position(rng)),
            radii: std::array::from_fn(|_| radius * rng.f64()),
        }
    }

    /// The module's statement of the error, at 10^5 points within reach.
    #[test]
    fn the_error_is_as_stated() {
        let mut rng = fastrand::Rng::with_seed(7);
        let (mut worst, mut beyond, mut points) = (0.0_f64, [0_u32; 4], 0);
        let mut worst_plain = 0.0_f64;
        while points < 100_000 {
            let cubic = random(&mut rng);
            let reach = 10f64.powf(-2.0 * rng.f64());
            for _ in 0..100 {
                let (center, radius) = cubic.at(rng.f64());
                let p = center + direction(&mut rng) * (radius + reach * rng.f64());
                let p = p.as_vec3().as_dvec3();
                let nearest = Cubic::places([cubic].into_iter(), p)
                    .iter()
                    .map(|place| place.distance)
                    .fold(f64::INFINITY, f64::min);
                worst_plain = worst_plain.max(nearest - brute_force(&cubic, p, 300));
                let error = (found(cubic, reach, p) - nearest).abs() / reach;
                worst = worst.max(error);
                for (count, bound) in beyond.iter_mut().zip([1e-5, 1e-4, 1e-3, 1e-2]) {
                    *count += u32::from(error > bound + 1e-6 / reach);
                }
                points += 1;
            }
        }
        assert!(worst_plain < 1e-9, "the plain search misses a minimum: {worst_plain}");
        // 5.1e-5 is what this seed gives; 2 COARSE is what is proven.
        assert!(worst <= 1e-3, "{worst} of the radius");
        assert!(beyond[0] < 100, "{beyond:?} of {points} are beyond 1e-5, 1e-4, 1e-3, 1e-2");
    }
}
