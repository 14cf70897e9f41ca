//! The gradient: a ramp from one place to another.
//!
//! `t = clamp((p - from) . (to - from) / |to - from|^2, 0, 1)`: 0 before `from`, 1 behind `to`.

use glam::DVec3;
use jbt_ir::{Domain, limits};

use super::{TextureMember, emit_unit, first_three};
use crate::member::member;

member! {
    /// A ramp between the planes through two places, across the line between them. Equal places give 0
    /// everywhere.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Gradient = "gradient" {
        /// Where t begins to rise.
        pub from: DVec3 [Position],
        /// Where t has become 1.
        pub to: DVec3 [Position],
    }
}

impl Gradient {
    /// The derivatives of t along the axes.
    fn slope(&self) -> DVec3 {
        let way = self.to - self.from;
        if way.length() < limits::MIN_LENGTH { DVec3::ZERO } else { way / way.length_squared() }
    }
}

impl TextureMember for Gradient {
    fn value(&self, p: DVec3) -> f64 {
        (p - self.from).dot(self.slope()).clamp(0.0, 1.0)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn columns(_variant: u8) -> &'static [&'static str] {
        &["slope_x", "slope_y", "slope_z", "from_x", "from_y", "from_z"]
    }

    fn push_columns(&self, _variant: u8, row: &mut Vec<f64>) {
        row.extend(self.slope().to_array());
        row.extend(self.from.to_array());
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let from = first_three(&row[3..]);
        let way = std::array::from_fn(|axis| d.sub(p[axis], from[axis]));
        let t = super::emit_dot(d, way, first_three(row));
        emit_unit(d, t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    #[test]
    fn rises_between_the_two_places() {
        let ramp = Gradient { from: DVec3::new(0.0, 1.0, 0.0), to: DVec3::new(0.0, 3.0, 0.0) };
        for (y, expected) in [(0.0, 0.0), (1.5, 0.25), (2.0, 0.5), (9.0, 1.0)] {
            assert_eq!(ramp.value(DVec3::new(5.0, y, 5.0)), expected);
        }
        assert_eq!(Gradient { to: ramp.from, ..ramp }.value(DVec3::ONE), 0.0);
    }

    #[test]
    fn both_forms_agree() {
        testing::judge(|rng| Gradient {
            from: DVec3::new(rng.f64(), rng.f64(), rng.f64()),
            to: DVec3::new(rng.f64() - 2.0, rng.f64(), rng.f64()),
        });
    }
}
