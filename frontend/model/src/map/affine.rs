//! Any affine map, by its matrix.

use glam::{DAffine3, DMat3, DVec3};

use super::member::{Freedom, MapMember};
use crate::member::{Matrix, member};
use crate::report::Fault;

member! {
    /// Mapped by a 3x4 matrix that takes this tree's space to its parent's.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Affine = "affine" {
        /// The rows, the last column of which is the shift.
        pub rows: Matrix [Rows],
    }
}

impl MapMember for Affine {
    const NAMED: bool = false;
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(&self) -> Result<DAffine3, Fault> {
        let [[xx, xy, xz, x], [yx, yy, yz, y], [zx, zy, zz, z]] = self.rows;
        let columns = [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]];
        Ok(DAffine3 { matrix3: DMat3::from_cols_array_2d(&columns), translation: DVec3::new(x, y, z) })
    }
}
