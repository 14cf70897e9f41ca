//! The words for queries.

use clap::ValueEnum;
use jbt::Query;

/// The words for queries.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum QueryName {
    /// The field
    Field,
    /// Field and gradient
    Gradient,
    /// Field and attributes
    Attributes,
    /// Field, gradient and attributes
    All,
}

impl QueryName {
    /// The query.
    pub fn query(self) -> Query {
        match self {
            Self::Field => Query::FIELD,
            Self::Gradient => Query::GRADIENT,
            Self::Attributes => Query::ATTRIBUTES,
            Self::All => Query::ALL,
        }
    }
}
