//! The ellipsoid: a point whose distance is stretched along the axes.
//!
//! ```text
//! d^2 = (x / a)^2 + (y / b)^2 + (z / c)^2
//! ```
//!
//! So the field is the field of a ball under the scaling (a, b, c): it reaches zero on the ellipsoid with the
//! half axes `radius * (a, b, c)`.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{Metric, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A point with a Euclidean distance that has weights along the axes.
    ///
    /// A radius, of the support or of the surface, is multiplied by `stretch` along each axis.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Ellipsoid = "ellipsoid" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// How many times it reaches as far as the radius, along each axis.
        pub stretch: DVec3 [Stretches],
    }
}

impl SkeletonMember for Ellipsoid {
    const COLUMNS: &'static [&'static str] = &["inv_x", "inv_y", "inv_z"];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn metric(&self) -> Metric {
        Metric::ellipsoid(self.stretch)
    }

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        Bounds::around([map.transform_point3(self.center)])
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        ((p - self.center) / self.stretch).length_squared()
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.center)
    }

    fn columns(&self, _scale: f64, row: &mut Vec<f64>) {
        row.extend(self.stretch.recip().to_array());
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let parts = std::array::from_fn(|k| d.mul(p[k], row[k]));
        super::length_squared(d, parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let ellipsoid = Ellipsoid { center: DVec3::new(1.0, 0.0, 0.0), stretch: DVec3::new(2.0, 1.0, 0.5) };
        for (p, expected) in
            [([1.0, 0.0, 0.0], 0.0), ([3.0, 0.0, 0.0], 1.0), ([1.0, -1.0, 0.0], 1.0), ([1.0, 0.0, 0.5], 1.0), ([5.0, 3.0, 1.0], 17.0)]
        {
            testing::same_everywhere(&ellipsoid, p.into(), expected);
        }
    }

    #[test]
    fn agrees_with_samples_of_its_level_sets() {
        testing::judge_norm(|rng| {
            let stretch = DVec3::from_array(std::array::from_fn(|_| 0.2 + 2.0 * rng.f64()));
            let ellipsoid = Ellipsoid { center: testing::position(rng), stretch };
            let samples = testing::sphere(24).map(|v| stretch * v).collect();
            (ellipsoid, ellipsoid.center, samples)
        });
    }
}
