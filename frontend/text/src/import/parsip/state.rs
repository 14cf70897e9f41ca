//! The state of reading one ParsIP file, and the meanings of its nodes.

use glam::DAffine3;

use super::scan::Sections;
use jbt_model::combine::Combinator;
use jbt_model::kind::Primitive;
use jbt_model::report::Report;
use jbt_model::tree::Tree;
use jbt_model::warp::Warp;

/// The meaning of a node, without its children and its map.
pub(super) enum Meaning {
    Combine(Combinator),
    Warp(Warp),
    Taper(LinearTaper),
    Map(DAffine3),
    /// The first child's field, times what the others leave of 1.
    SmoothDifference,
    /// Its only child: a cache, a texture, an instance.
    Same,
    Leaf {
        leaf: Primitive,
        color: Option<[f64; 3]>,
    },
}

/// A coordinate that is multiplied by what is linear in another one.
#[derive(Clone, Copy)]
pub(super) struct LinearTaper {
    /// The coordinate that changes, and the one that it changes along.
    pub(super) axis: usize,
    pub(super) base: usize,
    pub(super) factor: f64,
}

/// The progress of reading a node.
#[derive(Clone)]
pub(super) enum NodeState {
    New,
    /// Its children are being read: a reference to it now is a cycle.
    Open,
    Done(Tree),
}

/// The state of reading one file.
pub(super) struct Importer<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) sections: Sections,
    pub(super) errors: Report,
    pub(super) warnings: Report,
    /// Uses of nodes by others, so far.
    pub(super) edges: usize,
    /// Whether a node is the child of an operator already.
    pub(super) adopted: Vec<bool>,
}
