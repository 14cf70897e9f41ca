//! What every operator states about itself: its text in [`Operator`], and its field in the trait of its form.
//!
//! | form | operands | trait |
//! |---|---|---|
//! | fold | any number in any order, each with a weight | [`Fold`] |
//! | choice | any number in any order, one of which wins | [`Choice`] |
//! | step | two at a time, from the left | [`Step`] |
//! | map | one | [`Unary`] |
//!
//! What operators of one form have in common is made of these, in [`form`](super::form).
//!
//! *Over the ops* means: written with the methods of [`Domain`]. Lowering runs such a formula on a
//! `jbt_ir::FunctionBuilder`, where each method writes an instruction; nothing is computed yet.

use std::fmt::Debug;
use std::hash::Hash;

use jbt_ir::{Domain, Rule};

use super::extreme::Extreme;
use crate::diagnostic::Diagnostic;
use crate::member::Member;

/// How the numbers of an operator are written, between its word and its block. A set operation is a word
/// alone, in front of them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Syntax {
    /// Each behind its name, in any order.
    Named,
    /// One number, which may have its name before it.
    Labelled,
    /// One number, without its name.
    Alone,
}

/// What an operator states about its text and its parameters.
pub trait Operator: Member + Copy {
    /// How its numbers are written.
    const SYNTAX: Syntax = Syntax::Named;
    /// What it is printed as.
    const HEAD: &'static str = Self::NAME;
    /// Whether what its numbers may be depends on the iso-value.
    const ASKS_ISO: bool = false;

    /// What is wrong with numbers each of which by itself is what its kind says; without a place.
    fn fault(&self, _iso: f64) -> Option<Diagnostic> {
        None
    }

    /// The operator, where a number of it depends on a parameter. No value of the parameter may turn it into
    /// another operator (`ricci` at 1 into `sum`).
    fn general(self) -> Self {
        self
    }
}

/// What the operands of an operator have in common, over the ops, and its numbers.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a, R> {
    /// Its numbers: columns of the row in which the operator stands, not of the rows of its operands.
    pub row: &'a [R],
    /// Twice the iso-value: a complement is `2 iso - field`, the same surface with inside and outside
    /// exchanged.
    pub iso2: R,
    /// Whether no operand can be negative.
    pub non_negative: bool,
    /// Whether the field will be differentiated.
    pub moving: bool,
}

/// What an operand makes of a fold.
#[derive(Clone, Debug)]
pub struct Met<R> {
    /// The accumulators behind it.
    pub so_far: Vec<R>,
    /// How much of the attributes comes from it, up to a common factor; at least 0. Nothing if nobody asks.
    pub weight: Option<R>,
    /// What weights so far have to be multiplied with.
    pub rescale: Option<R>,
}

/// What a fold comes to.
#[derive(Clone, Copy, Debug)]
pub struct Finished<R> {
    /// The field.
    pub field: R,
    /// The sum of the weights.
    pub total: R,
    /// What has to be positive, so that there are attributes.
    pub seen: R,
}

/// What a fold states: operands come in any order, and each has a weight.
pub trait Fold: Operator {
    /// What of it selects code.
    type Code: Copy + Eq + Hash + Debug;
    /// Whether a single child answers as if the operator were not there. Not by default, as for sums and
    /// blends: where the field is 0 they give default attributes.
    const PASSES_SINGLE: bool = false;
    /// Whether slopes of the field are not bounded by the sum of those of the operands.
    const IS_STEEP: bool = false;

    /// What of it selects code; `depends`: numbers depend on parameters, so that the code has to serve all
    /// values.
    fn code(self, depends: bool) -> Self::Code;

    /// The field, plainly.
    fn field(self, fields: &[f64], iso: f64) -> f64;

    /// How much each child contributes, `max(0, f_i dF/df_i)` up to a common factor.
    fn weights(self, fields: &[f64], iso: f64) -> Vec<f64>;

    /// How far the fields are from where another formula holds; infinity if nothing is decided. For tests:
    /// the oracle has a measure of its own for folds (`decide` in `walk.rs`).
    fn kink_distance(self, _fields: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Whether the field can never be negative, if those of some children can (`false`) or of none (`true`).
    fn is_non_negative(self, children: bool) -> bool;

    /// Whether an operator that is an operand of an equal one may hand its own operands on to that one.
    /// `non_negative`: none of the operands handed on can be negative.
    fn flattens(self, _non_negative: bool) -> bool {
        false
    }

    /// Whether a zero makes it zero, whatever the others are; otherwise it changes nothing.
    fn absorbs(code: Self::Code) -> bool;

    /// Names of the numbers that a row keeps for it.
    fn columns(_code: Self::Code) -> &'static [&'static str] {
        &[]
    }

    /// Pushes these numbers.
    fn push_columns(self, _code: Self::Code, _row: &mut Vec<f64>) {}

    /// The accumulators before the first operand, over the ops.
    fn start<D: Domain>(code: Self::Code, d: &mut D, setting: Setting<'_, D::Real>) -> Vec<D::Real>;

    /// One operand more; `weighs`: somebody asks for its weight.
    fn meet<D: Domain>(
        code: Self::Code,
        d: &mut D,
        so_far: &[D::Real],
        operand: D::Real,
        setting: Setting<'_, D::Real>,
        weighs: bool,
    ) -> Met<D::Real>;

    /// Whether the sum of weights is an accumulator of its own.
    fn has_total(_code: Self::Code, non_negative: bool) -> bool;

    /// What it comes to; `total` is the sum of weights, where that is an accumulator of its own.
    fn finish<D: Domain>(
        code: Self::Code,
        d: &mut D,
        so_far: &[D::Real],
        total: Option<D::Real>,
        setting: Setting<'_, D::Real>,
    ) -> Finished<D::Real>;
}

/// What a choice states: operands come in any order, and the first of those with the extreme field wins.
pub trait Choice: Operator {
    /// Which field wins.
    const EXTREME: Extreme;
}

/// Of two sides that are apart by the first number of the row, one is the result, to the bit and with its
/// attributes. Nearer ones have a result beyond that side, by that number at most.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TakesApart {
    /// Which one.
    pub extreme: Extreme,
    /// Whether the right side is the complement of its field, `max(0, 2 iso - f)`, and gives its attributes
    /// where its field is above 0.
    pub complements: bool,
}

/// How a field follows that of a side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SideGrowth {
    /// Where that is larger, it is not smaller.
    Rises,
    /// Where that is larger, it is not larger.
    Falls,
}

/// What becomes of two sides.
#[derive(Clone, Copy, Debug)]
pub struct PairResult<R> {
    /// The field.
    pub field: R,
    /// How much of the attributes comes from the left and from the right side, up to a common factor; at
    /// least 0.
    pub weights: [R; 2],
}

/// Where an operator can be something else than 0.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OperatorReach {
    /// Where any side is.
    Any,
    /// Where all are, if none is negative anywhere.
    Both,
    /// Where the left side is.
    Left,
}

/// What a step states: it takes two fields at a time, from the left.
pub trait Step: Operator {
    /// What of it selects code.
    type Code: Copy + Eq + Hash + Debug;
    /// Whether its surface has edges where the surfaces of the sides meet.
    const CREASES: bool = true;
    /// Names of the numbers that a row keeps for it.
    const COLUMNS: &'static [&'static str] = &[];

    /// What of it selects code.
    fn code(self) -> Self::Code;

    /// Pushes the numbers of a row.
    fn push_columns(self, _row: &mut Vec<f64>) {}

    /// The step, plainly.
    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64>;

    /// How far two fields are from where another formula holds, or another side wins.
    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64;

    /// Where it can be something else than 0.
    fn reach(self) -> OperatorReach;

    /// Whether the field can never be negative, if those of the sides can (`false`) or cannot (`true`).
    fn is_non_negative(self, sides: [bool; 2]) -> bool;

    /// What may be done with right sides that are rows and zero; `non_negative`: no field can be negative.
    fn rule(code: Self::Code, non_negative: bool) -> Rule;

    /// How the field follows either side, in real numbers, if it does in one way everywhere.
    fn growth(_: Self::Code) -> Option<[SideGrowth; 2]> {
        None
    }

    /// What the field may be off by, in f32, where the sides are not larger than these in magnitude. Asked
    /// where there is a [`growth`](Self::growth).
    fn rounding<D: Domain>(
        _: Self::Code,
        d: &mut D,
        _sizes: [D::Real; 2],
        _row: &[D::Real],
        _iso2: D::Real,
    ) -> D::Real {
        d.constant(f32::INFINITY)
    }

    /// Whether one of two sides that are far apart is the result.
    fn takes_apart(_: Self::Code) -> Option<TakesApart> {
        None
    }

    /// The step over the ops. `iso2` is twice the iso-value.
    fn emit<D: Domain>(
        code: Self::Code,
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real>;
}

/// What a map states: it takes one field.
pub trait Unary: Operator {
    /// Names of the numbers that a row keeps for it.
    const COLUMNS: &'static [&'static str] = &[];
    /// Whether a positive field may become negative.
    const REVERSES: bool = false;

    /// Pushes the numbers of a row.
    fn push_columns(self, _iso: f64, _row: &mut Vec<f64>) {}

    /// The field, plainly.
    fn field(self, f: f64, iso: f64) -> f64;

    /// How far a field is from where another formula holds.
    fn kink_distance(self, f: f64, iso: f64) -> f64;

    /// Whether the field can never be negative, if that of the child can (`false`) or cannot (`true`).
    /// `fixed`: the numbers depend on no parameter; otherwise they may become anything.
    fn is_non_negative(self, child: bool, fixed: bool) -> bool;

    /// The field over the ops. `iso2` is twice the iso-value.
    fn emit<D: Domain>(d: &mut D, f: D::Real, row: &[D::Real], iso2: D::Real) -> D::Real;
}
