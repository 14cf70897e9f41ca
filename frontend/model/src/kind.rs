//! What a node does, with plain values. (Other `..Kind`s, as `SkeletonKind`, have no values.)

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use crate::attribute::{AttributeValue, Precedence};
use crate::combine::Combinator;
use crate::constant::LeafConstant;
use crate::expression::Expression;
use crate::falloff::Falloff;
use crate::particles::Particles;
use crate::skeleton::{Point, Skeleton};
use crate::warp::Warp;

/// A leaf: a skeleton, and the field around it.
///
/// The field at squared distance `d^2` from the skeleton is `strength * falloff(d^2 / radius^2)`.
#[derive(Clone, PartialEq, Debug)]
pub struct Primitive {
    /// What the distance is measured to.
    pub skeleton: Skeleton,
    /// How the field fades.
    pub falloff: Falloff,
    /// The support radius: where the field reaches zero.
    pub radius: f64,
    /// The factor of the field; negative ones push surfaces away.
    pub strength: f64,
}

/// What a node does.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeKind {
    /// A leaf.
    Primitive(Primitive),
    /// The sum of any number of points.
    Particles(Particles),
    /// Fields of the children become one field.
    Combine(Combinator),
    /// The field is a formula of the coordinates and of the children's fields: a leaf, if it has no children.
    Expression(Expression),
    /// One child answers, the others do not count: that whose place, from 0, is nearest to this number.
    Select(f64),
    /// The child stands elsewhere: the map takes the child's space to the parent's.
    Affine(DAffine3),
    /// The child is deformed. A second child, if there is one, gives the weight of the deformation: see
    /// [`warp`](crate::warp).
    Warp(Warp),
    /// The leaves below have this attribute, unless another node of the same name counts for them.
    Attribute {
        /// The attribute group.
        name: Arc<str>,
        /// What they have.
        value: AttributeValue,
        /// Whether it counts beside others of the name.
        precedence: Precedence,
    },
    /// The leaves below are of this, unless another constant of the same name counts for them. Programs know
    /// nothing of it.
    Constant {
        /// What is told of them.
        name: Arc<str>,
        /// What it is.
        value: LeafConstant,
        /// Whether it counts beside others of the name.
        precedence: Precedence,
    },
}

impl NodeKind {
    /// The skeleton whose uv the field of a leaf has: a formula has that of a point at the origin of its
    /// space, and so have particles, but each about its own position.
    #[must_use]
    pub fn uv_skeleton(&self) -> &Skeleton {
        match self {
            Self::Primitive(primitive) => &primitive.skeleton,
            // Each has its own place besides.
            Self::Particles(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Affine(_)
            | Self::Warp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => Self::origin(),
        }
    }

    /// A point at the origin, whose uv formulas have.
    pub(crate) const fn origin() -> &'static Skeleton {
        static ORIGIN: Skeleton = Skeleton::Point(Point { at: DVec3::ZERO });
        &ORIGIN
    }

    /// The constant that it gives to the leaves below, and its name.
    #[must_use]
    pub fn constant(&self) -> Option<(&str, &LeafConstant)> {
        match self {
            Self::Constant { name, value, .. } => Some((name, value)),
            Self::Primitive(_)
            | Self::Particles(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Affine(_)
            | Self::Warp(_)
            | Self::Attribute { .. } => None,
        }
    }

    /// The group of which it gives leaves an attribute.
    fn group(&self) -> Option<&str> {
        if let Self::Attribute { name, .. } = self { Some(name) } else { None }
    }

    /// Whether it gives leaves something that no node below changes.
    #[must_use]
    pub fn overrides(&self) -> bool {
        match self {
            Self::Attribute { precedence, .. } | Self::Constant { precedence, .. } => {
                *precedence == Precedence::Override
            }
            Self::Primitive(_)
            | Self::Particles(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Affine(_)
            | Self::Warp(_) => false,
        }
    }

    /// Whether it gives leaves the same thing as another node: the attribute of one group, or the constant of
    /// one name.
    pub(crate) fn binds_what(&self, other: &Self) -> bool {
        let constants = [self, other].map(|kind| kind.constant().map(|(name, _)| name));
        let groups = [self, other].map(Self::group);
        constants[0].is_some() && constants[0] == constants[1]
            || groups[0].is_some() && groups[0] == groups[1]
    }

    /// The rows of an affine map, the last column of which is the shift; `None` for any other node.
    #[must_use]
    pub fn rows(&self) -> Option<[[f64; 4]; 3]> {
        match self {
            Self::Affine(map) => Some(rows_of(map)),
            Self::Primitive(_)
            | Self::Particles(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Warp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => None,
        }
    }

    /// The children that answer: of a selector the chosen one, of any other node all. Panics, if a selector's
    /// number is near no child: the check has excluded it.
    #[must_use]
    pub fn asked<'a, T>(&self, children: &'a [T]) -> &'a [T] {
        &children[self.places_asked(children.len())]
    }

    /// The places of the children that answer, of so many.
    pub(crate) fn places_asked(&self, count: usize) -> Range<usize> {
        match self {
            Self::Select(which) => chosen(*which)..chosen(*which) + 1,
            Self::Primitive(_)
            | Self::Particles(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Affine(_)
            | Self::Warp(_)
            | Self::Attribute { .. }
            | Self::Constant { .. } => 0..count,
        }
    }
}

/// The rows of a map, the last column of which is the shift.
pub(crate) fn rows_of(map: &DAffine3) -> [[f64; 4]; 3] {
    let columns = map.to_cols_array_2d();
    [0, 1, 2].map(|row| columns.map(|column| column[row]))
}

/// The place of the child that a selector's number stands for: the nearest whole number. The number has been
/// checked.
pub fn chosen(which: f64) -> usize {
    which.round() as usize
}
