//! Particles from arrays: one node, however many there are.

use jbt::Tree;
use jbt_model::particles::{NumberArray, PerParticle};
use jbt_model::written::{ParticleRadius, WrittenParticles};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::falloff::PyFalloff;
use crate::model::PyModel;

/// One number for all, or one for each.
fn each(array: &PyReadonlyArray1<'_, f64>, count: usize) -> PyResult<PerParticle<jbt::Number>> {
    let numbers = array.as_array().to_vec();
    match numbers.as_slice() {
        [one] => Ok(PerParticle::All((*one).into())),
        all if all.len() == count => Ok(PerParticle::Each(numbers.into())),
        _ => Err(PyValueError::new_err("expected one number for all particles, or one for each")),
    }
}

/// The numbers of rows, one row after the other.
fn flat(array: &PyReadonlyArray2<'_, f64>) -> Vec<f64> {
    array.as_array().iter().copied().collect()
}

/// A sum of points. The package has checked shapes and numbers.
#[pyfunction]
#[pyo3(signature = (places, radii, strengths, colors, falloff))]
pub(crate) fn points(
    py: Python<'_>,
    places: PyReadonlyArray2<'_, f64>,
    radii: PyReadonlyArray1<'_, f64>,
    strengths: PyReadonlyArray1<'_, f64>,
    colors: Option<PyReadonlyArray2<'_, f64>>,
    falloff: &Bound<'_, PyFalloff>,
) -> PyResult<PyModel> {
    let positions = flat(&places);
    let count = positions.len() / 3;
    let radius = ParticleRadius::Support(each(&radii, count)?);
    let strength = each(&strengths, count)?;
    let colors = colors.as_ref().map(flat);
    if colors.as_ref().is_some_and(|colors| colors.len() != 3 && colors.len() != 3 * count) {
        return Err(PyValueError::new_err("expected one colour for all particles, or one for each"));
    }
    let falloff = falloff.get().0.clone();
    Ok(py.detach(move || {
        let particles = WrittenParticles { strength, falloff, ..WrittenParticles::new(positions, radius) };
        let tree = Tree::new(particles, Vec::new());
        PyModel::of(match colors {
            Some(colors) if colors.len() == 3 => tree.color([colors[0], colors[1], colors[2]]),
            Some(colors) => tree.colors(NumberArray::from(colors)),
            None => tree,
        })
    }))
}
