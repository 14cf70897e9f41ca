//! A warp that is given by three formulas of the point. They give the point where the child is evaluated.
//!
//! ```text
//! warp (x + 0.1 * sin(4 * y), y, z) { .. }                                 a wave across the x axis
//! warp (t = 0.5 * z, x * cos(t) + y * sin(t), y * cos(t) - x * sin(t), z)   a twist, with a definition
//! ```
//!
//! The form of the formulas is code, and their numbers are numbers of a row; see
//! [`expression`](crate::expression), which also defines the results of undefined operations. A coordinate is
//! clamped to [`LARGEST_WARPED`] in magnitude; NaN counts as the lowest.
//!
//! Formulas are an inverse map, so the box of a child that is not empty is unknown: it may be anywhere. A
//! model can state it, `warp (..) within (..) to (..)`, which is the node `within` around the warp.

use std::sync::Arc;

use glam::DVec3;
use jbt_ir::Domain;

use super::{WarpFault, WarpGrowth};
use crate::bounds::Bounds;
use crate::expression::{Form, Formula, Operand};

/// The largest magnitude of a coordinate behind a formula: 2^40.
pub const LARGEST_WARPED: f32 = 1_099_511_627_776.0;

/// A warp that is given by three formulas of the point.
#[derive(Clone, PartialEq, Debug)]
pub struct FormulaWarp {
    pub(crate) form: Arc<Form>,
    pub(crate) numbers: Vec<f64>,
}

impl FormulaWarp {
    /// The word of the text format.
    pub const NAME: &'static str = "warp";

    /// How its numbers are used.
    #[must_use]
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// Its numbers, in the order in which the formulas ask for them.
    #[must_use]
    pub fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    pub(super) fn inverse(&self, p: DVec3) -> DVec3 {
        let largest = f64::from(LARGEST_WARPED);
        let values = self.form.values(&self.numbers, p, &[]);
        let kept = |value: f64| if value.is_nan() { -largest } else { value.clamp(-largest, largest) };
        DVec3::from_array(std::array::from_fn(|axis| kept(values[axis])))
    }

    pub(super) fn kink_distance(&self, p: DVec3) -> f64 {
        self.form.kink_distance(&self.numbers, p, &[])
    }

    pub(super) fn fault(&self) -> Option<WarpFault> {
        let (values, children) = (self.form.results.len(), self.form.children());
        if values != 3 {
            let message = format!("the warp has {values} formulas");
            return Some(WarpFault { message, expected: "one for each of three coordinates" });
        }
        (children > 0).then(|| WarpFault {
            message: "the warp asks for fields".to_owned(),
            expected: "formulas of the coordinates; a second child gives a weight",
        })
    }

    /// All of space, unless the child is empty.
    pub(super) fn reach(child: Bounds) -> Bounds {
        if child.is_empty() { Bounds::EMPTY } else { Bounds::EVERYWHERE }
    }

    pub(super) fn growth(&self, largest: f64) -> WarpGrowth {
        let values = self.form.growth(&self.numbers, largest);
        let most = |of: fn(&crate::function::Growth) -> f64| values.iter().map(of).fold(0.0, f64::max);
        WarpGrowth {
            coordinates: most(|growth| growth.value).min(LARGEST_WARPED.into()),
            derivatives: most(|growth| growth.slope),
        }
    }
}

/// The formulas over the ops; `row` has the numbers.
pub(super) fn emit<D: Domain>(form: &Form, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
    let values = form.emit(d, |operand| match operand {
        Operand::Coordinate(axis) => p[axis as usize],
        Operand::Number(number) => row[number as usize],
        Operand::Child(_) | Operand::Step(_) => unreachable!("the check has excluded fields"),
    });
    let (lowest, largest) = (d.constant(-LARGEST_WARPED), d.constant(LARGEST_WARPED));
    std::array::from_fn(|axis| {
        // In this operand order a NaN gives the lowest.
        let kept = d.max(values[axis], lowest);
        d.min(kept, largest)
    })
}

impl From<&Formula> for FormulaWarp {
    /// The formula with the current values of its numbers.
    fn from(formula: &Formula) -> Self {
        let numbers = formula.numbers.iter().map(crate::number::Number::value).collect();
        Self { form: Arc::clone(&formula.form), numbers }
    }
}

impl From<&FormulaWarp> for Formula {
    fn from(warp: &FormulaWarp) -> Self {
        let numbers = warp.numbers.iter().map(|&number| number.into()).collect();
        Self { form: Arc::clone(&warp.form), numbers }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::{Axis, point, x, y, z};
    use crate::kind::NodeKind;
    use crate::term::Term;
    use crate::tree::Tree;
    use crate::warp::{Warp, testing};

    fn warp(coordinates: [Term; 3]) -> Warp {
        of(&point([0.0; 3], 1.0).warp(coordinates))
    }

    fn of(tree: &Tree) -> Warp {
        match tree.node().written().evaluated(0.5).unwrap() {
            NodeKind::Warp(warp) => warp,
            kind => panic!("{kind:?}"),
        }
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut compared = 0;
        for _ in 0..30 {
            let [p, q] = [(); 2].map(|()| testing::real(&mut rng));
            let turn = p * z();
            for coordinates in [
                [x() + p * (q * y()).sin(), y(), z()],
                [x() * turn.cos() + y() * turn.sin(), y() * turn.cos() - x() * turn.sin(), z()],
                [x() / (q * q + 0.5 + z() * z()), y() * (x() * 1e-6).exp(), z() / (0.5 + p.abs())],
                [x().abs() + q, (y() + p).modulo(1.5), x().mix(z(), 0.5 + q * y())],
                [
                    x().powf(3.0) - q * y().square(),
                    y().clamp(-1.0, z()),
                    (x() * x() + y() * y() + 0.1).sqrt(),
                ],
            ] {
                compared += testing::judge_formulas(&warp(coordinates), &mut rng);
            }
        }
        assert!(compared > 2500, "{compared} of 5,100 points are away from decisions");
    }

    #[test]
    fn bounded_formulas_have_bounded_numbers() {
        let wave = warp([x() + 0.5 * (3.0 * y()).sin(), y(), z() / 4.0]);
        let growth = wave.growth(100.0);
        assert!((100.5..101.0).contains(&growth.coordinates), "{growth:?}");
        // The derivative of the first along y, with factors below 1 raised to 1.
        assert!((4.0..4.001).contains(&growth.derivatives), "{growth:?}");
        let root = warp([(x() * x() + y() * y()).sqrt(), y(), z()]).growth(100.0);
        assert!(root.coordinates <= LARGEST_WARPED.into() && root.derivatives == f64::INFINITY, "{root:?}");
    }

    #[test]
    fn what_is_no_number_is_far_away() {
        let far = -f64::from(LARGEST_WARPED);
        let overflow = warp([(x() * 1e30).exp(), (x() * 1e30).exp() - (x() * 1e30).exp(), z()]);
        testing::same(&overflow, DVec3::new(1.0, 0.0, 2.0), DVec3::new(-far, far, 2.0));
        assert_eq!(overflow.forward_bounds(Bounds::EMPTY), Bounds::EMPTY);
    }

    /// The same maps as formulas and as members.
    #[test]
    fn a_twist_and_a_taper_as_formulas() {
        let turn = 0.7 * z();
        let scale = 1.0 + ((z() + 1.0) / 3.0).clamp(0.0, 1.0) * (0.25 - 1.0);
        let ball = point([0.0; 3], 1.0);
        let pairs: [(Tree, [Term; 3]); 2] = [
            (
                ball.twist(Axis::Z, 0.7),
                [x() * turn.cos() + y() * turn.sin(), y() * turn.cos() - x() * turn.sin(), z()],
            ),
            (ball.taper(Axis::Z, -1.0, 2.0, 1.0, 0.25), [x() / &scale, y() / &scale, z()]),
        ];
        let mut rng = fastrand::Rng::with_seed(4);
        for (member, coordinates) in pairs {
            let (member, formulas) = (of(&member), warp(coordinates));
            for _ in 0..500 {
                let p = DVec3::from_array([(); 3].map(|()| 2.0 * testing::real(&mut rng)));
                assert!(formulas.inverse(p).abs_diff_eq(member.inverse(p), 1e-12), "{p}");
                testing::same(&formulas, p.as_vec3().as_dvec3(), member.inverse(p.as_vec3().as_dvec3()));
            }
        }
    }

    #[test]
    fn a_warp_asks_for_no_fields() {
        let fault = warp([point([0.0; 3], 1.0).field(), y(), z()]).fault().expect("it asks for one");
        assert_eq!(fault.message, "the warp asks for fields");
    }
}
