//! What a text says about a node besides what it means: its name, and the calls that it was expanded in.
//!
//! None of it changes a field, and equality of trees looks at none of it.

use std::sync::Arc;

use crate::diagnostic::{Note, Span};
use crate::precedence::Precedence;

/// What is known of a node besides its meaning. Most nodes have none.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct NodeLabel {
    /// Its name.
    pub name: Option<Arc<str>>,
    /// Whether it is a part: a solid of its own, if it stands right below the root.
    pub part: bool,
    /// The style that it and nodes below it are.
    pub style: Option<NodeStyle>,
    /// The calls and loops around it, if it is not written where the model has it.
    pub calls: Option<Arc<LabelCall>>,
}

/// A use of a style: see [`Tree::style`](crate::tree::Tree::style).
#[derive(Clone, PartialEq, Debug)]
pub struct NodeStyle {
    /// What the style is called.
    pub name: Arc<str>,
    /// How many nodes it stands for: this one, and the next ones below.
    pub count: usize,
    /// Whether all of it overrides what stands below.
    pub precedence: Precedence,
}

/// A place where a definition is used or a loop stands, and those around it.
#[derive(PartialEq, Debug)]
pub struct LabelCall {
    /// What is called, or the variable of a loop.
    pub name: Arc<str>,
    /// In a loop: the number that the variable has, if it is one; nothing for calls.
    pub turn: Option<CallTurn>,
    /// Where it stands.
    pub span: Span,
    /// What it stands in.
    pub above: Option<Arc<Self>>,
}

/// One run of a loop.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum CallTurn {
    /// The variable is a number.
    Number(f64),
    /// The variable is an element of a list: its place, from 0.
    Element(usize),
}

impl LabelCall {
    /// How many notes a chain has at each of its ends.
    const SHOWN: usize = 4;

    /// The chain in words, innermost first; the middle of a long one is counted.
    #[must_use]
    pub fn notes(&self) -> Vec<Note> {
        let mut chain = Vec::new();
        let mut next = Some(self);
        while let Some(call) = next {
            chain.push(call);
            next = call.above.as_deref();
        }
        let left_out = chain.len().saturating_sub(2 * Self::SHOWN);
        let first = chain.len().min(Self::SHOWN);
        let mut notes: Vec<Note> = chain[..first].iter().map(|call| call.note()).collect();
        if left_out > 0 {
            notes.push(Note { span: None, message: format!("in {left_out} more calls and loops") });
        }
        notes.extend(chain[first + left_out..].iter().map(|call| call.note()));
        notes
    }

    fn note(&self) -> Note {
        let name = &self.name;
        let message = match self.turn {
            None => format!("in `{name}`, which is used"),
            Some(CallTurn::Number(number)) => format!("in the loop with {name} = {number}"),
            Some(CallTurn::Element(place)) => format!("in the loop where `{name}` is element {place}"),
        };
        Note { span: Some(self.span), message }
    }
}
