//! Steps: operators of two fields that take more by folding from the left, in the order of the file. What the members have in common, and
//! their list.
//!
//! ```text
//! F = step(.. step(step(f_1, f_2), f_3) .., f_n)        A likewise: of both sides' attributes, by their weights
//! ```
//!
//! A step weighs its two sides by `max(0, f dF/df)`; a side without weight is not there, nor is one whose own sides had none.

use jbt_ir::Domain;

use super::rfunction::{FamilyKind, RFunction};
use super::smooth::Smooth;
use super::symmetric_difference::SymmetricDifference;
use super::{Combinator, Form, SetOperation};
use crate::lower::guide::Rule;

/// What becomes of two sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<R> {
    /// The field.
    pub(crate) field: R,
    /// How much of the attributes comes from the left and from the right side, up to a common factor; at least 0.
    pub(crate) weights: [R; 2],
}

/// Where a step can be something else than 0.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Reach {
    /// Where any side is.
    Any,
    /// Where both are, if none is negative anywhere.
    Both,
    /// Where the left side is.
    Left,
}

/// What a step has. `number` is the one of the combinator; whoever has none is given 0.
pub(super) trait Step: Copy {
    /// Names of the numbers that a row keeps for it.
    fn column_names(self) -> &'static [&'static str];

    /// Pushes these numbers.
    fn columns(self, number: f64, row: &mut Vec<f64>);

    /// The step, plainly.
    fn pair(self, sides: [f64; 2], number: f64, iso: f64) -> Pair<f64>;

    /// How far two fields are from where another formula holds, or another side wins.
    fn decision(self, sides: [f64; 2], number: f64, iso: f64) -> f64;

    /// Where it can be something else than 0.
    fn reach(self) -> Reach;

    /// What may be done with right sides that are rows and zero; `non_negative`: no field can be negative.
    fn rule(self, non_negative: bool) -> Rule;

    /// Whether the field can never be negative, if those of the sides can (`false`) or cannot (`true`).
    fn is_non_negative(self, sides: [bool; 2]) -> bool;

    /// The step over the ops. `iso2` is twice the iso-value.
    fn emit<D: Domain>(self, d: &mut D, sides: [D::Real; 2], row: &[D::Real], iso2: D::Real)
    -> Pair<D::Real>;
}

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

impl Combinator {
    /// The kind of a step, and its number.
    pub(crate) fn step(self) -> Option<(StepKind, f64)> {
        match self.form() {
            Form::Step(kind) => Some((kind, self.numbers().first().copied().unwrap_or(0.0))),
            Form::Fold | Form::Difference | Form::Map(_) => None,
        }
    }
}

/// The field of a step's children, and how much of the attributes comes from each: nothing at all where the field is not positive.
pub(super) fn fold(combinator: Combinator, fields: &[f64], iso: f64) -> (f64, Vec<f64>) {
    let (kind, number) = combinator.step().expect("it is a step");
    let mut field = fields[0];
    let mut weights = vec![1.0];
    for &right in &fields[1..] {
        let pair = on_member!(kind, member => member.pair([field, right], number, iso));
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

/// How far a step's children are from any decision.
pub(super) fn decision(combinator: Combinator, fields: &[f64], iso: f64) -> f64 {
    let (kind, number) = combinator.step().expect("it is a step");
    let mut field = fields[0];
    let mut nearest = f64::INFINITY;
    for &right in &fields[1..] {
        let sides = [field, right];
        nearest = on_member!(kind, member => nearest.min(member.decision(sides, number, iso)));
        field = on_member!(kind, member => member.pair(sides, number, iso)).field;
    }
    nearest
}
