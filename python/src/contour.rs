//! Contours of a model in a plane.

use std::io;
use std::path::PathBuf;

use jbt::contour::{Contour, Detail, Plane, Rectangle, SliceError, Slicer};
use jbt::export::AtomicFile;
use jbt::export::svg::{Style, write_svg};
use jbt::mesh::Attribute;
use jbt::{Classified, ErrorKind, Query};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{OrRaise as _, refused};
use crate::mesh::{fineness, matrix};
use crate::model::PyModel;
use crate::work::CallEffort;

/// A file could not be written.
#[derive(Debug)]
pub(crate) struct FileError {
    pub(crate) path: PathBuf,
    pub(crate) source: io::Error,
}

impl std::fmt::Display for FileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} cannot be written", self.path)
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

impl Classified for FileError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::System
    }
}

/// Writes a file whole or not at all.
pub(crate) fn written(
    path: PathBuf,
    write: impl FnOnce(&mut AtomicFile) -> io::Result<()>,
) -> Result<(), FileError> {
    let done = AtomicFile::create(&path, true).and_then(|mut file| {
        write(&mut file)?;
        file.finish()
    });
    done.map_err(|source| FileError { path, source })
}

#[pymethods]
impl PyModel {
    /// The contour in a plane: a dictionary. With a path it is also written as SVG.
    #[allow(clippy::too_many_arguments)]
    fn contour<'py>(
        &self,
        py: Python<'py>,
        plane: &str,
        rectangle: Option<[[f64; 2]; 2]>,
        resolution: Option<usize>,
        cell: Option<f64>,
        svg: Option<PathBuf>,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let plane: Plane = plane.parse().map_err(|error| refused(format!("plane: {error}")))?;
        let rectangle = rectangle.map(|[low, high]| Rectangle::new(low, high)).transpose();
        let rectangle = rectangle.or_raise(py)?;
        let detail = Detail { fineness: fineness(resolution, cell)?, ..Detail::default() };
        let compiled = self.compiled(py, None)?;
        let effort = CallEffort { py, threads, progress };
        let contour = effort.run(move |watch| -> Result<Contour, SliceError> {
            let slicer = Slicer::of(&compiled, &plane, Query::ATTRIBUTES)?;
            let rectangle = rectangle.map_or_else(|| slicer.rectangle(), Ok)?;
            watch.run(slicer.contour(&rectangle, &detail))
        })?;
        let dict = told(py, &contour, &plane)?;
        if let Some(path) = svg {
            let write = move |_: &_| written(path, |file| write_svg(&contour, &Style::default(), file));
            CallEffort::quiet(py).run(write)?;
        }
        Ok(dict)
    }
}

fn told<'py>(py: Python<'py>, contour: &Contour, plane: &Plane) -> PyResult<Bound<'py, PyDict>> {
    let [u, v] = contour.origin;
    let world = |&[a, b]: &[f32; 2]| [u + f64::from(a), v + f64::from(b)];
    let flat: Vec<[f64; 2]> = contour.positions.iter().map(world).collect();
    let space: Vec<[f64; 3]> = flat.iter().map(|&point| plane.point(point)).collect();
    let dict = PyDict::new(py);
    dict.set_item("positions", matrix(py, 2, flat.into_flattened())?)?;
    dict.set_item("points", matrix(py, 3, space.into_flattened())?)?;
    let attributes = PyDict::new(py);
    for Attribute { name, width, values } in &contour.attributes {
        attributes.set_item(name, matrix(py, *width, values.clone())?)?;
    }
    dict.set_item("attributes", attributes)?;
    let loops: Vec<_> = contour
        .loops
        .iter()
        .map(|one| (one.start, one.end, one.is_hole, one.parent, one.depth, one.area, one.length))
        .collect();
    dict.set_item("loops", loops)?;
    dict.set_item("cell", contour.cell)?;
    dict.set_item("cut_sides", contour.cut_sides)?;
    Ok(dict)
}
