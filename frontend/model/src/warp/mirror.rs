//! The mirror: the child's part on the positive side of a coordinate plane appears on both sides.
//!
//! The inverse map takes the magnitude of the coordinate across the plane, so the child's part on the
//! negative side is not seen. Where the child meets the plane at an angle, there is a crease. For the mirror
//! image of the whole child use `reflect`, an affine map.

use glam::DVec3;
use jbt_ir::Domain;

use super::{WarpGrowth, WarpFault, WarpMember};
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A mirror in the plane through the origin that an axis stands on.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Mirror = "mirror" {
        /// The axis.
        pub axis: Axis [Axis] = Vector([0.0, 0.0, 1.0]),
    }
}

impl WarpMember for Mirror {
    const COLUMNS: &'static [&'static str] = &[];
    const CREASES: bool = true;

    fn inverse(&self, p: DVec3) -> DVec3 {
        let axis = self.axis.index();
        let mut q = p;
        q[axis] = p[axis].abs();
        q
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        p[self.axis.index()].abs()
    }

    fn fault(&self) -> Option<WarpFault> {
        None
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        let axis = self.axis.index();
        let mut both = child;
        if child.is_empty() || child.max[axis] < 0.0 {
            return Bounds::EMPTY;
        }
        both.min[axis] = -child.max[axis];
        both
    }

    /// A magnitude is exact.
    fn reach(&self, child: Bounds) -> Bounds {
        self.forward_bounds(child)
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        WarpGrowth { coordinates: largest, derivatives: 1.0 }
    }

    fn columns(&self, _: &mut Vec<f64>) {}

    fn variant(&self) -> u8 {
        self.axis as u8
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], _: &[D::Real]) -> [D::Real; 3] {
        let axis = variant as usize;
        let mut q = p;
        q[axis] = d.abs(p[axis]);
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing;

    #[test]
    fn both_sides_show_the_positive_half() {
        let mirror = Mirror { axis: Axis::Y };
        for y in [-2.0, 2.0] {
            testing::same(&mirror.into(), DVec3::new(1.0, y, 3.0), DVec3::new(1.0, 2.0, 3.0));
        }
        let hidden = Bounds::new(DVec3::splat(-2.0), DVec3::splat(-1.0));
        assert!(mirror.forward_bounds(hidden).is_empty());
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| Mirror { axis: Axis::ALL[rng.usize(..3)] });
    }
}
