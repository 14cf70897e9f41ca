//! All that is wrong with a model, as an error that shows the places.

use std::error::Error;
use std::fmt;
use std::io;
use std::ops::Deref;
use std::sync::Arc;

use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_ir::memory::NoMemory;

use super::{Diagnostic, Note, Source, Span, escape};

/// A source text and its name, kept for messages. Cloning shares both.
#[derive(Clone)]
pub struct SourceText {
    name: Arc<str>,
    text: Arc<[u8]>,
    included: Arc<[IncludedText]>,
}

/// A text that another one includes. Its places are bytes behind those of the texts before it.
#[derive(Clone, Debug)]
pub struct IncludedText {
    /// The path of its file.
    pub name: Arc<str>,
    /// Its bytes.
    pub text: Arc<[u8]>,
    /// The place of its first byte.
    pub start: usize,
}

impl SourceText {
    /// What a text is called that has no name.
    pub const UNNAMED: &'static str = "<text>";

    /// A text, copied, with the name of its file or something like `<stdin>`. More than [`MAX_SCENE_BYTES`]
    /// are not kept, as nobody reads them.
    #[must_use]
    pub fn new(name: &str, text: &[u8]) -> Self {
        let text = text[..text.len().min(MAX_SCENE_BYTES)].into();
        Self { name: name.into(), text, included: Arc::default() }
    }

    /// The same with the texts that it includes, in the order of their places.
    #[must_use]
    pub fn including(self, texts: Vec<IncludedText>) -> Self {
        Self { included: texts.into(), ..self }
    }

    /// The texts that it includes, directly or not.
    #[must_use]
    pub fn included(&self) -> &[IncludedText] {
        &self.included
    }

    /// The text that a place is in, and the place of that text's first byte.
    #[must_use]
    pub fn text_at(&self, byte: usize) -> (Source<'_>, usize) {
        let index = self.included.partition_point(|text| text.start <= byte);
        match index.checked_sub(1).map(|index| &self.included[index]) {
            Some(text) => (Source { name: &text.name, text: &text.text }, text.start),
            None => (self.source(), 0),
        }
    }

    /// A diagnostic with its place in the one text that it is in, and the places of its notes as words.
    #[must_use]
    pub fn located(&self, diagnostic: &Diagnostic) -> (Source<'_>, Diagnostic) {
        let start = diagnostic.span.map_or(0, |span| span.start as usize);
        let (source, base) = self.text_at(start);
        let moved = |span: Span| Span::new(span.start as usize - base, (span.end as usize).max(base) - base);
        let notes = diagnostic.notes.iter().map(|note| {
            let Some(span) = note.span else { return note.clone() };
            let (source, base) = self.text_at(span.start as usize);
            let (line, column) = source.position(span.start as usize - base);
            let message = format!("{} at {}:{line}:{column}", note.message, source.name);
            Note { span: None, message }
        });
        let (span, notes) = (diagnostic.span.map(moved), notes.collect());
        (source, Diagnostic { span, notes, ..diagnostic.clone() })
    }

    /// The diagnostic as people read it: see [`Source::render`].
    #[must_use]
    pub fn render(&self, diagnostic: &Diagnostic) -> String {
        let (source, located) = self.located(diagnostic);
        source.render(&located)
    }

    /// The same text under another name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its bytes.
    #[must_use]
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// What shows diagnostics about the text itself, not about those that it includes.
    #[must_use]
    pub fn source(&self) -> Source<'_> {
        Source { name: &self.name, text: &self.text }
    }
}

impl fmt::Debug for SourceText {
    /// Its name and its length.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {} bytes", self.name, self.text.len())
    }
}

/// All that is wrong with a model or its file: the one error of reading, checking and setting parameters.
///
/// It is a list of [`Diagnostic`]s, by [`Deref`] and by iteration. As text it is what people read, with the
/// line of each place and a caret, where the
/// model came from a text. So is its `Debug`, which a `main` that returns an error prints.
///
/// ```
/// use jbt_text::{Options, parse};
/// let model = parse(b"jbt 1\npoint {\n  radius -2\n}", &Options::default())?;
/// let error = model.check().unwrap_err();
/// assert_eq!(error[0].message, "the radius is -2");
/// let shown = error.to_string();
/// let lines: Vec<&str> = shown.lines().collect();
/// assert_eq!(lines[0], "<text>:2:1: error: the radius is -2");
/// assert_eq!(lines[1], "  2 | point {");
/// assert!(lines[2].starts_with("    | ^"));
/// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
/// ```
#[derive(Clone, Default)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    source: Option<SourceText>,
    cause: Option<Arc<io::Error>>,
}

impl From<NoMemory> for Diagnostics {
    fn from(error: NoMemory) -> Self {
        vec![Diagnostic::limit(None, error.to_string())].into()
    }
}

impl Diagnostics {
    /// Messages about a text, or about a model that came from none.
    #[must_use]
    pub fn new(list: Vec<Diagnostic>, source: Option<SourceText>) -> Self {
        Self { list, source, cause: None }
    }

    /// A file of this name could not be read.
    #[must_use]
    pub fn unreadable(name: &str, cause: io::Error) -> Self {
        let list = vec![Diagnostic::error(None, format!("cannot read {name}: {cause}"))];
        Self { list, source: None, cause: Some(Arc::new(cause)) }
    }

    /// The same about a text of another name; without a text nothing changes.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { source: self.source.map(|source| source.named(name)), ..self }
    }

    /// All messages, in the order of their places.
    #[must_use]
    pub fn list(&self) -> &[Diagnostic] {
        &self.list
    }

    /// All messages, in the order of their places.
    #[must_use]
    pub fn into_list(self) -> Vec<Diagnostic> {
        self.list
    }

    /// The text that the places are in.
    #[must_use]
    pub fn source_text(&self) -> Option<&SourceText> {
        self.source.as_ref()
    }

    /// Why a file could not be read, if that is what is wrong.
    #[must_use]
    pub fn io(&self) -> Option<&io::Error> {
        self.cause.as_deref()
    }

    fn show(&self, diagnostic: &Diagnostic) -> String {
        if let Some(source) = &self.source {
            return source.render(diagnostic);
        }
        let notes = diagnostic.notes.iter().map(|note| &note.message);
        let below = diagnostic.help.iter().chain(notes).map(|line| format!("\n  {}", escape(line)));
        let mut shown = format!("{}: {}", diagnostic.severity.name(), escape(&diagnostic.message));
        shown.extend(below);
        shown
    }
}

impl fmt::Display for Diagnostics {
    /// Each message with its place; the next one begins on a new line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.list.iter().enumerate() {
            write!(f, "{}{}", if index == 0 { "" } else { "\n" }, self.show(diagnostic))?;
        }
        Ok(())
    }
}

impl fmt::Debug for Diagnostics {
    /// As [`Display`](fmt::Display).
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for Diagnostics {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as &(dyn Error + 'static))
    }
}

impl Deref for Diagnostics {
    type Target = [Diagnostic];

    fn deref(&self) -> &[Diagnostic] {
        &self.list
    }
}

impl From<Vec<Diagnostic>> for Diagnostics {
    fn from(list: Vec<Diagnostic>) -> Self {
        Self::new(list, None)
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.list.into_iter()
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

impl PartialEq for Diagnostics {
    /// The same messages about the same places; texts and their names do not matter.
    fn eq(&self, other: &Self) -> bool {
        self.list == other.list
    }
}

impl Eq for Diagnostics {}
