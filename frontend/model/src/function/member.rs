//! What every function of formulas states about itself.

use jbt_ir::Domain;

use super::growth::Growth;

/// A range that says nothing.
pub(crate) const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// What a function states about itself. Its operands are as many as [`ARITY`](Self::ARITY) allows.
pub(super) trait FunctionMember {
    /// The word of the text format.
    const NAME: &'static str;
    /// The allowed numbers of operands: least and most.
    const ARITY: (usize, usize) = (1, 1);
    /// Whether its word means nothing else, also where it is not called: no parameter has such a name.
    const RESERVED: bool = false;

    /// The value in formulas of parameters: an infinity or a NaN where there is none.
    fn value(x: &[f64]) -> f64;

    /// The value in formulas of a point, plainly: it is there everywhere.
    fn total(x: &[f64]) -> f64 {
        Self::value(x)
    }

    /// How far the operands are from a jump, a kink or a pole.
    fn kink_distance(x: &[f64]) -> f64;

    /// Whether the value is never negative, rounding included, from the same about the operands.
    fn non_negative(x: &[bool]) -> bool;

    /// A range of the value from ranges of the operands, not all of which are points.
    fn range(x: &[[f64; 2]]) -> [f64; 2] {
        let _ = x;
        ANY
    }

    /// Bounds of the value from bounds of the operands. `divisor`: the magnitude of the second operand, if
    /// that is a number other than 0.
    fn growth(x: &[Growth], divisor: Option<f64>) -> Growth {
        let _ = (x, divisor);
        Growth::UNKNOWN
    }

    /// The value in formulas of a point, over the ops. `positive`: the first operand is known not to be
    /// negative.
    fn emit<D: Domain>(d: &mut D, x: &[D::Real], positive: bool) -> D::Real;
}
