//! The transcendental ops against `f64`: the largest errors that their docs state, and the special cases,
//! exactly.

use jbt_ir::domain::scalar::Scalar;
use jbt_ir::math;

const SAMPLES: usize = 1_000_000;
const SPECIALS: [f32; 22] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    3.0,
    -2.5,
    1e-45,
    -1e-45,
    1e-40,
    f32::MIN_POSITIVE,
    f32::EPSILON,
    1.0 + f32::EPSILON,
    1.0 - f32::EPSILON / 2.0,
    16_777_216.0,
    1e30,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

fn sin(a: f32) -> f32 {
    math::sin(&mut Scalar, a)
}

fn cos(a: f32) -> f32 {
    math::cos(&mut Scalar, a)
}

fn exp(a: f32) -> f32 {
    math::exp(&mut Scalar, a)
}

fn ln(a: f32) -> f32 {
    math::ln(&mut Scalar, a)
}

fn pow(a: f32, b: f32) -> f32 {
    math::pow(&mut Scalar, a, b)
}

/// The distance between a result and the truth, in units of the last place that the truth has as an `f32`.
///
/// Above the largest finite number the count goes on as if the next binade existed: infinity stands for
/// 2^128.
fn error(got: f32, truth: f64) -> f64 {
    if got.is_nan() || truth.is_nan() {
        return if got.is_nan() && truth.is_nan() { 0.0 } else { f64::INFINITY };
    }
    let end = 2f64.powi(128);
    let got = if got.is_infinite() { end.copysign(f64::from(got)) } else { f64::from(got) };
    let truth = truth.clamp(-end, end);
    let exponent = if truth == 0.0 { -126.0 } else { truth.abs().log2().floor().clamp(-126.0, 127.0) };
    (got - truth).abs() / (exponent - 23.0).exp2()
}

/// The largest error over these operands, and where it is.
fn worst(operands: impl Iterator<Item = f32>, ours: fn(f32) -> f32, truth: fn(f64) -> f64) -> (f64, f32) {
    operands
        .map(|a| (error(ours(a), truth(f64::from(a))), a))
        .fold((0.0, 0.0), |worst, this| if this.0 > worst.0 { this } else { worst })
}

/// Numbers with a magnitude up to `limit`: half of them spread over the bit patterns, half of them over the
/// numbers.
fn spread(seed: u64, limit: f32) -> impl Iterator<Item = f32> {
    let mut random = fastrand::Rng::with_seed(seed);
    let top = limit.to_bits();
    (0..SAMPLES).map(move |i| {
        if i % 2 == 0 {
            let magnitude = f32::from_bits(random.u32(0..=top));
            if random.bool() { magnitude } else { -magnitude }
        } else {
            (random.f32() * 2.0 - 1.0) * limit
        }
    })
}

fn check(name: &str, (worst, at): (f64, f32), bound: f64) {
    assert!(worst <= bound, "{name}({at:e}) is {worst} ULP off, more than {bound}");
}

#[test]
fn sine_and_cosine_are_within_their_bound() {
    for limit in [1.0, 10.0, 1e4, math::LARGEST_ANGLE] {
        check("sin", worst(spread(1, limit), sin, f64::sin), 1.25);
        check("cos", worst(spread(2, limit), cos, f64::cos), 1.25);
    }
    // Next to the multiples of a quarter turn almost all of the angle cancels.
    let near = || {
        (0..80_000u32).flat_map(|n| {
            let a = (f64::from(n) * std::f64::consts::FRAC_PI_2) as f32;
            [a.next_down(), a, a.next_up(), -a]
        })
    };
    check("sin near quarters", worst(near(), sin, f64::sin), 1.25);
    check("cos near quarters", worst(near(), cos, f64::cos), 1.25);
}

#[test]
fn sine_and_cosine_of_special_angles() {
    assert_eq!(sin(0.0).to_bits(), 0.0f32.to_bits());
    assert_eq!(sin(-0.0).to_bits(), (-0.0f32).to_bits());
    assert_eq!(cos(0.0), 1.0);
    assert_eq!(cos(-0.0), 1.0);
    assert_eq!(sin(1e-45), 1e-45);
    for a in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        assert!(sin(a).is_nan() && cos(a).is_nan());
    }
    for a in [math::LARGEST_ANGLE.next_up(), 1e8, 1e30, f32::MAX] {
        assert_eq!((sin(a).to_bits(), cos(a)), (0.0f32.to_bits(), 1.0));
        assert_eq!((sin(-a).to_bits(), cos(-a)), ((-0.0f32).to_bits(), 1.0));
    }
    for a in spread(3, f32::MAX) {
        assert!(sin(a).abs() <= 1.0 && cos(a).abs() <= 1.0);
        assert_eq!(sin(-a), -sin(a));
        assert_eq!(cos(-a), cos(a));
    }
}

#[test]
fn exponential_is_within_its_bound() {
    for limit in [1.0, 89.0, 110.0, f32::MAX] {
        check("exp", worst(spread(4, limit), exp, f64::exp), 1.0);
    }
    let subnormal = (0..100_000u32).map(|i| -87.0 - (f64::from(i) * 1.8e-4) as f32);
    check("exp, subnormal", worst(subnormal, exp, f64::exp), 1.0);
    check("exp, special", worst(SPECIALS.into_iter(), exp, f64::exp), 1.0);
}

#[test]
fn exponential_of_special_numbers() {
    assert_eq!(exp(0.0), 1.0);
    assert_eq!(exp(-0.0), 1.0);
    assert_eq!(exp(f32::INFINITY), f32::INFINITY);
    assert_eq!(exp(f32::NEG_INFINITY).to_bits(), 0.0f32.to_bits());
    assert_eq!(exp(-104.0), 0.0);
    assert_eq!(exp(88.722_84), f32::INFINITY);
    assert!(exp(88.722_83).is_finite());
    assert!(exp(-103.9) > 0.0);
    assert!(exp(f32::NAN).is_nan());
}

#[test]
fn logarithm_is_within_its_bound() {
    for limit in [1e-38, 0.5, 1.5, 10.0, f32::MAX] {
        check("ln", worst(spread(5, limit).map(f32::abs), ln, f64::ln), 1.0);
    }
    let near_one = (0..400_000).map(|i| f32::from_bits(1f32.to_bits() - 200_000 + i));
    check("ln near 1", worst(near_one, ln, f64::ln), 1.0);
    check("ln, special", worst(SPECIALS.into_iter(), ln, f64::ln), 1.0);
}

#[test]
fn logarithm_of_special_numbers() {
    assert_eq!(ln(1.0).to_bits(), 0.0f32.to_bits());
    assert_eq!(ln(0.0), f32::NEG_INFINITY);
    assert_eq!(ln(-0.0), f32::NEG_INFINITY);
    assert_eq!(ln(f32::INFINITY), f32::INFINITY);
    for a in [-1e-45, -1.0, f32::MIN, f32::NEG_INFINITY, f32::NAN] {
        assert!(ln(a).is_nan());
    }
}

/// The largest error of these powers, and where it is.
fn worst_power(pairs: impl Iterator<Item = (f32, f32)>) -> (f64, (f32, f32)) {
    pairs
        .map(|(a, b)| (error(pow(a, b), f64::from(a).powf(f64::from(b))), (a, b)))
        .fold((0.0, (0.0, 0.0)), |worst, this| if this.0 > worst.0 { this } else { worst })
}

#[test]
fn power_is_within_its_bound() {
    let mut random = fastrand::Rng::with_seed(6);
    let mut cases: Vec<(f32, f32)> = Vec::with_capacity(SAMPLES + 400_000);
    for i in 0..SAMPLES {
        // The exponent spans the results from underflow to overflow: a logarithm of up to 150 in base 2.
        let a = match i % 4 {
            0 => f32::from_bits(random.u32(1..0x7f80_0000)),
            1 => random.f32(),
            2 => 0.5 + random.f32(),
            _ => 1.0 + (random.f32() - 0.5) * 0.01,
        };
        let b = (random.f32() * 2.0 - 1.0) * 150.0 / a.log2().abs().max(0.01);
        cases.push((a, b));
    }
    for _ in 0..200_000 {
        cases.push((random.f32(), 1.0 + random.f32() * 1023.0));
        cases.push((f32::from_bits(random.u32(1..0x7f80_0000)), 1.0 / (1.0 + random.f32() * 1023.0)));
    }
    let (worst, (a, b)) = worst_power(cases.into_iter());
    assert!(worst <= 1.25, "pow({a:e}, {b:e}) is {worst} ULP off");
}

#[test]
fn power_of_integers() {
    for n in 1..=1024u16 {
        let n = f32::from(n);
        let (worst, (a, b)) = worst_power((0..2000u16).map(|i| (f32::from(i) / 1000.0, n)));
        assert!(worst <= 1.25, "pow({a:e}, {b:e}) is {worst} ULP off");
        assert_eq!(pow(1.0, n), 1.0);
        assert_eq!(pow(0.0, n).to_bits(), 0.0f32.to_bits());
    }
}

#[test]
fn power_of_special_numbers() {
    for a in SPECIALS {
        assert_eq!(pow(a, 0.0), 1.0, "{a}");
        assert_eq!(pow(a, -0.0), 1.0, "{a}");
        assert_eq!(pow(1.0, a), 1.0, "{a}");
    }
    for a in SPECIALS {
        for b in SPECIALS {
            if a == 1.0 || b == 0.0 {
                continue;
            }
            let got = pow(a, b);
            let truth = if a < 0.0 { f64::NAN } else { f64::from(a).abs().powf(f64::from(b)) };
            assert!(error(got, truth) <= 1.25, "pow({a:e}, {b:e}) = {got:e}, not {truth:e}");
            if truth == 0.0 || truth.is_infinite() {
                assert_eq!(f64::from(got), truth, "pow({a:e}, {b:e})");
                assert!(got.is_sign_positive(), "pow({a:e}, {b:e})");
            }
        }
    }
}
