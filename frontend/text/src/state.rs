//! The state of reading one text: tokens, messages, and what has been declared.
//!
//! Tokens are taken one at a time and nothing recurses, so that memory is bounded by the model and not by the
//! text. After an error that has lost the place, tokens are skipped in silence until a word, a brace or a
//! statement says where we are again.

use std::collections::HashMap;
use std::sync::Arc;

use super::files::Files;
use super::hints::foreign_mark;
use super::import::particles::ParticleOptions;
use super::lex::{Lexer, Token, TokenKind};
use super::program::known::{TextProgram, Value};
use super::scope::FormulaScope;
use super::texts::Texts;
use jbt_model::attribute::AttributeGroup;
use jbt_model::combine::{Combinator, Sum};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::label::NodeLabel;
use jbt_model::model::{Comments, Model};
use jbt_model::number::Number;
use jbt_model::orientation::Orientation;
use jbt_model::parameter::Parameter;
use jbt_model::report::{Report, clip};
use jbt_model::tree::Tree;
use jbt_model::written::Written;

/// What is set from outside a text.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Options {
    /// Values of parameters, by name; the last one of a name counts.
    pub parameters: Vec<(String, f64)>,
    /// How files are opened that the text names. By default none are.
    pub files: Files,
    /// The object to read, of a file that holds several; those that nothing refers to without it.
    pub object: Option<String>,
    /// What is said of particles, of a file that holds some.
    pub particles: ParticleOptions,
}

/// The state of reading one text.
pub(super) struct Parser<'a> {
    pub(super) lexer: Lexer<'a>,
    /// The scene's own text.
    pub(super) whole: &'a str,
    pub(super) report: Report,
    /// Messages are withheld, until we know again where we are in the text.
    pub(super) muted: bool,
    /// Reading has stopped for good.
    pub(super) stopped: bool,
    pub(super) options: &'a Options,
    pub(super) parameters: Vec<Parameter>,
    /// Each parameter as formulas have it; its value is NaN where its expression has an error.
    pub(super) references: HashMap<&'a str, Number>,
    pub(super) lets: HashMap<&'a str, Tree>,
    /// Inside of the formula of a field: what it may be about besides numbers.
    pub(super) scope: Option<FormulaScope<'a>>,
    pub(super) attributes: Vec<AttributeGroup>,
    pub(super) iso: Number,
    pub(super) iso_at: Option<Span>,
    pub(super) origin: Option<[f64; 3]>,
    /// Of the scene's own text.
    pub(super) comments: Comments,
    pub(super) orientation: Option<Orientation>,
    /// Nodes so far, shared ones once.
    pub(super) nodes: usize,
    pub(super) root: Option<Tree>,
    /// The parts of the scene.
    pub(super) parts: Vec<Tree>,
    /// A brace that the end of the file leaves open has been reported.
    pub(super) ended: bool,
    /// Stands for every node that could not be read.
    pub(super) broken: Tree,
    /// Names of values, definitions, files, and what may still be expanded.
    pub(super) program: TextProgram<'a>,
}

impl<'a> Parser<'a> {
    pub(super) fn new(whole: &'a str, texts: &'a Texts, options: &'a Options) -> Self {
        Self {
            lexer: Lexer::new(whole),
            whole,
            report: Report::default(),
            muted: false,
            stopped: false,
            options,
            parameters: Vec::new(),
            references: HashMap::new(),
            lets: HashMap::new(),
            scope: None,
            attributes: vec![AttributeGroup::color()],
            iso: Model::DEFAULT_ISO.into(),
            iso_at: None,
            origin: None,
            comments: Comments::new(),
            orientation: None,
            nodes: 0,
            root: None,
            parts: Vec::new(),
            ended: false,
            broken: Tree::new(Combinator::from(Sum {}), Vec::new()),
            program: TextProgram::new(whole, texts, options.files.reader()),
        }
    }

    // The tokens.

    pub(super) fn peek(&self) -> Token {
        self.lexer.peek()
    }

    pub(super) fn next(&mut self) -> Token {
        self.lexer.next()
    }

    pub(super) fn peek_behind(&self) -> Token {
        self.lexer.peek_behind()
    }

    /// Goes back to a byte that has been skipped as a part of a comment.
    pub(super) fn resume(&mut self, at: usize) {
        self.lexer.resume(at);
    }

    pub(super) fn leans_right(&self) -> bool {
        self.lexer.leans_right()
    }

    /// Where the last taken token ended.
    pub(super) fn previous_end(&self) -> usize {
        self.lexer.previous_end()
    }

    pub(super) fn text(&self, token: Token) -> &'a str {
        self.lexer.text(token.start, token.end).unwrap_or_else(|| self.source(token.span()))
    }

    /// The bytes of a span, in whatever text it is.
    pub(super) fn source(&self, span: Span) -> &'a str {
        let (start, end) = (span.start as usize, span.end as usize);
        match self.program.texts.text_at(start) {
            Some(file) => &file.text[start - file.base..end - file.base],
            None => &self.whole[start..end],
        }
    }

    /// The next token, if it is a word.
    pub(super) fn peek_word(&self) -> Option<&'a str> {
        let token = self.peek();
        (token.kind == TokenKind::Word).then(|| self.text(token))
    }

    /// Takes the next token if it is this mark.
    pub(super) fn accept(&mut self, mark: u8) -> Option<Token> {
        self.peek().is(mark).then(|| self.next())
    }

    /// Takes the next token if it is this word.
    pub(super) fn accept_word(&mut self, word: &str) -> bool {
        let found = self.peek_word() == Some(word);
        if found {
            self.next();
        }
        found
    }

    // Messages.

    /// Reports, wherever we are.
    pub(super) fn report(&mut self, make: impl FnOnce() -> Diagnostic) {
        if !self.stopped {
            let notes = || self.program.calls.as_ref().map(|calls| calls.notes()).unwrap_or_default();
            self.report.add(|| Diagnostic { notes: notes(), ..make() });
        }
    }

    /// Reports what `make` finds out from the parser's state.
    pub(super) fn report_with(&mut self, make: impl FnOnce(&Self) -> Diagnostic) {
        let made = (!self.stopped && !self.report.is_full()).then(|| make(self));
        self.report(|| made.unwrap_or_else(|| Diagnostic::error(None, "")));
    }

    /// Reports, unless it is mute, and is mute from then on.
    pub(super) fn report_and_mute(&mut self, make: impl FnOnce() -> Diagnostic) {
        if !self.muted {
            self.report(make);
        }
        self.muted = true;
    }

    /// Mute after an error that has been reported.
    pub(super) fn mute(&mut self) {
        self.muted = true;
    }

    /// Reports errors again: we know where we are in the text.
    pub(super) fn report_again(&mut self) {
        self.muted = false;
    }

    pub(super) fn is_muted(&self) -> bool {
        self.muted
    }

    /// Loses the place at a token that is not what was expected.
    pub(super) fn expected_at(&mut self, token: Token, expected: &str) {
        let found = if self.muted { String::new() } else { self.describe(token) };
        let hint = if token.kind == TokenKind::End { None } else { foreign_mark(self.text(token)) };
        self.report_and_mute(|| {
            let error = Diagnostic::error(Some(token.span()), format!("unexpected {found}"));
            match hint {
                Some(hint) => error.expected(format!("{expected}; {hint}")),
                None => error.expected(expected),
            }
        });
    }

    /// A token in words.
    pub(super) fn describe(&self, token: Token) -> String {
        match token.kind {
            TokenKind::End => "end of the file".to_owned(),
            TokenKind::Word
            | TokenKind::Number
            | TokenKind::Mark(_)
            | TokenKind::Quoted
            | TokenKind::Unknown => {
                format!("`{}`", clip(self.text(token)))
            }
        }
    }

    /// Reports a limit and stops reading.
    pub(super) fn give_up(&mut self, limit: Diagnostic) {
        if !self.stopped {
            let notes = self.program.calls.as_ref().map(|calls| calls.notes()).unwrap_or_default();
            self.report.add_last(Diagnostic { notes, ..limit });
        }
        self.stopped = true;
        self.muted = true;
        self.lexer.finish();
    }

    // Parameters.

    /// The number of a name: an argument, a variable, a number with a name, or a parameter.
    pub(super) fn parameter(&self, name: &str) -> Option<&Number> {
        match self.program.value(name) {
            Some(Value::Number(number)) => Some(number),
            Some(Value::Numbers(_) | Value::List(_) | Value::Tree(_)) => None,
            None => self.references.get(name),
        }
    }

    /// The names that stand for numbers or for lists of them.
    pub(super) fn parameter_names(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(Parameter::name).chain(self.program.value_names())
    }

    /// A node that is read here.
    pub(super) fn make(&self, span: Span, written: impl Into<Written>, children: Vec<Tree>) -> Tree {
        let tree = Tree::at(span, written, children);
        match &self.program.calls {
            None => tree,
            Some(calls) => {
                let label = NodeLabel { calls: Some(Arc::clone(calls)), ..NodeLabel::default() };
                tree.labelled(Some(Arc::new(label)))
            }
        }
    }
}
