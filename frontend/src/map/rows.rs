//! Any affine map, by its matrix.

use glam::{DAffine3, DMat3, DVec3};

use super::member::{Freedom, MapMember, MapShape};
use crate::field::FieldValue;
use crate::report::Fault;

/// The rows of a 3x4 matrix, child to parent.
pub(super) struct Affine;

impl MapMember for Affine {
    const WORD: &'static str = "affine";
    const SHAPE: MapShape = MapShape::Rows;
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        let [xx, xy, xz, x, yx, yy, yz, y, zx, zy, zz, z] = values[0].reals()[..] else {
            unreachable!("rows are 12 numbers")
        };
        let columns = [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]];
        Ok(DAffine3 { matrix3: DMat3::from_cols_array_2d(&columns), translation: DVec3::new(x, y, z) })
    }
}
