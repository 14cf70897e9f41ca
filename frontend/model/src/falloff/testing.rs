//! Checks for the tests of all falloffs: published figures of the plain form, and the promises of the
//! compiled form.

use jbt_ir::domain::interval::Interval;
use jbt_ir::domain::scalar::Scalar;

use super::{Falloff, FalloffKind, Nearness};

/// Figures of a falloff, by r.
pub struct Published {
    /// Where it is 1/2.
    pub half: Option<f64>,
    /// Where it is steepest, and the magnitude of the slope there.
    pub steepest: Option<(f64, f64)>,
}

impl Published {
    /// Judges both forms of a falloff.
    pub fn check(self, falloff: Falloff) {
        assert_eq!([0.0, 1.0, 1.5, 1e30].map(|s| falloff.value(s)), [1.0, 0.0, 0.0, 0.0], "{falloff:?}");
        if let Some(half) = self.half {
            assert!((falloff.value(half * half) - 0.5).abs() < 2e-6, "{falloff:?}");
            assert!(
                (falloff.inverse(0.5).sqrt() - half).abs() < 2e-7,
                "{falloff:?}: {}",
                falloff.inverse(0.5).sqrt()
            );
        }
        if let Some((at, expected)) = self.steepest {
            let found = -slope(falloff, at, 1e-6);
            assert!((found - expected).abs() < 1e-4 * expected, "{falloff:?}: {found}, not {expected}");
            for step in 1..2000 {
                let found = -slope(falloff, f64::from(step) / 2000.0, 1e-6);
                assert!(found < expected * (1.0 + 1e-4), "{falloff:?}: {found} at {step}/2000");
            }
        }
        inverse_is_inverse(falloff);
        for depends in [false, true] {
            Compiled::new(falloff, depends).judge(falloff);
        }
    }
}

/// The derivative by r, by central differences.
pub fn slope(falloff: Falloff, r: f64, step: f64) -> f64 {
    let g = |r: f64| falloff.value(r * r);
    (g(r + step) - g(r - step)) / (2.0 * step)
}

fn inverse_is_inverse(falloff: Falloff) {
    for step in 1..100 {
        let level = f64::from(step) / 100.0;
        let s = falloff.inverse(level);
        assert!((0.0..=1.0).contains(&s), "{falloff:?} is {level} at {s}");
        let jumps = falloff.value(1.0 - 1e-12) > level;
        let close = (falloff.value(s) - level).abs() < 1e-9;
        assert!(if jumps { (s - 1.0).abs() < 1e-9 } else { close }, "{falloff:?} is {level} at {s}");
    }
}

/// A falloff as code with its row.
struct Compiled {
    kind: FalloffKind,
    row: Vec<f32>,
}

/// Steps of s from 0 to 1.
const STEPS: u32 = 100_000;

impl Compiled {
    fn new(falloff: Falloff, depends: bool) -> Self {
        let (kind, mut row) = (falloff.code(depends), Vec::new());
        falloff.columns(kind, &mut row);
        assert_eq!(row.len(), kind.columns().len(), "one number for each column");
        Self { kind, row: row.into_iter().map(|number| number as f32).collect() }
    }

    /// The field at s in f32, as lowering computes it.
    fn at(&self, s: f32) -> f32 {
        let near = Nearness::emit(&mut Scalar, s, -1.0);
        self.kind.emit(&mut Scalar, near, &self.row)
    }

    fn range(&self, low: f32, high: f32) -> [f32; 2] {
        let mut domain = Interval::new(Scalar);
        let row: Vec<_> = self.row.iter().map(|&number| domain.point(number)).collect();
        let (s, slope) = (domain.input(low, high), domain.point(-1.0));
        let near = Nearness::emit(&mut domain, s, slope);
        let range = self.kind.emit(&mut domain, near, &row);
        domain.output(range)
    }

    /// The largest relative error of an approximated power or exponential.
    fn slack(&self) -> f32 {
        match self.kind {
            FalloffKind::Degree(0) | FalloffKind::Blinn(_) | FalloffKind::InversePower(0 | 1) => 2e-6,
            FalloffKind::Soft
            | FalloffKind::Wyvill
            | FalloffKind::Quartic
            | FalloffKind::Metaball
            | FalloffKind::Hermite
            | FalloffKind::Quintic
            | FalloffKind::Linear
            | FalloffKind::Degree(_)
            | FalloffKind::ArcTan(_)
            | FalloffKind::InversePower(_)
            | FalloffKind::Blanc(_) => 0.0,
        }
    }

    fn judge(&self, falloff: Falloff) {
        self.falls(falloff);
        for s in [1.0, 1.000_000_1, 1.5, 1e30, f32::INFINITY, f32::NAN] {
            assert_eq!(self.at(s).to_bits(), 0, "{falloff:?} is +0 at {s}");
        }
        assert_eq!(self.range(1.0, 2.0), [0.0; 2], "{falloff:?}: nothing outside");
        self.has_exact_images(falloff);
    }

    /// It falls from 1 to 0 in every step, and is near the plain form.
    fn falls(&self, falloff: Falloff) {
        // u may be off by 2^-25, so the field may be off by that times its slope in s.
        let steepest = (1..2000).map(|step| {
            let s = f64::from(step) / 2000.0;
            (falloff.value(s - 1e-6) - falloff.value(s + 1e-6)) / 2e-6
        });
        let bound = 2e-6 + 2e-7 * steepest.fold(0.0, f64::max);
        let mut last = self.at(0.0);
        assert!((last - 1.0).abs() < 1e-6, "{falloff:?} begins with {last}");
        for step in 1..=STEPS {
            let s = step as f32 / STEPS as f32;
            let next = self.at(s);
            assert!((0.0..=last).contains(&next), "{falloff:?} rises from {last:e} to {next:e} at {s}");
            let plain = falloff.value(f64::from(s));
            if s < 1.0 {
                assert!((f64::from(next) - plain).abs() < bound, "{falloff:?} is {next}, not {plain} at {s}");
            }
            last = next;
        }
        assert_eq!(last.to_bits(), 0);
    }

    /// The image of a range of s is exactly between the values at its ends.
    fn has_exact_images(&self, falloff: Falloff) {
        let mut rng = fastrand::Rng::with_seed(3);
        for i in 0..5000 {
            let width = 0.5f32.powi(i % 12) * rng.f32();
            let low = (1.2 * rng.f32() - 0.1 - 0.5 * width).clamp(0.0, 1.0);
            let high = (low + width).min(1.0);
            let (least, most) = (self.at(high), self.at(low));
            let [bottom, top] = self.range(low, high);
            assert!(bottom <= least && most <= top, "{falloff:?} encloses [{low}, {high}]");
            // An exact edge jumps: a range that reaches it goes down to 0.
            let close = |bound: f32, value: f32| (bound - value).abs() <= self.slack() * value.max(1e-30);
            assert!(
                close(bottom, least) && close(top, most),
                "{falloff:?} over [{low}, {high}]: [{bottom:e}, {top:e}], not [{least:e}, {most:e}]"
            );
        }
    }
}

#[test]
fn names_are_unique() {
    let mut words: Vec<&str> = Vec::new();
    for kind in FalloffKind::ALL {
        words.push(kind.name());
        words.extend(kind.aliases());
        assert!(words.iter().all(|word| FalloffKind::named(word).is_some()));
    }
    let count = words.len();
    words.sort_unstable();
    words.dedup();
    assert_eq!(words.len(), count);
    assert_eq!(FalloffKind::named("murakami"), Some(FalloffKind::Quartic));
    assert_eq!(FalloffKind::named("hard"), None);
}
