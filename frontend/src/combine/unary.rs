//! Maps of one field: what the members have in common, and their list.
//!
//! A map keeps the attributes of its child where both fields are positive; elsewhere there is only the
//! default, because a child whose field is 0 may have been left out. Where the map of 0 is 0, the support is
//! that of the child; else there is a field everywhere.

use jbt_ir::Domain;

use super::clamp::Clamp;
use super::complement::Complement;
use super::member::Unary;
use super::offset::Offset;
use super::shell::Shell;

/// The kind of a map: what selects code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum UnaryKind {
    Complement,
    Clamp,
    Shell,
    Offset,
}

/// Calls a method of the member.
macro_rules! on_member {
    ($kind:expr, $member:ident => $call:expr) => {
        match $kind {
            UnaryKind::Complement => {
                let $member = Complement;
                $call
            }
            UnaryKind::Clamp => {
                let $member = Clamp;
                $call
            }
            UnaryKind::Shell => {
                let $member = Shell;
                $call
            }
            UnaryKind::Offset => {
                let $member = Offset;
                $call
            }
        }
    };
}

const fn columns_of<M: Unary>(_: M) -> &'static [&'static str] {
    M::COLUMNS
}

impl UnaryKind {
    /// Names of the numbers that [`push_columns`](Self::push_columns) gives.
    pub(crate) fn columns(self) -> &'static [&'static str] {
        on_member!(self, member => columns_of(member))
    }

    /// The numbers of a row.
    pub(crate) fn push_columns(self, numbers: &[f64], iso: f64, row: &mut Vec<f64>) {
        on_member!(self, member => member.columns(numbers, iso, row));
    }

    /// Whether the field can never be negative. `fixed`: the numbers follow no parameter.
    pub(crate) fn is_non_negative(self, child: bool, numbers: &[f64], fixed: bool) -> bool {
        // Whatever a parameter may become counts as the worst that a number can be.
        let worst = vec![f64::NEG_INFINITY; numbers.len()];
        let numbers = if fixed { numbers } else { &worst };
        on_member!(self, member => member.is_non_negative(child, numbers))
    }

    /// The field of a map, plainly.
    pub(crate) fn field(self, f: f64, numbers: &[f64], iso: f64) -> f64 {
        on_member!(self, member => member.field(f, numbers, iso))
    }

    /// How far a field is from any kink of the map.
    pub(super) fn kink_distance(self, f: f64, numbers: &[f64], iso: f64) -> f64 {
        on_member!(self, member => member.kink_distance(f, numbers, iso))
    }

    /// The field over the ops.
    pub(crate) fn emit<D: Domain>(self, d: &mut D, f: D::Real, row: &[D::Real], iso2: D::Real) -> D::Real {
        on_member!(self, member => member.emit(d, f, row, iso2))
    }
}
