//! Steps: operators of two fields that take more by folding from the left, in the order of the file. What the
//! members have in common, and their list.
//!
//! ```text
//! F = step(.. step(step(f_1, f_2), f_3) .., f_n)        A likewise: of both sides' attributes, by their weights
//! ```
//!
//! A step weighs its two sides by `max(0, f dF/df)`; a side without weight is not there, nor is one whose own
//! sides had none.

use jbt_ir::{Domain, Rule};

use super::SetOperation;
use super::member::{Pair, Reach, Step};
use super::rfunction::{FamilyKind, RFunction};
use super::smooth::Smooth;
use super::symmetric_difference::SymmetricDifference;

/// The kind of a step: what selects code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum StepKind {
    SymmetricDifference,
    Smooth(SetOperation),
    RFunction(SetOperation, FamilyKind),
}

/// Calls a method of the member.
macro_rules! on_member {
    ($kind:expr, $member:ident => $call:expr) => {
        match $kind {
            StepKind::SymmetricDifference => {
                let $member = SymmetricDifference;
                $call
            }
            StepKind::Smooth(set) => {
                let $member = Smooth(set);
                $call
            }
            StepKind::RFunction(set, family) => {
                let $member = RFunction(set, family);
                $call
            }
        }
    };
}

impl StepKind {
    /// The word for it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::SymmetricDifference => "symmetric_difference",
            Self::Smooth(SetOperation::Union) => "smooth_union",
            Self::Smooth(SetOperation::Intersection) => "smooth_intersection",
            Self::Smooth(SetOperation::Difference) => "smooth_difference",
            Self::RFunction(..) => "rfunction",
        }
    }

    /// Names of the numbers that [`push_columns`](Self::push_columns) gives.
    pub(crate) fn columns(self) -> &'static [&'static str] {
        on_member!(self, member => member.column_names())
    }

    /// The numbers of a row.
    pub(crate) fn push_columns(self, number: f64, row: &mut Vec<f64>) {
        on_member!(self, member => member.columns(number, row));
    }

    /// See [`Step::reach`].
    pub(crate) fn reach(self) -> Reach {
        on_member!(self, member => member.reach())
    }

    /// See [`Step::rule`].
    pub(crate) fn rule(self, non_negative: bool) -> Rule {
        on_member!(self, member => member.rule(non_negative))
    }

    /// Whether the field of a fold can never be negative.
    pub(crate) fn is_non_negative(self, mut children: impl Iterator<Item = bool>) -> bool {
        let first = children.next().unwrap_or(true);
        on_member!(self, member => children.fold(first, |left, right| member.is_non_negative([left, right])))
    }

    /// The field of a step's children, and how much of the attributes comes from each: nothing at all where
    /// the field is not positive.
    pub(super) fn fold(self, number: f64, fields: &[f64], iso: f64) -> (f64, Vec<f64>) {
        let mut field = fields[0];
        let mut weights = vec![1.0];
        for &right in &fields[1..] {
            let pair = on_member!(self, member => member.pair([field, right], number, iso));
            // Once nothing has weight, the left side has none until something has.
            let known = weights.iter().any(|weight| *weight > 0.0);
            let [left, right] = if known { pair.weights } else { [0.0, pair.weights[1]] };
            if left + right > 0.0 {
                weights.iter_mut().for_each(|weight| *weight *= left / (left + right));
                weights.push(right / (left + right));
            } else {
                weights.fill(0.0);
                weights.push(0.0);
            }
            field = pair.field;
        }
        if field <= 0.0 {
            weights.fill(0.0);
        }
        (field, weights)
    }

    /// How far a step's children are from any kink.
    pub(super) fn kink_distance(self, number: f64, fields: &[f64], iso: f64) -> f64 {
        let mut field = fields[0];
        let mut nearest = f64::INFINITY;
        for &right in &fields[1..] {
            let sides = [field, right];
            nearest = on_member!(self, member => nearest.min(member.kink_distance(sides, number, iso)));
            field = on_member!(self, member => member.pair(sides, number, iso)).field;
        }
        nearest
    }

    /// The step over the ops.
    pub(crate) fn emit<D: Domain>(
        self,
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> Pair<D::Real> {
        on_member!(self, member => member.emit(d, sides, row, iso2))
    }
}
