//! Named parameters in a text, and the block of a primitive.

use super::expression::Place;
use super::lex::{Token, TokenKind};
use super::parse::{Parser, is_statement};
use super::{OWN_FIELDS, field_word};
use crate::diagnostic::{Diagnostic, Span};
use crate::falloff::Falloff;
use crate::field::{Field, FieldValue};
use crate::report::{clip, nearest};
use crate::skeleton::SkeletonKind;
use crate::tree::{NodeKind, Primitive, Tree};

/// Parameters of a description, with those values that have been read.
pub(super) struct Slots {
    fields: &'static [Field],
    values: Vec<Option<FieldValue>>,
}

impl Slots {
    fn new(fields: &'static [Field]) -> Self {
        Self { fields, values: vec![None; fields.len()] }
    }

    /// What was written for a parameter.
    pub(super) fn get(&self, index: usize) -> Option<FieldValue> {
        self.values[index]
    }

    /// The parameters that have to be written and were not.
    pub(super) fn missing(&self) -> Vec<Field> {
        let unwritten = self.fields.iter().zip(&self.values).filter(|(_, value)| value.is_none());
        unwritten.filter(|(field, _)| field.default.is_none()).map(|(field, _)| *field).collect()
    }

    /// All values, with defaults; nothing if one is missing or was wrong.
    pub(super) fn values(&self) -> Option<Vec<FieldValue>> {
        let all = self.fields.iter().zip(&self.values).map(|(field, value)| value.or(field.default));
        all.map(|value| value.filter(is_number)).collect()
    }
}

fn is_number(value: &FieldValue) -> bool {
    match value {
        FieldValue::Real(x) => !x.is_nan(),
        FieldValue::Vector(v) => v.iter().all(|x| !x.is_nan()),
    }
}

/// The message about parameters that have to be written.
pub(super) fn missing_error(span: Span, name: &str, missing: &[Field]) -> Diagnostic {
    let words: Vec<String> = missing.iter().map(|field| format!("`{}`", field.name)).collect();
    Diagnostic::error(Some(span), format!("`{name}` needs {}", words.join(" and ")))
}

/// The parameters that every primitive has, as far as they have been read.
#[derive(Default)]
struct Own {
    radius: Option<f64>,
    surface_radius: Option<(f64, Span)>,
    falloff: Option<Falloff>,
    strength: Option<f64>,
}

impl Parser<'_> {
    /// Named parameters before a block: in any order, each once.
    pub(super) fn slots(&mut self, fields: &'static [Field], owner: &str) -> Slots {
        let mut slots = Slots::new(fields);
        while let Some(word) = self.peek_word() {
            let Some(index) = fields.iter().position(|field| field.name == word) else {
                let names: Vec<&str> = fields.iter().map(|field| field.name).collect();
                let expected = format!("expected `{{`, or a parameter of {owner}: {}", names.join(", "));
                self.expected_at(self.peek(), &expected);
                break;
            };
            let token = self.next();
            self.slot(&mut slots, index, token);
            if self.is_lost() {
                break;
            }
        }
        slots
    }

    /// The value of a parameter whose word, `token`, has just been taken.
    fn slot(&mut self, slots: &mut Slots, index: usize, token: Token) {
        let value = self.field_value(slots.fields[index].kind);
        self.once(&mut slots.values[index], value, token);
    }

    /// Sets what may be written once.
    fn once<T>(&mut self, slot: &mut Option<T>, value: T, token: Token) {
        if slot.replace(value).is_some() {
            let word = self.text(token);
            self.report(|| Diagnostic::error(Some(token.span()), format!("a second `{word}`")));
        }
    }

    /// A primitive whose name, `start`, has just been taken.
    pub(super) fn primitive(&mut self, kind: SkeletonKind, start: Token) -> Tree {
        let mut slots = Slots::new(kind.fields());
        let mut own = Own::default();
        let Some(open) = self.open() else {
            return self.broken.clone();
        };
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::Mark(b'}') => {
                    self.find_place();
                    self.next();
                    break;
                }
                TokenKind::Word if !is_statement(self.text(token)) => {
                    self.next();
                    self.primitive_field(kind, token, &mut slots, &mut own);
                }
                TokenKind::Word | TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    return self.broken.clone();
                }
                TokenKind::Mark(_) | TokenKind::Number | TokenKind::Unknown => {
                    self.expected_at(token, "expected a parameter or `}`");
                    self.skip_token();
                }
            }
        }
        let span = Span::new(start.start, self.previous_end());
        self.finished_primitive(kind, span, &slots, &own)
    }

    /// A parameter of a primitive whose word, `token`, has just been taken.
    fn primitive_field(&mut self, kind: SkeletonKind, token: Token, slots: &mut Slots, own: &mut Own) {
        let word = self.text(token);
        let own_field = OWN_FIELDS.contains(&word);
        let index = kind.fields().iter().position(|field| field_word(kind, field) == word);
        if !own_field && index.is_none() {
            if self.is_lost() {
                return;
            }
            return self.unknown_field(kind, token);
        }
        self.find_place();
        if let Some(index) = index {
            return self.slot(slots, index, token);
        }
        if word == "falloff" {
            let falloff = self.falloff();
            if let Some(falloff) = falloff {
                self.once(&mut own.falloff, falloff, token);
            }
            return;
        }
        let value = self.expression(Place::Alone);
        match word {
            "radius" => self.once(&mut own.radius, value.value, token),
            "surface_radius" => {
                let span = Span { start: token.start as u32, end: value.span.end };
                self.once(&mut own.surface_radius, (value.value, span), token);
            }
            _ => self.once(&mut own.strength, value.value, token),
        }
    }

    fn falloff(&mut self) -> Option<Falloff> {
        let token = self.peek();
        let names = || Falloff::ALL.iter().map(|falloff| falloff.name());
        let expected = || format!("expected one of {}", names().collect::<Vec<_>>().join(", "));
        let Some(word) = self.peek_word() else {
            self.expected_at(token, &expected());
            return None;
        };
        self.next();
        let found = Falloff::ALL.iter().copied().find(|falloff| falloff.name() == word);
        if found.is_none() {
            self.report(|| {
                Diagnostic::error(Some(token.span()), format!("no falloff is called `{}`", clip(word)))
                    .expected(expected())
            });
        }
        found
    }

    fn unknown_field(&mut self, kind: SkeletonKind, token: Token) {
        let word = self.text(token);
        self.lose_place(|| {
            let words: Vec<_> = kind.fields().iter().map(|field| field_word(kind, field)).collect();
            let error = Diagnostic::error(
                Some(token.span()),
                format!("`{}` has no parameter `{}`", kind.name(), clip(word)),
            );
            let known = || words.iter().map(|word| &**word).chain(OWN_FIELDS);
            error.expected(match nearest(word, known()) {
                Some(near) => format!("perhaps `{near}`"),
                None => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
            })
        });
    }

    fn finished_primitive(&mut self, kind: SkeletonKind, span: Span, slots: &Slots, own: &Own) -> Tree {
        let mut missing: Vec<String> =
            slots.missing().iter().map(|field| format!("`{}`", field_word(kind, field))).collect();
        if own.radius.is_none() && own.surface_radius.is_none() {
            missing.push("`radius`".to_owned());
        }
        if !missing.is_empty() {
            self.report(|| {
                Diagnostic::error(Some(span), format!("`{}` needs {}", kind.name(), missing.join(" and ")))
            });
        }
        let falloff = own.falloff.unwrap_or(Falloff::Soft);
        let strength = own.strength.unwrap_or(1.0);
        let radius = match (own.radius, own.surface_radius) {
            (radius, None) => radius,
            (None, Some((radius, at))) => self.support_radius(radius, falloff, strength, at),
            (Some(_), Some((_, at))) => {
                self.report(|| {
                    Diagnostic::error(Some(at), "`surface_radius` and `radius` in one primitive")
                        .expected("expected one of them")
                });
                None
            }
        };
        match (slots.values(), radius) {
            (Some(values), Some(radius)) => {
                let skeleton = kind.from_fields(&values);
                let primitive = Primitive { skeleton, falloff, radius, strength };
                Tree::at(span, NodeKind::Primitive(primitive), Vec::new())
            }
            _ => self.broken.clone(),
        }
    }

    /// The support radius of a primitive whose surface alone has this radius: `r / sqrt(s)` with `falloff(s) = iso / strength`.
    fn support_radius(&mut self, radius: f64, falloff: Falloff, strength: f64, at: Span) -> Option<f64> {
        let level = self.iso / strength;
        if radius.is_nan() || self.iso.is_nan() || strength.is_nan() {
            return None;
        }
        if !(level > 0.0 && level < 1.0) {
            let (iso, strength) = (super::print::number(self.iso), super::print::number(strength));
            self.report(|| {
                let message = format!("with strength {strength} the primitive has no surface at iso {iso}");
                Diagnostic::error(Some(at), message)
                    .expected("expected a strength above iso, or `radius`, the radius of the support")
            });
            return None;
        }
        Some(radius / falloff.inverse(level).sqrt())
    }
}
