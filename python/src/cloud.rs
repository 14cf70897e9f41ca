//! CloudArrays from arrays: one flat sum.

use jbt::Tree;
use jbt::tree::SkeletonKind;
use jbt_model::written::{FieldNumber, Radius, Written, WrittenAttribute};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::falloff::PyFalloff;
use crate::model::PyModel;

/// The arrays of particles: one number for all, or one for each.
struct CloudArrays {
    places: Vec<[f64; 3]>,
    radii: Vec<f64>,
    strengths: Vec<f64>,
    colors: Option<Vec<[f64; 3]>>,
}

/// One of few or of many.
fn of<T: Copy>(all: &[T], index: usize) -> T {
    if all.len() == 1 { all[0] } else { all[index] }
}

/// The tree of particles.
fn cloud(particles: &CloudArrays, falloff: &PyFalloff) -> Tree {
    let leaf = |index: usize| {
        let written = Written::Primitive {
            skeleton: SkeletonKind::Point,
            fields: vec![FieldNumber::Vector(particles.places[index].map(Into::into))],
            falloff: falloff.0.clone(),
            radius: Radius::Support(of(&particles.radii, index).into()),
            strength: of(&particles.strengths, index).into(),
        };
        let leaf = Tree::new(written, Vec::new());
        match &particles.colors {
            Some(colors) if colors.len() > 1 => colored(leaf, colors[index]),
            Some(_) | None => leaf,
        }
    };
    let sum: Tree = (0..particles.places.len()).map(leaf).sum();
    match particles.colors.as_deref() {
        Some([color]) => colored(sum, *color),
        Some(_) | None => sum,
    }
}

fn colored(tree: Tree, color: [f64; 3]) -> Tree {
    let value = WrittenAttribute::Numbers(color.map(Into::into).to_vec());
    Tree::new(Written::Attribute { name: "color".into(), value }, vec![tree])
}

/// Rows of three numbers.
fn triples(array: &PyReadonlyArray2<'_, f64>) -> Vec<[f64; 3]> {
    array.as_array().outer_iter().map(|row| [row[0], row[1], row[2]]).collect()
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
    let particles = CloudArrays {
        places: triples(&places),
        radii: radii.as_array().to_vec(),
        strengths: strengths.as_array().to_vec(),
        colors: colors.as_ref().map(triples),
    };
    let count = particles.places.len();
    let fits = |length: usize| length == 1 || length == count;
    let colors = particles.colors.as_ref().map_or(1, Vec::len);
    if ![particles.radii.len(), particles.strengths.len(), colors].into_iter().all(fits) {
        return Err(PyValueError::new_err("expected one number for all particles, or one for each"));
    }
    let falloff = falloff.get().clone();
    Ok(py.detach(move || PyModel::of(cloud(&particles, &falloff))))
}
