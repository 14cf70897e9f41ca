//! The tree of a file: operators over children, by an explicit list of what is left to do.

use glam::{DAffine3, DQuat, DVec3};
use jbt_ir::limits::MAX_RICCI_EXPONENT;
use jbt_model::axis::Axis;
use jbt_model::combine::{Combinator, Intersection, Ricci, Union};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::{clip, nearest};
use jbt_model::tree::Tree;
use jbt_model::warp::{Twist, Warp};

use super::json::JsonValue;
use super::leaf::Placed;
use super::reader::TreeReader;

/// What a node does to its children.
#[derive(Clone, Copy)]
enum NodeOperation {
    Combine(Combinator),
    /// The first less a power of the second.
    Difference(f64),
    Scale(DVec3),
    Twist {
        axis: DVec3,
        rate: f64,
    },
}

/// What is left to do.
enum NodeTask {
    Enter(JsonValue),
    Leave(JsonValue, NodeOperation, usize),
}

/// All types of nodes, for hints.
const TYPES: [&str; 11] = [
    "RootNode",
    "RicciNode",
    "MinNode",
    "MaxNode",
    "DifferenceNode",
    "ScaleNode",
    "TwistNode",
    "ScalisPoint",
    "ScalisSegment",
    "ScalisTriangle",
    "SDFRootNode",
];

/// How near to y an axis is y.
const NEAR: f64 = 1e-4;

impl TreeReader<'_> {
    /// The tree below a node.
    pub(super) fn tree(&mut self, root: JsonValue) -> Result<Tree, Diagnostic> {
        let mut done: Vec<Placed> = Vec::new();
        let mut tasks = vec![NodeTask::Enter(root)];
        while let Some(task) = tasks.pop() {
            match task {
                NodeTask::Enter(node) => match self.enter(node)? {
                    Entered::Leaf(placed) => done.push(self.located(node, placed)),
                    Entered::Operator(operation) => {
                        let children = self.children(node)?;
                        tasks.push(NodeTask::Leave(node, operation, children.len()));
                        tasks.extend(children.into_iter().rev().map(NodeTask::Enter));
                    }
                },
                NodeTask::Leave(node, operation, count) => {
                    let children = done.split_off(done.len() - count);
                    let placed = self.apply(node, operation, children)?;
                    done.push(self.located(node, placed));
                }
            }
        }
        // The list ends with the root.
        done.pop().map(|root| root.tree).ok_or_else(|| self.error(root, "the file has no node"))
    }

    /// What the check says of it is said of the object in the file.
    fn located(&self, node: JsonValue, placed: Placed) -> Placed {
        Placed { tree: placed.tree.located(self.json.span(node)), ..placed }
    }

    fn children(&self, node: JsonValue) -> Result<Vec<JsonValue>, Diagnostic> {
        let list = self.needed(node, "children")?;
        let children: Vec<JsonValue> = self.json.values(list).collect();
        if children.is_empty() { Err(self.error(list, "the node has no children")) } else { Ok(children) }
    }

    fn enter(&mut self, node: JsonValue) -> Result<Entered, Diagnostic> {
        let (kind, value) = self.needed_text(node, "type")?;
        let number = |name: &str, default: f64| self.number_or(node, name, default);
        let has_alpha = self.json.member(node, "alpha").is_some();
        let operation = match kind {
            "ScalisPoint" => return self.scalis_point(node).map(Entered::Leaf),
            "ScalisSegment" => return self.scalis_segment(node).map(Entered::Leaf),
            "ScalisTriangle" => return self.scalis_triangle(node).map(Entered::Leaf),
            "SDFRootNode" => return self.distance(node).map(Entered::Leaf),
            "RootNode" | "RicciNode" => {
                let default = if kind == "RootNode" { Some(64.0) } else { None };
                NodeOperation::Combine(self.ricci(node, default)?)
            }
            "MinNode" => NodeOperation::Combine(Intersection {}.into()),
            "MaxNode" => NodeOperation::Combine(Union {}.into()),
            // The library writes its difference under the name of its parent.
            "DifferenceNode" => NodeOperation::Difference(self.alpha(node)?),
            "Node" if has_alpha => NodeOperation::Difference(self.alpha(node)?),
            "ScaleNode" => {
                let scale =
                    DVec3::new(number("scale_x", 1.0)?, number("scale_y", 1.0)?, number("scale_z", 1.0)?);
                if scale.cmpeq(DVec3::ZERO).any() {
                    return Err(self.error(node, "the scale has a 0"));
                }
                NodeOperation::Scale(scale)
            }
            "TwistNode" => {
                // The library's spelling; the usual one is read as well.
                let rate = match self.json.member(node, "twist_amout") {
                    Some(value) => self.number(value)?,
                    None => number("twist_amount", 1.0)?,
                };
                let axis = DVec3::new(number("axis_x", 0.0)?, number("axis_y", 1.0)?, number("axis_z", 0.0)?);
                if axis == DVec3::ZERO {
                    return Err(self.error(node, "the axis of the twist has no length"));
                }
                NodeOperation::Twist { axis, rate }
            }
            _ => {
                let error = self.error(value, format!("there is no node of the type {}", clip(kind)));
                let near = nearest(kind, TYPES).map(|near| format!("perhaps {near}"));
                return Err(error.expected(near.unwrap_or_else(|| format!("there are {}", TYPES.join(", ")))));
            }
        };
        Ok(Entered::Operator(operation))
    }

    /// Ricci's blend, by the older or the newer name of its exponent.
    fn ricci(&self, node: JsonValue, default: Option<f64>) -> Result<Combinator, Diagnostic> {
        let given = self.json.member(node, "ricci_n").or_else(|| self.json.member(node, "ricci"));
        let (value, exponent) = match (given, default) {
            (Some(value), _) => (value, self.number(value)?),
            (None, Some(default)) => (node, default),
            (None, None) => return Err(self.error(node, "the object has no \"ricci_n\"")),
        };
        if !(1.0..=MAX_RICCI_EXPONENT).contains(&exponent) {
            let error = self.error(value, format!("the exponent of the blend is {exponent}"));
            return Err(error.expected(format!("expected a number from 1 to {MAX_RICCI_EXPONENT}")));
        }
        Ok(Ricci { exponent }.into())
    }

    fn alpha(&self, node: JsonValue) -> Result<f64, Diagnostic> {
        let alpha = self.number_or(node, "alpha", 1.0)?;
        if alpha > 0.0 {
            return Ok(alpha);
        }
        Err(self.error(node, format!("the alpha is {alpha}")).expected("expected a number above 0"))
    }

    fn apply(
        &mut self,
        node: JsonValue,
        operation: NodeOperation,
        mut children: Vec<Placed>,
    ) -> Result<Placed, Diagnostic> {
        let span = self.json.span(node);
        match operation {
            NodeOperation::Combine(combinator) => {
                let low = children.iter().map(|child| child.low).reduce(DVec3::min).unwrap_or_default();
                let high = children.iter().map(|child| child.high).reduce(DVec3::max).unwrap_or_default();
                let trees: Vec<Tree> = children.into_iter().map(|child| child.tree).collect();
                Ok(Placed { tree: self.combined(span, combinator, trees), low, high })
            }
            NodeOperation::Difference(alpha) => {
                let Ok([body, cutter]) = <[Placed; 2]>::try_from(children) else {
                    return Err(self.error(node, "a difference has two children"));
                };
                let taken = cutter.tree.field();
                let taken = if alpha == 1.0 { taken } else { taken.max(0.0).powf(alpha) };
                let tree = Tree::expression((body.tree.field() - taken).max(0.0));
                Ok(Placed { tree, ..body })
            }
            NodeOperation::Scale(_) | NodeOperation::Twist { .. } => {
                let low = children.iter().map(|child| child.low).reduce(DVec3::min).unwrap_or_default();
                let high = children.iter().map(|child| child.high).reduce(DVec3::max).unwrap_or_default();
                if children.len() > 1 {
                    let message = "children of a scale or a twist before the last one are left out";
                    self.left_out.note(span, message);
                }
                let last = children.pop().ok_or_else(|| self.error(node, "the node has no children"))?;
                Ok(moved(operation, Placed { tree: last.tree, low, high }))
            }
        }
    }

    /// An operator over trees. A child that is not above 0 does not count in Ricci's blend, and the plain sum
    /// differs from that where fields are negative.
    fn combined(&self, span: Span, combinator: Combinator, mut trees: Vec<Tree>) -> Tree {
        if trees.len() == 1 && !self.negative {
            return trees.remove(0);
        }
        let combinator = match combinator {
            Combinator::Ricci(Ricci { exponent }) if self.negative && exponent == 1.0 => {
                Ricci { exponent: 1.0 + f64::EPSILON }.into()
            }
            other => other,
        };
        Tree::at(span, combinator, trees)
    }
}

enum Entered {
    Leaf(Placed),
    Operator(NodeOperation),
}

/// A scale or a twist about the middle of a box.
fn moved(operation: NodeOperation, child: Placed) -> Placed {
    let Placed { tree, low, high } = child;
    let center = low.midpoint(high);
    let (to, back) = (DAffine3::from_translation(center), DAffine3::from_translation(-center));
    match operation {
        NodeOperation::Scale(scale) => {
            let grown = (high - low) * (scale - 1.0);
            let tree = Tree::new(to * DAffine3::from_scale(scale) * back, vec![tree]);
            Placed { tree, low: low - grown, high: high + grown }
        }
        NodeOperation::Twist { axis, rate } => {
            let turn = DAffine3::from_quat(shortest(axis));
            let twist = Warp::from(Twist { axis: Axis::Y, rate });
            let twisted = Tree::new(twist, vec![Tree::new(turn * back, vec![tree])]);
            Placed { tree: Tree::new(to * turn.inverse(), vec![twisted]), low, high }
        }
        NodeOperation::Combine(_) | NodeOperation::Difference(_) => Placed { tree, low, high },
    }
}

/// The rotation that takes an axis to y by the shortest way, as the library finds it: also for an axis whose
/// length is not 1.
fn shortest(axis: DVec3) -> DQuat {
    if axis.distance(DVec3::Y) < NEAR {
        return DQuat::IDENTITY;
    }
    let real = axis.y + 1.0;
    let turn = if real < f64::EPSILON {
        if axis.x.abs() > axis.z.abs() {
            DQuat::from_xyzw(-axis.y, axis.x, 0.0, 0.0)
        } else {
            DQuat::from_xyzw(0.0, -axis.z, axis.y, 0.0)
        }
    } else {
        let cross = axis.cross(DVec3::Y);
        DQuat::from_xyzw(cross.x, cross.y, cross.z, real)
    };
    turn.normalize()
}
