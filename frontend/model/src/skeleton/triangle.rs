//! The triangle: the skeleton of plates and of solids made of them.
//!
//! The pose puts the triangle into the plane z = 0, the longest side on the x axis with its middle at the
//! origin, and the third corner below it. Then
//!
//! ```text
//!     A ─────────────── B        d^2 = z^2 + (inside ? 0 : the nearest of three sides)
//!       \           /            side:   |s| beyond its half length, squared, + q^2
//!          \    /                s, q:   along the side from its middle, and outwards from it
//!             C
//! ```
//!
//! A point is inside where all three q are negative, and |s| of the longest side is within its half length.
//! The last condition follows from the others, except by rounding in a very flat triangle: it keeps the error
//! to the size of the rounding.

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::{Domain, limits};

use super::formulas::emit_unit;
use super::{SkeletonMember, Symmetry};
use super::segment::segment_distance_squared;
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A filled triangle. Corners on a line make it a segment, equal ones a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Triangle = "triangle" {
        /// A corner.
        pub a: DVec3 [Position],
        /// A corner.
        pub b: DVec3 [Position],
        /// A corner.
        pub c: DVec3 [Position],
    }
}

/// The height of a triangle, as a part of its longest side, below which it counts as flat for its uv.
const FLATTEST: f64 = 1e-6;

/// Columns of one of the two shorter sides: outward normal (x, y), offsets of s and q, half length.
const SIDE: usize = 5;

impl Triangle {
    /// The corners in an order that puts the longest side first, from the first corner to the second.
    fn longest_first(&self) -> [DVec3; 3] {
        let turns =
            [[self.a, self.b, self.c], [self.b, self.c, self.a], [self.c, self.a, self.b]];
        let side = |corners: &[DVec3; 3]| corners[0].distance_squared(corners[1]);
        turns.into_iter().reduce(|best, next| if side(&next) > side(&best) { next } else { best }).unwrap_or(turns[0])
    }

    /// The gradients of the barycentric weights of b and c; zero if the triangle is flat.
    fn weights(&self) -> [DVec3; 2] {
        let (to_b, to_c) = (self.b - self.a, self.c - self.a);
        let n = to_b.cross(to_c);
        let longest = to_b.length().max(to_c.length()).max(self.b.distance(self.c));
        if n.length() <= FLATTEST * longest * longest || longest < limits::MIN_LENGTH {
            return [DVec3::ZERO; 2];
        }
        // Two divisions in a row: the square of an area may overflow f64.
        let (unit, area) = (n.normalize(), n.length());
        [to_c.cross(unit) / area, unit.cross(to_b) / area]
    }
}

impl SkeletonMember for Triangle {
    const COLUMNS: &'static [&'static str] = &[
        "half", //
        "bc_nx", "bc_ny", "bc_s", "bc_q", "bc_half", "ca_nx", "ca_ny", "ca_s", "ca_q", "ca_half",
    ];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        Bounds::around([self.a, self.b, self.c].map(|corner| map.transform_point3(corner)))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let sides = [(self.a, self.b), (self.b, self.c), (self.c, self.a)];
        let n = (self.b - self.a).cross(self.c - self.a);
        let longest = sides.iter().map(|(from, to)| from.distance_squared(*to)).fold(0.0, f64::max);
        // A triangle flatter than rounding has no plane: only its sides count.
        let flat = n.length() <= 1e-12 * longest;
        let inside = !flat && sides.iter().all(|(from, to)| (to - from).cross(p - from).dot(n) >= 0.0);
        if inside {
            return (p - self.a).dot(n.normalize()).powi(2);
        }
        sides.iter().map(|(from, to)| segment_distance_squared(p, *from, *to)).fold(f64::INFINITY, f64::min)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        let [a, b, c] = self.longest_first();
        let e1 = super::unit(b - a);
        let e1 = if e1 == DVec3::ZERO { DVec3::X } else { e1 };
        // Up is away from the third corner; in a flat triangle, any direction off the line. Twice, because
        // the first difference in a flat triangle is mostly rounding.
        let off_line = |v: DVec3| v - v.dot(e1) * e1;
        let down = off_line(off_line(c - a));
        let flat = down.length() <= 1e-12 * b.distance(a);
        let e2 = if flat { e1.any_orthonormal_vector() } else { -super::unit(down) };
        DAffine3::from_mat3_translation(DMat3::from_cols(e1, e2, e1.cross(e2)), a.midpoint(b))
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        let corners = self.longest_first();
        let to_pose = self.pose().inverse();
        let [a, b, c] = corners.map(|corner| scale * to_pose.transform_point3(corner));
        row.push(0.5 * scale * corners[0].distance(corners[1]));
        // B -> C -> A goes clockwise: outwards is to the left.
        for (from, to) in [(b, c), (c, a)] {
            let along = DVec3::new(to.x - from.x, to.y - from.y, 0.0);
            let u = super::unit(along);
            // A side without length has no direction; any direction will do, because only the ends count.
            let u = if u == DVec3::ZERO { DVec3::NEG_X } else { u };
            let middle = DVec3::new(0.5 * (from.x + to.x), 0.5 * (from.y + to.y), 0.0);
            let n = DVec3::new(-u.y, u.x, 0.0);
            row.extend([n.x, n.y, -u.dot(middle), -n.dot(middle), 0.5 * along.length()]);
        }
    }

    fn emit<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let zero = d.constant(0.0);
        let length = d.abs(x);
        let past = d.sub(length, row[0]);
        let past_ends = d.max(past, zero);
        let mut nearest = super::sum_of_squares(d, past_ends, y);
        let mut outwards = d.max(past, y);
        for side in row[1..].chunks_exact(SIDE) {
            let (square, q) = emit_side(d, [x, y], side);
            nearest = d.min(square, nearest);
            outwards = d.max(q, outwards);
        }
        let inside = d.lt(outwards, zero);
        let in_plane = d.select(inside, zero, nearest);
        d.fma(z, z, in_plane)
    }

    const UV_COLUMNS: &'static [&'static str] = &["u_x", "u_y", "u_at", "v_x", "v_y", "v_at"];

    /// Barycentric: u is the weight of `b`, v that of `c`, of the place's projection onto the plane, each
    /// between 0 and 1. So `a` is (0, 0), `b` (1, 0) and `c` (0, 1). A flat triangle, which has no plane,
    /// gives (0, 0).
    fn uv(&self, p: DVec3) -> [f64; 2] {
        self.weights().map(|weight| (p - self.a).dot(weight).clamp(0.0, 1.0))
    }

    fn uv_kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn uv_frame(&self) -> DAffine3 {
        self.pose()
    }

    fn uv_columns(&self, row: &mut Vec<f64>) {
        let turn = self.pose().matrix3.transpose();
        let from = self.pose().translation - self.a;
        for weight in self.weights() {
            let posed = turn * weight;
            row.extend([posed.x, posed.y, from.dot(weight)]);
        }
    }

    fn emit_uv<D: Domain>(d: &mut D, [x, y, _]: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        [&row[..3], &row[3..]].map(|weight| {
            let by_x = d.fma(x, weight[0], weight[2]);
            let both = d.fma(y, weight[1], by_x);
            emit_unit(d, both)
        })
    }
}

/// The squared distance of (x, y) from a side, and the signed distance outwards from the side's line.
fn emit_side<D: Domain>(d: &mut D, [x, y]: [D::Real; 2], side: &[D::Real]) -> (D::Real, D::Real) {
    let &[nx, ny, s_offset, q_offset, half] = side else { panic!("a side has {SIDE} columns") };
    // The side's direction is (ny, -nx).
    let minus_nx = d.neg(nx);
    let s = d.fma(x, ny, s_offset);
    let s = d.fma(y, minus_nx, s);
    let q = d.fma(x, nx, q_offset);
    let q = d.fma(y, ny, q);
    let past_ends = super::beyond(d, s, half);
    (super::sum_of_squares(d, past_ends, q), q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    fn corner(x: f64, y: f64) -> DVec3 {
        DVec3::new(x, y, 0.0)
    }

    #[test]
    fn known_distances() {
        let triangle = Triangle { a: corner(0.0, 0.0), b: corner(4.0, 0.0), c: corner(0.0, 3.0) };
        for (p, expected) in [
            ([1.0, 1.0, 2.0], 4.0),   // above the inside
            ([2.0, -3.0, 4.0], 25.0), // beside AB
            ([-3.0, -4.0, 0.0], 25.0),
            ([7.0, -4.0, 0.0], 25.0),
            ([0.0, 8.0, 0.0], 25.0),
        ] {
            testing::same_everywhere(&triangle, p.into(), expected);
        }
        // The hypotenuse is 3x + 4y = 12; 5 units along its normal from its middle.
        testing::same_everywhere(&triangle, DVec3::new(2.0 + 3.0, 1.5 + 4.0, 0.0), 25.0);
    }

    #[test]
    fn flat_ones_are_segments_and_points() {
        let (o, e, m) = (corner(0.0, 0.0), corner(8.0, 0.0), corner(2.0, 0.0));
        for [a, b, c] in [[o, e, m], [e, m, o], [m, o, e], [o, o, e], [o, e, o], [e, o, o]] {
            let flat = Triangle { a, b, c };
            for (p, expected) in
                [([5.0, 3.0, 0.0], 9.0), ([5.0, 0.0, -3.0], 9.0), ([11.0, 0.0, 4.0], 25.0), ([-3.0, 0.0, 0.0], 9.0)]
            {
                testing::same_everywhere(&flat, p.into(), expected);
            }
        }
        testing::same_everywhere(&Triangle { a: m, b: m, c: m }, DVec3::new(2.0, 3.0, 4.0), 25.0);
    }

    #[test]
    fn slivers_agree_with_their_longest_side() {
        let mut rng = fastrand::Rng::with_seed(7);
        for _ in 0..300 {
            let (a, b) = (testing::position(&mut rng), testing::position(&mut rng));
            let height = 10f64.powf(-4.0 - 6.0 * rng.f64());
            let c = a.lerp(b, rng.f64()) + height * (b - a).normalize().any_orthonormal_vector();
            let sliver = Triangle { a: b, b: c, c: a };
            for i in 0..100 {
                // Half of them in line with the sliver, where it is hard to say what is inside.
                let p = if i % 2 == 0 { a.lerp(b, 4.0 * rng.f64() - 2.0) } else { testing::position(&mut rng) };
                let p = p.as_vec3().as_dvec3();
                let expected = segment_distance_squared(p, a, b).sqrt();
                let got = f64::from(testing::emitted(&sliver, p)).sqrt();
                assert!((got - expected).abs() <= height + 1.5e-5, "{sliver:?} at {p}: {got}, not {expected}");
            }
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let [a, b, c] = std::array::from_fn(|_| testing::position(rng));
            let samples = (0..=60)
                .flat_map(|i| (0..=60 - i).map(move |j| (f64::from(i) / 60.0, f64::from(j) / 60.0)))
                .map(|(s, t)| a + s * (b - a) + t * (c - a))
                .collect();
            (Triangle { a, b, c }, samples)
        });
    }

    #[test]
    fn uv_is_barycentric() {
        let triangle = Triangle { a: corner(1.0, 0.0), b: corner(5.0, 0.0), c: corner(1.0, 3.0) };
        for (p, expected) in [
            ([1.0, 0.0, 2.0], [0.0, 0.0]),
            ([5.0, 0.0, 0.0], [1.0, 0.0]),
            ([1.0, 3.0, 0.0], [0.0, 1.0]),
            ([2.0, 1.5, -7.0], [0.25, 0.5]),
            ([-9.0, 9.0, 0.0], [0.0, 1.0]),
        ] {
            testing::same_uv(&triangle, p.into(), expected);
        }
        testing::same_uv(&Triangle { c: corner(2.0, 0.0), ..triangle }, DVec3::ONE, [0.0, 0.0]);
        testing::judge_uv(|rng| Triangle {
            a: testing::position(rng),
            b: testing::position(rng),
            c: testing::position(rng),
        });
    }
}
