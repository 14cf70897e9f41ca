//! The symmetric difference: what is inside of exactly one of two, `min(max(a, b), max(0, 2 iso - min(a,
//! b)))`.
//!
//! It is the difference of union and intersection, so `2 iso - f` stands for what is cut away, clamped at
//! zero as in the difference. Of more than two children it is the fold from the left, which is inside of an
//! odd number of them, as that of sets is. The child that decides gives the attributes: the larger one, or
//! the smaller one where its complement is smaller still, and it is there (its field is positive).
//!
//! Far from the other side, a side is limited to 2 iso, and once it is, a zero changes nothing: of zero rows
//! one has to stay.

use jbt_ir::{Domain, Rule};

use super::member::{Operator, PairResult, OperatorReach, Step};
use crate::member::member;
use crate::skeleton::positive_part;

member! {
    /// What is inside of an odd number of the children: of two, inside of exactly one.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct SymmetricDifference = "symmetric_difference" {}
}

impl Operator for SymmetricDifference {}

impl Step for SymmetricDifference {
    type Code = ();

    fn code(self) {}

    fn pair(self, [a, b]: [f64; 2], iso: f64) -> PairResult<f64> {
        let (larger, smaller) = (a.max(b), a.min(b));
        let cut = (2.0 * iso - smaller).max(0.0);
        let right_is_larger = a < b;
        let cuts = cut < larger && smaller > 0.0;
        let weights = if cuts == right_is_larger { [1.0, 0.0] } else { [0.0, 1.0] };
        PairResult { field: cut.min(larger), weights }
    }

    fn kink_distance(self, [a, b]: [f64; 2], iso: f64) -> f64 {
        let (larger, smaller) = (a.max(b), a.min(b));
        let cut = 2.0 * iso - smaller;
        let between = (a - b).abs().min((cut.max(0.0) - larger).abs());
        if cut.max(0.0) >= larger {
            return between;
        }
        let appears = if smaller == 0.0 { f64::INFINITY } else { smaller.abs() };
        between.min(cut.abs()).min(appears)
    }

    fn reach(self) -> OperatorReach {
        OperatorReach::Any
    }

    fn is_non_negative(self, [left, right]: [bool; 2]) -> bool {
        left || right
    }

    fn rule((): (), non_negative: bool) -> Rule {
        if non_negative { Rule::KeepOne } else { Rule::Never }
    }

    fn emit<D: Domain>(
        (): (),
        d: &mut D,
        [a, b]: [D::Real; 2],
        _: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        let (larger, smaller) = (d.max(b, a), d.min(b, a));
        let complement = d.sub(iso2, smaller);
        let cut = positive_part(d, complement);
        let field = d.min(cut, larger);
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let (decides, there) = (d.lt(cut, larger), d.lt(zero, smaller));
        let cuts = d.both(decides, there);
        let right_is_larger = d.lt(a, b);
        let (larger_wins, smaller_wins) =
            (d.select(right_is_larger, one, zero), d.select(right_is_larger, zero, one));
        let right = d.select(cuts, smaller_wins, larger_wins);
        let left = d.sub(one, right);
        PairResult { field, weights: [left, right] }
    }
}
