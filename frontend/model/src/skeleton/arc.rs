//! The arc: a part of a circle, up to all of it.
//!
//! In the pose its middle is on the x axis, so that the two halves are mirror images and `|y|` is enough.
//! With a the angle from the middle to an end, and phi the angle of the point,
//!
//! ```text
//!       end                     phi <= a:   (rho - radius)^2 + z^2
//!         ●──                   else:       |(x, |y|) - end|^2 + z^2
//!            \
//!    ·────────●── x             phi <= a:   x sin a - |y| cos a >= 0,   for 0 < a <= pi
//! ```
//!
//! The two distances are equal where phi = a, so rounding may decide freely there. They differ most on the
//! other side, at a - phi = +-pi, where the condition is just as near to 0. But there, with a near 0 or pi,
//! both terms of the condition have one sign. A sine kept above 0 ensures this for a = 0 and a = pi, too.

use glam::{DAffine3, DVec2, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::affine::{rotation, sin_cos_degrees};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::member::{Member as _, member};

member! {
    /// A part of a circle, not filled. With radius 0 or angle 0 it is a point, with 360 degrees a ring.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Arc = "arc" {
        /// The middle of its circle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction of the circle's axis, of any length but 0: seen from its tip the arc goes
        /// counterclockwise.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// The direction from the middle of the circle to where the arc begins: only the part across the
        /// normal counts.
        pub start: DVec3 [Direction] = Vector([1.0, 0.0, 0.0]),
        /// How far it goes, in degrees: from 0 to 360.
        pub degrees: f64 [Degrees],
        /// The radius of the circle.
        pub radius: f64 [NonNegative],
    }
}

/// The smallest sine in the condition: far above the underflow of products with lengths.
const SMALLEST_SINE: f64 = 1e-20;

impl Arc {
    /// Sine and cosine of the angle from the middle to an end.
    fn half_angle(&self) -> (f64, f64) {
        sin_cos_degrees(0.5 * self.degrees)
    }

    /// The position in the pose.
    fn posed(&self, p: DVec3) -> DVec3 {
        let n = self.normal.normalize();
        let start = (self.start - self.start.dot(n) * n).normalize();
        let (sin, cos) = self.half_angle();
        let middle = cos * start + sin * n.cross(start);
        let v = p - self.center;
        DVec3::new(v.dot(middle), v.dot(n.cross(middle)), v.dot(n))
    }

    /// Whether it is a single point.
    fn is_point(&self) -> bool {
        self.radius == 0.0 || self.degrees == 0.0
    }
}

impl SkeletonMember for Arc {
    // The end at (end_x, end_y); the sine and the cosine of the angle from the middle to it.
    const COLUMNS: &'static [&'static str] = &["radius", "end_x", "end_y", "sin", "cos"];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn fault(&self) -> Option<Diagnostic> {
        super::along_normal(Self::NAME, "start", self.normal, self.start)
    }

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let pose = *map * self.pose();
        let half = 0.5 * self.degrees.to_radians();
        let (sin, cos) = self.half_angle();
        let ends = [DVec2::new(cos, sin), DVec2::new(cos, -sin)].map(|end| self.radius * end);
        let ends = Bounds::around(ends.map(|end| pose.transform_point3(end.extend(0.0))));
        let mut bounds = ends;
        for axis in 0..3 {
            // A coordinate is x cos t + y sin t: largest at the angle of (x, y), smallest opposite.
            let row = pose.matrix3.row(axis);
            let (top, reach) = (row.y.atan2(row.x), self.radius * row.x.hypot(row.y));
            if top.abs() <= half {
                bounds.max[axis] = pose.translation[axis] + reach;
            }
            if std::f64::consts::PI - top.abs() <= half {
                bounds.min[axis] = pose.translation[axis] - reach;
            }
        }
        bounds.hull(ends)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let q = self.posed(p);
        let half = 0.5 * self.degrees.to_radians();
        if q.y.abs().atan2(q.x) <= half {
            return (q.x.hypot(q.y) - self.radius).powi(2) + q.z * q.z;
        }
        let (sin, cos) = self.half_angle();
        (DVec3::new(q.x, q.y.abs(), q.z) - self.radius * DVec3::new(cos, sin, 0.0)).length_squared()
    }

    /// The gradient jumps on the axis, from which all points of the circle are equally far, and where both
    /// ends are equally far.
    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.is_point() {
            return f64::INFINITY;
        }
        let q = self.posed(p);
        if self.degrees < 360.0 && q.x < 0.0 { q.y.abs() } else { q.x.hypot(q.y) }
    }

    fn pose(&self) -> DAffine3 {
        let start = super::frame(self.normal, self.start);
        let turn = rotation(DVec3::Z, self.half_angle());
        DAffine3::from_mat3_translation(start * turn, self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        let (sin, cos) = self.half_angle();
        let radius = scale * self.radius;
        row.extend([radius, radius * cos, radius * sin, sin.max(SMALLEST_SINE), cos]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let (radius, end_x, end_y, sin, cos) = (row[0], row[1], row[2], row[3], row[4]);
        let (zero, side) = (d.constant(0.0), d.abs(p[1]));
        let rho = super::emit_off_axis(d, p);
        let off_circle = d.sub(rho, radius);
        let circle = d.mul(off_circle, off_circle);
        let (off_x, off_y) = (d.sub(p[0], end_x), d.sub(side, end_y));
        let end = super::sum_of_squares(d, off_x, off_y);

        let minus_cos = d.neg(cos);
        let within = d.mul(p[0], sin);
        let within = d.fma(side, minus_cos, within);
        let within = d.le(zero, within);
        let in_plane = d.select(within, circle, end);
        d.fma(p[2], p[2], in_plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Ring, testing};

    fn arc(degrees: f64) -> Arc {
        Arc { center: DVec3::ZERO, normal: DVec3::Z, start: DVec3::X, degrees, radius: 2.0 }
    }

    #[test]
    fn known_distances() {
        for (degrees, p, expected) in [
            (90.0, [0.0, 2.0, 0.0], 0.0),
            (90.0, [3.0, 3.0, 0.0], (18f64.sqrt() - 2.0).powi(2)),
            (90.0, [-4.0, 2.0, 0.0], 16.0),
            (90.0, [2.0, -3.0, 4.0], 25.0),
            (180.0, [-2.0, 0.0, 1.0], 1.0),
            (180.0, [5.0, -4.0, 0.0], 25.0),
            (180.0, [0.0, -3.0, 0.0], 13.0),
            (270.0, [0.0, -2.0, 0.0], 0.0),
            (270.0, [-5.0, 0.0, 4.0], 25.0),
            (270.0, [4.0, -2.0, 0.0], 8.0), // as far from both ends
            (360.0, [2.0, 0.0, 0.0], 0.0),
            (360.0, [-2.0, 0.0, 0.0], 0.0),
            (0.0, [2.0, 0.0, 0.0], 0.0),
            (0.0, [-2.0, 0.0, 0.0], 16.0),
            (0.0, [2.0, 3.0, 4.0], 25.0),
        ] {
            testing::same_everywhere(&arc(degrees), p.into(), expected);
            // On the axis all of it is equally near.
            testing::same_everywhere(&arc(degrees), DVec3::new(0.0, 0.0, 1.5), 6.25);
        }
        assert!(arc(90.0).kink_distance(DVec3::new(-3.0, -3.0, 1.0)) < 1e-15);
        assert!((arc(360.0).kink_distance(DVec3::new(-3.0, -4.0, 1.0)) - 5.0).abs() < 1e-15);
    }

    #[test]
    fn the_whole_circle_is_a_ring() {
        let mut rng = fastrand::Rng::with_seed(4);
        for _ in 0..300 {
            let (center, normal) = (testing::position(&mut rng), testing::direction(&mut rng));
            let all = Arc { center, normal, start: testing::direction(&mut rng), degrees: 360.0, radius: 2.0 };
            let ring = Ring { center, normal, radius: 2.0 };
            let p = testing::position(&mut rng);
            assert!((all.distance_squared(p) - ring.distance_squared(p)).abs() < 1e-12);
            let emitted = f64::from(testing::emitted(&all, p)).sqrt();
            assert!((emitted - ring.distance_squared(p).sqrt()).abs() < 1e-5);
        }
    }

    /// Both sides of pi, of 0 and of a whole turn; points in the arc's plane and in line with its middle,
    /// where rounding decides the condition.
    #[test]
    fn angles_next_to_special_ones() {
        for around in [0.0, 90.0, 180.0, 270.0, 360.0] {
            for off in [-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6, 1e-3] {
                let degrees = around + off;
                if !(0.0..=360.0).contains(&degrees) {
                    continue;
                }
                let arc = arc(degrees);
                let pose = arc.pose();
                let half = 0.5 * degrees.to_radians();
                for i in 0..72 {
                    for phi in [f64::from(i) * 5f64.to_radians(), half, -half, half + 1e-7, half - 1e-7] {
                        for rho in [1e-6, 1.0, 2.0, 3.0, 1e4] {
                            let q = DVec3::new(rho * phi.cos(), rho * phi.sin(), 0.0).as_vec3().as_dvec3();
                            let p = pose.transform_point3(q);
                            let expected = arc.distance_squared(p).sqrt();
                            let got = f64::from(testing::emitted(&arc, p)).sqrt();
                            assert!((got - expected).abs() < 2e-6 * (2.0 + expected), "{arc:?} at {q}: {got}, not {expected}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(5e-2, |rng| {
            let degrees = if rng.u8(..4) == 0 { 90.0 * f64::from(rng.u8(0..5)) } else { 360.0 * rng.f64() };
            let arc = Arc {
                center: testing::position(rng),
                normal: testing::direction(rng) * 2.0,
                start: testing::direction(rng),
                degrees,
                radius: 4.0 * rng.f64(),
            };
            let n = arc.normal.normalize();
            let e1 = (arc.start - arc.start.dot(n) * n).normalize();
            let samples = (0..=2000)
                .map(|i| f64::from(i) / 2000.0 * degrees.to_radians())
                .map(|turn| arc.center + arc.radius * (turn.cos() * e1 + turn.sin() * n.cross(e1)))
                .collect();
            (arc, samples)
        });
    }
}
