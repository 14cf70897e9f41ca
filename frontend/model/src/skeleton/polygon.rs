//! The polygon: a filled flat region between any number of corners, concave ones among them.
//!
//! The pose puts it into the plane z = 0. Then
//!
//! ```text
//!     .-------.            d^2 = z^2 + (inside ? 0 : the nearest of all edges)
//!      \  o - -\ - - ->
//!       \  .----'          inside: a ray along x crosses an odd number of edges
//!        \/
//! ```
//!
//! An edge is crossed if one end is above the ray and the other is not. Both rows of a corner hold the same
//! f32, so this decision is exact. The place of a crossing along the ray is off by rounding only, and decides
//! only for points as near to the edge. Crossings of all edges are counted, so none may be left out.

use glam::{DAffine3, DMat3, DVec2, DVec3};
use jbt_ir::Domain;

use super::points::{self, NearestPlace};
use super::segment::segment_distance_squared;
use super::{Pieces, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::member::{Member as _, Positions, member};

/// Corners may lie off the plane by this part of the polygon's size; they count where they are in the plane.
const FLATNESS: f64 = 1e-5;
/// A polygon has at least this part of the square of its size as area.
const LEAST_AREA: f64 = 1e-9;

member! {
    /// A filled polygon with corners in one plane, in either sense of rotation.
    ///
    /// Where edges cross each other, a point is inside if a ray from it crosses an odd number of edges: the
    /// middle of a pentagram is a hole. Edges always belong to it.
    #[derive(Clone, PartialEq, Debug)]
    pub struct Polygon = "polygon" {
        /// The corners, at least three.
        pub points: Positions [Positions],
    }
}

impl Polygon {
    /// Twice the area vector (Newell's sums), about the middle.
    fn area(&self) -> DVec3 {
        let middle = points::middle(&self.points).translation;
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().zip(next).map(|(a, b)| (*a - middle).cross(*b - middle)).sum()
    }

    /// The corners in the pose: x, y, and the distance off the plane.
    fn corners(&self) -> Vec<DVec3> {
        let to_pose = self.pose().inverse();
        self.points.iter().map(|point| to_pose.transform_point3(*point)).collect()
    }

    /// The edges in the plane of the pose.
    fn edges(&self) -> Vec<[DVec2; 2]> {
        let corners = self.corners();
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| [a.truncate(), b.truncate()]).collect()
    }

    /// The nearest place of each edge to a point of the pose; no places for a point above or below the
    /// inside.
    fn places(&self, q: DVec3) -> Vec<NearestPlace> {
        let edges = self.edges();
        let crossed = |[a, b]: &&[DVec2; 2]| {
            (a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) * (b.x - a.x) / (b.y - a.y)
        };
        if edges.iter().filter(crossed).count() % 2 == 1 {
            return Vec::new();
        }
        let place = |[a, b]: &[DVec2; 2]| {
            let along = *b - *a;
            let square = along.length_squared();
            let t = if square > 0.0 { ((q.truncate() - *a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
            let square = segment_distance_squared(q, a.extend(0.0), b.extend(0.0));
            NearestPlace { distance: square.sqrt(), foot: (*a + t * along).extend(0.0), firmness: 1.0 }
        };
        edges.iter().map(place).collect()
    }
}

impl SkeletonMember for Polygon {
    const COLUMNS: &'static [&'static str] = &[];
    const CREASES: bool = true;
    const SYMMETRY: Symmetry = Symmetry::None;
    const PIECES: Option<Pieces> =
        Some(Pieces { columns: &["ax", "ay", "ux", "uy", "length", "by", "lean"], local: false });

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let back = *map * self.pose();
        Bounds::around(
            self.corners().into_iter().map(|corner| back.transform_point3(corner.truncate().extend(0.0))),
        )
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let q = self.pose().inverse().transform_point3(p);
        let places = self.places(q);
        if places.is_empty() { q.z * q.z } else { points::distance_squared(places) }
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        points::kink_distance(&self.places(self.pose().inverse().transform_point3(p)))
    }

    fn pose(&self) -> DAffine3 {
        let n = super::unit(self.area());
        let middle = points::middle(&self.points).translation;
        let height = self.points.iter().map(|point| (*point - middle).dot(n)).sum::<f64>();
        let count = self.points.len().max(1) as f64;
        DAffine3::from_mat3_translation(
            if n == DVec3::ZERO { DMat3::IDENTITY } else { super::along(n) },
            middle + n * (height / count),
        )
    }

    fn columns(&self, _scale: f64, _row: &mut Vec<f64>) {}

    fn emit<D: Domain>(d: &mut D, [_, _, z]: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let zero = d.constant(0.0);
        let inside = d.lt(row[1], zero);
        let in_plane = d.select(inside, zero, row[0]);
        d.fma(z, z, in_plane)
    }

    fn pieces(&self, scale: f64, _reach: f64, rows: &mut Vec<f64>) {
        for edge in self.edges() {
            let [a, b] = edge.map(|corner| scale * corner);
            let u = super::unit((b - a).extend(0.0));
            // Made of the corners as rows hold them, in f32: so a crossing of the ray is never far from its
            // edge.
            let [near, far] = [a, b].map(|corner| corner.as_vec2().as_dvec2());
            let rise = far.y - near.y;
            let lean = if rise == 0.0 { 0.0 } else { (far.x - near.x) / rise };
            rows.extend([a.x, a.y, u.x, u.y, a.distance(b), b.y, lean]);
        }
    }

    fn piece_bounds_under(&self, _reach: f64, map: &DAffine3) -> Vec<Bounds> {
        let back = *map * self.pose();
        let bounds = |edge: [DVec2; 2]| {
            Bounds::around(edge.map(|corner| back.transform_point3(corner.extend(0.0))))
        };
        self.edges().into_iter().map(bounds).collect()
    }

    fn piece_count(&self, _reach: f64, _most: usize) -> usize {
        self.points.len()
    }

    /// The smallest squared distance in the plane, and a number whose sign changes at each crossing.
    fn begin<D: Domain>(d: &mut D, beyond: D::Real) -> Vec<D::Real> {
        vec![d.mul(beyond, beyond), d.constant(1.0)]
    }

    fn step<D: Domain>(
        d: &mut D,
        [x, y, _]: [D::Real; 3],
        edge: &[D::Real],
        so_far: &[D::Real],
    ) -> Vec<D::Real> {
        let from_a = [d.sub(x, edge[0]), d.sub(y, edge[1])];
        let along_x = d.mul(from_a[0], edge[2]);
        let along = d.fma(from_a[1], edge[3], along_x);
        let along = super::positive_part(d, along);
        let along = d.min(along, edge[4]);
        let back = d.stop_gradient(along);
        let back = d.neg(back);
        let off = [d.fma(back, edge[2], from_a[0]), d.fma(back, edge[3], from_a[1])];
        let square = super::sum_of_squares(d, off[0], off[1]);
        let nearest = d.min(square, so_far[0]);

        let (a_above, b_above) = (d.lt(y, edge[1]), d.lt(y, edge[5]));
        let (one, two) = (d.either(a_above, b_above), d.both(a_above, b_above));
        let not_two = d.not(two);
        let spans = d.both(one, not_two);
        let crossing = d.mul(from_a[1], edge[6]);
        let before = d.lt(from_a[0], crossing);
        let crosses = d.both(spans, before);
        let other = d.neg(so_far[1]);
        vec![nearest, d.select(crosses, other, so_far[1])]
    }

    fn fault(&self) -> Option<Diagnostic> {
        let fault = points::fault(Self::NAME, &self.points, &[], 3);
        if fault.is_some() {
            return fault;
        }
        let corners = self.corners();
        let size = corners.iter().map(|corner| corner.truncate().length()).fold(0.0, f64::max);
        let off = corners.iter().map(|corner| corner.z.abs()).fold(0.0, f64::max);
        // Written to make NaN a fault too.
        let (has_area, is_flat) = (self.area().length() >= LEAST_AREA * size * size, off <= FLATNESS * size);
        if !has_area {
            let error = Diagnostic::error(None, "the polygon has no area");
            return Some(error.expected("expected corners that are not all on a line"));
        }
        if !is_flat {
            let error = Diagnostic::error(None, format!("the polygon is not flat: a corner is {off:.1e} off its plane"));
            return Some(error.expected(format!("expected at most {:.1e}, {FLATNESS:e} of its size", FLATNESS * size)));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    fn polygon(points: &[[f64; 2]]) -> Polygon {
        Polygon { points: points.iter().map(|&[x, y]| DVec3::new(x, y, 1.0)).collect() }
    }

    #[test]
    fn known_distances() {
        // An L: the notch is outside.
        let letter = polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]]);
        for (p, expected) in [
            ([0.5, 3.0, 3.0], 4.0),
            ([3.0, 3.0, 1.0], 4.0),
            ([2.0, 0.5, 1.0], 0.0),
            ([-3.0, -4.0, 1.0], 25.0),
            ([1.5, 3.0, 1.0], 0.25),
            // On a level with corners, which a ray passes.
            ([-1.0, 1.0, 1.0], 1.0),
            ([3.0, 4.0, 1.0], 4.0),
            ([0.5, 1.0, 2.0], 1.0),
        ] {
            testing::same_everywhere(&letter, p.into(), expected);
        }
        let mut other_way = letter.points.to_vec();
        other_way.reverse();
        testing::same_everywhere(&Polygon { points: other_way.into() }, DVec3::new(2.0, 0.5, 3.0), 4.0);
    }

    #[test]
    fn the_middle_of_a_pentagram_is_a_hole() {
        let corner = |i: u32| {
            let angle = f64::from(i) * 2.0 * std::f64::consts::TAU / 5.0;
            [angle.cos(), angle.sin()]
        };
        let star = polygon(&[0, 1, 2, 3, 4].map(corner));
        // The edges are at cos 72 degrees from the middle.
        let middle = (std::f64::consts::TAU / 5.0).cos();
        testing::same_everywhere(&star, DVec3::new(0.0, 0.0, 1.0), middle * middle);
        testing::same_everywhere(&star, DVec3::new(0.6, 0.0, 1.5), 0.25);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.3, |rng| {
            // A star around its middle, concave as a rule, made of triangles.
            let turn = DMat3::from_quat(glam::DQuat::from_axis_angle(testing::direction(rng), 6.0 * rng.f64()));
            let (at, count) = (testing::position(rng), rng.usize(3..9));
            let corner = |i: usize, radius: f64| {
                let (sin, cos) = (i as f64 * std::f64::consts::TAU / count as f64).sin_cos();
                at + turn * DVec3::new(radius * cos, radius * sin, 0.0)
            };
            let points: Vec<DVec3> = (0..count).map(|i| corner(i, 1.0 + 3.0 * rng.f64())).collect();
            let mut samples = Vec::new();
            for (i, &a) in points.iter().enumerate() {
                let b = points[(i + 1) % count];
                for (s, t) in (0..=60).flat_map(|s| (0..=60).map(move |t| (f64::from(s) / 60.0, f64::from(t) / 60.0))) {
                    samples.push(at.lerp(a.lerp(b, t), s));
                }
            }
            (Polygon { points: points.into() }, samples)
        });
    }
}
