//! Combinators: fields of the children become one field. One file per member, one list.
//!
//! A file states the plain formula in f64 for the oracle, and what the operator does with each row of a fold for the compiler.

pub(crate) mod difference;
pub(crate) mod intersection;
pub(crate) mod ricci;
pub(crate) mod sum;
pub(crate) mod union;

/// A combinator of one or more children.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Combinator {
    /// The sum of the fields: the plain blend.
    Sum,
    /// Ricci's super-elliptic blend (Ricci 1973) with this exponent in [1, 1024]: 1 is the sum, large ones near the union.
    Ricci(f64),
    /// The largest field.
    Union,
    /// The smallest field.
    Intersection,
    /// The first child without the others.
    Difference,
}

impl Combinator {
    /// The word of the text format.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sum => "sum",
            Self::Ricci(_) => "ricci",
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
        }
    }

    /// The field of the node from its children's fields, plainly.
    #[must_use]
    pub fn field(self, fields: &[f64], iso: f64) -> f64 {
        match self {
            Self::Sum => sum::field(fields),
            Self::Ricci(n) => ricci::field(fields, n),
            Self::Union => union::field(fields),
            Self::Intersection => intersection::field(fields),
            Self::Difference => difference::field(fields, iso),
        }
    }

    /// How much each child contributes, `max(0, f_i dF/df_i)` up to a common factor: what mixes attributes.
    ///
    /// By Euler's identity these add up to F for operators that are homogeneous of degree 1.
    #[must_use]
    pub fn weights(self, fields: &[f64], iso: f64) -> Vec<f64> {
        match self {
            Self::Sum => sum::weights(fields),
            Self::Ricci(n) => ricci::weights(fields, n),
            Self::Union | Self::Intersection | Self::Difference => {
                let (winner, weight) = (self.winner(fields, iso), self.field(fields, iso).max(0.0));
                (0..fields.len()).map(|child| if Some(child) == winner { weight } else { 0.0 }).collect()
            }
        }
    }

    /// The child that decides, where one does.
    #[must_use]
    pub fn winner(self, fields: &[f64], iso: f64) -> Option<usize> {
        match self {
            Self::Sum | Self::Ricci(_) => None,
            Self::Union => Some(union::winner(fields)),
            Self::Intersection => Some(intersection::winner(fields)),
            Self::Difference => Some(difference::winner(fields, iso)),
        }
    }

    /// How far the fields are from where another child would win; infinity if nothing is decided.
    #[must_use]
    pub fn decision(self, fields: &[f64], iso: f64) -> f64 {
        match self {
            Self::Sum | Self::Ricci(_) => f64::INFINITY,
            Self::Union => union::decision(fields),
            Self::Intersection => intersection::decision(fields),
            Self::Difference => difference::decision(fields, iso),
        }
    }
}

/// The difference between the largest and the second largest; infinity if there is no second.
fn lead(values: impl IntoIterator<Item = f64>) -> f64 {
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
