//! Looks, of which the colour counts; what is left out; transformations by name.

use std::sync::Arc;

use glam::DAffine3;
use jbt_model::diagnostic::{Diagnostic, Span};

use super::colors;
use super::modifier::BRACES;
use super::open::{LookFrame, Modifier, PovFrame, SHAPES};
use super::scan::PovToken;
use super::script::{PovValue, Script};
use super::shape::PovShapes;

impl Script<'_> {
    pub(super) fn in_look(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        match token {
            PovToken::Mark(b'{') => self.with_look(|look| look.depth += 1),
            PovToken::Mark(b'}') => {
                self.with_look(|look| look.depth -= 1);
                let Some((PovFrame::Look(LookFrame { depth: 0, color, is_default }), _)) = self.frames.last()
                else {
                    return Ok(());
                };
                let (color, is_default) = (*color, *is_default);
                self.frames.pop();
                if is_default {
                    self.default_color = color;
                    return Ok(());
                }
                return self.deliver(PovValue::Look(color), span);
            }
            PovToken::Word => return self.word_of_look(span),
            _ => {}
        }
        Ok(())
    }

    pub(super) fn with_look(&mut self, change: impl FnOnce(&mut LookFrame)) {
        if let Some((PovFrame::Look(look), _)) = self.frames.last_mut() {
            change(look);
        }
    }

    pub(super) fn word_of_look(&mut self, span: Span) -> Result<(), Diagnostic> {
        let word = self.scanner.word(span);
        if colors::begins(word) {
            self.scanner.go(span.start as usize);
            let amount = self.color()?;
            let color = self.linear(amount);
            if color.is_none() {
                self.left_out.note(span, "a colour that is not known is left out");
            }
            self.with_look(|look| look.color = color);
            return Ok(());
        }
        if matches!(word, "quick_color" | "quick_colour") {
            return if self.is_color_next()? {
                self.color().map(|_| ())
            } else {
                self.expression().map(|_| ())
            };
        }
        if matches!(word, "pigment" | "texture" | "material") {
            return Ok(());
        }
        if matches!(word, "translate" | "rotate" | "scale") {
            return self.expression().map(|_| ());
        }
        if self.scanner.peek()?.0 == PovToken::Mark(b'{') {
            if !BRACES.contains(&word) && word != "transform" {
                self.left_out.note(span, &format!("{word} gives no colour that is read"));
            }
            self.scanner.next()?;
            return self.open(PovFrame::skip(word), span);
        }
        match self.named_color(word) {
            Some(color) => self.with_look(|look| look.color = color.or(look.color)),
            None => self.left_out.note(span, &format!("{word} gives no colour that is read")),
        }
        if self.scanner.peek()?.0 == PovToken::Mark(b'(') {
            self.skip_balanced(b'(', b')')?;
        }
        Ok(())
    }

    /// What is left out calls for random numbers all the same.
    pub(super) fn in_skipped(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        let Some((PovFrame::Skip(skip), _)) = self.frames.last_mut() else { return Ok(()) };
        match token {
            PovToken::Mark(b'{') => skip.depth += 1,
            PovToken::Mark(b'}') => {
                skip.depth -= 1;
                if skip.depth == 0 {
                    let word = std::mem::take(&mut skip.word);
                    let begin = self.frames.pop().map_or(span, |(_, begin)| begin);
                    let is_shape = SHAPES.contains(&word.as_str());
                    let shapes = || PovValue::Shapes(Arc::new(PovShapes::other(&word)));
                    let value = if is_shape { shapes() } else { PovValue::Other };
                    return self.deliver(value, begin);
                }
            }
            PovToken::Word => match self.scanner.word(span) {
                "rand" => {
                    self.scanner.go(span.start as usize);
                    self.expression()?;
                }
                "assumed_gamma" => return self.assumed_gamma(span),
                _ => {}
            },
            _ => {}
        }
        Ok(())
    }

    pub(super) fn in_transform(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        match token {
            PovToken::Mark(b'}') => {
                let Some((PovFrame::Transform(map), begin)) = self.frames.pop() else { return Ok(()) };
                return self.deliver(PovValue::Transform(map), begin);
            }
            PovToken::Mark(b',') => return Ok(()),
            PovToken::Word => {}
            _ => return Err(self.scanner.unexpected(token, span).expected("expected a transformation")),
        }
        let word = self.scanner.word(span);
        let map = match self.modifier(word, span)? {
            Modifier::Map(map) => map,
            Modifier::Done => return Ok(()),
            Modifier::None => match (word, self.value(word)) {
                ("inverse", _) => DAffine3::IDENTITY,
                (_, Some(&PovValue::Transform(map))) => map,
                _ => return Err(self.scanner.unexpected(token, span).expected("expected a transformation")),
            },
        };
        if let Some((PovFrame::Transform(so_far), _)) = self.frames.last_mut() {
            *so_far = map * *so_far;
        }
        Ok(())
    }
}
