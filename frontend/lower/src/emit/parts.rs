//! What is in progress while code is emitted: guards and probes.

use jbt_ir::{Rule, Table, Value};
use rustc_hash::FxHashMap as HashMap;

use crate::names::SpaceId;
use crate::prune_info::{Decision, DecisionKind, RowContest};
use jbt_model::combine::{Extreme, ReduceCode};

/// The field of a guard whose row is left out.
#[derive(Clone, Copy, Debug)]
pub(super) enum GuardStart {
    Zero,
    /// Below every field.
    Lowest,
    /// Above every field.
    Highest,
}

impl GuardStart {
    pub(super) const fn number(self) -> f32 {
        match self {
            Self::Zero => 0.0,
            Self::Lowest => f32::MIN,
            Self::Highest => f32::MAX,
        }
    }

    pub(super) const fn rule(self) -> Rule {
        match self {
            Self::Zero => Rule::Neutral,
            Self::Lowest | Self::Highest => Rule::Never,
        }
    }
}

/// What the guard of an operand is like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guard {
    pub(super) start: GuardStart,
    /// How it is left out while it is not zero.
    pub(super) decision: Option<DecisionKind>,
}

impl Guard {
    /// Of whatever is left out where it is zero, and then counts as that.
    pub(super) const ZERO: Self = Self { start: GuardStart::Zero, decision: None };
    /// Of the left side of a difference.
    pub(super) const LEFT: Self =
        Self { start: GuardStart::Highest, decision: Some(DecisionKind::DifferenceLeft) };
    /// Of what is subtracted: where it is zero, it limits the left side to twice the iso-value all the same.
    pub(super) const RIGHT: Self =
        Self { start: GuardStart::Zero, decision: Some(DecisionKind::DifferenceRight) };

    /// Of an operand.
    pub(super) const fn of(code: ReduceCode, non_negative: bool) -> Self {
        match code {
            ReduceCode::Fold(_) | ReduceCode::Step(_) => Self::ZERO,
            ReduceCode::Choice(extreme) => {
                let start = match extreme {
                    Extreme::Largest if non_negative => GuardStart::Zero,
                    Extreme::Largest => GuardStart::Lowest,
                    Extreme::Smallest => GuardStart::Highest,
                };
                Self { start, decision: Some(DecisionKind::of(extreme)) }
            }
        }
    }
}

/// A probe that may be asked for in the end, as it is seen in the innermost open row.
#[derive(Clone, Copy)]
pub(super) struct Probe {
    pub(super) name: usize,
    pub(super) value: Value,
}

/// A guard of an operator in progress, or rows that are its operands.
pub(super) struct Operand {
    pub(super) table: Table,
    pub(super) kind: DecisionKind,
    pub(super) name: usize,
}

/// The probes of a range function.
#[derive(Default)]
pub(super) struct Probes {
    /// How many there are.
    pub(super) count: usize,
    /// The probes in each open row of the scene and of guards; no others are open outside of these.
    pub(super) open: Vec<Vec<Probe>>,
    /// The point in the world, and in spaces where it is one number for a point of the world: the first of
    /// three probes.
    pub(super) points: HashMap<SpaceId, usize>,
    /// Guards whose operators are in progress, and for each operator in progress, how many are not its own.
    pub(super) operands: Vec<Operand>,
    pub(super) outer: Vec<usize>,
    pub(super) decisions: Vec<Decision>,
    pub(super) contests: Vec<RowContest>,
    /// In the end: the values behind the scene's row.
    pub(super) results: Vec<Probe>,
}
