//! Building blocks of the uv of skeletons: angles as parts of a turn, and frames.
//!
//! Every skeleton gives each place of space two numbers in [0, 1]: the coordinates of the place *on the
//! skeleton*, by the skeleton's own parameters. They are finite everywhere.
//! [`SkeletonMember::uv_kink_distance`](super::SkeletonMember::uv_kink_distance) says where they jump: at
//! seams, poles and axes.
//!
//! Angles about an axis n start at the *zero direction*: the x axis without its part along n, or the y axis
//! where n is closer than about 26 degrees to x (|n.x| > 0.9). They go right-handed about n. So a picture
//! stays in place when other numbers of the skeleton change. The frame of the skeleton has n as its z axis
//! and the zero direction as its x axis.
//!
//! Rotations that leave distances unchanged change the uv, so the uv has a frame of its own beside the pose.

use std::f64::consts::TAU;

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::{Domain, limits};

use super::formulas::emit_unit;

/// The frame about the unit vector `n` at `origin`: see the module.
pub(super) fn frame(n: DVec3, origin: DVec3) -> DAffine3 {
    let zero = if n.x.abs() > 0.9 { DVec3::Y } else { DVec3::X };
    let x = (zero - zero.dot(n) * n).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, n.cross(x), n), origin)
}

/// A place in the coordinates of a rigid frame.
pub(super) fn within(frame: &DAffine3, p: DVec3) -> DVec3 {
    frame.matrix3.transpose() * (p - frame.translation)
}

/// `1 / length`, and 0 for a length below [`limits::MIN_LENGTH`].
pub(super) fn inverse(length: f64) -> f64 {
    if length < limits::MIN_LENGTH { 0.0 } else { 1.0 / length }
}

/// The angle of (x, y) from the x axis to the y axis, as a part of a turn: from 0 to 1. At (0, 0) it is 0.
pub(super) fn turn(x: f64, y: f64) -> f64 {
    let part = y.atan2(x) / TAU;
    if part < 0.0 { part + 1.0 } else { part }
}

/// The distance of (x, y) from the jump of [`turn`]: the positive x axis.
pub(super) fn turn_kink_distance(x: f64, y: f64) -> f64 {
    if x > 0.0 { y.abs() } else { x.hypot(y) }
}

/// The uv of a ball: longitude about the z axis, and latitude from 0 at -z to 1 at +z. In the middle it is
/// (0, 1/2).
pub(super) fn sphere(p: DVec3) -> [f64; 2] {
    [turn(p.x, p.y), 0.5 + 2.0 * p.z.atan2(p.x.hypot(p.y)) / TAU]
}

/// The distance of `p` from the jumps of [`sphere`].
pub(super) fn sphere_kink_distance(p: DVec3) -> f64 {
    turn_kink_distance(p.x, p.y)
}

/// [`sphere`] over the ops.
pub(super) fn emit_sphere<D: Domain>(d: &mut D, p: [D::Real; 3]) -> [D::Real; 2] {
    let rho = super::emit_off_axis(d, p);
    let up = d.abs(p[2]);
    let latitude = emit_first_quarter(d, rho, up);
    let (zero, two, half) = (d.constant(0.0), d.constant(2.0), d.constant(0.5));
    let below = d.lt(p[2], zero);
    let minus = d.neg(latitude);
    let latitude = d.select(below, minus, latitude);
    let v = d.fma(latitude, two, half);
    [emit_turn(d, p[0], p[1]), v]
}

/// `atan(q) / (2 pi q)` in q^2, for q in [0, 1]: the error of the angle is below 1.5e-8 of a turn. Fitted by
/// iterated least squares (Lawson 1961).
const ATAN: [f32; 8] = [
    0.159_154_93,
    -0.053_049_67,
    0.031_785_43,
    -0.022_328_51,
    0.015_824_39,
    -0.009_534_13,
    0.003_908_39,
    -0.000_760_83,
];

/// [`turn`] for x and y of at least 0: from 0 to 1/4.
fn emit_first_quarter<D: Domain>(d: &mut D, x: D::Real, y: D::Real) -> D::Real {
    let (small, large) = (d.min(x, y), d.max(x, y));
    let (zero, quarter) = (d.constant(0.0), d.constant(0.25));
    let ratio = d.div(small, large);
    // False for NaN: 0 / 0 and, at infinitely far points, inf / inf.
    let sound = d.le(ratio, ratio);
    let q = d.select(sound, ratio, zero);
    let square = d.mul(q, q);
    let mut sum = d.constant(ATAN[ATAN.len() - 1]);
    for &coefficient in ATAN.iter().rev().skip(1) {
        let coefficient = d.constant(coefficient);
        sum = d.fma(sum, square, coefficient);
    }
    let angle = d.mul(sum, q);
    let steep = d.lt(x, y);
    let rest = d.sub(quarter, angle);
    d.select(steep, rest, angle)
}

/// [`turn`] over the ops.
pub(super) fn emit_turn<D: Domain>(d: &mut D, x: D::Real, y: D::Real) -> D::Real {
    let (zero, half, one) = (d.constant(0.0), d.constant(0.5), d.constant(1.0));
    let (across, up) = (d.abs(x), d.abs(y));
    let angle = emit_first_quarter(d, across, up);
    let left = d.lt(x, zero);
    let rest = d.sub(half, angle);
    let angle = d.select(left, rest, angle);
    let below = d.lt(y, zero);
    let rest = d.sub(one, angle);
    d.select(below, rest, angle)
}

/// `x * factor + offset`, between 0 and 1.
pub(super) fn emit_ramp<D: Domain>(d: &mut D, x: D::Real, factor: D::Real, offset: f32) -> D::Real {
    let offset = d.constant(offset);
    let t = d.fma(x, factor, offset);
    emit_unit(d, t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jbt_ir::domain::scalar::Scalar;

    #[test]
    fn angles_all_round() {
        for i in 0..10_000 {
            let angle = f64::from(i) / 10_000.0 * TAU;
            let (x, y) = ((3.0 * angle.cos()) as f32, (3.0 * angle.sin()) as f32);
            let got = f64::from(emit_turn(&mut Scalar, x, y));
            let expected = turn(f64::from(x), f64::from(y));
            assert!((got - expected).abs() < 2e-7, "{got}, not {expected}");
            assert!((0.0..=1.0).contains(&got));
        }
        assert_eq!(turn(0.0, 0.0), 0.0);
    }

    #[test]
    fn hostile_places_have_numbers() {
        let hostile = [0.0, -0.0, 1e-45, -1e-45, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        for x in hostile {
            for y in hostile {
                for z in hostile {
                    for part in emit_sphere(&mut Scalar, [x, y, z]) {
                        assert!((0.0..=1.0).contains(&part), "{part} at {x} {y} {z}");
                    }
                }
            }
        }
    }

    #[test]
    fn frames_are_right_handed_and_keep_their_zero() {
        for n in [DVec3::Z, DVec3::NEG_Z, DVec3::Y, DVec3::new(0.6, 0.0, 0.8)] {
            let frame = frame(n, DVec3::ONE);
            assert!((frame.matrix3.determinant() - 1.0).abs() < 1e-12);
            assert!(frame.matrix3.x_axis.dot(DVec3::X) > 0.0);
            assert!(within(&frame, DVec3::ONE + 2.0 * n).abs_diff_eq(DVec3::new(0.0, 0.0, 2.0), 1e-12));
        }
        assert_eq!(frame(DVec3::X, DVec3::ZERO).matrix3.x_axis, DVec3::Y);
    }
}
