//! The oracle: a plain walk over a tree in f64, one point at a time, by each node's plain formula.
//!
//! ```text
//! walk(node, p):   primitive    strength * falloff(d^2(p) / radius^2), with the attributes of the way down
//!                  particles    each of them, and their sum
//!                  combinator   walk each child at p; combine fields, mix attributes by weights
//!                  expression   walk each child at p; the formula of p and their fields
//!                  selector     walk the chosen child
//!                  map          walk the child at map^-1(p)
//!                  attribute    walk the child, its leaves having this attribute: numbers, what a texture is at p, or their uv
//! ```
//!
//! It judges the compiler, so it shares no arithmetic with it: fields and weights are the plain formulas in
//! f64. Of what the compiler knows it asks the form of an operator alone, to find kinks. It is too simple to
//! be fast: every primitive is evaluated once for each path that leads to it, for each question again.

use std::rc::Rc;

use glam::{DMat3, DVec3};

use crate::attribute::{AttributeGroup, AttributeValue, GroupKind, Mixing, Precedence, UvMap};
use crate::check::{CheckedTree, NodeId};
use crate::combine::{Combinator, OperatorForm, ReduceCode, Sum};
use crate::descent::{GivenAttribute, Question, ask, ask_at};
use crate::expression::Expression;
use crate::kind::{NodeKind, Primitive};
use crate::particles::{ParticleValues, Particles};
use crate::skeleton::Skeleton;
use crate::warp::Warp;

/// The answers at a point.
#[derive(Clone, PartialEq, Debug)]
pub struct Sample {
    /// The field.
    pub field: f64,
    /// The value of each attribute group, in the order of [`CheckedTree::attributes`].
    pub attributes: Vec<Vec<f64>>,
    /// How far the point is from anything that is decided: a tie of a union, the rim of a support, the axis
    /// of a ring, the crease of a warp, a total weight of zero, a tie of dominance. In units of the fields,
    /// weights and lengths that it compares; infinity if nothing is decided.
    ///
    /// Where this is small, gradients and attributes of another engine may differ: it may have decided
    /// otherwise.
    pub kink_distance: f64,
}

/// The values of all attribute groups at a leaf.
type GroupValues = Rc<[Vec<f64>]>;

/// What the way down has found of an attribute group.
#[derive(Clone)]
enum Given {
    /// A value, and how far it is from a jump.
    Value(Vec<f64>, f64),
    /// The uv of the leaf.
    Uv(UvMap),
}

/// What counts of an attribute group on the way down.
#[derive(Clone)]
struct Heard {
    given: Given,
    precedence: Precedence,
}

/// What the way down has found of all groups, and how it turns directions: from here to the world. Where no
/// group is one, nobody asks.
#[derive(Clone)]
struct Way {
    heard: Rc<[Heard]>,
    turn: DMat3,
}

impl Way {
    /// A value as the world has it.
    fn turned(&self, group: &AttributeGroup, value: Vec<f64>) -> Vec<f64> {
        match (group.kind, &value[..]) {
            (GroupKind::Direction, &[x, y, z]) => (self.turn * DVec3::new(x, y, z)).to_array().to_vec(),
            (GroupKind::Direction | GroupKind::Numbers, _) => value,
        }
    }
}

/// The step of the differences that turn directions in warps.
const TURN_STEP: f64 = 1e-5;

impl Heard {
    fn numbers(value: Vec<f64>) -> Self {
        Self { given: Given::Value(value, f64::INFINITY), precedence: Precedence::Nearest }
    }
}

/// What is known at a node.
#[derive(Clone)]
struct SampleAnswer {
    field: f64,
    kink_distance: f64,
    /// The field is zero around the point, not only at it: all leaves that matter are out of reach.
    silent: bool,
    /// The mean of the leaves' values, for each group.
    mean: GroupValues,
    /// The values of the leaf with the largest share of the weight.
    dominant: GroupValues,
    /// The share of that leaf.
    share: f64,
    /// The second largest share of a leaf.
    second: f64,
}

/// The answers at `p`. Cost: all paths of the tree.
#[must_use]
pub fn walk(tree: &CheckedTree, p: [f64; 3]) -> Sample {
    let defaults: GroupValues = tree.attributes().iter().map(|group| group.default.clone()).collect();
    let heard = defaults.iter().map(|value| Heard::numbers(value.clone())).collect();
    let unbound = Way { heard, turn: DMat3::IDENTITY };
    let turns = tree.attributes().iter().any(AttributeGroup::turns);
    let root = ask(tree, &mut SampleQuestion { tree, defaults, turns }, unbound, p.into());
    finish(tree, &root)
}

/// The field of a node at a point of the space around it.
fn field_at(tree: &CheckedTree, node: NodeId, p: DVec3) -> f64 {
    let defaults: GroupValues = tree.attributes().iter().map(|group| group.default.clone()).collect();
    let heard = defaults.iter().map(|value| Heard::numbers(value.clone())).collect();
    let mut question = SampleQuestion { tree, defaults, turns: false };
    ask_at(tree, &mut question, node, (Way { heard, turn: DMat3::IDENTITY }, p)).field
}

/// The question for the field and the attributes.
struct SampleQuestion<'a> {
    tree: &'a CheckedTree,
    defaults: GroupValues,
    /// Whether there are directions.
    turns: bool,
}

impl Question for SampleQuestion<'_> {
    type Way = Way;
    type Answer = SampleAnswer;
    /// How far the point is from a crease.
    type Mark = f64;

    fn enter(&mut self, _node: NodeId, way: Way) -> Way {
        way
    }

    fn below(&self, way: &Way, _child: usize) -> Way {
        way.clone()
    }

    fn given(&self, way: Way, node: GivenAttribute<'_>, p: DVec3) -> Way {
        // Nearer to the leaves than whatever was said above: it replaces it, unless that overrides.
        let mut heard = way.heard.to_vec();
        for (group, above) in self.tree.attributes().iter().zip(&mut heard) {
            if *group.name == *node.name && above.precedence == Precedence::Nearest {
                let given = match given(node.value, p) {
                    Given::Value(value, jump) => Given::Value(way.turned(group, value), jump),
                    uv @ Given::Uv(_) => uv,
                };
                *above = Heard { given, precedence: node.precedence };
            }
        }
        Way { heard: heard.into(), ..way }
    }

    fn turned(&self, tree: &CheckedTree, way: Way, node: NodeId, p: DVec3) -> Way {
        if !self.turns {
            return way;
        }
        let node = tree.node(node);
        let step = if let NodeKind::Affine(map) = &node.kind {
            map.matrix3
        } else if let NodeKind::Warp(warp) = &node.kind {
            let inside = |p: DVec3| match node.children.get(1) {
                Some(&weight) => warp.weighted(p, field_at(tree, weight, p)),
                None => warp.inverse(p),
            };
            let along = |axis: DVec3| {
                let offset = TURN_STEP * axis;
                (inside(p + offset) - inside(p - offset)) / (2.0 * TURN_STEP)
            };
            DMat3::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)).inverse()
        } else {
            return way;
        };
        Way { turn: way.turn * step, ..way }
    }

    fn primitive(&self, leaf: &Primitive, p: DVec3, way: &Way) -> SampleAnswer {
        primitive(leaf, p, way)
    }

    fn particles(&self, particles: &Particles, p: DVec3, way: &Way) -> SampleAnswer {
        sum(self.tree, particles, p, (way, &self.defaults))
    }

    fn combine(&self, combinator: Combinator, children: &[SampleAnswer]) -> SampleAnswer {
        combine(combinator, self.tree.iso(), children, &self.defaults)
    }

    fn express(&self, formula: &Expression, p: DVec3, way: &Way, children: &[SampleAnswer]) -> SampleAnswer {
        let values = values_at(way, NodeKind::origin(), p);
        express(formula, p, children, values, &self.defaults)
    }

    fn field(answer: &SampleAnswer) -> f64 {
        answer.field
    }

    fn mark(&self, warp: &Warp, p: DVec3, weight: Option<&SampleAnswer>) -> f64 {
        let Some(weight) = weight else { return warp.kink_distance(p) };
        // Where the weight is clamped, there is a crease.
        let clamp = if weight.silent { f64::INFINITY } else { weight.field.abs() };
        let clamp = clamp.min((weight.field - 1.0).abs());
        warp.kink_distance(p).min(weight.kink_distance).min(clamp)
    }

    fn marked(&self, answer: &mut SampleAnswer, crease: f64) {
        answer.kink_distance = answer.kink_distance.min(crease);
    }
}

/// The gradient of the field at `p` by central differences: `step` to both sides along each axis.
#[must_use]
pub fn walk_gradient(tree: &CheckedTree, p: [f64; 3], step: f64) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let at = |offset: f64| {
            let mut q = p;
            q[axis] += offset;
            walk(tree, q).field
        };
        (at(step) - at(-step)) / (2.0 * step)
    })
}

/// What an attribute node gives at a point of its space.
fn given(value: &AttributeValue, p: DVec3) -> Given {
    match value {
        AttributeValue::Numbers(numbers) => Given::Value(numbers.clone(), f64::INFINITY),
        AttributeValue::Textured(textured) => {
            Given::Value(textured.value(p), textured.texture.kink_distance(p))
        }
        AttributeValue::Uv(map) => Given::Uv(*map),
        AttributeValue::Expressed(expression) => {
            Given::Value(expression.values(p), expression.kink_distance(p, &[]))
        }
    }
}

/// The values of all attribute groups at a leaf with this skeleton's uv, and how far they are from a jump.
fn values_at(way: &Way, skeleton: &Skeleton, p: DVec3) -> (GroupValues, f64) {
    let value = |heard: &Heard| match &heard.given {
        Given::Value(value, _) => value.clone(),
        Given::Uv(map) => map.apply(skeleton.uv(p)).to_vec(),
    };
    let jump = |heard: &Heard| match &heard.given {
        Given::Value(_, kink_distance) => *kink_distance,
        Given::Uv(_) => skeleton.uv_kink_distance(p),
    };
    let heard = way.heard.iter();
    (heard.clone().map(value).collect(), heard.map(jump).fold(f64::INFINITY, f64::min))
}

/// The sum of particles. Of those that are silent the first two are kept, which say what any number of them
/// says, and the nearest rim.
fn sum(
    tree: &CheckedTree,
    particles: &Particles,
    p: DVec3,
    (way, defaults): (&Way, &GroupValues),
) -> SampleAnswer {
    let mut answers = Vec::new();
    let (mut silent, mut rim) = (0, f64::INFINITY);
    let groups = tree.attributes().iter();
    let own: Vec<_> = groups.map(|group| particles.values_of(&group.name)).collect();
    for particle in 0..particles.len() {
        let (skeleton, radius) = (particles.point(particle), particles.radius(particle));
        let (falloff, strength) = (*particles.falloff(), particles.strength(particle));
        let s = (p - skeleton.at).length_squared() / (radius * radius);
        if s >= 1.0 || strength == 0.0 {
            silent += 1;
            if strength != 0.0 {
                rim = rim.min((1.0 - s).abs());
            }
            if silent > 2 {
                continue;
            }
        }
        let heard = |((values, group), above): ((&Option<&ParticleValues>, &AttributeGroup), &Heard)| match (
            values,
            above.precedence,
        ) {
            (Some(values), Precedence::Nearest) => {
                Heard::numbers(way.turned(group, values.of(particle).collect()))
            }
            _ => above.clone(),
        };
        let heard = own.iter().zip(tree.attributes()).zip(way.heard.iter()).map(heard).collect();
        let way = Way { heard, turn: way.turn };
        let leaf = Primitive { skeleton: skeleton.into(), falloff, radius, strength };
        answers.push(primitive(&leaf, p, &way));
    }
    let mut answer = combine(Sum {}.into(), tree.iso(), &answers, defaults);
    answer.kink_distance = answer.kink_distance.min(rim);
    answer
}

fn primitive(leaf: &Primitive, p: DVec3, way: &Way) -> SampleAnswer {
    let s = leaf.skeleton.distance_squared(p) / (leaf.radius * leaf.radius);
    let field = leaf.strength * leaf.falloff.value(s);
    let silent = s >= 1.0 || leaf.strength == 0.0;
    let rim = if leaf.strength == 0.0 { f64::INFINITY } else { (1.0 - s).abs() };
    // At the tip of a falloff, as at the axis of a ring, the gradient jumps.
    let tip = if leaf.falloff.is_pointed() { s.sqrt() * leaf.radius } else { f64::INFINITY };
    let (values, jump) = values_at(way, &leaf.skeleton, p);
    let kink_distance = if silent { rim } else { rim.min(tip).min(jump).min(leaf.skeleton.kink_distance(p)) };
    SampleAnswer {
        field,
        kink_distance,
        silent,
        mean: values.clone(),
        dominant: values,
        share: 1.0,
        second: 0.0,
    }
}

fn combine(
    combinator: Combinator,
    iso: f64,
    children: &[SampleAnswer],
    defaults: &GroupValues,
) -> SampleAnswer {
    if children.len() == 1 && combinator.passes_single() {
        // There is nothing to decide.
        return children[0].clone();
    }
    let fields: Vec<f64> = children.iter().map(|child| child.field).collect();
    let field = combinator.field(&fields, iso);
    let weights = combinator.weights(&fields, iso);
    let (kink_distance, silent) = decide(combinator, iso, children, combinator.winner(&fields, iso), field);
    mixed(children, &weights, defaults, (field, kink_distance, silent))
}

/// The field of a formula, and the attributes of the leaf that it is, of its only child, or of several by
/// weight.
fn express(
    expression: &Expression,
    p: DVec3,
    children: &[SampleAnswer],
    (values, jump): (GroupValues, f64),
    defaults: &GroupValues,
) -> SampleAnswer {
    let fields: Vec<f64> = children.iter().map(|child| child.field).collect();
    let field = expression.field(p, &fields);
    let heard = expression.kink_distance(p, &fields);
    let kink_distance = children.iter().fold(heard, |d, child| d.min(child.kink_distance));
    let silent = !children.is_empty() && children.iter().all(|child| child.silent) && expression.vanishes();
    match children {
        [] => {
            let (mean, dominant, kink_distance) = (values.clone(), values, kink_distance.min(jump));
            SampleAnswer { field, kink_distance, silent, mean, dominant, share: 1.0, second: 0.0 }
        }
        [child] => {
            let kink_distance =
                if child.silent { kink_distance } else { kink_distance.min(child.field.abs()) };
            mixed(
                children,
                &[f64::from(u8::from(child.field != 0.0))],
                defaults,
                (field, kink_distance, silent),
            )
        }
        _ => {
            let weights = expression.weights(p, &fields);
            let total: f64 = weights.iter().sum();
            // Where the weight falls to zero, attributes jump to their defaults.
            let kink_distance = if silent { kink_distance } else { kink_distance.min(total) };
            mixed(children, &weights, defaults, (field, kink_distance, silent))
        }
    }
}

/// The answer of a node with this field and distance to a kink, whose attributes are those of its children by
/// weight.
fn mixed(
    children: &[SampleAnswer],
    weights: &[f64],
    defaults: &GroupValues,
    (field, kink_distance, silent): (f64, f64, bool),
) -> SampleAnswer {
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        let (mean, dominant) = (defaults.clone(), defaults.clone());
        return SampleAnswer { field, kink_distance, silent, mean, dominant, share: 1.0, second: 0.0 };
    }
    let mut mean: Vec<Vec<f64>> = defaults.iter().map(|default| vec![0.0; default.len()]).collect();
    let mut dominant = defaults;
    let (mut share, mut second) = (0.0, 0.0f64);
    for (child, weight) in children.iter().zip(weights) {
        let part = weight / total;
        for (sums, values) in mean.iter_mut().zip(child.mean.iter()) {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += part * value;
            }
        }
        // Strictly: of equals the first in the file stays.
        if part * child.share > share {
            second = second.max(share);
            (dominant, share) = (&child.dominant, part * child.share);
        } else {
            second = second.max(part * child.share);
        }
        second = second.max(part * child.second);
    }
    SampleAnswer {
        field,
        kink_distance,
        silent,
        mean: mean.into(),
        dominant: dominant.clone(),
        share,
        second,
    }
}

/// How far a node is from any kink that reaches its answer, and whether its field is zero all around.
fn decide(
    combinator: Combinator,
    iso: f64,
    children: &[SampleAnswer],
    winner: Option<usize>,
    field: f64,
) -> (f64, bool) {
    let nearest = |d: f64, child: &SampleAnswer| d.min(child.kink_distance);
    let all_nearest = || children.iter().fold(f64::INFINITY, nearest);
    if children.iter().all(|child| child.silent) {
        // The complement of nothing is something, but it is the same all around.
        return (all_nearest(), field == 0.0);
    }
    let heard_fields =
        || children.iter().filter(|child| !child.silent).map(|child| child.field).collect::<Vec<_>>();
    // To the form it does not matter here whether numbers depend on parameters.
    match combinator.form(false) {
        OperatorForm::Reduce(ReduceCode::Fold(code)) if code.absorbs() => {
            let silent = children.iter().any(|child| child.silent);
            // Where the field falls to zero, attributes jump to their defaults.
            let fading = heard_fields().iter().fold(f64::INFINITY, |least, f| least.min(f.abs()));
            (all_nearest().min(if silent { f64::INFINITY } else { fading }), silent)
        }
        OperatorForm::Reduce(ReduceCode::Step(_)) => {
            let fields: Vec<f64> = children.iter().map(|child| child.field).collect();
            if field == 0.0 && children.iter().any(|child| child.silent) {
                return (all_nearest(), true);
            }
            (combinator.kink_distance(&fields, iso).min(all_nearest()).min(field.abs()), false)
        }
        OperatorForm::Map(_) => {
            let child = &children[0];
            let fading = child.field.abs().min(field.abs());
            (combinator.kink_distance(&[child.field], iso).min(child.kink_distance).min(fading), false)
        }
        OperatorForm::Reduce(ReduceCode::Fold(_)) => {
            // Where the total weight falls to zero, attributes jump to their defaults.
            let heard = || children.iter().filter(|child| !child.silent).map(|child| child.field);
            let largest = heard().fold(f64::NEG_INFINITY, f64::max);
            (children.iter().fold(largest.abs(), nearest), false)
        }
        form @ (OperatorForm::Reduce(ReduceCode::Choice(_)) | OperatorForm::Difference) => {
            let winner = &children[winner.unwrap_or(0)];
            // A tie of children that are zero all around is none: the first of them wins, whatever the
            // engine.
            let first = usize::from(form == OperatorForm::Difference);
            let quiet = children.iter().skip(first).position(|child| child.silent).map(|i| i + first);
            let rivals: Vec<f64> = (0..children.len())
                .filter(|&i| i < first || !children[i].silent || Some(i) == quiet)
                .map(|i| children[i].field)
                .collect();
            let silent = winner.silent && field == 0.0;
            // Where the field falls to zero, attributes jump to their defaults.
            let fading = if silent { f64::INFINITY } else { field.abs() };
            (combinator.kink_distance(&rivals, iso).min(winner.kink_distance).min(fading), silent)
        }
    }
}

fn finish(tree: &CheckedTree, root: &SampleAnswer) -> Sample {
    let values = root.mean.iter().zip(root.dominant.iter());
    let pick = |(group, (mean, dominant)): (&AttributeGroup, (&Vec<f64>, &Vec<f64>))| match group.mixing {
        Mixing::Blend => mean.clone(),
        Mixing::Dominant => dominant.clone(),
    };
    let attributes = tree.attributes().iter().zip(values).map(pick).collect();
    let dominance = tree.attributes().iter().any(|group| group.mixing == Mixing::Dominant);
    let lead = if dominance { root.share - root.second } else { f64::INFINITY };
    Sample { field: root.field, attributes, kink_distance: root.kink_distance.min(lead) }
}
