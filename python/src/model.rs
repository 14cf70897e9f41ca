//! Models: a tree and what its field means, and what was compiled of it.

use std::sync::{Arc, OnceLock};

use jbt::tree::{CombinatorKind, FalloffKind, Field, MapKind, SkeletonKind, TextureKind, WarpKind};
use jbt::{AttributeGroup, CheckedTree, Compiled, Engine, Mixing, Query, Scene, Tree};
use jbt_model::builder::Vector;
use jbt_model::model::Model as InnerModel;
use jbt_model::written::{FieldNumber, Radius, Written, WrittenAttribute, WrittenFalloff, WrittenTextured};
use jbt_model::written::WrittenUv;
use jbt_text::Options;
use pyo3::prelude::*;

use crate::error::{OrRaise as _, Refusal, refused};
use crate::evaluator::Evaluator;
use crate::fields::{field_value, numbers, vector};
use crate::number::{Number, Term, number_of, term_of};
use crate::work::{Effort, compiler};

/// A falloff: its kind and its numbers.
#[pyclass(frozen, module = "jbt")]
#[derive(Clone)]
pub(crate) struct Falloff(pub(crate) WrittenFalloff);

/// A texture: its kind and its numbers.
#[pyclass(frozen, module = "jbt")]
#[derive(Clone)]
pub(crate) struct Pattern {
    texture: TextureKind,
    fields: Vec<FieldNumber>,
}

/// A model, which never changes. What is found out about it is kept.
#[pyclass(frozen, module = "jbt._jbt")]
#[derive(Clone)]
pub(crate) struct Model(Arc<ModelParts>);

struct ModelParts {
    model: InnerModel,
    /// What was odd about its file.
    warnings: Vec<String>,
    checked: OnceLock<CheckedTree>,
    compiled: OnceLock<Compiled>,
}

/// The member of a list with the name of a constructor.
macro_rules! named {
    ($kind:ident, $name:expr) => {{
        let name: &str = $name;
        let found = $kind::ALL.iter().copied().find(|kind| kind.constructor() == name);
        found.ok_or_else(|| refused(format!("there is no {} {name:?}", stringify!($kind))))
    }};
}

/// Values for all parameters of a member.
fn values(fields: &[Field], given: &[Bound<'_, PyAny>]) -> PyResult<Vec<FieldNumber>> {
    if fields.len() != given.len() {
        return Err(refused(format!("expected {} parameters, got {}", fields.len(), given.len())));
    }
    fields.iter().zip(given).map(|(field, given)| field_value(field, given)).collect()
}

#[pymethods]
impl Falloff {
    #[new]
    fn new(name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let kind = named!(FalloffKind, name)?;
        Ok(Self(WrittenFalloff::new(kind, values(kind.fields(), &given)?)))
    }

    /// The falloff that a word of the text format names.
    #[staticmethod]
    fn named(word: &str) -> PyResult<Self> {
        let known = || {
            let words: Vec<&str> = FalloffKind::ALL.iter().map(|kind| kind.name()).collect();
            refused(format!("falloff: expected one of {}, got {word:?}", words.join(", ")))
        };
        let kind = FalloffKind::named(word).ok_or_else(known)?;
        let defaults = kind.fields().iter().map(|field| field.default.clone().map(FieldNumber::from));
        let defaults: Option<Vec<FieldNumber>> = defaults.collect();
        let needed = || refused(format!("falloff: {word:?} needs numbers; call jbt.{}(..)", kind.constructor()));
        Ok(Self(WrittenFalloff::new(kind, defaults.ok_or_else(needed)?)))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().0 == self.0)
    }

    fn __repr__(&self) -> String {
        format!("<jbt.Falloff {}>", self.0.kind().text(self.0.fields()))
    }
}

#[pymethods]
impl Pattern {
    #[new]
    fn new(name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let texture = named!(TextureKind, name)?;
        Ok(Self { texture, fields: values(texture.fields(), &given)? })
    }

    fn __repr__(&self) -> String {
        format!("<jbt.Pattern {}>", self.texture.name())
    }
}

impl Model {
    pub(crate) fn new(model: InnerModel, warnings: Vec<String>) -> Self {
        let (checked, compiled) = (OnceLock::new(), OnceLock::new());
        Self(Arc::new(ModelParts { model, warnings, checked, compiled }))
    }

    /// A model of a tree with what else is said of another one.
    fn with_tree(&self, root: Tree) -> Self {
        Self::new(InnerModel { root, ..self.0.model.clone() }, self.0.warnings.clone())
    }

    /// A model of a tree alone.
    pub(crate) fn of(root: Tree) -> Self {
        let mut model = InnerModel::new(root);
        // The tree remembers its parameters by itself.
        model.parameters.clear();
        Self::new(model, Vec::new())
    }

    fn tree(&self) -> &Tree {
        &self.0.model.root
    }

    /// Whether these are the same model.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Whether it says more than its tree does.
    fn says_more(&self) -> bool {
        let InnerModel { iso, attributes, root: _, parameters, source, origin } = &self.0.model;
        let plain = *iso == InnerModel::DEFAULT_ISO.into() && *attributes == [AttributeGroup::color()];
        !plain || !parameters.is_empty() || source.is_some() || origin.is_some()
    }

    /// The checked tree.
    pub(crate) fn checked(&self, py: Python<'_>) -> PyResult<CheckedTree> {
        if let Some(checked) = self.0.checked.get() {
            return Ok(checked.clone());
        }
        let model = self.0.model.clone();
        let checked = Effort::quiet(py).run(move |_| model.check())?;
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

/// What several models say of themselves besides their trees, in one.
fn merged(models: &[Model]) -> PyResult<InnerModel> {
    let mut all = models.iter().map(|model| &model.0.model);
    let Some(first) = all.next() else {
        return Err(refused("models: expected one model or more, got none"));
    };
    let mut merged = first.clone();
    for model in all {
        if merged.iso != model.iso {
            let (a, b) = (merged.iso.to_string(), model.iso.to_string());
            return Err(refused(format!(
                "models with the iso-values {a} and {b} cannot be combined: give both one by .with_iso(..)"
            )));
        }
        merge_groups(&mut merged.attributes, &model.attributes)?;
        for parameter in &model.parameters {
            match merged.parameters.iter().find(|known| known.name() == parameter.name()) {
                None => merged.parameters.push(parameter.clone()),
                Some(known) if known == parameter => {}
                Some(known) => {
                    let (name, a, b) = (known.name(), known.value(), parameter.value());
                    return Err(refused(format!(
                        "the parameter `{name}` is {a} in one model and {b} in another one"
                    )));
                }
            }
        }
        if model.origin.is_some() && merged.origin.is_some() && merged.origin != model.origin {
            merged.origin = None;
        } else {
            merged.origin = merged.origin.or(model.origin);
        }
        // Places are those of one text: of two texts none are told.
        merged.source = match (merged.source.take(), &model.source) {
            (Some(a), Some(b)) if a.name() == b.name() && a.text() == b.text() => Some(a),
            (Some(_), Some(_)) => None,
            (a, b) => a.or_else(|| b.clone()),
        };
    }
    Ok(merged)
}

fn merge_groups(groups: &mut Vec<AttributeGroup>, others: &[AttributeGroup]) -> PyResult<()> {
    for other in others {
        match groups.iter_mut().find(|known| known.name == other.name) {
            None => groups.push(other.clone()),
            Some(known) if known == other || *other == AttributeGroup::color() => {}
            Some(known) if *known == AttributeGroup::color() => *known = other.clone(),
            Some(known) => {
                return Err(refused(format!(
                    "the attribute `{}` is declared in two ways: give both models one by .group(..)",
                    known.name
                )));
            }
        }
    }
    Ok(())
}

fn trees(models: &[Model]) -> Vec<Tree> {
    models.iter().map(|model| model.tree().clone()).collect()
}

fn owned(models: &[PyRef<'_, Model>]) -> Vec<Model> {
    models.iter().map(|model| (**model).clone()).collect()
}

/// Building.
#[pymethods]
impl Model {
    /// A primitive by the name of its skeleton's constructor.
    #[staticmethod]
    fn primitive(
        name: &str,
        given: Vec<Bound<'_, PyAny>>,
        radius: (&str, Bound<'_, PyAny>),
        falloff: &Bound<'_, Falloff>,
        strength: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let skeleton = named!(SkeletonKind, name)?;
        let fields = values(skeleton.fields(), &given)?;
        let (word, radius) = radius;
        let number = number_of(word, &radius)?;
        let radius = if word == "radius" { Radius::Support(number) } else { Radius::Surface(number) };
        let strength = number_of("strength", strength)?;
        let falloff = falloff.get().0.clone();
        let written = Written::Primitive { skeleton, fields, falloff, radius, strength };
        Ok(Self::of(Tree::new(written, Vec::new())))
    }

    /// An operator over models.
    #[staticmethod]
    fn combine(
        name: &str,
        given: Vec<Bound<'_, PyAny>>,
        models: Vec<PyRef<'_, Self>>,
    ) -> PyResult<Self> {
        let combinator = named!(CombinatorKind, name)?;
        let models = owned(&models);
        let written = Written::Combine { combinator, fields: values(combinator.fields(), &given)? };
        Ok(Self::new(InnerModel { root: Tree::new(written, trees(&models)), ..merged(&models)? }, Vec::new()))
    }

    /// One of several models, by a number.
    #[staticmethod]
    fn select(which: &Bound<'_, PyAny>, models: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let models = owned(&models);
        let root = Tree::select(number_of("which", which)?, trees(&models));
        Ok(Self::new(InnerModel { root, ..merged(&models)? }, Vec::new()))
    }

    /// An affine map.
    fn map(&self, name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let map = named!(MapKind, name)?;
        let written = Written::Map { map, fields: values(map.fields(), &given)? };
        Ok(self.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// A warp.
    fn warp(&self, name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let warp = named!(WarpKind, name)?;
        let written = Written::Warp { warp, fields: values(warp.fields(), &given)? };
        Ok(self.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// The warp at the root, weighted by the field of another model.
    fn weighted(&self, weight: &Bound<'_, Self>) -> PyResult<Self> {
        let models = [self.clone(), weight.get().clone()];
        let root = self.tree().weighted(models[1].tree());
        Ok(Self::new(InnerModel { root, ..merged(&models)? }, Vec::new()))
    }

    /// A warp by three formulas.
    fn warp_by(&self, coordinates: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let terms: Vec<_> =
            coordinates.iter().map(|term| Ok(term_of("coordinates", term)?.inner)).collect::<PyResult<_>>()?;
        let given = terms.len();
        let terms = <[_; 3]>::try_from(terms)
            .map_err(|_| refused(format!("coordinates: expected 3 formulas, got {given}")))?;
        Ok(self.with_tree(self.tree().warp(terms)))
    }

    /// Every primitive with another falloff.
    fn with_falloff(&self, falloff: &Bound<'_, Falloff>) -> Self {
        self.with_tree(self.tree().falloff(falloff.get().0.clone()))
    }

    /// Every primitive with another strength.
    fn with_strength(&self, strength: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(self.with_tree(self.tree().strength(number_of("strength", strength)?)))
    }

    /// Attributes of all leaves below; a group that is not there yet is declared.
    fn attribute(&self, name: &str, given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let numbers = numbers(name, given)?;
        let declared = self.declared(name, numbers.len());
        let written = Written::Attribute { name: name.into(), value: WrittenAttribute::Numbers(numbers) };
        Ok(declared.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// Attributes by a pattern of two values.
    fn textured(
        &self,
        name: &str,
        pattern: &Bound<'_, Pattern>,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let Pattern { texture, fields } = pattern.get().clone();
        let (a, b) = (numbers("a", a)?, numbers("b", b)?);
        let declared = self.declared(name, a.len());
        let value = WrittenAttribute::Textured(WrittenTextured { texture, fields, a, b });
        let written = Written::Attribute { name: name.into(), value };
        Ok(declared.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// The uv of skeletons.
    fn uv(
        &self,
        name: &str,
        scale: [Bound<'_, PyAny>; 2],
        degrees: &Bound<'_, PyAny>,
        shift: [Bound<'_, PyAny>; 2],
    ) -> PyResult<Self> {
        let [[su, sv], [u, v]] = [("scale", scale), ("shift", shift)]
            .map(|(name, [a, b])| [number_of(name, &a), number_of(name, &b)]);
        let map = WrittenUv { scale: [su?, sv?], degrees: number_of("degrees", degrees)?, shift: [u?, v?] };
        let declared = self.declared(name, 2);
        let written = Written::Attribute { name: name.into(), value: WrittenAttribute::Uv(map) };
        Ok(declared.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// Attributes by formulas.
    fn expressed(&self, name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let terms: Vec<_> = given.iter().map(|term| Ok(term_of("values", term)?.inner)).collect::<PyResult<_>>()?;
        let declared = self.declared(name, terms.len());
        Ok(declared.with_tree(self.tree().expressed(name, terms)))
    }

    /// The field as a part of a formula.
    fn field(&self) -> Term {
        let models = if self.says_more() { vec![self.clone()] } else { Vec::new() };
        Term { inner: self.tree().field(), models }
    }

    /// A field by a formula.
    #[staticmethod]
    #[pyo3(signature = (formula, low, high))]
    fn expression(
        formula: &Bound<'_, PyAny>,
        low: Option<&Bound<'_, PyAny>>,
        high: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let Term { inner, models } = term_of("formula", formula)?;
        let root = match low.zip(high) {
            None => Tree::expression(inner),
            Some((low, high)) => Tree::expression_within(inner, corner("low", low)?, corner("high", high)?),
        };
        if models.is_empty() {
            return Ok(Self::of(root));
        }
        Ok(Self::new(InnerModel { root, ..merged(&models)? }, Vec::new()))
    }

    /// The same, and 0 outside of a box.
    fn within(&self, low: &Bound<'_, PyAny>, high: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(self.with_tree(self.tree().within(corner("low", low)?, corner("high", high)?)))
    }

    /// Its field as a distance that fades.
    fn fading(&self, falloff: &Bound<'_, Falloff>, radius: &Bound<'_, PyAny>) -> PyResult<Self> {
        let falloff = falloff.get().0.falloff();
        Ok(self.with_tree(self.tree().fading(falloff, number_of("radius", radius)?)))
    }

    /// Every falloff by a formula of r that a callable makes.
    fn falloff_by(&self, formula: &Bound<'_, PyAny>) -> PyResult<Self> {
        let failed = std::cell::RefCell::new(None);
        let tree = self.tree().falloff_by(|r| {
            let called = formula.call1((Term::plain(r),)).and_then(|made| Ok(term_of("formula", &made)?.inner));
            called.unwrap_or_else(|error| {
                failed.borrow_mut().get_or_insert(error);
                0.0.into()
            })
        });
        match failed.into_inner() {
            Some(error) => Err(error),
            None => Ok(self.with_tree(tree)),
        }
    }
}

fn corner(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vector> {
    Ok(vector(name, given)?.into())
}

impl Model {
    /// The same with a group of this width, unless it has one of this name.
    fn declared(&self, name: &str, width: usize) -> Self {
        if self.0.model.attributes.iter().any(|group| &*group.name == name) {
            return self.clone();
        }
        let group =
            AttributeGroup { name: name.into(), default: vec![0.0; width], mixing: Mixing::Blend };
        let mut model = self.0.model.clone();
        model.attributes.push(group);
        Self::new(model, self.0.warnings.clone())
    }
}

/// Reading and asking.
#[pymethods]
impl Model {
    /// A file, with values of parameters.
    #[staticmethod]
    fn load(py: Python<'_>, path: std::path::PathBuf, parameters: Vec<(String, f64)>) -> PyResult<Self> {
        let options = Options { parameters };
        Ok(Self::read(Effort::quiet(py).run(move |_| Scene::load_with(path, &options))?))
    }

    /// A text, as if it were a file of this name.
    #[staticmethod]
    fn loads(
        py: Python<'_>,
        name: String,
        text: Vec<u8>,
        parameters: Vec<(String, f64)>,
    ) -> PyResult<Self> {
        let options = Options { parameters };
        let read = move |_: &_| Scene::from_reader(&name, text.as_slice(), &options);
        Ok(Self::read(Effort::quiet(py).run(read)?))
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
    fn iso(&self) -> Number {
        Number(self.0.model.iso.clone())
    }

    fn with_iso(&self, iso: &Bound<'_, PyAny>) -> PyResult<Self> {
        let iso = number_of("iso", iso)?;
        Ok(Self::new(InnerModel { iso, ..self.0.model.clone() }, self.0.warnings.clone()))
    }

    /// The origin that is set, if one is.
    #[getter]
    fn origin(&self) -> Option<[f64; 3]> {
        self.0.model.origin
    }

    #[pyo3(signature = (origin))]
    fn with_origin(&self, origin: Option<[f64; 3]>) -> Self {
        Self::new(InnerModel { origin, ..self.0.model.clone() }, self.0.warnings.clone())
    }

    /// Attribute groups: name, default, mixing.
    fn groups(&self) -> Vec<(String, Vec<f64>, &'static str)> {
        let each = |group: &AttributeGroup| {
            (group.name.to_string(), group.default.clone(), group.mixing.name())
        };
        self.0.model.attributes.iter().map(each).collect()
    }

    /// The same with a group declared so.
    fn group(&self, name: &str, default: Vec<f64>, mixing: &str) -> PyResult<Self> {
        let found = Mixing::ALL.into_iter().find(|known| known.name() == mixing);
        let words: Vec<&str> = Mixing::ALL.iter().map(|known| known.name()).collect();
        let wrong = || refused(format!("mixing: expected one of {}, got {mixing:?}", words.join(", ")));
        let group = AttributeGroup { name: name.into(), default, mixing: found.ok_or_else(wrong)? };
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
        let borrowed: Vec<(&str, f64)> = settings.iter().map(|(name, value)| (name.as_str(), *value)).collect();
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
    ) -> PyResult<Evaluator> {
        let query = query_of(gradient, attributes);
        let compiled = self.compiled(py, engine_of(engine)?)?;
        let made = Effort::quiet(py).run(move |_| compiled.evaluator(query))?;
        Ok(Evaluator::new(made, self.checked(py)?))
    }

    /// Evaluations of primitives for one point: for each query `(name, separate, cached, fused)`; and uses
    /// and instances of leaves.
    fn counters(&self, py: Python<'_>) -> PyResult<(Vec<(String, u64, u64, u64)>, u64, u64)> {
        let compiled = self.compiled(py, None)?;
        Effort::quiet(py).run(move |_| -> Result<_, Refusal> {
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
        let whole = |model: &InnerModel| InnerModel { parameters: model.all_parameters(), ..model.clone() };
        other.cast::<Self>().is_ok_and(|other| whole(&other.get().0.model) == whole(&self.0.model))
    }
}

impl Model {
    fn read(scene: Scene) -> Self {
        let warnings = scene.warnings.iter().map(|one| one.message.clone()).collect();
        Self::new(scene.model, warnings)
    }
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
