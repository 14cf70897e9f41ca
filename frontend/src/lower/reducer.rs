//! What an operator of like operands is as code.

use super::occurrence::Reducer;
use crate::combine::step::StepKind;

/// What an operator is as code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum ReducerCode {
    Sum,
    Ricci(RicciCode),
    Product,
    Union,
    Intersection,
    Step(StepKind),
}

/// What an exponent is as code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct RicciCode {
    /// An integer exponent is code: a chain of products. Any other is a number of the row.
    pub(super) integer: Option<u32>,
    /// Whether the exponent is negative; otherwise these are magnitudes.
    pub(super) negative: bool,
}

impl ReducerCode {
    /// The code of an operator.
    pub(super) const fn of(reducer: Reducer) -> Self {
        match reducer {
            Reducer::Sum => Self::Sum,
            Reducer::Ricci(n) if n.abs() == (n.abs() as u32) as f64 => {
                Self::Ricci(RicciCode { integer: Some(n.abs() as u32), negative: n < 0.0 })
            }
            Reducer::Ricci(n) | Reducer::RicciFollowing(n) => {
                Self::Ricci(RicciCode { integer: None, negative: n < 0.0 })
            }
            Reducer::Product => Self::Product,
            Reducer::Union => Self::Union,
            Reducer::Intersection => Self::Intersection,
            Reducer::Step(kind, _) => Self::Step(kind),
        }
    }

    /// Whether operands are met in the order of the file, the first of them alone.
    pub(super) const fn is_ordered(self) -> bool {
        match self {
            Self::Step(_) => true,
            Self::Sum | Self::Ricci(_) | Self::Product | Self::Union | Self::Intersection => false,
        }
    }

    /// Names of the numbers that a row keeps for the operator.
    pub(super) fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Ricci(RicciCode { integer: None, .. }) => &["exponent", "inverse_exponent"],
            Self::Step(kind) => kind.columns(),
            Self::Ricci(_) | Self::Sum | Self::Product | Self::Union | Self::Intersection => &[],
        }
    }

    /// These numbers.
    pub(super) fn push_columns(self, reducer: Reducer, row: &mut Vec<f64>) {
        match (reducer, self) {
            (
                Reducer::Ricci(n) | Reducer::RicciFollowing(n),
                Self::Ricci(RicciCode { integer: None, .. }),
            ) => row.extend([n.abs(), 1.0 / n.abs()]),
            (Reducer::Step(kind, number), _) => kind.push_columns(number, row),
            (
                Reducer::Sum
                | Reducer::Ricci(_)
                | Reducer::RicciFollowing(_)
                | Reducer::Product
                | Reducer::Union
                | Reducer::Intersection,
                _,
            ) => {}
        }
    }

    /// The word for it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sum => "sum",
            Self::Ricci(_) => "ricci",
            Self::Product => "product",
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Step(kind) => kind.name(),
        }
    }
}
