//! Edges: how a field function that never reaches zero is cut off at the support radius.

use jbt_ir::Domain;

use crate::field::FieldValue;
use crate::member::ParameterType;

/// The edge of a falloff.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Edge {
    /// The published function inside of the support and zero from its rim outwards: if it is not zero there,
    /// the field jumps.
    Exact,
    /// The published function as far as `s = 1/2` (71 % of the support radius), and from there to the rim
    /// times a factor that falls from 1 to 0 and is flat at both ends, so that the whole is C1:
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

    /// The edge as the value of a parameter: its index among the [words](Self::WORDS).
    pub(crate) const fn to_field(self) -> FieldValue {
        FieldValue::Real(match self {
            Self::Exact => 0.0,
            Self::Smooth => 1.0,
        })
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

    /// The factor of the function at `s`, in f64.
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
                // In this form every step is monotone in u; the form z^2 (2 - z^2) has a rising and a falling
                // factor.
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

impl ParameterType for Edge {
    fn read(value: &FieldValue) -> Self {
        if value.real() == 0.0 { Self::Exact } else { Self::Smooth }
    }

    fn write(&self) -> FieldValue {
        self.to_field()
    }
}
