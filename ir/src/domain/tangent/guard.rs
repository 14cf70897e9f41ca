//! Guarded tangents: whatever overflows on the way, a slope is a finite number.
//!
//! ```text
//! factors of a product      NaN counts as 0, infinities as the largest numbers of their sign
//! products and sums         of finite numbers are no NaN; infinities count as the largest numbers
//! ```
//!
//! So 0 times anything is 0. Outside of a support, and where a bound limits a field, the slope is exactly 0,
//! however far squares have overflowed. Where nothing overflows, every op gives the same bits as without
//! guards: the ops are the same, in the same order.

use rustc_hash::FxHashSet as HashSet;

use super::Tangent;
use crate::builder::FunctionBuilder;
use crate::entity::Value;
use crate::op::Domain;

/// The largest magnitude of a component of a gradient, 2^100: beyond it gradients saturate.
pub const LARGEST_SLOPE: f32 = (1u128 << 100) as f32;

impl Tangent {
    /// As [`new`](Self::new), but all slopes are finite.
    #[must_use]
    pub fn guarded(builder: FunctionBuilder) -> Self {
        Self { tame: Some(HashSet::default()), ..Self::new(builder) }
    }

    /// The value; if the domain is guarded, as a finite number: 0 for NaN, the largest of its sign for an
    /// infinity.
    pub(super) fn tame(&mut self, value: Value) -> Value {
        if !self.is_wild(value) {
            return value;
        }
        if let Some(number) = self.builder.as_constant(value) {
            let number = if number.is_nan() { 0.0 } else { number.clamp(f32::MIN, f32::MAX) };
            return self.builder.constant(number);
        }
        let held = self.hold_within(value, f32::MAX);
        let (is_number, zero) = (self.builder.eq(value, value), self.builder.constant(0.0));
        let tame = self.builder.select(is_number, held, zero);
        self.note(tame)
    }

    /// The result of an op on finite numbers, as a number that is not NaN.
    pub(super) fn tame_result(&mut self, value: Value) -> Value {
        if !self.is_wild(value) {
            return value;
        }
        let held = self.hold_within(value, f32::MAX);
        self.note(held)
    }

    /// A component of a gradient, within [`LARGEST_SLOPE`] if the domain is guarded.
    pub(crate) fn saturated(&mut self, component: Value) -> Value {
        if self.tame.is_none() {
            return component;
        }
        let component = self.tame(component);
        self.hold_within(component, LARGEST_SLOPE)
    }

    /// Whether a value may be NaN or infinite, in a guarded domain. Without guards always false.
    fn is_wild(&self, value: Value) -> bool {
        let Some(tame) = &self.tame else { return false };
        self.builder.as_constant(value).map_or_else(|| !tame.contains(&value), |number| !number.is_finite())
    }

    /// Remembers that a value is finite.
    pub(crate) fn note(&mut self, value: Value) -> Value {
        if let Some(tame) = &mut self.tame {
            tame.insert(value);
        }
        value
    }

    /// The nearest number within a magnitude.
    fn hold_within(&mut self, value: Value, magnitude: f32) -> Value {
        let (largest, smallest) = (self.builder.constant(magnitude), self.builder.constant(-magnitude));
        let held = self.builder.min(value, largest);
        self.builder.max(held, smallest)
    }

    /// The derivative `b a^(b-1)` of a power along its base, given as `slope` = `b * (a^b / a)`. In a guarded
    /// domain, `(b a^b) / a` where the quotient `a^b / a` has overflowed, as it does for subnormal bases.
    pub(super) fn power_slope(&mut self, slope: Value, [a, b, value]: [Value; 3], positive: Value) -> Value {
        if self.tame.is_none() {
            return slope;
        }
        let d = &mut self.builder;
        let (product, zero, largest) = (d.mul(b, value), d.constant(0.0), d.constant(f32::MAX));
        let quotient = d.div(product, a);
        let other = d.select(positive, quotient, zero);
        let size = d.abs(slope);
        let is_finite = d.le(size, largest);
        d.select(is_finite, slope, other)
    }
}
