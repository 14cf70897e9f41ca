//! What the tests of all skeletons have in common: every skeleton is judged by points of the set that it is.

use std::fmt::Debug;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use jbt_ir::domain::scalar::Scalar;

use super::{ROUNDING, SkeletonMember};
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

/// The compiler's form in f32: numbers are derived in f64 and rounded once. The point is brought to the pose in f64, so that it
/// is the form alone that is judged.
pub fn emitted<S: SkeletonMember>(skeleton: &S, p: DVec3) -> f32 {
    emitted_scaled(skeleton, 1.0, p)
}

/// The same of a skeleton that is `scale` times as large, asked at `scale * p`.
fn emitted_scaled<S: SkeletonMember>(skeleton: &S, scale: f64, p: DVec3) -> f32 {
    let mut row = Vec::new();
    skeleton.columns(scale, &mut row);
    assert_eq!(row.len(), S::COLUMNS.len(), "one number for each column");
    let row: Vec<f32> = row.into_iter().map(|x| x as f32).collect();
    let p = scale * skeleton.pose().inverse().transform_point3(p);
    S::emit(&mut Scalar, p.as_vec3().to_array(), &row)
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
            // The point that it was given is off by half a unit along each axis.
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

/// A skeleton in its pose may be scaled, and be turned as its symmetry says.
fn scales<S: SkeletonMember + Debug>(skeleton: &S, p: DVec3, rng: &mut fastrand::Rng) {
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
    // What is p's place in the skeleton's own pose, if it was turned in the one way or in the other?
    let there = pose.inverse().transform_point3(p);
    let other = (turn.transpose() * simplest) * there;
    let same = skeleton.distance_squared(pose.transform_point3(other));
    assert!(
        (same.sqrt() - expected).abs() <= 1e-9 * (1.0 + expected),
        "{skeleton:?} feels {turn} and not {simplest}"
    );
}
