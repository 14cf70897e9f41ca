//! Open bodies of definitions, loops and conditions, and what waits for a node in them.

use jbt_ir::limits::MAX_EXPANSION_DEPTH;

use super::known::{BodyFrame, BodyKind, CallFrame, LocalFrame, Remembered, Value};
use crate::block::{Begun, NodeFrame, NodeStack};
use crate::lex::{Token, TokenKind};
use crate::state::Parser;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;
use jbt_model::tree::Tree;

impl<'a> Parser<'a> {
    /// The frame of a body whose `{` has just been taken.
    pub(super) fn open_body(&mut self, open: Token, span: Span, kind: BodyKind<'a>) -> Begun<'a> {
        let counts = !matches!(kind, BodyKind::Branch);
        if counts && self.program.depth == MAX_EXPANSION_DEPTH {
            let message = format!("more than {MAX_EXPANSION_DEPTH} calls and loops in each other");
            self.give_up(Diagnostic::limit(Some(span), message));
            return Begun::Nothing;
        }
        self.program.depth += usize::from(counts);
        let mut frame = BodyFrame {
            kind,
            first: 0,
            open: open.start as u32,
            locals: self.program.locals.len(),
            visible: self.program.visible,
            around: self.program.calls.clone(),
            errors: self.report.count(),
        };
        self.turn(&mut frame);
        Begun::Body(Box::new(frame))
    }

    /// The end of a body, whose `}` has just been taken. Gives it back if it goes on with its next turn.
    pub(crate) fn close_body(
        &mut self,
        mut frame: Box<BodyFrame<'a>>,
        finished: &[Tree],
    ) -> Option<Box<BodyFrame<'a>>> {
        self.program.locals.truncate(frame.locals);
        if self.turn(&mut frame) {
            return Some(frame);
        }
        let wrong = self.report.count() > frame.errors;
        self.program.visible = frame.visible;
        self.program.calls = frame.around;
        match frame.kind {
            BodyKind::BodyLoop(_) => self.program.depth -= 1,
            BodyKind::Branch => self.skip_else(),
            BodyKind::Call { definition, back, key } => {
                self.program.depth -= 1;
                definition.is_wrong.set(definition.is_wrong.get() || wrong);
                let nodes = &finished[frame.first.min(finished.len())..];
                let (span, what) = (definition.span, format!("{} nodes", nodes.len()));
                if let Some(key) = key
                    && self.charge(nodes.len() as f64, 0, span, &what)
                {
                    self.program.remembered.insert(key, Remembered(nodes.into()));
                }
                if self.stopped {
                    return None;
                }
                self.lexer.jump(back);
            }
        }
        None
    }

    /// A `let` in a body, whose word has just been taken.
    pub(crate) fn local_let(&mut self, stack: &mut NodeStack<'a>) {
        let Some((name, span)) = self.name("value") else { return };
        self.equals();
        self.check_local(name, span);
        if self.is_muted() {
            return;
        }
        if self.begins_plain() {
            let value = self.value().unwrap_or_else(Value::unknown);
            self.program.bind(name, value);
        } else {
            let (first, is_named) = (stack.finished.len(), self.begins_named());
            let frame = LocalFrame { name, span, first, stays: false, is_named };
            stack.frames.push(NodeFrame::Local(Box::new(frame)));
        }
    }

    /// A name in front of a node, `NAME : node`, which has just been taken with its mark.
    pub(crate) fn named_node(&mut self, token: Token) -> Begun<'a> {
        let frame =
            LocalFrame { name: self.text(token), span: token.span(), first: 0, stays: true, is_named: false };
        Begun::Named(Box::new(frame))
    }

    /// Gives nodes that are finished to what waits for them.
    pub(crate) fn settle(&mut self, stack: &mut NodeStack<'a>) {
        loop {
            match stack.frames.last() {
                Some(NodeFrame::Local(frame)) => {
                    let (first, name, span, stays) = (frame.first, frame.name, frame.span, frame.stays);
                    let is_named = frame.is_named;
                    stack.frames.pop();
                    let tree = self.only(stack, first, span, &format!("`{}`", clip(name)));
                    let tree = if is_named { tree } else { self.with_name(tree, name, span) };
                    if stays {
                        stack.finished.push(tree);
                    } else {
                        self.program.bind(name, Value::Tree(tree));
                        // A name is no node: what is around still waits.
                        return;
                    }
                }
                Some(NodeFrame::Call(frame)) => {
                    let (first, span) = (frame.first, frame.span);
                    let tree = self.only(stack, first, span, "this argument");
                    let Some(NodeFrame::Call(mut frame)) = stack.frames.pop() else { return };
                    frame.give(Value::Tree(tree));
                    if !self.advance(frame, stack) {
                        return;
                    }
                }
                Some(NodeFrame::Block(_) | NodeFrame::Body(_)) | None => return,
            }
        }
    }

    /// The only node from a place of the stack on; else a message.
    fn only(&mut self, stack: &mut NodeStack<'a>, first: usize, span: Span, what: &str) -> Tree {
        let mut trees: Vec<Tree> = stack.finished.drain(first.min(stack.finished.len())..).collect();
        match (trees.pop(), trees.len()) {
            (Some(tree), 0) => tree,
            (last, others) => {
                let count = others + usize::from(last.is_some());
                self.report(|| {
                    Diagnostic::error(Some(span), format!("{what} stands for {count} nodes"))
                        .expected("expected one; `sum { .. }` around them makes them one")
                });
                self.broken.clone()
            }
        }
    }

    /// Goes on with a call. Whether it has become nodes, so that what is around may go on as well.
    pub(crate) fn advance(&mut self, mut frame: Box<CallFrame<'a>>, stack: &mut NodeStack<'a>) -> bool {
        match self.arguments(&mut frame) {
            super::call::Next::Node => {
                frame.first = stack.finished.len();
                stack.frames.push(NodeFrame::Call(frame));
                false
            }
            super::call::Next::Done => match self.enter(*frame) {
                Begun::Body(mut body) => {
                    body.first = stack.finished.len();
                    stack.bodies += 1;
                    stack.frames.push(NodeFrame::Body(body));
                    false
                }
                Begun::Many(trees) => {
                    stack.finished.extend(trees.iter().cloned());
                    true
                }
                _ => false,
            },
            super::call::Next::Broken => {
                stack.finished.push(self.broken.clone());
                true
            }
        }
    }

    /// Whether a value is next, and no node.
    pub(crate) fn begins_value(&self) -> bool {
        self.peek().kind != TokenKind::End && self.begins_plain()
    }
}
