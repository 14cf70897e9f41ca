//! What was written: nodes with their numbers as formulas of parameters.
//!
//! A [`Tree`](crate::tree::Tree) is made of such nodes, and of nothing else. What they mean, a [`NodeKind`]
//! with plain values, is found out by the [check](crate::check), for the values that the parameters and the
//! iso-value have then.
//!
//! ```text
//! rotate axis z degrees 90 * t { .. }      written  Map { Rotate, axis (0 0 1), degrees 90 * t }
//!                                          meant    Affine(a 3x4 matrix), for the present value of t
//! ```

mod attribute;
mod falloff;
mod field;
mod particles;
mod plain;
mod points;
mod surface;

use std::sync::Arc;

use glam::DAffine3;

use crate::attribute::Precedence;
use crate::combine::CombinatorKind;
use crate::constant::LeafConstant;
use crate::diagnostic::Diagnostic;
use crate::expression::Formula;
use crate::field::{FieldKind, FieldValue};
use crate::kind::{NodeKind, Primitive};
use crate::map::MapKind;
use crate::number::{Number, ParameterValues, Step};
use crate::report::Fault;
use crate::skeleton::SkeletonKind;
use crate::warp::{FormulaWarp, WarpKind};

pub use crate::map::Freedom;
pub use attribute::{WrittenAttribute, WrittenTextured, WrittenUv};
pub use falloff::WrittenFalloff;
pub use field::FieldNumber;
pub use field::as_written;
pub use particles::{ParticleRadius, WrittenParticles};
pub use points::WrittenPoint;
use surface::support_radius;

/// The radius of a primitive.
#[derive(Clone, PartialEq, Debug)]
pub enum Radius {
    /// Where the field reaches zero.
    Support(Number),
    /// Where the primitive alone meets the iso-value of the model.
    Surface(Number),
}

impl<T: Into<Number>> From<T> for Radius {
    /// The radius of support.
    fn from(radius: T) -> Self {
        Self::Support(radius.into())
    }
}

/// What tells maps apart that depend on parameters: the kind of an affine map, none for the move to the box
/// of a formula, and the steps of the numbers that it is made of.
pub type MapKey = (Option<MapKind>, Vec<Step>);

/// What a node was written as.
#[derive(Clone, PartialEq, Debug)]
pub enum Written {
    /// A leaf.
    Primitive {
        /// The kind of the skeleton.
        skeleton: SkeletonKind,
        /// Its parameters, in the order of [`SkeletonKind::fields`].
        fields: Vec<FieldNumber>,
        /// How the field fades.
        falloff: WrittenFalloff,
        /// How far the field reaches.
        radius: Radius,
        /// The factor of the field.
        strength: Number,
    },
    /// Any number of points, as arrays.
    Particles(Box<WrittenParticles>),
    /// An operator.
    Combine {
        /// The kind.
        combinator: CombinatorKind,
        /// Its parameters, in the order of [`CombinatorKind::fields`].
        fields: Vec<FieldNumber>,
    },
    /// A formula.
    Expression(Formula),
    /// A selector, which chooses the child whose place is nearest to this number.
    Select(Number),
    /// An affine map.
    Map {
        /// The kind.
        map: MapKind,
        /// Its values, in the order of [`MapKind::fields`].
        fields: Vec<FieldNumber>,
    },
    /// A warp.
    Warp {
        /// The kind; its variant is not looked at.
        warp: WarpKind,
        /// Its parameters, in the order of [`WarpKind::fields`].
        fields: Vec<FieldNumber>,
    },
    /// A warp that is given by three formulas of the point.
    FormulaWarp(Formula),
    /// An attribute of the leaves below.
    Attribute {
        /// The attribute group.
        name: Arc<str>,
        /// What they have.
        value: WrittenAttribute,
        /// Whether it counts beside others of the name.
        precedence: Precedence,
    },
    /// A constant of the leaves below.
    Constant {
        /// What is told of them.
        name: Arc<str>,
        /// What it is.
        value: LeafConstant,
        /// Whether it counts beside others of the name.
        precedence: Precedence,
    },
}

impl Radius {
    fn number(&self) -> &Number {
        match self {
            Self::Support(number) | Self::Surface(number) => number,
        }
    }

    fn number_mut(&mut self) -> &mut Number {
        match self {
            Self::Support(number) | Self::Surface(number) => number,
        }
    }
}

impl Written {
    /// The formula of coordinates that it has.
    pub(crate) const fn formula(&self) -> Option<&Formula> {
        match self {
            Self::Expression(formula)
            | Self::FormulaWarp(formula)
            | Self::Attribute { value: WrittenAttribute::Expressed(formula), .. } => Some(formula),
            Self::Primitive { .. }
            | Self::Particles(_)
            | Self::Combine { .. }
            | Self::Select(_)
            | Self::Map { .. }
            | Self::Warp { .. }
            | Self::Attribute { .. }
            | Self::Constant { .. } => None,
        }
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = &Number> {
        let falloff = self.falloff().map_or(&[][..], WrittenFalloff::fields);
        let (fields, numbers, own): (&[FieldNumber], &[Number], [Option<&Number>; 2]) = match self {
            Self::Primitive { fields, radius, strength, .. } => {
                (fields, &[], [Some(radius.number()), Some(strength)])
            }
            Self::Particles(particles) => (&[], &[], particles.own_numbers()),
            Self::Select(number) => (&[], &[], [Some(number), None]),
            Self::Expression(formula) | Self::FormulaWarp(formula) => (&[], &formula.numbers, [None; 2]),
            Self::Attribute { .. } | Self::Constant { .. } => (&[], &[], [None; 2]),
            Self::Combine { fields, .. } | Self::Map { fields, .. } | Self::Warp { fields, .. } => {
                (fields, &[], [None; 2])
            }
        };
        let value = if let Self::Attribute { value, .. } = self { Some(value) } else { None };
        let numbers = numbers.iter().chain(value.into_iter().flat_map(WrittenAttribute::numbers));
        let fields = fields.iter().chain(falloff).flat_map(FieldNumber::numbers);
        fields.chain(numbers).chain(own.into_iter().flatten())
    }

    fn numbers_mut(&mut self) -> Vec<&mut Number> {
        match self {
            Self::Primitive { fields, falloff, radius, strength, .. } => {
                let own = [radius.number_mut(), strength];
                let fields = fields.iter_mut().chain(falloff.fields_mut());
                fields.flat_map(FieldNumber::numbers_mut).chain(own).collect()
            }
            Self::Particles(particles) => particles.numbers_mut().collect(),
            Self::Select(number) => vec![number],
            Self::Expression(formula) | Self::FormulaWarp(formula) => formula.numbers.iter_mut().collect(),
            Self::Combine { fields, .. } | Self::Map { fields, .. } | Self::Warp { fields, .. } => {
                fields.iter_mut().flat_map(FieldNumber::numbers_mut).collect()
            }
            Self::Attribute { value, .. } => value.numbers_mut(),
            Self::Constant { .. } => Vec::new(),
        }
    }

    /// The numbers that depend on parameters.
    pub(crate) fn dependent_numbers(&self) -> impl Iterator<Item = &Number> {
        self.numbers().filter(|number| number.depends_on_parameters())
    }

    /// Whether a number depends on a parameter; of a surface radius, the iso-value counts too.
    pub(crate) fn depends_on_parameters(&self, iso: &Number) -> bool {
        self.dependent_numbers().next().is_some() || (iso.depends_on_parameters() && self.asks_iso())
    }

    /// Whether the node depends on the iso-value of its model.
    pub(crate) fn asks_iso(&self) -> bool {
        match self {
            Self::Primitive { radius, .. } => matches!(radius, Radius::Surface(_)),
            Self::Particles(particles) => matches!(particles.radius, ParticleRadius::Surface(_)),
            Self::Combine { .. }
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Map { .. }
            | Self::Warp { .. }
            | Self::FormulaWarp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => false,
        }
    }

    /// Whether the iso-value of the model decides if its numbers can be.
    pub(crate) fn is_limited_by_iso(&self) -> bool {
        matches!(self, Self::Combine { combinator, .. } if combinator.asks_iso())
    }

    /// The same with the present values of parameters. An error names the place of a formula, if it has one.
    pub(crate) fn refreshed(&self, known: &ParameterValues) -> Result<Self, Diagnostic> {
        let mut fresh = self.clone();
        for number in fresh.numbers_mut() {
            *number = number.refreshed(known)?;
        }
        Ok(fresh)
    }

    /// What the node means with the present values of its numbers, in a model of this iso-value; unchecked.
    ///
    /// # Errors
    ///
    /// An axis without a direction, and the surface radius of a primitive that has no surface; without a
    /// place.
    pub fn evaluated(&self, iso: f64) -> Result<NodeKind, Diagnostic> {
        self.kind(iso).map_err(|fault| fault.at(None))
    }

    fn kind(&self, iso: f64) -> Result<NodeKind, Fault> {
        let values =
            |fields: &[FieldNumber]| -> Vec<FieldValue> { fields.iter().map(FieldNumber::value).collect() };
        Ok(match self {
            Self::Primitive { skeleton, fields, falloff, radius, strength } => {
                let (falloff, strength) = (falloff.falloff(), strength.value());
                let radius = match radius {
                    Radius::Support(radius) => radius.value(),
                    Radius::Surface(radius) => support_radius(radius.value(), falloff, strength, iso)?,
                };
                let skeleton = skeleton.from_fields(&values(fields));
                NodeKind::Primitive(Primitive { skeleton, falloff, radius, strength })
            }
            Self::Particles(particles) => NodeKind::Particles(particles.particles(iso)?),
            Self::Combine { combinator, fields } => {
                let combinator = combinator.from_fields(&values(fields));
                let depends = self.dependent_numbers().next().is_some();
                NodeKind::Combine(if depends { combinator.general() } else { combinator })
            }
            Self::Expression(formula) => NodeKind::Expression(formula.expression()),
            Self::Select(which) => NodeKind::Select(which.value()),
            Self::Map { .. } => NodeKind::Affine(self.map()?),
            Self::Warp { warp, fields } => NodeKind::Warp(warp.from_fields(&values(fields))),
            Self::FormulaWarp(formula) => NodeKind::Warp(FormulaWarp::from(formula).into()),
            Self::Attribute { name, value, precedence } => {
                NodeKind::Attribute { name: Arc::clone(name), value: value.value(), precedence: *precedence }
            }
            Self::Constant { name, value, precedence } => {
                NodeKind::Constant { name: Arc::clone(name), value: value.clone(), precedence: *precedence }
            }
        })
    }

    /// What tells the maps of nodes apart that depend on parameters: equal for those that are equal whatever
    /// the values. An affine node has one, and so has a formula in a box; nothing else moves what is in it.
    pub fn map_key(&self) -> MapKey {
        let steps = |numbers: &mut dyn Iterator<Item = &Number>| numbers.flat_map(Number::steps).collect();
        match self {
            Self::Map { map, fields } => {
                (Some(*map), steps(&mut fields.iter().flat_map(FieldNumber::numbers)))
            }
            _ => (None, steps(&mut self.formula().into_iter().flat_map(Formula::corners))),
        }
    }

    /// The map of an affine node, with the present values of its numbers; of any other node the identity.
    pub(crate) fn map(&self) -> Result<DAffine3, Fault> {
        let Self::Map { map, fields } = self else { return Ok(DAffine3::IDENTITY) };
        map.affine(&fields.iter().map(FieldNumber::value).collect::<Vec<_>>())
    }

    /// How much the linear part of a map can change.
    pub fn freedom(&self) -> Freedom {
        match self {
            Self::Map { map, .. } if self.dependent_numbers().next().is_some() => map.freedom(),
            Self::Map { .. }
            | Self::Primitive { .. }
            | Self::Particles(_)
            | Self::Combine { .. }
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Warp { .. }
            | Self::FormulaWarp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => Freedom::Fixed,
        }
    }

    /// Whether a primitive's skeleton can turn: a direction or an angle depends on a parameter, or one of
    /// several positions, which give it its own.
    pub fn skeleton_turns(&self) -> bool {
        let Self::Primitive { skeleton, fields, .. } = self else { return false };
        let described = skeleton.fields();
        let positions = described.iter().filter(|field| field.kind == FieldKind::Position).count();
        described.iter().zip(fields).any(|(field, value)| {
            let turns = match field.kind {
                // An arc is posed by its middle, which turns with its angle.
                FieldKind::Direction | FieldKind::Axis | FieldKind::Positions | FieldKind::Degrees => true,
                FieldKind::Position => positions > 1,
                FieldKind::Real
                | FieldKind::Positive
                | FieldKind::NonNegative
                | FieldKind::Extents
                | FieldKind::Stretches
                | FieldKind::Lengths
                | FieldKind::Within { .. }
                | FieldKind::Choice(_)
                | FieldKind::Count
                | FieldKind::Whole { .. }
                | FieldKind::Rows
                | FieldKind::Flag => false,
            };
            turns && value.numbers().iter().any(Number::depends_on_parameters)
        })
    }

    /// Whether it is a leaf with a skeleton.
    pub(crate) const fn is_primitive(&self) -> bool {
        matches!(self, Self::Primitive { .. })
    }

    /// The falloff of a primitive, or of particles.
    pub(crate) fn falloff(&self) -> Option<&WrittenFalloff> {
        match self {
            Self::Primitive { falloff, .. } => Some(falloff),
            Self::Particles(particles) => Some(&particles.falloff),
            Self::Combine { .. }
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Map { .. }
            | Self::Warp { .. }
            | Self::FormulaWarp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => None,
        }
    }

    /// Whether the strength of a primitive, or that of all particles, depends on a parameter.
    pub fn strength_depends_on_parameters(&self) -> bool {
        let strength = match self {
            Self::Primitive { strength, .. } => Some(strength),
            Self::Particles(particles) => particles.strength.all(),
            Self::Combine { .. }
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Map { .. }
            | Self::Warp { .. }
            | Self::FormulaWarp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => None,
        };
        strength.is_some_and(Number::depends_on_parameters)
    }

    /// Whether a parameter of a primitive's falloff, or of that of particles, follows one of the model.
    pub fn falloff_depends_on_parameters(&self) -> bool {
        self.falloff().is_some_and(WrittenFalloff::depends_on_parameters)
    }

    /// The same with another strength, if it is a primitive, or particles.
    pub(crate) fn with_strength(mut self, new: Number) -> Self {
        match &mut self {
            Self::Primitive { strength, .. } => *strength = new,
            Self::Particles(particles) => particles.strength = new.into(),
            Self::Combine { .. }
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Map { .. }
            | Self::Warp { .. }
            | Self::FormulaWarp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => {}
        }
        self
    }

    /// What it gives leaves: whether that is a constant, and its name. `None` if it gives nothing.
    #[must_use]
    pub fn given(&self) -> Option<(bool, &str)> {
        if let Self::Attribute { name, .. } = self {
            return Some((false, name));
        }
        if let Self::Constant { name, .. } = self { Some((true, name)) } else { None }
    }

    /// The same with another precedence, if it is an attribute or a constant.
    #[must_use]
    pub fn with_precedence(mut self, new: Precedence) -> Self {
        if let Self::Attribute { precedence, .. } | Self::Constant { precedence, .. } = &mut self {
            *precedence = new;
        }
        self
    }

    /// The same with another falloff, if it is a primitive, or particles.
    pub(crate) fn with_falloff(mut self, new: WrittenFalloff) -> Self {
        match &mut self {
            Self::Primitive { falloff, .. } => *falloff = new,
            Self::Particles(particles) => particles.falloff = new,
            Self::Combine { .. }
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Map { .. }
            | Self::Warp { .. }
            | Self::FormulaWarp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => {}
        }
        self
    }

    /// What a primitive is written as that was changed from one leaf to another: numbers that the change has
    /// left alone follow their parameters still.
    pub(crate) fn changed(&self, old: &Primitive, new: &Primitive) -> Self {
        let Self::Primitive { fields, falloff, radius, strength, .. } = self else {
            unreachable!("leaves are written as primitives")
        };
        let kept = |number: &Number, old: f64, new: f64| {
            if old.to_bits() == new.to_bits() { number.clone() } else { Number::from(new) }
        };
        let skeleton = new.skeleton.kind();
        let after = new.skeleton.to_fields();
        let fields = if skeleton == old.skeleton.kind() {
            let before = old.skeleton.to_fields();
            let each = fields.iter().zip(before).zip(after);
            each.map(|((field, before), after)| if before == after { field.clone() } else { after.into() })
                .collect()
        } else {
            as_written(after)
        };
        let radius = if old.radius.to_bits() == new.radius.to_bits() {
            radius.clone()
        } else {
            Radius::Support(new.radius.into())
        };
        let strength = kept(strength, old.strength, new.strength);
        let falloff = if new.falloff == old.falloff { falloff.clone() } else { new.falloff.into() };
        Self::Primitive { skeleton, fields, falloff, radius, strength }
    }
}
