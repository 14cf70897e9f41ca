//! What stands between the name of an attribute and its block: numbers, a texture, a formula, or a map of uv.
//!
//! ```text
//! color (1 0.3 0.1) { child }
//! color checker { a (1 1 1) b (0 0 0) size 0.5 } { child }
//! color expression { r = sqrt(x^2 + y^2), (r, 1 - r, 0) } { child }
//! uv scale (2 2) rotate 90 shift (0 0.5) { child }           a group of two reals; all three may be left out
//! ```

use super::color::color_hint;
use super::expression::ExpressionPlace;
use super::lex::{Token, TokenKind};
use super::primitive::Slots;
use super::state::Parser;
use super::words::{EXPRESSION, is_builtin, texture_named};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::number::Number;
use jbt_model::report::{clip, nearest};
use jbt_model::texture::TextureKind;
use jbt_model::word::is_statement;
use jbt_model::written::{WrittenAttribute, WrittenTextured, WrittenUv};

/// The words of a map of uv.
const UV_WORDS: [&str; 3] = ["scale", "rotate", "shift"];

/// The words for the two values of a texture.
const ENDS: [&str; 2] = ["a", "b"];

impl Parser<'_> {
    /// The value of the attribute `name`, whose token is `at`; nothing after an error in what is no list of
    /// numbers.
    pub(super) fn attribute_value(
        &mut self,
        at: Token,
        name: &str,
        width: usize,
    ) -> Option<WrittenAttribute> {
        if self.begins_color(Some(width)) {
            return Some(WrittenAttribute::Numbers(self.group_values(Some(width))));
        }
        let word = self.peek_word();
        if let Some(kind) = word.and_then(texture_named) {
            let token = self.next();
            return self.textured(kind, token, width).map(WrittenAttribute::Textured);
        }
        if word == Some(EXPRESSION) {
            let token = self.next();
            return self.attribute_formula(token, width).map(WrittenAttribute::Expressed);
        }
        let is_number = |word: &str| {
            self.parameter(word).is_some() || self.elements_named(word).is_some() || is_builtin(word)
        };
        let begins_uv = match word {
            // Behind a uv without a map, the next value of a style or its end may follow.
            Some(word) => {
                let is_uv = UV_WORDS.contains(&word) || self.begins_given(word) && !is_number(word);
                is_uv && (width == 2 || !is_number(word))
            }
            None => self.peek().is(b'{') || self.peek().is(b'}'),
        };
        if begins_uv && (width == 2 || name == "uv") {
            return self.uv(at, name, width).map(WrittenAttribute::Uv);
        }
        match word {
            Some(word) if !is_number(word) => {
                self.unknown_texture(word, width);
                None
            }
            _ => Some(WrittenAttribute::Numbers(self.group_values(Some(width)))),
        }
    }

    fn unknown_texture(&mut self, word: &str, width: usize) {
        let token = self.next();
        self.report_with(|parser| {
            let message = format!("no texture or parameter is called `{}`", clip(word));
            let textures = || TextureKind::ALL.iter().map(|kind| kind.name());
            let words = textures().chain([EXPRESSION]).chain(parser.parameter_names());
            let color = color_hint(word).filter(|_| matches!(width, 3 | 4));
            Diagnostic::error(Some(token.span()), message).expected(match (color, nearest(word, words)) {
                (Some(hint), _) => hint,
                (None, Some(near)) => format!("perhaps `{near}`"),
                (None, None) => format!(
                    "`{EXPRESSION}` is a formula, textures are {}",
                    textures().collect::<Vec<_>>().join(", ")
                ),
            })
        });
        self.mute();
        self.skip_arguments();
        if self.peek().is(b'{') {
            self.skip_block();
        }
    }

    /// The map of a uv, in any order, each part once.
    fn uv(&mut self, at: Token, name: &str, width: usize) -> Option<WrittenUv> {
        let (mut scale, mut degrees, mut shift) = (None, None, None);
        while let Some(word) = self.peek_word() {
            if self.begins_given(word) && !UV_WORDS.contains(&word) {
                break;
            }
            if !UV_WORDS.contains(&word) {
                let expected = format!("expected `{{`, or a part of the map: {}", UV_WORDS.join(", "));
                self.expected_at(self.peek(), &expected);
                break;
            }
            let token = self.next();
            match word {
                "scale" => {
                    let numbers = self.one_or_two();
                    self.once(&mut scale, numbers, token);
                }
                "rotate" => {
                    let number = self.expression(ExpressionPlace::Alone).number;
                    self.once(&mut degrees, number, token);
                }
                _ => {
                    let numbers = self.vector();
                    self.once(&mut shift, numbers, token);
                }
            }
            if self.is_muted() {
                break;
            }
        }
        if width != 2 {
            let plural = if width == 1 { "" } else { "s" };
            self.report(|| {
                let message = format!("`{}` has {width} real{plural}, and a uv has 2", clip(name));
                Diagnostic::error(Some(at.span()), message).expected("expected a group of 2 reals, or values")
            });
            return None;
        }
        let identity = WrittenUv::default();
        Some(WrittenUv {
            scale: scale.unwrap_or(identity.scale),
            degrees: degrees.unwrap_or(identity.degrees),
            shift: shift.unwrap_or(identity.shift),
        })
    }

    /// Two numbers, or one for both; NaNs after an error.
    fn one_or_two(&mut self) -> [Number; 2] {
        match self.number_or_elements() {
            None => [f64::NAN.into(), f64::NAN.into()],
            Some(all) if all.count == 1 => [all.numbers[0].clone(), all.numbers[0].clone()],
            Some(all) => self.sized(all),
        }
    }

    /// The block of a texture, whose word, `start`, has just been taken.
    fn textured(&mut self, kind: TextureKind, start: Token, width: usize) -> Option<WrittenTextured> {
        let mut slots = Slots::new(kind.fields());
        let mut ends: [Option<Vec<Number>>; 2] = [None, None];
        let open = self.open()?;
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
                    self.texture_field(kind, token, (&mut slots, &mut ends), width);
                }
                TokenKind::Word | TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    self.mute();
                    return None;
                }
                TokenKind::Mark(_) | TokenKind::Number | TokenKind::Quoted | TokenKind::Unknown => {
                    self.expected_at(token, "expected a parameter or `}`");
                    self.skip_token();
                }
            }
        }
        let missing = slots.missing().into_iter().map(|field| field.name);
        let ends_missing = ENDS.iter().copied().zip(&ends).filter(|(_, end)| end.is_none());
        let missing: Vec<String> =
            ends_missing.map(|(name, _)| name).chain(missing).map(|name| format!("`{name}`")).collect();
        if !missing.is_empty() {
            let span = Span::new(start.start, self.previous_end());
            self.report(|| {
                Diagnostic::error(Some(span), format!("`{}` needs {}", kind.name(), missing.join(" and ")))
            });
        }
        let [a, b] = ends;
        Some(WrittenTextured { texture: kind, fields: slots.values()?, a: a?, b: b? })
    }

    /// A parameter of a texture whose word, `token`, has just been taken.
    fn texture_field(
        &mut self,
        kind: TextureKind,
        token: Token,
        (slots, ends): (&mut Slots<'_>, &mut [Option<Vec<Number>>; 2]),
        width: usize,
    ) {
        let word = self.text(token);
        let end = ENDS.iter().position(|end| *end == word);
        let index = kind.fields().iter().position(|field| field.name == word);
        match (end, index) {
            (Some(end), _) => {
                self.report_again();
                let numbers = self.group_values(Some(width));
                self.once(&mut ends[end], numbers, token);
            }
            (None, Some(index)) => {
                self.report_again();
                self.slot(slots, index, token);
            }
            (None, None) => self.unknown_texture_field(kind, token),
        }
    }

    fn unknown_texture_field(&mut self, kind: TextureKind, token: Token) {
        let word = self.text(token);
        self.report_and_mute(|| {
            let message = format!("`{}` has no parameter `{}`", kind.name(), clip(word));
            let known = || ENDS.into_iter().chain(kind.fields().iter().map(|field| field.name));
            Diagnostic::error(Some(token.span()), message).expected(match nearest(word, known()) {
                Some(near) => format!("perhaps `{near}`"),
                None => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
            })
        });
    }
}
