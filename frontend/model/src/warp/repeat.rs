//! The repetition: copies of the child at equal steps along an axis.
//!
//! ```text
//!   count 3        |    o    |    o    |    o    |        spacing: from one to the next
//!                       0         1         2             walls halfway between
//! ```
//!
//! The child is the first copy. Each point belongs to the cell of the copy that is nearest along the axis, so
//! copies cost nothing. A child that leaves its cell is cut at the wall, so it should be no longer along the
//! axis than `spacing`, and centred at the origin. The first cell has no lower wall and the last cell no
//! upper wall. Without a count, or with 0, there are copies without end to both sides; such a model has no
//! bounds, so a mesh or picture of it needs a region. A lattice is a repetition of a repetition.

use glam::DVec3;
use jbt_ir::Domain;

use super::{WarpGrowth, ROUNDINGS, UNDERFLOW, WarpFault, WarpMember};
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::member::member;

/// 1.5 * 2^23: adding and subtracting it rounds a number below 2^22 to a whole one.
pub(super) const ROUND: f32 = 12_582_912.0;
/// The last copy, to both sides, of a repetition without end: beyond, f32 has three bits left for the place
/// of a point in its cell.
const ENDLESS: f64 = (1 << 21) as f64;

member! {
    /// Copies along a coordinate axis.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Repeat = "repeat" {
        /// The axis.
        pub axis: Axis [Axis] = Vector([0.0, 0.0, 1.0]),
        /// The distance from a copy to the next.
        pub spacing: f64 [Positive],
        /// How many there are, the child among them: a whole number, 0 for no end.
        pub count: f64 [Count] = Real(0.0),
    }
}

impl Repeat {
    /// The first copy and the last.
    fn ends(&self) -> [f64; 2] {
        if self.count == 0.0 { [-ENDLESS, ENDLESS] } else { [0.0, self.count - 1.0] }
    }

    /// The place of the lower wall that the first cell lacks and of the upper wall that the last cell lacks.
    fn walls(&self) -> [f64; 2] {
        let [first, last] = self.ends();
        [(first - 0.5) * self.spacing, (last + 0.5) * self.spacing]
    }
}

impl WarpMember for Repeat {
    const COLUMNS: &'static [&'static str] =
        &["spacing", "inverse_spacing", "half_spacing", "first", "last", "lower_wall", "upper_wall"];
    const CREASES: bool = true;

    fn inverse(&self, p: DVec3) -> DVec3 {
        let (axis, [first, last]) = (self.axis.index(), self.ends());
        let mut q = p;
        q[axis] -= self.spacing * (p[axis] / self.spacing).round().clamp(first, last);
        q
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        let [lower, upper] = self.walls();
        let x = p[self.axis.index()];
        let cell = (x - lower) / self.spacing;
        let wall = (cell - cell.round()).abs() * self.spacing;
        let half = 0.5 * self.spacing;
        // The first and the last cell have one wall each; a single cell has none.
        if self.count == 1.0 {
            f64::INFINITY
        } else if x < lower + half {
            lower + self.spacing - x
        } else if x > upper - half {
            x - (upper - self.spacing)
        } else {
            wall
        }
    }

    fn fault(&self) -> Option<WarpFault> {
        None
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        let axis = self.axis.index();
        let mut all = child;
        if child.is_empty() {
            return child;
        }
        if self.count == 0.0 {
            (all.min[axis], all.max[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
        } else {
            all.max[axis] += (self.count - 1.0) * self.spacing;
        }
        all
    }

    /// The number of the nearest copy is exact; its distance, and the part beyond the walls, are off by a few
    /// units of the farthest copy.
    fn reach(&self, child: Bounds) -> Bounds {
        let axis = self.axis.index();
        let mut reach = self.forward_bounds(child);
        if !reach.is_empty() {
            let size = super::farthest(child) + (self.count + 1.0) * self.spacing;
            reach.min[axis] -= ROUNDINGS * size + UNDERFLOW;
            reach.max[axis] += ROUNDINGS * size + UNDERFLOW;
        }
        reach
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        WarpGrowth { coordinates: 1.01 * largest.max(self.spacing), derivatives: 2.0 }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        let ([first, last], [lower, upper]) = (self.ends(), self.walls());
        row.extend([self.spacing, 1.0 / self.spacing, 0.5 * self.spacing, first, last, lower, upper]);
    }

    fn variant(&self) -> u8 {
        self.axis as u8
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [spacing, inverse, half, first, last, lower, upper] = row[..] else {
            unreachable!("a repetition has seven columns")
        };
        let axis = variant as usize;
        // The part beyond the walls is added again at the end, so that the rest is known to lie in a cell and
        // ranges stay narrow.
        let between = d.max(lower, p[axis]);
        let between = d.min(upper, between);
        let beyond = d.sub(p[axis], between);
        let copies = d.mul(between, inverse);
        let round = d.constant(ROUND);
        let shifted = d.add(copies, round);
        let copy = d.sub(shifted, round);
        let copy = d.max(first, copy);
        let copy = d.min(last, copy);
        let copy = d.stop_gradient(copy);
        let back = d.neg(copy);
        let inside = d.fma(back, spacing, between);
        let other_half = d.neg(half);
        let inside = d.max(other_half, inside);
        let inside = d.min(half, inside);
        let mut q = p;
        q[axis] = d.add(inside, beyond);
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing;

    #[test]
    fn copies_stand_at_equal_steps() {
        let repeat = Repeat { axis: Axis::X, spacing: 2.0, count: 3.0 };
        for (x, expected) in
            [(0.25, 0.25), (2.25, 0.25), (4.25, 0.25), (6.25, 2.25), (-3.0, -3.0), (0.75, 0.75), (1.25, -0.75)]
        {
            testing::same(&repeat.into(), DVec3::new(x, 5.0, 6.0), DVec3::new(expected, 5.0, 6.0));
        }
        let endless = Repeat { count: 0.0, ..repeat };
        for x in [-199.5, -1.5, 0.5, 2.5, 2000.5] {
            testing::same(&endless.into(), DVec3::new(x, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0));
        }
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| Repeat {
            axis: Axis::ALL[rng.usize(..3)],
            spacing: 0.05 + 2.0 * rng.f64(),
            count: f64::from(rng.u8(..6)),
        });
    }

    #[test]
    fn bounds_end_where_the_last_copy_does() {
        let child = Bounds::new(DVec3::splat(-0.5), DVec3::splat(0.75));
        let three = Repeat { axis: Axis::Z, spacing: 2.0, count: 3.0 };
        assert_eq!(three.forward_bounds(child), Bounds::new(child.min, DVec3::new(0.75, 0.75, 4.75)));
        let bounds = Repeat { count: 0.0, ..three }.reach(child);
        assert_eq!((bounds.min.z, bounds.max.z, bounds.max.x), (f64::NEG_INFINITY, f64::INFINITY, 0.75));
    }

    #[test]
    fn decides_at_its_walls() {
        let repeat = Repeat { axis: Axis::X, spacing: 2.0, count: 2.0 };
        for (x, expected) in [(-4.0, 5.0), (0.5, 0.5), (1.0, 0.0), (1.25, 0.25), (9.0, 8.0)] {
            assert!((repeat.kink_distance(DVec3::new(x, 0.0, 0.0)) - expected).abs() < 1e-12, "at {x}");
        }
    }
}
