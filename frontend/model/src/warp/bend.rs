//! The bend: a straight spine becomes an arc (Barr 1984).
//!
//! ```text
//!                      centre of          about the axis `axis`, here x; the spine runs along the axis behind it, y, and bends
//!       ____           curvature          towards the one behind that, z (in the order x y z x), if the rate is positive
//!      /    \          o
//!     |      | to      |  1/rate          between `from` and `to`, a length s of the spine turns by rate * s;
//!   from   ^ |      ---+---- y            beyond, everything goes on straight
//!          z
//! ```
//!
//! `center` is the place on the spine that stays. With Y measured from there, `A = 1 - k Z`, `B = k Y`, and
//! the distance from the centre of curvature in radii, `h = sqrt(A^2 + B^2)`, the inverse map is
//!
//! ```text
//! inside:   s = atan2(B, A) / k          y = center + s          z = (1 - h) / k = (2 Z - k (Y^2 + Z^2)) / (1 + h)
//! beyond:   with t = k e at the end e    y = center + e + Y cos t + (Z - 1/k) sin t          z = 1/k - Y sin t + (Z - 1/k) cos t
//! ```
//!
//! Nothing is divided by k: this form of z, and an arctangent by the half angle (`angle`), stay precise for
//! any small k, and a rate of 0 is the identity. (The form that is usually printed, `z = 1/k + h / |k|`,
//! takes the other one of two roots.)
//!
//! **Limits.** The part of the child beyond 1/k, behind the centre of curvature, is not seen inside the bend:
//! its material would be there twice. A bend of more than half a turn to one side ends at half a turn, and a
//! straight part ends where it crosses the side opposite of the middle. The whole spine meets at the centre
//! of curvature; within [`SMALLEST_DISTANCE`] of it, in radii, s fades to 0, so that everything is finite.

use std::f64::consts::PI;

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::Domain;

use super::{WarpGrowth, ROUNDINGS, UNDERFLOW, WarpFault, WarpMember, farthest};
use crate::affine::map_bounds;
use crate::angle;
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::member::member;

/// The distance from the centre of curvature below which the spine fades, in radii: 2^-16.
pub const SMALLEST_DISTANCE: f64 = 1.0 / 65_536.0;
/// The largest rate, in magnitude.
pub const LARGEST_RATE: f64 = 1e6;
/// Products of rate and coordinates up to this limit have finite squares.
const LARGEST_PRODUCT: f64 = (1_u64 << 60) as f64;
/// Two squares of coordinates up to this limit, or of such coordinates times a rate up to 1, have a finite
/// sum in f32: 2^63.
const FARTHEST: f32 = (1_u64 << 63) as f32;

member! {
    /// A bend of a spine through the origin.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Bend = "bend" {
        /// The axis about which it turns.
        pub axis: Axis [Axis] = Vector([0.0, 0.0, 1.0]),
        /// Radians for each unit of length along the spine: the curvature.
        pub rate: f64 [Real],
        /// One end of what is bent.
        pub from: f64 [Real],
        /// The other end.
        pub to: f64 [Real],
        /// The place on the spine that stays.
        pub center: f64 [Real] = Real(0.0),
    }
}

/// An end of the bend, and the rigid map from the warped space to the child's beyond it, in coordinates (Y,
/// Z) and (y, z).
struct End {
    /// The place on the spine, from the centre.
    at: f64,
    cos: f64,
    sin: f64,
    /// What is added to y and z.
    shift: [f64; 2],
}

/// `sin(t) / t` and `(1 - cos t) / t`.
fn per_angle(t: f64) -> [f64; 2] {
    if t == 0.0 {
        return [1.0, 0.0];
    }
    let half = 0.5 * t;
    [t.sin() / t, half.sin() * (half.sin() / half)]
}

impl Bend {
    /// The lower and the upper end.
    fn ends(&self) -> [End; 2] {
        let [low, high] = [self.from.min(self.to), self.from.max(self.to)];
        [low, high].map(|place| {
            let at = place - self.center;
            let (sin, cos) = (self.rate * at).sin_cos();
            let [along, across] = per_angle(self.rate * at);
            End { at, cos, sin, shift: [place - at * along, at * across] }
        })
    }

    /// Half a turn as a length of the spine; 0 if the rate is 0.
    fn half_turn(&self) -> f64 {
        if self.rate == 0.0 { 0.0 } else { PI / self.rate.abs() }
    }

    /// The place on the spine, from the centre, and the distance from the centre of curvature in radii.
    fn spine(&self, p: DVec3) -> angle::Polar<f64> {
        let [_, u, v] = self.axis.order();
        let y = p[u] - self.center;
        let point = [1.0 - self.rate * p[v], self.rate * y];
        angle::plain(point, y, self.half_turn(), SMALLEST_DISTANCE)
    }

    /// The image (Y, Z) of the place s of the spine at height z.
    fn arc(&self, s: f64, z: f64) -> [f64; 2] {
        let (sin, cos) = (self.rate * s).sin_cos();
        let [along, across] = per_angle(self.rate * s);
        [self.center + s * along - z * sin, z * cos + s * across]
    }

    /// A box around the image of a child, in the bent part and in the straight parts, with each part `slack`
    /// longer than it is.
    fn bent(&self, child: Bounds, slack: f64) -> Bounds {
        let [a, u, v] = self.axis.order();
        let [lower, upper] = self.ends();
        let mut all = Bounds::EMPTY;
        for (end, side) in [(&lower, -1.0), (&upper, 1.0)] {
            let mut beyond = child;
            // If the centre is not beyond this end, points beyond the end come from beyond it in the child as
            // well.
            let place = self.center + end.at;
            if side > 0.0 && end.at >= 0.0 {
                beyond.min[u] = beyond.min[u].max(place - slack);
            } else if side < 0.0 && end.at <= 0.0 {
                beyond.max[u] = beyond.max[u].min(place + slack);
            }
            all = all.hull(self.rigid(end, beyond));
        }
        let [first, last] = [child.min[u], child.max[u]].map(|y| y - self.center);
        let (first, last) = (first.max(lower.at - slack), last.min(upper.at + slack));
        if first <= last {
            let half = self.half_turn();
            let turns = [-half, -0.5 * half, 0.0, 0.5 * half, half].into_iter();
            let extremes = turns.filter(|s| first < *s && *s < last);
            for s in extremes.chain([first, last]) {
                for z in [child.min[v], child.max[v]] {
                    let mut p = child.min;
                    [p[u], p[v]] = self.arc(s, z);
                    let mut q = p;
                    q[a] = child.max[a];
                    all = all.hull(Bounds::around([p, q]));
                }
            }
        }
        all
    }

    /// The image of the rigid part beyond an end.
    fn rigid(&self, end: &End, beyond: Bounds) -> Bounds {
        if beyond.is_empty() {
            return Bounds::EMPTY;
        }
        let [a, u, v] = self.axis.order();
        let axis = |index: usize| DVec3::AXES[index];
        let mut columns = [DVec3::ZERO; 3];
        columns[a] = axis(a);
        columns[u] = end.cos * axis(u) - end.sin * axis(v);
        columns[v] = end.sin * axis(u) + end.cos * axis(v);
        let back = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let shift = end.shift[0] * axis(u) + end.shift[1] * axis(v);
        let forward = back.transpose();
        let origin = self.center * axis(u);
        map_bounds(&DAffine3::from_mat3_translation(forward, origin - forward * shift), beyond)
    }
}

impl WarpMember for Bend {
    const COLUMNS: &'static [&'static str] = &[
        "rate", "center", "half_turn", "low", "low_cos", "low_sin", "low_y", "low_z", "high", "high_cos",
        "high_sin", "high_y", "high_z",
    ];

    fn inverse(&self, p: DVec3) -> DVec3 {
        let [_, u, v] = self.axis.order();
        let (y, z) = (p[u] - self.center, p[v]);
        let spine = self.spine(p);
        let [lower, upper] = self.ends();
        let rigid = |end: &End| {
            let [sin, cos] = [end.sin, end.cos];
            [end.shift[0] + cos * y + sin * z, end.shift[1] - sin * y + cos * z]
        };
        let mut q = p;
        [q[u], q[v]] = if spine.angle < lower.at {
            rigid(&lower)
        } else if spine.angle > upper.at {
            rigid(&upper)
        } else {
            let height = (2.0 * z - self.rate * (y * y + z * z)) / (1.0 + spine.distance);
            [self.center + spine.angle, height]
        };
        q
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.rate == 0.0 {
            return f64::INFINITY;
        }
        let [_, u, v] = self.axis.order();
        let spine = self.spine(p);
        let [lower, upper] = self.ends().map(|end| (spine.angle - end.at).abs() * spine.distance.min(1.0));
        // Opposite of the middle, the two straight parts meet.
        let cut = if self.rate * p[v] > 1.0 { (p[u] - self.center).abs() } else { f64::INFINITY };
        lower.min(upper).min(cut).min(spine.distance / self.rate.abs())
    }

    fn fault(&self) -> Option<WarpFault> {
        if (self.to - self.from).abs() < jbt_ir::limits::MIN_LENGTH {
            let message = format!("the bend goes from {} to {}", self.from, self.to);
            return Some(WarpFault { message, expected: "expected two different places" });
        }
        (self.rate.abs() > LARGEST_RATE).then(|| WarpFault {
            message: format!("the rate of the bend is {}", self.rate),
            expected: "expected at most 1e6 in magnitude",
        })
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        if child.is_empty() || self.rate == 0.0 {
            return child;
        }
        if child.is_finite() { self.bent(child, 0.0) } else { all_of_space(self.axis, child) }
    }

    /// Let L be the distance of the point from the place that stays. The child's point is no farther from
    /// that place, along the spine and then up.
    ///
    /// Away from the centre of curvature (h > 1/2) the products of k are off by 4 units of 2^-24 of
    /// `1 + |k| L <= 2 + h`, which moves s and z by less than 64 units of L. Nearer, `1 / |k| <= 2 L`, and
    /// the error equals a shift of the point by less than 16 units of L; the arctangent adds 2^-21 of the
    /// angle, on a radius below L. Beyond the ends a rotation is off by 6 units of its sum. The choice
    /// between the three parts may be wrong only within the error of s, times h for a length.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() {
            return child;
        }
        if !child.is_finite() {
            return all_of_space(self.axis, child);
        }
        let ends = self.from.abs().max(self.to.abs());
        let size = 2.0 * (farthest(child) + self.center.abs() + ends);
        let turn = self.rate.abs() * size;
        let mut slack = 4.0 * ROUNDINGS * size * (2.0 + turn) + UNDERFLOW;
        if turn > 0.25 {
            // The box may hold the centre of curvature, where s fades.
            slack += 4.0 * SMALLEST_DISTANCE / self.rate.abs();
        }
        self.bent(child.grown(slack), slack).grown(slack)
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        let turn = self.rate.abs() * (largest + self.center.abs());
        if turn > LARGEST_PRODUCT {
            return WarpGrowth::UNKNOWN;
        }
        let ends = self.from.abs().max(self.to.abs());
        let coordinates = 4.0 * (largest + self.center.abs() + ends);
        WarpGrowth { coordinates, derivatives: 64.0 / SMALLEST_DISTANCE + 16.0 * (1.0 + turn).powi(2) }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.extend([self.rate, self.center, self.half_turn().min(f64::from(f32::MAX))]);
        for end in self.ends() {
            row.extend([end.at, end.cos, end.sin, end.shift[0], end.shift[1]]);
        }
    }

    fn variant(&self) -> u8 {
        self.axis as u8
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [_, u, v] = Axis::ALL[usize::from(variant)].order();
        let [rate, center, half_turn] = row[..3] else { unreachable!("a bend has thirteen columns") };
        let (far_y, far_z) = (d.sub(p[u], center), p[v]);
        let one = d.constant(1.0);
        let back = d.neg(rate);
        // Where squares of coordinates in radii would overflow, the point is replaced by a nearer one, which
        // is still far from the whole spine.
        let (steep, farthest) = (d.abs(rate), d.constant(FARTHEST));
        let steep = d.max(steep, one);
        let farthest = d.div(farthest, steep);
        let nearest = d.neg(farthest);
        let mut near = |far| {
            let near = d.min(far, farthest);
            d.max(near, nearest)
        };
        let (y, z) = (near(far_y), near(far_z));
        let across = d.fma(back, z, one);
        let along = d.mul(rate, y);
        let spine = angle::emit(d, [across, along], y, half_turn, SMALLEST_DISTANCE as f32);

        let square = d.mul(z, z);
        let square = d.fma(y, y, square);
        let twice = d.add(z, z);
        let height = d.fma(back, square, twice);
        let divisor = d.add(spine.distance, one);
        let height = d.div(height, divisor);
        // Inside the bend the limits do not change s; elsewhere they keep ranges small.
        let inside = d.max(row[3], spine.angle);
        let inside = d.min(row[8], inside);
        let inside = d.add(inside, center);

        let lower = rigid(d, far_y, far_z, &row[4..8]);
        let upper = rigid(d, far_y, far_z, &row[9..13]);
        let (below, above) = (d.lt(spine.angle, row[3]), d.lt(row[8], spine.angle));
        let mut q = p;
        for ((axis, inside), (lower, upper)) in
            [(u, inside), (v, height)].into_iter().zip(lower.into_iter().zip(upper))
        {
            let beyond = d.select(above, upper, inside);
            q[axis] = d.select(below, lower, beyond);
        }
        q
    }
}

/// The rigid map beyond an end: `row` holds its cosine, its sine and its shift.
fn rigid<D: Domain>(d: &mut D, y: D::Real, z: D::Real, row: &[D::Real]) -> [D::Real; 2] {
    let [cos, sin, shift_y, shift_z] = row[..] else { unreachable!("an end has four columns") };
    let first = d.fma(cos, y, shift_y);
    let first = d.fma(sin, z, first);
    let back = d.neg(sin);
    let second = d.fma(back, y, shift_z);
    let second = d.fma(cos, z, second);
    [first, second]
}

/// Unbounded across the axis.
fn all_of_space(axis: Axis, child: Bounds) -> Bounds {
    let [_, u, v] = axis.order();
    let mut all = child;
    for axis in [u, v] {
        (all.min[axis], all.max[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    all
}

#[cfg(test)]
mod tests {
    use jbt_ir::domain::scalar::Scalar;

    use super::*;
    use crate::warp::{Warp, testing};

    const BEND: Bend = Bend { axis: Axis::X, rate: 0.5, from: -1.0, to: 2.0, center: 0.25 };

    /// Barr's forward map as published, with the place that stays in the middle.
    fn forward(bend: &Bend, q: DVec3) -> DVec3 {
        let (k, clamped) = (bend.rate, q.y.clamp(bend.from, bend.to));
        let (sin, cos) = (k * (clamped - bend.center)).sin_cos();
        let beyond = q.y - clamped;
        let y = -sin * (q.z - 1.0 / k) + bend.center + cos * beyond;
        DVec3::new(q.x, y, cos * (q.z - 1.0 / k) + 1.0 / k + sin * beyond)
    }

    fn random(rng: &mut fastrand::Rng) -> Bend {
        let [rate, from, to, center] = [(); 4].map(|()| testing::real(rng));
        Bend { axis: Axis::ALL[rng.usize(..3)], rate, from, to, center }
    }

    #[test]
    fn undoes_what_barr_does() {
        let mut rng = fastrand::Rng::with_seed(1);
        let mut seen = 0;
        for _ in 0..20_000 {
            let bend = Bend { axis: Axis::X, from: -1.0 - rng.f64(), to: 0.5 + rng.f64(), ..random(&mut rng) };
            let bend = Bend { center: 0.4 * bend.center, ..bend };
            let q = DVec3::from_array([(); 3].map(|()| testing::real(&mut rng)));
            let turn = (bend.rate * (q.y.clamp(bend.from, bend.to) - bend.center)).abs();
            let straight = q.y < bend.from || q.y > bend.to;
            // A straight part crosses the far side only after a quarter turn.
            let most = if straight { 0.5 * PI } else { 3.1 };
            if 1.0 - bend.rate * q.z < 1e-3 || turn > most || bend.rate.abs() < 1e-3 {
                continue;
            }
            seen += 1;
            let back = bend.inverse(forward(&bend, q));
            assert!(back.abs_diff_eq(q, 1e-9), "{bend:?}: {q} became {back}");
        }
        assert!(seen > 10_000, "{seen}");
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(random);
    }

    #[test]
    fn bend_at_rate_zero_is_the_identity() {
        let mut rng = fastrand::Rng::with_seed(2);
        for axis in Axis::ALL {
            let bend = Bend { axis, rate: 0.0, from: -0.5, to: 0.5, center: 0.0 };
            for _ in 0..1000 {
                let p = DVec3::from_array([(); 3].map(|()| testing::real(&mut rng))).as_vec3();
                assert_eq!(bend.inverse(p.as_dvec3()), p.as_dvec3());
                assert_eq!(testing::emitted(&bend, p), p);
                testing::finite(&bend.into(), p.as_dvec3());
            }
            let child = Bounds::new(DVec3::NEG_ONE, DVec3::ONE);
            assert_eq!(bend.forward_bounds(child), child);
        }
    }

    /// The published form takes the root with the other sign: it moves the point (0, 0, 0), which has to
    /// stay, to the height 2/k.
    #[test]
    fn the_root_has_the_right_sign() {
        for rate in [0.5, -0.5] {
            let bend = Bend { rate, ..BEND };
            let stays = DVec3::new(0.0, 0.25, 0.0);
            testing::same(&bend.into(), stays, stays);
            let published = 1.0 / rate + 1.0 / rate.abs();
            assert!((published - 2.0 * rate.signum().max(0.0) / rate).abs() < 1e-15);
        }
    }

    #[test]
    fn ends_are_rigid() {
        let (a, b) = (DVec3::new(0.0, 2.5, 1.0), DVec3::new(1.0, 3.5, -0.5));
        let (p, q) = (forward(&BEND, a), forward(&BEND, b));
        assert!((p.distance(q) - a.distance(b)).abs() < 1e-12);
        testing::same(&BEND.into(), p, a);
        testing::same(&BEND.into(), q, b);
    }

    #[test]
    fn digits_stay_however_small_the_rate_is() {
        let mut rng = fastrand::Rng::with_seed(3);
        for rate in [0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-12] {
            let bend = Bend { axis: Axis::X, rate, from: -1.0, to: 1.0, center: 0.0 };
            let mut row = Vec::new();
            bend.columns(&mut row);
            let row: Vec<f32> = row.into_iter().map(|number| number as f32).collect();
            let used = Bend { rate: f64::from(row[0]), ..bend };
            let mut worst = 0.0_f64;
            for _ in 0..20_000 {
                let p = DVec3::from_array([(); 3].map(|()| 2.0 * rng.f64() - 1.0)).as_vec3();
                let found = DVec3::from_array(Bend::emit(&mut Scalar, 0, p.to_array(), &row).map(f64::from));
                worst = worst.max((found - used.inverse(p.as_dvec3())).abs().max_element());
            }
            assert!(worst <= 2.5e-7, "{worst:e} at rate {rate}");
        }
    }

    #[test]
    fn the_centre_of_curvature_is_finite() {
        let centre = DVec3::new(0.0, 0.25, 2.0);
        for off in [0.0, 1e-30, 1e-9, 1e-6, 1e-3] {
            for p in [centre, centre + DVec3::Y * off, centre - DVec3::Z * off, centre + DVec3::ONE * off] {
                testing::finite(&Warp::from(BEND), p);
            }
        }
        testing::finite(&BEND.into(), DVec3::new(1e6, -1e6, 1e6));
        assert!(BEND.inverse(centre).y == 0.25);
    }

    #[test]
    fn what_makes_no_bend_is_a_fault() {
        assert_eq!(BEND.fault(), None);
        assert_eq!(Bend { to: -1.0, ..BEND }.fault().unwrap().message, "the bend goes from -1 to -1");
        assert_eq!(Bend { rate: -2e6, ..BEND }.fault().unwrap().message, "the rate of the bend is -2000000");
    }
}
