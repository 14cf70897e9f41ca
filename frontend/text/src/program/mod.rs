//! Texts that are programs: definitions, loops, conditions, files, and values with names. They are expanded
//! as they are read.
//!
//! ```text
//! arm(2, hue = 0.1)          the cursor jumps to the body of `arm`, and back behind its `}`
//! for i in 0 .. 3 { .. }     at `}` it jumps back to the body, until `i` has had all its values
//! if i > 0 { .. } else { .. }   one of the blocks is skipped
//! include "parts.jbt"        the cursor goes through another text
//! ```
//!
//! So there is no list of tokens and no tree of syntax: what is open stands on the stack of open blocks
//! (`node.rs`), and nothing recurses, apart from files in files, of which there are
//! [`MAX_INCLUDE_DEPTH`](jbt_ir::limits::MAX_INCLUDE_DEPTH) at most. What an expansion will read is charged
//! before it begins, to the bytes that one scene may have: a scene is never longer than the longest text.

use jbt_ir::limits::{EXPANSION_BYTES, MAX_SCENE_BYTES};

use super::lex::TokenKind;
use super::state::Parser;
use jbt_model::combine::{Combinator, Union};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::number::Number;
use jbt_model::parameter::Fixture;
use jbt_model::tree::Tree;

mod body;
mod call;
mod definition;
mod include;
pub(super) mod known;
mod repeat;
mod style;
mod value;

impl<'a> Parser<'a> {
    /// Whether what is read stands in a file that the scene includes.
    pub(super) fn is_included(&self) -> bool {
        !self.program.open.is_empty()
    }

    /// Charges so many turns of so many bytes each to what may still be read. False, after a message, if that
    /// is too much; then nothing is read any more.
    fn charge(&mut self, turns: f64, bytes: usize, span: Span, what: &str) -> bool {
        self.program.has_expanded = true;
        let cost = turns * (bytes + EXPANSION_BYTES) as f64;
        let is_enough = self.is_enough(cost, span, what);
        if is_enough {
            self.program.left -= cost as usize;
        }
        is_enough
    }

    /// Whether so many turns can be afforded. False after a message; then nothing is read any more.
    fn affords(&mut self, turns: f64, span: Span, what: &str) -> bool {
        self.is_enough(turns * EXPANSION_BYTES as f64, span, what)
    }

    fn is_enough(&mut self, cost: f64, span: Span, what: &str) -> bool {
        if cost <= self.program.left as f64 {
            return true;
        }
        let left = self.program.left;
        let message = format!("{what} would make the text longer by {cost} bytes; {left} are left");
        self.give_up(
            Diagnostic::limit(Some(span), message)
                .expected(format!("an expanded text may have {MAX_SCENE_BYTES}")),
        );
        false
    }

    /// Charges the copy of a formula of so many steps.
    pub(super) fn charge_copy(&mut self, steps: usize, span: Span) -> bool {
        const STEP_BYTES: usize = 16;
        let cost = steps * STEP_BYTES;
        if let Some(left) = self.program.left.checked_sub(cost) {
            self.program.left = left;
            return true;
        }
        let message =
            format!("the formula of this number has {steps} steps, which are too many to copy here");
        self.give_up(Diagnostic::limit(Some(span), message));
        false
    }

    /// Charges the copy of a vector or a list with so many elements. Those that are as short as a colour or a
    /// place cost what their name does.
    fn charge_elements(&mut self, count: usize, span: Span) -> bool {
        const ELEMENT_BYTES: usize = 16;
        const SHORT: usize = 8;
        let cost = count.saturating_sub(SHORT) * ELEMENT_BYTES;
        if cost == 0 {
            return true;
        }
        let is_enough = self.is_enough(cost as f64, span, &format!("a copy of these {count} elements"));
        self.program.left -= if is_enough { cost } else { 0 };
        is_enough
    }

    /// Notes that nodes depend on a number which stays as it was read. False, after a message, if a
    /// parameter is out of its range, so that the number decides nothing.
    fn decides(&mut self, number: &Number, span: Span) -> bool {
        if !number.depends_on_parameters() {
            return true;
        }
        self.declares(Fixture::Expansion, number, span);
        let Some(error) = self.program.out_of_range.clone() else { return true };
        if !self.program.tells_range {
            self.report(|| error);
        }
        self.program.tells_range = true;
        false
    }

    /// A tree with a name. One that has another name already keeps it, below a union of this tree alone.
    pub(super) fn with_name(&mut self, tree: Tree, name: &str, span: Span) -> Tree {
        match tree.node().name() {
            _ if tree.identity() == self.broken.identity() => tree,
            None => tree.named(name),
            Some(own) if own == name => tree,
            Some(_) => {
                self.count_node(span);
                self.make(span, Combinator::from(Union {}), vec![tree]).named(name)
            }
        }
    }

    /// Whether what is next is a name in front of a node, `NAME : node`. Any word may be one.
    pub(super) fn begins_named(&self) -> bool {
        self.peek().kind == TokenKind::Word && self.peek_behind().is(b':')
    }
}
