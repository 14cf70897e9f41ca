//! The state of reading one ParsIP file, and the meanings of its nodes.

use super::scan::Sections;
use jbt_model::combine::Combinator;
use jbt_model::kind::Primitive;
use jbt_model::report::Report;
use jbt_model::tree::Tree;
use jbt_model::warp::Twist;

/// The meaning of a node, without its children and its map.
pub(super) enum Meaning {
    Combine(Combinator),
    Warp(Twist),
    /// Its only child: a cache, a texture, an instance.
    Same,
    Leaf {
        leaf: Primitive,
        color: Option<[f64; 3]>,
    },
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
