//! The answers at all points of a lattice.

use jbt::Polygonize;
use jbt::sample::Sampler;
use numpy::IntoPyArray as _;
use numpy::ndarray::Array3;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::Refusal;
use crate::mesh::{fineness, region};
use crate::model::{PyModel, query_of};
use crate::work::CallEffort;

#[pymethods]
impl PyModel {
    /// The answers at the points of a lattice: `(names, groups, arrays, origin, spacing)`. The arrays have an
    /// index for x, then y, then z, of which x is the fastest in memory.
    #[allow(clippy::too_many_arguments)]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        gradient: bool,
        attributes: bool,
        resolution: Option<usize>,
        cell: Option<f64>,
        bounds: Option<[[f64; 3]; 2]>,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let settings = Polygonize {
            region: region(bounds)?,
            fineness: fineness(resolution, cell)?,
            ..Polygonize::default()
        };
        let query = query_of(gradient, attributes);
        let compiled = self.compiled(py, None)?;
        let effort = CallEffort { py, threads, progress };
        let (lattice, planes, layout, origin) = effort.run(move |watch| -> Result<_, Refusal> {
            let lattice = settings.lattice(compiled.tree())?;
            let sampler = Sampler::of(&compiled, query)?;
            let planes = watch.run(sampler.dense(&lattice))?;
            Ok((lattice, planes, sampler.evaluator().layout().clone(), compiled.origin()))
        })?;
        let [nx, ny, nz] = lattice.points();
        let mut arrays = Vec::with_capacity(planes.len());
        for plane in planes {
            let array = Array3::from_shape_vec((nz, ny, nx), plane)
                .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
            arrays.push(array.reversed_axes().into_pyarray(py));
        }
        let dict = PyDict::new(py);
        dict.set_item("names", layout.names())?;
        let groups: Vec<(String, usize, usize)> =
            layout.attributes().map(|(name, first, width)| (name.to_owned(), first, width)).collect();
        dict.set_item("groups", groups)?;
        dict.set_item("planes", arrays)?;
        dict.set_item("origin", origin.world(lattice.origin()))?;
        dict.set_item("spacing", lattice.spacing())?;
        Ok(dict)
    }
}
