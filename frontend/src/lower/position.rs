//! Where an occurrence stands: in which space its points are asked, and the affine map from there to its own space.
//!
//! Affine runs collapse into one matrix. What a row has to do to the point depends on the matrix:
//!
//! | map | numbers | work |
//! |---|---|---|
//! | identity | 0 | none |
//! | translation | 3 | 3 subtractions |
//! | scaling | 4 | 3 fused steps |
//! | full | 12 | 9 fused steps |

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::Domain;

/// How much of an affine map there is: what selects code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub(super) enum MapKind {
    Identity,
    Translation,
    Scaling,
    Full,
}

impl MapKind {
    /// The kind of the inverse of `map`, which is of the same kind.
    pub(super) fn of(map: &DAffine3) -> Self {
        let matrix = map.matrix3.to_cols_array();
        let scale = matrix[0];
        let uniform = [scale, 0.0, 0.0, 0.0, scale, 0.0, 0.0, 0.0, scale];
        if matrix != uniform {
            Self::Full
        } else if scale != 1.0 {
            Self::Scaling
        } else if map.translation != DVec3::ZERO {
            Self::Translation
        } else {
            Self::Identity
        }
    }

    /// The kind for a leaf, which is at least a translation: a primitive that passes the origin keeps its code.
    pub(super) fn of_leaf(map: &DAffine3) -> Self {
        match Self::of(map) {
            Self::Identity | Self::Translation => Self::Translation,
            Self::Scaling => Self::Scaling,
            Self::Full => Self::Full,
        }
    }

    /// Names of the columns that [`push_columns`](Self::push_columns) fills.
    pub(super) const fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Identity => &[],
            Self::Translation => &["tx", "ty", "tz"],
            Self::Scaling => &["scale", "tx", "ty", "tz"],
            Self::Full => &["xx", "xy", "xz", "xt", "yx", "yy", "yz", "yt", "zx", "zy", "zz", "zt"],
        }
    }

    /// The numbers of the inverse of `map`.
    pub(super) fn push_columns(self, map: &DAffine3, row: &mut Vec<f64>) {
        let inverse = self.inverse(map);
        match self {
            Self::Identity => {}
            Self::Translation => row.extend(map.translation.to_array()),
            Self::Scaling => {
                row.push(inverse.matrix3.x_axis.x);
                row.extend(inverse.translation.to_array());
            }
            Self::Full => {
                for axis in 0..3 {
                    row.extend(inverse.matrix3.row(axis).to_array());
                    row.push(inverse.translation[axis]);
                }
            }
        }
    }

    /// The inverse of `map`: its numbers are those of a row, before they are rounded.
    pub(super) fn inverse(self, map: &DAffine3) -> DAffine3 {
        match self {
            Self::Identity => DAffine3::IDENTITY,
            Self::Translation => DAffine3::from_translation(-map.translation),
            Self::Scaling => {
                let scale = 1.0 / map.matrix3.x_axis.x;
                DAffine3 {
                    matrix3: DMat3::from_diagonal(DVec3::splat(scale)),
                    translation: map.translation * -scale,
                }
            }
            Self::Full => map.inverse(),
        }
    }

    /// The point in the inner space.
    pub(super) fn emit<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        match self {
            Self::Identity => p,
            Self::Translation => std::array::from_fn(|axis| d.sub(p[axis], row[axis])),
            Self::Scaling => std::array::from_fn(|axis| d.fma(p[axis], row[0], row[1 + axis])),
            Self::Full => std::array::from_fn(|axis| {
                let row = &row[4 * axis..][..4];
                let x = d.fma(p[0], row[0], row[3]);
                let xy = d.fma(p[1], row[1], x);
                d.fma(p[2], row[2], xy)
            }),
        }
    }
}
