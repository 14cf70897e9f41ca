//! Stripes: layers of two kinds in turn.
//!
//! `t = floor(p . along / width) mod 2`, with `along` of length 1.

use glam::DVec3;
use jbt_ir::Domain;

use super::{TextureMember, cell, cell_kink_distance, emit_cell, emit_dot, emit_odd, first_three};
use crate::member::member;

member! {
    /// Layers across a direction; the first one on its side of the origin has t = 0.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Stripes = "stripes" {
        /// The direction in which they follow each other, of any length but 0.
        pub along: DVec3 [Direction] = Vector([1.0, 0.0, 0.0]),
        /// How thick each is.
        pub width: f64 [Positive] = Real(1.0),
    }
}

impl Stripes {
    /// How many layers a point is away from the origin.
    fn layers(&self, p: DVec3) -> f64 {
        p.dot(crate::skeleton::unit(self.along)) / self.width
    }
}

impl TextureMember for Stripes {
    fn value(&self, p: DVec3) -> f64 {
        f64::from(cell(self.layers(p)).0.rem_euclid(2))
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        self.width * cell_kink_distance(self.layers(p))
    }

    fn columns(_variant: u8) -> &'static [&'static str] {
        &["along_x", "along_y", "along_z"]
    }

    fn push_columns(&self, _variant: u8, row: &mut Vec<f64>) {
        row.extend((crate::skeleton::unit(self.along) / self.width).to_array());
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let layers = emit_dot(d, p, first_three(row));
        let number = emit_cell(d, layers).number;
        emit_odd(d, number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    #[test]
    fn layers_alternate() {
        let stripes = Stripes { along: DVec3::new(0.0, 2.0, 0.0), width: 0.5 };
        for (y, expected) in [(0.1, 0.0), (0.6, 1.0), (-0.1, 1.0), (-0.6, 0.0)] {
            assert_eq!(stripes.value(DVec3::new(7.0, y, -3.0)), expected, "{y}");
        }
        assert!((stripes.kink_distance(DVec3::new(0.0, 0.6, 0.0)) - 0.1).abs() < 1e-15);
    }

    #[test]
    fn both_forms_agree() {
        testing::judge(|rng| Stripes {
            along: DVec3::new(rng.f64() - 0.5, rng.f64() - 0.5, 0.3),
            width: 0.2 + rng.f64(),
        });
    }
}
