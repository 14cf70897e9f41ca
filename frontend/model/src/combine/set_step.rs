//! Steps that are a set operation in a family of formulas with one number: smooth ones, R-functions.

use std::fmt::Debug;
use std::hash::Hash;

use jbt_ir::{Domain, Rule};

use super::member::{Operator, OperatorReach, PairResult, SideGrowth, Step, TakesApart};

/// The formula of a set operation in a family. It is what of the step selects code.
pub trait SetFormula: Copy + Eq + Hash + Debug {
    /// See [`Step::CREASES`].
    const CREASES: bool = true;

    /// Pushes the numbers of a row.
    fn push_columns(self, number: f64, row: &mut Vec<f64>);

    /// The step, plainly.
    fn pair(self, sides: [f64; 2], number: f64, iso: f64) -> PairResult<f64>;

    /// How far two fields are from where gradients jump.
    fn kink_distance(self, sides: [f64; 2], number: f64, iso: f64) -> f64;

    /// Where it can be something else than 0.
    fn reach(self) -> OperatorReach;

    /// Whether the field can never be negative, if those of the sides can (`false`) or cannot (`true`).
    fn is_non_negative(self, sides: [bool; 2]) -> bool;

    /// What may be done with right sides that are rows and zero; `non_negative`: no field can be negative.
    fn rule(self, non_negative: bool) -> Rule;

    /// See [`Step::growth`].
    fn growth(self) -> Option<[SideGrowth; 2]>;

    /// See [`Step::rounding`].
    fn rounding<D: Domain>(self, d: &mut D, sizes: [D::Real; 2], row: &[D::Real], iso2: D::Real) -> D::Real;

    /// See [`Step::takes_apart`].
    fn takes_apart(self) -> Option<TakesApart> {
        None
    }

    /// The step over the ops. `iso2` is twice the iso-value.
    fn emit<D: Domain>(
        self,
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real>;
}

/// A step that has such a formula.
pub trait SetStep: Operator {
    /// The family.
    type Formula: SetFormula;
    /// Names of the numbers that a row keeps for it.
    const COLUMNS: &'static [&'static str] = &[];

    /// Its formula.
    fn formula(self) -> Self::Formula;

    /// The number of the formula.
    fn number(self) -> f64;
}

impl<T: SetStep> Step for T {
    type Code = T::Formula;
    const COLUMNS: &'static [&'static str] = <T as SetStep>::COLUMNS;
    const CREASES: bool = <T::Formula as SetFormula>::CREASES;

    fn code(self) -> T::Formula {
        self.formula()
    }

    fn push_columns(self, row: &mut Vec<f64>) {
        self.formula().push_columns(self.number(), row);
    }

    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64> {
        self.formula().pair(sides, self.number(), iso)
    }

    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64 {
        self.formula().kink_distance(sides, self.number(), iso)
    }

    fn reach(self) -> OperatorReach {
        self.formula().reach()
    }

    fn is_non_negative(self, sides: [bool; 2]) -> bool {
        self.formula().is_non_negative(sides)
    }

    fn rule(formula: T::Formula, non_negative: bool) -> Rule {
        formula.rule(non_negative)
    }

    fn growth(formula: T::Formula) -> Option<[SideGrowth; 2]> {
        formula.growth()
    }

    fn rounding<D: Domain>(
        formula: T::Formula,
        d: &mut D,
        sizes: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> D::Real {
        formula.rounding(d, sizes, row, iso2)
    }

    fn takes_apart(formula: T::Formula) -> Option<TakesApart> {
        formula.takes_apart()
    }

    fn emit<D: Domain>(
        formula: T::Formula,
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        formula.emit(d, sides, row, iso2)
    }
}
