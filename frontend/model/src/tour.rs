//! Tours: every path of a checked tree from above, with what holds there.
//!
//! ```text
//! union { color (1 0 0) { translate (2 0 0) { point } } ring }
//!
//! enter union   enter color   enter affine   enter point           leave point   leave affine   ..
//!                                            color red, map x + 2
//! ```
//!
//! Whoever writes a model for another program, draws it or casts rays at its leaves needs no stack of maps
//! and attributes. A tour is iterative: a chain of a million nodes is a tree like any other.

use std::rc::Rc;

use glam::DAffine3;

use crate::check::{CheckedTree, NodeId};
use crate::kind::{NodeKind, rows_of};

/// A node on one of its paths, and what the nodes above it make of it.
#[derive(Clone, PartialEq, Debug)]
pub struct TourStep {
    /// The node.
    pub node: NodeId,
    /// How many nodes are above it.
    pub depth: usize,
    /// Which child of the node above it is; 0 for the root.
    pub child: usize,
    state: Rc<TourState>,
}

/// What holds at a node by those above it.
#[derive(Clone, PartialEq, Debug)]
struct TourState {
    map: DAffine3,
    warp: Option<NodeId>,
    bound: Vec<NodeId>,
}

impl TourStep {
    /// The rows of the map from the space of the node to the world, or to the space below the nearest
    /// [warp](Self::warp); the last column is the shift. An affine node counts for those below it alone.
    #[must_use]
    pub fn rows(&self) -> [[f64; 4]; 3] {
        rows_of(&self.state.map)
    }

    /// The nearest warp above, which no map can stand for.
    #[must_use]
    pub fn warp(&self) -> Option<NodeId> {
        self.state.warp
    }

    /// The attribute nodes and constants above that hold here: of each name the nearest one, unless one
    /// overrides it, in the order of the nodes that first gave the names.
    #[must_use]
    pub fn bound(&self) -> &[NodeId] {
        &self.state.bound
    }
}

/// What comes next on a tour.
#[derive(Clone, PartialEq, Debug)]
pub enum TourEvent {
    /// A node, in front of all that is below it.
    Enter(TourStep),
    /// The same, behind all that is below it.
    Leave(TourStep),
}

/// A tour that is under way: an iterator over its events.
#[derive(Debug)]
pub struct Tour<'a> {
    tree: &'a CheckedTree,
    stack: Vec<TourEvent>,
    /// How many events wait besides those below the node that was entered last.
    without: usize,
}

impl Tour<'_> {
    /// Leaves out what is below the node that was entered last: its leave comes next.
    pub fn skip_below(&mut self) {
        self.stack.truncate(self.without);
    }

    /// Where the child of a node stands.
    fn below(&self, step: &TourStep, child: usize) -> TourStep {
        let node = self.tree.node(step.node);
        let state = match &node.kind {
            NodeKind::Affine(map) => {
                Rc::new(TourState { map: step.state.map * *map, ..TourState::clone(&step.state) })
            }
            // What weighs a warp stands where the warp does.
            NodeKind::Warp(_) if child == 0 => {
                let map = DAffine3::IDENTITY;
                Rc::new(TourState { map, warp: Some(step.node), ..TourState::clone(&step.state) })
            }
            NodeKind::Attribute { .. } | NodeKind::Constant { .. } => {
                let mut state = TourState::clone(&step.state);
                let is_replaced = |&bound: &NodeId| self.tree.node(bound).kind.binds_what(&node.kind);
                match state.bound.iter().position(is_replaced) {
                    Some(place) if self.tree.node(state.bound[place]).kind.overrides() => {}
                    Some(place) => state.bound[place] = step.node,
                    None => state.bound.push(step.node),
                }
                Rc::new(state)
            }
            NodeKind::Primitive(_)
            | NodeKind::Particles(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Warp(_) => Rc::clone(&step.state),
        };
        TourStep { node: node.children[child], depth: step.depth + 1, child, state }
    }
}

impl Iterator for Tour<'_> {
    type Item = TourEvent;

    fn next(&mut self) -> Option<TourEvent> {
        let event = self.stack.pop()?;
        if let TourEvent::Enter(step) = &event {
            let node = self.tree.node(step.node);
            self.stack.push(TourEvent::Leave(step.clone()));
            self.without = self.stack.len();
            let children = node.kind.places_asked(node.children.len());
            for child in children.rev() {
                let below = self.below(step, child);
                self.stack.push(TourEvent::Enter(below));
            }
        } else {
            self.without = self.stack.len();
        }
        Some(event)
    }
}

impl CheckedTree {
    /// Every path from the root, with an event in front of what is below a node and one behind it. Of a
    /// selector the chosen child counts.
    ///
    /// ```
    /// use jbt_model::kind::NodeKind;
    /// use jbt_model::tour::TourEvent;
    /// let text = "jbt 1 union { color (1 0 0) { translate (2 0 0) { point { radius 1 } } } point { radius 1 } }";
    /// let tree = jbt_text::model(text)?.check()?;
    /// let mut told = Vec::new();
    /// for event in tree.tour() {
    ///     if let TourEvent::Enter(step) = event
    ///         && let NodeKind::Primitive(_) = tree.node(step.node).kind
    ///     {
    ///         told.push((step.rows()[0][3], step.bound().len()));
    ///     }
    /// }
    /// assert_eq!(told, [(2.0, 1), (0.0, 0)]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// Cost: the paths, of which there are at most [`MAX_INSTANCES`](jbt_ir::limits::MAX_INSTANCES).
    #[must_use]
    pub fn tour(&self) -> Tour<'_> {
        let state = Rc::new(TourState { map: DAffine3::IDENTITY, warp: None, bound: Vec::new() });
        let root = TourStep { node: self.root(), depth: 0, child: 0, state };
        Tour { tree: self, stack: vec![TourEvent::Enter(root)], without: 0 }
    }
}
