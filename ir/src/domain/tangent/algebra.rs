//! The arithmetic of tangents: sums and multiples of `constant * factors * base vector`.
//!
//! The factors stay a list until somebody needs a number, for three reasons:
//!
//! * The common factors of two tangents along one base are taken out of their sum: the derivative of
//!   `u^2 (4u + 5)` becomes `u` times a fused step instead of two products.
//! * Constants and columns are multiplied with each other first: once for a row instead of once for each
//!   point.
//! * A condition, from `max` or `select`, is a factor too. It is dropped where another factor is zero
//!   wherever the condition does not hold: `max(t, 0)` is zero outside of `0 < t`.

use crate::entity::Value;
use crate::function::InstKind;
use crate::op::{Domain, Op};

use super::Tangent;
use super::slope::{Factor, Factors, Slope, Vector};

/// More factors than this are multiplied, so that a long chain of products does not become a long list.
const MAX_FACTORS: usize = 8;
/// Powers are taken apart up to this one.
const MAX_POWER: usize = 4;

/// Lists.
impl Tangent {
    fn list(&self, factors: Factors) -> &[Factor] {
        &self.lists[factors.0]
    }

    /// The name of a list, whatever its order.
    fn name(&mut self, mut list: Vec<Factor>) -> Factors {
        list.sort_unstable();
        let next = self.lists.len();
        let name = *self.list_names.entry(list.clone()).or_insert(next);
        if name == next {
            self.lists.push(list);
        }
        Factors(name)
    }

    /// The list with one more factor.
    fn with(&mut self, factors: Factors, factor: Factor) -> Factors {
        let mut list = self.list(factors).to_vec();
        match factor {
            Factor::Value(value) => {
                list.push(factor);
                list.retain(|other| !matches!(other, Factor::Where(mask) if self.vanishes(value, *mask)));
            }
            Factor::Where(mask) => {
                let idle =
                    list.iter().any(|other| matches!(other, Factor::Value(v) if self.vanishes(*v, mask)));
                if !idle && !list.contains(&factor) {
                    list.push(factor);
                }
            }
            Factor::Unless(_) => {
                if !list.contains(&factor) {
                    list.push(factor);
                }
            }
        }
        if list.len() > MAX_FACTORS {
            let product = self.product_of(1.0, &list);
            list = vec![Factor::Value(product)];
        }
        self.name(list)
    }

    /// Whether `value` is 0 wherever `mask` does not hold: it is `max(t, 0)`, and the mask is `0 < t`.
    fn vanishes(&self, value: Value, mask: Value) -> bool {
        let Some(InstKind::Op { op: Op::Max, args: max }) = self.builder.definition(value) else {
            return false;
        };
        let Some(InstKind::Op { op: Op::Lt, args: lt }) = self.builder.definition(mask) else { return false };
        self.builder.as_constant(max[1]) == Some(0.0) && lt[..] == [max[1], max[0]]
    }

    /// `a` and `n` if the value is `a^n`, made by `n - 1` products with `a`; else the value itself and 1.
    fn power(&self, value: Value) -> (Value, usize) {
        let mut product = value;
        for exponent in 2..=MAX_POWER {
            let Some([a, b]) = self.operands_of_product(product) else { break };
            if a == b {
                return (a, exponent);
            }
            if self.operands_of_product(a).is_none_or(|inner| !inner.contains(&b)) {
                break;
            }
            product = a;
        }
        (value, 1)
    }

    fn operands_of_product(&self, value: Value) -> Option<[Value; 2]> {
        let Some(InstKind::Op { op: Op::Mul, args }) = self.builder.definition(value) else { return None };
        Some([args[0], args[1]])
    }

    /// `constant * product of list` as one value. Factors that are the same for all points of a row are
    /// multiplied first, conditions last.
    fn product_of(&mut self, constant: f32, list: &[Factor]) -> Value {
        let one = self.builder.constant(1.0);
        let (mut row, mut lanes) = (self.builder.constant(constant), one);
        let mut left = list;
        while let Some(&factor) = left.first() {
            // Equal factors are neighbours. As a rule the function already computes their power.
            let count = left.iter().take_while(|&&other| other == factor).count();
            left = &left[count..];
            let Factor::Value(value) = factor else { continue };
            let value = self.tame(value);
            let power = (1..count).fold(value, |power, _| {
                let product = self.builder.mul(power, value);
                self.tame_result(product)
            });
            if self.builder.is_uniform(value) {
                row = self.times(row, power);
            } else {
                lanes = self.times(lanes, power);
            }
        }
        let mut product = self.times(row, lanes);
        let zero = self.builder.constant(0.0);
        for &factor in list {
            product = match factor {
                Factor::Value(_) => continue,
                Factor::Where(mask) => self.builder.select(mask, product, zero),
                Factor::Unless(mask) => self.builder.select(mask, zero, product),
            };
            self.note(product);
        }
        product
    }

    /// What two lists share, and what is left of each.
    fn common(&self, a: Factors, b: Factors) -> [Vec<Factor>; 3] {
        let (mut shared, mut left, mut right) = (Vec::new(), Vec::new(), self.list(b).to_vec());
        for &factor in self.list(a) {
            match right.iter().position(|&other| other == factor) {
                Some(found) => shared.push(right.remove(found)),
                None => left.push(factor),
            }
        }
        [shared, left, right]
    }
}

/// Sums and multiples.
impl Tangent {
    /// The tangent as three values.
    pub fn components(&mut self, slope: Slope) -> Vector {
        let Slope::Scaled { constant, factors, base } = slope else { return [None; 3] };
        let scale = self.scale(constant, factors);
        let base = self.bases[base];
        base.map(|component| {
            let value = component?;
            let product = self.times(scale, value);
            Some(self.tame(product))
        })
    }

    /// `constant * factors * vector` as a slope.
    pub(super) fn vector(&mut self, constant: f32, factors: Factors, vector: Vector) -> Slope {
        if vector == [None; 3] || constant == 0.0 {
            return Slope::Zero;
        }
        let next = self.bases.len();
        let base = *self.base_names.entry(vector).or_insert(next);
        if base == next {
            self.bases.push(vector);
        }
        Slope::Scaled { constant, factors, base }
    }

    /// `constant * factors` as one value.
    fn scale(&mut self, constant: f32, factors: Factors) -> Value {
        let list = self.list(factors).to_vec();
        self.product_of(constant, &list)
    }

    /// `a * b`, where 1 is not multiplied.
    pub(super) fn times(&mut self, a: Value, b: Value) -> Value {
        let [a, b] = [a, b].map(|value| self.tame(value));
        if self.builder.as_constant(a) == Some(1.0) {
            b
        } else if self.builder.as_constant(b) == Some(1.0) {
            a
        } else {
            let product = self.builder.mul(a, b);
            self.tame_result(product)
        }
    }

    /// `by * slope`.
    pub(super) fn scaled(&mut self, slope: Slope, by: Value) -> Slope {
        let Slope::Scaled { constant, mut factors, base } = slope else { return Slope::Zero };
        if let Some(number) = self.builder.as_constant(by) {
            return Self::multiplied(slope, number);
        }
        let (value, exponent) = self.power(by);
        for _ in 0..exponent {
            factors = self.with(factors, Factor::Value(value));
        }
        Slope::Scaled { constant, factors, base }
    }

    /// `by * slope`, for a number.
    pub(super) fn multiplied(slope: Slope, by: f32) -> Slope {
        match slope {
            Slope::Zero => Slope::Zero,
            Slope::Scaled { .. } if by == 0.0 => Slope::Zero,
            Slope::Scaled { constant, factors, base } => {
                Slope::Scaled { constant: constant * by, factors, base }
            }
        }
    }

    /// `a + b`.
    pub(super) fn sum(&mut self, a: Slope, b: Slope) -> Slope {
        let (
            Slope::Scaled { constant: ca, factors: fa, base: ba },
            Slope::Scaled { constant: cb, factors: fb, base: bb },
        ) = (a, b)
        else {
            return if a == Slope::Zero { b } else { a };
        };
        if ba == bb {
            return self.sum_along((ca, fa), (cb, fb), ba);
        }
        if fa == fb && ca == cb {
            let vector = self.sum_of_vectors(None, ba, None, bb);
            return self.vector(ca, fa, vector);
        }
        // With one constant for both, the components add the factors, with one fused step each.
        let common = if ca.abs() == cb.abs() { ca } else { 1.0 };
        let mut factor = |constant: f32, factors: Factors| {
            (constant != 1.0 || factors != Factors::default()).then(|| self.scale(constant, factors))
        };
        let (fa, fb) = (factor(ca / common, fa), factor(cb / common, fb));
        let vector = self.sum_of_vectors(fa, ba, fb, bb);
        self.vector(common, Factors::default(), vector)
    }

    /// `(ca fa + cb fb) * base`.
    fn sum_along(&mut self, (ca, fa): (f32, Factors), (cb, fb): (f32, Factors), base: usize) -> Slope {
        if fa == fb {
            let constant = ca + cb;
            return if constant == 0.0 { Slope::Zero } else { Slope::Scaled { constant, factors: fa, base } };
        }
        // The first constant is taken out of the sum as well: ca (fa + (cb / ca) fb).
        let [shared, left, right] = self.common(fa, fb);
        let (first, second) = (self.product_of(1.0, &left), self.product_of(1.0, &right));
        let ratio = cb / ca;
        let sum = if ratio == 1.0 {
            self.plus(first, second)
        } else {
            let ratio = self.builder.constant(ratio);
            self.multiply_add(ratio, second, first)
        };
        let shared = self.name(shared);
        let factors = self.with(shared, Factor::Value(sum));
        Slope::Scaled { constant: ca, factors, base }
    }

    /// `fa * a + fb * b` by components; no factor means 1.
    fn sum_of_vectors(&mut self, fa: Option<Value>, a: usize, fb: Option<Value>, b: usize) -> Vector {
        let (a, b) = (self.bases[a], self.bases[b]);
        std::array::from_fn(|axis| match (a[axis], b[axis]) {
            (None, None) => None,
            (Some(a), None) => Some(fa.map_or(a, |f| self.times(f, a))),
            (None, Some(b)) => Some(fb.map_or(b, |f| self.times(f, b))),
            (Some(a), Some(b)) => Some(match (fa, fb) {
                (None, None) => self.plus(a, b),
                (Some(fa), None) => self.multiply_add(fa, a, b),
                (None, Some(fb)) => self.multiply_add(fb, b, a),
                (Some(fa), Some(fb)) => {
                    let product = self.times(fa, a);
                    self.multiply_add(fb, b, product)
                }
            }),
        })
    }

    /// `a + b`.
    fn plus(&mut self, a: Value, b: Value) -> Value {
        let [a, b] = [a, b].map(|value| self.tame(value));
        let sum = self.builder.add(a, b);
        self.tame_result(sum)
    }

    /// `a * b + c`, where 1 is not multiplied.
    fn multiply_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        if self.builder.as_constant(a) == Some(1.0) {
            return self.plus(b, c);
        }
        if self.builder.as_constant(b) == Some(1.0) {
            return self.plus(a, c);
        }
        let [a, b, c] = [a, b, c].map(|value| self.tame(value));
        let sum = self.builder.fma(a, b, c);
        self.tame_result(sum)
    }

    /// The slope of `condition ? a : b`.
    pub(super) fn choice(&mut self, condition: Value, a: Slope, b: Slope) -> Slope {
        if a == b {
            return a;
        }
        match (a, b) {
            (Slope::Zero, Slope::Zero) => Slope::Zero,
            (Slope::Scaled { constant, factors, base }, Slope::Zero) => {
                let factors = self.with(factors, Factor::Where(condition));
                Slope::Scaled { constant, factors, base }
            }
            (Slope::Zero, Slope::Scaled { constant, factors, base }) => {
                let factors = self.with(factors, Factor::Unless(condition));
                Slope::Scaled { constant, factors, base }
            }
            (
                Slope::Scaled { constant: ca, factors: fa, base: ba },
                Slope::Scaled { constant: cb, factors: fb, base: bb },
            ) if ba == bb => {
                let [shared, left, right] = self.common(fa, fb);
                let (a, b) = (self.product_of(ca, &left), self.product_of(cb, &right));
                let chosen = self.builder.select(condition, a, b);
                self.note(chosen);
                let shared = self.name(shared);
                let factors = self.with(shared, Factor::Value(chosen));
                Slope::Scaled { constant: 1.0, factors, base: ba }
            }
            (Slope::Scaled { .. }, Slope::Scaled { .. }) => {
                let (a, b) = (self.components(a), self.components(b));
                let zero = self.builder.constant(0.0);
                let vector = std::array::from_fn(|axis| match (a[axis], b[axis]) {
                    (None, None) => None,
                    (a, b) => {
                        let chosen = self.builder.select(condition, a.unwrap_or(zero), b.unwrap_or(zero));
                        Some(self.note(chosen))
                    }
                });
                self.vector(1.0, Factors::default(), vector)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::function::{FoldKind, Function, Rule, Schema};

    /// The ops of a function, in order.
    fn ops(function: &Function) -> Vec<Op> {
        let insts = function.insts.values();
        insts
            .filter_map(|inst| if let InstKind::Op { op, .. } = inst.kind { Some(op) } else { None })
            .collect()
    }

    /// `d/dx` of what `f` makes of x and a column, as a function.
    fn derivative(
        f: impl FnOnce(&mut Tangent, super::super::Dual, super::super::Dual) -> super::super::Dual,
    ) -> Function {
        let mut builder = crate::builder::FunctionBuilder::new("f", &["x"]);
        let schema = Schema { name: "t".into(), columns: vec!["c".into()], parent: None, slots: Vec::new() };
        let table = builder.table(schema);
        let x = builder.input(0);
        let zero = builder.constant(0.0);
        let sum = builder.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
        let column = builder.column(table, 0);
        let mut tangent = Tangent::new(builder);
        let one = tangent.builder.constant(1.0);
        let x = tangent.with_tangent(x, [Some(one), None, None]);
        let y = f(&mut tangent, x, Tangent::still(column));
        let [dx, ..] = tangent.components(y.slope);
        let next = tangent.builder.add(sum, dx.expect("y moves"));
        let out = tangent.builder.end_fold(&[next])[0];
        tangent.builder.finish(&[("dx".to_owned(), out)])
    }

    #[test]
    fn a_condition_that_a_factor_knows_is_not_asked() {
        let square_of_positive = derivative(|d, x, c| {
            let t = d.mul(x, c);
            let zero = d.constant(0.0);
            let u = d.max(t, zero);
            d.mul(u, u)
        });
        assert!(!ops(&square_of_positive).contains(&Op::Select), "{square_of_positive}");

        let positive = derivative(|d, x, c| {
            let t = d.mul(x, c);
            let zero = d.constant(0.0);
            d.max(t, zero)
        });
        assert!(ops(&positive).contains(&Op::Select), "max alone has a jump in its slope: {positive}");
    }

    #[test]
    fn common_factors_leave_a_sum() {
        // u^2 (4u + 5): the primal takes 3 ops, its derivative 2u (4u + 5 + 2u) a fused step, a product and
        // the doubling of the column.
        let f = derivative(|d, x, c| {
            let u = d.mul(x, c);
            let (four, five) = (d.constant(4.0), d.constant(5.0));
            let slope = d.fma(four, u, five);
            let square = d.mul(u, u);
            d.mul(square, slope)
        });
        let (mul, fma) = (Op::Mul, Op::Fma);
        assert_eq!(ops(&f), [mul, fma, mul, mul, fma, mul, mul, mul, Op::Add], "{f}");
    }

    #[test]
    fn powers_are_taken_apart_and_found_again() {
        let f = derivative(|d, x, c| {
            let u = d.mul(x, c);
            let square = d.mul(u, u);
            d.mul(square, u)
        });
        // u c, u^2, u^3, 3c, 3c u^2, and the sum of the fold.
        assert_eq!(ops(&f).len(), 6, "{f}");
    }

    #[test]
    fn long_products_stay_short_lists() {
        let f = derivative(|d, x, c| {
            let mut product = x;
            for shift in 0..100 {
                let shift = d.constant(shift as f32);
                let next = d.add(c, shift);
                product = d.mul(product, next);
            }
            assert!(d.lists.iter().all(|list| list.len() <= MAX_FACTORS));
            product
        });
        assert!(ops(&f).contains(&Op::Mul), "{f}");
    }
}
