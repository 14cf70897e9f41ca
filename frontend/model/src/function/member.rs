//! What every function of formulas implements.

use jbt_ir::Domain;

use super::growth::Growth;

/// The range of all numbers.
pub(crate) const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// What a function implements. It takes as many operands as [`ARITY`](Self::ARITY) allows.
pub(super) trait FunctionMember {
    /// The word of the text format.
    const NAME: &'static str;
    /// The allowed numbers of operands: least and most.
    const ARITY: (usize, usize) = (1, 1);
    /// Whether its word is reserved, even where it is not called: no parameter may have the name.
    const RESERVED: bool = false;

    /// The value in formulas of parameters: an infinity or a NaN where there is none.
    fn value(x: &[f64]) -> f64;

    /// The value in formulas of a point, in f64, defined for all operands.
    fn total(x: &[f64]) -> f64 {
        Self::value(x)
    }

    /// The distance of the operands from the nearest jump, kink or pole.
    fn kink_distance(x: &[f64]) -> f64;

    /// Whether the value, with rounding, is never negative, derived from the same facts about the operands.
    fn non_negative(x: &[bool]) -> bool;

    /// A range of the value from ranges of the operands, not all of which are points.
    fn range(x: &[[f64; 2]]) -> [f64; 2] {
        let _ = x;
        ANY
    }

    /// Bounds of the value from bounds of the operands. `divisor` is the magnitude of the second operand, if
    /// that is a number other than 0.
    fn growth(x: &[Growth], divisor: Option<f64>) -> Growth {
        let _ = (x, divisor);
        Growth::UNKNOWN
    }

    /// The value in formulas of a point, over the ops. `positive` means that the first operand is known not
    /// to be negative.
    fn emit<D: Domain>(d: &mut D, x: &[D::Real], positive: bool) -> D::Real;
}
