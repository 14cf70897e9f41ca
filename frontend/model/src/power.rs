//! Powers with whole and other exponents, over the ops: what falloffs and Ricci's blend share.

use jbt_ir::Domain;

/// An exponent, as the compiler has it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Exponent<R> {
    /// A whole number: products.
    Integer(u32),
    /// Any number of at least 1, and its reciprocal.
    General(R, R),
}

/// `x^n` for x in [0, 1].
pub(crate) fn power<D: Domain>(d: &mut D, x: D::Real, exponent: Exponent<D::Real>) -> D::Real {
    match exponent {
        Exponent::General(n, _) => d.pow(x, n),
        Exponent::Integer(n) => {
            // Square and multiply, from the highest bit.
            let mut result = x;
            for bit in (0..n.ilog2()).rev() {
                result = d.mul(result, result);
                if n >> bit & 1 == 1 {
                    result = d.mul(result, x);
                }
            }
            result
        }
    }
}
