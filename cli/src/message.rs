//! A message about a file, for people and for machines.

use jbt::diagnostic::{Diagnostic, Severity, Source, SourceText};
use serde_json::{Value, json};

/// A message about a file.
#[derive(Clone, Debug)]
pub struct Message {
    /// How much it matters.
    pub severity: Severity,
    /// For people: place, message, the line, a caret.
    pub rendered: String,
    file: String,
    /// The first byte, from 0.
    byte: Option<u32>,
    /// Lines and columns from 1: those of the first character, and those behind the last. A file that is no
    /// text has none.
    place: Option<[(usize, usize); 2]>,
    message: String,
    hint: Option<String>,
    /// The calls and loops that the place stands in.
    notes: Vec<String>,
}

impl Message {
    /// A diagnostic about a text, or about one that it includes.
    pub fn in_text(text: &SourceText, diagnostic: &Diagnostic) -> Self {
        let (source, located) = text.located(diagnostic);
        Self::new(&source, &located)
    }

    /// A diagnostic about one text.
    fn new(source: &Source<'_>, diagnostic: &Diagnostic) -> Self {
        let Diagnostic { severity, span, message, help, notes } = diagnostic;
        let place = span.map(|span| [span.start, span.end.max(span.start)]);
        Self {
            severity: *severity,
            rendered: source.render(diagnostic),
            file: source.name.to_owned(),
            byte: span.map(|span| span.start),
            place: place
                .filter(|_| !source.is_binary())
                .map(|place| place.map(|byte| source.position(byte as usize))),
            message: message.clone(),
            hint: help.clone(),
            notes: notes.iter().map(|note| note.message.clone()).collect(),
        }
    }

    /// A message whose text says its place.
    pub fn rendered(severity: Severity, file: &str, rendered: String) -> Self {
        Self {
            severity,
            file: file.to_owned(),
            byte: None,
            place: None,
            message: rendered.clone(),
            hint: None,
            notes: Vec::new(),
            rendered,
        }
    }

    /// For machines.
    pub fn json(&self) -> Value {
        let (line, column) = self.place.map(|[start, _]| start).unzip();
        let end = self.place.map(|[_, (line, column)]| json!({ "line": line, "column": column }));
        json!({
            "file": self.file,
            "severity": self.severity.name(),
            "byte": self.byte,
            "line": line,
            "column": column,
            "end": end,
            "message": self.message,
            "hint": self.hint,
            "notes": self.notes,
        })
    }
}
