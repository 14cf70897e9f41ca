//! The extremes of fields: what choices are made by.

use jbt_ir::Domain;

/// Which of several fields wins; of equals, the first.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Extreme {
    /// That of a union.
    Largest,
    /// That of an intersection.
    Smallest,
}

impl Extreme {
    /// The child that wins.
    pub(super) fn winner(self, fields: &[f64]) -> usize {
        let beats = |a: f64, b: f64| match self {
            Self::Largest => a > b,
            Self::Smallest => a < b,
        };
        (1..fields.len()).fold(0, |best, i| if beats(fields[i], fields[best]) { i } else { best })
    }

    /// How far the winner is ahead of the next; infinity if there is none.
    pub(super) fn lead(self, fields: &[f64]) -> f64 {
        let sign = match self {
            Self::Largest => 1.0,
            Self::Smallest => -1.0,
        };
        let (mut first, mut second) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for value in fields.iter().map(|f| sign * f) {
            if value > first {
                (first, second) = (value, first);
            } else if value > second {
                second = value;
            }
        }
        if second == f64::NEG_INFINITY { f64::INFINITY } else { first - second }
    }

    /// The better one of two fields, over the ops; the accumulated one if they are equal.
    pub fn step<D: Domain>(self, d: &mut D, best: D::Real, field: D::Real) -> D::Real {
        match self {
            Self::Largest => d.max(field, best),
            Self::Smallest => d.min(field, best),
        }
    }

    /// Whether an operand beats the best so far.
    pub fn beats<D: Domain>(self, d: &mut D, best: D::Real, field: D::Real) -> D::Mask {
        match self {
            Self::Largest => d.lt(best, field),
            Self::Smallest => d.lt(field, best),
        }
    }
}
