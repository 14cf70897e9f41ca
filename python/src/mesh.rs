//! Meshes: arrays that are given away to NumPy, and back again to be written.

use std::path::PathBuf;
use std::str::FromStr as _;

use jbt::export::{ColorEncoding, ExportError, ExportOptions, Format, Up, save_with};
use jbt::mesh::{Attribute, Creases, Mesh};
use jbt::{Box3, Engine, Fineness, Polygonize, Polygonized};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::constant::{constants_dict, constants_of};
use crate::error::refused;
use crate::model::{PyModel, engine_of, orientation_of};
use crate::work::CallEffort;

/// How fine a lattice is: by its cell, or by cells along the longest side.
pub(crate) fn fineness(resolution: Option<usize>, cell: Option<f64>) -> PyResult<Fineness> {
    match (resolution, cell) {
        (_, Some(cell)) if !(cell > 0.0 && cell.is_finite()) => {
            Err(refused(format!("cell: expected a finite number above 0, got {cell}")))
        }
        (_, Some(cell)) => Ok(Fineness::Cell(cell)),
        (Some(0), None) => Err(refused("resolution: expected 1 or more, got 0")),
        (Some(cells), None) => Ok(Fineness::Resolution(cells)),
        (None, None) => Ok(Fineness::default()),
    }
}

/// A box of the world.
pub(crate) fn region(given: Option<[[f64; 3]; 2]>) -> PyResult<Option<Box3<f64>>> {
    let Some([low, high]) = given else { return Ok(None) };
    let fine = (0..3).all(|axis| low[axis].is_finite() && high[axis].is_finite() && low[axis] < high[axis]);
    if !fine {
        return Err(refused(format!(
            "region: expected finite corners, each number of the first below that of the second, got {low:?} and {high:?}"
        )));
    }
    Ok(Some(Box3::new(low, high)))
}

/// Rows of a matrix, given away.
pub(crate) fn matrix<'py, T: numpy::Element>(
    py: Python<'py>,
    width: usize,
    values: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    let rows = values.len() / width;
    let array = Array2::from_shape_vec((rows, width), values)
        .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
    Ok(array.into_pyarray(py).into_any())
}

#[pymethods]
impl PyModel {
    /// The surface as triangles: a dictionary of arrays and of what it took.
    #[allow(clippy::too_many_arguments)]
    fn mesh<'py>(
        &self,
        py: Python<'py>,
        resolution: Option<usize>,
        cell: Option<f64>,
        bounds: Option<[[f64; 3]; 2]>,
        thin: bool,
        sharp: bool,
        engine: Option<&str>,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let settings = Polygonize {
            region: region(bounds)?,
            fineness: fineness(resolution, cell)?,
            thin_parts: thin,
            sharp,
            ..Polygonize::default()
        };
        let compiled = self.compiled(py, engine_of(engine)?)?;
        let effort = CallEffort { py, threads, progress };
        let dict = told(py, effort.run(move |watch| watch.run(settings.with(&compiled)))?)?;
        dict.set_item("constants", constants_dict(py, self.checked(py)?.constants())?)?;
        Ok(dict)
    }
}

/// The arrays of a mesh, given away.
pub(crate) fn mesh_dict(py: Python<'_>, mesh: Mesh) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("origin", mesh.origin)?;
    dict.set_item("up", mesh.orientation.up.name())?;
    dict.set_item("handed", mesh.orientation.handed.name())?;
    dict.set_item("vertices", matrix(py, 3, mesh.positions.into_flattened())?)?;
    dict.set_item("normals", matrix(py, 3, mesh.normals.into_flattened())?)?;
    dict.set_item("faces", matrix(py, 3, mesh.triangles.into_flattened())?)?;
    let attributes = PyDict::new(py);
    let names: Vec<(String, usize)> =
        mesh.attributes.iter().map(|attribute| (attribute.name.clone(), attribute.width)).collect();
    for Attribute { name, width, values } in mesh.attributes {
        attributes.set_item(name, matrix(py, width, values)?)?;
    }
    dict.set_item("attributes", attributes)?;
    dict.set_item("creases", creases_of(py, mesh.creases, &names)?)?;
    Ok(dict)
}

/// A mesh and what it took.
fn told(py: Python<'_>, made: Polygonized) -> PyResult<Bound<'_, PyDict>> {
    let Polygonized { mesh, report, lattice, engine, primitive_evaluations, compile_time, .. } = made;
    let dict = mesh_dict(py, mesh)?;
    dict.set_item("closed", report.closed)?;
    dict.set_item("cut_sides", report.cut_sides.to_string())?;
    dict.set_item("crowded", report.crowded)?;
    let thin = report.thin.as_ref();
    dict.set_item("thin_places", thin.map_or(0, |thin| thin.places))?;
    dict.set_item("thin_near", thin.map_or_else(Vec::new, |thin| thin.near.clone()))?;
    dict.set_item("thin_cell", thin.and_then(|thin| thin.cell))?;
    dict.set_item("field_evaluations", report.field_evaluations + report.jump_evaluations)?;
    dict.set_item("gradient_evaluations", report.gradient_evaluations)?;
    dict.set_item("full_evaluations", report.full_evaluations)?;
    dict.set_item("primitive_evaluations", primitive_evaluations)?;
    dict.set_item("lattice_origin", lattice.origin())?;
    dict.set_item("spacing", lattice.spacing())?;
    dict.set_item("cells", lattice.cells())?;
    dict.set_item("engine", Engine::name(engine))?;
    dict.set_item("compile_seconds", compile_time.as_secs_f64())?;
    Ok(dict)
}

/// The sides of edges, as arrays.
fn creases_of<'py>(
    py: Python<'py>,
    creases: Creases,
    attributes: &[(String, usize)],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("vertices", creases.vertices.into_pyarray(py))?;
    dict.set_item("normals", matrix(py, 3, creases.normals.into_flattened())?)?;
    dict.set_item("corners", matrix(py, 2, creases.corners.into_flattened())?)?;
    let values = PyDict::new(py);
    let mut planes = creases.attributes.into_iter();
    for (name, width) in attributes {
        values.set_item(name, matrix(py, *width, planes.next().unwrap_or_default())?)?;
    }
    dict.set_item("attributes", values)?;
    Ok(dict)
}

/// The sides of edges as arrays: vertices, normals, corners, values of each attribute.
type CreaseArrays<'py> = (
    PyReadonlyArray1<'py, u32>,
    PyReadonlyArray2<'py, f32>,
    PyReadonlyArray2<'py, u32>,
    Vec<PyReadonlyArray2<'py, f32>>,
);

/// The sides of edges from arrays, copied.
fn creases_from((vertices, normals, corners, attributes): &CreaseArrays<'_>) -> PyResult<Creases> {
    let corners = corners.as_array();
    if corners.ncols() != 2 {
        return Err(refused(format!("corners: expected the shape (n, 2), got {:?}", corners.shape())));
    }
    let values = |values: &PyReadonlyArray2<'_, f32>| values.as_array().iter().copied().collect();
    Ok(Creases {
        vertices: vertices.as_array().to_vec(),
        normals: triples("normals", normals)?,
        attributes: attributes.iter().map(values).collect(),
        corners: corners.outer_iter().map(|row| [row[0], row[1]]).collect(),
    })
}

/// Rows of three numbers, copied.
fn triples<T: numpy::Element + Copy>(name: &str, array: &PyReadonlyArray2<'_, T>) -> PyResult<Vec<[T; 3]>> {
    let view = array.as_array();
    if view.ncols() != 3 {
        return Err(refused(format!("{name}: expected the shape (n, 3), got {:?}", view.shape())));
    }
    Ok(view.outer_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// Writes a mesh, in the format that the ending of the path names or that is given. The file appears whole or
/// not at all.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn save_mesh(
    py: Python<'_>,
    path: PathBuf,
    origin: [f64; 3],
    orientation: (&str, &str),
    vertices: PyReadonlyArray2<'_, f32>,
    normals: PyReadonlyArray2<'_, f32>,
    faces: PyReadonlyArray2<'_, u32>,
    attributes: Vec<(String, PyReadonlyArray2<'_, f32>)>,
    creases: CreaseArrays<'_>,
    format: Option<&str>,
    up: Option<&str>,
    colors: Option<&str>,
    constants: Vec<(String, Vec<Bound<'_, PyAny>>)>,
) -> PyResult<()> {
    let attributes = attributes.into_iter().map(|(name, values)| {
        let values = values.as_array();
        Attribute { name, width: values.ncols(), values: values.iter().copied().collect() }
    });
    let mesh = Mesh {
        origin,
        orientation: orientation_of(orientation.0, orientation.1)?,
        positions: triples("vertices", &vertices)?,
        normals: triples("normals", &normals)?,
        attributes: attributes.collect(),
        triangles: triples("faces", &faces)?,
        parts: Vec::new(),
        creases: creases_from(&creases)?,
    };
    let word = |name: &str, given: &str, error: String| refused(format!("{name}: {given:?}: {error}"));
    let format = match format {
        Some(given) => {
            Some(Format::from_str(given).map_err(|error| word("format", given, error.to_string()))?)
        }
        None => Format::of(&path),
    };
    let options = ExportOptions {
        up: up.map(|given| Up::from_str(given).map_err(|e| word("up", given, e.to_string()))).transpose()?,
        colors: colors
            .map(|given| ColorEncoding::from_str(given).map_err(|e| word("colors", given, e.to_string())))
            .transpose()?,
        constants: vec![constants_of(constants)?],
        ..ExportOptions::default()
    };
    CallEffort::quiet(py).run(move |_| match format {
        Some(format) => save_with(&path, &mesh, format, &options),
        None => Err(ExportError::Extension { path }),
    })
}
