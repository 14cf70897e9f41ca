//! The tangent of a real: `constant * factors * base vector`. The domain names lists of factors and base
//! vectors.

use crate::entity::Value;

/// Three components; `None` is an exact zero.
pub type Vector = [Option<Value>; 3];

/// The tangent of a real.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Slope {
    /// Zero.
    Zero,
    /// `constant * product of factors * base`.
    Scaled {
        /// A number that is known while compiling.
        constant: f32,
        /// The name of a list of factors of the domain.
        factors: Factors,
        /// The name of a base vector of the domain.
        base: usize,
    },
}

/// The name of a list of factors. The default one is empty: 1.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Factors(pub(super) usize);

/// A factor of a tangent.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(super) enum Factor {
    /// A number.
    Value(Value),
    /// 1 where the condition holds, 0 elsewhere.
    Where(Value),
    /// 0 where the condition holds, 1 elsewhere.
    Unless(Value),
}
