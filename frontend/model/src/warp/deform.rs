//! The deformation: scaling, rotation and translation. Unweighted it is an affine map that costs more than
//! one. It exists to be *weighted*, so that another subtree's field says where and how much it acts.
//!
//! ```text
//! deform by (0 0 0.5) degrees 40 weighted { CHILD WEIGHT }
//!
//!        weight 1: the child as it stands after the map          the child is scaled about `center`, turned about an axis through it
//!        weight 0: the child as it is                            and moved by `by`
//! ```

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::Domain;

use super::{WarpGrowth, ROUNDINGS, UNDERFLOW, WarpFault, WarpMember, farthest};
use crate::affine::{map_bounds, rotation, sin_cos_degrees};
use crate::bounds::Bounds;
use crate::member::member;

/// Factors between the inverse of this and this are accepted.
const LARGEST_FACTOR: f64 = 1e6;
/// Nothing is promised where rounding may exceed this part of a length.
const LARGEST_PART: f64 = 0.25;

member! {
    /// An affine map about a centre.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Deform = "deform" {
        /// How far the centre moves.
        pub by: DVec3 [Position] = Vector([0.0; 3]),
        /// The axis of the turn, of any length but 0.
        pub axis: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// The turn, right-handed.
        pub degrees: f64 [Real] = Real(0.0),
        /// The factors along the coordinate axes, before the turn: none is 0.
        pub size: DVec3 [Position] = Vector([1.0; 3]),
        /// The point about which it is scaled and turned.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
    }
}

impl Deform {
    /// The map from the child's space.
    fn map(&self) -> DAffine3 {
        let turn = rotation(self.axis.normalize_or_zero(), sin_cos_degrees(self.degrees));
        let matrix = turn * DMat3::from_diagonal(self.size);
        DAffine3::from_mat3_translation(matrix, self.center + self.by - matrix * self.center)
    }
}

/// The largest sum of the magnitudes in a row of a matrix.
fn largest_row(matrix: DMat3) -> f64 {
    [0, 1, 2].map(|row| matrix.row(row).abs().element_sum()).into_iter().fold(0.0, f64::max)
}

impl WarpMember for Deform {
    const COLUMNS: &'static [&'static str] =
        &["xx", "xy", "xz", "xt", "yx", "yy", "yz", "yt", "zx", "zy", "zz", "zt"];

    fn inverse(&self, p: DVec3) -> DVec3 {
        self.map().inverse().transform_point3(p)
    }

    fn kink_distance(&self, _: DVec3) -> f64 {
        f64::INFINITY
    }

    fn fault(&self) -> Option<WarpFault> {
        let size = self.size.abs();
        let wrong = size.min_element() < 1.0 / LARGEST_FACTOR || size.max_element() > LARGEST_FACTOR;
        wrong.then(|| WarpFault {
            message: format!("the `size` of the deform is ({} {} {})", self.size.x, self.size.y, self.size.z),
            expected: "expected factors from 1e-6 to 1e6 in magnitude",
        })
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        map_bounds(&self.map(), child)
    }

    /// A coordinate takes three fused steps with numbers that are rounded once: it is off by less than 5
    /// units of 2^-24 of the sum's terms.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() {
            return child;
        }
        let map = self.map();
        let back = map.inverse();
        let (there, here) = (largest_row(map.matrix3), largest_row(back.matrix3));
        let part = ROUNDINGS * here * there;
        let fixed = ROUNDINGS
            * (here * map.translation.abs().max_element() + back.translation.abs().max_element())
            + UNDERFLOW;
        let size = farthest(child);
        if !(part <= LARGEST_PART && size.is_finite()) {
            return Bounds::new(DVec3::NEG_INFINITY, DVec3::INFINITY);
        }
        map_bounds(&map, child.grown((part * size + fixed) / (1.0 - part)))
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        let back = self.map().inverse();
        let factor = 1.01 * largest_row(back.matrix3);
        let coordinates = factor * largest + 1.01 * back.translation.abs().max_element();
        WarpGrowth { coordinates, derivatives: factor }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        let back = self.map().inverse();
        for axis in 0..3 {
            row.extend(back.matrix3.row(axis).to_array());
            row.push(back.translation[axis]);
        }
    }

    fn variant(&self) -> u8 {
        0
    }

    fn emit<D: Domain>(d: &mut D, _: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        std::array::from_fn(|axis| {
            let row = &row[4 * axis..][..4];
            let x = d.fma(p[0], row[0], row[3]);
            let xy = d.fma(p[1], row[1], x);
            d.fma(p[2], row[2], xy)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing;

    const STILL: Deform =
        Deform { by: DVec3::ZERO, axis: DVec3::Z, degrees: 0.0, size: DVec3::ONE, center: DVec3::ZERO };

    #[test]
    fn scales_turns_and_moves() {
        testing::same(&STILL.into(), DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 3.0));
        let deform = Deform { by: DVec3::Z, degrees: 90.0, center: DVec3::X, ..STILL };
        testing::same(&deform.into(), DVec3::new(1.0, 2.0, 1.0), DVec3::new(3.0, 0.0, 0.0));
        let deform = Deform { size: DVec3::new(2.0, 1.0, -1.0), center: DVec3::X, ..STILL };
        testing::same(&deform.into(), DVec3::new(3.0, 2.0, -3.0), DVec3::new(2.0, 2.0, 3.0));
        assert!(Deform { size: DVec3::new(1.0, 0.0, 1.0), ..STILL }.fault().is_some());
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| {
            let [by, axis, center] = [(); 3].map(|()| DVec3::from_array([(); 3].map(|()| testing::real(rng))));
            let size = DVec3::from_array([(); 3].map(|()| 0.2 + rng.f64()));
            Deform { by, axis: axis + DVec3::splat(1e-3), degrees: 200.0 * testing::real(rng), size, center }
        });
    }
}
