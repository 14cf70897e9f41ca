//! The rectangle: a flat one, anywhere and any way round.
//!
//! A box that is flat along an axis is one too; a rectangle has a normal and so needs no rotation around it.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::member::{Member as _, member};

member! {
    /// A filled rectangle. With a half size of 0 it is a segment, with two a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Rectangle = "rectangle" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction that it faces, of any length but 0; either of the two.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// The direction of its length: only the part across the normal counts.
        pub along: DVec3 [Direction] = Vector([1.0, 0.0, 0.0]),
        /// How far it reaches from the middle along `along`.
        pub half_length: f64 [NonNegative],
        /// How far it reaches from the middle across `along`.
        pub half_width: f64 [NonNegative],
    }
}

impl SkeletonMember for Rectangle {
    const COLUMNS: &'static [&'static str] = &["half_length", "half_width"];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn fault(&self) -> Option<Diagnostic> {
        super::along_normal(Self::NAME, "along", self.normal, self.along)
    }

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let center = map.transform_point3(self.center);
        let frame = map.matrix3 * super::frame(self.normal, self.along);
        let reach = self.half_length * frame.x_axis.abs() + self.half_width * frame.y_axis.abs();
        Bounds::new(center - reach, center + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let (v, n) = (p - self.center, self.normal.normalize());
        let length = (self.along - self.along.dot(n) * n).normalize();
        let past = |side: DVec3, half: f64| (v.dot(side).abs() - half).max(0.0).powi(2);
        past(length, self.half_length) + past(n.cross(length), self.half_width) + v.dot(n).powi(2)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::frame(self.normal, self.along), self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.extend([scale * self.half_length, scale * self.half_width]);
    }

    fn emit<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let (past_length, past_width) = (super::beyond(d, x, row[0]), super::beyond(d, y, row[1]));
        super::length_squared(d, [past_length, past_width, z])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        // Along y by 2, across by 1; `along` leans out of the plane, which does not count.
        let rectangle = Rectangle {
            center: DVec3::new(1.0, 0.0, 0.0),
            normal: DVec3::new(0.0, 0.0, -3.0),
            along: DVec3::new(0.0, 1.0, 5.0),
            half_length: 2.0,
            half_width: 1.0,
        };
        for (p, expected) in [([1.5, -1.5, 0.0], 0.0), ([1.5, 1.5, 3.0], 9.0), ([5.0, 6.0, 0.0], 25.0), ([-3.0, 0.0, -4.0], 25.0)] {
            testing::same_everywhere(&rectangle, p.into(), expected);
        }
        assert_eq!(rectangle.fault(), None);
        assert!(Rectangle { along: DVec3::Z, ..rectangle }.fault().is_some());
    }

    #[test]
    fn it_is_a_flat_box() {
        let mut rng = fastrand::Rng::with_seed(8);
        for _ in 0..200 {
            let (center, half) = (testing::position(&mut rng), DVec3::new(rng.f64(), 2.0 * rng.f64(), 0.0));
            let flat = crate::skeleton::Cuboid { center, half };
            let rectangle =
                Rectangle { center, normal: DVec3::Z, along: DVec3::X, half_length: half.x, half_width: half.y };
            let p = testing::position(&mut rng).as_vec3().as_dvec3();
            testing::same_everywhere(&rectangle, p, flat.distance_squared(p));
            assert_eq!(testing::emitted(&rectangle, p), testing::emitted(&flat, p), "to the bit");
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.2, |rng| {
            let (normal, along) = (testing::direction(rng) * 2.0, testing::direction(rng));
            let (half_length, half_width) = (3.0 * rng.f64(), 2.0 * rng.f64());
            let rectangle = Rectangle { center: testing::position(rng), normal, along, half_length, half_width };
            let n = normal.normalize();
            let length = (along - along.dot(n) * n).normalize();
            let tick = |i: i32| f64::from(i) / 30.0 - 1.0;
            let samples = (0..=60)
                .flat_map(|i| (0..=60).map(move |j| (tick(i), tick(j))))
                .map(|(s, t)| rectangle.center + s * half_length * length + t * half_width * n.cross(length))
                .collect();
            (rectangle, samples)
        });
    }
}
