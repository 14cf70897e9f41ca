//! The set that a model encloses: how far it reaches, how large it is, who decides where.

use jbt::diagnostic::Span;
use jbt::solid::{Measure, Solid};
use jbt::tree::{LeafConstant, WeightOf};
use jbt::{Box3, Query};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::constant::object;
use crate::error::{OrRaise as _, Refusal, refused};
use crate::evaluator::PyEvaluator;
use crate::mesh::{fineness, region};
use crate::model::PyModel;
use crate::work::{CallEffort, compiler};

/// The smallest and the largest corner of a box, in the world.
type WorldCorners = ([f64; 3], [f64; 3]);

#[pymethods]
impl PyModel {
    /// A box around the solid, in the world; `None` if it is empty. The second part says whether every side
    /// is within the tolerance.
    fn tight_bounds(
        &self,
        py: Python<'_>,
        tolerance: f32,
        bounds: Option<[[f64; 3]; 2]>,
    ) -> PyResult<(Option<WorldCorners>, bool)> {
        let compiled = self.compiled(py, None)?;
        let origin = compiled.origin();
        let local = region(bounds)?.map(|bounds| bounds.map(|corner| origin.rounded(corner)));
        let found = CallEffort::quiet(py).run(move |_| -> Result<_, Refusal> {
            Ok(Solid::of(&compiled)?.tight_bounds(local, tolerance)?)
        })?;
        let world = |corner: [f32; 3]| origin.world(corner.map(f64::from));
        let outer = found.outer.map(|Box3 { low, high }| (world(low), world(high)));
        Ok((outer, found.converged))
    }

    /// Volume, area and centre of mass: a dictionary.
    fn measure<'py>(
        &self,
        py: Python<'py>,
        resolution: Option<usize>,
        cell: Option<f64>,
        bounds: Option<[[f64; 3]; 2]>,
        threads: Option<usize>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let compiled = self.compiled(py, None)?;
        let origin = compiled.origin();
        let local = region(bounds)?.map(|bounds| bounds.map(|corner| origin.rounded(corner)));
        let settings = Measure { region: local, fineness: fineness(resolution, cell)? };
        let effort = CallEffort { py, threads, progress };
        let made = effort.run(move |watch| -> Result<_, Refusal> {
            let solid = Solid::of(&compiled)?;
            Ok(watch.run(solid.measure(&settings))?)
        })?;
        let dict = PyDict::new(py);
        dict.set_item("volume", made.volume.estimate)?;
        dict.set_item("least", made.volume.low)?;
        dict.set_item("most", made.volume.high)?;
        dict.set_item("area", made.area)?;
        dict.set_item("center", made.center)?;
        dict.set_item("cell", made.cell)?;
        Ok(dict)
    }

    /// Who decides at points: arrays of nodes (-1 for nobody) and shares, and paths and lines of the nodes.
    fn owner<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let view = points.as_array();
        if view.ncols() != 3 {
            return Err(refused(format!("points: expected the shape (n, 3), got {:?}", view.shape())));
        }
        let points: Vec<[f64; 3]> = view.outer_iter().map(|row| [row[0], row[1], row[2]]).collect();
        let tree = self.checked(py)?;
        let source = tree.diagnostics(Vec::new()).source_text().cloned();
        let effort = CallEffort { py, threads, progress: None };
        let found = effort.run(move |watch| -> Result<_, Refusal> {
            let each = |point: &[f64; 3]| {
                let found = (!watch.is_stopped()).then(|| jbt_model::owner::owner(&tree, *point)).flatten();
                found.map(|owner| {
                    let constants = owner.constants(&tree).into_iter();
                    let constants = constants.map(|(name, value)| (name.to_owned(), value.clone())).collect();
                    let path = owner.path(&tree);
                    let (node, particle) = (owner.node.0, owner.particle as i64);
                    FoundOwner { node, particle, share: owner.share, path, span: owner.span, constants }
                })
            };
            Ok(points.par_iter().map(each).collect::<Vec<_>>())
        })?;
        let line = |span: Option<Span>| {
            source
                .as_ref()
                .zip(span)
                .map_or(0, |(source, span)| source.source().position(span.start as usize).0)
        };
        owners_dict(py, found, line)
    }

    /// What answers the weights of leaves, or of what has these paths, and behind them that of nobody.
    fn weights(&self, py: Python<'_>, paths: Option<Vec<String>>) -> PyResult<PyEvaluator> {
        let of_leaves = vec![WeightOf::Leaves];
        let asked = paths.as_ref().map(|paths| paths.iter().map(|path| WeightOf::Named(path)).collect());
        let asked: Vec<WeightOf<'_>> = asked.unwrap_or(of_leaves);
        let mut tree = self.checked(py)?;
        let declared = tree.attributes().len();
        for of in asked.into_iter().chain([WeightOf::Default]) {
            tree = tree.with_weights(of).or_raise(py)?;
        }
        // Others go last: ways to leaves have the nodes that give them.
        let added: Vec<_> = tree.attributes()[declared..].iter().map(|group| group.name.clone()).collect();
        let tree = tree.of_attributes(&added).or_raise(py)?;
        let compiled = compiler(None).compile(&tree);
        let made = CallEffort::quiet(py).run(move |_| compiled.evaluator(Query::ATTRIBUTES))?;
        Ok(PyEvaluator::new(made, tree))
    }

    /// What answers the field in the numbers that decide sides: as [`compile`](Self::compile) of the field.
    fn sides(&self, py: Python<'_>) -> PyResult<PyEvaluator> {
        let compiled = self.compiled(py, None)?;
        let made = CallEffort::quiet(py).run(move |_| compiled.evaluator(Query::FIELD))?;
        Ok(PyEvaluator::new(made, self.checked(py)?))
    }
}

/// The leaf that decides at a point.
struct FoundOwner {
    node: u32,
    particle: i64,
    share: f64,
    path: String,
    span: Option<Span>,
    constants: Vec<(String, LeafConstant)>,
}

/// A dictionary of who decides at points. `line` is that of a place.
fn owners_dict(
    py: Python<'_>,
    found: Vec<Option<FoundOwner>>,
    line: impl Fn(Option<Span>) -> usize,
) -> PyResult<Bound<'_, PyDict>> {
    let leaf = found.iter().map(|one| one.as_ref().map_or(-1, |one| i64::from(one.node))).collect();
    let particle = found.iter().map(|one| one.as_ref().map_or(-1, |one| one.particle)).collect();
    let share = found.iter().map(|one| one.as_ref().map_or(0.0, |one| one.share)).collect();
    let lines = found.iter().map(|one| one.as_ref().map_or(0, |one| line(one.span) as i64)).collect();
    let dict = PyDict::new(py);
    dict.set_item("leaf", PyArray1::<i64>::from_vec(py, leaf))?;
    dict.set_item("particle", PyArray1::<i64>::from_vec(py, particle))?;
    dict.set_item("share", PyArray1::<f64>::from_vec(py, share))?;
    dict.set_item("line", PyArray1::<i64>::from_vec(py, lines))?;
    let mut paths = Vec::new();
    let mut constants = Vec::new();
    for one in found {
        let (path, of_leaf) = one.map(|one| (one.path, one.constants)).unzip();
        paths.push(path);
        let told = PyDict::new(py);
        for (name, value) in of_leaf.into_iter().flatten() {
            told.set_item(name, object(py, value)?)?;
        }
        constants.push(told);
    }
    dict.set_item::<_, Vec<Option<String>>>("path", paths)?;
    dict.set_item("constants", constants)?;
    Ok(dict)
}
