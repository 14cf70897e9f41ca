//! Coordinates as arrays of NumPy: one array of one dimension for each of x, y and z, of f32 or f64, with any
//! stride. A matrix of points is three such views.

use jbt::ModelOrigin;
use numpy::ndarray::ArrayView1;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods as _};
use pyo3::prelude::*;

use crate::error::refused;

/// An array of coordinates along an axis, borrowed from Python.
#[derive(FromPyObject)]
pub(crate) enum Coordinates<'py> {
    #[pyo3(transparent)]
    Single(PyReadonlyArray1<'py, f32>),
    #[pyo3(transparent)]
    Double(PyReadonlyArray1<'py, f64>),
}

/// Coordinates that threads may read.
#[derive(Clone, Copy)]
pub(crate) enum PointColumn<'a> {
    /// As kernels take them.
    Plane(&'a [f32]),
    Single(ArrayView1<'a, f32>),
    Double(ArrayView1<'a, f64>),
}

impl Coordinates<'_> {
    fn count(&self) -> usize {
        match self {
            Self::Single(array) => array.len(),
            Self::Double(array) => array.len(),
        }
    }

    fn column(&self) -> PointColumn<'_> {
        match self {
            Self::Single(array) => match array.as_slice() {
                Ok(plane) => PointColumn::Plane(plane),
                Err(_) => PointColumn::Single(array.as_array()),
            },
            Self::Double(array) => PointColumn::Double(array.as_array()),
        }
    }
}

impl PointColumn<'_> {
    /// Writes coordinates from `start` on, about an origin: moved in f64 and rounded once.
    fn copy_to(&self, start: usize, origin: f64, plane: &mut [f32]) {
        let end = start + plane.len();
        match self {
            Self::Plane(all) => copy(all[start..end].iter().copied(), origin, plane),
            Self::Single(all) => copy((start..end).map(|index| all[index]), origin, plane),
            Self::Double(all) => {
                plane.iter_mut().zip(start..end).for_each(|(x, index)| *x = (all[index] - origin) as f32);
            }
        }
    }

    /// One coordinate.
    pub(crate) fn at(&self, index: usize) -> f64 {
        match self {
            Self::Plane(all) => f64::from(all[index]),
            Self::Single(all) => f64::from(all[index]),
            Self::Double(all) => all[index],
        }
    }
}

fn copy(from: impl Iterator<Item = f32>, origin: f64, plane: &mut [f32]) {
    if origin == 0.0 {
        plane.iter_mut().zip(from).for_each(|(x, value)| *x = value);
    } else {
        plane.iter_mut().zip(from).for_each(|(x, value)| *x = (f64::from(value) - origin) as f32);
    }
}

/// The columns of points, and how many there are.
pub(crate) fn columns<'a>(given: &'a [Coordinates<'_>; 3]) -> PyResult<([PointColumn<'a>; 3], usize)> {
    let counts = given.each_ref().map(Coordinates::count);
    if counts != [counts[0]; 3] {
        let [x, y, z] = counts;
        return Err(refused(format!("points: expected as many x, y and z, got {x}, {y} and {z}")));
    }
    Ok((given.each_ref().map(Coordinates::column), counts[0]))
}

/// The planes as they are, if nothing has to be copied or moved.
pub(crate) fn planes<'a>(columns: &[PointColumn<'a>; 3], origin: ModelOrigin) -> Option<[&'a [f32]; 3]> {
    match columns {
        [PointColumn::Plane(x), PointColumn::Plane(y), PointColumn::Plane(z)] if origin.is_world() => {
            Some([x, y, z])
        }
        _ => None,
    }
}

/// Writes points from `start` on into planes, about an origin.
pub(crate) fn copy_to(
    columns: &[PointColumn<'_>; 3],
    start: usize,
    origin: ModelOrigin,
    planes: [&mut [f32]; 3],
) {
    for ((column, plane), origin) in columns.iter().zip(planes).zip(origin.point()) {
        column.copy_to(start, origin, plane);
    }
}
