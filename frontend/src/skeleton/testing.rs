//! What the tests of all skeletons have in common: every skeleton is judged by points of the set that it is.

use std::fmt::Debug;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use jbt_ir::domain::scalar::Scalar;

use super::SkeletonMember;
use crate::affine::Similarity;
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

/// The row of a skeleton as the compiler stores it: derived in f64, rounded once.
pub fn row<S: SkeletonMember>(skeleton: &S) -> Vec<f32> {
    let mut row = Vec::new();
    skeleton.columns(&mut row);
    assert_eq!(row.len(), S::COLUMNS.len(), "one number for each column");
    row.into_iter().map(|x| x as f32).collect()
}

/// The compiler's form in f32.
pub fn emitted<S: SkeletonMember>(p: DVec3, row: &[f32]) -> f32 {
    S::emit(&mut Scalar, p.as_vec3().to_array(), row)
}

/// Both forms give a known squared distance.
pub fn same_everywhere<S: SkeletonMember + Debug>(skeleton: &S, p: DVec3, expected: f64) {
    let plain = skeleton.distance_squared(p);
    assert!(
        (plain - expected).abs() <= 1e-14 * (1.0 + expected),
        "{skeleton:?} at {p}: {plain}, not {expected}"
    );
    let got = f64::from(emitted::<S>(p, &row(skeleton)));
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
        bounds_hold(&skeleton, &samples, spacing);
        let row = row(&skeleton);
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
            let got = f64::from(emitted::<S>(p, &row)).sqrt();
            assert!(
                (got - distance).abs() <= 1e-6 * 10.0,
                "{skeleton:?} at {p}: {got} in f32, {distance} in f64"
            );
            moves(&skeleton, p, &mut rng);
        }
        for sample in samples.iter().step_by(97) {
            assert!(skeleton.distance_squared(*sample) < 1e-20, "{skeleton:?} does not hold {sample}");
        }
    }
}

/// The bounds hold all samples, and not more than the samples need.
fn bounds_hold<S: SkeletonMember + Debug>(skeleton: &S, samples: &[DVec3], spacing: f64) {
    let (bounds, around) = (skeleton.bounds(), Bounds::around(samples.iter().copied()));
    let (low, high) = (around.min - bounds.min, bounds.max - around.max);
    for slack in [low, high] {
        assert!(slack.min_element() >= -1e-12, "{skeleton:?}: {bounds:?} does not hold {around:?}");
        assert!(slack.max_element() <= spacing, "{skeleton:?}: {bounds:?} is too large for {around:?}");
    }
}

/// A moved skeleton is as far from a moved point, up to the scale. The map may mirror; some skeletons need it straight.
fn moves<S: SkeletonMember + Debug>(skeleton: &S, p: DVec3, rng: &mut fastrand::Rng) {
    let scale = 10f64.powf(2.0 * rng.f64() - 1.0);
    let mirror = DMat3::from_diagonal(DVec3::new(if rng.bool() { 1.0 } else { -1.0 }, 1.0, 1.0));
    let turn = DMat3::from_quat(DQuat::from_axis_angle(direction(rng), 6.0 * rng.f64()));
    let linear = if rng.bool() { turn * mirror } else { DMat3::IDENTITY };
    let map = DAffine3::from_mat3_translation(scale * linear, position(rng));
    let similarity = Similarity::from_affine(&map).expect("a similarity by construction");
    let Some(moved) = skeleton.moved(&similarity) else {
        assert!(!similarity.keeps_axes(), "every skeleton can be shifted and scaled");
        return;
    };
    let (here, there) =
        (skeleton.distance_squared(p).sqrt(), moved.distance_squared(similarity.point(p)).sqrt());
    assert!((there - scale * here).abs() <= 1e-9 * scale * (1.0 + here), "{skeleton:?} became {moved:?}");
}
