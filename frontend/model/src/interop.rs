//! Vectors and affine maps of other libraries: features `glam` and `mint`.
//!
//! glam is used inside of this crate whatever the features are; its types are in the interface of the builder
//! with the feature alone, because its
//! major versions move.

use crate::number::{Rows, Vector};

/// Vectors, by their coordinates.
macro_rules! vectors {
    ($($type:ty)+) => { $(
        impl From<$type> for Vector {
            fn from(vector: $type) -> Self {
                Self::from([vector.x, vector.y, vector.z])
            }
        }
    )+ };
}

#[cfg(feature = "glam")]
vectors! { glam::Vec3 glam::Vec3A glam::DVec3 glam::IVec3 }
#[cfg(feature = "mint")]
vectors! {
    mint::Vector3<f32> mint::Vector3<f64> mint::Vector3<i32>
    mint::Point3<f32> mint::Point3<f64> mint::Point3<i32>
}

/// Affine maps, by the three images of the axes and the shift.
#[cfg(feature = "glam")]
macro_rules! maps {
    ($($type:ty)+) => { $(
        impl From<$type> for Rows {
            fn from(map: $type) -> Self {
                let columns = map.to_cols_array_2d();
                Self::from([0, 1, 2].map(|row| columns.map(|column| column[row])))
            }
        }
    )+ };
}

#[cfg(feature = "glam")]
maps! { glam::Affine3A glam::DAffine3 }

#[cfg(feature = "mint")]
mod matrices {
    use mint::{ColumnMatrix3x4, RowMatrix3x4};

    use super::Rows;
    use crate::number::Number;

    impl<T: Into<Number>> From<RowMatrix3x4<T>> for Rows {
        fn from(map: RowMatrix3x4<T>) -> Self {
            Self::from([map.x, map.y, map.z].map(<[T; 4]>::from))
        }
    }

    impl<T: Into<Number> + Copy> From<ColumnMatrix3x4<T>> for Rows {
        fn from(map: ColumnMatrix3x4<T>) -> Self {
            let columns = [map.x, map.y, map.z, map.w].map(<[T; 3]>::from);
            Self::from([0, 1, 2].map(|row| columns.map(|column| column[row])))
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::builder::point;
    use crate::tree::Tree;

    fn ball() -> Tree {
        point([0; 3], 1)
    }

    #[cfg(feature = "glam")]
    #[test]
    fn glam_has_vectors_and_maps() {
        use glam::{Affine3A, DAffine3, DVec3, Vec3, Vec3A};
        let there = ball().translate([1, 2, 3]);
        assert_eq!(ball().translate(DVec3::new(1.0, 2.0, 3.0)), there);
        assert_eq!(ball().translate(Vec3::new(1.0, 2.0, 3.0)), there);
        assert_eq!(ball().translate(Vec3A::new(1.0, 2.0, 3.0)), there);
        let rows = ball().affine([[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]);
        let columns = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [5.0, 6.0, 7.0]];
        assert_eq!(ball().affine(DAffine3::from_cols_array_2d(&columns)), rows);
        let columns = columns.map(|column| column.map(|x| x as f32));
        assert_eq!(ball().affine(Affine3A::from_cols_array_2d(&columns)), rows);
    }

    #[cfg(feature = "mint")]
    #[test]
    fn mint_has_vectors_and_maps() {
        use mint::{ColumnMatrix3x4, Point3, RowMatrix3x4, Vector3};
        let there = ball().translate([1, 2, 3]);
        assert_eq!(ball().translate(Vector3::from([1.0, 2.0, 3.0])), there);
        assert_eq!(ball().translate(Point3::from([1.0f32, 2.0, 3.0])), there);
        let rows = ball().affine([[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]);
        let by_rows = RowMatrix3x4::from([[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]);
        assert_eq!(ball().affine(by_rows), rows);
        let by_columns = ColumnMatrix3x4::from([[0, 1, 0], [-1, 0, 0], [0, 0, 1], [5, 6, 7]]);
        assert_eq!(ball().affine(by_columns), rows);
    }
}
