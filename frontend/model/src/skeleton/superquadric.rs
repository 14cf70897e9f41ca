//! The superquadric (Barr 1981): a point whose distance is a norm that rounds or squares its level sets in
//! two ways.
//!
//! ```text
//! d^(2/e1) = (|x / a|^(2/e2) + |y / b|^(2/e2))^(e2/e1) + |z / c|^(2/e1)
//! ```
//!
//! e1 shapes the profile along z, e2 the slices across it: 1 is round, towards 0 square, 2 has flat facets
//! like an octahedron. It is a norm of exponent 2/e1 over a norm of exponent 2/e2, so that all statements of
//! [`LMetric`](super::LMetric) hold for each. Pinched shapes, with exponents above 2, are refused: their
//! distance is no norm and infinitely steep at the planes where a coordinate is 0.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;
use jbt_ir::limits::MAX_METRIC_EXPONENT;

use super::lmetric::{emit_norm, emit_term, norm};
use super::{Metric, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::field::FieldKind;
use crate::member::member;

/// Barr's exponents: 2 over the exponent of a norm.
const BARR: FieldKind = FieldKind::Within { least: 2.0 / MAX_METRIC_EXPONENT, most: 2.0 };

member! {
    /// A point with the distance of a superellipsoid.
    ///
    /// A radius, of the support or of the surface, is multiplied by `stretch` along each axis.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Superquadric = "superquadric" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// Barr's exponent along z, from 1/512 to 2.
        pub e1: f64 [BARR],
        /// Barr's exponent across z, from 1/512 to 2.
        pub e2: f64 [BARR],
        /// How many times it reaches as far as the radius, along each axis.
        pub stretch: DVec3 [Stretches] = Vector([1.0; 3]),
    }
}

impl SkeletonMember for Superquadric {
    // The exponents of the norms: first of the slices, then of the profile.
    const COLUMNS: &'static [&'static str] = &["inv_x", "inv_y", "inv_z", "l2", "inv_l2", "l1", "inv_l1"];
    const CREASES: bool = true;
    const SYMMETRY: Symmetry = Symmetry::None;

    fn metric(&self) -> Metric {
        Metric::touching(self.stretch)
    }

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        Bounds::around([map.transform_point3(self.center)])
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let [x, y, z] = ((p - self.center) / self.stretch).to_array();
        let across = norm(&[x, y], 2.0 / self.e2);
        norm(&[across, z], 2.0 / self.e1).powi(2)
    }

    /// The gradient jumps on planes where a coordinate is 0 in a norm of exponent below 2, and on the z axis,
    /// where both coordinates of one norm are 0.
    fn kink_distance(&self, p: DVec3) -> f64 {
        let [x, y, z] = (p - self.center).abs().to_array();
        let across = if self.e2 > 1.0 { x.min(y) } else { f64::INFINITY };
        let along = if self.e1 > 1.0 { z.min(x.hypot(y)) } else { f64::INFINITY };
        across.min(along)
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.center)
    }

    fn columns(&self, _scale: f64, row: &mut Vec<f64>) {
        row.extend(self.stretch.recip().to_array());
        row.extend([2.0 / self.e2, 0.5 * self.e2, 2.0 / self.e1, 0.5 * self.e1]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let [x, y, z] = [0, 1, 2].map(|k| emit_term(d, p[k], row[k]));
        let across = emit_norm(d, &[x, y], [row[3], row[4]]);
        let distance = emit_norm(d, &[across, z], [row[5], row[6]]);
        d.mul(distance, distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{LMetric, testing};

    #[test]
    fn known_distances() {
        let shape = |e1: f64, e2: f64| Superquadric { center: DVec3::ZERO, e1, e2, stretch: DVec3::ONE };
        for (e1, e2, p, expected) in [
            (1.0, 1.0, [2.0, -3.0, 6.0], 7.0),
            (2.0, 2.0, [1.0, -2.0, 3.0], 6.0),
            (2.0, 1.0, [3.0, 4.0, -2.0], 7.0),       // a double cone
            (1.0, 2.0, [1.0, -2.0, 4.0], 5.0),       // round over diamonds
            (1.0 / 512.0, 1.0, [3.0, 4.0, 2.0], 5.0), // a cylinder
            (0.5, 0.5, [0.0, 0.0, -2.0], 2.0),
            (0.5, 1.7, [0.0, 0.0, 0.0], 0.0),
        ] {
            testing::same_everywhere(&shape(e1, e2), p.into(), f64::powi(expected, 2));
        }
        assert_eq!(shape(1.0, 1.0).kink_distance(DVec3::ZERO), f64::INFINITY);
        assert_eq!(shape(1.0, 1.5).kink_distance(DVec3::new(-1.0, 0.5, 0.0)), 0.5);
        assert_eq!(shape(1.5, 1.0).kink_distance(DVec3::new(3.0, 4.0, -9.0)), 5.0);
    }

    #[test]
    fn equal_exponents_make_an_l_metric() {
        let mut rng = fastrand::Rng::with_seed(12);
        for _ in 0..200 {
            let (center, e) = (testing::position(&mut rng), 0.1 + 1.9 * rng.f64());
            let stretch = DVec3::new(0.5, 1.0, 2.0);
            let shape = Superquadric { center, e1: e, e2: e, stretch };
            let l = LMetric { center, exponent: 2.0 / e, stretch };
            let p = testing::position(&mut rng);
            let (a, b) = (shape.distance_squared(p), l.distance_squared(p));
            assert!((a / b - 1.0).abs() < 1e-12, "{shape:?} at {p}: {a}, {b}");
        }
    }

    /// Barr's own parametrization of the surface, by latitude and longitude.
    #[test]
    fn agrees_with_samples_of_its_level_sets() {
        testing::judge_norm(|rng| {
            let mut exponent = || [2.0, 1.0, 2.0 * rng.f64().max(0.01), 0.05 + rng.f64()][rng.usize(..4)];
            let (e1, e2) = (exponent(), exponent());
            let stretch = DVec3::from_array(std::array::from_fn(|_| 0.2 + 2.0 * rng.f64()));
            let shape = Superquadric { center: testing::position(rng), e1, e2, stretch };
            let power = |x: f64, e: f64| x.signum() * x.abs().powf(e);
            let samples = testing::sphere(24).map(|v| {
                let (across, up) = (v.x.hypot(v.y), v.z);
                let [cos, sin] = if across > 0.0 { [v.x / across, v.y / across] } else { [1.0, 0.0] };
                let across = power(across, e1);
                stretch * DVec3::new(across * power(cos, e2), across * power(sin, e2), power(up, e1))
            });
            (shape, shape.center, samples.collect())
        });
    }
}
