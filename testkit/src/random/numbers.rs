//! Random numbers, and values of parameters by their descriptions: ordinary or hostile ones.

use fastrand::Rng;
use jbt_model::field::{Field, FieldKind, FieldValue};

use super::{Numbers, Random};

/// Three numbers within `size` of 0.
pub fn vector(rng: &mut Rng, size: f64) -> [f64; 3] {
    std::array::from_fn(|_| size * (2.0 * rng.f64() - 1.0))
}

/// A finite number: often a simple one, sometimes any bits.
fn hostile(rng: &mut Rng) -> f64 {
    match rng.u8(..6) {
        0 => 0.0,
        1 => -0.0,
        2 => f64::from(rng.i32(-9..10)),
        3 => rng.f64() - 0.5,
        4 => [1.0, 1e15, -1e-15, f64::MIN_POSITIVE, 5e-324, f64::MAX, 0.1][rng.usize(..7)],
        _ => Some(f64::from_bits(rng.u64(..))).filter(|x| x.is_finite()).unwrap_or(0.5),
    }
}

impl Random {
    /// Whether numbers are hostile.
    pub(super) fn is_hostile(&self) -> bool {
        match self.settings.numbers {
            Numbers::Ordinary => false,
            Numbers::Hostile => true,
        }
    }

    /// An ordinary number from `low` to `high`. One of three hostile numbers is ordinary as well, so that not
    /// everything about a model is broken; the sign of the others is kept only where all ordinary ones are
    /// positive.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        if self.is_hostile() && self.numbers.u8(..3) > 0 {
            let number = hostile(&mut self.numbers);
            return if low < 0.0 { number } else { number.abs() };
        }
        low + (high - low) * self.numbers.f64()
    }

    /// Three numbers within `size` of 0.
    pub fn vector(&mut self, size: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-size, size))
    }

    /// So many numbers from 0 to 1.
    pub(super) fn units(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.between(0.0, 1.0)).collect()
    }

    /// Values that the parameters of a member may have.
    pub fn fields(&mut self, fields: &[Field]) -> Vec<FieldValue> {
        fields.iter().map(|field| self.field(field)).collect()
    }

    fn field(&mut self, field: &Field) -> FieldValue {
        if let Some(default) = &field.default
            && self.is_hostile()
            && self.numbers.u8(..4) == 0
        {
            return default.clone();
        }
        match field.kind {
            FieldKind::Real => FieldValue::Real(self.between(-1.5, 1.5)),
            FieldKind::Positive | FieldKind::NonNegative => FieldValue::Real(self.between(0.1, 1.0)),
            // Whole numbers may be code.
            FieldKind::Within { least, most } if most > 2.0 && self.shape.bool() => {
                let (least, most) = (least.ceil() as u32, most.min(8.0) as u32);
                FieldValue::Real(f64::from(self.shape.u32(least.max(1)..=most)))
            }
            FieldKind::Within { least, most } => {
                FieldValue::Real(self.between(least, most.min(8.0)).clamp(least, most))
            }
            FieldKind::Whole { least, most } => FieldValue::Real(f64::from(self.shape.u32(least..=most))),
            FieldKind::Choice(words) => FieldValue::Real(self.shape.usize(0..words.len()) as f64),
            FieldKind::Count if self.is_hostile() => FieldValue::Real(self.between(0.0, 9.0)),
            // 0 where that is the default.
            FieldKind::Count if field.default.is_some() => FieldValue::Real(self.numbers.u8(0..6).into()),
            FieldKind::Count => FieldValue::Real(self.numbers.u8(1..6).into()),
            FieldKind::Position | FieldKind::Direction => FieldValue::Vector(self.vector(1.0)),
            FieldKind::Degrees => FieldValue::Real(self.between(0.0, 360.0)),
            FieldKind::Stretches => FieldValue::Vector(self.vector(1.0).map(|x| 0.3 + x.abs())),
            FieldKind::Extents => FieldValue::Vector(self.vector(1.0).map(f64::abs)),
            FieldKind::Positions => {
                // As many as a chain of curves has. How many there are is a number as any other.
                let count = 1 + 3 * self.numbers.usize(1..4);
                let count = if self.is_hostile() { self.numbers.usize(..8) } else { count };
                FieldValue::Vectors((0..count).map(|_| self.vector(1.0)).collect())
            }
            FieldKind::Lengths => {
                let count = if self.is_hostile() { self.numbers.usize(..8) } else { 10 };
                FieldValue::Reals((0..count).map(|_| self.between(0.0, 0.3)).collect())
            }
            FieldKind::Flag => FieldValue::Real(f64::from(self.numbers.u8(0..2))),
            FieldKind::Rows => FieldValue::Reals((0..12).map(|_| self.between(-1.5, 1.5)).collect()),
            FieldKind::Axis => {
                let axis = self.shape.usize(0..3);
                FieldValue::Vector(std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 }))
            }
        }
    }
}
