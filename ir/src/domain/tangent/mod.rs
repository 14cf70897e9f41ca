//! Forward-mode differentiation as a meaning of the ops: every real carries its tangent along x, y and z.
//!
//! Running a function in this domain *emits* another function: the primal instructions, shared by
//! hash-consing with existing ones, and the tangents after them. A tangent is kept as a product,
//!
//! ```text
//! constant * factors * (bx, by, bz)
//! ```
//!
//! because along a chain of one variable (a squared distance, its falloff, a strength) only the scalar
//! factors change: the derivative of a falloff is computed once instead of three times. Zero components are
//! absent. Squares keep their 2 in the constant, so that the gradient of `|p - c|^2` is `2 * (dx, dy, dz)`
//! and costs nothing.
//!
//! A factor of 0 times a base that has overflowed is NaN, where the slope is 0. A *guarded* domain
//! ([`Tangent::guarded`]) emits the same products and sums, and keeps their operands and results finite
//! (`guard.rs`).

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::builder::FunctionBuilder;
use crate::entity::Value;
use crate::op::{Domain, Op};

mod algebra;
mod guard;
mod slope;

pub use guard::LARGEST_SLOPE;
pub use slope::{Factors, Slope, Vector};

use slope::Factor;

/// A real and its tangent.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Dual {
    /// The value, as it was.
    pub value: Value,
    /// Its tangent: the derivatives along x, y and z.
    pub slope: Slope,
}

/// The tangent domain, emitting into a builder. Masks and bits have no tangent.
#[derive(Debug)]
pub struct Tangent {
    /// Where the instructions go.
    pub builder: FunctionBuilder,
    /// Values that are known to be finite, if the domain is guarded.
    tame: Option<HashSet<Value>>,
    bases: Vec<Vector>,
    base_names: HashMap<Vector, usize>,
    lists: Vec<Vec<Factor>>,
    list_names: HashMap<Vec<Factor>, usize>,
}

impl Tangent {
    /// Emits into this builder.
    #[must_use]
    pub fn new(builder: FunctionBuilder) -> Self {
        Self {
            builder,
            tame: None,
            bases: Vec::new(),
            base_names: HashMap::default(),
            lists: vec![Vec::new()],
            list_names: HashMap::from_iter([(Vec::new(), 0)]),
        }
    }

    /// A value with zero tangent.
    #[must_use]
    pub const fn still(value: Value) -> Dual {
        Dual { value, slope: Slope::Zero }
    }

    /// A value with this tangent.
    pub fn with_tangent(&mut self, value: Value, tangent: Vector) -> Dual {
        Dual { value, slope: self.vector(1.0, Factors::default(), tangent) }
    }

    /// The slope of a product of two reals.
    fn product(&mut self, a: Dual, b: Dual) -> Slope {
        if a == b {
            let slope = self.scaled(a.slope, a.value);
            return Self::multiplied(slope, 2.0);
        }
        let (left, right) = (self.scaled(a.slope, b.value), self.scaled(b.slope, a.value));
        self.sum(left, right)
    }

    /// `1 / x`, or 0 where x is not positive: the guard of slopes that are infinite at 0.
    fn inverse_if_positive(&mut self, x: Value) -> Value {
        let (zero, one) = (self.builder.constant(0.0), self.builder.constant(1.0));
        let positive = self.builder.lt(zero, x);
        let inverse = self.builder.div(one, x);
        self.builder.select(positive, inverse, zero)
    }

    /// The dual of a unary function with this value and derivative.
    fn chain(&mut self, value: Value, a: Dual, derivative: impl FnOnce(&mut Self) -> Value) -> Dual {
        if a.slope == Slope::Zero {
            return Self::still(value);
        }
        // The value keeps the origin of its instruction; the ops below have the origin of a derivative.
        let derivative = self.derivative(derivative);
        let slope = self.derivative(|d| d.scaled(a.slope, derivative));
        Dual { value, slope }
    }

    /// Runs `emit` with the origin of a derivative.
    fn derivative<T>(&mut self, emit: impl FnOnce(&mut Self) -> T) -> T {
        let origin = self.builder.origin();
        self.builder.set_origin(origin.gradient());
        let result = emit(self);
        self.builder.set_origin(origin);
        result
    }

    /// A component of a tangent, as a value that has none. As in the gradient, adding +0 removes the sign of
    /// a zero, which may depend on rows that add nothing.
    fn slope_along(&mut self, a: Dual, axis: usize) -> Dual {
        let components = self.derivative(|d| d.components(a.slope));
        let zero = self.builder.constant(0.0);
        Self::still(components[axis].map_or(zero, |component| self.builder.add(component, zero)))
    }

    fn with_slope(&mut self, value: Value, slope: impl FnOnce(&mut Self) -> Slope) -> Dual {
        let slope = self.derivative(slope);
        Dual { value, slope }
    }
}

impl Domain for Tangent {
    type Real = Dual;
    type Mask = Value;
    type Bits = Value;

    fn constant(&mut self, value: f32) -> Dual {
        Self::still(self.builder.constant(value))
    }

    fn bits_constant(&mut self, value: u32) -> Value {
        self.builder.bits_constant(value)
    }

    fn add(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.add(a.value, b.value);
        self.with_slope(value, |d| d.sum(a.slope, b.slope))
    }

    fn sub(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.sub(a.value, b.value);
        self.with_slope(value, |d| d.sum(a.slope, Self::multiplied(b.slope, -1.0)))
    }

    fn mul(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.mul(a.value, b.value);
        self.with_slope(value, |d| d.product(a, b))
    }

    fn div(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.div(a.value, b.value);
        if a.slope == Slope::Zero && b.slope == Slope::Zero {
            return Self::still(value);
        }
        self.with_slope(value, |d| {
            let one = d.builder.constant(1.0);
            let inverse = d.builder.div(one, b.value);
            let left = d.scaled(a.slope, inverse);
            if b.slope == Slope::Zero {
                return left;
            }
            let factor = d.builder.mul(value, inverse);
            let right = d.scaled(b.slope, factor);
            d.sum(left, Self::multiplied(right, -1.0))
        })
    }

    fn fma(&mut self, a: Dual, b: Dual, c: Dual) -> Dual {
        let value = self.builder.fma(a.value, b.value, c.value);
        self.with_slope(value, |d| {
            let product = d.product(a, b);
            d.sum(product, c.slope)
        })
    }

    fn neg(&mut self, a: Dual) -> Dual {
        Dual { value: self.builder.neg(a.value), slope: Self::multiplied(a.slope, -1.0) }
    }

    fn abs(&mut self, a: Dual) -> Dual {
        let value = self.builder.abs(a.value);
        self.chain(value, a, |d| {
            let (zero, one, minus) =
                (d.builder.constant(0.0), d.builder.constant(1.0), d.builder.constant(-1.0));
            let negative = d.builder.lt(a.value, zero);
            d.builder.select(negative, minus, one)
        })
    }

    fn sqrt(&mut self, a: Dual) -> Dual {
        let value = self.builder.sqrt(a.value);
        self.chain(value, a, |d| {
            let half = d.builder.constant(0.5);
            let inverse = d.inverse_if_positive(value);
            d.builder.mul(half, inverse)
        })
    }

    fn min(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.min(a.value, b.value);
        if a.slope == b.slope {
            return Dual { value, slope: a.slope };
        }
        self.with_slope(value, |d| {
            let first = d.builder.lt(a.value, b.value);
            d.choice(first, a.slope, b.slope)
        })
    }

    fn max(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.max(a.value, b.value);
        if a.slope == b.slope {
            return Dual { value, slope: a.slope };
        }
        self.with_slope(value, |d| {
            let first = d.builder.lt(b.value, a.value);
            d.choice(first, a.slope, b.slope)
        })
    }

    fn lt(&mut self, a: Dual, b: Dual) -> Value {
        self.builder.lt(a.value, b.value)
    }

    fn le(&mut self, a: Dual, b: Dual) -> Value {
        self.builder.le(a.value, b.value)
    }

    fn eq(&mut self, a: Dual, b: Dual) -> Value {
        self.builder.eq(a.value, b.value)
    }

    fn both(&mut self, a: Value, b: Value) -> Value {
        self.builder.both(a, b)
    }

    fn either(&mut self, a: Value, b: Value) -> Value {
        self.builder.either(a, b)
    }

    fn not(&mut self, a: Value) -> Value {
        self.builder.not(a)
    }

    fn select(&mut self, condition: Value, a: Dual, b: Dual) -> Dual {
        let value = self.builder.select(condition, a.value, b.value);
        self.with_slope(value, |d| d.choice(condition, a.slope, b.slope))
    }

    fn to_bits(&mut self, a: Dual) -> Value {
        self.builder.to_bits(a.value)
    }

    /// Bits have no tangent, so neither has a real made of bits.
    fn from_bits(&mut self, a: Value) -> Dual {
        Self::still(self.builder.from_bits(a))
    }

    fn bit_and(&mut self, a: Value, b: Value) -> Value {
        self.builder.bit_and(a, b)
    }

    fn bit_or(&mut self, a: Value, b: Value) -> Value {
        self.builder.bit_or(a, b)
    }

    fn bit_xor(&mut self, a: Value, b: Value) -> Value {
        self.builder.bit_xor(a, b)
    }

    fn int_add(&mut self, a: Value, b: Value) -> Value {
        self.builder.int_add(a, b)
    }

    fn int_sub(&mut self, a: Value, b: Value) -> Value {
        self.builder.int_sub(a, b)
    }

    fn shl(&mut self, a: Value, by: Value) -> Value {
        self.builder.shl(a, by)
    }

    fn shr(&mut self, a: Value, by: Value) -> Value {
        self.builder.shr(a, by)
    }

    fn sin(&mut self, a: Dual) -> Dual {
        let value = self.builder.sin(a.value);
        self.chain(value, a, |d| d.builder.cos(a.value))
    }

    fn cos(&mut self, a: Dual) -> Dual {
        let value = self.builder.cos(a.value);
        self.chain(value, a, |d| {
            let sin = d.builder.sin(a.value);
            d.builder.neg(sin)
        })
    }

    fn exp(&mut self, a: Dual) -> Dual {
        let value = self.builder.exp(a.value);
        self.chain(value, a, |_| value)
    }

    fn ln(&mut self, a: Dual) -> Dual {
        let value = self.builder.ln(a.value);
        self.chain(value, a, |d| {
            let one = d.builder.constant(1.0);
            d.builder.div(one, a.value)
        })
    }

    /// `b a^(b-1) da + a^b ln(a) db`, both 0 where a is not positive: one-sided there, and never NaN.
    fn pow(&mut self, a: Dual, b: Dual) -> Dual {
        let value = self.builder.pow(a.value, b.value);
        self.with_slope(value, |d| {
            let mut slope = Slope::Zero;
            if a.slope != Slope::Zero {
                // The quotient, not a product with 1/a: the power may be 0 where 1/a is infinite.
                let (zero, quotient) = (d.builder.constant(0.0), d.builder.div(value, a.value));
                let positive = d.builder.lt(zero, a.value);
                let ratio = d.builder.select(positive, quotient, zero);
                let derivative = d.builder.mul(b.value, ratio);
                let derivative = d.power_slope(derivative, [a.value, b.value, value], positive);
                slope = d.scaled(a.slope, derivative);
            }
            if b.slope != Slope::Zero {
                let zero = d.builder.constant(0.0);
                let positive = d.builder.lt(zero, a.value);
                let logarithm = d.builder.ln(a.value);
                let derivative = d.builder.mul(value, logarithm);
                let derivative = d.builder.select(positive, derivative, zero);
                let right = d.scaled(b.slope, derivative);
                slope = d.sum(slope, right);
            }
            slope
        })
    }

    fn slope_x(&mut self, a: Dual) -> Dual {
        self.slope_along(a, 0)
    }

    fn slope_y(&mut self, a: Dual) -> Dual {
        self.slope_along(a, 1)
    }

    fn slope_z(&mut self, a: Dual) -> Dual {
        self.slope_along(a, 2)
    }

    fn stop_gradient(&mut self, a: Dual) -> Dual {
        Self::still(self.builder.op(Op::StopGradient, &[a.value]))
    }

    /// The same value, with its slope.
    fn low_end(&mut self, a: Dual) -> Dual {
        a
    }
}
