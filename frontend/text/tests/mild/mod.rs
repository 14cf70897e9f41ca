//! Random models of ordinary numbers, which pass the check: what lowering is tried with.
#![allow(dead_code, reason = "each test file uses its own part")]

use fastrand::Rng;
use glam::{DAffine3, DQuat, DVec3};
use jbt_model::affine::scale_rotate_translate;
use jbt_model::attribute::{AttributeGroup, AttributeValue, Mixing, Textured, UvMap};
use jbt_model::builder::{Term, x, y, z};
use jbt_model::combine::{
    Clamp, Combinator, Complement, Difference, Intersection, Offset, Product, RFunction, RFunctionOrder,
    RFunctionPower, Ricci, SetOperation, Shell, Sum, SymmetricDifference, Union,
};
use jbt_model::falloff::{Falloff, FalloffKind};
use jbt_model::field::{Field, FieldKind, FieldValue};
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::model::Model;
use jbt_model::number::param;
use jbt_model::skeleton::{Skeleton, SkeletonKind};
use jbt_model::texture::TextureKind;
use jbt_model::tree::Tree;
use jbt_model::warp::WarpKind;

/// Three numbers within `size` of 0.
pub fn vector(rng: &mut Rng, size: f64) -> [f64; 3] {
    std::array::from_fn(|_| size * (2.0 * rng.f64() - 1.0))
}

/// Parameters of a member: positions and lengths up to 1.
pub fn fields(rng: &mut Rng, fields: &[Field]) -> Vec<FieldValue> {
    let value = |field: &Field| match field.kind {
        FieldKind::Real => FieldValue::Real(3.0 * rng.f64() - 1.5),
        FieldKind::Positive | FieldKind::NonNegative => FieldValue::Real(0.05 + rng.f64()),
        FieldKind::Within { least, most } => {
            let number = least + (most.min(8.0) - least) * rng.f64();
            // Whole numbers may be code.
            FieldValue::Real(if most > 2.0 && rng.bool() { number.ceil() } else { number })
        }
        FieldKind::Choice(words) => FieldValue::Real(rng.usize(..words.len()) as f64),
        FieldKind::Whole { least, most } => FieldValue::Real(rng.u32(least..=most).into()),
        FieldKind::Count => FieldValue::Real(count(field, rng.u8(..6))),
        FieldKind::Position | FieldKind::Direction => FieldValue::Vector(vector(rng, 1.0)),
        FieldKind::Degrees => FieldValue::Real(360.0 * rng.f64()),
        FieldKind::Stretches => FieldValue::Vector(vector(rng, 1.0).map(|x| 0.3 + x.abs())),
        FieldKind::Extents => FieldValue::Vector(vector(rng, 1.0).map(f64::abs)),
        FieldKind::Positions => {
            // As many as a chain of curves has.
            let count = 1 + 3 * rng.usize(1..4);
            FieldValue::Vectors((0..count).map(|_| vector(rng, 1.0)).collect())
        }
        FieldKind::Lengths => FieldValue::Reals((0..10).map(|_| 0.3 * rng.f64()).collect()),
        FieldKind::Flag => FieldValue::Real(f64::from(rng.u8(..2))),
        FieldKind::Rows => unreachable!("only maps have rows"),
        FieldKind::Axis => FieldValue::Vector(DVec3::AXES[rng.usize(..3)].to_array()),
    };
    fields.iter().map(value).collect()
}

/// A count, which may be 0 where that is its default.
fn count(field: &Field, count: u8) -> f64 {
    f64::from(if field.default.is_none() { count + 1 } else { count })
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

/// A leaf of any kind; one in eight is negative if `signs`.
pub fn leaf(rng: &mut Rng, signs: bool) -> Primitive {
    let kind = *rng.choice(SkeletonKind::ALL).expect("there are skeletons");
    let strength = match rng.u8(..8) {
        0 if signs => -0.1 - rng.f64(),
        1 => 0.5 + rng.f64(),
        _ => 1.0,
    };
    let (skeleton, falloff) = (skeleton(rng, kind), falloff(rng));
    Primitive { skeleton, falloff, radius: 0.1 + rng.f64(), strength }
}

/// A skeleton of this kind.
pub fn skeleton(rng: &mut Rng, kind: SkeletonKind) -> Skeleton {
    let mut fields = fields(rng, kind.fields());
    fit(kind, &mut fields);
    kind.from_fields(&fields)
}

/// A falloff of any kind.
pub fn falloff(rng: &mut Rng) -> Falloff {
    let kind = *rng.choice(FalloffKind::ALL).expect("there are falloffs");
    kind.from_fields(&fields(rng, kind.fields()))
}

/// A map of any kind: moved, scaled, turned, mirrored, stretched.
pub fn affine(rng: &mut Rng) -> DAffine3 {
    let turn = DQuat::from_vec4(glam::DVec4::from((DVec3::from(vector(rng, 1.0)), 0.4))).normalize();
    let to = DVec3::from(vector(rng, 1.0));
    let size = DVec3::splat(0.4 + rng.f64());
    match rng.u8(..6) {
        0 => DAffine3::from_translation(to),
        1 => scale_rotate_translate(size, DQuat::IDENTITY, to),
        2 => scale_rotate_translate(-size, DQuat::IDENTITY, to),
        3 | 4 => scale_rotate_translate(size, turn, to),
        _ => scale_rotate_translate(size + 0.5 * DVec3::from(vector(rng, 0.7)), turn, to),
    }
}

/// A warp of any kind, or one that is given by formulas.
pub fn warp(rng: &mut Rng) -> NodeKind {
    if rng.usize(..WarpKind::ALL.len() + 1) == 0 {
        return formula_warp(rng);
    }
    let kind = *rng.choice(WarpKind::ALL).expect("there are warps");
    NodeKind::Warp(kind.from_fields(&fields(rng, kind.fields())))
}

/// A warp that is given by formulas: of bounded derivatives, with a definition, with a pole that is not
/// there, with a crease.
pub fn formula_warp(rng: &mut Rng) -> NodeKind {
    let [p, q, r] = vector(rng, 1.0);
    let turn = p * z();
    let coordinates = match rng.u8(..4) {
        0 => [x() + 0.3 * p * (3.0 * q * y()).sin(), y() + r, z() * 0.9],
        1 => [x() * turn.cos() + y() * turn.sin(), y() * turn.cos() - x() * turn.sin(), z()],
        2 => [x() / (1.0 + r.abs() * z() * z()), y(), z() + 0.2 * q],
        _ => [x().abs() + 0.3 * p, y() + 0.1 * x() * y(), z().max(2.0 * z() + q)],
    };
    let still = Tree::sum(Vec::<Tree>::new()).warp(coordinates);
    still.node().written().evaluated(0.5).expect("formulas mean something")
}

/// A map of the field, for iso-values from 0.2.
fn field_map(rng: &mut Rng) -> NodeKind {
    NodeKind::Combine(match rng.u8(..6) {
        0 => Complement {}.into(),
        1 => Clamp { low: 0.4 * rng.f64() - 0.2, high: 0.3 + rng.f64() }.into(),
        2 => Clamp { low: 0.0, high: 0.3 + rng.f64() }.into(),
        3 | 4 => Shell { thickness: 0.05 + 0.3 * rng.f64() }.into(),
        _ => Offset { by: 0.3 * rng.f64() - 0.15 }.into(),
    })
}

/// The groups of all models.
fn groups() -> Vec<AttributeGroup> {
    let wood = AttributeGroup { name: "wood".into(), default: vec![0.5], mixing: Mixing::Dominant };
    let uv = AttributeGroup { name: "uv".into(), default: vec![0.0; 2], mixing: Mixing::Blend };
    vec![AttributeGroup::color(), wood, uv]
}

/// What an attribute node of any kind gives.
fn attribute(rng: &mut Rng) -> NodeKind {
    let group = rng.choice(groups()).expect("there are groups");
    let numbers = |rng: &mut Rng| (0..group.width()).map(|_| rng.f64()).collect::<Vec<f64>>();
    let value = match rng.u8(..3) {
        0 => {
            let kind = *rng.choice(TextureKind::ALL).expect("there are textures");
            let texture = kind.from_fields(&fields(rng, kind.fields()));
            AttributeValue::Textured(Textured { texture, a: numbers(rng), b: numbers(rng) })
        }
        1 if group.width() == 2 => {
            let (scale, shift) = ([rng.f64(), -rng.f64()], [rng.f64(), rng.f64()]);
            AttributeValue::Uv(UvMap { scale, degrees: 90.0 * rng.f64(), shift })
        }
        _ => AttributeValue::Numbers(numbers(rng)),
    };
    NodeKind::Attribute { name: group.name, value }
}

/// The tree with a formula as an attribute, of one of the groups.
fn expressed(rng: &mut Rng, tree: &Tree) -> Tree {
    let group = rng.choice(groups()).expect("there are groups");
    let (p, q) = (rng.f64(), 1.0 + 3.0 * rng.f64());
    let radius = (x() * x() + y() * y() + z() * z()).sqrt();
    let all = [
        (q * x()).sin() * p,
        radius.clone() - p,
        radius.falloff(Falloff::Wyvill),
        y().clamp(-p, p),
        p.into(),
    ];
    let value = |_| all[rng.usize(..all.len())].clone();
    let values: Vec<Term> = (0..group.width()).map(value).collect();
    tree.expressed(&group.name, values)
}

fn unary(rng: &mut Rng) -> NodeKind {
    match rng.u8(..5) {
        3 if rng.u8(..3) == 0 => field_map(rng),
        0 | 1 => attribute(rng),
        2 => warp(rng),
        _ => NodeKind::Affine(affine(rng)),
    }
}

/// A tree under a map that follows a parameter of its own: its code serves all values.
fn following(rng: &mut Rng, tree: &Tree, index: usize) -> Tree {
    let follows = param(&format!("p{index}"), 2.0 * rng.f64() - 1.0);
    match rng.u8(..3) {
        0 => tree.translate((follows, 0.0, 0.5 - rng.f64())),
        1 => tree.scale(1.0 + 0.5 * follows),
        _ => tree.rotate([0.3, 0.5, 1.0], 90.0 * follows),
    }
}

fn rfunction(rng: &mut Rng, set: SetOperation) -> Combinator {
    match rng.u8(..3) {
        0 => RFunction { set, alpha: 1.9 * rng.f64() - 0.9 }.into(),
        1 => RFunctionOrder { set, order: rng.u32(1..5) }.into(),
        _ => RFunctionPower { set, power: 1.5 + 4.0 * rng.f64() }.into(),
    }
}

/// A formula, of the point or of some of the children.
fn expression(rng: &mut Rng, [a, b, c]: &[Tree; 3]) -> Tree {
    let high = vector(rng, 0.9).map(|side| side.abs() + 0.1);
    let p = 0.3 + rng.f64();
    let (f, g, h) = (a.field(), b.field(), c.field());
    let size = (x() * x() + y() * y() + z() * z()).sqrt();
    match rng.u8(..6) {
        0 => Tree::expression((p - size).clamp(-0.5, 1.5)),
        1 => Tree::expression_within(p + 0.3 * (2.0 * x()).sin() * y(), high.map(|side| -side), high),
        2 => Tree::expression(size - p).fading(falloff(rng), p),
        3 => Tree::expression((0.7 * f * g - p * h.square()).clamp(-1.0, 1.0)),
        4 => a.within(high.map(|side| -side), high),
        _ => Tree::expression(f.max(g.min(p)) / (1.0 + y().abs()) + 0.2 * (x() * 0.5).atan()),
    }
}

fn combinator(rng: &mut Rng) -> Combinator {
    let set = SetOperation::ALL[rng.usize(..3)];
    match rng.u8(..17) {
        14..17 => Difference {}.into(),
        7 => Product {}.into(),
        8 => SymmetricDifference {}.into(),
        9 | 10 => Combinator::smooth(set, 0.05 + 0.4 * rng.f64()),
        11 => rfunction(rng, set),
        12 => Ricci { exponent: -f64::from(rng.u32(1..5)) }.into(),
        13 => Ricci { exponent: -1.0 - 4.0 * rng.f64() }.into(),
        0 | 1 => Sum {}.into(),
        2 => Ricci { exponent: f64::from(rng.u32(1..5)) }.into(),
        3 => Ricci { exponent: 1.0 + 4.0 * rng.f64() }.into(),
        4 => Intersection {}.into(),
        5 => Difference {}.into(),
        _ => Union {}.into(),
    }
}

/// A model of up to `steps` nodes and leaves, built upwards; nodes that were used once may be used again.
pub fn model(rng: &mut Rng, steps: usize, signs: bool) -> Model {
    let plain = |leaf| Tree::new(NodeKind::Primitive(leaf), Vec::new());
    let mut trees = vec![plain(leaf(rng, signs))];
    for _ in 0..steps {
        let pick = |rng: &mut Rng| {
            let recent = trees.len().saturating_sub(4);
            let lowest = if rng.u8(..3) > 0 { recent } else { 0 };
            trees[rng.usize(lowest..trees.len())].clone()
        };
        let tree = match rng.u8(..5) {
            0 => plain(leaf(rng, signs)),
            1 if rng.u8(..5) == 0 => {
                let tree = pick(rng);
                following(rng, &tree, trees.len())
            }
            1 if rng.u8(..6) == 0 => Tree::new(warp(rng), vec![pick(rng), pick(rng)]),
            2 if rng.u8(..4) == 0 => {
                let tree = pick(rng);
                expressed(rng, &tree)
            }
            1 | 2 => Tree::new(unary(rng), vec![pick(rng)]),
            3 if rng.u8(..4) == 0 => {
                let children: Vec<Tree> = (0..rng.usize(1..4)).map(|_| pick(rng)).collect();
                let which = rng.usize(..children.len()) as f64;
                Tree::new(NodeKind::Select(which), children)
            }
            3 if rng.u8(..3) == 0 => {
                let children = [(); 3].map(|()| pick(rng));
                expression(rng, &children)
            }
            _ => {
                let fresh = rng.usize(..3);
                let mut children: Vec<Tree> = (0..rng.usize(1..4)).map(|_| pick(rng)).collect();
                children.extend((0..fresh).map(|_| plain(leaf(rng, signs))));
                Tree::new(NodeKind::Combine(combinator(rng)), children)
            }
        };
        trees.push(tree);
    }
    let root = trees.pop().expect("there is a leaf");
    let iso = (0.2 + 0.5 * rng.f64()).into();
    Model { iso, attributes: groups(), ..Model::new(root) }
}
