//! Named parameters in a text, and the block of a primitive.

use super::expression::ExpressionPlace;
use super::hints::{in_braces, radii};
use super::lex::{Token, TokenKind};
use super::state::Parser;
use super::words::{COMMON_FIELDS, WEIGHTED, field_word};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::falloff::Falloff;
use jbt_model::field::Field;
use jbt_model::number::Number;
use jbt_model::report::{clip, nearest};
use jbt_model::skeleton::SkeletonKind;
use jbt_model::tree::Tree;
use jbt_model::word::is_statement;
use jbt_model::written::{FieldNumber, Radius, Written, WrittenFalloff};

/// Parameters of a description, with those values that have been read.
pub(super) struct Slots<'a> {
    fields: &'a [Field],
    values: Vec<Option<FieldNumber>>,
}

impl<'a> Slots<'a> {
    pub(super) fn new(fields: &'a [Field]) -> Self {
        Self { fields, values: vec![None; fields.len()] }
    }

    /// What was written for a parameter; it is not there any more.
    pub(super) fn take(&mut self, index: usize) -> Option<FieldNumber> {
        self.values[index].take()
    }

    /// The parameters that have to be written and were not.
    pub(super) fn missing(&self) -> Vec<Field> {
        let unwritten = self.fields.iter().zip(&self.values).filter(|(_, value)| value.is_none());
        unwritten.filter(|(field, _)| field.default.is_none()).map(|(field, _)| field.clone()).collect()
    }

    /// All values, with defaults; nothing if one is missing or was wrong.
    pub(super) fn values(self) -> Option<Vec<FieldNumber>> {
        let all = self.fields.iter().zip(self.values);
        let all = all.map(|(field, value)| value.or_else(|| field.default.clone().map(FieldNumber::from)));
        all.map(|value| value.filter(is_number)).collect()
    }

    /// All values, with defaults; nothing if one is missing or wrong, after a message.
    pub(super) fn complete(
        self,
        parser: &mut Parser<'_>,
        start: Token,
        name: &str,
    ) -> Option<Vec<FieldNumber>> {
        let span = Span::new(start.start, parser.previous_end());
        let missing = self.missing();
        if !missing.is_empty() && !parser.is_muted() {
            parser.report(|| missing_error(span, name, &missing));
        }
        self.values()
    }
}

fn is_number(value: &FieldNumber) -> bool {
    value.numbers().iter().all(|number| !number.value().is_nan())
}

/// The message about parameters that have to be written.
pub(super) fn missing_error(span: Span, name: &str, missing: &[Field]) -> Diagnostic {
    let words: Vec<String> = missing.iter().map(|field| format!("`{}`", field.name)).collect();
    Diagnostic::error(Some(span), format!("`{name}` needs {}", words.join(" and ")))
}

/// The parameters that every primitive has, as far as they have been read.
#[derive(Default)]
struct Common {
    radius: Option<Number>,
    surface_radius: Option<(Number, Span)>,
    falloff: Option<WrittenFalloff>,
    strength: Option<Number>,
}

impl Parser<'_> {
    /// Named parameters before a block: in any order, each once.
    pub(super) fn slots<'f>(&mut self, fields: &'f [Field], owner: &str) -> Slots<'f> {
        let mut slots = Slots::new(fields);
        while let Some(word) = self.peek_word().filter(|word| *word != WEIGHTED) {
            let Some(index) = fields.iter().position(|field| field.name == word) else {
                let names: Vec<&str> = fields.iter().map(|field| field.name).collect();
                let expected = format!("expected `{{`, or a parameter of {owner}: {}", names.join(", "));
                self.expected_at(self.peek(), &expected);
                break;
            };
            let token = self.next();
            self.slot(&mut slots, index, token);
            if self.is_muted() {
                break;
            }
        }
        slots
    }

    /// The value of a parameter whose word, `token`, has just been taken.
    pub(super) fn slot(&mut self, slots: &mut Slots<'_>, index: usize, token: Token) {
        let value = self.field_value(slots.fields[index].kind);
        self.once(&mut slots.values[index], value, token);
    }

    /// Sets what may be written once.
    pub(super) fn once<T>(&mut self, slot: &mut Option<T>, value: T, token: Token) {
        if slot.replace(value).is_some() {
            let word = self.text(token);
            self.report(|| Diagnostic::error(Some(token.span()), format!("a second `{word}`")));
        }
    }

    /// A primitive whose name, `start`, has just been taken.
    pub(super) fn primitive(&mut self, kind: SkeletonKind, start: Token) -> Tree {
        let mut slots = Slots::new(kind.fields());
        let mut common = Common::default();
        if self.peek().is(b'(') {
            self.expected_at(self.peek(), &in_braces(kind));
            self.skip_arguments();
            if !self.peek().is(b'{') {
                self.report_again();
                return self.broken.clone();
            }
        }
        let Some(open) = self.open() else {
            return self.broken.clone();
        };
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::Mark(b'}') => {
                    self.report_again();
                    self.next();
                    break;
                }
                TokenKind::Word if !is_statement(self.text(token)) => {
                    self.next();
                    self.primitive_field(kind, token, &mut slots, &mut common);
                }
                TokenKind::Word | TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    return self.broken.clone();
                }
                TokenKind::Mark(_) | TokenKind::Number | TokenKind::Quoted | TokenKind::Unknown => {
                    self.expected_at(token, "expected a parameter or `}`");
                    self.skip_token();
                }
            }
        }
        let span = Span::new(start.start, self.previous_end());
        self.finished_primitive(kind, span, slots, common)
    }

    /// A parameter of a primitive whose word, `token`, has just been taken.
    fn primitive_field(
        &mut self,
        kind: SkeletonKind,
        token: Token,
        slots: &mut Slots<'_>,
        common: &mut Common,
    ) {
        let word = self.text(token);
        let common_field = COMMON_FIELDS.contains(&word);
        let index = kind.fields().iter().position(|field| field_word(kind, field) == word);
        if !common_field && index.is_none() {
            if self.is_muted() {
                return;
            }
            return self.unknown_field(kind, token);
        }
        self.report_again();
        if let Some(index) = index {
            return self.slot(slots, index, token);
        }
        if word == "falloff" {
            let falloff = self.falloff(false);
            if let Some(falloff) = falloff {
                self.once(&mut common.falloff, falloff, token);
            }
            return;
        }
        // A plain number keeps no place: an error of the check underlines the whole primitive.
        let value = self.expression(ExpressionPlace::Alone);
        match word {
            "radius" => self.once(&mut common.radius, value.number, token),
            "surface_radius" => {
                let span = Span { start: token.start as u32, end: value.span.end };
                self.once(&mut common.surface_radius, (value.number, span), token);
            }
            _ => self.once(&mut common.strength, value.number, token),
        }
    }

    fn unknown_field(&mut self, kind: SkeletonKind, token: Token) {
        let word = self.text(token);
        self.report_and_mute(|| {
            let words: Vec<_> = kind.fields().iter().map(|field| field_word(kind, field)).collect();
            let error = Diagnostic::error(
                Some(token.span()),
                format!("`{}` has no parameter `{}`", kind.name(), clip(word)),
            );
            let known = || words.iter().map(|word| &**word).chain(COMMON_FIELDS);
            // Figures with a size have a `center`, and a point is `at` a place.
            let other = [("center", "at"), ("at", "center")].into_iter().find(|(from, _)| *from == word);
            let other = other.map(|(_, to)| to).filter(|to| known().any(|word| word == *to));
            error.expected(match other.or_else(|| nearest(word, known())) {
                Some(near) => format!("perhaps `{near}`"),
                None => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
            })
        });
    }

    fn finished_primitive(
        &mut self,
        kind: SkeletonKind,
        span: Span,
        slots: Slots<'_>,
        common: Common,
    ) -> Tree {
        let mut missing: Vec<String> =
            slots.missing().iter().map(|field| format!("`{}`", field_word(kind, field))).collect();
        if common.radius.is_none() && common.surface_radius.is_none() {
            missing.push("`radius`".to_owned());
        }
        if !missing.is_empty() {
            self.report(|| {
                let needs = format!("`{}` needs {}", kind.name(), missing.join(" and "));
                let help = radii(kind, common.radius.is_some() || common.surface_radius.is_some());
                Diagnostic { help, ..Diagnostic::error(Some(span), needs) }
            });
        }
        let falloff = common.falloff.unwrap_or_else(|| Falloff::Soft.into());
        let strength = common.strength.unwrap_or_else(|| 1.0.into());
        let radius = match (common.radius, common.surface_radius) {
            (radius, None) => radius.map(Radius::Support),
            (None, Some((radius, _))) => Some(Radius::Surface(radius)),
            (Some(_), Some((_, at))) => {
                self.report(|| {
                    Diagnostic::error(Some(at), "`surface_radius` and `radius` in one primitive")
                        .expected("expected one of them")
                });
                None
            }
        };
        let (Some(fields), Some(radius)) = (slots.values(), radius) else {
            return self.broken.clone();
        };
        let written = Written::Primitive { skeleton: kind, fields, falloff, radius, strength };
        self.make(span, written, Vec::new())
    }
}
