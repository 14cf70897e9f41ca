//! Nodes of a text: a stack of open blocks, and one of finished subtrees.

use jbt_ir::limits::MAX_NODES;

use super::block::{Begun, BlockFrame, Head};
use super::expression::ExpressionPlace;
use super::hints::foreign_word;
use super::lex::{Token, TokenKind};
use super::program::known::Value;
use super::state::Parser;
use super::words::{EMPTY, GROUP_NODE, PARTICLES, WEIGHTED, fixed_words};
use jbt_model::attribute::Precedence;
use jbt_model::combine::CombinatorKind;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::expression::Formula;
use jbt_model::map::MapKind;
use jbt_model::report::{clip, nearest};
use jbt_model::skeleton::SkeletonKind;
use jbt_model::tree::Tree;
use jbt_model::warp::WarpKind;
use jbt_model::word::{CONSTANT, OVERRIDE, STYLE, is_statement};
use jbt_model::written::Written;

impl<'a> Parser<'a> {
    /// Whether a word begins a node of this file.
    pub(super) fn begins_node(&self, word: &str) -> bool {
        fixed_words().any(|fixed| fixed == word)
            || self.group(word).is_some()
            || self.program.defines(word)
            || ["for", "if", "include", EMPTY, CONSTANT, OVERRIDE, STYLE].contains(&word)
    }

    /// All words that begin a node of this file.
    fn node_words(&self) -> impl Iterator<Item = &str> {
        let fixed = fixed_words().map(|word| -> &str { word });
        let own = self.attributes.iter().map(|group| &*group.name);
        fixed.chain([EMPTY, CONSTANT, OVERRIDE, STYLE]).chain(own).chain(self.program.definition_names())
    }

    /// Past the next token, or past the whole block that it opens.
    pub(super) fn skip_token(&mut self) {
        if self.peek().is(b'{') {
            self.skip_block();
        } else {
            self.next();
        }
    }

    /// Past the block that is next, whatever is in it.
    pub(super) fn skip_block(&mut self) {
        let open = self.peek();
        let mut depth = 0usize;
        loop {
            let token = self.next();
            match token.kind {
                TokenKind::Mark(b'{') => depth += 1,
                TokenKind::Mark(b'}') => depth -= 1,
                TokenKind::End => {
                    self.report_again();
                    self.unclosed(open.start as u32, token);
                    return;
                }
                TokenKind::Mark(_)
                | TokenKind::Word
                | TokenKind::Number
                | TokenKind::Quoted
                | TokenKind::Unknown => {}
            }
            if depth == 0 {
                return;
            }
        }
    }

    /// Past the parentheses that are next, whatever is in them, and a semicolon behind them; not into a
    /// block.
    pub(super) fn skip_arguments(&mut self) {
        let mut depth = 0usize;
        loop {
            match self.peek().kind {
                TokenKind::Mark(b'(') => depth += 1,
                TokenKind::Mark(b')') if depth > 0 => depth -= 1,
                TokenKind::Mark(b'{' | b'}') | TokenKind::End => return,
                TokenKind::Mark(_)
                | TokenKind::Word
                | TokenKind::Number
                | TokenKind::Quoted
                | TokenKind::Unknown => {
                    if depth == 0 {
                        break;
                    }
                }
            }
            self.next();
        }
        if self.text(self.peek()) == ";" {
            self.next();
        }
    }

    /// Reports a brace that is not closed where `token` stands.
    pub(super) fn unclosed(&mut self, open: u32, token: Token) {
        // Only the innermost of the braces that the end of the file leaves open.
        if token.kind == TokenKind::End && std::mem::replace(&mut self.ended, true) {
            return;
        }
        let found = self.describe(token);
        self.report(|| {
            Diagnostic::error(Some(Span { start: open, end: open + 1 }), "this `{` is not closed")
                .expected(format!("expected `}}` before {found}"))
        });
    }

    /// Counts a node.
    pub(super) fn count_node(&mut self, span: Span) {
        self.nodes += 1;
        if self.nodes > MAX_NODES {
            self.give_up(Diagnostic::limit(Some(span), format!("more than {MAX_NODES} nodes")));
        }
    }

    /// What begins with the word that is next.
    pub(super) fn begin(&mut self) -> Begun<'a> {
        let start = self.next();
        let word = self.text(start);
        if self.is_muted() {
            if !self.begins_node(word) {
                return Begun::Nothing;
            }
            self.report_again();
        }
        if self.peek().is(b':') {
            self.next();
            return self.named_node(start);
        }
        if let Some(kind) = SkeletonKind::ALL.iter().copied().find(|kind| kind.name() == word) {
            self.count_node(start.span());
            return Begun::Leaf(self.primitive(kind, start));
        }
        if let Some(kind) = CombinatorKind::named(word).next() {
            return self.combinator(start, kind);
        }
        if let Some(kind) = WarpKind::ALL.iter().copied().find(|kind| kind.name() == word) {
            let fields = self.slots(kind.fields(), "a warp").complete(self, start, kind.name());
            let written = fields.map(|fields| Box::new(Written::Warp { warp: kind, fields }));
            let weighted = self.accept_word(WEIGHTED);
            let head = if weighted { Head::Weighted } else { Head::Unary };
            return self.block(start, written.map_or(Head::Broken, head));
        }
        match word {
            "use" => Begun::Leaf(self.use_node()),
            PARTICLES => Begun::Leaf(self.particles(start)),
            "select" => self.select(start),
            "warp" => self.formula_warp(start),
            "expression" => Begun::Leaf(self.expression_node(start)),
            "within" => self.within(start),
            "falloff" => self.falloff_node(start),
            "blend" => {
                if !self.accept_word("ricci") {
                    self.expected_at(
                        self.peek(),
                        "expected `ricci` and its exponent; `sum` is the plain blend",
                    );
                    return self.block(start, Head::Broken);
                }
                self.combinator(start, CombinatorKind::Ricci)
            }
            _ if MapKind::named(word).next().is_some() => self.map(start, word),
            GROUP_NODE => self.given_node(start, Self::named_attribute),
            _ if self.group(word).is_some() => {
                self.given_node(start, |parser, nearest| parser.attribute((start, word), nearest))
            }
            _ if self.program.defines(word) => self.call(start, word),
            _ if self.is_loop(word) => self.for_node(start),
            _ if self.is_condition(word) => self.if_node(start),
            _ if self.is_include(word) => Begun::Leaf(self.include_node(start)),
            CONSTANT => self.given_node(start, Self::constant),
            STYLE => self.style_node(start, Precedence::Nearest),
            OVERRIDE => self.override_node(start),
            EMPTY => {
                self.count_node(start.span());
                Begun::Leaf(self.make(start.span(), Written::Expression(Formula::zero()), Vec::new()))
            }
            _ => self.unknown_node(start, word),
        }
    }

    /// The block of a node whose head has been read.
    pub(super) fn block(&mut self, start: Token, head: Head) -> Begun<'a> {
        let span = Span::new(start.start, self.previous_end());
        self.count_node(span);
        match self.open() {
            Some(open) => {
                let open = open.start as u32;
                Begun::Block(BlockFrame { head, first: 0, span, open, incomplete: false, around: None })
            }
            None => Begun::Leaf(self.broken.clone()),
        }
    }

    /// The opening brace of a node, after an error also a later one that must be meant.
    pub(super) fn open(&mut self) -> Option<Token> {
        if self.peek().is(b'(') {
            self.expected_at(self.peek(), "expected `{`: no parentheses stand before a block");
            self.skip_arguments();
        }
        if !self.peek().is(b'{') {
            self.expected_at(self.peek(), "expected `{`");
            while let token = self.peek()
                && !token.is(b'{')
            {
                let word = self.peek_word();
                let found = word.is_some_and(|word| is_statement(word) || self.begins_node(word));
                if found || token.is(b'}') || token.kind == TokenKind::End {
                    return None;
                }
                self.next();
            }
        }
        self.report_again();
        self.accept(b'{')
    }

    pub(super) fn unary(&mut self, start: Token, written: Option<Written>) -> Begun<'a> {
        self.block(start, written.map_or(Head::Broken, |written| Head::Unary(Box::new(written))))
    }

    /// The node of a block that has been closed.
    pub(super) fn close(&mut self, frame: BlockFrame, children: Vec<Tree>) -> Tree {
        let written = match frame.head {
            Head::Broken => return self.broken.clone(),
            Head::Combine(combinator) => {
                return self.make(frame.span, Written::Combine { combinator, fields: Vec::new() }, children);
            }
            Head::Operator(written) => *written,
            Head::Weighted(written) => {
                let count = children.len();
                if count != 2 && !frame.incomplete {
                    self.report(|| {
                        let what = format!("a weighted warp has {count} nodes in its block");
                        Diagnostic::error(Some(frame.span), what)
                            .expected("expected two: what it deforms, and what gives the weight")
                    });
                }
                *written
            }
            Head::Unary(written) => {
                self.check_single(frame.span, frame.incomplete, children.len());
                *written
            }
            Head::Styled(style, precedence) => {
                self.check_single(frame.span, frame.incomplete, children.len());
                return self.styled(frame.span, (&style, precedence), children);
            }
        };
        let made = self.make(frame.span, written, children);
        let Some(around) = frame.around else { return made };
        self.make(frame.span, *around, vec![made])
    }

    /// The block of a node with one child has one.
    fn check_single(&mut self, span: Span, is_incomplete: bool, count: usize) {
        if count == 1 || is_incomplete {
            return;
        }
        let word = self.source(span).split_ascii_whitespace().next().unwrap_or_default();
        self.report(|| {
            let error = |what: &str| Diagnostic::error(Some(span), format!("`{}` has {what}", clip(word)));
            match count {
                0 => error("no node in its block").expected("expected one"),
                _ => error(&format!("{count} nodes in its block"))
                    .expected("expected one; `sum { .. }` around them makes them one"),
            }
        });
    }

    fn select(&mut self, start: Token) -> Begun<'a> {
        let which = self.expression(ExpressionPlace::Alone).number;
        self.block(start, Head::Operator(Box::new(Written::Select(which))))
    }

    /// The node of the name that is next.
    pub(super) fn use_node(&mut self) -> Tree {
        let token = self.peek();
        let Some(name) = self.peek_word() else {
            self.expected_at(token, "expected the name of a `let`");
            return self.broken.clone();
        };
        if let Some(tree) = self.tree_named(name) {
            self.next();
            return tree;
        }
        if self.begins_node(name) || is_statement(name) {
            self.report(|| {
                Diagnostic::error(Some(token.span()), format!("`use` has no name before `{name}`"))
                    .expected("expected the name of a `let`")
            });
            return self.broken.clone();
        }
        self.next();
        self.report_with(|parser| {
            let error =
                Diagnostic::error(Some(token.span()), format!("no `let {}` stands above", clip(name)));
            match nearest(name, parser.lets.keys().copied()) {
                Some(near) => error.expected(format!("perhaps `{near}`")),
                None => error,
            }
        });
        self.broken.clone()
    }

    /// The node that a name stands for: an argument, a value of a body, or a `let`.
    pub(super) fn tree_named(&self, name: &str) -> Option<Tree> {
        match self.program.value(name) {
            Some(Value::Tree(tree)) => Some(tree.clone()),
            Some(Value::Number(_) | Value::Numbers(_) | Value::List(_)) => None,
            None => self.lets.get(name).cloned(),
        }
    }

    /// An attribute or a constant that does not override, whose word, `start`, has just been taken.
    fn given_node(
        &mut self,
        start: Token,
        given: impl FnOnce(&mut Self, Precedence) -> Option<Written>,
    ) -> Begun<'a> {
        let written = given(self, Precedence::Nearest);
        self.unary(start, written)
    }

    /// An attribute, a constant or a style that overrides, whose word, `start`, has just been taken.
    fn override_node(&mut self, start: Token) -> Begun<'a> {
        let precedence = Precedence::Override;
        if self.peek_word().is_some_and(|word| self.is_style(word)) {
            self.next();
            return self.style_node(start, precedence);
        }
        let Some(given) = self.given(precedence) else {
            self.expected_at(self.peek(), "expected an attribute's name, `constant` or `style`");
            return self.block(start, Head::Broken);
        };
        self.unary(start, given)
    }

    /// An attribute or a constant without its block, if one is next; nothing of it after an error.
    pub(super) fn given(&mut self, precedence: Precedence) -> Option<Option<Written>> {
        match self.peek_word() {
            Some(word) if self.group(word).is_some() => {
                let at = self.next();
                Some(self.attribute((at, word), precedence))
            }
            Some(GROUP_NODE) => {
                self.next();
                Some(self.named_attribute(precedence))
            }
            Some(CONSTANT) => {
                self.next();
                Some(self.constant(precedence))
            }
            _ => None,
        }
    }

    /// Whether a word begins an attribute or a constant of a style.
    pub(super) fn begins_given(&self, word: &str) -> bool {
        self.group(word).is_some() || [GROUP_NODE, CONSTANT, OVERRIDE].contains(&word)
    }

    /// An attribute whose name is next.
    fn named_attribute(&mut self, precedence: Precedence) -> Option<Written> {
        let Some(name) = self.peek_word() else {
            self.expected_at(self.peek(), "expected an attribute's name");
            return None;
        };
        let at = self.next();
        self.attribute((at, name), precedence)
    }

    /// An attribute whose name has just been taken; nothing after an error.
    fn attribute(&mut self, (at, name): (Token, &str), precedence: Precedence) -> Option<Written> {
        let group = self.attributes.iter().find(|group| &*group.name == name);
        let Some((name, width)) = group.map(|group| (group.name.clone(), group.width())) else {
            self.report_with(|parser| {
                Diagnostic::error(Some(at.span()), format!("no attribute is named `{}`", clip(name)))
                    .expected(parser.known_groups())
            });
            self.number_or_elements();
            return None;
        };
        let value = self.attribute_value(at, &name, width)?;
        Some(Written::Attribute { name, value, precedence })
    }

    fn known_groups(&self) -> String {
        let names: Vec<&str> = self.attributes.iter().map(|group| &*group.name).collect();
        format!("declared are {}", names.join(", "))
    }

    /// A word that begins nothing. A block with values before it is read as that of a misspelt attribute,
    /// others are skipped.
    fn unknown_node(&mut self, start: Token, word: &'a str) -> Begun<'a> {
        let foreign = foreign_word(word);
        let valued = foreign.is_none() && (self.peek().is(b'(') || self.peek().kind == TokenKind::Number);
        let assigned = self.peek().is(b'=');
        self.report_with(|parser| {
            let known = parser.node_words();
            let error = Diagnostic::error(Some(start.span()), format!("no node is called `{}`", clip(word)));
            if parser.lets.contains_key(word) {
                return error.expected(format!("perhaps `use {word}`"));
            }
            if let Some(hint) = foreign {
                return error.expected(hint);
            }
            match nearest(word, known) {
                Some(near) => error.expected(format!("perhaps `{near}`")),
                None if assigned => {
                    let name = clip(word);
                    error.expected(format!("a number is `param {name} = ..`, a node `let {name} = ..`"))
                }
                None if word == "uv" => error.expected("declare it first: attribute uv 2"),
                None if valued => error.expected(parser.known_groups()),
                None => error,
            }
        });
        if valued {
            self.number_or_elements();
            return self.block(start, Head::Broken);
        }
        self.mute();
        self.skip_arguments();
        if self.peek().is(b'{') {
            self.skip_block();
            self.report_again();
        }
        Begun::Leaf(self.broken.clone())
    }
}
