//! The statements of a file. The state of the parser is in `state`, nodes are in `node`, values in `value`.

use std::sync::Arc;

use jbt_ir::limits::{MAX_ATTRIBUTE_WIDTH, MAX_ATTRIBUTES, MAX_SCENE_BYTES};

use super::expression::ExpressionPlace;
use super::lex::{Token, TokenKind};
use super::program::known::Value;
use super::state::{Options, Parser};
use super::texts::Texts;
use super::words::is_builtin;
use jbt_model::attribute::{AttributeGroup, DIRECTION, GroupKind, Mixing};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::model::Model;
use jbt_model::number::{Number, NumberFormula};
use jbt_model::orientation::{Handed, ModelUp, Orientation};
use jbt_model::parameter::{Fixture, not_finite, unknown};
use jbt_model::report::clip;
use jbt_model::tree::Tree;
use jbt_model::word::{is_statement, normalized};

/// The model of a text, or everything that is wrong with it.
pub(super) fn read(text: &[u8], texts: &Texts, options: &Options) -> Result<Model, Vec<Diagnostic>> {
    if text.len() > MAX_SCENE_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_SCENE_BYTES} are read", text.len());
        return Err(vec![Diagnostic::limit(None, message)]);
    }
    let whole = std::str::from_utf8(text).map_err(|error| {
        let at = error.valid_up_to();
        let end = error.error_len().map_or(text.len(), |length| at + length);
        vec![
            Diagnostic::error(Some(Span::new(at, end)), "this is not UTF-8")
                .expected("expected a text file, in the encoding UTF-8"),
        ]
    })?;
    let mut parser = Parser::new(whole, texts, options);
    parser.file();
    parser.finish()
}

/// The value of a text that is one expression, or everything that is wrong with it.
pub(super) fn read_number(text: &str) -> Result<f64, Vec<Diagnostic>> {
    let options = Options::default();
    let texts = Texts::new(text.len());
    let mut parser = Parser::new(text, &texts, &options);
    let value = parser.expression(ExpressionPlace::Alone).number.value();
    let rest = parser.peek();
    if rest.kind != TokenKind::End {
        parser.expected_at(rest, "expected one number");
    }
    if parser.report.is_empty() { Ok(value) } else { Err(parser.report.finish()) }
}

impl<'a> Parser<'a> {
    /// A text from its first word to its end.
    pub(super) fn file(&mut self) {
        self.keep_comment(false);
        self.header();
        let head = self.previous_end();
        loop {
            let token = self.peek();
            self.keep_comment(self.previous_end() == head);
            match token.kind {
                TokenKind::End => return,
                TokenKind::Word => {
                    let word = self.text(token);
                    if self.begins_named() {
                        self.report_again();
                        self.root(token);
                    } else if self.begins_definition(word) {
                        self.report_again();
                        self.next();
                        self.definition_statement(word, token);
                    } else if self.begins_part(word) {
                        self.report_again();
                        self.part_statement(token);
                    } else if is_statement(word) {
                        self.report_again();
                        self.next();
                        self.statement(word, token.span());
                    } else if self.is_muted() && !self.begins_node(word) {
                        self.next();
                    } else {
                        self.report_again();
                        self.root(token);
                    }
                }
                TokenKind::Mark(b'{') => {
                    self.expected_at(token, "expected a node's name before it");
                    self.skip_block();
                }
                TokenKind::Mark(b'}') => {
                    self.expected_at(token, "no block is open here");
                    self.next();
                }
                TokenKind::Mark(_) | TokenKind::Number | TokenKind::Quoted | TokenKind::Unknown => {
                    self.expected_at(token, "expected a statement or a node");
                    self.next();
                }
            }
        }
    }

    fn header(&mut self) {
        let token = self.peek();
        if self.lexer.rest(self.lexer.start()).trim().is_empty() {
            return;
        }
        if !self.accept_word("jbt") {
            let rest = self.lexer.rest(token.start);
            let span =
                Span::new(token.start, token.start + rest.chars().take(1).map(char::len_utf8).sum::<usize>());
            self.report(|| {
                Diagnostic::error(Some(span), "the file does not begin with `jbt 1`")
                    .expected("expected the format and its version first")
            });
            return;
        }
        let version = self.peek();
        if version.kind != TokenKind::Number {
            self.expected_at(version, "expected the version: jbt 1");
        } else if self.text(version) == "1" {
            self.next();
        } else {
            let found = clip(self.text(version));
            self.give_up(
                Diagnostic::error(Some(version.span()), format!("the file has version {found}"))
                    .expected("expected version 1: jbt 1"),
            );
        }
    }

    fn statement(&mut self, word: &str, span: Span) {
        match word {
            "iso" => self.iso_statement(span),
            "origin" => self.origin_statement(span),
            "orientation" => self.orientation_statement(span),
            "param" => self.param_statement(),
            "attribute" => self.attribute_statement(),
            "let" => self.let_statement(),
            _ => {
                self.report(|| {
                    Diagnostic::error(Some(span), "a second `jbt`")
                        .expected("expected it once, at the beginning")
                });
                self.next();
            }
        }
    }

    fn iso_statement(&mut self, span: Span) {
        let value = self.expression(ExpressionPlace::Alone).number;
        if self.is_included() {
            let iso = self.iso.value();
            if value.value().to_bits() != iso.to_bits() && !value.value().is_nan() {
                self.report(|| {
                    Diagnostic::error(Some(span), format!("the iso-value of the scene is {iso}"))
                        .expected("expected the same in a file that it includes, or none")
                });
            }
            return;
        }
        if self.iso_at.is_some() {
            self.report(|| Diagnostic::error(Some(span), "a second `iso`").expected("expected it once"));
        } else if self.nodes > 0 {
            self.report(|| {
                Diagnostic::error(Some(span), "`iso` stands after a node")
                    .expected("expected it before all nodes, since it gives `surface_radius` its meaning")
            });
        }
        self.iso_at = Some(span);
        self.iso = value;
    }

    fn origin_statement(&mut self, span: Span) {
        let from = self.peek().start;
        let numbers: [Number; 3] = self.vector();
        if self.is_included() {
            // That of the scene counts, or none; it changes no field.
            return;
        }
        for number in &numbers {
            self.declares(Fixture::Declaration, number, Span::new(from, self.previous_end()));
        }
        if self.origin.replace(numbers.map(|number| number.value())).is_some() {
            self.report(|| Diagnostic::error(Some(span), "a second `origin`").expected("expected it once"));
        }
    }

    /// `up` and an axis, `handed` and a hand, either or both.
    fn orientation_statement(&mut self, span: Span) {
        let mut orientation = Orientation::default();
        let at = self.peek();
        let is_up = self.accept_word("up");
        if is_up {
            let found = ModelUp::ALL.into_iter().find(|up| self.accept_word(up.name()));
            orientation.up = found.unwrap_or_else(|| {
                self.expected_at(self.peek(), "expected `y` or `z`");
                ModelUp::Z
            });
        }
        if self.accept_word("handed") {
            let found = Handed::ALL.into_iter().find(|hand| self.accept_word(hand.name()));
            orientation.handed = found.unwrap_or_else(|| {
                self.expected_at(self.peek(), "expected `right` or `left`");
                Handed::Right
            });
        } else if !is_up {
            self.expected_at(at, "expected `up` and an axis, or `handed` and a hand");
        }
        if self.orientation.replace(orientation).is_some() {
            let error = Diagnostic::error(Some(span), "a second `orientation`");
            self.report(|| error.expected("expected it once"));
        }
    }

    /// A name that is being defined.
    pub(super) fn name(&mut self, what: &str) -> Option<(&'a str, Span)> {
        let token = self.peek();
        if token.kind != TokenKind::Word {
            self.expected_at(token, &format!("expected the {what}'s name"));
            return None;
        }
        self.next();
        Some((self.text(token), token.span()))
    }

    pub(super) fn equals(&mut self) {
        if self.accept(b'=').is_none() {
            self.expected_at(self.peek(), "expected `=`");
        }
    }

    fn attribute_statement(&mut self) {
        let Some((name, span)) = self.name("attribute") else {
            return;
        };
        let width_at = self.peek();
        let turns = self.peek_word() == Some(DIRECTION)
            && self.parameter(DIRECTION).is_none()
            && self.program.value(DIRECTION).is_none();
        if turns {
            self.next();
            self.group_statement((name, span, width_at), Some(3), GroupKind::Direction);
            return;
        }
        let width = self.expression(ExpressionPlace::Alone);
        self.declares(Fixture::Declaration, &width.number, width.span);
        let (width, width_span) = (width.number.value(), width.span);
        let right = width.fract() == 0.0 && (1.0..=MAX_ATTRIBUTE_WIDTH as f64).contains(&width);
        if !right && !width.is_nan() {
            self.report(|| {
                Diagnostic::error(
                    Some(width_span),
                    format!("the width of `{}` is not 1 to {MAX_ATTRIBUTE_WIDTH}", clip(name)),
                )
                .expected("expected the number of its reals")
            });
        }
        self.group_statement((name, span, width_at), right.then_some(width as usize), GroupKind::Numbers);
    }

    /// The declaration of a group behind its width, if that is known.
    fn group_statement(
        &mut self,
        (name, span, width_at): (&str, Span, Token),
        width: Option<usize>,
        kind: GroupKind,
    ) {
        let mut default = None;
        if !self.is_muted() && self.accept_word("default") {
            let from = self.peek().start;
            let values = self.group_values(width);
            for number in &values {
                self.declares(Fixture::Declaration, number, Span::new(from, self.previous_end()));
            }
            default = Some(values.iter().map(Number::value).collect());
        }
        let mixing = Mixing::ALL.into_iter().find(|mixing| self.accept_word(mixing.name()));
        if self.is_muted() || width_at.kind == TokenKind::End {
            return;
        }
        let width = width.unwrap_or(1);
        let group = AttributeGroup {
            name: Arc::from(name),
            default: default.unwrap_or_else(|| vec![if name == "color" { 1.0 } else { 0.0 }; width]),
            mixing: mixing.unwrap_or(Mixing::Blend),
            kind,
            ..AttributeGroup::color()
        };
        self.declare(group, span);
    }

    /// Marks the parameters of a number that stays as it is read.
    pub(super) fn declares(&mut self, what: Fixture, number: &Number, span: Span) {
        for (name, _) in number.formula().into_iter().flat_map(NumberFormula::parameters) {
            let declared = self.parameters.iter_mut().find(|parameter| parameter.name() == &**name);
            if let Some(parameter) = declared {
                parameter.declares(what, span);
            }
        }
    }

    fn declare(&mut self, group: AttributeGroup, span: Span) {
        let name = Arc::clone(&group.name);
        if &*name == "color" {
            if group.width() != 3 {
                self.report(|| {
                    Diagnostic::error(Some(span), "`color` has 3 reals: red, green and blue")
                        .expected("expected width 3")
                });
            }
            if !self.is_included() {
                self.attributes[0] = group;
            } else if self.attributes[0] != group {
                self.report(|| {
                    Diagnostic::error(Some(span), "the scene declares `color` in another way")
                        .expected("expected the same in a file that it includes, or nothing")
                });
            }
        } else if self.is_included() && self.attributes.contains(&group) {
            // A file that is included says again what it is about.
        } else if self.group(&name).is_some() {
            self.report(|| Diagnostic::error(Some(span), format!("a second attribute `{}`", clip(&name))));
        } else if self.attributes.len() == MAX_ATTRIBUTES {
            let message = format!("more than {MAX_ATTRIBUTES} attributes, `color` included");
            self.report(|| Diagnostic::limit(Some(span), message));
        } else {
            self.attributes.push(group);
        }
    }

    /// The width of a declared group.
    pub(super) fn group(&self, name: &str) -> Option<usize> {
        self.attributes.iter().find(|group| &*group.name == name).map(AttributeGroup::width)
    }

    fn let_statement(&mut self) {
        let Some((name, span)) = self.name("subtree") else {
            return;
        };
        self.equals();
        if self.peek_word().is_some_and(|word| self.begins_node(word)) {
            self.report_again();
        }
        if self.is_muted() {
            self.lets.entry(name).or_insert_with(|| self.broken.clone());
            return;
        }
        if self.begins_value() {
            return self.let_value(name, span);
        }
        let is_named = self.begins_named();
        let tree = self.tree();
        let tree = if is_named { tree } else { self.with_name(tree, name, span) };
        if self.lets.insert(name, tree).is_some() || self.program.value(name).is_some() {
            self.report(|| Diagnostic::error(Some(span), format!("a second `let {}`", clip(name))));
        }
    }

    /// A value with a name.
    fn let_value(&mut self, name: &'a str, span: Span) {
        let value = self.value();
        if self.lets.contains_key(name) {
            self.report(|| Diagnostic::error(Some(span), format!("a second `let {}`", clip(name))));
        } else if is_builtin(name) || self.references.contains_key(name) {
            let name = clip(name);
            self.report(|| Diagnostic::error(Some(span), format!("`{name}` means something else already")));
        } else if self.program.define(name, value.unwrap_or_else(Value::unknown)) {
            self.report(|| Diagnostic::error(Some(span), format!("a second `let {}`", clip(name))));
        }
    }

    fn root(&mut self, token: Token) {
        for tree in self.nodes() {
            self.add_root(token, tree);
        }
    }

    fn add_root(&mut self, token: Token, tree: Tree) {
        // What could not be read is no root that another one would be the second beside.
        let broken = self.broken.identity();
        if self.root.as_ref().is_none_or(|root| root.identity() == broken) {
            self.root = Some(tree);
        } else if tree.identity() != broken {
            self.report(|| {
                Diagnostic::error(Some(token.span()), "a second root")
                    .expected("expected one node; `sum { .. }` or `union { .. }` around both makes them one")
            });
        }
    }

    // The end.

    fn finish(mut self) -> Result<Model, Vec<Diagnostic>> {
        self.check_options();
        self.root_of_parts();
        if self.root.is_none() {
            let end = Span::new(self.whole.len(), self.whole.len());
            self.report(|| {
                if self.whole.trim().is_empty() {
                    let empty = Diagnostic::error(Some(end), "the file is empty");
                    return empty.expected("expected `jbt 1` and a node, as point { surface_radius 1 }");
                }
                Diagnostic::error(Some(end), "the file has no node").expected("expected the tree")
            });
        }
        let mut report = std::mem::take(&mut self.report);
        match self.root {
            Some(root) if report.is_empty() => {
                let model = Model {
                    iso: self.iso,
                    attributes: self.attributes,
                    root,
                    parameters: self.parameters,
                    origin: self.origin,
                    orientation: self.orientation.unwrap_or_default(),
                    source: None,
                    comments: self.comments,
                };
                Ok(if self.program.has_expanded { model.share() } else { model })
            }
            _ => {
                if self.program.has_expanded {
                    report.sort();
                }
                Err(report.finish())
            }
        }
    }

    /// Values from outside are for parameters that exist, and are numbers.
    fn check_options(&mut self) {
        for (name, value) in &self.options.parameters {
            if !self.references.contains_key(&*normalized(name)) {
                self.report_with(|parser| unknown(name, &parser.parameters));
            } else if !value.is_finite() {
                self.report(|| not_finite(name));
            }
        }
    }
}
