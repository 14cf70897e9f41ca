//! What steps and maps state about themselves, and what may be done with their operands.

use jbt_ir::{Domain, Rule};

/// What a map has.
pub(super) trait Unary: Copy {
    /// Names of the numbers that a row keeps for it.
    const COLUMNS: &'static [&'static str];

    /// Pushes these numbers, from those of the combinator.
    fn columns(self, numbers: &[f64], iso: f64, row: &mut Vec<f64>);

    /// The field, plainly.
    fn field(self, f: f64, numbers: &[f64], iso: f64) -> f64;

    /// How far a field is from where another formula holds.
    fn kink_distance(self, f: f64, numbers: &[f64], iso: f64) -> f64;

    /// Whether the field can never be negative, if that of the child can (`false`) or cannot (`true`).
    fn is_non_negative(self, child: bool, numbers: &[f64]) -> bool;

    /// The field over the ops. `iso2` is twice the iso-value.
    fn emit<D: Domain>(self, d: &mut D, f: D::Real, row: &[D::Real], iso2: D::Real) -> D::Real;
}

/// What becomes of two sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<R> {
    /// The field.
    pub(crate) field: R,
    /// How much of the attributes comes from the left and from the right side, up to a common factor; at
    /// least 0.
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
    fn kink_distance(self, sides: [f64; 2], number: f64, iso: f64) -> f64;

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

/// The difference between the largest and the second largest; infinity if there is no second.
pub(super) fn lead(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut first, mut second) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for value in values {
        if value > first {
            (first, second) = (value, first);
        } else if value > second {
            second = value;
        }
    }
    if second == f64::NEG_INFINITY { f64::INFINITY } else { first - second }
}
