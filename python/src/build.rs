//! Building models: what the functions of the package's `_members.py` and the methods of its `Model` call.

use jbt::tree::{CombinatorKind, MapKind, Precedence, SkeletonKind, WarpKind};
use jbt::{AttributeGroup, Mixing, Tree};
use jbt_model::builder::Vector;
use jbt_model::model::Model;
use jbt_model::word::normalized;
use jbt_model::written::{Radius, Written, WrittenAttribute, WrittenTextured, WrittenUv};
use pyo3::prelude::*;

use crate::constant::constant_of;
use crate::error::refused;
use crate::falloff::{PyFalloff, PyPattern, named, values};
use crate::fields::{numbers, vector};
use crate::merge::merged;
use crate::model::PyModel;
use crate::number::number_of;
use crate::term::{PyTerm, term_of};

fn trees(models: &[PyModel]) -> Vec<Tree> {
    models.iter().map(|model| model.tree().clone()).collect()
}

fn owned(models: &[PyRef<'_, PyModel>]) -> Vec<PyModel> {
    models.iter().map(|model| (**model).clone()).collect()
}

/// Building.
#[pymethods]
impl PyModel {
    /// A primitive by the name of its skeleton's constructor.
    #[staticmethod]
    fn primitive(
        name: &str,
        given: Vec<Bound<'_, PyAny>>,
        radius: (&str, Bound<'_, PyAny>),
        falloff: &Bound<'_, PyFalloff>,
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
    fn combine(name: &str, given: Vec<Bound<'_, PyAny>>, models: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let combinator = named!(CombinatorKind, name)?;
        let models = owned(&models);
        let written = Written::Combine { combinator, fields: values(combinator.fields(), &given)? };
        Ok(Self::new(
            Model { root: Tree::new(written, trees(&models)), ..merged(models.iter().map(PyModel::inner))? },
            Vec::new(),
        ))
    }

    /// One of several models, by a number.
    #[staticmethod]
    fn select(which: &Bound<'_, PyAny>, models: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let models = owned(&models);
        let root = Tree::select(number_of("which", which)?, trees(&models));
        Ok(Self::new(Model { root, ..merged(models.iter().map(PyModel::inner))? }, Vec::new()))
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
        Ok(Self::new(Model { root, ..merged(models.iter().map(PyModel::inner))? }, Vec::new()))
    }

    /// A warp by three formulas.
    fn warp_by(&self, coordinates: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let terms: Vec<_> = coordinates
            .iter()
            .map(|term| Ok(term_of("coordinates", term)?.inner))
            .collect::<PyResult<_>>()?;
        let given = terms.len();
        let terms = <[_; 3]>::try_from(terms)
            .map_err(|_| refused(format!("coordinates: expected 3 formulas, got {given}")))?;
        Ok(self.with_tree(self.tree().warp(terms)))
    }

    /// Every primitive with another falloff.
    fn with_falloff(&self, falloff: &Bound<'_, PyFalloff>) -> Self {
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
        let written = Written::Attribute {
            name: name.into(),
            value: WrittenAttribute::Numbers(numbers),
            precedence: Precedence::Nearest,
        };
        Ok(declared.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// A constant of all leaves below: text or a whole number.
    fn constant(&self, name: &str, given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let value = constant_of(name, given)?;
        Ok(self.with_tree(self.tree().constant(name, value)))
    }

    /// The attribute, constant or style at the root counts whatever stands below.
    fn overriding(&self) -> PyResult<Self> {
        let what = || refused("an attribute, a constant or a style can override, and nothing else");
        Ok(self.with_tree(self.tree().try_overriding().ok_or_else(what)?))
    }

    /// The attributes and constants down to another model are a style.
    fn styled(&self, name: &str, below: &Bound<'_, Self>) -> PyResult<Self> {
        let what = || refused("style: expected the model with attributes and constants around it");
        let tree = self.tree().clone().with_style(name, below.get().tree());
        Ok(self.with_tree(tree.ok_or_else(what)?))
    }

    /// Attributes by a pattern of two values.
    fn textured(
        &self,
        name: &str,
        pattern: &Bound<'_, PyPattern>,
        a: &Bound<'_, PyAny>,
        b: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let PyPattern { texture, fields } = pattern.get().clone();
        let (a, b) = (numbers("a", a)?, numbers("b", b)?);
        let declared = self.declared(name, a.len());
        let value = WrittenAttribute::Textured(WrittenTextured { texture, fields, a, b });
        let written = Written::Attribute { name: name.into(), value, precedence: Precedence::Nearest };
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
        let written = Written::Attribute {
            name: name.into(),
            value: WrittenAttribute::Uv(map),
            precedence: Precedence::Nearest,
        };
        Ok(declared.with_tree(Tree::new(written, vec![self.tree().clone()])))
    }

    /// Attributes by formulas.
    fn expressed(&self, name: &str, given: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let terms: Vec<_> =
            given.iter().map(|term| Ok(term_of("values", term)?.inner)).collect::<PyResult<_>>()?;
        let declared = self.declared(name, terms.len());
        Ok(declared.with_tree(self.tree().expressed(name, terms)))
    }

    /// The field as a part of a formula.
    fn field(&self) -> PyTerm {
        let models = if self.says_more() { vec![self.clone()] } else { Vec::new() };
        PyTerm { inner: self.tree().field(), models }
    }

    /// A field by a formula.
    #[staticmethod]
    #[pyo3(signature = (formula, low, high))]
    fn expression(
        formula: &Bound<'_, PyAny>,
        low: Option<&Bound<'_, PyAny>>,
        high: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let PyTerm { inner, models } = term_of("formula", formula)?;
        let root = match low.zip(high) {
            None => Tree::expression(inner),
            Some((low, high)) => Tree::expression_within(inner, corner("low", low)?, corner("high", high)?),
        };
        if models.is_empty() {
            return Ok(Self::of(root));
        }
        Ok(Self::new(Model { root, ..merged(models.iter().map(PyModel::inner))? }, Vec::new()))
    }

    /// The same, and 0 outside of a box.
    fn within(&self, low: &Bound<'_, PyAny>, high: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(self.with_tree(self.tree().within(corner("low", low)?, corner("high", high)?)))
    }

    /// Its field as a distance that fades.
    fn fading(&self, falloff: &Bound<'_, PyFalloff>, radius: &Bound<'_, PyAny>) -> PyResult<Self> {
        let falloff = falloff.get().0.falloff();
        Ok(self.with_tree(self.tree().fading(falloff, number_of("radius", radius)?)))
    }

    /// Every falloff by a formula of r that a callable makes.
    fn falloff_by(&self, formula: &Bound<'_, PyAny>) -> PyResult<Self> {
        let failed = std::cell::RefCell::new(None);
        let tree = self.tree().falloff_by(|r| {
            let called =
                formula.call1((PyTerm::plain(r),)).and_then(|made| Ok(term_of("formula", &made)?.inner));
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

impl PyModel {
    /// The same with a group of this width, unless it has one of this name.
    fn declared(&self, name: &str, width: usize) -> Self {
        let name = &*normalized(name);
        if self.inner().attributes.iter().any(|group| &*group.name == name) {
            return self.clone();
        }
        let group = AttributeGroup {
            name: name.into(),
            default: vec![0.0; width],
            mixing: Mixing::Blend,
            ..AttributeGroup::color()
        };
        let mut model = self.inner().clone();
        model.attributes.push(group);
        self.edited(model)
    }
}
