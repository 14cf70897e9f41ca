//! Models: a tree and what its field means, and what was compiled of it.

use std::sync::{Arc, OnceLock};

use jbt::{
    AttributeGroup, CheckedTree, Compiled, Engine, GroupKind, Mixing, Query, Scene, SceneFolder, Tree,
};
use jbt_model::model::Model;
use jbt_model::orientation::{Handed, ModelUp, Orientation};
use jbt_model::word::normalized;
use jbt_text::Options;
use jbt_text::files::Files;
use pyo3::prelude::*;

use crate::error::{OrRaise as _, Refusal, refused};
use crate::evaluator::PyEvaluator;
use crate::number::{PyNumber, number_of};
use crate::work::{CallEffort, compiler};

/// A query, and evaluations of primitives for a point: separate, cached, fused.
type CountRow = (String, u64, u64, u64);

/// A model, which never changes. What is found out about it is kept.
#[pyclass(frozen, module = "jbt._jbt", name = "Model")]
#[derive(Clone)]
pub(crate) struct PyModel(Arc<ModelParts>);

struct ModelParts {
    model: Model,
    /// What was odd about its file.
    warnings: Vec<String>,
    checked: OnceLock<CheckedTree>,
    compiled: OnceLock<Compiled>,
}

impl PyModel {
    pub(crate) fn new(model: Model, warnings: Vec<String>) -> Self {
        let (checked, compiled) = (OnceLock::new(), OnceLock::new());
        Self(Arc::new(ModelParts { model, warnings, checked, compiled }))
    }

    /// What it is.
    pub(crate) fn inner(&self) -> &Model {
        &self.0.model
    }

    /// An edit of it.
    pub(crate) fn edited(&self, model: Model) -> Self {
        Self::new(model, self.0.warnings.clone())
    }

    /// A model of a tree with what else is said of another one.
    pub(crate) fn with_tree(&self, root: Tree) -> Self {
        self.edited(Model { root, ..self.0.model.clone() })
    }

    /// A model of a tree alone.
    pub(crate) fn of(root: Tree) -> Self {
        let mut model = Model::new(root);
        // The tree remembers its parameters by itself.
        model.parameters.clear();
        Self::new(model, Vec::new())
    }

    pub(crate) fn tree(&self) -> &Tree {
        &self.0.model.root
    }

    /// Whether these are the same model.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Whether it says more than its tree does.
    pub(crate) fn says_more(&self) -> bool {
        let Model { iso, attributes, root: _, parameters, source, origin, orientation, comments: _ } =
            &self.0.model;
        let plain = *iso == Model::DEFAULT_ISO.into() && *attributes == [AttributeGroup::color()];
        !plain
            || !parameters.is_empty()
            || source.is_some()
            || origin.is_some()
            || *orientation != Orientation::default()
    }

    /// The checked tree.
    pub(crate) fn checked(&self, py: Python<'_>) -> PyResult<CheckedTree> {
        if let Some(checked) = self.0.checked.get() {
            return Ok(checked.clone());
        }
        let model = self.0.model.clone();
        let checked = CallEffort::quiet(py).run(move |_| model.check())?;
        Ok(self.0.checked.get_or_init(|| checked).clone())
    }

    /// What the compiler made of it so far.
    pub(crate) fn compiled(&self, py: Python<'_>, engine: Option<Engine>) -> PyResult<Compiled> {
        let checked = self.checked(py)?;
        if engine.is_some() {
            return Ok(compiler(engine).compile(&checked));
        }
        Ok(self.0.compiled.get_or_init(|| compiler(None).compile(&checked)).clone())
    }
}

/// Reading and asking.
#[pymethods]
impl PyModel {
    /// A file, with values of parameters.
    #[staticmethod]
    fn load(
        py: Python<'_>,
        path: std::path::PathBuf,
        object: Option<String>,
        parameters: Vec<(String, f64)>,
    ) -> PyResult<Self> {
        // Files that the scene names are opened beneath its folder.
        let files = Files::new(Arc::new(SceneFolder::of(&path)));
        let options = Options { parameters, object, files, ..Options::default() };
        Ok(Self::read(CallEffort::quiet(py).run(move |_| Scene::load_with(path, &options))?))
    }

    /// A text, as if it were a file of this name.
    #[staticmethod]
    fn loads(
        py: Python<'_>,
        name: String,
        text: Vec<u8>,
        object: Option<String>,
        parameters: Vec<(String, f64)>,
    ) -> PyResult<Self> {
        let options = Options { parameters, object, ..Options::default() };
        let read = move |_: &_| Scene::from_reader(&name, text.as_slice(), &options);
        Ok(Self::read(CallEffort::quiet(py).run(read)?))
    }

    /// The model in the text format.
    fn text(&self, py: Python<'_>) -> String {
        let model = self.0.model.clone();
        py.detach(move || jbt_text::print(&model))
    }

    /// What was odd about its file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    /// The iso-value.
    #[getter]
    fn iso(&self) -> PyNumber {
        PyNumber(self.0.model.iso.clone())
    }

    fn with_iso(&self, iso: &Bound<'_, PyAny>) -> PyResult<Self> {
        let iso = number_of("iso", iso)?;
        Ok(self.edited(Model { iso, ..self.0.model.clone() }))
    }

    /// The origin that is set, if one is.
    #[getter]
    fn origin(&self) -> Option<[f64; 3]> {
        self.0.model.origin
    }

    #[pyo3(signature = (origin))]
    fn with_origin(&self, origin: Option<[f64; 3]>) -> Self {
        self.edited(Model { origin, ..self.0.model.clone() })
    }

    /// The axis that points up, and the hand of the axes.
    #[getter]
    fn orientation(&self) -> (&'static str, &'static str) {
        let Orientation { up, handed } = self.0.model.orientation;
        (up.name(), handed.name())
    }

    fn with_orientation(&self, up: &str, handed: &str) -> PyResult<Self> {
        Ok(self.edited(Model { orientation: orientation_of(up, handed)?, ..self.0.model.clone() }))
    }

    /// Attribute groups: name, default, mixing, and whether they are directions.
    fn groups(&self) -> Vec<(String, Vec<f64>, &'static str, bool)> {
        let each = |group: &AttributeGroup| {
            (group.name.to_string(), group.default.clone(), group.mixing.name(), group.turns())
        };
        self.0.model.attributes.iter().map(each).collect()
    }

    /// The same with a group declared so.
    fn group(&self, name: &str, default: Vec<f64>, mixing: &str, turns: bool) -> PyResult<Self> {
        let found = Mixing::ALL.into_iter().find(|known| known.name() == mixing);
        let words: Vec<&str> = Mixing::ALL.iter().map(|known| known.name()).collect();
        let wrong = || refused(format!("mixing: expected one of {}, got {mixing:?}", words.join(", ")));
        let group = AttributeGroup {
            name: normalized(name).into(),
            default,
            mixing: found.ok_or_else(wrong)?,
            kind: if turns { GroupKind::Direction } else { GroupKind::Numbers },
            ..AttributeGroup::color()
        };
        let mut model = self.0.model.clone();
        match model.attributes.iter_mut().find(|known| known.name == group.name) {
            Some(known) => *known = group,
            None => model.attributes.push(group),
        }
        Ok(Self::new(model, self.0.warnings.clone()))
    }

    /// Parameters: name and value.
    fn parameters(&self, py: Python<'_>) -> PyResult<Vec<(String, f64)>> {
        let checked = self.checked(py)?;
        Ok(checked.parameters().iter().map(|one| (one.name().to_owned(), one.value())).collect())
    }

    /// Other values of parameters. What was compiled serves the new model too.
    fn with_parameters(&self, py: Python<'_>, settings: Vec<(String, f64)>) -> PyResult<Self> {
        let borrowed: Vec<(&str, f64)> =
            settings.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let checked = self.checked(py)?.with_parameters(&borrowed).or_raise(py)?;
        let made = Self::new(self.0.model.with_parameters(&borrowed).or_raise(py)?, self.0.warnings.clone());
        if let Some(compiled) = self.0.compiled.get() {
            let _ = made.0.compiled.set(compiled.updated(&checked));
        }
        let _ = made.0.checked.set(checked);
        Ok(made)
    }

    /// Everything that is wrong, as an exception.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        self.checked(py).map(drop)
    }

    /// Nodes, and leaves by all paths.
    fn size(&self, py: Python<'_>) -> PyResult<(usize, u64)> {
        let checked = self.checked(py)?;
        Ok((checked.nodes().len(), checked.leaf_uses()))
    }

    /// The box outside of which the field is 0, in the world; `None` if it is 0 everywhere.
    fn support(&self, py: Python<'_>) -> PyResult<Option<([f64; 3], [f64; 3])>> {
        let support = self.checked(py)?.support();
        Ok((!support.is_empty()).then(|| (support.low(), support.high())))
    }

    /// What answers a query at points.
    #[pyo3(signature = (gradient, attributes, engine))]
    fn compile(
        &self,
        py: Python<'_>,
        gradient: bool,
        attributes: bool,
        engine: Option<&str>,
    ) -> PyResult<PyEvaluator> {
        let query = query_of(gradient, attributes);
        let compiled = self.compiled(py, engine_of(engine)?)?;
        let made = CallEffort::quiet(py).run(move |_| compiled.evaluator(query))?;
        Ok(PyEvaluator::new(made, self.checked(py)?))
    }

    /// Evaluations of primitives for one point: for each query `(name, separate, cached, fused)`; and uses
    /// and instances of leaves.
    fn counters(&self, py: Python<'_>) -> PyResult<(Vec<CountRow>, u64, u64)> {
        let compiled = self.compiled(py, None)?;
        CallEffort::quiet(py).run(move |_| -> Result<_, Refusal> {
            let statistics = jbt::statistics::Statistics::new(compiled.tree());
            let mut rows = Vec::new();
            for query in Query::EVERY {
                let count = statistics.per_point(&compiled.evaluator(query)?);
                rows.push((query.name().into_owned(), count.separate, count.cached, count.fused));
            }
            Ok((rows, statistics.uses(), statistics.instances()))
        })
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        // A tree remembers parameters that nobody has declared.
        let whole = |model: &Model| Model { parameters: model.all_parameters(), ..model.clone() };
        other.cast::<Self>().is_ok_and(|other| whole(&other.get().0.model) == whole(&self.0.model))
    }
}

impl PyModel {
    fn read(scene: Scene) -> Self {
        let warnings = scene.warnings.iter().map(|one| one.message.clone()).collect();
        Self::new(scene.model, warnings)
    }
}

/// The orientation of these words.
pub(crate) fn orientation_of(up: &str, handed: &str) -> PyResult<Orientation> {
    let axis = ModelUp::ALL.into_iter().find(|known| known.name() == up);
    let hand = Handed::ALL.into_iter().find(|known| known.name() == handed);
    Ok(Orientation {
        up: axis.ok_or_else(|| refused(format!("up: expected y or z, got {up:?}")))?,
        handed: hand.ok_or_else(|| refused(format!("handed: expected right or left, got {handed:?}")))?,
    })
}

/// The query with the field and what else is wanted.
pub(crate) fn query_of(gradient: bool, attributes: bool) -> Query {
    match (gradient, attributes) {
        (false, false) => Query::FIELD,
        (true, false) => Query::GRADIENT,
        (false, true) => Query::ATTRIBUTES,
        (true, true) => Query::SURFACE,
    }
}

/// The engine of a name.
pub(crate) fn engine_of(name: Option<&str>) -> PyResult<Option<Engine>> {
    let Some(name) = name else { return Ok(None) };
    let known: Vec<&str> = Engine::ALL.iter().map(|engine| engine.name()).collect();
    let wrong = |_| refused(format!("engine: expected one of {}, got {name:?}", known.join(", ")));
    name.parse().map(Some).map_err(wrong)
}
