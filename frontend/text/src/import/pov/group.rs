//! Groups: shapes that are one object.

use std::sync::Arc;

use jbt_model::diagnostic::{Diagnostic, Span};

use super::open::{GroupFrame, Modifier, PovFrame};
use super::scan::PovToken;
use super::script::{PovValue, Script};
use super::shape::PovShapes;

impl Script<'_> {
    pub(super) fn in_group(&mut self, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        match token {
            PovToken::Mark(b'}') => return self.close_group(),
            PovToken::Mark(b',' | b';') => return Ok(()),
            PovToken::Word => {}
            _ => return Err(self.scanner.unexpected(token, span).expected("expected a shape")),
        }
        let word = self.scanner.word(span);
        if self.begin_shapes(word, span)? {
            return Ok(());
        }
        match self.modifier(word, span)? {
            Modifier::Map(map) => {
                if let Some((PovFrame::Group(group), _)) = self.frames.last_mut() {
                    group.map = map * group.map;
                }
                return Ok(());
            }
            Modifier::Done => return Ok(()),
            Modifier::None => {}
        }
        if let Some(PovValue::Shapes(shapes)) = self.value(word) {
            let shapes = Arc::clone(shapes);
            self.spend(1 + shapes.blobs.len(), span)?;
            return self.deliver(PovValue::Shapes(shapes), span);
        }
        match self.scanner.peek()?.0 {
            PovToken::Mark(b'{') => {
                self.scanner.next()?;
                self.open(PovFrame::skip(word), span)
            }
            PovToken::Mark(b'(') => {
                self.left_out.note(span, &format!("the macro {word} is not run"));
                self.skip_balanced(b'(', b')')
            }
            _ => {
                self.left_out.note(span, &format!("{word} is not known and is left out"));
                self.deliver(PovValue::Shapes(Arc::new(PovShapes::other(word))), span)
            }
        }
    }

    pub(super) fn close_group(&mut self) -> Result<(), Diagnostic> {
        let Some((PovFrame::Group(group), span)) = self.frames.pop() else { return Ok(()) };
        let GroupFrame { word, is_set_operation, mut shapes, count, map, color } = group;
        self.spend(shapes.blobs.len(), span)?;
        if is_set_operation && shapes.blobs.is_empty() {
            shapes = PovShapes::other(word);
        }
        let fault: Option<Arc<str>> = (is_set_operation && count > 1).then(|| {
            let others = if shapes.others.is_empty() { "blobs".to_owned() } else { shapes.others.join(", ") };
            format!("a blob in {} {word} with other shapes: {others}", article(word)).into()
        });
        for placed in &mut shapes.blobs {
            placed.map = map * placed.map;
            placed.color = placed.color.or(color);
            placed.fault = placed.fault.take().or_else(|| fault.clone());
        }
        if fault.is_some() {
            // They are named in the fault.
            shapes.others.clear();
        }
        self.deliver(PovValue::Shapes(Arc::new(shapes)), span)
    }
}

fn article(word: &str) -> &'static str {
    if word.starts_with('i') { "an" } else { "a" }
}
