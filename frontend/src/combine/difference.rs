//! The difference: the first child without the others, `min(a, max(0, 2 iso - b_1), max(0, 2 iso - b_2),
//! ...)`.
//!
//! `2 iso - b` has the surface of b with inside and outside exchanged. Clamped at zero, the field stays
//! non-negative and within the support of the first child. The first child decides unless a subtracted one is
//! strictly smaller.

use jbt_ir::Domain;

use super::extreme::Extreme;
use super::member::Operator;
use crate::member::member;
use crate::skeleton::positive_part;

member! {
    /// The first child without the others: what is inside of the first and of no other.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Difference = "difference" {}
}

impl Operator for Difference {}

impl Difference {
    pub(super) fn field(fields: &[f64], iso: f64) -> f64 {
        fields[1..].iter().fold(fields[0], |least, f| least.min((2.0 * iso - f).max(0.0)))
    }

    /// The child that decides. Among subtracted ones the one with the largest field, also where several are
    /// clamped to zero. One without field is not there: it limits the field of the first, and leaves the rest
    /// to it.
    pub(super) fn winner(fields: &[f64], iso: f64) -> usize {
        let Some(largest) =
            (1..fields.len()).reduce(|best, i| if fields[i] > fields[best] { i } else { best })
        else {
            return 0;
        };
        let cuts = (2.0 * iso - fields[largest]).max(0.0) < fields[0];
        if cuts && fields[largest] > 0.0 { largest } else { 0 }
    }

    pub(super) fn kink_distance(fields: &[f64], iso: f64) -> f64 {
        let Some(largest) = fields[1..].iter().copied().reduce(f64::max) else {
            return f64::INFINITY;
        };
        let cut = 2.0 * iso - largest;
        let between = (cut.max(0.0) - fields[0]).abs();
        if cut.max(0.0) >= fields[0] {
            return between;
        }
        // Where a subtracted child decides: which one, whether its complement is clamped, and whether it is
        // there.
        let appears = if largest == 0.0 { f64::INFINITY } else { largest.abs() };
        let among = Extreme::Largest.lead(&fields[1..]).min(cut.abs()).min(appears);
        between.min(among)
    }
}

/// The field without the subtracted one, and whether the subtracted one gives the attributes, over the ops.
///
/// `subtracted` is the union of all that is subtracted, `iso2` twice the iso-value.
pub(crate) fn emit<D: Domain>(
    d: &mut D,
    field: D::Real,
    subtracted: D::Real,
    iso2: D::Real,
) -> (D::Real, D::Mask) {
    let complement = d.sub(iso2, subtracted);
    let cut = positive_part(d, complement);
    let (zero, cuts) = (d.constant(0.0), d.lt(cut, field));
    let there = d.lt(zero, subtracted);
    (d.min(cut, field), d.both(cuts, there))
}
