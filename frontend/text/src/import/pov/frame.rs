//! What is open while a scene is run: blobs, components, groups, looks. Each token goes to the innermost one.

use std::sync::Arc;

use glam::DAffine3;
use jbt_model::diagnostic::{Diagnostic, Span};

use super::amount::Amount;
use super::colors;
use super::open::{ComponentFrame, GroupFrame, LookFrame, PovFrame, SHAPES};
use super::scan::PovToken;
use super::script::{PovValue, Script};
use super::shape::{PovBlob, PovShapes};

/// Groups, and whether they are more than a union.
const GROUPS: [(&str, bool); 5] =
    [("object", false), ("union", false), ("merge", false), ("intersection", true), ("difference", true)];

impl Script<'_> {
    /// Runs the scene to its end.
    pub(super) fn run(&mut self) -> Result<(), Diagnostic> {
        loop {
            let (token, span) = self.scanner.next()?;
            if token == PovToken::End {
                if self.leave_file()? {
                    continue;
                }
                return self.finished();
            }
            match (token, self.frames.last().map(|(frame, _)| frame)) {
                (PovToken::Mark(b'#'), _) => self.directive()?,
                (_, None) => self.top(token, span)?,
                (_, Some(PovFrame::Blob(_))) => self.in_blob(token, span)?,
                (_, Some(PovFrame::Component(_))) => self.in_component(token, span)?,
                (_, Some(PovFrame::Group(_))) => self.in_group(token, span)?,
                (_, Some(PovFrame::Look(_))) => self.in_look(token, span)?,
                (_, Some(PovFrame::Skip(_))) => self.in_skipped(token, span)?,
                (_, Some(PovFrame::Transform(_))) => self.in_transform(token, span)?,
                (_, Some(PovFrame::Declaration(_))) => {
                    return Err(self.scanner.unexpected(token, span).expected("expected a value"));
                }
            }
        }
    }

    /// Everything has to be closed at the end.
    pub(super) fn finished(&self) -> Result<(), Diagnostic> {
        if let Some((frame, span)) = self.frames.last() {
            let message = format!("the {} is not closed", frame.word());
            return Err(Diagnostic::error(Some(*span), message).expected("expected `}`"));
        }
        match self.blocks.last() {
            Some((_, span)) => {
                Err(Diagnostic::error(Some(*span), "the directive has no end").expected("expected `#end`"))
            }
            None => Ok(()),
        }
    }

    /// A token that belongs to nothing.
    pub(super) fn top(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        match token {
            PovToken::Mark(b';' | b',') => Ok(()),
            PovToken::Word => {
                let word = self.scanner.word(span);
                if self.begin_shapes(word, span)? {
                    return Ok(());
                }
                match self.scanner.peek()?.0 {
                    PovToken::Mark(b'{') => {
                        self.scanner.next()?;
                        if word != "global_settings" {
                            self.left_out.note(span, &format!("{word} is left out"));
                        }
                        self.open(PovFrame::skip(word), span)
                    }
                    PovToken::Mark(b'(') => {
                        self.left_out.note(span, &format!("the macro {word} is not run"));
                        self.skip_balanced(b'(', b')')
                    }
                    _ => Err(self.scanner.unexpected(token, span)),
                }
            }
            _ => Err(self.scanner.unexpected(token, span)),
        }
    }

    /// Begins a shape, whose word has been read. False if it is none.
    pub(super) fn begin_shapes(&mut self, word: &str, span: Span) -> Result<bool, Diagnostic> {
        let group = GROUPS.iter().find(|(known, _)| *known == word);
        let is_other = SHAPES.contains(&word);
        if word != "blob" && group.is_none() && !is_other {
            return Ok(false);
        }
        self.scanner.expect(b'{')?;
        let frame = match group {
            Some(&(word, is_set_operation)) => PovFrame::Group(GroupFrame {
                word,
                is_set_operation,
                shapes: PovShapes::default(),
                count: 0,
                map: DAffine3::IDENTITY,
                color: None,
            }),
            None if is_other => PovFrame::skip(word),
            None => PovFrame::Blob(PovBlob {
                threshold: 1.0,
                components: Vec::new(),
                map: DAffine3::IDENTITY,
                color: None,
                span,
            }),
        };
        self.open(frame, span)?;
        Ok(true)
    }

    /// The value of a declaration; `None` if it comes when something that is open now is closed.
    pub(super) fn begin_value(&mut self, name: &str, span: Span) -> Result<Option<PovValue>, Diagnostic> {
        let place = self.scanner.place();
        let Some(word) = self.scanner.peek_word()? else {
            return self.expression().map(|amount| Some(PovValue::Amount(amount)));
        };
        if colors::begins(word) {
            return self.color().map(|amount| Some(PovValue::Amount(amount)));
        }
        let word_span = self.scanner.next()?.1;
        let opens = self.scanner.peek()?.0 == PovToken::Mark(b'{');
        if let Some(value) = self.value(word).filter(|value| !matches!(value, PovValue::Amount(_))) {
            let value = value.clone();
            if let PovValue::Shapes(shapes) = &value {
                self.spend(shapes.blobs.len(), span)?;
            }
            if matches!(self.scanner.peek()?.0, PovToken::Mark(b'(')) {
                self.skip_balanced(b'(', b')')?;
                return Ok(Some(PovValue::Amount(Amount::Unknown(word_span))));
            }
            return Ok(Some(value));
        }
        if !opens && !matches!(word, "function" | "array" | "spline") {
            self.scanner.go(place);
            return self.expression().map(|amount| Some(PovValue::Amount(amount)));
        }
        self.open(PovFrame::Declaration(name.to_owned()), span)?;
        if self.begin_shapes(word, word_span)? {
            return Ok(None);
        }
        match self.scanner.peek()?.0 {
            PovToken::Mark(b'(') => self.skip_balanced(b'(', b')')?,
            PovToken::Mark(b'[') => {
                while self.scanner.peek()?.0 == PovToken::Mark(b'[') {
                    self.skip_balanced(b'[', b']')?;
                }
                if self.scanner.peek()?.0 != PovToken::Mark(b'{') {
                    self.frames.pop();
                    return Ok(Some(PovValue::Other));
                }
            }
            _ => {}
        }
        self.scanner.expect(b'{')?;
        let frame = match word {
            "pigment" | "texture" | "material" => {
                PovFrame::Look(LookFrame { depth: 1, color: None, is_default: false })
            }
            "transform" => PovFrame::Transform(DAffine3::IDENTITY),
            _ => PovFrame::skip(word),
        };
        self.open(frame, word_span)?;
        Ok(None)
    }

    /// Hands what was closed to what is open around it.
    pub(super) fn deliver(&mut self, value: PovValue, span: Span) -> Result<(), Diagnostic> {
        match (self.frames.last_mut().map(|(frame, _)| frame), value) {
            (Some(PovFrame::Declaration(_)), value) => {
                if let Some((PovFrame::Declaration(name), _)) = self.frames.pop() {
                    self.declare(&name, value);
                }
                self.scanner.accept(b';')?;
            }
            (Some(PovFrame::Group(group)), PovValue::Shapes(shapes)) => {
                group.count += 1;
                group.shapes.add(Arc::unwrap_or_clone(shapes));
            }
            (Some(PovFrame::Group(GroupFrame { color, .. })), PovValue::Look(look)) => {
                *color = look.or(*color);
            }
            (Some(PovFrame::Blob(PovBlob { color, .. })), PovValue::Look(look)) => *color = look.or(*color),
            (Some(PovFrame::Component(ComponentFrame { color, .. })), PovValue::Look(look)) => {
                *color = look.or(*color);
            }
            (Some(PovFrame::Group(GroupFrame { map, .. })), PovValue::Transform(new))
            | (Some(PovFrame::Blob(PovBlob { map, .. })), PovValue::Transform(new))
            | (Some(PovFrame::Component(ComponentFrame { map, .. })), PovValue::Transform(new))
            | (Some(PovFrame::Transform(map)), PovValue::Transform(new)) => *map = new * *map,
            (None, PovValue::Shapes(shapes)) => {
                for word in &shapes.others {
                    self.left_out.note(span, &format!("{word} is no blob and is left out"));
                }
                self.scene.add(Arc::unwrap_or_clone(shapes));
            }
            (
                _,
                PovValue::Shapes(_)
                | PovValue::Look(_)
                | PovValue::Transform(_)
                | PovValue::Amount(_)
                | PovValue::Other,
            ) => {}
        }
        Ok(())
    }
}
