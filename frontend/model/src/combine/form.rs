//! What operators of one form have in common, made of what each of them states.
//!
//! [`Plain`] is what the oracle and the check ask any operator. Each form answers for all its members at
//! once: the forms are its parameter, so that one type may have one of them.

use super::difference::Difference;
use super::extent::Extent;
use super::extreme::Extreme;
use super::member::{Choice, Fold, Reach, Step, Unary};
use crate::bounds::Bounds;

/// Operands in any order, each with a weight.
pub(super) struct Folds;
/// Operands in any order, one of which wins.
pub(super) struct Choices;
/// The first child without the others.
pub(super) struct Differences;
/// Two operands at a time, from the left: `F = step(.. step(step(f_1, f_2), f_3) .., f_n)`.
pub(super) struct Steps;
/// One child.
pub(super) struct Maps;

/// What any operator answers, whose form is `F`. See [`Combinator`](super::Combinator).
pub(super) trait Plain<F>: Copy {
    const TAKES_ONE: bool = false;
    const PASSES_SINGLE: bool = true;

    fn field(self, fields: &[f64], iso: f64) -> f64;

    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64>;

    fn winner(self, _fields: &[f64], _iso: f64) -> Option<usize> {
        None
    }

    fn kink_distance(self, fields: &[f64], iso: f64) -> f64;

    fn extent(self, children: &[Extent], iso: f64) -> Extent;

    fn is_non_negative(self, children: &mut dyn Iterator<Item = bool>, fixed: bool) -> bool;

    fn push_columns(self, depends: bool, iso: f64, row: &mut Vec<f64>);
}

impl<T: Fold> Plain<Folds> for T {
    const PASSES_SINGLE: bool = <T as Fold>::PASSES_SINGLE;

    fn field(self, fields: &[f64], iso: f64) -> f64 {
        Fold::field(self, fields, iso)
    }

    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        Fold::weights(self, fields, iso)
    }

    fn kink_distance(self, fields: &[f64], _: f64) -> f64 {
        Fold::kink_distance(self, fields)
    }

    fn extent(self, children: &[Extent], _: f64) -> Extent {
        let any = Extent::any(children);
        let signed = !any.negative.is_empty() && !Fold::is_non_negative(self, false);
        if T::absorbs(self.code(true)) {
            // One that is negative is enough, wherever all are.
            let support = Extent::all(children).support;
            return Extent { support, negative: if signed { support } else { Bounds::EMPTY } };
        }
        Extent { negative: if signed { any.negative } else { Bounds::EMPTY }, ..any }
    }

    fn is_non_negative(self, mut children: &mut dyn Iterator<Item = bool>, _: bool) -> bool {
        Fold::is_non_negative(self, true)
            && (Fold::is_non_negative(self, false) || Iterator::all(&mut children, |child| child))
    }

    fn push_columns(self, depends: bool, _: f64, row: &mut Vec<f64>) {
        Fold::push_columns(self, self.code(depends), row);
    }
}

/// The weights of children of which one decides.
fn of_winner(winner: usize, field: f64, count: usize) -> Vec<f64> {
    (0..count).map(|child| if child == winner { field.max(0.0) } else { 0.0 }).collect()
}

impl<T: Choice> Plain<Choices> for T {
    fn field(self, fields: &[f64], _: f64) -> f64 {
        fields[T::EXTREME.winner(fields)]
    }

    fn weights(self, fields: &[f64], _: f64) -> Vec<f64> {
        let winner = T::EXTREME.winner(fields);
        of_winner(winner, fields[winner], fields.len())
    }

    fn winner(self, fields: &[f64], _: f64) -> Option<usize> {
        Some(T::EXTREME.winner(fields))
    }

    fn kink_distance(self, fields: &[f64], _: f64) -> f64 {
        T::EXTREME.lead(fields)
    }

    fn extent(self, children: &[Extent], _: f64) -> Extent {
        let reach = match T::EXTREME {
            Extreme::Largest => Reach::Any,
            Extreme::Smallest => Reach::Both,
        };
        Extent::reaching(reach, children)
    }

    fn is_non_negative(self, mut children: &mut dyn Iterator<Item = bool>, _: bool) -> bool {
        match T::EXTREME {
            Extreme::Largest => Iterator::any(&mut children, |child| child),
            Extreme::Smallest => Iterator::all(&mut children, |child| child),
        }
    }

    fn push_columns(self, _: bool, _: f64, _: &mut Vec<f64>) {}
}

impl Plain<Differences> for Difference {
    fn field(self, fields: &[f64], iso: f64) -> f64 {
        Self::field(fields, iso)
    }

    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        of_winner(Self::winner(fields, iso), Self::field(fields, iso), fields.len())
    }

    fn winner(self, fields: &[f64], iso: f64) -> Option<usize> {
        Some(Self::winner(fields, iso))
    }

    fn kink_distance(self, fields: &[f64], iso: f64) -> f64 {
        Self::kink_distance(fields, iso)
    }

    fn extent(self, children: &[Extent], _: f64) -> Extent {
        Extent::reaching(Reach::Left, children)
    }

    fn is_non_negative(self, children: &mut dyn Iterator<Item = bool>, _: bool) -> bool {
        children.next().unwrap_or(true)
    }

    fn push_columns(self, _: bool, _: f64, _: &mut Vec<f64>) {}
}

/// The field of a step's children, and how much of the attributes comes from each: nothing at all where the
/// field is not positive. A side without weight is not there, nor is one whose own sides had none.
fn fold<T: Step>(step: T, fields: &[f64], iso: f64) -> (f64, Vec<f64>) {
    let mut field = fields[0];
    let mut weights = vec![1.0];
    for &right in &fields[1..] {
        let pair = step.pair([field, right], iso);
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

impl<T: Step> Plain<Steps> for T {
    fn field(self, fields: &[f64], iso: f64) -> f64 {
        fold(self, fields, iso).0
    }

    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        fold(self, fields, iso).1
    }

    fn kink_distance(self, fields: &[f64], iso: f64) -> f64 {
        let mut field = fields[0];
        let mut nearest = f64::INFINITY;
        for &right in &fields[1..] {
            nearest = nearest.min(Step::kink_distance(self, [field, right], iso));
            field = self.pair([field, right], iso).field;
        }
        nearest
    }

    fn extent(self, children: &[Extent], _: f64) -> Extent {
        let extent = Extent::reaching(self.reach(), children);
        let never = Step::is_non_negative(self, [false; 2]);
        if never { Extent { negative: Bounds::EMPTY, ..extent } } else { extent }
    }

    fn is_non_negative(self, children: &mut dyn Iterator<Item = bool>, _: bool) -> bool {
        let first = children.next().unwrap_or(true);
        children.fold(first, |left, right| Step::is_non_negative(self, [left, right]))
    }

    fn push_columns(self, _: bool, _: f64, row: &mut Vec<f64>) {
        Step::push_columns(self, row);
    }
}

/// A map keeps the attributes of its child where both fields are positive; elsewhere there is only the
/// default, because a child whose field is 0 may have been left out. Where the map of 0 is 0, the support is
/// that of the child; else there is a field everywhere.
impl<T: Unary> Plain<Maps> for T {
    const TAKES_ONE: bool = true;
    const PASSES_SINGLE: bool = false;

    fn field(self, fields: &[f64], iso: f64) -> f64 {
        Unary::field(self, fields[0], iso)
    }

    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        let seen = fields[0] > 0.0 && Unary::field(self, fields[0], iso) > 0.0;
        vec![if seen { 1.0 } else { 0.0 }]
    }

    fn kink_distance(self, fields: &[f64], iso: f64) -> f64 {
        Unary::kink_distance(self, fields[0], iso)
    }

    fn extent(self, children: &[Extent], iso: f64) -> Extent {
        let (child, at_zero) = (children[0], Unary::field(self, 0.0, iso));
        let support = if at_zero == 0.0 { child.support } else { Bounds::EVERYWHERE };
        let negative = if at_zero < 0.0 {
            Bounds::EVERYWHERE
        } else if T::REVERSES {
            child.support
        } else if Unary::is_non_negative(self, false, true) {
            Bounds::EMPTY
        } else {
            child.negative
        };
        Extent { support, negative }
    }

    fn is_non_negative(self, children: &mut dyn Iterator<Item = bool>, fixed: bool) -> bool {
        Unary::is_non_negative(self, children.next().unwrap_or(true), fixed)
    }

    fn push_columns(self, _: bool, iso: f64, row: &mut Vec<f64>) {
        Unary::push_columns(self, iso, row);
    }
}
