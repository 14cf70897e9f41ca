//! The directive `#include`, and the end of the file that it names.

use jbt_ir::limits::MAX_INCLUDE_DEPTH;
use jbt_model::diagnostic::{Diagnostic, Span};

use super::scan::PovToken;
use super::script::Script;
use super::texts::PovReturn;

impl Script<'_> {
    /// Another file. The names of the usual colours are known without it.
    pub(super) fn include(&mut self, span: Span) -> Result<(), Diagnostic> {
        let (token, at) = self.scanner.next()?;
        if token != PovToken::Text {
            return Err(self.scanner.unexpected(token, at).expected("expected the name of a file"));
        }
        self.spend(1, span)?;
        let name = self.scanner.word(at);
        if let Some(range) = self.texts.named(at.start as usize, name) {
            if self.returns.len() == MAX_INCLUDE_DEPTH {
                let message = format!("files include each other more than {MAX_INCLUDE_DEPTH} deep");
                return Err(Diagnostic::limit(Some(span), message));
            }
            let open = [self.frames.len(), self.blocks.len()];
            self.returns.push(PovReturn { place: self.scanner.place(), open });
            self.scanner.enter(range);
            return Ok(());
        }
        let name = format!("\"{}\"", self.scanner.shown(at));
        if name != "\"colors.inc\"" {
            self.left_out.note(span, &format!("the file {name} is not read"));
            if self.missing.len() < 8 {
                self.missing.push(name);
            }
        }
        Ok(())
    }

    /// Goes back behind the directive whose file ends here. False at the end of the scene.
    pub(super) fn leave_file(&mut self) -> Result<bool, Diagnostic> {
        let Some(PovReturn { place, open }) = self.returns.pop() else { return Ok(false) };
        let [frames, blocks] = open;
        if self.blocks.len() != blocks {
            let span = self.blocks.last().map(|(_, span)| *span);
            return Err(
                Diagnostic::error(span, "the directive has no end in its file").expected("expected `#end`")
            );
        }
        // Braces may close in another file, but not those that were open before.
        if self.frames.len() < frames {
            let end = Span::new(self.scanner.place(), self.scanner.place());
            return Err(Diagnostic::error(Some(end), "the file closes what it has not opened"));
        }
        let end = self.texts.end_of(place);
        self.scanner.enter(place..end);
        Ok(true)
    }
}
