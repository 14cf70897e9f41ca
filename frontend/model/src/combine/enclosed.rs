//! Steps that follow their sides in one way are bounded by their values at the ends of these.
//!
//! ```text
//! F grows with a, falls with b:     F(a.low, b.high) - e <= F <= F(a.high, b.low) + e
//! ```
//!
//! e is the rounding of F itself, which grows only in real numbers: once for the end and once for where F is
//! asked. Op by op a range would forget that what rounds, and what it rounds, depend on the same sides.

use jbt_ir::Domain;

use super::member::{SideGrowth, Step};

/// The low end, or the high one, as a number.
fn end<D: Domain>(d: &mut D, is_low: bool, x: D::Real) -> D::Real {
    if is_low {
        return d.low_end(x);
    }
    let minus = d.neg(x);
    let end = d.low_end(minus);
    d.neg(end)
}

/// `plain`, to the bit; over ranges bounded by the ends as well.
pub(super) fn enclosed<S: Step, D: Domain>(
    code: S::Code,
    d: &mut D,
    (plain, sides): (D::Real, [D::Real; 2]),
    row: &[D::Real],
    iso2: D::Real,
) -> D::Real {
    let Some(growth) = S::growth(code) else { return plain };
    let [low, high] = [true, false].map(|is_low| {
        let mut of = |side: usize| end(d, is_low == (growth[side] == SideGrowth::Rises), sides[side]);
        [of(0), of(1)]
    });
    let sizes = [0, 1].map(|side| {
        let (a, b) = (d.abs(low[side]), d.abs(high[side]));
        d.add(a, b)
    });
    let rounding = S::rounding(code, d, sizes, row, iso2);
    let minus = d.neg(rounding);
    let [lowest, highest] = [(low, minus), (high, rounding)].map(|(ends, off)| {
        let field = S::emit(code, d, ends, row, iso2).field;
        let (bound, zero) = (d.add(field, off), d.constant(0.0));
        // NaN where an end is: then nothing is known.
        low.into_iter().chain(high).fold(bound, |bound, end| d.fma(end, zero, bound))
    });
    let below = d.min(highest, plain);
    d.max(lowest, below)
}

#[cfg(test)]
mod tests {
    use jbt_ir::domain::interval::Interval;
    use jbt_ir::domain::scalar::Scalar;

    use crate::combine::operators::{
        RFunction, RFunctionOrder, RFunctionPower, SmoothDifference, SmoothIntersection, SmoothUnion,
    };
    use crate::combine::{Combinator, OperatorForm, ReduceCode, SetOperation, StepCode};

    /// A step with its row.
    fn step(operator: Combinator, iso: f64) -> (StepCode, Vec<f32>) {
        let OperatorForm::Reduce(ReduceCode::Step(code)) = operator.form(false) else {
            unreachable!("these are steps")
        };
        let mut row = Vec::new();
        operator.push_columns(false, iso, &mut row);
        (code, row.into_iter().map(|number| number as f32).collect())
    }

    /// The range of a step, bounded by ends or op by op.
    fn range((code, row): &(StepCode, Vec<f32>), sides: [[f32; 2]; 2], iso2: f32, ends: bool) -> [f32; 2] {
        let mut d = Interval::new(Scalar);
        let sides = sides.map(|[low, high]| d.input(low, high));
        let row: Vec<_> = row.iter().map(|&number| d.point(number)).collect();
        let iso2 = d.point(iso2);
        let plain = code.emit(&mut d, sides, &row, iso2).field;
        let field = if ends { code.bounded(&mut d, (plain, sides), &row, iso2) } else { plain };
        d.output(field)
    }

    fn operators(rng: &mut fastrand::Rng) -> Vec<Combinator> {
        let width = 10f64.powf(-3.0 + 3.0 * rng.f64());
        let mut all: Vec<Combinator> = vec![
            SmoothUnion { width }.into(),
            SmoothIntersection { width }.into(),
            SmoothDifference { width }.into(),
        ];
        for set in SetOperation::ALL {
            all.push(RFunction { set, alpha: 1.9 * rng.f64() - 0.9 }.into());
            all.push(RFunction { set, alpha: 1.0 }.into());
            all.push(RFunctionPower { set, power: 1.1 + 62.0 * rng.f64().powi(3) }.into());
            all.push(RFunctionOrder { set, order: rng.u32(1..5) }.into());
        }
        all
    }

    /// A range of fields, among them thin ones and such with a zero at an end.
    fn fields(rng: &mut fastrand::Rng) -> [f32; 2] {
        let low = match rng.u8(0..6) {
            0 => 0.0,
            1 => -2.0 * rng.f32(),
            2 => 20.0 * rng.f32(),
            _ => 1.2 * rng.f32(),
        };
        [low, low + [0.0, 1e-6, 1e-3, 0.1, 1.0][rng.usize(0..5)] * rng.f32()]
    }

    #[test]
    fn ranges_hold_the_numbers_and_end_near_them() {
        let mut rng = fastrand::Rng::with_seed(1);
        let (mut parts, mut count) = ([0.0; 2], [0.0; 2]);
        for _ in 0..4000 {
            let iso = [0.5, 0.1, 3.0][rng.usize(0..3)];
            let iso2 = (2.0 * iso) as f32;
            for operator in operators(&mut rng) {
                let step = step(operator, iso);
                let sides = [fields(&mut rng), fields(&mut rng)];
                let [low, high] = range(&step, sides, iso2, true);
                let [first, last] = range(&step, sides, iso2, false);
                assert!(first <= low && high <= last, "{operator:?} {sides:?}");
                let is_smooth = matches!(
                    operator,
                    Combinator::SmoothUnion(_)
                        | Combinator::SmoothIntersection(_)
                        | Combinator::SmoothDifference(_)
                );
                // That of an order is not monotone.
                let is_bounded = !matches!(operator, Combinator::RFunctionOrder(_));
                let kind = is_bounded.then_some(usize::from(!is_smooth));
                // Of thin ranges rounding is a part.
                if let Some(kind) = kind.filter(|_| last - first > 0.01) {
                    parts[kind] += f64::from((high - low) / (last - first));
                    count[kind] += 1.0;
                }
                for _ in 0..8 {
                    let at = sides.map(|[low, high]| match rng.u8(0..4) {
                        0 => low,
                        1 => high,
                        _ => (low + (high - low) * rng.f32()).clamp(low, high),
                    });
                    let d = &mut Scalar;
                    let field = step.0.emit(d, at, &step.1, iso2).field;
                    assert!(low <= field && field <= high, "{operator:?}: {field} at {at:?}, {sides:?}");
                    // Points keep their bits.
                    let same = step.0.bounded(d, (field, at), &step.1, iso2);
                    assert_eq!(same.to_bits(), field.to_bits(), "{operator:?}");
                }
            }
        }
        // How wide ranges are, on average, as a part of what they are op by op.
        let [smooth, rvachev] = [0, 1].map(|kind| parts[kind] / count[kind]);
        assert!(smooth < 0.98 && rvachev < 0.7, "{smooth} {rvachev}");
    }

    #[test]
    fn a_round_union_is_known_by_its_ends() {
        // R_0 of fields from 0 to 1: what it is of nothing and of two that are 1.
        let step = step(RFunction { set: SetOperation::Union, alpha: 0.0 }.into(), 0.5);
        let value = |a: f32| {
            let d = &mut Scalar;
            step.0.emit(d, [a; 2], &step.1, 1.0).field
        };
        let [low, high] = range(&step, [[0.0, 1.0]; 2], 1.0, true);
        assert!((low - value(0.0)).abs() < 1e-3 && (high - value(1.0)).abs() < 1e-3, "{low} {high}");
        // What may be NaN stays so.
        let open = range(&step, [[0.0, f32::INFINITY], [0.0, 1.0]], 1.0, true);
        assert_eq!(open, [f32::NEG_INFINITY, f32::INFINITY]);
    }
}
