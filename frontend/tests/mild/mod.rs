//! Random models of ordinary numbers, which pass the check: what lowering is tried with.
#![allow(dead_code, reason = "each test file uses its own part")]

use fastrand::Rng;
use glam::{DAffine3, DQuat, DVec3};
use jbt_frontend::affine::scale_rotate_translate;
use jbt_frontend::attribute::{AttributeGroup, Mixing};
use jbt_frontend::combine::{Combinator, Family, SetOperation};
use jbt_frontend::falloff::FalloffKind;
use jbt_frontend::field::{Field, FieldKind, FieldValue};
use jbt_frontend::model::Model;
use jbt_frontend::number::param;
use jbt_frontend::skeleton::SkeletonKind;
use jbt_frontend::tree::{NodeKind, Primitive, Tree};
use jbt_frontend::warp::WarpKind;

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
            FieldValue::Real(if rng.bool() { number.ceil() } else { number })
        }
        FieldKind::Choice(words) => FieldValue::Real(rng.usize(..words.len()) as f64),
        FieldKind::Count => FieldValue::Real(count(field, rng.u8(..6))),
        FieldKind::Position | FieldKind::Direction => FieldValue::Vector(vector(rng, 1.0)),
        FieldKind::Extents => FieldValue::Vector(vector(rng, 1.0).map(f64::abs)),
        FieldKind::Axis => FieldValue::Vector(DVec3::AXES[rng.usize(..3)].to_array()),
    };
    fields.iter().map(value).collect()
}

/// A count, which may be 0 where that is its default.
fn count(field: &Field, count: u8) -> f64 {
    f64::from(if field.default.is_none() { count + 1 } else { count })
}

/// A leaf of any kind; one in eight is negative if `signs`.
pub fn leaf(rng: &mut Rng, signs: bool) -> Primitive {
    let kind = *rng.choice(SkeletonKind::ALL).expect("there are skeletons");
    let strength = match rng.u8(..8) {
        0 if signs => -0.1 - rng.f64(),
        1 => 0.5 + rng.f64(),
        _ => 1.0,
    };
    let skeleton = kind.from_fields(&fields(rng, kind.fields()));
    let falloff = *rng.choice(FalloffKind::ALL).expect("there are falloffs");
    let falloff = falloff.from_fields(&fields(rng, falloff.fields()));
    Primitive { skeleton, falloff, radius: 0.1 + rng.f64(), strength }
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

/// A warp of any kind.
pub fn warp(rng: &mut Rng) -> NodeKind {
    let kind = *rng.choice(WarpKind::ALL).expect("there are warps");
    NodeKind::Warp(kind.from_fields(&fields(rng, kind.fields())))
}

/// A map of the field, for iso-values from 0.2.
fn field_map(rng: &mut Rng) -> NodeKind {
    NodeKind::Combine(match rng.u8(..6) {
        0 => Combinator::Complement,
        1 => Combinator::Clamp { low: 0.4 * rng.f64() - 0.2, high: 0.3 + rng.f64() },
        2 => Combinator::Clamp { low: 0.0, high: 0.3 + rng.f64() },
        3 | 4 => Combinator::Shell(0.05 + 0.3 * rng.f64()),
        _ => Combinator::Offset(0.3 * rng.f64() - 0.15),
    })
}

fn unary(rng: &mut Rng) -> NodeKind {
    match rng.u8(..5) {
        3 if rng.u8(..3) == 0 => field_map(rng),
        0 => NodeKind::Attribute { name: "color".into(), values: vector(rng, 1.0).into() },
        1 => NodeKind::Attribute { name: "wood".into(), values: vec![rng.f64()] },
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

fn family(rng: &mut Rng) -> Family {
    match rng.u8(..3) {
        0 => Family::Alpha(1.9 * rng.f64() - 0.9),
        1 => Family::Order(rng.u32(1..5)),
        _ => Family::Power(1.5 + 4.0 * rng.f64()),
    }
}

fn combinator(rng: &mut Rng) -> Combinator {
    let set = SetOperation::ALL[rng.usize(..3)];
    match rng.u8(..17) {
        14..17 => Combinator::Difference,
        7 => Combinator::Product,
        8 => Combinator::SymmetricDifference,
        9 | 10 => Combinator::Smooth(set, 0.05 + 0.4 * rng.f64()),
        11 => Combinator::RFunction(set, family(rng)),
        12 => Combinator::Ricci(-f64::from(rng.u32(1..5))),
        13 => Combinator::Ricci(-1.0 - 4.0 * rng.f64()),
        0 | 1 => Combinator::Sum,
        2 => Combinator::Ricci(f64::from(rng.u32(1..5))),
        3 => Combinator::Ricci(1.0 + 4.0 * rng.f64()),
        4 => Combinator::Intersection,
        5 => Combinator::Difference,
        _ => Combinator::Union,
    }
}

/// A model of up to `steps` nodes and leaves, built upwards; nodes that were used once may be used again.
pub fn model(rng: &mut Rng, steps: usize, signs: bool) -> Model {
    let wood = AttributeGroup { name: "wood".into(), default: vec![0.5], mixing: Mixing::Dominant };
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
            1 | 2 => Tree::new(unary(rng), vec![pick(rng)]),
            3 if rng.u8(..4) == 0 => {
                let children: Vec<Tree> = (0..rng.usize(1..4)).map(|_| pick(rng)).collect();
                let which = rng.usize(..children.len()) as f64;
                Tree::new(NodeKind::Select(which), children)
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
    Model { iso, attributes: vec![AttributeGroup::color(), wood], ..Model::new(root) }
}
