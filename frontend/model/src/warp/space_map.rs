//! The space map: pulls the child at one point to another point, within a ball (HyperFun's
//! `hfSpaceMapCubic`).
//!
//! ```text
//! inverse:   p - f(t) (to - from),     t = |p - to| / radius,     f(t) = (1 - t)^3 / (1 + t) for t < 1, 0 beyond
//! ```
//!
//! f falls from 1 to 0, so the child's point `from` appears at `to`, and outside of the ball around `to`
//! nothing moves. The map is C2 at the rim; at `to` it has the tip of a cone. Several control points are
//! nested maps. With a radius below four times the distance from `from` to `to`, space folds: parts of the
//! child are seen more than once. HyperFun gives the radius as `ratio * (1 + |to - from|)`.

use glam::DVec3;
use jbt_ir::Domain;

use super::{WarpGrowth, ROUNDINGS, UNDERFLOW, WarpFault, WarpMember, farthest};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A pull from one point to another.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct SpaceMap = "space_map" {
        /// Whatever is here ...
        pub from: DVec3 [Position],
        /// ... appears here.
        pub to: DVec3 [Position],
        /// How far around `to` anything moves.
        pub radius: f64 [Positive],
    }
}

impl SpaceMap {
    fn shift(&self) -> DVec3 {
        self.to - self.from
    }

    /// A box around the child and its pulled parts, where the ball has this radius.
    fn pulled(&self, child: Bounds, radius: f64) -> Bounds {
        let shift = self.shift();
        let swept = Bounds::new(child.min + shift.min(DVec3::ZERO), child.max + shift.max(DVec3::ZERO));
        let moved = swept.intersection(Bounds::new(self.to, self.to).grown(radius));
        if moved.is_empty() { child } else { child.hull(moved) }
    }
}

impl WarpMember for SpaceMap {
    const COLUMNS: &'static [&'static str] =
        &["to_x", "to_y", "to_z", "inverse_radius", "shift_x", "shift_y", "shift_z"];

    fn inverse(&self, p: DVec3) -> DVec3 {
        let t = p.distance(self.to) / self.radius;
        p - (1.0 - t).max(0.0).powi(3) / (1.0 + t) * self.shift()
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.from == self.to { f64::INFINITY } else { p.distance(self.to) }
    }

    fn fault(&self) -> Option<WarpFault> {
        None
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        if child.is_empty() { child } else { self.pulled(child, self.radius) }
    }

    /// Where the computed t is 1 or more, points keep their bits; t is off by 4 units of itself and of `to`.
    /// Elsewhere the point is off by a few units of the shift and of itself.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() {
            return child;
        }
        let radius = self.radius + ROUNDINGS * (self.radius + self.to.abs().max_element());
        let size = farthest(child) + self.shift().abs().max_element();
        self.pulled(child, radius).grown(ROUNDINGS * size + UNDERFLOW)
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        let shift = self.shift().abs().max_element();
        // f falls at most four times as fast as t grows, along three axes.
        WarpGrowth { coordinates: 1.01 * (largest + shift), derivatives: 1.0 + 16.0 * shift / self.radius }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.extend(self.to.to_array());
        row.push(1.0 / self.radius);
        row.extend(self.shift().to_array());
    }

    fn variant(&self) -> u8 {
        0
    }

    fn emit<D: Domain>(d: &mut D, _: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [x, y, z] = std::array::from_fn(|axis| {
            let off = d.sub(p[axis], row[axis]);
            // In units of the radius, so that squares within the ball do not overflow.
            d.mul(off, row[3])
        });
        let square = d.mul(x, x);
        let square = d.fma(y, y, square);
        let square = d.fma(z, z, square);
        let t = d.sqrt(square);
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let rest = d.sub(one, t);
        let rest = d.max(rest, zero);
        let square = d.mul(rest, rest);
        let cube = d.mul(square, rest);
        // Beyond the rim the divisor is irrelevant, but must not overflow.
        let within = d.min(t, one);
        let divisor = d.add(within, one);
        let part = d.div(cube, divisor);
        let back = d.neg(part);
        std::array::from_fn(|axis| d.fma(back, row[4 + axis], p[axis]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing;

    #[test]
    fn what_is_at_one_point_appears_at_the_other() {
        let map = SpaceMap { from: DVec3::ZERO, to: DVec3::new(0.0, 0.5, 0.0), radius: 2.0 };
        testing::same(&map.into(), map.to, map.from);
        // t = 1/2: (1/2)^3 / (3/2) = 1/12.
        testing::same(&map.into(), DVec3::new(1.0, 0.5, 0.0), DVec3::new(1.0, 0.5 - 1.0 / 24.0, 0.0));
        testing::same(&map.into(), DVec3::new(3.0, 0.5, 0.0), DVec3::new(3.0, 0.5, 0.0));
        testing::finite(&map.into(), map.to);
        testing::finite(&map.into(), DVec3::splat(1e6));
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| SpaceMap {
            from: DVec3::from_array([(); 3].map(|()| testing::real(rng))),
            to: DVec3::from_array([(); 3].map(|()| testing::real(rng))),
            radius: 0.1 + 3.0 * rng.f64(),
        });
    }
}
