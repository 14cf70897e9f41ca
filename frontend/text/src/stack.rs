//! The stack of open blocks, bodies, calls and names, and that of finished subtrees: how nodes are read
//! without recursion.

use super::block::{Begun, BlockFrame, NodeFrame, NodeStack};
use super::lex::TokenKind;
use super::state::Parser;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::tree::Tree;
use jbt_model::word::is_statement;

impl<'a> Parser<'a> {
    /// One node with everything below it.
    pub(super) fn tree(&mut self) -> Tree {
        let start = self.peek();
        let mut trees = self.nodes();
        match (trees.pop(), trees.is_empty()) {
            (Some(tree), true) => tree,
            (last, _) => {
                let count = trees.len() + usize::from(last.is_some());
                self.report(|| {
                    Diagnostic::error(Some(start.span()), format!("this stands for {count} nodes"))
                        .expected("expected one; `sum { .. }` around them makes them one")
                });
                self.broken.clone()
            }
        }
    }

    /// What is next with everything below it: one node, or those that a call, a loop or a condition stands
    /// for.
    pub(super) fn nodes(&mut self) -> Vec<Tree> {
        let mut stack = NodeStack::default();
        loop {
            if !self.step(&mut stack) {
                return vec![self.broken.clone()];
            }
            if stack.frames.is_empty() {
                return stack.finished;
            }
        }
    }

    /// One step: a word begins something, or a brace ends it. False if reading cannot go on.
    fn step(&mut self, stack: &mut NodeStack<'a>) -> bool {
        let token = self.peek();
        let word = self.peek_word();
        let in_body = matches!(stack.frames.last(), Some(NodeFrame::Body(_)));
        match token.kind {
            TokenKind::Word if in_body && word == Some("let") && !self.begins_named() => {
                self.report_again();
                self.next();
                self.local_let(stack);
            }
            TokenKind::Word if !word.is_some_and(|word| self.begins_statement(word)) => {
                let begun = self.begin();
                self.push(begun, stack);
            }
            TokenKind::Mark(b'}')
                if matches!(stack.frames.last(), Some(NodeFrame::Block(_) | NodeFrame::Body(_))) =>
            {
                self.report_again();
                self.next();
                self.pop(stack);
            }
            TokenKind::Word if stack.bodies > 0 && !self.stopped => {
                self.expected_at(
                    token,
                    "expected a node or `}`: this statement stands outside of all blocks",
                );
                self.next();
            }
            TokenKind::Word | TokenKind::End => {
                match stack.frames.last() {
                    Some(NodeFrame::Block(frame)) => self.unclosed(frame.open, token),
                    Some(NodeFrame::Body(frame)) => self.unclosed(frame.open, token),
                    Some(NodeFrame::Call(_) | NodeFrame::Local(_)) | None => {
                        self.expected_at(token, "expected a node");
                    }
                }
                return false;
            }
            TokenKind::Mark(_) | TokenKind::Number | TokenKind::Quoted | TokenKind::Unknown => {
                match stack.frames.last_mut() {
                    Some(NodeFrame::Block(frame)) => frame.incomplete = true,
                    Some(NodeFrame::Body(_)) => {}
                    Some(NodeFrame::Call(_) | NodeFrame::Local(_)) => {
                        self.expected_at(token, "expected a node");
                        stack.finished.push(self.broken.clone());
                        self.settle(stack);
                        return true;
                    }
                    None => {
                        self.expected_at(token, "expected a node");
                        return false;
                    }
                }
                self.expected_at(token, "expected a node or `}`");
                self.skip_token();
            }
        }
        true
    }

    /// Takes what a word has begun.
    fn push(&mut self, begun: Begun<'a>, stack: &mut NodeStack<'a>) {
        match begun {
            Begun::Leaf(tree) => {
                stack.finished.push(tree);
                self.settle(stack);
            }
            Begun::Many(trees) => {
                stack.finished.extend(trees.iter().cloned());
                self.settle(stack);
            }
            Begun::Block(frame) => {
                stack
                    .frames
                    .push(NodeFrame::Block(BlockFrame { first: stack.finished.len() as u32, ..frame }));
            }
            Begun::Body(mut frame) => {
                frame.first = stack.finished.len();
                stack.bodies += 1;
                stack.frames.push(NodeFrame::Body(frame));
            }
            Begun::Call(frame) => {
                if self.advance(frame, stack) {
                    self.settle(stack);
                }
            }
            Begun::Named(mut frame) => {
                frame.first = stack.finished.len();
                stack.frames.push(NodeFrame::Local(frame));
            }
            Begun::Done => self.settle(stack),
            Begun::Nothing => {}
        }
    }

    /// Ends the block or the body on top, whose brace has just been taken.
    fn pop(&mut self, stack: &mut NodeStack<'a>) {
        match stack.frames.pop() {
            Some(NodeFrame::Block(frame)) => {
                let children = stack.finished.drain(frame.first as usize..).collect();
                let tree = self.close(frame, children);
                stack.finished.push(tree);
                self.settle(stack);
            }
            Some(NodeFrame::Body(frame)) => match self.close_body(frame, &stack.finished) {
                Some(frame) => stack.frames.push(NodeFrame::Body(frame)),
                None => {
                    stack.bodies -= 1;
                    self.settle(stack);
                }
            },
            Some(NodeFrame::Call(_) | NodeFrame::Local(_)) | None => {}
        }
    }

    /// Whether the word that is next begins a statement.
    fn begins_statement(&self, word: &str) -> bool {
        let begins = is_statement(word) || word != "include" && self.begins_definition(word);
        begins && !self.begins_named()
    }
}
