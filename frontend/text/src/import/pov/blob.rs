//! Blobs and their components, as they are read.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::skeleton::{Point, Segment};

use super::open::{ComponentFrame, Modifier, PovFrame};
use super::scan::PovToken;
use super::script::{PovValue, Script};
use super::shape::{Component, PlacedBlob, PovBlob, PovShapes};

/// Smallest strength and squared radius of a component that counts, as in the original.
const NOTHING: f64 = 1e-10;

impl Script<'_> {
    pub(super) fn in_blob(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        match token {
            PovToken::Mark(b'}') => return self.close_blob(),
            PovToken::Mark(b',') => return Ok(()),
            PovToken::Word => {}
            _ => return Err(self.scanner.unexpected(token, span).expected("expected a component")),
        }
        let word = self.scanner.word(span);
        match word {
            "threshold" => {
                let at = self.scanner.peek()?.1;
                let amount = self.expression()?;
                let threshold = self.real(amount, at)?;
                if threshold <= 0.0 {
                    let error = Diagnostic::error(Some(at), format!("the threshold is {threshold}"));
                    return Err(error.expected("expected a number above 0"));
                }
                self.with_blob(|blob| blob.threshold = threshold);
                Ok(())
            }
            "sphere" | "cylinder" => {
                self.spend(4, span)?;
                self.scanner.expect(b'{')?;
                let frame = ComponentFrame {
                    is_sphere: word == "sphere",
                    arguments: Vec::new(),
                    map: DAffine3::IDENTITY,
                    color: None,
                };
                self.open(PovFrame::Component(frame), span)
            }
            "component" => self.old_component(span),
            _ => match self.modifier(word, span)? {
                Modifier::Map(map) => {
                    self.with_blob(|blob| blob.map = map * blob.map);
                    Ok(())
                }
                Modifier::Done => Ok(()),
                Modifier::None => self.blob_name(word, span),
            },
        }
    }

    pub(super) fn with_blob(&mut self, change: impl FnOnce(&mut PovBlob)) {
        if let Some((PovFrame::Blob(blob), _)) = self.frames.last_mut() {
            change(blob);
        }
    }

    /// A name in a blob: that of another blob, which this one begins with.
    pub(super) fn blob_name(&mut self, word: &str, span: Span) -> Result<(), Diagnostic> {
        let known = match self.value(word) {
            Some(PovValue::Shapes(shapes)) if shapes.blobs.len() == 1 => Some(shapes.blobs[0].clone()),
            _ => None,
        };
        if let Some(placed) = known {
            self.spend(4 * placed.blob.components.len(), span)?;
            self.with_blob(|blob| {
                let PovBlob { threshold, components, map, color, .. } = (*placed.blob).clone();
                *blob = PovBlob { threshold, components, map: placed.map * map, color, span: blob.span };
            });
            return Ok(());
        }
        let shown = self.scanner.shown(span);
        let error = if self.scanner.peek()?.0 == PovToken::Mark(b'(') {
            Diagnostic::error(Some(span), format!("the macro `{shown}` is called in a blob, and is not run"))
        } else {
            Diagnostic::error(Some(span), format!("unexpected `{shown}`"))
        };
        Err(error.expected("expected a component, a transformation or a pigment"))
    }

    /// `component strength, radius, <centre>`, without braces.
    pub(super) fn old_component(&mut self, span: Span) -> Result<(), Diagnostic> {
        self.spend(4, span)?;
        let mut arguments = Vec::with_capacity(3);
        for _ in 0..3 {
            self.scanner.accept(b',')?;
            let at = self.scanner.peek()?.1;
            arguments.push((self.expression()?, at));
        }
        arguments.reverse();
        let frame = ComponentFrame { is_sphere: true, arguments, map: DAffine3::IDENTITY, color: None };
        self.add_component(frame, span)
    }

    pub(super) fn in_component(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        match token {
            PovToken::Mark(b'}') => {
                let Some((PovFrame::Component(frame), begin)) = self.frames.pop() else { return Ok(()) };
                return self.add_component(frame, begin);
            }
            PovToken::Mark(b',') => return Ok(()),
            PovToken::Word => {
                let word = self.scanner.word(span);
                if word == "strength" {
                    return Ok(());
                }
                match self.modifier(word, span)? {
                    Modifier::Map(map) => {
                        if let Some((PovFrame::Component(frame), _)) = self.frames.last_mut() {
                            frame.map = map * frame.map;
                        }
                        return Ok(());
                    }
                    Modifier::Done => return Ok(()),
                    Modifier::None => {}
                }
            }
            PovToken::End
            | PovToken::Text
            | PovToken::Number(_)
            | PovToken::Mark(_)
            | PovToken::AtMost
            | PovToken::AtLeast
            | PovToken::Unequal => {}
        }
        self.scanner.go(span.start as usize);
        let amount = self.expression()?;
        if let Some((PovFrame::Component(frame), _)) = self.frames.last_mut() {
            if frame.arguments.len() == 4 {
                return Err(Diagnostic::error(Some(span), "the component has too many numbers"));
            }
            frame.arguments.push((amount, span));
        }
        Ok(())
    }

    /// A component that is complete.
    pub(super) fn add_component(&mut self, frame: ComponentFrame, span: Span) -> Result<(), Diagnostic> {
        let ComponentFrame { is_sphere, arguments, map, color } = frame;
        let needed = if is_sphere { 3 } else { 4 };
        if arguments.len() != needed {
            let message = format!("the component has {} of {needed} arguments", arguments.len());
            let error = Diagnostic::error(Some(span), message);
            return Err(error.expected(if is_sphere {
                "expected sphere { centre, radius, strength }"
            } else {
                "expected cylinder { end, end, radius, strength }"
            }));
        }
        let places = needed - 2;
        let ends: Vec<DVec3> = arguments[..places]
            .iter()
            .map(|&(amount, at)| self.reals(amount, at))
            .collect::<Result<_, _>>()?;
        let radius = self.real(arguments[places].0, arguments[places].1)?.abs();
        let strength = self.real(arguments[places + 1].0, arguments[places + 1].1)?;
        if strength.abs() < NOTHING || radius * radius < NOTHING {
            self.left_out.note(span, "a component without strength or radius is left out");
            return Ok(());
        }
        let skeleton = match ends.as_slice() {
            [from, to] if from != to => Segment { from: *from, to: *to }.into(),
            _ => Point { at: ends[0] }.into(),
        };
        self.with_blob(|blob| {
            blob.components.push(Component { skeleton, radius, strength, map, color, span });
        });
        Ok(())
    }

    pub(super) fn close_blob(&mut self) -> Result<(), Diagnostic> {
        let Some((PovFrame::Blob(mut blob), span)) = self.frames.pop() else { return Ok(()) };
        blob.color = blob.color.or(self.default_color);
        let mut shapes = PovShapes::default();
        if blob.components.is_empty() {
            self.left_out.note(span, "the blob has no components");
        } else {
            let blob = Arc::new(blob);
            shapes.blobs.push(PlacedBlob { blob, map: DAffine3::IDENTITY, color: None, fault: None });
        }
        self.deliver(PovValue::Shapes(Arc::new(shapes)), span)
    }
}
