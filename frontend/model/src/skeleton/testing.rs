//! Checks for the tests of all skeletons: every skeleton is compared with points of its set.

use std::fmt::Debug;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use jbt_ir::domain::scalar::Scalar;

use super::{BEYOND, ROUNDING, SkeletonMember};
use crate::bounds::Bounds;

/// A position within 5 of the origin along each axis.
pub fn position(rng: &mut fastrand::Rng) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 10.0 * rng.f64() - 5.0))
}

/// A unit vector.
pub fn direction(rng: &mut fastrand::Rng) -> DVec3 {
    loop {
        let v = position(rng);
        if v.length() > 0.1 {
            return v.normalize();
        }
    }
}

/// Radii in [0, 1] and angles that cover the unit disc, its middle and rim included.
pub fn polar(rings: u32, spokes: u32) -> impl Iterator<Item = (f64, f64)> {
    let turn = std::f64::consts::TAU / f64::from(spokes);
    (0..=rings)
        .flat_map(move |r| (0..spokes).map(move |s| (f64::from(r) / f64::from(rings), f64::from(s) * turn)))
}

/// Directions that cover the unit sphere, the axes included: unit vectors.
pub fn sphere(bands: u32) -> impl Iterator<Item = DVec3> {
    let step = std::f64::consts::PI / f64::from(bands);
    let band = move |i: u32| (0..2 * bands).map(move |j| (f64::from(i) * step, f64::from(j) * step));
    (0..=bands).flat_map(band).map(|(latitude, longitude)| {
        let (across, up) = latitude.sin_cos();
        DVec3::new(across * longitude.cos(), across * longitude.sin(), up)
    })
}

/// Points that cover the unit ball, its middle and its surface included.
pub fn ball(shells: u32) -> impl Iterator<Item = DVec3> {
    let shell = move |i: u32| sphere(12).map(move |v| f64::from(i) / f64::from(shells) * v);
    (0..=shells).flat_map(shell)
}

/// The compiler's form in f32: numbers are derived in f64 and rounded once. The point is brought to the pose
/// in f64, so that only the form is judged.
pub fn emitted<S: SkeletonMember>(skeleton: &S, p: DVec3) -> f32 {
    emitted_scaled(skeleton, 1.0, p)
}

/// The compiler's form of the skeleton scaled by `scale`, at the point `scale * p`.
fn emitted_scaled<S: SkeletonMember>(skeleton: &S, scale: f64, p: DVec3) -> f32 {
    let mut row = Vec::new();
    skeleton.columns(scale, &mut row);
    assert_eq!(row.len(), S::COLUMNS.len(), "one number for each column");
    let mut row: Vec<f32> = row.into_iter().map(|x| x as f32).collect();
    let p = scale * skeleton.pose().inverse().transform_point3(p);
    let p = p.as_vec3().to_array();
    row.extend(folded(skeleton, scale, p));
    S::emit(&mut Scalar, p, &row)
}

/// The support radius of skeletons with pieces: no point is farther away.
const REACH: f64 = 40.0;

/// The final accumulators, if the skeleton has pieces; `p` is in the pose and scaled.
fn folded<S: SkeletonMember>(skeleton: &S, scale: f64, p: [f32; 3]) -> Vec<f32> {
    let Some(pieces) = S::PIECES else { return Vec::new() };
    let mut numbers = Vec::new();
    skeleton.pieces(scale, REACH, &mut numbers);
    let numbers: Vec<f32> = numbers.into_iter().map(|x| x as f32).collect();
    let start = S::begin(&mut Scalar, (BEYOND * REACH * scale) as f32);
    let rows = numbers.chunks_exact(pieces.columns.len());
    rows.fold(start, |so_far, piece| S::step(&mut Scalar, p, piece, &so_far))
}

/// Judges random tubes by balls of which they are made; each point of a set is within `spacing` of a ball.
pub fn judge_balls<S>(spacing: f64, mut make: impl FnMut(&mut fastrand::Rng) -> (S, Vec<(DVec3, f64)>))
where
    S: SkeletonMember + PartialEq + Debug,
{
    let mut rng = fastrand::Rng::with_seed(2);
    for _ in 0..40 {
        let (skeleton, balls) = make(&mut rng);
        assert_eq!(S::from_fields(&skeleton.to_fields()), skeleton);
        assert!(skeleton.fault().is_none(), "{skeleton:?}");
        let bounds = skeleton.bounds_under(&DAffine3::IDENTITY);
        let around =
            balls.iter().map(|(c, r)| Bounds::new(*c - *r, *c + *r)).fold(Bounds::EMPTY, Bounds::hull);
        assert!((around.min - bounds.min).min_element() >= -1e-11, "{bounds:?} does not hold {around:?}");
        assert!((bounds.max - around.max).min_element() >= -1e-11, "{bounds:?} does not hold {around:?}");
        assert!((around.min - bounds.min).max_element() <= spacing, "{bounds:?} is too large for {around:?}");
        assert!((bounds.max - around.max).max_element() <= spacing, "{bounds:?} is too large for {around:?}");
        for i in 0..50 {
            let (center, radius) = balls[rng.usize(..balls.len())];
            let near = center + direction(&mut rng) * (radius + 10f64.powf(1.0 - 6.0 * rng.f64()));
            let p = if i % 2 == 0 { near } else { 2.0 * position(&mut rng) };
            let p = p.as_vec3().as_dvec3();
            let distance = skeleton.distance_squared(p).sqrt();
            let ball = balls.iter().map(|(c, r)| c.distance(p) - r).fold(f64::INFINITY, f64::min).max(0.0);
            assert!(distance <= ball + 1e-9, "{skeleton:?} at {p}: {distance}, but a ball is {ball} away");
            assert!(ball <= distance + spacing, "{skeleton:?} at {p}: {distance}, but no ball within {ball}");
            let got = f64::from(emitted(&skeleton, p)).sqrt();
            let size = skeleton.bounds_under(&skeleton.pose().inverse());
            let size = size.min.abs().max(size.max.abs()).max_element();
            let allowed = (ROUNDING + 2f64.powi(-24)) * (size + distance) + 2f64.powi(-73);
            assert!(got >= distance - allowed, "{skeleton:?} at {p}: {got} in f32, {distance} in f64");
            if skeleton.kink_distance(p) > 1e-4 {
                assert!(got <= distance + allowed, "{skeleton:?} at {p}: {got} in f32, {distance} in f64");
            }
        }
    }
}

/// Both forms give a known squared distance.
pub fn same_everywhere<S: SkeletonMember + Debug>(skeleton: &S, p: DVec3, expected: f64) {
    let plain = skeleton.distance_squared(p);
    assert!(
        (plain - expected).abs() <= 1e-14 * (1.0 + expected),
        "{skeleton:?} at {p}: {plain}, not {expected}"
    );
    let got = f64::from(emitted(skeleton, p));
    assert!(
        (got - expected).abs() <= 1e-6 * (1.0 + expected),
        "{skeleton:?} at {p}: {got} in f32, not {expected}"
    );
}

/// Judges random skeletons by samples of their sets; each point of a set is within `spacing` of a sample.
pub fn judge<S>(spacing: f64, mut make: impl FnMut(&mut fastrand::Rng) -> (S, Vec<DVec3>))
where
    S: SkeletonMember + PartialEq + Debug,
{
    let mut rng = fastrand::Rng::with_seed(2);
    for _ in 0..40 {
        let (skeleton, samples) = make(&mut rng);
        assert_eq!(S::from_fields(&skeleton.to_fields()), skeleton);
        assert_eq!(skeleton.to_fields().len(), S::FIELDS.len());
        bounds_hold(&skeleton, &samples, spacing, &mut rng);
        for i in 0..50 {
            let near =
                samples[rng.usize(..samples.len())] + direction(&mut rng) * 10f64.powf(1.0 - 6.0 * rng.f64());
            let p = if i % 2 == 0 { near } else { 2.0 * position(&mut rng) };
            // The same point for both forms: f32 coordinates are f64 coordinates.
            let p = p.as_vec3().as_dvec3();
            let distance = skeleton.distance_squared(p).sqrt();
            let sampled = samples.iter().map(|s| s.distance(p)).fold(f64::INFINITY, f64::min);
            assert!(
                distance <= sampled + 1e-9,
                "{skeleton:?} at {p}: {distance}, but a sample is {sampled} away"
            );
            assert!(
                sampled <= distance + spacing,
                "{skeleton:?} at {p}: {distance}, but no sample within {sampled}"
            );
            let got = f64::from(emitted(&skeleton, p)).sqrt();
            assert!(
                (got - distance).abs() <= 1e-6 * 10.0,
                "{skeleton:?} at {p}: {got} in f32, {distance} in f64"
            );
            let size = skeleton.bounds_under(&skeleton.pose().inverse());
            let size = size.min.abs().max(size.max.abs()).max_element();
            // The input point is off by half a unit along each axis.
            let allowed = (ROUNDING + 2f64.powi(-24)) * (size + distance) + 2f64.powi(-73);
            assert!(
                (got - distance).abs() <= allowed,
                "{skeleton:?} at {p}: {got} in f32, {distance} in f64"
            );
            scales(&skeleton, p, &mut rng);
        }
        for sample in samples.iter().step_by(97) {
            assert!(skeleton.distance_squared(*sample) < 1e-20, "{skeleton:?} does not hold {sample}");
        }
    }
}

/// Judges random points with a norm as their distance: `make` gives a skeleton, its point, and vectors of
/// norm 1.
pub fn judge_norm<S>(mut make: impl FnMut(&mut fastrand::Rng) -> (S, DVec3, Vec<DVec3>))
where
    S: SkeletonMember + PartialEq + Debug,
{
    let mut rng = fastrand::Rng::with_seed(3);
    for _ in 0..60 {
        let (skeleton, at, ways) = make(&mut rng);
        assert_eq!(S::from_fields(&skeleton.to_fields()), skeleton);
        assert_eq!(skeleton.to_fields().len(), S::FIELDS.len());
        assert_eq!(skeleton.distance_squared(at), 0.0);
        let metric = skeleton.metric();
        let turn = DMat3::from_quat(DQuat::from_axis_angle(direction(&mut rng), 6.0 * rng.f64()));
        for linear in [DMat3::IDENTITY, turn, turn * DMat3::from_diagonal(position(&mut rng))] {
            let around = Bounds::around(ways.iter().map(|&way| linear * way));
            let (reach, found) = (metric.reach(linear), around.max.max(-around.min));
            assert!((reach - found).min_element() >= -1e-9, "{skeleton:?} reaches {found} under {linear}");
            let half = (metric.half() - found).max_element();
            assert!(linear != DMat3::IDENTITY || half < 1e-9, "{skeleton:?}: {:?}", metric.half());
        }
        let close = |a: f64, b: f64, what: &str| {
            assert!((a - b).abs() <= 1e-9 * (1.0 + b), "{skeleton:?}: {a}, not {b}: {what}");
        };
        for &way in &ways {
            let length = 10f64.powf(3.0 * rng.f64() - 2.0);
            let distance = skeleton.distance_squared(at + length * way).sqrt();
            close(distance, length, "a level set");
            // Both forms at the same point: f32 coordinates are f64 coordinates.
            let p = (length * way).as_vec3().as_dvec3();
            let expected = skeleton.distance_squared(at + p).sqrt();
            let got = f64::from(emitted(&skeleton, at + p)).sqrt();
            let allowed = ROUNDING * expected + metric.steepness() * 2f64.powi(-24) * p.length();
            assert!(
                (got - expected).abs() <= allowed + 2f64.powi(-73),
                "{skeleton:?} at {p}: {got}, not {expected}"
            );
            let other = at + way + 0.1 * direction(&mut rng);
            let (moved, most) = (skeleton.distance_squared(other).sqrt() - 1.0, 0.1 * metric.steepness());
            assert!(moved.abs() <= most + 1e-9, "{skeleton:?}: {moved} in {most}");
            scales(&skeleton, at + length * way, &mut rng);
        }
    }
}

/// The bounds hold all samples, and not more than the samples need.
fn bounds_hold<S: SkeletonMember + Debug>(
    skeleton: &S,
    samples: &[DVec3],
    spacing: f64,
    rng: &mut fastrand::Rng,
) {
    let map = DAffine3::from_mat3_translation(
        DMat3::from_cols(direction(rng), direction(rng), direction(rng)),
        position(rng),
    );
    for map in [DAffine3::IDENTITY, map] {
        let stretch = map.matrix3.to_cols_array().iter().map(|x| x.abs()).sum::<f64>();
        let images = samples.iter().map(|sample| map.transform_point3(*sample));
        let (bounds, around) = (skeleton.bounds_under(&map), Bounds::around(images));
        let (low, high) = (around.min - bounds.min, bounds.max - around.max);
        for slack in [low, high] {
            assert!(slack.min_element() >= -1e-11, "{skeleton:?}: {bounds:?} does not hold {around:?}");
            assert!(
                slack.max_element() <= spacing * stretch,
                "{skeleton:?}: {bounds:?} is too large for {around:?}"
            );
        }
    }
}

/// Checks that a skeleton in its pose may be scaled, and turned by its symmetry.
pub fn scales<S: SkeletonMember + Debug>(skeleton: &S, p: DVec3, rng: &mut fastrand::Rng) {
    let pose = skeleton.pose();
    assert!(
        (pose.matrix3.transpose() * pose.matrix3).abs_diff_eq(DMat3::IDENTITY, 1e-12),
        "the pose is rigid"
    );
    let scale = 10f64.powf(2.0 * rng.f64() - 1.0);
    let (expected, got) = (skeleton.distance_squared(p).sqrt(), emitted_scaled(skeleton, scale, p).sqrt());
    assert!(
        (f64::from(got) - scale * expected).abs() <= 1e-5 * scale,
        "{skeleton:?} at {p}, {scale} times as large"
    );

    let turn = DMat3::from_quat(DQuat::from_axis_angle(direction(rng), 6.0 * rng.f64()));
    let mirror = DMat3::from_diagonal(DVec3::new(if rng.bool() { 1.0 } else { -1.0 }, 1.0, 1.0));
    let turn = turn * mirror;
    let simplest = S::SYMMETRY.simplest(turn);
    // The place of p in the pose after either turn.
    let there = pose.inverse().transform_point3(p);
    let other = (turn.transpose() * simplest) * there;
    let same = skeleton.distance_squared(pose.transform_point3(other));
    assert!(
        (same.sqrt() - expected).abs() <= 1e-9 * (1.0 + expected),
        "{skeleton:?} feels {turn} and not {simplest}"
    );
}

/// The uv in f32, of the compiler's form.
fn emitted_uv<S: SkeletonMember>(skeleton: &S, p: DVec3) -> [f32; 2] {
    let mut row = Vec::new();
    skeleton.uv_columns(&mut row);
    assert_eq!(row.len(), S::UV_COLUMNS.len(), "one number for each column");
    let row: Vec<f32> = row.into_iter().map(|x| x as f32).collect();
    let p = skeleton.uv_frame().inverse().transform_point3(p);
    S::emit_uv(&mut Scalar, p.as_vec3().to_array(), &row)
}

/// Both forms give a known uv.
pub fn same_uv<S: SkeletonMember + Debug>(skeleton: &S, p: DVec3, expected: [f64; 2]) {
    let (plain, got) = (skeleton.uv(p), emitted_uv(skeleton, p));
    for part in 0..2 {
        assert!(
            (plain[part] - expected[part]).abs() < 1e-12,
            "{skeleton:?} at {p}: {plain:?}, not {expected:?}"
        );
        let off = (f64::from(got[part]) - expected[part]).abs();
        assert!(off < 1e-6, "{skeleton:?} at {p}: {got:?} in f32, not {expected:?}");
    }
}

/// Both forms of the uv agree away from seams and are in [0, 1] everywhere; the frame is rigid; jumps are
/// where the kink distance is 0.
pub fn judge_uv<S: SkeletonMember + Debug>(mut make: impl FnMut(&mut fastrand::Rng) -> S) {
    let mut rng = fastrand::Rng::with_seed(4);
    for _ in 0..40 {
        let skeleton = make(&mut rng);
        let frame = skeleton.uv_frame().matrix3;
        assert!((frame.transpose() * frame).abs_diff_eq(DMat3::IDENTITY, 1e-12), "{skeleton:?}");
        assert!(frame.determinant() > 0.0, "{skeleton:?}");
        for _ in 0..200 {
            let p = 2.0 * position(&mut rng);
            let (plain, got) = (skeleton.uv(p), emitted_uv(&skeleton, p));
            let decision = skeleton.uv_kink_distance(p);
            let step = direction(&mut rng) * 1e-6;
            let near = skeleton.uv(p + step);
            for part in 0..2 {
                assert!((0.0..=1.0).contains(&plain[part]), "{skeleton:?} at {p}: {plain:?}");
                assert!((0.0..=1.0).contains(&got[part]), "{skeleton:?} at {p}: {got:?} in f32");
                if decision > 1e-2 {
                    let off = (f64::from(got[part]) - plain[part]).abs();
                    assert!(off < 1e-4, "{skeleton:?} at {p}: {got:?} in f32, {plain:?} in f64");
                    let jump = (near[part] - plain[part]).abs();
                    assert!(jump < 1e-3, "{skeleton:?} at {p}: {plain:?} jumps to {near:?}");
                }
            }
        }
    }
}
