//! The checker: cubes of two kinds in turn, like a chessboard in space.
//!
//! `t = (floor(x / size) + floor(y / size) + floor(z / size)) mod 2`. On a face exactly between two layers of
//! cubes, rounding chooses the layer: shift the pattern, by a map above the node and its inverse below.

use glam::DVec3;
use jbt_ir::Domain;

use super::{TextureMember, cell, cell_kink_distance, emit_cell, emit_odd};
use crate::member::member;

member! {
    /// Cubes along the axes; the one whose lowest corner is the origin has t = 0.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Checker = "checker" {
        /// The side of a cube.
        pub size: f64 [Positive] = Real(1.0),
    }
}

impl TextureMember for Checker {
    fn value(&self, p: DVec3) -> f64 {
        let sum: i32 = p.to_array().iter().map(|x| cell(x / self.size).0).sum();
        f64::from(sum.rem_euclid(2))
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        p.to_array().iter().map(|x| self.size * cell_kink_distance(x / self.size)).fold(f64::INFINITY, f64::min)
    }

    fn columns(_variant: u8) -> &'static [&'static str] {
        &["inv_size"]
    }

    fn push_columns(&self, _variant: u8, row: &mut Vec<f64>) {
        row.push(1.0 / self.size);
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let [x, y, z] = p.map(|coordinate| {
            let scaled = d.mul(coordinate, row[0]);
            emit_cell(d, scaled).number
        });
        let xy = d.int_add(x, y);
        let sum = d.int_add(xy, z);
        emit_odd(d, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    #[test]
    fn cubes_alternate() {
        let checker = Checker { size: 0.5 };
        for (p, expected) in [
            ([0.1, 0.1, 0.1], 0.0),
            ([0.6, 0.1, 0.1], 1.0),
            ([-0.1, 0.1, 0.1], 1.0),
            ([-0.1, -0.1, 0.1], 0.0),
            ([-0.1, -0.6, 1.1], 1.0),
        ] {
            assert_eq!(checker.value(p.into()), expected, "{p:?}");
            assert_eq!(f64::from(testing::emitted(&checker, p.map(|x| x as f32))), expected, "{p:?}");
        }
        assert!((checker.kink_distance([0.6, 0.2, 0.25].into()) - 0.1).abs() < 1e-15);
    }

    #[test]
    fn both_forms_agree() {
        testing::judge(|rng| Checker { size: 0.2 + rng.f64() });
    }
}
