//! The cone: a solid one with flat ends, whole or cut off.
//!
//! Its profile in the half plane of the distance from the axis, rho, and the height, z:
//!
//! ```text
//!     z                                d^2 = inside ? 0 : the nearest of three sides
//!     ├──────── r2                     ends:  rho beyond its radius, squared, + (z -+ half)^2
//!     │           \   side             side:  |s| beyond its half length, squared, + q^2
//!     ├─────────────── r1              s, q:  along the side from its middle, and outwards from it
//! ```
//!
//! A point is inside where it is between the planes of the ends, q is negative, and rho is below the larger
//! radius. The last condition follows from the others, except by rounding at a sharp edge: it keeps the error
//! to the size of the rounding.

use glam::{DAffine3, DVec2, DVec3};
use jbt_ir::Domain;

use super::ends;
use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A solid cone or, with two radii, a frustum.
    ///
    /// Equal radii make it a cylinder, radii of 0 a segment. Equal ends make it a disc of the larger radius,
    /// whose axis is z since they say nothing else.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Cone = "cone" {
        /// One end of the axis.
        pub from: DVec3 [Position],
        /// The other end of the axis.
        pub to: DVec3 [Position],
        /// How far it reaches from the axis at `from`.
        pub from_radius: f64 [NonNegative],
        /// How far it reaches from the axis at `to`; 0 is a tip.
        pub to_radius: f64 [NonNegative] = Real(0.0),
    }
}

impl Cone {
    /// The direction of the axis.
    fn direction(&self) -> DVec3 {
        super::direction(self.to - self.from)
    }

    fn half(&self) -> f64 {
        0.5 * self.from.distance(self.to)
    }

    /// The vector of the profile's side from its end at `from` to its end at `to`.
    fn side(&self) -> DVec2 {
        DVec2::new(self.to_radius - self.from_radius, 2.0 * self.half())
    }
}

impl SkeletonMember for Cone {
    // The middle of the side is at (middle, 0), and (nx, nz) is the unit vector outwards from it.
    const COLUMNS: &'static [&'static str] =
        &["half", "from_radius", "to_radius", "largest", "middle", "nx", "nz", "side_half"];
    const SYMMETRY: Symmetry = Symmetry::Arrow;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let ends = [(self.from, self.from_radius), (self.to, self.to_radius)];
        ends::bounds_under(map, ends, |radius| super::circle_reach(map, self.direction(), radius))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let Self { from, from_radius, to_radius, .. } = *self;
        let (h, rho) = super::cylindrical(p - from, self.direction());
        let (q, side) = (DVec2::new(rho, h), self.side());
        let corners = [DVec2::new(from_radius, 0.0), DVec2::new(to_radius, side.y)];
        // Outwards is to the right of the way up. Without a height there is no inside.
        let outwards = DVec2::new(side.y, -side.x).dot(q - corners[0]);
        if side.y > 0.0 && outwards <= 0.0 && (0.0..=side.y).contains(&h) {
            return 0.0;
        }
        let segment = |start: DVec2, end: DVec2| {
            let along = end - start;
            let square = along.length_squared();
            let t = if square > 0.0 { ((q - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
            q.distance_squared(start + t * along)
        };
        let ends = corners.map(|corner| segment(DVec2::new(0.0, corner.y), corner));
        ends[0].min(ends[1]).min(segment(corners[0], corners[1]))
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    // Measured from the middle, the ends are alike.
    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::towards(self.direction()), self.from.midpoint(self.to))
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        let side = self.side();
        let length = side.length();
        // A side without length has no direction; any direction will do, because only the ends count.
        let normal = if length > 0.0 { DVec2::new(side.y, -side.x) / length } else { DVec2::X };
        let [from, to] = [scale * self.from_radius, scale * self.to_radius];
        row.extend([scale * self.half(), from, to, from.max(to), 0.5 * (from + to)]);
        row.extend([normal.x, normal.y, 0.5 * scale * length]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let &[half, from_radius, to_radius, largest, middle, nx, nz, side_half] = row else {
            panic!("a cone has {} columns", Self::COLUMNS.len())
        };
        let zero = d.constant(0.0);
        let (z, rho) = (p[2], super::emit_off_axis(d, p));
        let (above_from, above_to) = (d.add(z, half), d.sub(z, half));

        let off = d.sub(rho, middle);
        let (minus_nz, outwards) = (d.neg(nz), d.mul(off, nx));
        let outwards = d.fma(z, nz, outwards);
        let along = d.mul(off, minus_nz);
        let along = d.fma(z, nx, along);
        let past_side = super::beyond(d, along, side_half);
        let side = super::sum_of_squares(d, past_side, outwards);

        let mut nearest = side;
        for (above, radius) in [(above_from, from_radius), (above_to, to_radius)] {
            let past = d.sub(rho, radius);
            let past = super::positive_part(d, past);
            let end = super::sum_of_squares(d, past, above);
            nearest = d.min(end, nearest);
        }
        let below_from = d.neg(above_from);
        let past_largest = d.sub(rho, largest);
        let past_ends = d.max(below_from, above_to);
        let past_sides = d.max(outwards, past_largest);
        let past = d.max(past_ends, past_sides);
        let inside = d.lt(past, zero);
        d.select(inside, zero, nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Cylinder, testing};

    #[test]
    fn known_distances() {
        // The side of the profile goes from (3, 0) to (0, 4): 4 rho + 3 h = 12.
        let cone = Cone { from: DVec3::ZERO, to: DVec3::new(0.0, 4.0, 0.0), from_radius: 3.0, to_radius: 0.0 };
        for (p, expected) in [
            ([1.0, 2.0, 0.0], 0.0),
            ([0.0, 3.9, 0.0], 0.0),
            ([2.9, 0.01, 0.0], 0.0),
            ([1.5 + 4.0, 2.0 + 3.0, 0.0], 25.0), // off the middle of the side, along its normal
            ([0.0, 9.0, 0.0], 25.0),             // above the tip
            ([0.0, -2.0, 2.0], 4.0),             // below the bottom
            ([6.0, -4.0, 0.0], 25.0),            // off the edge
        ] {
            testing::same_everywhere(&cone, p.into(), expected);
        }
        let turned = Cone { from: cone.to, to: cone.from, from_radius: 0.0, to_radius: 3.0 };
        testing::same_everywhere(&turned, DVec3::new(5.5, 5.0, 0.0), 25.0);
    }

    #[test]
    fn the_degenerate_ones() {
        let [a, b] = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 3.0)];
        for (from_radius, to_radius) in [(2.0, 0.5), (0.5, 2.0), (2.0, 2.0)] {
            let disc = Cone { from: a, to: a, from_radius, to_radius };
            testing::same_everywhere(&disc, DVec3::new(0.0, 5.0, 5.0), 25.0);
            testing::same_everywhere(&disc, DVec3::new(0.0, 1.0, -2.0), 9.0);
            testing::same_everywhere(&disc, DVec3::new(1.0, 1.0, 1.0), 0.0);
        }
        let segment = Cone { from: a, to: b, from_radius: 0.0, to_radius: 0.0 };
        testing::same_everywhere(&segment, DVec3::new(3.0, 0.0, 7.0), 25.0);
        testing::same_everywhere(&segment, DVec3::new(0.0, 2.0, 2.0), 4.0);
        let point = Cone { from: a, to: a, from_radius: 0.0, to_radius: 0.0 };
        testing::same_everywhere(&point, DVec3::new(2.0, 3.0, 7.0), 49.0);
    }

    #[test]
    fn equal_radii_make_a_cylinder() {
        let mut rng = fastrand::Rng::with_seed(3);
        for _ in 0..200 {
            let (from, to, radius) = (testing::position(&mut rng), testing::position(&mut rng), 2.0 * rng.f64());
            let cone = Cone { from, to, from_radius: radius, to_radius: radius };
            let p = testing::position(&mut rng);
            testing::same_everywhere(&cone, p.as_vec3().into(), Cylinder { from, to, radius }.distance_squared(p.as_vec3().into()));
        }
    }

    #[test]
    fn a_flat_one_with_a_sharp_edge_keeps_its_bound() {
        testing::judge(0.5, |rng| sampled(rng, 0.01, 3.0));
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.6, |rng| sampled(rng, 5.0, 2.0));
    }

    /// A cone and points of it, up to `height` high and with radii up to `radius`; each third has a tip.
    fn sampled(rng: &mut fastrand::Rng, height: f64, radius: f64) -> (Cone, Vec<DVec3>) {
        let (from, along) = (testing::position(rng), testing::direction(rng));
        let to = from + height * rng.f64() * along;
        let [from_radius, to_radius] = match rng.u8(..3) {
            0 => [radius * rng.f64(), 0.0],
            1 => [0.0, radius * rng.f64()],
            _ => [radius * rng.f64(), radius * rng.f64()],
        };
        let (e1, e2) = along.any_orthonormal_pair();
        let samples = testing::polar(8, 48)
            .flat_map(|(r, turn)| {
                (0..=40).map(move |i| {
                    let t = f64::from(i) / 40.0;
                    let reach = r * (from_radius + t * (to_radius - from_radius));
                    from.lerp(to, t) + reach * (turn.cos() * e1 + turn.sin() * e2)
                })
            })
            .collect();
        (Cone { from, to, from_radius, to_radius }, samples)
    }
}
