//! Random models: every member that the lists hold, every kind of number, shared subtrees.

use std::sync::Arc;

use fastrand::Rng;
use glam::{DAffine3, DMat3, DVec3};
use jbt_frontend::attribute::{AttributeGroup, AttributeValue, Mixing, Textured, UvMap};
use jbt_frontend::builder::{Term, param, x, y, z};
use jbt_frontend::combine::{Combinator, CombinatorKind};
use jbt_frontend::falloff::{Falloff, FalloffKind};
use jbt_frontend::field::{Field, FieldKind, FieldValue};
use jbt_frontend::kind::{NodeKind, Primitive};
use jbt_frontend::model::Model;
use jbt_frontend::skeleton::{Point, SkeletonKind};
use jbt_frontend::texture::TextureKind;
use jbt_frontend::tree::Tree;
use jbt_frontend::warp::WarpKind;

/// A point of radius 1.
pub fn point() -> Tree {
    let skeleton = Point { at: DVec3::ZERO }.into();
    let leaf = Primitive { skeleton, falloff: Falloff::Soft, radius: 1.0, strength: 1.0 };
    Tree::new(NodeKind::Primitive(leaf), Vec::new())
}

/// A finite number: often a simple one, sometimes any bits.
fn number(rng: &mut Rng) -> f64 {
    match rng.u8(..6) {
        0 => 0.0,
        1 => -0.0,
        2 => f64::from(rng.i32(-9..10)),
        3 => rng.f64() - 0.5,
        4 => *rng.choice(&[1.0, 1e15, -1e-15, f64::MIN_POSITIVE, 5e-324, f64::MAX, 0.1]).unwrap(),
        _ => Some(f64::from_bits(rng.u64(..))).filter(|x| x.is_finite()).unwrap_or(0.5),
    }
}

fn numbers<const N: usize>(rng: &mut Rng) -> [f64; N] {
    std::array::from_fn(|_| number(rng))
}

fn fields(rng: &mut Rng, fields: &[Field]) -> Vec<FieldValue> {
    let value = |field: &Field| match (field.kind, &field.default) {
        (_, Some(default)) if rng.u8(..4) == 0 => default.clone(),
        (FieldKind::Real, _) => FieldValue::Real(number(rng)),
        (FieldKind::Positive | FieldKind::NonNegative | FieldKind::Degrees, _) => {
            FieldValue::Real(number(rng).abs())
        }
        (FieldKind::Within { least, most }, _) => FieldValue::Real(number(rng).clamp(least, most)),
        (FieldKind::Choice(words), _) => FieldValue::Real(rng.usize(..words.len()) as f64),
        (FieldKind::Whole { least, most }, _) => FieldValue::Real(rng.u32(least..=most).into()),
        (FieldKind::Count, _) => {
            FieldValue::Real(if rng.bool() { f64::from(rng.u8(..9)) } else { number(rng) })
        }
        (FieldKind::Position | FieldKind::Direction, _) => FieldValue::Vector(numbers(rng)),
        (FieldKind::Extents | FieldKind::Stretches, _) => FieldValue::Vector(numbers(rng).map(f64::abs)),
        (FieldKind::Positions, _) => FieldValue::Vectors((0..rng.usize(..8)).map(|_| numbers(rng)).collect()),
        (FieldKind::Lengths, _) => {
            FieldValue::Reals((0..rng.usize(..8)).map(|_| number(rng).abs()).collect())
        }
        (FieldKind::Flag, _) => FieldValue::Real(f64::from(rng.u8(..2))),
        (FieldKind::Rows, _) => unreachable!("only maps have rows"),
        (FieldKind::Axis, _) => FieldValue::Vector(DVec3::AXES[rng.usize(..3)].to_array()),
    };
    fields.iter().map(value).collect()
}

fn leaf(rng: &mut Rng) -> Tree {
    let kind = *rng.choice(SkeletonKind::ALL).unwrap();
    let leaf = Primitive {
        skeleton: kind.from_fields(&fields(rng, kind.fields())),
        falloff: falloff(rng),
        radius: number(rng),
        strength: if rng.bool() { 1.0 } else { number(rng) },
    };
    Tree::new(NodeKind::Primitive(leaf), Vec::new())
}

fn falloff(rng: &mut Rng) -> Falloff {
    let kind = *rng.choice(FalloffKind::ALL).unwrap();
    kind.from_fields(&fields(rng, kind.fields()))
}

/// What an attribute node of any kind gives.
fn value(rng: &mut Rng, width: usize) -> AttributeValue {
    let all = |rng: &mut Rng| (0..width).map(|_| number(rng)).collect::<Vec<f64>>();
    match rng.u8(..3) {
        0 => {
            let kind = *rng.choice(TextureKind::ALL).unwrap();
            let texture = kind.from_fields(&fields(rng, kind.fields()));
            AttributeValue::Textured(Textured { texture, a: all(rng), b: all(rng) })
        }
        1 if width == 2 => {
            AttributeValue::Uv(UvMap { scale: numbers(rng), degrees: number(rng), shift: numbers(rng) })
        }
        _ => AttributeValue::Numbers(all(rng)),
    }
}

fn affine(rng: &mut Rng) -> DAffine3 {
    match rng.u8(..5) {
        0 => DAffine3::from_translation(numbers(rng).into()),
        1 => DAffine3::from_scale(DVec3::splat(number(rng))),
        2 => DAffine3::from_scale(numbers(rng).into()),
        3 => DAffine3::from_rotation_z(rng.f64()),
        _ => DAffine3 { matrix3: DMat3::from_cols_array(&numbers(rng)), translation: numbers(rng).into() },
    }
}

/// Formulas of any operations, where what was made once may be used again.
fn terms(rng: &mut Rng, children: &[Tree]) -> Vec<Term> {
    let mut terms = vec![x(), y(), z()];
    terms.extend(children.iter().map(Tree::field));
    for _ in 0..rng.usize(..12) {
        let pick = |rng: &mut Rng| match rng.u8(..3) {
            0 => Term::from(number(rng)),
            1 => param("bulge", 0.5) * number(rng) + x(),
            _ => terms[rng.usize(..terms.len())].clone(),
        };
        let (a, b, c) = (terms[rng.usize(..terms.len())].clone(), pick(rng), pick(rng));
        terms.push(match rng.u8(..22) {
            0 => a + b,
            1 => b - a,
            2 => a * b,
            3 => b / a,
            4 => -a,
            5 => a.powf(f64::from(rng.i8(-4..5))),
            6 => b.powf(a),
            7 => a.sqrt(),
            8 => a.sin() + a.cos(),
            9 => a.tan().atan(),
            10 => a.asin() - a.acos(),
            11 => a.abs().sign(),
            12 => a.floor() - (a.ceil() - a.round()),
            13 => a.exp().ln(),
            14 => a.square(),
            15 => a.min(b).max(c),
            16 => a.clamp(b, c),
            17 => a.mix(b, c),
            18 => a.step_at(b),
            19 => a.modulo(b),
            20 => a.atan2(b),
            _ => a.falloff(falloff(rng)),
        });
    }
    terms
}

/// A formula of any operations.
fn expression(rng: &mut Rng, children: &[Tree]) -> Tree {
    let last = terms(rng, children).pop().unwrap_or_else(x);
    if rng.bool() {
        return Tree::expression(last);
    }
    let (a, b): ([f64; 3], [f64; 3]) = (numbers(rng), numbers(rng));
    let corner = |of: fn(f64, f64) -> f64| -> [f64; 3] { std::array::from_fn(|axis| of(a[axis], b[axis])) };
    Tree::expression_within(last, corner(f64::min), corner(f64::max))
}

/// A model of up to some 30 nodes, built upwards from leaves; nodes that were used once may be used again.
pub fn model(rng: &mut Rng) -> Model {
    let mut groups = vec![AttributeGroup::color()];
    for name in ["rough", "uv", "scale", "n1", "color2"] {
        if rng.bool() {
            let default = (0..*rng.choice(&[1, 2, 2, 3, 4, 64]).unwrap()).map(|_| number(rng)).collect();
            groups.push(AttributeGroup {
                name: name.into(),
                default,
                mixing: *rng.choice(Mixing::ALL.iter()).unwrap(),
            });
        }
    }
    if rng.bool() {
        groups[0].default = vec![0.5, -0.0, 1.0];
        groups[0].mixing = Mixing::Dominant;
    }
    let mut trees = vec![leaf(rng)];
    for _ in 0..rng.usize(..30) {
        let pick = |rng: &mut Rng| {
            let recent = trees.len().saturating_sub(4);
            trees[if rng.bool() { rng.usize(recent..trees.len()) } else { rng.usize(..trees.len()) }].clone()
        };
        let tree = match rng.u8(..7) {
            0 => leaf(rng),
            1 => Tree::new(NodeKind::Affine(affine(rng)), vec![pick(rng)]),
            2 if rng.u8(..5) == 0 => {
                let terms = terms(rng, &[]);
                let warped = pick(rng).warp(std::array::from_fn(|_| terms[rng.usize(..terms.len())].clone()));
                if rng.bool() { warped.weighted(&pick(rng)) } else { warped }
            }
            2 => {
                let kind = *rng.choice(WarpKind::ALL).unwrap();
                let children = (0..rng.usize(1..3)).map(|_| pick(rng)).collect();
                Tree::new(NodeKind::Warp(kind.from_fields(&fields(rng, kind.fields()))), children)
            }
            3 => {
                let group = rng.choice(&groups).unwrap();
                if rng.u8(..4) == 0 {
                    let terms = terms(rng, &[]);
                    let values: Vec<Term> =
                        (0..group.width()).map(|_| terms[rng.usize(..terms.len())].clone()).collect();
                    trees.push(pick(rng).expressed(&group.name, values));
                    continue;
                }
                let value = value(rng, group.width());
                Tree::new(NodeKind::Attribute { name: Arc::clone(&group.name), value }, vec![pick(rng)])
            }
            4 => {
                let children = (0..rng.usize(1..5)).map(|_| pick(rng)).collect();
                Tree::new(NodeKind::Select(number(rng)), children)
            }
            5 => {
                let children: Vec<Tree> = (0..rng.usize(..4)).map(|_| pick(rng)).collect();
                expression(rng, &children)
            }
            _ => {
                let combinator = combinator(rng);
                let count = if combinator.kind().takes_one() { 1 } else { rng.usize(1..5) };
                let children = (0..count).map(|_| pick(rng)).collect();
                Tree::new(NodeKind::Combine(combinator), children)
            }
        };
        trees.push(tree);
    }
    let root = trees.pop().unwrap_or_else(point);
    Model { iso: number(rng).into(), attributes: groups, ..Model::new(root) }
}

/// Any operator.
fn combinator(rng: &mut Rng) -> Combinator {
    let kind = rng.choice(CombinatorKind::ALL).expect("there are operators");
    kind.from_fields(&fields(rng, kind.fields()))
}
