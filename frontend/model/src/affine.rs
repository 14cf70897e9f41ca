//! Affine maps and the cheaper kinds among them.
//!
//! A node's map takes the child's space to the parent's: `parent = linear * child + translation`, column
//! vectors, right-handed, `linear` stored by columns (glam's layout). Evaluation goes the other way, by the
//! inverse.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::bounds::Bounds;

/// The identity map.
pub const IDENTITY: DAffine3 = DAffine3::IDENTITY;

/// The linear part of a similarity, which is a rotation (or reflection), uniform scale and translation: it
/// multiplies all distances by `scale`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Similarity {
    scale: f64,
    turn: DMat3,
}

impl Similarity {
    /// The map as a similarity, if it is one to within 1e-12 of its size.
    #[must_use]
    pub fn from_affine(map: &DAffine3) -> Option<Self> {
        if map.matrix3 == DMat3::IDENTITY {
            return Some(Self { scale: 1.0, turn: DMat3::IDENTITY });
        }
        let gram = map.matrix3.transpose() * map.matrix3;
        let square = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
        let near = gram.abs_diff_eq(DMat3::from_diagonal(DVec3::splat(square)), 1e-12 * square);
        (near && square > 0.0).then(|| {
            let scale = square.sqrt();
            Self { scale, turn: map.matrix3 * (1.0 / scale) }
        })
    }

    /// The factor of all lengths.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The rotation or reflection, with the scale taken out.
    #[must_use]
    pub fn turn(&self) -> &DMat3 {
        &self.turn
    }
}

/// The map that scales first, then rotates by the quaternion (normalised here), then translates.
#[must_use]
pub fn scale_rotate_translate(scale: DVec3, rotation: DQuat, translation: DVec3) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(scale, rotation.normalize(), translation)
}

/// The smallest box around the image of a box, which may be unbounded.
#[must_use]
pub fn map_bounds(map: &DAffine3, bounds: Bounds) -> Bounds {
    if bounds.is_empty() {
        return Bounds::EMPTY;
    }
    let (mut min, mut max) = (map.translation, map.translation);
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    for (axis, column) in columns.into_iter().enumerate() {
        for to in 0..3 {
            // Left out where the factor is zero: zero times an infinite side is zero, not NaN.
            if column[to] != 0.0 {
                let (a, b) = (column[to] * bounds.min[axis], column[to] * bounds.max[axis]);
                min[to] += a.min(b);
                max[to] += a.max(b);
            }
        }
    }
    Bounds::new(min, max)
}

/// Sine and cosine of an angle in degrees; exact for quarter turns.
#[must_use]
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let quarters = degrees / 90.0;
    if quarters.fract() != 0.0 {
        return degrees.to_radians().sin_cos();
    }
    match quarters.rem_euclid(4.0) as u8 {
        0 => (0.0, 1.0),
        1 => (1.0, 0.0),
        2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}

/// The rotation about a unit vector by the angle with this sine and cosine, right-handed (Rodrigues 1840).
#[must_use]
pub fn rotation(axis: DVec3, (sin, cos): (f64, f64)) -> DMat3 {
    DMat3::from_cols_array_2d(&[0, 1, 2].map(|column| {
        let e = DVec3::AXES[column];
        (cos * e + sin * axis.cross(e) + (1.0 - cos) * axis[column] * axis).to_array()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let quarter = rotation(DVec3::Z, sin_cos_degrees(90.0));
        assert_eq!(quarter * DVec3::X, DVec3::Y);
        assert_eq!(rotation(DVec3::X, sin_cos_degrees(-270.0)) * DVec3::Y, DVec3::Z);
        assert_eq!(rotation(DVec3::Y, sin_cos_degrees(540.0)) * DVec3::X, -DVec3::X);
    }

    #[test]
    fn a_third_of_a_turn_about_the_diagonal_exchanges_the_axes() {
        let turn = rotation(DVec3::ONE.normalize(), sin_cos_degrees(120.0));
        assert!((turn * DVec3::X).abs_diff_eq(DVec3::Y, 1e-15));
    }
}
