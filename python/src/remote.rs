//! Parts of models and blocks of meshes, which other processes work on: as bytes.

use jbt::mesh::{self, Lattice, LatticeBlock, MeshBlock, MeshError, join_blocks};
use jbt::remote::{ModelPart, ModelRows, ModelShape, RowSource, from_rows};
use jbt::{Box3, Level, Polygonize, PolygonizeError, Query};
use numpy::IntoPyArray as _;
use numpy::ndarray::Array3;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{OrRaise as _, Refusal, refused};
use crate::mesh::{fineness, mesh_dict, region};
use crate::model::{PyModel, query_of};
use crate::work::{CallEffort, compiler};

/// The queries of meshes.
const MESH: [Query; 3] = [Query::FIELD, Query::GRADIENT, Query::SURFACE];

/// A lattice of points of the whole.
#[pyclass(frozen, module = "jbt._jbt", name = "Lattice")]
pub(crate) struct PyLattice(Lattice);

#[pymethods]
impl PyLattice {
    /// A lattice from its first corner, in coordinates about a model's origin.
    #[new]
    fn new(py: Python<'_>, origin: [f64; 3], spacing: f64, cells: [usize; 3]) -> PyResult<Self> {
        Ok(Self(Lattice::new(origin, spacing, cells).or_raise(py)?))
    }

    /// `(origin, spacing, cells)`.
    fn parts(&self) -> ([f64; 3], f64, [usize; 3]) {
        (self.0.origin(), self.0.spacing(), self.0.cells())
    }

    /// The closed box that a block looks at, for so much reach in cells.
    fn bounds(&self, edge: usize, place: [u32; 3], reach: usize) -> PyResult<([f32; 3], [f32; 3])> {
        let Box3 { low, high } = self.block(edge, place)?.bounds(&self.0, reach);
        Ok((low, high))
    }

    /// The closed box of points from a first one on.
    fn points(&self, first: [usize; 3], cells: [usize; 3]) -> ([f32; 3], [f32; 3]) {
        let at = |axis: usize, last: bool| {
            self.0.coordinate(axis, first[axis] + if last { cells[axis] } else { 0 })
        };
        ([0, 1, 2].map(|axis| at(axis, false)), [0, 1, 2].map(|axis| at(axis, true)))
    }
}

impl PyLattice {
    fn block(&self, edge: usize, place: [u32; 3]) -> PyResult<LatticeBlock> {
        LatticeBlock::new(&self.0, edge, place)
            .ok_or_else(|| refused(format!("there is no brick {place:?} of {edge} cells in this lattice")))
    }
}

#[pymethods]
impl PyModel {
    /// The lattice over a region, and the model's origin.
    fn lattice(
        &self,
        py: Python<'_>,
        resolution: Option<usize>,
        cell: Option<f64>,
        bounds: Option<[[f64; 3]; 2]>,
    ) -> PyResult<(PyLattice, [f64; 3])> {
        let fineness = fineness(resolution, cell)?;
        let settings = Polygonize { region: region(bounds)?, fineness, ..Polygonize::default() };
        let checked = self.checked(py)?;
        Ok((PyLattice(settings.lattice(&checked).or_raise(py)?), checked.origin().point()))
    }

    /// The bricks that the surface may cross, and boxes of 32 cells in each.
    fn busy(
        &self,
        py: Python<'_>,
        lattice: &PyLattice,
        edge: usize,
        threads: Option<usize>,
    ) -> PyResult<Vec<([u32; 3], u64)>> {
        let (compiled, lattice) = (self.compiled(py, None)?, lattice.0.clone());
        let effort = CallEffort { py, threads, progress: None };
        let work = effort
            .run(move |watch| watch.run(Polygonize::default().busy_blocks(&compiled, &lattice, edge)))?;
        Ok(work.into_iter().map(|one| (one.place, one.boxes)).collect())
    }
}

/// A whole model of which parts are taken.
#[pyclass(frozen, module = "jbt._jbt", name = "RowSource")]
pub(crate) struct PyRowSource(std::sync::Arc<RowSource>);

#[pymethods]
impl PyRowSource {
    /// Of a model: for meshes, or for samples of a query.
    #[new]
    #[pyo3(signature = (model, query=None))]
    fn new(py: Python<'_>, model: &PyModel, query: Option<(bool, bool)>) -> PyResult<Self> {
        let compiled = model.compiled(py, None)?;
        let queries = match query {
            Some((gradient, attributes)) => vec![query_of(gradient, attributes)],
            None => MESH.to_vec(),
        };
        let source = CallEffort::quiet(py).run(move |_| RowSource::new(&compiled, &queries))?;
        Ok(Self(std::sync::Arc::new(source)))
    }

    /// The shape of the whole.
    fn shape<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.0.shape().bytes())
    }

    /// The rows that matter in a closed box, and how many there are.
    fn rows<'py>(
        &self,
        py: Python<'py>,
        low: [f32; 3],
        high: [f32; 3],
    ) -> PyResult<(Bound<'py, PyBytes>, usize)> {
        let source = std::sync::Arc::clone(&self.0);
        let (bytes, count) = CallEffort::quiet(py).run(move |_| -> Result<_, Refusal> {
            let rows = source.rows(Box3::new(low, high))?;
            Ok((rows.to_bytes(), rows.len()))
        })?;
        Ok((PyBytes::new(py, &bytes), count))
    }
}

/// The shape of a whole model, checked.
#[pyclass(frozen, module = "jbt._jbt", name = "Shape")]
pub(crate) struct PyShape(ModelShape);

#[pymethods]
impl PyShape {
    #[new]
    fn new(py: Python<'_>, bytes: PyBackedBytes) -> PyResult<Self> {
        Ok(Self(CallEffort::quiet(py).run(move |_| ModelShape::from_bytes(&bytes))?))
    }

    fn fingerprint(&self) -> u64 {
        self.0.fingerprint()
    }

    /// The part of a brick's mesh, as bytes; or `None` if it needs rows of a larger reach.
    #[allow(clippy::too_many_arguments)]
    fn block<'py>(
        &self,
        py: Python<'py>,
        rows: PyBackedBytes,
        lattice: &PyLattice,
        edge: usize,
        place: [u32; 3],
        reach: usize,
        threads: Option<usize>,
    ) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let block = lattice.block(edge, place)?;
        let (shape, lattice) = (self.0.clone(), lattice.0.clone());
        let effort = CallEffort { py, threads, progress: None };
        let made = effort.run(move |watch| -> Result<_, Refusal> {
            let part = part(&shape, &rows)?;
            match watch.run(part.block(&lattice, block, reach)?) {
                Err(PolygonizeError::Mesh(MeshError::Reach { .. })) => Ok(None),
                made => Ok(Some(made?.to_bytes())),
            }
        })?;
        Ok(made.map(|bytes| PyBytes::new(py, &bytes)))
    }

    /// The answers at the points of some cells of a lattice: `(names, planes)`, with indices x, y and z.
    #[allow(clippy::too_many_arguments)]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        rows: PyBackedBytes,
        query: (bool, bool),
        lattice: &PyLattice,
        first: [usize; 3],
        cells: [usize; 3],
        threads: Option<usize>,
    ) -> PyResult<(Vec<String>, Vec<Bound<'py, PyAny>>)> {
        let lattice = lattice.0.part(first, cells).or_raise(py)?;
        let (shape, query, points) = (self.0.clone(), query_of(query.0, query.1), lattice.points());
        let effort = CallEffort { py, threads, progress: None };
        let (names, planes) = effort.run(move |watch| -> Result<_, Refusal> {
            let part = part(&shape, &rows)?;
            let sampler = part.sampler(query)?;
            let planes = watch.run(part.dense(&sampler, &lattice)?)?;
            Ok((sampler.evaluator().layout().names().to_vec(), planes))
        })?;
        let [nx, ny, nz] = points;
        let mut arrays = Vec::with_capacity(planes.len());
        for plane in planes {
            let array = Array3::from_shape_vec((nz, ny, nx), plane)
                .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
            arrays.push(array.reversed_axes().into_pyarray(py).into_any());
        }
        Ok((names, arrays))
    }
}

fn part(shape: &ModelShape, rows: &[u8]) -> Result<ModelPart, Refusal> {
    Ok(from_rows(compiler(None), shape, &ModelRows::from_bytes(rows)?)?)
}

/// What a block of a mesh tells: vertices, triangles, names of others' vertices, whether it has a rim, and
/// the sides of the lattice that cut the body.
#[pyfunction]
pub(crate) fn block_facts(
    py: Python<'_>,
    bytes: PyBackedBytes,
) -> PyResult<(usize, usize, usize, bool, String)> {
    let MeshBlock { mesh, below, is_open, cut_sides, .. } = MeshBlock::from_bytes(&bytes).or_raise(py)?;
    Ok((mesh.positions.len(), mesh.triangles.len(), below.len(), is_open, cut_sides.to_string()))
}

/// The mesh of blocks: a dictionary as a model's mesh has it.
#[pyfunction]
pub(crate) fn join(py: Python<'_>, blocks: Vec<PyBackedBytes>) -> PyResult<Bound<'_, PyDict>> {
    let (mesh, is_open, sides) = CallEffort::quiet(py).run(move |_| -> Result<_, Refusal> {
        let read: Result<Vec<MeshBlock>, _> =
            blocks.iter().map(|bytes| MeshBlock::from_bytes(bytes)).collect();
        let read = read?;
        drop(blocks);
        let mut sides = mesh::Sides::default();
        for block in &read {
            for axis in 0..3 {
                sides.low[axis] |= block.cut_sides.low[axis];
                sides.high[axis] |= block.cut_sides.high[axis];
            }
        }
        Ok((join_blocks(&read)?, read.iter().any(|block| block.is_open), sides))
    })?;
    let dict = mesh_dict(py, mesh)?;
    dict.set_item("closed", !is_open)?;
    dict.set_item("cut_sides", sides.to_string())?;
    Ok(dict)
}

/// What this CPU runs: the level of the instruction set.
#[pyfunction]
pub(crate) fn cpu_level() -> &'static str {
    Level::best().name()
}
