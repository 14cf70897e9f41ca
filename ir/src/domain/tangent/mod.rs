//! Forward-mode differentiation as a meaning of the ops: every real carries its tangent along x, y and z.
//!
//! Running a function in this domain *emits* another function: the primal instructions, shared by hash-consing with whatever is
//! there already, and the tangents after them. A tangent is kept as a product,
//!
//! ```text
//! constant * factor * (bx, by, bz)
//! ```
//!
//! because along a chain of one variable (a squared distance, its falloff, a strength) only the scalar factor changes: the
//! derivative of a falloff is computed once and not three times. Components that are zero are not there at all, and squares keep
//! their 2 in the constant, so that the gradient of `|p - c|^2` is `2 * (dx, dy, dz)` and costs nothing.

use rustc_hash::FxHashMap as HashMap;

use crate::builder::FunctionBuilder;
use crate::entity::Value;
use crate::op::{Domain, Op};

/// Three components; `None` is an exact zero.
pub type Vector = [Option<Value>; 3];

/// The tangent of a real.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Slope {
    /// It does not move.
    Zero,
    /// `constant * factor * base`; no factor means 1.
    Scaled {
        /// A number that is known while compiling.
        constant: f32,
        /// A number for each lane.
        factor: Option<Value>,
        /// The name of a base vector of the domain.
        base: usize,
    },
}

/// A real and its tangent.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Dual {
    /// The value, as it was.
    pub value: Value,
    /// How it moves with x, y and z.
    pub slope: Slope,
}

/// The tangent domain, emitting into a builder. Masks and bits do not move.
pub struct Tangent {
    /// Where the instructions go.
    pub builder: FunctionBuilder,
    bases: Vec<Vector>,
    names: HashMap<Vector, usize>,
}

impl Tangent {
    /// Emits into this builder.
    #[must_use]
    pub fn new(builder: FunctionBuilder) -> Self {
        Self { builder, bases: Vec::new(), names: HashMap::default() }
    }

    /// A value that does not move.
    #[must_use]
    pub const fn still(value: Value) -> Dual {
        Dual { value, slope: Slope::Zero }
    }

    /// A value with this tangent.
    pub fn moving(&mut self, value: Value, tangent: Vector) -> Dual {
        Dual { value, slope: self.vector(1.0, None, tangent) }
    }

    /// The tangent as three values.
    pub fn components(&mut self, slope: Slope) -> Vector {
        let Slope::Scaled { constant, factor, base } = slope else { return [None; 3] };
        let scale = self.scale(constant, factor);
        let base = self.bases[base];
        base.map(|component| component.map(|value| self.times(scale, value)))
    }

    /// `constant * factor * vector` as a slope.
    fn vector(&mut self, constant: f32, factor: Option<Value>, vector: Vector) -> Slope {
        if vector == [None; 3] || constant == 0.0 {
            return Slope::Zero;
        }
        let next = self.bases.len();
        let base = *self.names.entry(vector).or_insert(next);
        if base == next {
            self.bases.push(vector);
        }
        Slope::Scaled { constant, factor, base }
    }

    /// `constant * factor` as one value.
    fn scale(&mut self, constant: f32, factor: Option<Value>) -> Value {
        let number = self.builder.constant(constant);
        factor.map_or(number, |factor| self.times(number, factor))
    }

    /// `a * b`, where 1 is not multiplied.
    fn times(&mut self, a: Value, b: Value) -> Value {
        if self.builder.as_constant(a) == Some(1.0) {
            b
        } else if self.builder.as_constant(b) == Some(1.0) {
            a
        } else {
            self.builder.mul(a, b)
        }
    }

    /// `by * slope`.
    fn scaled(&mut self, slope: Slope, by: Value) -> Slope {
        let Slope::Scaled { constant, factor, base } = slope else { return Slope::Zero };
        if let Some(number) = self.builder.as_constant(by) {
            return Self::multiplied(slope, number);
        }
        let factor = factor.map_or(by, |factor| self.times(factor, by));
        Slope::Scaled { constant, factor: Some(factor), base }
    }

    /// `by * slope`, for a number.
    fn multiplied(slope: Slope, by: f32) -> Slope {
        match slope {
            Slope::Zero => Slope::Zero,
            Slope::Scaled { .. } if by == 0.0 => Slope::Zero,
            Slope::Scaled { constant, factor, base } => {
                Slope::Scaled { constant: constant * by, factor, base }
            }
        }
    }

    /// `a + b`.
    fn sum(&mut self, a: Slope, b: Slope) -> Slope {
        let (
            Slope::Scaled { constant: ca, factor: fa, base: ba },
            Slope::Scaled { constant: cb, factor: fb, base: bb },
        ) = (a, b)
        else {
            return if a == Slope::Zero { b } else { a };
        };
        if ba == bb {
            return self.sum_of_factors((ca, fa), (cb, fb), ba);
        }
        // One constant for both leaves the factors to the components, where one fused step each adds them.
        let common = if ca.abs() == cb.abs() { ca } else { 1.0 };
        if common == 1.0 && fa == fb && ca == cb {
            let vector = self.sum_of_vectors(None, ba, None, bb);
            return self.vector(1.0, fa, vector);
        }
        let fa = (ca / common != 1.0 || fa.is_some()).then(|| self.scale(ca / common, fa));
        let fb = (cb / common != 1.0 || fb.is_some()).then(|| self.scale(cb / common, fb));
        let vector = self.sum_of_vectors(fa, ba, fb, bb);
        self.vector(common, None, vector)
    }

    /// `(ca fa + cb fb) * base`.
    fn sum_of_factors(&mut self, a: (f32, Option<Value>), b: (f32, Option<Value>), base: usize) -> Slope {
        if a.1 == b.1 {
            let constant = a.0 + b.0;
            return if constant == 0.0 { Slope::Zero } else { Slope::Scaled { constant, factor: a.1, base } };
        }
        // The first constant is taken out of the sum: ca (fa + (cb / ca) fb).
        let one = self.builder.constant(1.0);
        let first = a.1.unwrap_or(one);
        let second = b.1.unwrap_or(one);
        let ratio = b.0 / a.0;
        let sum = if ratio == 1.0 {
            self.builder.add(first, second)
        } else {
            let ratio = self.builder.constant(ratio);
            self.builder.fma(ratio, second, first)
        };
        Slope::Scaled { constant: a.0, factor: Some(sum), base }
    }

    /// `fa * a + fb * b` by components; no factor means 1.
    fn sum_of_vectors(&mut self, fa: Option<Value>, a: usize, fb: Option<Value>, b: usize) -> Vector {
        let (a, b) = (self.bases[a], self.bases[b]);
        std::array::from_fn(|axis| match (a[axis], b[axis]) {
            (None, None) => None,
            (Some(a), None) => Some(fa.map_or(a, |f| self.times(f, a))),
            (None, Some(b)) => Some(fb.map_or(b, |f| self.times(f, b))),
            (Some(a), Some(b)) => Some(match (fa, fb) {
                (None, None) => self.builder.add(a, b),
                (Some(fa), None) => self.multiply_add(fa, a, b),
                (None, Some(fb)) => self.multiply_add(fb, b, a),
                (Some(fa), Some(fb)) => {
                    let product = self.times(fa, a);
                    self.multiply_add(fb, b, product)
                }
            }),
        })
    }

    fn multiply_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        if self.builder.as_constant(a) == Some(1.0) {
            self.builder.add(b, c)
        } else if self.builder.as_constant(b) == Some(1.0) {
            self.builder.add(a, c)
        } else {
            self.builder.fma(a, b, c)
        }
    }

    /// The slope of `condition ? a : b`.
    fn choice(&mut self, condition: Value, a: Slope, b: Slope) -> Slope {
        if a == b {
            return a;
        }
        let zero = self.builder.constant(0.0);
        match (a, b) {
            (Slope::Zero, Slope::Zero) => Slope::Zero,
            (Slope::Scaled { constant, factor, base }, Slope::Zero) => {
                let factor = factor.unwrap_or_else(|| self.builder.constant(1.0));
                let factor = self.builder.select(condition, factor, zero);
                Slope::Scaled { constant, factor: Some(factor), base }
            }
            (Slope::Zero, Slope::Scaled { constant, factor, base }) => {
                let factor = factor.unwrap_or_else(|| self.builder.constant(1.0));
                let factor = self.builder.select(condition, zero, factor);
                Slope::Scaled { constant, factor: Some(factor), base }
            }
            (
                Slope::Scaled { constant: ca, factor: fa, base: ba },
                Slope::Scaled { constant: cb, factor: fb, base: bb },
            ) => {
                if ba == bb {
                    let (a, b) = (self.scale(ca, fa), self.scale(cb, fb));
                    let factor = self.builder.select(condition, a, b);
                    return Slope::Scaled { constant: 1.0, factor: Some(factor), base: ba };
                }
                let (a, b) = (self.components(a), self.components(b));
                let vector = std::array::from_fn(|axis| match (a[axis], b[axis]) {
                    (None, None) => None,
                    (a, b) => Some(self.builder.select(condition, a.unwrap_or(zero), b.unwrap_or(zero))),
                });
                self.vector(1.0, None, vector)
            }
        }
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
        // The value keeps the origin of its instruction; what follows is a derivative.
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

    /// Bits do not move, so neither does what is made of them.
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

    fn hold(&mut self, a: Dual) -> Dual {
        Self::still(self.builder.op(Op::Hold, &[a.value]))
    }
}
