//! Styles: attributes and constants that have a name together.
//!
//! ```text
//! style oak = { color (0.45 0.25 0.1) rough 0.7 constant material "oak" }
//! style oak { child }
//! override style oak { child }
//! ```

use std::collections::HashSet;
use std::rc::Rc;
use std::sync::Arc;

use super::known::TextStyle;
use crate::block::{Begun, Head};
use crate::lex::Token;
use crate::state::Parser;
use jbt_model::attribute::Precedence;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::label::{LabelCall, NodeLabel, NodeStyle};
use jbt_model::report::{clip, nearest};
use jbt_model::tree::Tree;
use jbt_model::word::{OVERRIDE, STYLE, normalized};
use jbt_model::written::Written;

impl<'a> Parser<'a> {
    /// Whether a word that is next begins the definition of a style, and not a use.
    pub(crate) fn begins_style(&self, word: &str) -> bool {
        let name = self.peek_behind();
        word == STYLE
            && name.kind == crate::lex::TokenKind::Word
            && self.group(word).is_none()
            && !self.lexer.rest(name.end).trim_start().starts_with('{')
    }

    /// Whether a word that has just been taken begins the use of a style.
    pub(crate) fn is_style(&self, word: &str) -> bool {
        word == STYLE && self.group(word).is_none()
    }

    /// A definition whose word has just been taken.
    pub(super) fn style_statement(&mut self) {
        let Some((name, span)) = self.name("style") else { return };
        self.equals();
        let open = self.peek();
        if !open.is(b'{') {
            self.expected_at(open, "expected `{` and attributes or constants");
            return;
        }
        let end = self.block_end();
        self.next();
        let errors = self.report.count();
        let values = self.style_values(name);
        if self.report.count() > errors {
            self.jump_behind(end);
            self.report_again();
        } else if values.is_empty() {
            self.report(|| {
                Diagnostic::error(Some(span), format!("`{STYLE} {}` gives nothing", clip(name)))
                    .expected("expected attributes or constants between its braces")
            });
        }
        if self.program.styles.contains_key(name) {
            self.report(|| Diagnostic::error(Some(span), format!("a second `{STYLE} {}`", clip(name))));
            return;
        }
        let is_wrong = self.report.count() > errors;
        let length = end.saturating_sub(open.end);
        let style = TextStyle { name: normalized(name).into(), values, length };
        self.program.styles.insert(name, (!is_wrong).then(|| Rc::new(style)));
    }

    /// What stands between the braces of a style, and the closing one.
    fn style_values(&mut self, style: &str) -> Vec<(Written, Span)> {
        let mut values: Vec<(Written, Span)> = Vec::new();
        let mut known: HashSet<(bool, String)> = HashSet::new();
        loop {
            if self.accept(b'}').is_some() {
                return values;
            }
            let start = self.peek();
            let precedence = match self.peek_word() {
                Some(OVERRIDE) if self.group(OVERRIDE).is_none() => {
                    self.next();
                    Precedence::Override
                }
                _ => Precedence::Nearest,
            };
            let Some(given) = self.given(precedence) else {
                self.expected_at(self.peek(), "expected an attribute, a constant, or `}`");
                return values;
            };
            let Some(written) = given else { return values };
            let span = Span::new(start.start, self.previous_end());
            let given = written.given().map(|(is_constant, name)| (is_constant, name.to_owned()));
            if given.is_some_and(|given| !known.insert(given)) {
                let what = self.source(span).to_owned();
                let message = format!("`{STYLE} {}` gives `{}` a second time", clip(style), clip(&what));
                self.report(|| Diagnostic::error(Some(span), message));
            }
            values.push((written, span));
        }
    }

    /// A use of a style whose word has just been taken; `start` is the first word of the node.
    pub(crate) fn style_node(&mut self, start: Token, precedence: Precedence) -> Begun<'a> {
        let Some(name) = self.peek_word() else {
            self.expected_at(self.peek(), "expected the name of a style");
            return self.block(start, Head::Broken);
        };
        let token = self.next();
        match self.program.styles.get(name) {
            Some(Some(style)) => {
                let style = Rc::clone(style);
                let span = Span::new(start.start, token.end);
                let what = format!("this use of `{STYLE} {name}`");
                if !self.charge(1.0, style.length, span, &what) {
                    return Begun::Nothing;
                }
                (1..style.values.len()).for_each(|_| self.count_node(span));
                self.block(start, Head::Styled(style, precedence))
            }
            Some(None) => self.block(start, Head::Broken),
            None => {
                self.report_with(|parser| {
                    let message = format!("no `{STYLE} {}` stands above", clip(name));
                    let error = Diagnostic::error(Some(token.span()), message);
                    match nearest(name, parser.program.styles.keys().copied()) {
                        Some(near) => error.expected(format!("perhaps `{near}`")),
                        None => error,
                    }
                });
                self.block(start, Head::Broken)
            }
        }
    }

    /// The nodes of a style over what stands in its block.
    pub(crate) fn styled(
        &self,
        span: Span,
        (style, precedence): (&TextStyle, Precedence),
        children: Vec<Tree>,
    ) -> Tree {
        let above = self.program.calls.clone();
        let call = Arc::new(LabelCall { name: Arc::clone(&style.name), turn: None, span, above });
        let mut below = children;
        for (place, (written, at)) in style.values.iter().enumerate().rev() {
            let written = match precedence {
                Precedence::Nearest => written.clone(),
                Precedence::Override => written.clone().with_precedence(precedence),
            };
            let is_first = place == 0;
            let of_style =
                || NodeStyle { name: Arc::clone(&style.name), count: style.values.len(), precedence };
            let label = NodeLabel {
                calls: Some(Arc::clone(&call)),
                style: is_first.then(of_style),
                ..NodeLabel::default()
            };
            below = vec![Tree::at(*at, written, below).labelled(Some(Arc::new(label)))];
        }
        below.pop().unwrap_or_else(|| self.broken.clone())
    }
}
