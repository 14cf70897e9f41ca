//! Messages about a model, with the place in the text that earns them.
//!
//! ```text
//! hero.jbt:6:5: error: the radius is -1
//!   6 |     point { radius -1 }
//!     |     ^^^^^^^^^^^^^^^^^^^ expected a number of at least 1e-15
//! ```

mod list;

use std::fmt::Write as _;

pub use list::{Diagnostics, IncludedText, SourceText};

/// A range of bytes of a source text.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The first byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The range between two byte offsets of a text of at most [`jbt_ir::limits::MAX_SCENE_BYTES`].
    #[must_use]
    pub const fn new(start: usize, end: usize) -> Self {
        Self { start: start as u32, end: end as u32 }
    }
}

/// How much a diagnostic matters.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    /// The model cannot be used.
    Error,
    /// The model can be used, and is perhaps not what was meant.
    Warning,
    /// The model is larger than a limit allows.
    Limit,
}

impl Severity {
    /// The word for it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Limit => "limit",
        }
    }
}

/// A message about a model.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostic {
    /// How much it matters.
    pub severity: Severity,
    /// Where, if the model came from a text.
    pub span: Option<Span>,
    /// What is wrong, with the numbers in it. Words of the file may stand in it as they are: rendering
    /// escapes them.
    pub message: String,
    /// What was expected instead, or what to do.
    pub help: Option<String>,
    /// How the place came to be read: the calls and loops that it stands in, innermost first.
    pub notes: Vec<Note>,
}

/// A line below a message, with the place that it is about.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Note {
    /// Where, if the model came from a text.
    pub span: Option<Span>,
    /// What is there.
    pub message: String,
}

impl Diagnostic {
    /// An error.
    #[must_use]
    pub fn error(span: Option<Span>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, span, message: message.into(), help: None, notes: Vec::new() }
    }

    /// A limit that was reached.
    #[must_use]
    pub fn limit(span: Option<Span>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Limit, ..Self::error(span, message) }
    }

    /// A warning.
    #[must_use]
    pub fn warning(span: Option<Span>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(span, message) }
    }

    /// The same with what was expected.
    #[must_use]
    pub fn expected(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// A source text and its name, for showing diagnostics.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The file's name, or something like `<stdin>`.
    pub name: &'a str,
    /// The text. Bytes, not characters: a stranger's file need not be UTF-8.
    pub text: &'a [u8],
}

/// The longest excerpt of a line that is shown, in characters.
const EXCERPT: usize = 96;
/// How many bytes tell whether a file is text.
const BEGINNING: usize = 4096;

impl Source<'_> {
    /// Whether it has no lines: its first bytes have control characters that stand in no text, from 1 to 8.
    /// Places in it are counted in bytes, from 0.
    #[must_use]
    pub fn is_binary(&self) -> bool {
        self.text.iter().take(BEGINNING).any(|byte| (1..=8).contains(byte))
    }

    /// Line and column of a byte, counted from 1. The column counts characters; bytes that are not UTF-8
    /// count one each.
    #[must_use]
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let byte = byte.min(self.text.len());
        let line = (0..byte).filter(|&at| self.ends_line(at)).count() + 1;
        (line, characters(&self.text[self.line_start(byte)..byte]) + 1)
    }

    /// Whether a line ends with this byte: a line feed, or a carriage return with none behind it.
    fn ends_line(&self, at: usize) -> bool {
        match self.text[at] {
            b'\n' => true,
            b'\r' => self.text.get(at + 1) != Some(&b'\n'),
            _ => false,
        }
    }

    /// The bytes at which lines begin, in their order.
    #[must_use]
    pub fn line_starts(&self) -> Vec<usize> {
        let ends = (0..self.text.len()).filter(|&at| self.ends_line(at));
        std::iter::once(0).chain(ends.map(|end| end + 1)).collect()
    }

    /// Where the line of a byte begins.
    fn line_start(&self, byte: usize) -> usize {
        (0..byte).rev().find(|&at| self.ends_line(at)).map_or(0, |end| end + 1)
    }

    /// The diagnostic as people read it: place, message, the line, a caret; in a file that is no text, the
    /// byte and the message. Control characters of the file are escaped.
    #[must_use]
    pub fn render(&self, diagnostic: &Diagnostic) -> String {
        self.render_from(1, diagnostic)
    }

    /// As [`render`](Self::render), where the text is a part of a longer one and begins with this line of it,
    /// counted from 1.
    #[must_use]
    pub fn render_from(&self, first_line: u64, diagnostic: &Diagnostic) -> String {
        let mut out = String::new();
        let message = escape(&diagnostic.message);
        let severity = diagnostic.severity.name();
        let Some(span) = diagnostic.span else {
            let _ = write!(out, "{}: {severity}: {message}", escape(self.name));
            if let Some(help) = &diagnostic.help {
                let _ = write!(out, "\n  {}", escape(help));
            }
            self.render_notes(&mut out, first_line, diagnostic);
            return out;
        };
        if self.is_binary() {
            let _ = write!(out, "{}: byte {}: {severity}: {message}", escape(self.name), span.start);
            if let Some(help) = &diagnostic.help {
                let _ = write!(out, "\n  {}", escape(help));
            }
            return out;
        }
        let (line, column) = self.position(span.start as usize);
        let line = first_line + line as u64 - 1;
        let _ = writeln!(out, "{}:{line}:{column}: {severity}: {message}", escape(self.name));
        let (excerpt, before, under) = self.excerpt(span);
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        let _ = writeln!(out, "  {number} | {excerpt}");
        let _ = write!(out, "  {margin} | {}{}", " ".repeat(before), "^".repeat(under.max(1)));
        if let Some(help) = &diagnostic.help {
            let _ = write!(out, " {}", escape(help));
        }
        self.render_notes(&mut out, first_line, diagnostic);
        out
    }

    /// The notes of a diagnostic, each on a line of its own.
    fn render_notes(&self, out: &mut String, first_line: u64, diagnostic: &Diagnostic) {
        for note in &diagnostic.notes {
            let _ = write!(out, "\n  {}", escape(&note.message));
            if let Some(span) = note.span {
                let (line, column) = self.position(span.start as usize);
                let line = first_line + line as u64 - 1;
                let _ = write!(out, " at {}:{line}:{column}", escape(self.name));
            }
        }
    }

    /// The part of the span's line to show, the width of what stands before the span, and the width of the
    /// span.
    fn excerpt(&self, span: Span) -> (String, usize, usize) {
        let start = (span.start as usize).min(self.text.len());
        let end = (span.end as usize).clamp(start, self.text.len());
        let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
        let line_end = self.text[start..].iter().position(is_end).map_or(self.text.len(), |n| start + n);
        let from = self.line_start(start).max(start.saturating_sub(EXCERPT / 2));
        let to = line_end.min(from + EXCERPT);
        let show = |range: &[u8]| escape(&String::from_utf8_lossy(range));
        let before = &self.text[from..start];
        let before = show(before.strip_suffix(b"\r").unwrap_or(before));
        let under = show(&self.text[start..end.clamp(start, to.max(start))]);
        let after = show(&self.text[end.clamp(start, to.max(start))..to.max(start)]);
        (
            format!("{before}{under}{after}").trim_end().to_owned(),
            before.chars().count(),
            under.chars().count(),
        )
    }
}

fn characters(bytes: &[u8]) -> usize {
    String::from_utf8_lossy(bytes).chars().count()
}

/// The text with every control character (terminal escapes, bidirectional overrides) written as `\u{..}`, and
/// tabs as a space.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\t' => out.push(' '),
            c if c.is_control()
                || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}') =>
            {
                let _ = write!(out, "\\u{{{:x}}}", c as u32);
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_caret_and_escapes() {
        let source = Source { name: "a.jbt", text: b"jbt 1\n  radius \x1b[31m0\n" };
        let shown =
            source.render(&Diagnostic::error(Some(Span::new(15, 21)), "bad \x1b[2J").expected("a number"));
        assert_eq!(
            shown,
            "a.jbt:2:10: error: bad \\u{1b}[2J\n  2 |   radius \\u{1b}[31m0\n    |          ^^^^^^^^^^^ a number"
        );
    }

    #[test]
    fn places_in_files_without_lines_are_bytes() {
        let source = Source { name: "a.g", text: b"v\x01\0\n\n5" };
        let shown = source.render(&Diagnostic::error(Some(Span::new(4, 5)), "bad").expected("a number"));
        assert_eq!(shown, "a.g: byte 4: error: bad\n  a number");
        assert!(!Source { name: "a.blob", text: b"[Global]\0\r\n\t\x1b" }.is_binary());
    }

    #[test]
    fn a_part_of_a_text_has_the_lines_of_the_whole() {
        let source = Source { name: "p.csv", text: b"1,nan,3" };
        let shown = source.render_from(1000, &Diagnostic::error(Some(Span::new(2, 5)), "bad"));
        assert_eq!(shown, "p.csv:1000:3: error: bad\n  1000 | 1,nan,3\n       |   ^^^");
    }

    #[test]
    fn lines_end_as_on_any_system() {
        let shown = |text: &str| {
            let start = text.find("bad").unwrap();
            let source = Source { name: "a.jbt", text: text.as_bytes() };
            source.render(&Diagnostic::error(Some(Span::new(start, start + 3)), "m"))
        };
        let expected = "a.jbt:3:4: error: m\n  3 |    bad x\n    |    ^^^";
        for end in ["\n", "\r\n", "\r"] {
            assert_eq!(shown(&["jbt 1", "", "   bad x", "y", ""].join(end)), expected, "{end:?}");
        }
        // An end that is no place of a token, and one that is two.
        let source = Source { name: "a", text: b"x\r\ny\r\rz" };
        assert_eq!(
            [1, 2, 3, 5, 6].map(|byte| source.position(byte)),
            [(1, 2), (1, 3), (2, 1), (3, 1), (4, 1)]
        );
        let last = source.render(&Diagnostic::error(Some(Span::new(2, 9)), "m"));
        assert_eq!(last, "a:1:3: error: m\n  1 | x\n    |  ^");
    }

    #[test]
    fn a_span_past_the_end_is_harmless() {
        let source = Source { name: "a.jbt", text: b"" };
        assert!(
            source.render(&Diagnostic::limit(Some(Span::new(7, 3)), "m")).starts_with("a.jbt:1:1: limit: m")
        );
    }
}
