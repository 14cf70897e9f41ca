//! Random nodes, from the lists of members: leaves, warps, maps, attributes.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use jbt_model::affine::scale_rotate_translate;
use jbt_model::attribute::{AttributeGroup, AttributeValue, Precedence, Textured, UvMap};
use jbt_model::builder::noise;
use jbt_model::falloff::{Falloff, FalloffKind};
use jbt_model::field::FieldValue;
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::map::MapKind;
use jbt_model::number::Number;
use jbt_model::skeleton::{Skeleton, SkeletonKind};
use jbt_model::texture::TextureKind;
use jbt_model::tree::Tree;
use jbt_model::warp::WarpKind;
use jbt_model::written::{FieldNumber, Written};

use super::Random;

impl Random {
    /// A leaf of any kind.
    pub(super) fn leaf(&mut self) -> Tree {
        Tree::new(NodeKind::Primitive(self.primitive()), Vec::new())
    }

    /// A skeleton of any kind with any falloff.
    pub fn primitive(&mut self) -> Primitive {
        let kind = SkeletonKind::ALL[self.shape.usize(0..SkeletonKind::ALL.len())];
        let skeleton = self.skeleton(kind);
        let strength = match self.shape.u8(0..8) {
            0 if self.settings.negative => -self.between(0.1, 0.8),
            1 | 2 => self.between(0.5, 1.7),
            _ => 1.0,
        };
        let falloff = self.falloff();
        Primitive { skeleton, falloff, radius: self.between(0.5, 1.5), strength }
    }

    /// A skeleton of this kind.
    pub fn skeleton(&mut self, kind: SkeletonKind) -> Skeleton {
        let mut fields = self.fields(kind.fields());
        if !self.is_hostile() {
            fit(kind, &mut fields);
        }
        kind.from_fields(&fields)
    }

    /// A falloff of any kind.
    pub(super) fn falloff(&mut self) -> Falloff {
        let kind = FalloffKind::ALL[self.shape.usize(0..FalloffKind::ALL.len())];
        kind.from_fields(&self.fields(kind.fields()))
    }

    /// A warp of any kind, or one that is given by formulas.
    pub fn warp(&mut self) -> NodeKind {
        let Some(&kind) = WarpKind::ALL.get(self.shape.usize(0..WarpKind::ALL.len() + 1)) else {
            return self.formula_warp();
        };
        NodeKind::Warp(kind.from_fields(&self.fields(kind.fields())))
    }

    /// The tree under a warp, in one of four cases under the weight of a leaf.
    pub(super) fn warped(&mut self, tree: Tree) -> Tree {
        let warp = self.warp();
        let weight = (self.shape.u8(0..4) == 0).then(|| self.leaf());
        Tree::new(warp, std::iter::once(tree).chain(weight).collect())
    }

    /// An affine map: a matrix, or a member of the list as it is written.
    pub fn map(&mut self) -> Written {
        if self.is_hostile() {
            return match self.shape.u8(0..4) {
                0 => DAffine3::from_translation(self.vector(1.0).into()).into(),
                1 => DAffine3 {
                    matrix3: DMat3::from_cols_array(&[(); 9].map(|()| self.between(-1.0, 1.0))),
                    translation: self.vector(1.0).into(),
                }
                .into(),
                _ => self.listed_map(),
            };
        }
        let translation = self.vector(0.7).into();
        let turned = {
            let [x, y, z] = self.vector(1.0);
            DQuat::from_xyzw(x, y, z, 0.4).normalize()
        };
        let size = self.between(0.6, 1.4);
        let even = DVec3::splat(size);
        let uneven = DVec3::from(self.vector(0.4)) + even;
        let map = match self.shape.u8(0..6) {
            0 => scale_rotate_translate(DVec3::ONE, DQuat::IDENTITY, translation),
            1 => scale_rotate_translate(even, DQuat::IDENTITY, translation),
            2 => scale_rotate_translate(even, turned, translation),
            3 => scale_rotate_translate(-even, turned, translation),
            4 => scale_rotate_translate(uneven, turned, translation),
            _ => return self.listed_map(),
        };
        map.into()
    }

    /// A member of the list of maps. Ordinary ones neither stretch nor squeeze much.
    fn listed_map(&mut self) -> Written {
        let map = MapKind::ALL[self.shape.usize(0..MapKind::ALL.len())];
        // Whether a scale mirrors selects code; a rotation never does, whatever its numbers are.
        let mirrors = self.shape.bool();
        for tries in 0..1000 {
            let fields = self.fields(map.fields()).into_iter().map(FieldNumber::from).collect();
            let written = Written::Map { map, fields };
            let fits = |matrix: DMat3| {
                is_moderate(matrix) && (tries > 64 || (matrix.determinant() < 0.0) == mirrors)
            };
            if self.is_hostile() || meant(&written).is_some_and(|affine| fits(affine.matrix3)) {
                return written;
            }
        }
        panic!("{}: ordinary numbers are moderate maps, sometimes", map.name())
    }

    /// An affine map of ordinary numbers.
    pub fn affine(&mut self) -> DAffine3 {
        meant(&self.map()).expect("ordinary maps mean something")
    }

    /// The tree with an attribute of any kind.
    pub(super) fn attributed(&mut self, tree: &Tree, group: &AttributeGroup) -> Tree {
        let pick = self.shape.u8(0..6);
        if pick == 0 {
            return if self.shape.bool() {
                self.textured_following(tree, group)
            } else {
                self.expressed(tree, group)
            };
        }
        let value = self.value(pick, group.width());
        let precedence = if self.shape.u8(0..4) == 0 { Precedence::Override } else { Precedence::Nearest };
        let kind = NodeKind::Attribute { name: Arc::clone(&group.name), value, precedence };
        Tree::new(kind, vec![tree.clone()])
    }

    /// What an attribute node gives: numbers, a texture, or uv where that fits.
    fn value(&mut self, pick: u8, width: usize) -> AttributeValue {
        match pick {
            1 | 2 => {
                let kind = TextureKind::ALL[self.shape.usize(0..TextureKind::ALL.len())];
                let texture = kind.from_fields(&self.fields(kind.fields()));
                AttributeValue::Textured(Textured { texture, a: self.units(width), b: self.units(width) })
            }
            3 | 4 if width == 2 => {
                let (scale, shift) = ([self.between(-1.0, 1.0), 1.0], [0.0, self.between(-1.0, 1.0)]);
                AttributeValue::Uv(UvMap { scale, degrees: self.between(0.0, 90.0), shift })
            }
            _ => AttributeValue::Numbers(self.units(width)),
        }
    }

    /// The tree with a noise that depends on parameters: its code serves all their values.
    fn textured_following(&mut self, tree: &Tree, group: &AttributeGroup) -> Tree {
        let (octaves, low) = (self.between(0.5, 3.5), self.between(0.0, 1.0));
        let pattern = noise(self.between(0.3, 1.0), self.parameter("octaves", octaves), 0);
        let a = vec![self.parameter("low", low); group.width()];
        let b: Vec<Number> = self.units(group.width()).into_iter().map(Number::from).collect();
        tree.textured(&group.name, pattern, &a, &b)
    }
}

/// The matrix that a map means, if it means one.
fn meant(map: &Written) -> Option<DAffine3> {
    match map.evaluated(0.5) {
        Ok(NodeKind::Affine(affine)) => Some(affine),
        _ => None,
    }
}

/// Whether a map and its inverse make nothing more than about twice as long.
fn is_moderate(matrix: DMat3) -> bool {
    let size = |matrix: DMat3| matrix.to_cols_array().iter().map(|x| x * x).sum::<f64>();
    let largest = 8.0;
    size(matrix) < largest && matrix.determinant().abs() > 0.1 && size(matrix.inverse()) < largest
}

/// Makes parameters that are well by themselves fit each other: a radius for all points or one for each,
/// corners in a plane.
fn fit(kind: SkeletonKind, values: &mut [FieldValue]) {
    if kind == SkeletonKind::Polygon
        && let [FieldValue::Vectors(points)] = values
    {
        for [x, y, z] in points {
            *z = 0.3 * *x - 0.6 * *y + 0.1;
        }
    }
    if kind == SkeletonKind::Superquadric {
        // Sharper edges than these are no ordinary ones.
        values[1..3].iter_mut().for_each(|exponent| *exponent = FieldValue::Real(exponent.real().max(0.2)));
    }
    if let [FieldValue::Vectors(points), FieldValue::Reals(radii), ..] = values {
        // All lists of radii are as long as the longest list of points.
        radii.truncate(if radii.first().is_some_and(|first| *first < 0.1) { 0 } else { points.len() });
    }
}
