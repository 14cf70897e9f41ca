//! The segment: the skeleton of a capsule.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry, uv};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// The straight line between two points. Equal ends are a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Segment = "segment" {
        /// One end.
        pub from: DVec3 [Position],
        /// The other end.
        pub to: DVec3 [Position],
    }
}

impl SkeletonMember for Segment {
    // A unit direction and a length: this needs no division and no special case for equal ends, where both
    // are zero. Measured from the middle, both ends are one comparison.
    const COLUMNS: &'static [&'static str] = &["half"];
    const SYMMETRY: Symmetry = Symmetry::Axis;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        Bounds::around([self.from, self.to].map(|end| map.transform_point3(end)))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        segment_distance_squared(p, self.from, self.to)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::along(self.to - self.from), self.from.midpoint(self.to))
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.push(0.5 * scale * self.from.distance(self.to));
    }

    fn emit<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let past_ends = super::beyond(d, z, row[0]);
        super::length_squared(d, [x, y, past_ends])
    }

    const UV_COLUMNS: &'static [&'static str] = &["inv_length"];

    /// u: the angle about the segment's direction. v: how far along it is, from 0 at `from` to 1 at `to`; 1/2
    /// where the ends are equal.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let q = uv::within(&self.uv_frame(), p);
        let along = q.z * uv::inverse(self.from.distance(self.to)) + 0.5;
        [uv::turn(q.x, q.y), along.clamp(0.0, 1.0)]
    }

    fn uv_kink_distance(&self, p: DVec3) -> f64 {
        let q = uv::within(&self.uv_frame(), p);
        uv::turn_kink_distance(q.x, q.y)
    }

    fn uv_frame(&self) -> DAffine3 {
        uv::frame(super::direction(self.to - self.from), self.from.midpoint(self.to))
    }

    fn uv_columns(&self, row: &mut Vec<f64>) {
        row.push(uv::inverse(self.from.distance(self.to)));
    }

    fn emit_uv<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        [uv::emit_turn(d, x, y), uv::emit_ramp(d, z, row[0], 0.5)]
    }
}

/// The squared distance of `p` from the segment between `from` and `to`, in f64.
pub(super) fn segment_distance_squared(p: DVec3, from: DVec3, to: DVec3) -> f64 {
    let (v, along) = (p - from, to - from);
    let square = along.length_squared();
    let t = if square > 0.0 { (v.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (v - t * along).length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let segment = Segment { from: DVec3::ZERO, to: DVec3::new(4.0, 0.0, 0.0) };
        for (p, expected) in [([2.0, 3.0, 0.0], 9.0), ([-3.0, 0.0, 4.0], 25.0), ([7.0, 4.0, 0.0], 25.0), ([1.0, 0.0, 0.0], 0.0)] {
            testing::same_everywhere(&segment, p.into(), expected);
        }
    }

    #[test]
    fn equal_ends_are_a_point() {
        let at = DVec3::new(1.0, 2.0, 3.0);
        testing::same_everywhere(&Segment { from: at, to: at }, DVec3::new(1.0, 5.0, 7.0), 25.0);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(2e-2, |rng| {
            let (from, to) = (testing::position(rng), testing::position(rng));
            let samples = (0..=1000).map(|i| from.lerp(to, f64::from(i) / 1000.0)).collect();
            (Segment { from, to }, samples)
        });
    }

    #[test]
    fn uv_goes_around_and_along() {
        let segment = Segment { from: DVec3::ZERO, to: DVec3::new(0.0, 0.0, -4.0) };
        for (p, expected) in [
            ([2.0, 0.0, -1.0], [0.0, 0.25]),
            // Right-handed about -z: from x to -y.
            ([0.0, -2.0, -3.0], [0.25, 0.75]),
            ([-1.0, 0.0, 1.0], [0.5, 0.0]),
            ([0.0, 2.0, -9.0], [0.75, 1.0]),
            ([0.0, 0.0, -2.0], [0.0, 0.5]),
        ] {
            testing::same_uv(&segment, p.into(), expected);
        }
        testing::same_uv(&Segment { to: segment.from, ..segment }, DVec3::X, [0.0, 0.5]);
        testing::judge_uv(|rng| Segment { from: testing::position(rng), to: testing::position(rng) });
    }
}
