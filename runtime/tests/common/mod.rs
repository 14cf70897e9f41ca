//! Random models: a shape from one seed, its numbers from another, so that one shape can be tried with many
//! sets of numbers.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::sync::Arc;

use fastrand::Rng;
use jbt::build::{Term, noise, param, x, y, z};
use jbt::{Model, Number};
use jbt_frontend::affine::scale_rotate_translate;
use jbt_frontend::attribute::{AttributeGroup, AttributeValue, Mixing, Textured, UvMap};
use jbt_frontend::combine::{Combinator, Family, SetOperation};
use jbt_frontend::falloff::{Falloff, FalloffKind};
use jbt_frontend::field::{Field, FieldKind, FieldValue};
use jbt_frontend::kind::{NodeKind, Primitive};
use jbt_frontend::skeleton::SkeletonKind;
use jbt_frontend::texture::TextureKind;
use jbt_frontend::tree::Tree;
use jbt_frontend::warp::WarpKind;

/// The seeds of a model: what selects code comes from `shape`, everything else from `numbers`.
pub struct Random {
    shape: Rng,
    numbers: Rng,
    /// Trees that may be used once more.
    done: Vec<Tree>,
    /// How many parameters there are.
    parameters: usize,
}

impl Random {
    /// The generator of a shape and a set of numbers.
    pub fn new(shape: u64, numbers: u64) -> Self {
        Self {
            shape: Rng::with_seed(shape),
            numbers: Rng::with_seed(numbers),
            done: Vec::new(),
            parameters: 0,
        }
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.numbers.f64()
    }

    fn vector(&mut self, size: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-size, size))
    }

    /// A model of about `leaves` leaves, with colours and some other groups.
    pub fn model(mut self, leaves: usize) -> Model {
        let mut attributes = vec![AttributeGroup::color()];
        for index in 0..self.shape.usize(0..3) {
            attributes.push(AttributeGroup {
                name: format!("group{index}").into(),
                default: (0..[1, 2, 2, 3, 4, 7][self.shape.usize(0..6)])
                    .map(|_| self.between(-1.0, 1.0))
                    .collect(),
                mixing: if self.shape.bool() { Mixing::Blend } else { Mixing::Dominant },
            });
        }
        let root = self.tree(leaves, &attributes, 0);
        Model { iso: self.between(0.3, 0.6).into(), attributes, ..Model::new(root) }
    }

    fn tree(&mut self, leaves: usize, attributes: &[AttributeGroup], depth: usize) -> Tree {
        if !self.done.is_empty() && self.shape.u8(0..10) == 0 {
            let again = self.done[self.shape.usize(0..self.done.len())].clone();
            return self.unary(again, attributes);
        }
        let tree = if leaves <= 1 || depth > 6 {
            self.leaf()
        } else {
            let parts = self.shape.usize(1..leaves.min(5) + 1);
            let children: Vec<Tree> =
                (0..parts).map(|_| self.tree(leaves / parts, attributes, depth + 1)).collect();
            let set = SetOperation::ALL[self.shape.usize(0..3)];
            let kind = NodeKind::Combine(match self.shape.u8(0..21) {
                9 => Combinator::Product,
                10 => Combinator::SymmetricDifference,
                11 => Combinator::Smooth(set, self.between(0.05, 0.5)),
                12 => {
                    let width = self.between(0.05, 0.5);
                    let width = self.parameter("width", width);
                    return self.finished(Tree::smooth(set, width, children), attributes);
                }
                13 => Combinator::RFunction(set, self.family()),
                14 => Combinator::Ricci(match self.shape.u8(0..3) {
                    0 => -f64::from(self.shape.u32(1..20)),
                    1 => -self.between(1.01, 9.9),
                    _ => -512.0,
                }),
                0 | 1 => Combinator::Sum,
                2 => Combinator::Ricci(f64::from(self.shape.u32(1..20))),
                3 => Combinator::Ricci(if self.shape.bool() { self.between(1.01, 9.9) } else { 1024.0 }),
                4 => Combinator::Intersection,
                5 => Combinator::Difference,
                6 | 7 | 15..18 => Combinator::Union,
                18 => Combinator::Sum,
                8 | 19 => return self.expression(&children, attributes),
                _ => {
                    // Which child answers is a number as any other.
                    let which = self.between(-0.49, parts as f64 - 0.51);
                    let which = self.parameter("choice", which);
                    return self.finished(Tree::select(which, children), attributes);
                }
            });
            Tree::new(kind, children)
        };
        self.finished(tree, attributes)
    }

    /// A formula, of the point or of some of the children.
    fn expression(&mut self, children: &[Tree], attributes: &[AttributeGroup]) -> Tree {
        let (low, high) = (self.vector(0.8).map(|low| low - 0.9), self.vector(0.8).map(|high| high + 0.9));
        let (p, q) = (self.between(0.3, 0.9), self.between(0.3, 0.9));
        let [a, b, c] = std::array::from_fn(|place| children[place % children.len()].field());
        let size = || (x() * x() + y() * y() + z().powf(2.0)).sqrt();
        let tree = match self.shape.u8(0..9) {
            0 => Tree::expression((p - size()).clamp(-0.5, 1.5)),
            1 => Tree::expression_within(q + 0.3 * (2.0 * x()).sin() * y(), low, high),
            2 => Tree::expression(size() - p).fading(Falloff::Wyvill, q),
            3 => Tree::expression((p * &a * &b).clamp(-1.5, 1.5)),
            4 => Tree::expression((0.7 * &a * &b - q * c.square()).max(-1.0).min(1.0)),
            5 => children[0].within(low, high),
            6 => Tree::expression(&a * (1.0 + p * (2.0 * x()).sin()) + q * (&b - &a)),
            7 => Tree::expression(a.max(b.min(p)) / (1.0 + y().abs()) + q * (&c * &c + 0.1).sqrt()),
            _ => {
                Tree::expression(p * a.clamp(-0.5, 1.5).atan2(2.0 + b.abs()) + 0.2 * (z() * 0.5).tan().atan())
            }
        };
        self.finished(tree, attributes)
    }

    fn finished(&mut self, tree: Tree, attributes: &[AttributeGroup]) -> Tree {
        let tree = self.unary(tree, attributes);
        self.done.push(tree.clone());
        tree
    }

    fn leaf(&mut self) -> Tree {
        let kind = SkeletonKind::ALL[self.shape.usize(0..SkeletonKind::ALL.len())];
        let mut fields = self.fields(kind.fields());
        fit(kind, &mut fields);
        let skeleton = kind.from_fields(&fields);
        let strength = match self.shape.u8(0..8) {
            0 => -self.between(0.1, 0.8),
            1 | 2 => self.between(0.5, 1.7),
            _ => 1.0,
        };
        let falloff = FalloffKind::ALL[self.shape.usize(0..FalloffKind::ALL.len())];
        let falloff = falloff.from_fields(&self.fields(falloff.fields()));
        let radius = self.between(0.5, 1.5);
        Tree::new(NodeKind::Primitive(Primitive { skeleton, falloff, radius, strength }), Vec::new())
    }

    /// Values that a member of an open set may have.
    pub fn fields(&mut self, fields: &[Field]) -> Vec<FieldValue> {
        let mut values = Vec::new();
        for field in fields {
            values.push(match field.kind {
                FieldKind::Real => FieldValue::Real(self.between(-1.5, 1.5)),
                FieldKind::Positive | FieldKind::NonNegative => FieldValue::Real(self.between(0.1, 1.0)),
                // Whole numbers may be code.
                FieldKind::Within { least, most } if most > 2.0 && self.shape.bool() => {
                    let (least, most) = (least.ceil() as u32, most.min(8.0) as u32);
                    FieldValue::Real(f64::from(self.shape.u32(least.max(1)..=most)))
                }
                FieldKind::Within { least, most } => FieldValue::Real(self.between(least, most.min(8.0))),
                FieldKind::Choice(words) => FieldValue::Real(self.shape.usize(0..words.len()) as f64),
                // 0 where that is the default.
                FieldKind::Count if field.default.is_some() => FieldValue::Real(self.numbers.u8(0..6).into()),
                FieldKind::Count => FieldValue::Real(self.numbers.u8(1..6).into()),
                FieldKind::Position => FieldValue::Vector(self.vector(1.0)),
                FieldKind::Degrees => FieldValue::Real(self.between(0.0, 360.0)),
                FieldKind::Stretches => FieldValue::Vector(self.vector(1.0).map(|x| 0.3 + x.abs())),
                FieldKind::Extents => FieldValue::Vector(self.vector(1.0).map(f64::abs)),
                FieldKind::Direction => FieldValue::Vector(self.vector(1.0)),
                FieldKind::Positions => {
                    // As many as a chain of curves has. How many there are is a number as any other.
                    let count = 1 + 3 * self.numbers.usize(1..4);
                    FieldValue::Vectors((0..count).map(|_| self.vector(1.0)).collect())
                }
                FieldKind::Lengths => FieldValue::Reals((0..10).map(|_| self.between(0.0, 0.3)).collect()),
                FieldKind::Flag => FieldValue::Real(f64::from(self.numbers.u8(0..2))),
                FieldKind::Rows => unreachable!("only maps have rows"),
                FieldKind::Axis => {
                    let axis = self.shape.usize(0..3);
                    FieldValue::Vector(std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 }))
                }
            });
        }
        values
    }

    /// The tree under up to two unary nodes.
    fn unary(&mut self, mut tree: Tree, attributes: &[AttributeGroup]) -> Tree {
        for _ in 0..self.shape.usize(0..3) {
            let kind = match self.shape.u8(0..11) {
                10 => self.field_map(),
                0..3 => {
                    let group = &attributes[self.shape.usize(0..attributes.len())];
                    let pick = self.shape.u8(0..6);
                    if pick == 0 {
                        tree = if self.shape.bool() {
                            self.textured_following(&tree, group)
                        } else {
                            self.expressed(&tree, group)
                        };
                        continue;
                    }
                    NodeKind::Attribute {
                        name: Arc::clone(&group.name),
                        value: self.value(pick, group.width()),
                    }
                }
                3 => {
                    let warp = self.warp();
                    if self.shape.u8(0..4) == 0 {
                        let weight = self.leaf();
                        tree = Tree::new(warp, vec![tree, weight]);
                        continue;
                    }
                    warp
                }
                4 => {
                    tree = self.following(&tree);
                    continue;
                }
                _ => self.affine(),
            };
            tree = Tree::new(kind, vec![tree]);
        }
        tree
    }

    /// A warp of any kind, or one that is given by formulas.
    fn warp(&mut self) -> NodeKind {
        let Some(&kind) = WarpKind::ALL.get(self.shape.usize(0..WarpKind::ALL.len() + 1)) else {
            return self.formula_warp();
        };
        NodeKind::Warp(kind.from_fields(&self.fields(kind.fields())))
    }

    /// Formulas of bounded derivatives, with a definition, with a pole that is not there, with a crease.
    fn formula_warp(&mut self) -> NodeKind {
        let [p, q, r] = self.vector(1.0);
        let turn = p * z();
        let coordinates = match self.shape.u8(0..4) {
            0 => [x() + 0.3 * p * (3.0 * q * y()).sin(), y() + r, z() * 0.9],
            1 => [x() * turn.cos() + y() * turn.sin(), y() * turn.cos() - x() * turn.sin(), z()],
            2 => [x() / (1.0 + r.abs() * z() * z()), y(), z() + 0.2 * q],
            _ => [x().abs() + 0.3 * p, y() + 0.1 * x() * y(), z().max(2.0 * z() + q)],
        };
        let still = Tree::combine(Combinator::Sum, Vec::<Tree>::new()).warp(coordinates);
        still.node().written().evaluated(0.5).expect("formulas mean something")
    }

    fn family(&mut self) -> Family {
        match self.shape.u8(0..3) {
            0 => Family::Alpha(self.between(-0.8, 1.0)),
            1 => Family::Order(self.shape.u32(1..4)),
            _ => Family::Power(self.between(1.5, 6.0)),
        }
    }

    /// A map of the field, for iso-values from 0.3. Whether a clamp lets negative fields pass selects code.
    fn field_map(&mut self) -> NodeKind {
        NodeKind::Combine(match self.shape.u8(0..6) {
            0 => Combinator::Complement,
            1 => Combinator::Clamp { low: -self.between(0.01, 0.5), high: self.between(0.4, 1.3) },
            2 => Combinator::Clamp { low: self.between(0.0, 0.2), high: self.between(0.4, 1.3) },
            3 => Combinator::Clamp { low: 0.0, high: self.between(0.4, 1.3) },
            4 => Combinator::Shell(self.between(0.05, 0.5)),
            _ => Combinator::Offset(self.between(-0.3, 0.2)),
        })
    }

    fn units(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.between(0.0, 1.0)).collect()
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

    /// The tree with a noise that follows parameters: its code serves all their values.
    fn textured_following(&mut self, tree: &Tree, group: &AttributeGroup) -> Tree {
        let (octaves, low) = (self.between(0.5, 3.5), self.between(0.0, 1.0));
        let pattern = noise(self.between(0.3, 1.0), self.parameter("octaves", octaves), 0);
        let a = vec![self.parameter("low", low); group.width()];
        let b: Vec<Number> = self.units(group.width()).into_iter().map(Number::from).collect();
        tree.textured(&group.name, pattern, &a, &b)
    }

    /// The tree with a formula as an attribute, with a number that follows a parameter.
    fn expressed(&mut self, tree: &Tree, group: &AttributeGroup) -> Tree {
        let (size, part) = (self.between(0.3, 2.0), self.between(0.0, 1.0));
        let follows = self.parameter("wave", size);
        let radius = (x() * x() + y() * y() + z() * z()).sqrt();
        // The last one is infinite or no number where the point is.
        let all = [
            (x() * follows).sin() * part,
            radius.falloff(Falloff::Wyvill),
            y().clamp(-part, part),
            radius.clone() + part,
            Term::from(part),
            radius.square() - radius.square() * x().abs() / (1.0 + x().abs()),
        ];
        let values = (0..group.width()).map(|_| all[self.shape.usize(0..all.len())].clone());
        let values: Vec<Term> = values.collect();
        tree.expressed(&group.name, values)
    }

    /// A new parameter.
    fn parameter(&mut self, kind: &str, value: f64) -> Number {
        self.parameters += 1;
        param(&format!("{kind}{}", self.parameters), value)
    }

    /// The tree under a map that follows a parameter of its own: its code serves all values.
    fn following(&mut self, tree: &Tree) -> Tree {
        let value = self.between(-1.0, 1.0);
        let follows = self.parameter("map", value);
        match self.shape.u8(0..3) {
            0 => tree.translate((follows, 0.0, self.between(-0.5, 0.5))),
            1 => tree.scale(1.0 + 0.4 * follows),
            _ => tree.rotate([0.3, 0.5, 1.0], 90.0 * follows),
        }
    }

    fn affine(&mut self) -> NodeKind {
        let translation = glam(self.vector(0.7));
        let turned = {
            let [x, y, z] = self.vector(1.0);
            glam::DQuat::from_xyzw(x, y, z, 0.4).normalize()
        };
        let still = glam::DQuat::IDENTITY;
        let size = self.between(0.6, 1.4);
        let even = glam::DVec3::splat(size);
        let uneven = glam(self.vector(0.4)) + even;
        NodeKind::Affine(match self.shape.u8(0..6) {
            0 => scale_rotate_translate(glam::DVec3::ONE, still, translation),
            1 => scale_rotate_translate(even, still, translation),
            2 => scale_rotate_translate(even, turned, translation),
            3 => scale_rotate_translate(-even, turned, translation),
            _ => scale_rotate_translate(uneven, turned, translation),
        })
    }
}

/// Makes parameters that are well by themselves fit each other: a radius for all points or one for each,
/// corners in a plane.
pub fn fit(kind: SkeletonKind, values: &mut [FieldValue]) {
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

fn glam(vector: [f64; 3]) -> glam::DVec3 {
    vector.into()
}

/// Points that hurt: zeros of both signs, subnormals, huge numbers, infinities, NaN.
pub const SPICE: [f32; 12] =
    [0.0, -0.0, 1.0, -0.5, 1e-45, -1e-39, 1e30, -1e30, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];

/// Finite coordinates at which squares, cubes and products of lengths overflow or underflow.
pub const HOSTILE: [f32; 24] = [
    0.0,
    -0.0,
    1e-45,
    -1e-39,
    1e-20,
    0.25,
    -1.0,
    5.0,
    -1e4,
    1_048_576.0,
    1e9,
    -1e12,
    1e15,
    1e19,
    -1e19,
    2e19,
    -2e19,
    4e25,
    -1e30,
    1e30,
    2e38,
    -3e38,
    f32::MIN,
    f32::MAX,
];

/// Ordinary points within `size` of the origin, with spicy ones among them.
pub fn points(rng: &mut Rng, count: usize, size: f32) -> jbt::Points {
    (0..count)
        .map(|_| {
            let mut point = std::array::from_fn(|_| (2.0 * rng.f32() - 1.0) * size);
            if rng.u8(0..4) == 0 {
                for _ in 0..rng.usize(1..4) {
                    point[rng.usize(0..3)] = SPICE[rng.usize(0..SPICE.len())];
                }
            }
            point
        })
        .collect()
}
