//! The formula of a field: an expression over `x y z`, `field(name)`, definitions of its own and numbers. Or
//! several, without fields: three of a point, or one for each channel of an attribute.
//!
//! It is read by the parser of numbers, which hands what is no number through as steps.

use jbt_ir::limits::MAX_EXPRESSION_STEPS;

use super::block::{Begun, Head};
use super::expression::ExpressionPlace;
use super::lex::{Token, TokenKind};
use super::scope::FormulaScope;
use super::state::Parser;
use super::words::{WEIGHTED, is_builtin};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::expression::{Assembled, Assembler, Draft, Formula};
use jbt_model::falloff::{Falloff, FalloffKind};
pub use jbt_model::function::Function;
use jbt_model::number::{Number, Variable};
use jbt_model::report::{clip, nearest};
use jbt_model::tree::Tree;
use jbt_model::word::{COORDINATES, FIELD, is_statement};
use jbt_model::written::{Written, WrittenFalloff};

impl<'a> Parser<'a> {
    /// What a word that has just been taken stands for in a formula, if it is no number there; an error that
    /// has been told.
    pub(super) fn variable(&mut self, word: &str, token: Token) -> Option<Result<Variable, ()>> {
        let scope = self.scope.as_ref()?;
        if let Some(&place) = scope.definitions.get(word) {
            return Some(Ok(Variable::Definition(place)));
        }
        if let Some(axis) = COORDINATES.iter().position(|name| *name == word) {
            return Some(Ok(Variable::Coordinate(axis as u8)));
        }
        let fieldless = scope.fieldless;
        (word == FIELD).then(|| if fieldless { self.no_field(token) } else { self.field_of(token) })
    }

    /// The function of a falloff, in a formula.
    pub(super) fn falloff_function(&mut self, word: &str, token: Token) -> Option<Function> {
        let next = self.peek();
        if self.scope.is_none() || !(next.is(b'(') || next.is(b'{')) {
            return None;
        }
        let written = self.falloff_of(FalloffKind::named(word)?, token)?;
        Some(Function::falloff(self.fixed_falloff(&written, token.span())))
    }

    /// A falloff of plain numbers.
    fn fixed_falloff(&mut self, written: &WrittenFalloff, span: Span) -> Falloff {
        if written.depends_on_parameters() {
            self.report(|| {
                Diagnostic::error(Some(span), "the numbers of this falloff depend on a parameter")
                    .expected("expected plain numbers: in a formula they are code")
            });
        }
        written.falloff()
    }

    fn no_field(&mut self, token: Token) -> Result<Variable, ()> {
        self.report_and_mute(|| {
            Diagnostic::error(Some(token.span()), "the formula of an attribute asks for no field")
                .expected("expected coordinates and numbers")
        });
        Err(())
    }

    /// `( NAME )` behind the word `field`.
    fn field_of(&mut self, token: Token) -> Result<Variable, ()> {
        if self.scope.as_ref().is_some_and(|scope| scope.pointwise) {
            self.report_and_mute(|| {
                Diagnostic::error(Some(token.span()), "a warp asks for no fields").expected(
                    "expected formulas of x, y and z; `weighted` gives a warp the weight of a field",
                )
            });
            return Err(());
        }
        if self.accept(b'(').is_none() {
            self.report_and_mute(|| {
                Diagnostic::error(Some(token.span()), "`field` names no subtree")
                    .expected("expected the name of a `let`: field(name)")
            });
            return Err(());
        }
        let at = self.peek();
        let Some(name) = self.peek_word().filter(|word| !is_statement(word)) else {
            self.expected_at(at, "expected the name of a `let`");
            return Err(());
        };
        self.next();
        let tree = self.tree_named(name).unwrap_or_else(|| {
            self.report_with(|parser| {
                let error =
                    Diagnostic::error(Some(at.span()), format!("no `let {}` stands above", clip(name)));
                match nearest(name, parser.lets.keys().copied()) {
                    Some(near) => error.expected(format!("perhaps `{near}`")),
                    None => error,
                }
            });
            self.broken.clone()
        });
        if self.accept(b')').is_none() {
            self.expected_at(self.peek(), "expected `)`");
            return Err(());
        }
        self.scope.as_mut().map(|scope| scope.child(tree)).ok_or(())
    }

    /// A node whose word, `expression`, has just been taken.
    pub(super) fn expression_node(&mut self, start: Token) -> Tree {
        let bounds = if self.accept_word("within") { Some(self.corners()) } else { None };
        self.count_node(Span::new(start.start, self.previous_end()));
        let Some(open) = self.open() else {
            return self.broken.clone();
        };
        let Some((assembled, children)) = self.formula((start, open), FormulaScope::default(), 1) else {
            return self.broken.clone();
        };
        let span = Span::new(start.start, self.previous_end());
        let written = Written::Expression(Formula::new(assembled, bounds));
        self.make(span, written, children)
    }

    /// The formula of an attribute, whose word, `start`, has just been taken: one value for each channel.
    pub(super) fn attribute_formula(&mut self, start: Token, width: usize) -> Option<Formula> {
        let open = self.open()?;
        let scope = FormulaScope { fieldless: true, ..FormulaScope::default() };
        let (assembled, _) = self.formula((start, open), scope, width)?;
        Some(Formula::new(assembled, None))
    }

    /// A formula with so many values and the subtrees that it asks for, from behind its `{`, which is `open`,
    /// to behind its `}`.
    fn formula(
        &mut self,
        (start, open): (Token, Token),
        scope: FormulaScope<'a>,
        width: usize,
    ) -> Option<(Assembled, Vec<Tree>)> {
        self.scope = Some(scope);
        let mut assembler = Assembler::default();
        let values = self.definitions(&mut assembler, width);
        let scope = self.scope.take().unwrap_or_default();
        if !self.peek().is(b'}') {
            self.expected_at(self.peek(), "expected an operator, or `}`");
        }
        if !self.end_of_formula(open) {
            return None;
        }
        let span = Span::new(start.start, self.previous_end());
        if assembler.steps() > MAX_EXPRESSION_STEPS {
            let message = format!(
                "the expression has {} operations; it may have {MAX_EXPRESSION_STEPS}",
                assembler.steps()
            );
            self.report(|| Diagnostic::limit(Some(span), message));
            return None;
        }
        let assembled = assembler.finish(&values);
        let children = assembled.children.iter().map(|&child| scope.children[child as usize].clone());
        let children = children.collect();
        Some((assembled, children))
    }

    /// The definitions of a formula and its value, or its values in parentheses, up to its end or to an error
    /// that has lost the place.
    fn definitions(&mut self, assembler: &mut Assembler, width: usize) -> Vec<Draft> {
        let mut values: Vec<Draft> = Vec::new();
        loop {
            let token = self.peek();
            let defines = token.kind == TokenKind::Word && self.peek_behind().is(b'=');
            let name = defines.then(|| self.text(token));
            if defines {
                self.next();
                self.next();
            }
            // Numbers whose steps may hold variables.
            let numbers = match (defines, width) {
                (false, 2..) => self.group_values(Some(width)),
                _ => vec![self.expression(ExpressionPlace::Alone).number],
            };
            let drafts = numbers.iter().map(|number| assembler.postfix(&number.steps(), &values));
            let mut drafts: Vec<Draft> = drafts.collect();
            let Some(name) = name.filter(|_| !self.is_muted()) else {
                return drafts;
            };
            let value = drafts.remove(0);
            self.define(name, token.span(), values.len() as u32);
            values.push(value);
            if self.accept(b',').is_none() {
                self.expected_at(self.peek(), "expected `,` and the next definition, or the value");
                return vec![Draft::Constant(f64::NAN.into())];
            }
        }
    }

    /// The definitions and the values of a formula, this many, up to its end or to an error that has lost the
    /// place.
    fn formulas(&mut self, assembler: &mut Assembler, count: usize) -> Vec<Draft> {
        let (mut definitions, mut values): (Vec<Draft>, Vec<Draft>) = (Vec::new(), Vec::new());
        while values.len() < count {
            let token = self.peek();
            let defines = token.kind == TokenKind::Word && self.peek_behind().is(b'=');
            let name = defines.then(|| self.text(token));
            if defines {
                self.next();
                self.next();
            }
            let number = self.expression(ExpressionPlace::Alone).number;
            let value = assembler.postfix(&number.steps(), &definitions);
            match name.filter(|_| !self.is_muted()) {
                Some(name) => {
                    self.define(name, token.span(), definitions.len() as u32);
                    definitions.push(value);
                }
                None => values.push(value),
            }
            if values.len() < count && self.accept(b',').is_none() {
                let expected = match values.len() {
                    0 => "expected `,` and the next definition, or the value",
                    _ => "expected an operator, or `,` and the next coordinate: warp (x, y, z)",
                };
                self.expected_at(self.peek(), expected);
                values.resize(count, Draft::Constant(f64::NAN.into()));
            }
        }
        values
    }

    /// The node `warp`: its child is asked where three formulas of the point say. Its word has just been
    /// taken.
    pub(super) fn formula_warp(&mut self, start: Token) -> Begun<'a> {
        let written = self.coordinates();
        let bounds = self.accept_word("within").then(|| self.corners());
        let weighted = self.accept_word(WEIGHTED);
        let head = written.map_or(Head::Broken, |written| {
            let written = Box::new(written);
            if weighted { Head::Weighted(written) } else { Head::Unary(written) }
        });
        match (self.block(start, head), bounds) {
            (Begun::Block(frame), Some(corners)) => {
                self.count_node(Span::new(start.start, self.previous_end()));
                Begun::Block(frame.inside(bounding(corners)))
            }
            (begun, _) => begun,
        }
    }

    /// `( definitions x, y, z )`: the formulas of a point.
    fn coordinates(&mut self) -> Option<Written> {
        if self.accept(b'(').is_none() {
            self.expected_at(self.peek(), "expected `(` and three coordinates: warp (x, y, z)");
            return None;
        }
        self.scope = Some(FormulaScope { pointwise: true, ..FormulaScope::default() });
        let mut assembler = Assembler::default();
        let values = self.formulas(&mut assembler, 3);
        self.scope = None;
        if self.accept(b')').is_none() {
            self.expected_at(self.peek(), "expected an operator, or `)`: a point has three coordinates");
        }
        (!self.is_muted()).then(|| Written::FormulaWarp(Formula::new(assembler.finish(&values), None)))
    }

    fn define(&mut self, name: &'a str, span: Span, place: u32) {
        let taken = is_builtin(name)
            || COORDINATES.contains(&name)
            || name == FIELD
            || self.parameter(name).is_some()
            || Function::named(name).is_some()
            || FalloffKind::named(name).is_some();
        if taken {
            self.report(|| {
                Diagnostic::error(Some(span), format!("`{}` means something else already", clip(name)))
            });
        } else if self.scope.as_mut().is_some_and(|scope| scope.definitions.insert(name, place).is_some()) {
            self.report(|| Diagnostic::error(Some(span), format!("a second definition of `{}`", clip(name))));
        }
    }

    /// Past the end of a formula's block, whatever stands before it. Whether there is one.
    fn end_of_formula(&mut self, open: Token) -> bool {
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::Mark(b'}') => {
                    self.report_again();
                    self.next();
                    return true;
                }
                TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    return false;
                }
                TokenKind::Word if is_statement(self.text(token)) => {
                    self.unclosed(open.start as u32, token);
                    return false;
                }
                TokenKind::Word
                | TokenKind::Mark(_)
                | TokenKind::Number
                | TokenKind::Quoted
                | TokenKind::Unknown => {
                    self.skip_token();
                }
            }
        }
    }

    /// Two corners of a box: `(..) to (..)`.
    fn corners(&mut self) -> [[Number; 3]; 2] {
        let low = self.vector();
        if !self.accept_word("to") {
            self.expected_at(self.peek(), "expected `to` and the largest corner");
        }
        let high = if self.is_muted() { low.clone() } else { self.vector() };
        [low, high]
    }

    /// The node `within`: 0 outside of a box. Its word has just been taken.
    pub(super) fn within(&mut self, start: Token) -> Begun<'a> {
        let corners = self.corners();
        self.unary(start, Some(bounding(corners)))
    }

    /// The node `falloff`: its child's field is a distance. Its word has just been taken.
    pub(super) fn falloff_node(&mut self, start: Token) -> Begun<'a> {
        let Some(written) = self.falloff(true) else {
            return self.unary(start, None);
        };
        let falloff = self.fixed_falloff(&written, Span::new(start.start, self.previous_end()));
        if !self.accept_word("radius") {
            self.expected_at(self.peek(), "expected `radius`, the distance at which the field reaches zero");
            return self.unary(start, None);
        }
        let radius = self.expression(ExpressionPlace::Alone).number;
        self.unary(start, Some(Written::Expression(Formula::fading(falloff, radius))))
    }
}

/// A child's field, and 0 outside of a box.
fn bounding(corners: [[Number; 3]; 2]) -> Written {
    Written::Expression(Formula::new(Assembler::default().finish(&[Draft::Child(0)]), Some(corners)))
}
