//! Blocks of a text, and what their nodes become.

use std::rc::Rc;
use std::sync::Arc;

use super::program::known::{BodyFrame, CallFrame, LocalFrame, TextStyle};
use jbt_model::attribute::Precedence;
use jbt_model::combine::CombinatorKind;
use jbt_model::diagnostic::Span;
use jbt_model::tree::Tree;
use jbt_model::written::Written;

/// What an open block becomes.
pub(super) enum Head {
    /// An operator without parameters.
    Combine(CombinatorKind),
    /// An operator with parameters.
    Operator(Box<Written>),
    /// With one child. Boxed, so that a million open blocks are small.
    Unary(Box<Written>),
    /// A style, and whether it overrides.
    Styled(Rc<TextStyle>, Precedence),
    /// A warp whose second child weighs it.
    Weighted(Box<Written>),
    /// The head has an error; the block is read for its own errors.
    Broken,
}

/// An open block.
pub(super) struct BlockFrame {
    pub(super) head: Head,
    /// Its first child on the stack of finished subtrees.
    pub(super) first: u32,
    /// The node's words before the block.
    pub(super) span: Span,
    /// The byte of the opening brace.
    pub(super) open: u32,
    /// Something in the block could not be read: its children are not counted.
    pub(super) incomplete: bool,
    /// A node around it, which its words give as well.
    pub(super) around: Option<Box<Written>>,
}

impl BlockFrame {
    /// With a node around it.
    pub(super) fn inside(self, around: Written) -> Self {
        Self { around: Some(Box::new(around)), ..self }
    }
}

/// What is open.
pub(super) enum NodeFrame<'a> {
    /// A block of children.
    Block(BlockFrame),
    /// The body of a definition, of a loop or of a condition.
    Body(Box<BodyFrame<'a>>),
    /// A call waits for an argument.
    Call(Box<CallFrame<'a>>),
    /// A name waits for its node.
    Local(Box<LocalFrame<'a>>),
}

/// The stack of what is open, and that of finished subtrees.
#[derive(Default)]
pub(super) struct NodeStack<'a> {
    pub(super) frames: Vec<NodeFrame<'a>>,
    pub(super) finished: Vec<Tree>,
    /// How many of the frames are bodies.
    pub(super) bodies: usize,
}

/// What begins with a word.
pub(super) enum Begun<'a> {
    /// A whole subtree.
    Leaf(Tree),
    /// Whole subtrees, which have been expanded already.
    Many(Arc<[Tree]>),
    /// A block is open.
    Block(BlockFrame),
    /// A body is open.
    Body(Box<BodyFrame<'a>>),
    /// A call is open.
    Call(Box<CallFrame<'a>>),
    /// A node with a name follows.
    Named(Box<LocalFrame<'a>>),
    /// What stands for no nodes.
    Done,
    /// Nothing: the word was skipped.
    Nothing,
}
