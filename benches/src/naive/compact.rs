//! The compact tree of the walker: a list in the order of the walk, its leaves holding the product of all
//! maps above them.
//!
//! ```text
//! union(a, rotate(difference(b, c, d)))   =   Open(union) a  Open(difference) b' Open(union) c' d' Close Close  Close
//! ```
//!
//! Similarities disappear into the leaves' own numbers, other affine maps become one matrix at each leaf;
//! only warps remain as nodes. A shared subtree is written down once for each path that leads to it.

use std::rc::Rc;

use glam::{DAffine3, Mat3, Vec3};
use jbt::tree::AttributeValue;
use jbt::tree::Warp;
use jbt::tree::{Combinator, operators::Ricci};
use jbt::tree::{NodeKind, Particles, Primitive};
use jbt::{CheckedTree, Falloff, NodeId};

use super::skeleton::Skeleton;

/// An affine map from the space that a point is in to the space of a leaf or a warp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Map {
    pub(super) linear: Mat3,
    pub(super) translation: Vec3,
}

/// A leaf.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub(super) skeleton: Skeleton,
    pub(super) falloff: Falloff,
    pub(super) inverse_square_radius: f32,
    pub(super) strength: f32,
    /// The place of the map to the leaf's space in [`Compact::maps`], unless that is the identity.
    pub(super) map: Option<u32>,
    /// Which part of [`Compact::values`] holds its attributes: the `values`-th, of the tree's width.
    pub(super) values: u32,
}

/// A twist, and the affine map before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist {
    pub(super) axis: u8,
    pub(super) rate: f32,
    /// As in [`Leaf::map`].
    pub(super) map: Option<u32>,
}

/// Any other warp, and the affine map before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Warped {
    /// The place of the warp in [`Compact::warps`].
    pub(super) warp: u32,
    /// As in [`Leaf::map`].
    pub(super) map: Option<u32>,
}

/// What is done with the fields of children.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operator {
    Sum,
    /// Ricci's blend with a whole exponent.
    Powers(i32),
    /// Ricci's blend with any exponent.
    Ricci(f32),
    Union,
    Intersection,
    /// The first child without the second.
    Difference,
    Twist(Twist),
    Warp(Warped),
}

/// A step of the walk.
#[derive(Clone, Debug)]
pub(super) enum Step {
    Leaf(Leaf),
    /// The children of an operator begin.
    Open(Operator),
    /// They end: its answer goes to the operator around it.
    Close,
}

/// A tree, ready to be walked.
#[derive(Clone, Debug)]
pub(super) struct Compact {
    pub(super) steps: Vec<Step>,
    pub(super) maps: Vec<Map>,
    /// Warps that are no twists, or weighted; and what weighs them.
    pub(super) warps: Vec<(Warp, Option<CheckedTree>)>,
    /// The values of all attribute groups at each leaf.
    pub(super) values: Vec<f32>,
}

enum Task {
    /// Write down a node: the map from its space to that of the warp above or the world, and its leaves'
    /// attributes.
    Write(NodeId, DAffine3, Rc<[f32]>),
    Push(Operator),
    Close,
}

impl Compact {
    /// Panics on operators that no case has: the walk knows sums, Ricci's blend, and plain set operations.
    pub(super) fn new(tree: &CheckedTree) -> Self {
        let mut compact = Self { steps: Vec::new(), maps: Vec::new(), warps: Vec::new(), values: Vec::new() };
        let defaults: Rc<[f32]> = defaults(tree).into();
        let mut tasks = vec![Task::Write(tree.root(), DAffine3::IDENTITY, defaults)];
        while let Some(task) = tasks.pop() {
            match task {
                Task::Write(id, map, values) => compact.write(tree, id, map, values, &mut tasks),
                Task::Push(operator) => compact.steps.push(Step::Open(operator)),
                Task::Close => compact.steps.push(Step::Close),
            }
        }
        compact
    }

    fn write(
        &mut self,
        tree: &CheckedTree,
        id: NodeId,
        map: DAffine3,
        values: Rc<[f32]>,
        tasks: &mut Vec<Task>,
    ) {
        let node = tree.node(id);
        match &node.kind {
            NodeKind::Primitive(primitive) => self.leaf(primitive, &map, &values),
            NodeKind::Particles(particles) => {
                self.steps.push(Step::Open(Operator::Sum));
                for particle in 0..particles.len() {
                    let values = own_values(tree, (particles, particle), &values);
                    let primitive = Primitive {
                        skeleton: particles.point(particle).into(),
                        falloff: *particles.falloff(),
                        radius: particles.radius(particle),
                        strength: particles.strength(particle),
                    };
                    self.leaf(&primitive, &map, &values);
                }
                self.steps.push(Step::Close);
            }
            NodeKind::Combine(combinator) => combine(*combinator, &node.children, map, &values, tasks),
            NodeKind::Expression(_) => unreachable!("no model that is compared has a formula"),
            NodeKind::Select(_) => {
                tasks.push(Task::Write(node.kind.asked(&node.children)[0], map, values));
            }
            NodeKind::Affine(here) => tasks.push(Task::Write(node.children[0], map * *here, values)),
            NodeKind::Warp(Warp::Twist(twist)) if node.children.len() == 1 => {
                let map = self.map(&map);
                let twist = Twist { axis: twist.axis as u8, rate: twist.rate as f32, map };
                tasks.push(Task::Close);
                tasks.push(Task::Write(node.children[0], DAffine3::IDENTITY, values));
                tasks.push(Task::Push(Operator::Twist(twist)));
            }
            NodeKind::Warp(warp) => {
                let map = self.map(&map);
                self.warps.push((warp.clone(), node.children.get(1).map(|&weight| tree.subtree(weight))));
                let warp = self.warps.len() as u32 - 1;
                tasks.push(Task::Close);
                tasks.push(Task::Write(node.children[0], DAffine3::IDENTITY, values));
                tasks.push(Task::Push(Operator::Warp(Warped { warp, map })));
            }
            NodeKind::Constant { .. } => tasks.push(Task::Write(node.children[0], map, values)),
            NodeKind::Attribute { name, value, .. } => {
                // Numbers are all that it knows: where they are computed, the check against the oracle says
                // that it is off.
                let here: &[f64] = match value {
                    AttributeValue::Numbers(numbers) => numbers,
                    AttributeValue::Textured(_) | AttributeValue::Uv(_) | AttributeValue::Expressed(_) => &[],
                };
                let mut values = values.to_vec();
                let mut start = 0;
                for group in tree.attributes() {
                    if group.name == *name {
                        for (value, here) in values[start..].iter_mut().zip(here) {
                            *value = *here as f32;
                        }
                    }
                    start += group.width();
                }
                tasks.push(Task::Write(node.children[0], map, values.into()));
            }
        }
    }

    fn leaf(&mut self, primitive: &Primitive, map: &DAffine3, values: &[f32]) {
        let map = self.map(map);
        let number = self.values.len() / values.len();
        self.values.extend_from_slice(values);
        self.steps.push(Step::Leaf(Leaf {
            skeleton: Skeleton::new(&primitive.skeleton),
            falloff: primitive.falloff,
            inverse_square_radius: primitive.radius.powi(-2) as f32,
            strength: primitive.strength as f32,
            map,
            values: number as u32,
        }));
    }

    /// Keeps the inverse of a map, unless it is the identity.
    fn map(&mut self, map: &DAffine3) -> Option<u32> {
        if *map == DAffine3::IDENTITY {
            return None;
        }
        let inverse = map.inverse();
        let (linear, translation) = (inverse.matrix3.as_mat3(), inverse.translation.as_vec3());
        self.maps.push(Map { linear, translation });
        Some(self.maps.len() as u32 - 1)
    }
}

/// The values of one of particles, below these.
fn own_values(tree: &CheckedTree, (particles, particle): (&Particles, usize), above: &[f32]) -> Vec<f32> {
    let (mut values, mut start) = (above.to_vec(), 0);
    for group in tree.attributes() {
        if let Some(own) = particles.values_of(&group.name) {
            values[start..].iter_mut().zip(own.of(particle)).for_each(|(value, own)| *value = own as f32);
        }
        start += group.width();
    }
    values
}

/// The values of leaves without attributes.
pub(super) fn defaults(tree: &CheckedTree) -> Vec<f32> {
    tree.attributes().iter().flat_map(|group| &group.default).map(|&value| value as f32).collect()
}

/// Plans the children of a combinator, the last task first.
fn combine(
    combinator: Combinator,
    children: &[NodeId],
    map: DAffine3,
    values: &Rc<[f32]>,
    tasks: &mut Vec<Task>,
) {
    let write = |id: &NodeId| Task::Write(*id, map, values.clone());
    let operator = match (combinator.name(), combinator) {
        (_, Combinator::Ricci(Ricci { exponent: n })) if n != 1.0 => {
            if n.fract() == 0.0 && n > 0.0 {
                Operator::Powers(n as i32)
            } else {
                Operator::Ricci(n as f32)
            }
        }
        ("sum" | "ricci", _) => Operator::Sum,
        ("union", _) => Operator::Union,
        ("intersection", _) => Operator::Intersection,
        ("difference", _) => Operator::Difference,
        (name, _) => panic!("no case compares walks of `{name}`"),
    };
    match (operator, children) {
        // With one child there is nothing to decide.
        (Operator::Union | Operator::Intersection | Operator::Difference, [only]) => tasks.push(write(only)),
        (Operator::Difference, [first, subtracted @ ..]) if subtracted.len() > 1 => {
            tasks.extend([Task::Close, Task::Close]);
            tasks.extend(subtracted.iter().rev().map(write));
            tasks.extend([Task::Push(Operator::Union), write(first), Task::Push(operator)]);
        }
        (_, children) => {
            tasks.push(Task::Close);
            tasks.extend(children.iter().rev().map(write));
            tasks.push(Task::Push(operator));
        }
    }
}
