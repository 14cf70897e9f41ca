//! Ricci's blend (Ricci 1973): `F = (sum max(f_i, 0)^n)^(1/n)`; with n = 1 the plain sum, negative fields
//! included.
//!
//! Scaled by the largest operand, no exponent overflows: `F = m (sum (f_i / m)^n)^(1/n)`. The weight of a
//! child is `f_i^n`. With a negative exponent it is an intersection that blends, 0 where any operand is, and
//! m is the smallest operand.
//!
//! The compiler meets the operands one at a time and does not know the largest beforehand, so it keeps the
//! largest so far, `m`, and the sum relative to it, `S = sum (f_i / m)^n`. A larger operand f rescales: `S (m
//! / f)^n + 1`. Either way it takes one power:
//!
//! ```text
//! p = (min(f, m) / max(f, m))^n
//! S = f > m ? S p + 1 : S + p        m = max(f, m)        in the end F = m S^(1/n)
//! ```
//!
//! m begins at a number so small that an operand below it counts for nothing; so it is never 0, and no
//! quotient needs a guard. F does not depend on m, so m is held: its tangent would cancel. The 1 is `(f /
//! f)^n` and has the tangent `n f' / f`.
//!
//! A negative exponent exchanges larger and smaller: with p = -n, m is the smallest so far, which begins at a
//! number above all fields, a *smaller* operand rescales, and `F = m / S^(1/p)`. Quotients are those of the
//! smaller by the larger again; where that is 0, so is F.

use jbt_ir::{Domain, limits};

use super::member::{Finished, Fold, Met, Operator, Setting, Syntax};
use crate::diagnostic::Diagnostic;
use crate::member::member;
use crate::power::{Exponent, power};

member! {
    /// Ricci's super-elliptic blend (Ricci 1973).
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Ricci = "ricci" {
        /// In [1, 1024], where 1 is the sum and large ones are near the union, or in [-1024, -1], near the
        /// intersection.
        pub exponent: f64 [Real],
    }
}

/// What the largest operand is before there is one: about 8e-31. Its reciprocal is finite.
pub(crate) const FLOOR: f32 = 1.0 / (1u128 << 100) as f32;

/// What the smallest operand is before there is one, for a negative exponent: about 1e30.
pub(crate) const CEILING: f32 = (1u128 << 100) as f32;

/// Roots of a power of two up to this exponent are taken by square roots: more of them take longer than a
/// power.
const MOST_SQUARE_ROOTS: u32 = 16;

/// What an exponent is as code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct RicciCode {
    /// An integer exponent is code: a chain of products. Any other is a number of the row.
    integer: Option<u32>,
    /// Whether the exponent is negative; otherwise these are magnitudes.
    negative: bool,
}

impl RicciCode {
    /// The magnitude of the exponent.
    fn exponent<R: Copy>(self, row: &[R]) -> Exponent<R> {
        self.integer.map_or_else(|| Exponent::General(row[0], row[1]), Exponent::Integer)
    }
}

impl Ricci {
    /// Whether it is the plain sum.
    pub(super) const fn is_sum(self) -> bool {
        self.exponent == 1.0
    }
}

impl Operator for Ricci {
    const SYNTAX: Syntax = Syntax::Alone;
    const HEAD: &'static str = "blend ricci";

    fn fault(&self, _: f64) -> Option<Diagnostic> {
        let (n, most) = (self.exponent, limits::MAX_RICCI_EXPONENT);
        (!(1.0..=most).contains(&n.abs())).then(|| {
            Diagnostic::error(None, format!("the exponent of the Ricci blend is {n}"))
                .expected(format!("expected a number from 1 to {most}, or from -{most} to -1"))
        })
    }

    /// Never exactly 1: the plain sum is another operator where fields are negative. The next number above 1
    /// is the same exponent in f32.
    fn general(self) -> Self {
        if self.is_sum() { Self { exponent: 1.0 + f64::EPSILON } } else { self }
    }
}

impl Fold for Ricci {
    type Code = RicciCode;

    fn code(self, depends: bool) -> RicciCode {
        let (n, negative) = (self.exponent.abs(), self.exponent < 0.0);
        let is_integer = n == f64::from(n as u32);
        RicciCode { integer: (is_integer && !depends).then_some(n as u32), negative }
    }

    fn field(self, fields: &[f64], iso: f64) -> f64 {
        if self.is_sum() {
            return fields.iter().sum();
        }
        let n = self.exponent;
        let scale = if n < 0.0 {
            fields.iter().fold(f64::INFINITY, |m, &f| m.min(f)).max(0.0)
        } else {
            fields.iter().fold(0.0f64, |m, &f| m.max(f))
        };
        if scale == 0.0 {
            return 0.0;
        }
        scale * self.weights(fields, iso).iter().sum::<f64>().powf(1.0 / n)
    }

    fn weights(self, fields: &[f64], _: f64) -> Vec<f64> {
        let n = self.exponent;
        if n < 0.0 {
            let smallest = fields.iter().fold(f64::INFINITY, |m, &f| m.min(f));
            let weight = |f: &f64| if smallest > 0.0 { (smallest / f).powf(-n) } else { 0.0 };
            return fields.iter().map(weight).collect();
        }
        let largest = fields.iter().fold(0.0f64, |m, &f| m.max(f));
        if self.is_sum() || largest == 0.0 {
            return fields.iter().map(|f| f.max(0.0)).collect();
        }
        fields.iter().map(|f| (f.max(0.0) / largest).powf(n)).collect()
    }

    /// With a negative exponent, how far the operands are from where one becomes 0.
    fn kink_distance(self, fields: &[f64]) -> f64 {
        if self.exponent < 0.0 {
            fields.iter().fold(f64::INFINITY, |nearest, f| nearest.min(f.abs()))
        } else {
            f64::INFINITY
        }
    }

    fn is_non_negative(self, children: bool) -> bool {
        children || !self.is_sum()
    }

    fn flattens(self, _: bool) -> bool {
        true
    }

    fn absorbs(code: RicciCode) -> bool {
        code.negative
    }

    fn columns(code: RicciCode) -> &'static [&'static str] {
        if code.integer.is_some() { &[] } else { &["exponent", "inverse_exponent"] }
    }

    fn push_columns(self, code: RicciCode, row: &mut Vec<f64>) {
        let n = self.exponent.abs();
        if code.integer.is_none() {
            row.extend([n, 1.0 / n]);
        }
    }

    /// The largest operand and the sum relative to it; for a negative exponent, the smallest.
    fn start<D: Domain>(code: RicciCode, d: &mut D, _: Setting<'_, D::Real>) -> Vec<D::Real> {
        let zero = d.constant(0.0);
        vec![d.constant(if code.negative { CEILING } else { FLOOR }), zero]
    }

    fn meet<D: Domain>(
        code: RicciCode,
        d: &mut D,
        so_far: &[D::Real],
        operand: D::Real,
        setting: Setting<'_, D::Real>,
        _: bool,
    ) -> Met<D::Real> {
        let (exponent, negative) = (code.exponent(setting.row), code.negative);
        let (extreme, sum) = (so_far[0], so_far[1]);
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let field = if setting.non_negative { operand } else { d.max(operand, zero) };
        let (takes, scale, ratio) = if negative {
            let takes = d.lt(field, extreme);
            let scale = d.min(field, extreme);
            let scale = d.stop_gradient(scale);
            // In this order: of equals the operand, whose tangent counts. Two zeros have the quotient 0.
            let (larger, floor) = (d.max(extreme, field), d.constant(FLOOR));
            let larger = d.max(larger, floor);
            (takes, scale, d.div(scale, larger))
        } else {
            let takes = d.lt(extreme, field);
            let scale = d.max(field, extreme);
            let scale = d.stop_gradient(scale);
            // In this order: of equals the operand, whose tangent counts.
            let smaller = d.min(extreme, field);
            (takes, scale, d.div(smaller, scale))
        };
        let power = power(d, ratio, exponent);
        let first = if setting.moving { unit(d, field, scale, (exponent, negative)) } else { one };
        let rescaled = d.fma(sum, power, first);
        let added = d.add(sum, power);
        let sum = d.select(takes, rescaled, added);
        let (rescale, weight) = (d.select(takes, power, one), d.select(takes, one, power));
        Met { so_far: vec![scale, sum], weight: Some(weight), rescale: Some(rescale) }
    }

    fn has_total(_: RicciCode, _: bool) -> bool {
        false
    }

    /// `F = largest * sum^(1/n)`.
    fn finish<D: Domain>(
        code: RicciCode,
        d: &mut D,
        so_far: &[D::Real],
        _: Option<D::Real>,
        setting: Setting<'_, D::Real>,
    ) -> Finished<D::Real> {
        let (extreme, sum) = (so_far[0], so_far[1]);
        let root = match code.exponent(setting.row) {
            Exponent::Integer(n) if n.is_power_of_two() && n <= MOST_SQUARE_ROOTS => {
                (0..n.ilog2()).fold(sum, |root, _| d.sqrt(root))
            }
            Exponent::Integer(n) => {
                let inverse = d.constant(1.0 / n as f32);
                d.pow(sum, inverse)
            }
            Exponent::General(_, inverse) => d.pow(sum, inverse),
        };
        let field = if code.negative { d.div(extreme, root) } else { d.mul(extreme, root) };
        Finished { field, total: sum, seen: if code.negative { field } else { sum } }
    }
}

/// 1, with the tangent of `(field / largest)^n` where the two are equal.
fn unit<D: Domain>(
    d: &mut D,
    field: D::Real,
    scale: D::Real,
    (exponent, negative): (Exponent<D::Real>, bool),
) -> D::Real {
    let one = d.constant(1.0);
    let divisor = if negative {
        let floor = d.constant(FLOOR);
        d.max(scale, floor)
    } else {
        scale
    };
    let inverse = d.div(one, divisor);
    let quotient = d.mul(field, inverse);
    let held = d.stop_gradient(quotient);
    let still = if negative { d.sub(held, quotient) } else { d.sub(quotient, held) };
    let n = match exponent {
        Exponent::Integer(n) => d.constant(n as f32),
        Exponent::General(n, _) => n,
    };
    d.fma(n, still, one)
}
