//! The L-metric: a point whose distance is a norm with any exponent, from the octahedron (1) over the ball
//! (2) to the cube (many).
//!
//! ```text
//! d^l = |x / a|^l + |y / b|^l + |z / c|^l,   l >= 1
//! ```
//!
//! **Powers of large and small numbers.** With m the largest of the three terms,
//! `d = m (sum (|x_i| / m)^l)^(1/l)`: no quotient is above 1, and the sum is in `[1, 3]`. The scale m
//! cancels, so `stop_gradient` keeps it out of the derivative. Limits that change no number (1 for a
//! quotient, 1 for the sum) make these bounds known to intervals.
//!
//! **Kinks.** Where a coordinate is 0 and l < 2, the gradient jumps (l = 1) or turns as fast as `|x|^(l-1)`:
//! `kink_distance` is the distance from these planes. It is finite everywhere, and 0 at the centre.
//!
//! **Rounding**, in units of u = 2^-24 relative to the result. A term is off by 2, and so is m, which is a
//! term. A quotient adds 1; the power multiplies the sum by l and adds 2.5 of its own; a rounded l adds 1 for
//! exponent and power together. The root brings errors times l back to 1 each, all others to at most 4.5 with
//! its own rounding of `1 / l`, and adds 2.5. In all that is less than 13; powers that underflow are smaller
//! than any of this.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;
use jbt_ir::limits::MAX_METRIC_EXPONENT;

use super::{Metric, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A point with the norm of exponent `exponent`, with weights along the axes.
    ///
    /// A radius, of the support or of the surface, is multiplied by `stretch` along each axis.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct LMetric = "lmetric" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The exponent, from 1 to [`MAX_METRIC_EXPONENT`].
        pub exponent: f64 [Within { least: 1.0, most: MAX_METRIC_EXPONENT }],
        /// How many times it reaches as far as the radius, along each axis.
        pub stretch: DVec3 [Stretches] = Vector([1.0; 3]),
    }
}

impl SkeletonMember for LMetric {
    const COLUMNS: &'static [&'static str] = &["inv_x", "inv_y", "inv_z", "l", "inv_l"];
    const CREASES: bool = true;
    const SYMMETRY: Symmetry = Symmetry::None;

    fn metric(&self) -> Metric {
        Metric::touching(self.stretch)
    }

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        Bounds::around([map.transform_point3(self.center)])
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        norm(&((p - self.center) / self.stretch).to_array(), self.exponent).powi(2)
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.exponent < 2.0 { (p - self.center).abs().min_element() } else { f64::INFINITY }
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.center)
    }

    fn columns(&self, _scale: f64, row: &mut Vec<f64>) {
        row.extend(self.stretch.recip().to_array());
        row.extend([self.exponent, self.exponent.recip()]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let terms = [0, 1, 2].map(|k| emit_term(d, p[k], row[k]));
        let distance = emit_norm(d, &terms, [row[3], row[4]]);
        d.mul(distance, distance)
    }
}

/// The norm with this exponent, in f64.
pub(super) fn norm(v: &[f64], exponent: f64) -> f64 {
    let largest = v.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    let sum: f64 = v.iter().map(|x| (x.abs() / largest).powf(exponent)).sum();
    largest * sum.powf(exponent.recip())
}

/// `|x| * inverse`, with a slope of 0 where x is 0.
pub(super) fn emit_term<D: Domain>(d: &mut D, x: D::Real, inverse: D::Real) -> D::Real {
    let size = d.abs(x);
    d.mul(size, inverse)
}

/// The norm of terms that are not negative, with the exponent and its inverse.
pub(super) fn emit_norm<D: Domain>(d: &mut D, terms: &[D::Real], [l, inv_l]: [D::Real; 2]) -> D::Real {
    // A smaller term than 2^-80 contributes nothing.
    let (one, smallest) = (d.constant(1.0), d.constant(8.271_806e-25));
    let mut largest = terms[0];
    for &term in &terms[1..] {
        largest = d.max(largest, term);
    }
    let largest = d.stop_gradient(largest);
    let divisor = d.max(largest, smallest);
    let mut sum = None;
    for &term in terms {
        let part = d.div(term, divisor);
        // These limits change no number. Where both operands are equal, their order decides whose slope
        // counts: never the slope of 1.
        let part = d.min(one, part);
        let power = d.pow(part, l);
        sum = Some(sum.map_or(power, |sum| d.add(sum, power)));
    }
    let sum = d.max(one, sum.expect("there are terms"));
    let root = d.pow(sum, inv_l);
    d.mul(largest, root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    fn metric(exponent: f64) -> LMetric {
        LMetric { center: DVec3::ZERO, exponent, stretch: DVec3::ONE }
    }

    #[test]
    fn known_distances() {
        for (exponent, p, expected) in [
            (1.0, [1.0, -2.0, 3.0], 6.0),
            (2.0, [2.0, -3.0, 6.0], 7.0),
            (3.0, [3.0, 4.0, -5.0], 6.0),
            (1024.0, [1.0, 0.5, -0.25], 1.0),
            (1024.0, [2.0, 2.0, -2.0], 2.0 * 3f64.powf(1.0 / 1024.0)),
            (1.5, [0.0, 0.0, 0.0], 0.0),
            (7.0, [0.0, -2.0, 0.0], 2.0),
        ] {
            testing::same_everywhere(&metric(exponent), p.into(), f64::powi(expected, 2));
        }
        let stretched = LMetric { stretch: DVec3::new(2.0, 1.0, 0.5), ..metric(1.0) };
        testing::same_everywhere(&stretched, DVec3::new(4.0, -1.0, 1.0), 25.0);
        assert_eq!(metric(1.5).kink_distance(DVec3::new(3.0, -0.25, 1.0)), 0.25);
        assert_eq!(metric(2.0).kink_distance(DVec3::ZERO), f64::INFINITY);
    }

    #[test]
    fn nothing_overflows_and_little_underflows() {
        for exponent in [1.0, 1.5, 2.0, 4.0, 100.0, 1024.0] {
            for size in [1e-15, 1e-10, 1e10, 1e18] {
                let p = DVec3::new(size, -0.75 * size, 0.5 * size).as_vec3().as_dvec3();
                let expected = metric(exponent).distance_squared(p);
                let got = f64::from(testing::emitted(&metric(exponent), p));
                assert!((got / expected - 1.0).abs() < 2e-6, "{exponent} at {size}: {got}, not {expected}");
            }
        }
    }

    #[test]
    fn agrees_with_samples_of_its_level_sets() {
        testing::judge_norm(|rng| {
            let exponent = [1.0, 1.0 + rng.f64(), 2.0, 2.0 + 8.0 * rng.f64(), 1024f64.powf(rng.f64())][rng.usize(..5)];
            let stretch = DVec3::from_array(std::array::from_fn(|_| 0.2 + 2.0 * rng.f64()));
            let l = LMetric { center: testing::position(rng), exponent, stretch };
            // A direction, scaled to length 1 in the norm.
            let onto = |v: DVec3| {
                let top = v.abs().max_element();
                let sum: f64 = v.to_array().iter().map(|x| (x.abs() / top).powf(exponent)).sum();
                stretch * v / (top * sum.powf(1.0 / exponent))
            };
            (l, l.center, testing::sphere(24).map(onto).collect())
        });
    }
}
