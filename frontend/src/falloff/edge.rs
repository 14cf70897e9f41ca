//! Edges: how a field function that never reaches zero is cut off at the support radius.

use jbt_ir::Domain;

use crate::field::{Field, FieldKind, FieldValue};

/// The end of a function of the distance in a unit of its own, which never reaches zero by itself.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rim {
    /// The support radius in that unit, in [0.01, 16].
    pub cutoff: f64,
    /// What happens there.
    pub edge: Edge,
}

impl Rim {
    /// The first parameter, and what it is if it is not written; that of the edge follows.
    pub(super) const fn cutoff_field(default: f64) -> Field {
        let kind = FieldKind::Within { least: 0.01, most: 16.0 };
        Field { name: "cutoff", kind, default: Some(FieldValue::Real(default)) }
    }

    /// The rim with these two parameters.
    pub(super) fn from_fields(values: &[FieldValue]) -> Self {
        Self { cutoff: values[0].real(), edge: Edge::from_field(&values[1]) }
    }

    /// Its two parameters.
    pub(super) const fn to_fields(self) -> [FieldValue; 2] {
        [FieldValue::Real(self.cutoff), self.edge.to_field()]
    }
}

/// The edge of a falloff.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Edge {
    /// The published function inside of the support and zero from its rim outwards: if it is not zero there, the field jumps.
    Exact,
    /// The published function as far as `s = 1/2` (71 % of the support radius), and from there to the rim times a factor that
    /// falls from 1 to 0 and is flat at both ends, so that the whole is C1:
    ///
    /// ```text
    /// 1 - (1 - z^2)^2,   z = min(2 (1 - s), 1)
    /// ```
    #[default]
    Smooth,
}

impl Edge {
    /// The words of the text format, in the order of the edges.
    pub const WORDS: &'static [&'static str] = &["exact", "smooth"];

    /// The parameter of a falloff whose edge is this one, unless it is written.
    pub(super) const fn field(default: Self) -> Field {
        Field { name: "edge", kind: FieldKind::Choice(Self::WORDS), default: Some(default.to_field()) }
    }

    pub(crate) const fn to_field(self) -> FieldValue {
        FieldValue::Real(match self {
            Self::Exact => 0.0,
            Self::Smooth => 1.0,
        })
    }

    pub(super) fn from_field(value: &FieldValue) -> Self {
        if value.real() == 0.0 { Self::Exact } else { Self::Smooth }
    }

    /// The edge as the lowest bit of a variant.
    pub(super) const fn bit(self) -> u8 {
        match self {
            Self::Exact => 0,
            Self::Smooth => 1,
        }
    }

    /// The edge of a variant.
    pub(super) const fn of_bit(variant: u8) -> Self {
        if variant & 1 == 0 { Self::Exact } else { Self::Smooth }
    }

    /// The factor of the function at `s`, plainly.
    pub(super) fn factor(self, s: f64) -> f64 {
        if s >= 1.0 {
            return 0.0;
        }
        match self {
            Self::Exact => 1.0,
            Self::Smooth => {
                let z = (2.0 * (1.0 - s)).min(1.0);
                z * z * (2.0 - z * z)
            }
        }
    }

    /// The function with its edge, over the ops.
    pub(super) fn emit<D: Domain>(self, d: &mut D, u: D::Real, value: D::Real) -> D::Real {
        match self {
            Self::Exact => super::emit_inside(d, u, value),
            Self::Smooth => {
                // In this form, and not as z^2 (2 - z^2), every step falls or rises with u.
                let (one, twice) = (d.constant(1.0), d.add(u, u));
                let z = d.min(twice, one);
                let square = d.mul(z, z);
                let rest = d.sub(one, square);
                let rest = d.mul(rest, rest);
                let factor = d.sub(one, rest);
                d.mul(value, factor)
            }
        }
    }
}
