//! The written of what an attribute node gives to leaves.

use super::field::{FieldNumber, as_written};
use crate::attribute::{AttributeValue, Textured, UvMap};
use crate::expression::Formula;
use crate::number::{Number, values};
use crate::texture::TextureKind;

/// What an attribute node gives to the leaves below it, before its formulas are evaluated.
#[derive(Clone, PartialEq, Debug)]
pub enum WrittenAttribute {
    /// One number for each channel of the group.
    Numbers(Vec<Number>),
    /// A mixture of two values.
    Textured(WrittenTextured),
    /// The uv of each leaf's skeleton.
    Uv(WrittenUv),
    /// A formula with one value for each channel.
    Expressed(Formula),
}

/// A mixture of two values by a texture.
#[derive(Clone, PartialEq, Debug)]
pub struct WrittenTextured {
    /// The kind of the texture; its variant is not looked at.
    pub texture: TextureKind,
    /// Its parameters, in the order of [`TextureKind::fields`].
    pub fields: Vec<FieldNumber>,
    /// Where the texture is 0: one number for each channel.
    pub a: Vec<Number>,
    /// Where the texture is 1: one number for each channel.
    pub b: Vec<Number>,
}

/// A map of uv: scale, then rotation about (0, 0), then shift.
#[derive(Clone, PartialEq, Debug)]
pub struct WrittenUv {
    /// The factors of u and v.
    pub scale: [Number; 2],
    /// The rotation in degrees, from u to v.
    pub degrees: Number,
    /// What is added.
    pub shift: [Number; 2],
}

impl Default for WrittenUv {
    /// The map that changes nothing.
    fn default() -> Self {
        Self::from(UvMap::IDENTITY)
    }
}

impl From<UvMap> for WrittenUv {
    fn from(map: UvMap) -> Self {
        let both = |numbers: [f64; 2]| numbers.map(Number::from);
        Self { scale: both(map.scale), degrees: map.degrees.into(), shift: both(map.shift) }
    }
}

impl From<&AttributeValue> for WrittenAttribute {
    fn from(value: &AttributeValue) -> Self {
        let all = |numbers: &[f64]| numbers.iter().map(|&number| number.into()).collect();
        match value {
            AttributeValue::Numbers(numbers) => Self::Numbers(all(numbers)),
            AttributeValue::Textured(Textured { texture, a, b }) => Self::Textured(WrittenTextured {
                texture: texture.kind(),
                fields: as_written(texture.to_fields()),
                a: all(a),
                b: all(b),
            }),
            AttributeValue::Uv(map) => Self::Uv((*map).into()),
            AttributeValue::Expressed(expression) => Self::Expressed(expression.into()),
        }
    }
}

impl WrittenAttribute {
    /// The value, with the present values of its numbers.
    #[must_use]
    pub fn value(&self) -> AttributeValue {
        let plain = |numbers: &[Number]| numbers.iter().map(Number::value).collect();
        match self {
            Self::Numbers(numbers) => AttributeValue::Numbers(plain(numbers)),
            Self::Textured(WrittenTextured { texture, fields, a, b }) => {
                let fields: Vec<_> = fields.iter().map(FieldNumber::value).collect();
                let texture = texture.from_fields(&fields);
                AttributeValue::Textured(Textured { texture, a: plain(a), b: plain(b) })
            }
            Self::Uv(WrittenUv { scale, degrees, shift }) => AttributeValue::Uv(UvMap {
                scale: values(scale),
                degrees: degrees.value(),
                shift: values(shift),
            }),
            Self::Expressed(formula) => AttributeValue::Expressed(formula.expression()),
        }
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = &Number> {
        let (fields, numbers): (&[FieldNumber], [&[Number]; 3]) = match self {
            Self::Numbers(numbers) => (&[], [numbers, &[], &[]]),
            Self::Textured(WrittenTextured { fields, a, b, .. }) => (fields, [a, b, &[]]),
            Self::Uv(WrittenUv { scale, degrees, shift }) => {
                (&[], [scale, std::slice::from_ref(degrees), shift])
            }
            Self::Expressed(formula) => (&[], [&formula.numbers, &[], &[]]),
        };
        fields.iter().flat_map(FieldNumber::numbers).chain(numbers.into_iter().flatten())
    }

    pub(super) fn numbers_mut(&mut self) -> Vec<&mut Number> {
        match self {
            Self::Numbers(numbers) => numbers.iter_mut().collect(),
            Self::Textured(WrittenTextured { fields, a, b, .. }) => {
                let fields = fields.iter_mut().flat_map(FieldNumber::numbers_mut);
                fields.chain(a).chain(b).collect()
            }
            Self::Uv(WrittenUv { scale, degrees, shift }) => {
                scale.iter_mut().chain([degrees]).chain(shift).collect()
            }
            Self::Expressed(formula) => formula.numbers.iter_mut().collect(),
        }
    }
}
