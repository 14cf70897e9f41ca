//! Inverses of maps as rows have them, and what rounding does to the coordinates that they give. The
//! file above has the proof of the bounds.

use glam::{DAffine3, DMat3, DVec3};

use crate::position::MapKind;
use jbt_model::affine::Similarity;

/// Half a unit in the last place of 1 in f32.
pub(super) const HALF_UNIT: f64 = 1.0 / (1 << 24) as f64;
/// What a coordinate is off by, relative to the numbers that it is made of.
const UNITS: f64 = 6.0 * HALF_UNIT;

/// The inverse of a map, and what rounding does to the coordinates that it gives: `error <= relative |q| +
/// fixed`.
pub(super) struct Inverse {
    pub(super) back: DAffine3,
    pub(super) relative: DMat3,
    pub(super) fixed: DVec3,
}

impl Inverse {
    pub(super) fn new(kind: MapKind, map: &DAffine3) -> Self {
        LinearFacts::new(kind, map).inverse(map)
    }
}

/// What follows from the linear part of a map alone: found once for all particles of a node.
pub(super) struct LinearFacts {
    kind: MapKind,
    back: DMat3,
    /// The magnitudes of the inverse.
    rows: DMat3,
    relative: DMat3,
    /// The largest length of a row of the map.
    pub(super) longest: f64,
    /// Whether it leaves distances alone.
    pub(super) rigid: bool,
}

impl LinearFacts {
    pub(super) fn new(kind: MapKind, map: &DAffine3) -> Self {
        let back = kind.inverse(map).matrix3;
        let rows = absolute(back);
        let residual = back * map.matrix3 - DMat3::IDENTITY;
        let relative = match kind {
            MapKind::Identity => DMat3::ZERO,
            MapKind::Translation | MapKind::Scaling | MapKind::Full => {
                UNITS * (rows * absolute(map.matrix3)) + absolute(residual)
            }
        };
        let lengths = DVec3::from_array([0, 1, 2].map(|axis| map.matrix3.row(axis).length()));
        let rigid = Similarity::from_affine(map).is_some_and(|it| (it.scale() - 1.0).abs() < 1e-11);
        Self { kind, back, rows, relative, longest: lengths.max_element(), rigid }
    }

    /// The inverse of a map with this linear part.
    pub(super) fn inverse(&self, map: &DAffine3) -> Inverse {
        let translation = match self.kind {
            MapKind::Identity => {
                return Inverse { back: DAffine3::IDENTITY, relative: self.relative, fixed: DVec3::ZERO };
            }
            MapKind::Translation => -map.translation,
            MapKind::Scaling => map.translation * -self.back.x_axis.x,
            MapKind::Full => -(self.back * map.translation),
        };
        let shift = self.back * map.translation + translation;
        let size = self.rows * map.translation.abs() + translation.abs();
        Inverse {
            back: DAffine3 { matrix3: self.back, translation },
            relative: self.relative,
            fixed: UNITS * size + shift.abs() + 2f64.powi(-86),
        }
    }
}

pub(super) fn absolute(matrix: DMat3) -> DMat3 {
    DMat3::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs())
}
