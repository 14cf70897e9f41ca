//! The half space: all points on one side of a plane. It is unbounded, and so is a model of half spaces
//! alone.
//!
//! Cut with a bounded shape it is bounded: `intersection { half_space .. sphere .. }` has a support. A half
//! space alone needs a region where a mesh or a volume is asked for.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// The points behind a plane.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct HalfSpace = "half_space" {
        /// A point of the plane.
        pub at: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction out of the half space, of any length but 0.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
    }
}

impl SkeletonMember for HalfSpace {
    const COLUMNS: &'static [&'static str] = &[];
    const SYMMETRY: Symmetry = Symmetry::Arrow;

    /// Unbounded, except for one side if the plane is exactly across an axis.
    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        // Normals go the other way than points.
        let normal = map.matrix3.inverse().transpose() * super::unit(self.normal);
        let at = map.transform_point3(self.at);
        let mut bounds = Bounds::new(DVec3::NEG_INFINITY, DVec3::INFINITY);
        for axis in 0..3 {
            if normal == normal[axis] * DVec3::AXES[axis] {
                let side = if normal[axis] > 0.0 { &mut bounds.max } else { &mut bounds.min };
                side[axis] = at[axis];
            }
        }
        bounds
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        (p - self.at).dot(self.normal.normalize()).max(0.0).powi(2)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::towards(self.normal), self.at)
    }

    fn columns(&self, _scale: f64, _row: &mut Vec<f64>) {}

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], _row: &[D::Real]) -> D::Real {
        let outside = super::positive_part(d, p[2]);
        d.mul(outside, outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::member::Member as _;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let half = HalfSpace { at: DVec3::new(0.0, 0.0, 1.0), normal: DVec3::new(0.0, 3.0, 4.0) };
        for (p, expected) in
            [([9.0, 3.0, 5.0], 25.0), ([1e3, 0.0, 1.0], 0.0), ([7.0, -3.0, 0.0], 0.0), ([0.0, 8.0, -5.0], 0.0), ([0.0, 5.0, 1.0], 9.0)]
        {
            testing::same_everywhere(&half, p.into(), expected);
        }
        for normal in [DVec3::Z, DVec3::NEG_Z, DVec3::NEG_X] {
            let half = HalfSpace { at: 2.0 * DVec3::ONE, normal };
            testing::same_everywhere(&half, 2.0 * DVec3::ONE + 3.0 * normal, 9.0);
            testing::same_everywhere(&half, 2.0 * DVec3::ONE - 3.0 * normal, 0.0);
        }
    }

    #[test]
    fn it_ends_on_one_side_at_most() {
        let (low, high) = (DVec3::NEG_INFINITY, DVec3::INFINITY);
        let down = HalfSpace { at: DVec3::new(1.0, 2.0, 3.0), normal: DVec3::new(0.0, -2.0, 0.0) };
        assert_eq!(down.bounds_under(&DAffine3::IDENTITY), Bounds::new(DVec3 { y: 2.0, ..low }, high));
        let mirrored = DAffine3::from_scale(DVec3::new(1.0, -2.0, 1.0));
        assert_eq!(down.bounds_under(&mirrored), Bounds::new(low, DVec3 { y: -4.0, ..high }));
        let oblique = HalfSpace { normal: DVec3::new(0.0, 1.0, 1e-9), ..down };
        assert_eq!(oblique.bounds_under(&DAffine3::IDENTITY), Bounds::new(low, high));
        // A shear moves points of the plane within it, and the normal does not turn with the y axis.
        let sheared = DAffine3::from_mat3(glam::DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z));
        assert_eq!(down.bounds_under(&sheared), Bounds::new(DVec3 { y: 2.0, ..low }, high));
    }

    #[test]
    fn agrees_with_the_nearest_of_its_points_and_is_turned_by_its_symmetry() {
        let mut rng = fastrand::Rng::with_seed(9);
        for _ in 0..500 {
            let half = HalfSpace { at: testing::position(&mut rng), normal: testing::direction(&mut rng) };
            assert_eq!(HalfSpace::from_fields(&half.to_fields()), half);
            let p = testing::position(&mut rng).as_vec3().as_dvec3();
            let (distance, size) = (half.distance_squared(p).sqrt(), 20.0);
            let got = f64::from(testing::emitted(&half, p)).sqrt();
            assert!((got - distance).abs() < 1e-6 * size, "{half:?} at {p}: {got}, not {distance}");
            // A point of the set at that distance, and none nearer.
            let nearest = p - distance * half.normal;
            assert!(half.distance_squared(nearest) < 1e-24);
            let inside = nearest - 1e-9 * half.normal + rng.f64() * half.normal.any_orthonormal_vector();
            assert!(half.distance_squared(inside) == 0.0 && inside.distance(p) >= distance - 1e-9);
            testing::scales(&half, p, &mut rng);
        }
    }
}
