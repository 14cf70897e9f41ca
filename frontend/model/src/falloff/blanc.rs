//! The extended field function of Blanc and Schlick (1995): two rational pieces, with a hardness p.
//!
//! ```text
//! 1 - 9 s^2 / (p + (9/2 - 4p) s)                   s <= 1/4
//! (1 - s)^2 / (3/4 - p + (3/2 + 4p) s)             1/4 <= s <= 1
//! ```
//!
//! Whatever p is, it is 1/2 at half the radius, with slope `-(2 + 16/9 p)` in r there, C1 at the seam and at
//! the rim. The larger p, the nearer it is to a step; p = 0 makes the inner piece `1 - 2s`. Both fall for
//! every p >= 0.
//!
//! Over the ops it is the sum of two terms: the outer piece up to the seam, and the increase by the inner
//! piece:
//!
//! ```text
//! x^2 / (9/8 + (3/2 + 4p) (3/4 - x))  +  1/2 - 9 y / (9/2 + p (1/y - 4)),      x = min(u, 3/4),  y = min(s, 1/4)
//! ```

use jbt_ir::Domain;

use super::{FalloffMember, Nearness, bisect, emit_square};
use crate::member::member;

member! {
    /// Blanc and Schlick's. Text: `blanc { hardness 0 }`, which is the default; also `schlick`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Blanc = "blanc" {
        /// p, in [0, 100].
        pub hardness: f64 [Within { least: 0.0, most: 100.0 }] = Real(0.0),
    }
}

/// The smallest y that is a divisor: the least difference between 1 and another u.
const LEAST: f32 = 1.0 / (1 << 24) as f32;

impl FalloffMember for Blanc {
    const ALIASES: &'static [&'static str] = &["schlick"];

    fn value(&self, s: f64) -> f64 {
        let p = self.hardness;
        if s >= 1.0 {
            0.0
        } else if s == 0.0 {
            // Also for p = 0, where the quotient below is 0 / 0.
            1.0
        } else if s <= 0.25 {
            1.0 - 9.0 * s * s / (p + (4.5 - 4.0 * p) * s)
        } else {
            (1.0 - s).powi(2) / (0.75 - p + (1.5 + 4.0 * p) * s)
        }
    }

    fn inverse(&self, level: f64) -> f64 {
        bisect(|s| self.value(s), level)
    }

    fn steepness(&self) -> f64 {
        64.0 * (1.0 + self.hardness)
    }

    fn is_pointed(&self) -> bool {
        false
    }

    fn variant(&self, _follows: bool) -> u8 {
        0
    }

    fn column_names(_variant: u8) -> &'static [&'static str] {
        &["hardness", "falloff_rise"]
    }

    fn columns(&self, _variant: u8, row: &mut Vec<f64>) {
        row.extend([self.hardness, 1.5 + 4.0 * self.hardness]);
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real {
        let u = near.u;
        let [seam_u, seam_s, least] = [0.75, 0.25, LEAST].map(|number| d.constant(number));
        let [one, half, four, nine] = [1.0, 0.5, 4.0, 9.0].map(|number| d.constant(number));
        let [outer_seam, inner_seam] = [1.125, 4.5].map(|number| d.constant(number));

        // At the seam itself x has a slope in u and y has none: without any slope the gradient would be 0
        // there.
        let x = d.min(seam_u, u);
        let square = d.mul(x, x);
        let before = d.sub(seam_u, x);
        let divisor = d.fma(row[1], before, outer_seam);
        let outer = d.div(square, divisor);

        let s = emit_square(d, u);
        let y = d.min(s, seam_s);
        let positive = d.max(y, least);
        let inverse = d.div(one, positive);
        let before = d.sub(inverse, four);
        let divisor = d.fma(row[0], before, inner_seam);
        let numerator = d.mul(nine, y);
        let fallen = d.div(numerator, divisor);
        // Exactly 0 outside of the seam, where y is 1/4 and both numbers are exact.
        let inner = d.sub(half, fallen);
        d.add(outer, inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::testing::{Published, slope};

    #[test]
    fn published_values() {
        for hardness in [0.0, 0.4, 1.0, 1.125, 5.0, 100.0] {
            let blanc = Blanc { hardness };
            Published { half: Some(0.5), steepest: None }.check(blanc.into());
            let expected = -(2.0 + 16.0 / 9.0 * hardness);
            for r in [0.5 - 1e-7, 0.5 + 1e-7] {
                let slope = slope(blanc.into(), r, 1e-8);
                assert!((slope - expected).abs() < 1e-4 * expected * expected, "{slope} for {expected}");
            }
        }
    }
}
