//! The box: a solid one, along the axes of its own space.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry, uv};
use crate::affine::map_bounds;
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A solid box along the axes. Half sizes of 0 make it a rectangle, a segment or a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Cuboid = "box" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// How far it reaches from the middle along each axis: half its sides.
        pub half: DVec3 [Extents],
    }
}

impl SkeletonMember for Cuboid {
    const COLUMNS: &'static [&'static str] = &["half_x", "half_y", "half_z"];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        map_bounds(map, Bounds::new(self.center - self.half, self.center + self.half))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        ((p - self.center).abs() - self.half).max(DVec3::ZERO).length_squared()
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.extend((scale * self.half).to_array());
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let outside = [0, 1, 2].map(|k| super::beyond(d, p[k], row[k]));
        super::length_squared(d, outside)
    }

    const UV_COLUMNS: &'static [&'static str] = &["half_x", "half_y", "half_z", "inv_x", "inv_y", "inv_z"];

    /// Every face covers [0, 1]^2, seen from outside with u to the right and v up: up is z on the four sides,
    /// and y on top and bottom. A place belongs to the face whose plane it is farthest beyond (or, inside,
    /// least behind). A side without length counts as 1/2.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let q = p - self.center;
        let part = |axis: usize, sign: f64| {
            (sign * q[axis] * 0.5 * uv::inverse(self.half[axis]) + 0.5).clamp(0.0, 1.0)
        };
        let beyond = q.abs() - self.half;
        let sign = |axis: usize| if q[axis] < 0.0 { -1.0 } else { 1.0 };
        if beyond.z >= beyond.x && beyond.z >= beyond.y {
            [part(0, sign(2)), part(1, 1.0)]
        } else if beyond.x >= beyond.y {
            [part(1, sign(0)), part(2, 1.0)]
        } else {
            [part(0, -sign(1)), part(2, 1.0)]
        }
    }

    fn uv_kink_distance(&self, p: DVec3) -> f64 {
        let q = (p - self.center).abs();
        let mut beyond = [0, 1, 2].map(|axis| (q[axis] - self.half[axis], axis));
        beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Between faces, and between a face and the opposite one.
        (beyond[0].0 - beyond[1].0).min(q[beyond[0].1])
    }

    fn uv_columns(&self, row: &mut Vec<f64>) {
        row.extend(self.half.to_array());
        row.extend(self.half.to_array().map(|half| 0.5 * uv::inverse(half)));
    }

    fn emit_uv<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        let zero = d.constant(0.0);
        let beyond: [D::Real; 3] = std::array::from_fn(|axis| {
            let size = d.abs(p[axis]);
            d.sub(size, row[axis])
        });
        let (z_x, z_y) = (d.le(beyond[0], beyond[2]), d.le(beyond[1], beyond[2]));
        let top = d.both(z_x, z_y);
        let side = d.le(beyond[1], beyond[0]);
        // What decides the sign of u, and what u is made of.
        let [minus, positive] = [d.constant(-1.0), d.constant(1.0)];
        let [sx, sy, sz] = p.map(|coordinate| {
            let below = d.lt(coordinate, zero);
            d.select(below, minus, positive)
        });
        let front = d.neg(sy);
        let sign = d.select(side, sx, front);
        let sign = d.select(top, sz, sign);
        let along = d.select(side, p[1], p[0]);
        let along = d.select(top, p[0], along);
        let inverse = d.select(side, row[4], row[3]);
        let inverse = d.select(top, row[3], inverse);
        let along = d.mul(sign, along);
        let up = d.select(top, p[1], p[2]);
        let inverse_up = d.select(top, row[4], row[5]);
        [uv::emit_ramp(d, along, inverse, 0.5), uv::emit_ramp(d, up, inverse_up, 0.5)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let cuboid = Cuboid { center: DVec3::new(1.0, 0.0, 0.0), half: DVec3::new(1.0, 2.0, 3.0) };
        for (p, expected) in
            [([0.5, -1.5, 2.5], 0.0), ([5.0, 0.0, 0.0], 9.0), ([-2.0, 4.0, -9.0], 44.0), ([1.0, 2.0, 3.0], 0.0)]
        {
            testing::same_everywhere(&cuboid, p.into(), expected);
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let half = DVec3::new(rng.f64(), 2.0 * rng.f64(), 3.0 * rng.f64());
            let cuboid = Cuboid { center: testing::position(rng), half };
            let tick = |i: i32| f64::from(i % 21) / 10.0 - 1.0;
            let samples = (0..21 * 21 * 21)
                .map(|i| cuboid.center + half * DVec3::new(tick(i), tick(i / 21), tick(i / 441)))
                .collect();
            (cuboid, samples)
        });
    }

    #[test]
    fn uv_shows_all_of_a_picture_on_each_face() {
        let solid = Cuboid { center: DVec3::ZERO, half: DVec3::new(1.0, 2.0, 4.0) };
        for (p, expected) in [
            ([2.0, 1.0, 2.0], [0.75, 0.75]),   // +x: y to the right, z up
            ([-2.0, 1.0, 2.0], [0.25, 0.75]),  // -x
            ([-0.5, 3.0, -2.0], [0.75, 0.25]), // +y
            ([-0.5, -9.0, 5.0], [0.25, 1.0]),  // -y
            ([0.5, 1.0, 5.0], [0.75, 0.75]),   // +z: y up
            ([0.5, 1.0, -5.0], [0.25, 0.75]),  // -z
        ] {
            testing::same_uv(&solid, p.into(), expected);
        }
        testing::judge_uv(|rng| Cuboid { center: testing::position(rng), half: testing::position(rng).abs() });
        testing::same_uv(&Cuboid { half: DVec3::ZERO, ..solid }, DVec3::new(2.0, 1.0, 0.0), [0.5, 0.5]);
    }
}
