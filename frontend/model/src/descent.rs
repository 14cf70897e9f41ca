//! The walk that the [oracle](crate::walk) and [owners](crate::owner) share: points go down, answers come up.
//!
//! ```text
//!          p │   ▲ combine, express, mark       at each node: where its children are asked,
//!            ▼   │                              and what their answers make
//!          leaves
//! ```
//!
//! It walks every path of the tree, one point at a time, on a list of its own: a chain of a million nodes is
//! a tree like any other.

use glam::DVec3;

use crate::attribute::{AttributeValue, Precedence};
use crate::check::{CheckedTree, NodeId};
use crate::combine::Combinator;
use crate::expression::Expression;
use crate::kind::{NodeKind, Primitive, chosen};
use crate::particles::Particles;
use crate::warp::Warp;

/// An attribute node on the way down.
#[derive(Clone, Copy)]
pub(crate) struct GivenAttribute<'a> {
    pub(crate) name: &'a str,
    pub(crate) value: &'a AttributeValue,
    pub(crate) precedence: Precedence,
}

/// A question that has an answer at each node.
pub(crate) trait Question {
    /// What the way down to a node has found.
    type Way: Clone;
    /// What is known at a node.
    type Answer;
    /// What a warp adds to the answer of its child.
    type Mark;

    /// At each node, before its children are asked.
    fn enter(&mut self, node: NodeId, way: Self::Way) -> Self::Way;

    /// The way on to a child.
    fn below(&self, way: &Self::Way, child: usize) -> Self::Way;

    /// The way below an attribute node, which is asked at `p`.
    fn given(&self, way: Self::Way, node: GivenAttribute<'_>, p: DVec3) -> Self::Way;

    /// The way into a map or a warp, which is asked at `p`.
    fn turned(&self, tree: &CheckedTree, way: Self::Way, node: NodeId, p: DVec3) -> Self::Way;

    /// The answer of a leaf.
    fn primitive(&self, leaf: &Primitive, p: DVec3, way: &Self::Way) -> Self::Answer;

    /// The answer of particles, which is that of the sum of their points.
    fn particles(&self, particles: &Particles, p: DVec3, way: &Self::Way) -> Self::Answer;

    /// The answer of an operator.
    fn combine(&self, combinator: Combinator, children: &[Self::Answer]) -> Self::Answer;

    /// The answer of a formula, which is a leaf if it has no children.
    fn express(
        &self,
        formula: &Expression,
        p: DVec3,
        way: &Self::Way,
        children: &[Self::Answer],
    ) -> Self::Answer;

    /// The field of an answer.
    fn field(answer: &Self::Answer) -> f64;

    /// What a warp adds that is asked at `p`, and its weight if it has one.
    fn mark(&self, warp: &Warp, p: DVec3, weight: Option<&Self::Answer>) -> Self::Mark;

    /// Adds it.
    fn marked(&self, answer: &mut Self::Answer, mark: Self::Mark);
}

/// The work that is left. Points are those of a node's parent.
enum DescentTask<Q: Question> {
    /// Ask a node.
    Ask(NodeId, DVec3, Q::Way),
    /// Ask the child of a weighted warp, whose weight has answered.
    Enter(NodeId, DVec3, Q::Way),
    /// Add to the last answer what a warp says.
    Mark(Q::Mark),
    /// Answer for a node whose children have answered.
    Answer(NodeId, DVec3, Q::Way),
}

/// The answer of the root at `p`. Cost: all paths of the tree.
pub(crate) fn ask<Q: Question>(tree: &CheckedTree, question: &mut Q, way: Q::Way, p: DVec3) -> Q::Answer {
    ask_at(tree, question, tree.root(), (way, p))
}

/// The answer of a node at a point of the space around it.
pub(crate) fn ask_at<Q: Question>(
    tree: &CheckedTree,
    question: &mut Q,
    node: NodeId,
    (way, p): (Q::Way, DVec3),
) -> Q::Answer {
    let mut tasks: Vec<DescentTask<Q>> = vec![DescentTask::Ask(node, p, way)];
    let mut answers: Vec<Q::Answer> = Vec::new();
    while let Some(task) = tasks.pop() {
        match task {
            DescentTask::Ask(id, p, way) => {
                let way = question.enter(id, way);
                let node = tree.node(id);
                let child = |index: usize, p: DVec3, way: &Q::Way| {
                    DescentTask::Ask(node.children[index], p, question.below(way, index))
                };
                match &node.kind {
                    NodeKind::Primitive(leaf) => answers.push(question.primitive(leaf, p, &way)),
                    NodeKind::Particles(these) => answers.push(question.particles(these, p, &way)),
                    NodeKind::Combine(_) | NodeKind::Expression(_) => {
                        tasks.push(DescentTask::Answer(id, p, way.clone()));
                        tasks.extend((0..node.children.len()).rev().map(|index| child(index, p, &way)));
                    }
                    NodeKind::Select(which) => tasks.push(child(chosen(*which), p, &way)),
                    NodeKind::Affine(map) => {
                        let way = question.turned(tree, way, id, p);
                        tasks.push(child(0, map.inverse().transform_point3(p), &way));
                    }
                    NodeKind::Warp(_) if node.children.len() > 1 => {
                        let weight = child(1, p, &way);
                        tasks.push(DescentTask::Enter(id, p, way));
                        tasks.push(weight);
                    }
                    NodeKind::Warp(warp) => {
                        tasks.push(DescentTask::Mark(question.mark(warp, p, None)));
                        let way = question.turned(tree, way, id, p);
                        tasks.push(child(0, warp.inverse(p), &way));
                    }
                    NodeKind::Attribute { name, value, precedence } => {
                        let node = GivenAttribute { name, value, precedence: *precedence };
                        let way = question.given(way, node, p);
                        tasks.push(child(0, p, &way));
                    }
                    NodeKind::Constant { .. } => tasks.push(child(0, p, &way)),
                }
            }
            DescentTask::Enter(id, p, way) => {
                let weight = answers.pop().expect("the weight has been asked");
                let node = tree.node(id);
                if let NodeKind::Warp(warp) = &node.kind {
                    tasks.push(DescentTask::Mark(question.mark(warp, p, Some(&weight))));
                    let at = warp.weighted(p, Q::field(&weight));
                    let way = question.turned(tree, way, id, p);
                    tasks.push(DescentTask::Ask(node.children[0], at, question.below(&way, 0)));
                }
            }
            DescentTask::Mark(mark) => {
                let answer = answers.last_mut().expect("the child has been asked");
                question.marked(answer, mark);
            }
            DescentTask::Answer(id, p, way) => {
                let children = answers.split_off(answers.len() - tree.node(id).children.len());
                answers.push(joined(question, &tree.node(id).kind, (p, &way), &children));
            }
        }
    }
    answers.pop().expect("the root has answered")
}

/// The answer of a node whose children have answered.
fn joined<Q: Question>(
    question: &Q,
    kind: &NodeKind,
    (p, way): (DVec3, &Q::Way),
    children: &[Q::Answer],
) -> Q::Answer {
    match kind {
        NodeKind::Combine(combinator) => question.combine(*combinator, children),
        NodeKind::Expression(formula) => question.express(formula, p, way, children),
        NodeKind::Primitive(_)
        | NodeKind::Particles(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. } => unreachable!("these answer at once"),
    }
}
