//! What every falloff implements, and the argument of its formula.

use jbt_ir::Domain;

use crate::member::Member;

/// How near a point is to the skeleton, over the ops: the argument of falloffs.
#[derive(Clone, Copy, Debug)]
pub struct Nearness<R> {
    /// `max(1 - s, 0)`: exactly 0 from the support radius outwards, precise near the support radius.
    pub u: R,
    /// Two factors of `-s`.
    square: R,
    slope: R,
}

impl<R: Copy> Nearness<R> {
    /// From two factors of `-s`: the squared distance and `-1 / R^2`. NaN counts as outside.
    pub fn emit<D: Domain<Real = R>>(d: &mut D, square: R, slope: R) -> Self {
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let left = d.fma(square, slope, one);
        Self { u: d.max(left, zero), square, slope }
    }

    /// `min(s, 1)`, precise near the skeleton. Where it has a slope, u is above 0.
    pub(super) fn square<D: Domain<Real = R>>(self, d: &mut D) -> R {
        let (one, back) = (d.constant(1.0), d.mul(self.square, self.slope));
        let s = d.neg(back);
        d.min(s, one)
    }

    /// `r`, the root of [`square`](Self::square).
    pub(super) fn distance<D: Domain<Real = R>>(self, d: &mut D) -> R {
        let s = self.square(d);
        d.sqrt(s)
    }
}

/// What a falloff without parameters states about itself.
pub trait PlainFalloff {
    /// The word of the text format.
    const NAME: &'static str;
    /// Synonyms of the word.
    const ALIASES: &'static [&'static str];
    /// See [`FalloffMember::steepness`].
    const STEEPNESS: f64;
    /// See [`FalloffMember::is_pointed`].
    const IS_POINTED: bool = false;

    /// The field at `s = d^2 / R^2 >= 0`, in f64.
    fn value(s: f64) -> f64;

    /// The `s` at which the field is `level`, for `0 < level < 1`.
    fn inverse(level: f64) -> f64;

    /// The field over the ops.
    fn emit<D: Domain>(d: &mut D, near: Nearness<D::Real>) -> D::Real;
}

/// What a falloff with parameters states about itself.
pub trait FalloffMember: Member {
    /// Synonyms of its name.
    const ALIASES: &'static [&'static str];

    /// The field at `s = d^2 / R^2 >= 0`, in f64.
    fn value(&self, s: f64) -> f64;

    /// The `s` at which the field is `level`, for `0 < level < 1`; the place of the jump where the field
    /// jumps over the level.
    fn inverse(&self, level: f64) -> f64;

    /// A bound of the factors, and of their products, that the chain rule multiplies for the derivative by u
    /// at u = 0. Supports rest on it.
    fn steepness(&self) -> f64;

    /// Whether the field has a tip at the skeleton: its slope in r is not 0 there, so that the gradient
    /// jumps.
    fn is_pointed(&self) -> bool;

    /// The part of the parameters that selects code. With `depends`, a parameter of the model changes the
    /// numbers, so the code must serve all values.
    fn variant(&self, depends: bool) -> u8;

    /// The names of the columns of a row, for this variant.
    fn column_names(variant: u8) -> &'static [&'static str];

    /// The numbers of a row: one for each of [`column_names`](Self::column_names).
    fn columns(&self, variant: u8, row: &mut Vec<f64>);

    /// The field over the ops; `row` holds the columns of a falloff with this variant.
    fn emit<D: Domain>(d: &mut D, variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real;
}
