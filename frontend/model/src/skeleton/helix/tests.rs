//! The helix against samples of it.

use jbt_testkit::skip::short_or_long;

use super::*;
use crate::skeleton::{ROUNDING, testing};

fn helix(pitch: f64, turns: f64) -> Helix {
    Helix { center: DVec3::ZERO, normal: DVec3::Z, start: DVec3::X, radius: 2.0, pitch, turns }
}

fn random(rng: &mut fastrand::Rng) -> Helix {
    let turns = [0.0, 0.25 * f64::from(rng.u8(0..12)), rng.f64(), 6.0 * rng.f64()][rng.usize(..4)];
    let pitch = 10f64.powf(2.0 * rng.f64() - 1.0) * if rng.bool() { 1.0 } else { -1.0 };
    Helix {
        center: testing::position(rng),
        normal: testing::direction(rng) * 2.0,
        start: testing::direction(rng),
        radius: if rng.u8(..8) == 0 { 0.0 } else { 3.0 * rng.f64() },
        pitch,
        turns,
    }
}

#[test]
fn known_distances() {
    // It begins at (2, 0, -4), and rises by 4 in a turn.
    for (p, expected) in [
        ([2.0, 0.0, -4.0], 0.0),
        ([2.0, 0.0, -9.0], 25.0),
        ([0.0, 2.0, -3.0], 0.0),
        ([2.0, 0.0, 0.0], 0.0),
        ([5.0, 0.0, 0.0], 9.0),
        ([0.0, -7.0, -1.0], 25.0),
        ([-2.0, 0.0, 2.0], 0.0),
        ([2.0, 0.0, 7.0], 9.0),
        // On the axis the place at its height is nearest.
        ([0.0, 0.0, 0.0], 4.0),
        ([0.0, 0.0, 1.5], 4.0),
        ([0.0, 0.0, -5.0], 5.0),
    ] {
        testing::same_everywhere(&helix(4.0, 2.0), p.into(), expected);
        let [x, y, z] = p;
        testing::same_everywhere(&helix(-4.0, 2.0), DVec3::new(x, y, -z), expected);
    }
    // Above the end, on the other side of the axis: the last place across is nearest.
    let across = [(-2.0, 0.0), (-2.0, -0.0)].map(|(x, y)| DVec3::new(x, y, 4.0));
    for p in across {
        let expected = helix(4.0, 2.0).distance_squared(p);
        assert!(expected < 4.0);
        testing::same_everywhere(&helix(4.0, 2.0), p, expected);
    }
    testing::same_everywhere(&helix(4.0, 0.0), DVec3::new(2.0, 3.0, 4.0), 25.0);
    // Without a radius it is a segment.
    let line = Helix { radius: 0.0, ..helix(4.0, 2.0) };
    testing::same_everywhere(&line, DVec3::new(3.0, 0.0, 1.0), 9.0);
    testing::same_everywhere(&line, DVec3::new(3.0, 0.0, 8.0), 25.0);
}

#[test]
fn agrees_with_samples_of_the_set() {
    testing::judge(5e-2, |rng| {
        let helix = random(rng);
        let pose = helix.pose();
        let samples = (0..=4000).map(|i| f64::from(i) / 4000.0 * helix.last());
        let samples = samples.map(|t| pose.transform_point3(helix.at(t))).collect();
        (helix, samples)
    });
}

/// The smallest distance from places so dense that, refined once, they are as good as all.
fn brute_force(helix: &Helix, q: DVec3) -> f64 {
    let count = 64.0_f64.max((128.0 * helix.turns).ceil());
    let step = helix.last() / count;
    let distance = |t: f64| q.distance(helix.at(t.clamp(0.0, helix.last())));
    let coarse: Vec<f64> = (0..=count as u32).map(|i| distance(f64::from(i) * step)).collect();
    let least = coarse.iter().copied().fold(f64::INFINITY, f64::min);
    let mut best = least;
    for (i, &found) in coarse.iter().enumerate() {
        // Within a step the distance changes by half the step's length at most.
        if found > least + step * helix.radius.hypot(helix.rise()) {
            continue;
        }
        let (mut low, mut high) = ((i as f64 - 1.0) * step, (i as f64 + 1.0) * step);
        for _ in 0..40 {
            let [a, b] = [low + 0.382 * (high - low), high - 0.382 * (high - low)];
            if distance(a) < distance(b) { high = b } else { low = a }
        }
        best = best.min(distance(low));
    }
    best
}

/// What the module says of the error, at 10^5 points: of both forms.
#[test]
fn the_error_is_as_stated() {
    let mut rng = fastrand::Rng::with_seed(3);
    let (mut worst, mut worst_plain, mut too_small, mut beyond) = (0.0_f64, 0.0_f64, 0.0_f64, [0_u32; 3]);
    let helices = short_or_long([600, 2_000]);
    for _ in 0..helices {
        let helix = random(&mut rng);
        let size = helix.radius.max(helix.rise().abs());
        let pose = helix.pose();
        let bend = if helix.radius > 0.0 { helix.rise().powi(2) / helix.radius } else { 0.0 };
        let extent = helix.radius + (helix.pitch * helix.turns).abs();
        for i in 0..50 {
            let near = helix.at((1.2 * rng.f64() - 0.1) * helix.last());
            // The centres of curvature are on a helix across from it, b^2 / R from the axis.
            let across = DVec3::new(-near.x, -near.y, 0.0).normalize_or_zero() * bend + DVec3::Z * near.z;
            let decades = if i % 4 == 0 { 9.0 } else { 5.0 };
            let around = testing::direction(&mut rng) * 10f64.powf(1.0 - decades * rng.f64());
            let q = if i % 2 == 0 && bend < 10.0 { across } else { near } + around;
            let p = pose.transform_point3(q);
            let expected = brute_force(&helix, q);
            worst_plain = worst_plain.max((helix.distance_squared(p).sqrt() - expected).abs() / (1.0 + expected));
            let error = f64::from(testing::emitted(&helix, p)).sqrt() - expected;
            let rounding = 2f64.powi(-24) * (extent + expected);
            too_small = too_small.max(-error / rounding);
            let part = (error - 4.0 * rounding) / size;
            worst = worst.max(part);
            for (count, bound) in beyond.iter_mut().zip([1e-9, 1e-7, 1e-6]) {
                *count += u32::from(part > bound);
            }
        }
    }
    assert!(worst_plain < 1e-7, "the plain search misses a minimum: {worst_plain}");
    assert!(too_small < 0.5 * ROUNDING * 2f64.powi(24), "too small by {too_small} units");
    assert!(worst <= 2f64.powi(-19), "{worst} of the size; {beyond:?} are beyond 1e-9, 1e-7, 1e-6");
    assert!(2 * beyond[1] < helices, "{beyond:?} of 50 points of {helices} helices are beyond 1e-9, 1e-7, 1e-6");
}

/// The rounding of a place does not grow with the turns.
#[test]
fn many_turns() {
    let mut rng = fastrand::Rng::with_seed(5);
    let helix = Helix { radius: 1.0, ..helix(0.01, 4095.75) };
    let height = helix.pitch * helix.turns;
    for i in 0..300 {
        let t = [-1e-4, helix.last() + 1e-4, helix.last() * rng.f64()][i % 3];
        let q = helix.at(t) + testing::direction(&mut rng) * 10f64.powf(-5.0 * rng.f64());
        let q = q.as_vec3().as_dvec3();
        let p = helix.pose().transform_point3(q);
        let (expected, got) = (helix.distance_squared(p).sqrt(), f64::from(testing::emitted(&helix, p)).sqrt());
        assert!((got - expected).abs() < 8.0 * 2f64.powi(-24) * (1.0 + height), "{q}: {got}, not {expected}");
    }
}

#[test]
fn faults() {
    assert!(helix(0.0, 1.0).fault().is_some());
    assert!(Helix { start: DVec3::NEG_Z, ..helix(1.0, 1.0) }.fault().is_some());
    assert!(helix(-1.0, 1.0).fault().is_none());
}
