//! JSON (RFC 8259) with places: values of a text in the order in which they stand, each with the place behind
//! its last part. Reading keeps a list of what is open, and nothing recurses.
//!
//! ```text
//! {"a": [1, 2]}      0 object, up to 5     1 key     2 array, up to 5     3 number     4 number
//! ```

use jbt_ir::limits::{MAX_BLOCK_DEPTH, MAX_NODES};
use jbt_model::diagnostic::{Diagnostic, Span};

/// What a value is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum JsonKind {
    Object,
    Array,
    /// The name of the member behind it.
    Key,
    Text,
    Number,
    /// `true`, `false` or `null`.
    Word,
}

#[derive(Clone, Copy)]
struct JsonItem {
    kind: JsonKind,
    span: Span,
    /// The place in the list behind the value.
    end: u32,
}

/// A text that has been read.
pub(super) struct Json<'a> {
    bytes: &'a [u8],
    items: Vec<JsonItem>,
}

/// A value: its place in the list.
pub(super) type JsonValue = u32;

impl<'a> Json<'a> {
    /// Reads a text.
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, Diagnostic> {
        let start = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut reader = JsonReader { bytes, at: start, items: Vec::new(), open: Vec::new() };
        reader.document()?;
        Ok(Self { bytes, items: reader.items })
    }

    fn item(&self, value: JsonValue) -> JsonItem {
        self.items[value as usize]
    }

    pub(super) fn kind(&self, value: JsonValue) -> JsonKind {
        self.item(value).kind
    }

    pub(super) fn span(&self, value: JsonValue) -> Span {
        self.item(value).span
    }

    /// The text of a string or key as it stands in the file, without quotes. None of the words that are
    /// looked for has an escape.
    pub(super) fn text(&self, value: JsonValue) -> &'a str {
        let Span { start, end } = self.span(value);
        std::str::from_utf8(&self.bytes[start as usize + 1..end as usize - 1]).unwrap_or("?")
    }

    /// A number; one beyond all f64 is infinite.
    pub(super) fn number(&self, value: JsonValue) -> Option<f64> {
        let JsonItem { kind, span, .. } = self.item(value);
        let word = std::str::from_utf8(&self.bytes[span.start as usize..span.end as usize]).ok()?;
        if kind == JsonKind::Number { word.parse().ok() } else { None }
    }

    /// Whether any member of this name is a number other than 0.
    pub(super) fn has_number(&self, name: &str) -> bool {
        let keys = (0..self.items.len() as u32).filter(|&at| self.kind(at) == JsonKind::Key);
        keys.filter(|&key| self.text(key) == name)
            .any(|key| self.number(key + 1).is_some_and(|number| number != 0.0))
    }

    /// The members of an object, names and values; or none.
    pub(super) fn members(&self, object: JsonValue) -> impl Iterator<Item = (JsonValue, JsonValue)> {
        let JsonItem { kind, end, .. } = self.item(object);
        let mut at = if kind == JsonKind::Object { object + 1 } else { end };
        std::iter::from_fn(move || {
            let key = at;
            (key < end).then(|| {
                at = self.item(key + 1).end;
                (key, key + 1)
            })
        })
    }

    /// The member of a name; of several, the last one.
    pub(super) fn member(&self, object: JsonValue, name: &str) -> Option<JsonValue> {
        self.members(object).filter(|&(key, _)| self.text(key) == name).last().map(|(_, value)| value)
    }

    /// The values of an array; or none.
    pub(super) fn values(&self, array: JsonValue) -> impl Iterator<Item = JsonValue> {
        let JsonItem { kind, end, .. } = self.item(array);
        let mut at = if kind == JsonKind::Array { array + 1 } else { end };
        std::iter::from_fn(move || {
            let value = at;
            (value < end).then(|| {
                at = self.item(value).end;
                value
            })
        })
    }
}

struct JsonReader<'a> {
    bytes: &'a [u8],
    at: usize,
    items: Vec<JsonItem>,
    /// Objects and arrays that are not closed.
    open: Vec<u32>,
}

impl JsonReader<'_> {
    fn document(&mut self) -> Result<(), Diagnostic> {
        loop {
            self.value()?;
            // Behind a value: the end of what is open, or what follows.
            loop {
                let Some(&open) = self.open.last() else {
                    return if self.peek().is_none() {
                        Ok(())
                    } else {
                        self.unexpected("the end of the file")
                    };
                };
                let is_object = self.items[open as usize].kind == JsonKind::Object;
                let is_empty = self.items.len() == open as usize + 1;
                match self.peek() {
                    Some(b'}') if is_object => self.close(),
                    Some(b']') if !is_object => self.close(),
                    Some(b',') if !is_empty => {
                        self.at += 1;
                        self.peek();
                        if is_object {
                            self.key()?;
                        }
                        break;
                    }
                    _ if is_empty => {
                        if is_object {
                            self.key()?;
                        }
                        break;
                    }
                    _ => return self.unexpected(if is_object { "`,` or `}`" } else { "`,` or `]`" }),
                }
            }
        }
    }

    /// The next byte that is no blank.
    fn peek(&mut self) -> Option<u8> {
        while matches!(self.bytes.get(self.at), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
        self.bytes.get(self.at).copied()
    }

    fn unexpected<T>(&mut self, expected: &str) -> Result<T, Diagnostic> {
        let found = self.peek();
        let span = Span::new(self.at, (self.at + 1).min(self.bytes.len()));
        let message = if found.is_some() { "this is no JSON" } else { "the file ends here" };
        Err(Diagnostic::error(Some(span), message).expected(format!("expected {expected}")))
    }

    fn push(&mut self, kind: JsonKind, start: usize) -> Result<(), Diagnostic> {
        if self.items.len() == MAX_NODES {
            let span = Span::new(start, self.at);
            return Err(Diagnostic::limit(Some(span), format!("more than {MAX_NODES} values")));
        }
        let end = self.items.len() as u32 + 1;
        self.items.push(JsonItem { kind, span: Span::new(start, self.at), end });
        Ok(())
    }

    fn close(&mut self) {
        self.at += 1;
        let end = self.items.len() as u32;
        if let Some(open) = self.open.pop() {
            let item = &mut self.items[open as usize];
            item.end = end;
            item.span.end = self.at as u32;
        }
    }

    /// A value, or the beginning of one.
    fn value(&mut self) -> Result<(), Diagnostic> {
        let first = self.peek();
        let start = self.at;
        match first {
            Some(b'{' | b'[') => {
                if self.open.len() == MAX_BLOCK_DEPTH {
                    let message = format!("more than {MAX_BLOCK_DEPTH} values within each other");
                    return Err(Diagnostic::limit(Some(Span::new(start, start + 1)), message));
                }
                self.at += 1;
                let kind = if first == Some(b'{') { JsonKind::Object } else { JsonKind::Array };
                self.open.push(self.items.len() as u32);
                self.push(kind, start)
            }
            Some(b'"') => {
                self.string()?;
                self.push(JsonKind::Text, start)
            }
            Some(b'-' | b'0'..=b'9') => {
                self.digits()?;
                self.push(JsonKind::Number, start)
            }
            Some(b't' | b'f' | b'n') => {
                let rest = &self.bytes[start..];
                let Some(word) =
                    [&b"true"[..], b"false", b"null"].into_iter().find(|word| rest.starts_with(word))
                else {
                    return self.unexpected("a value");
                };
                self.at += word.len();
                self.push(JsonKind::Word, start)
            }
            _ => self.unexpected("a value"),
        }
    }

    /// A member's name and its colon.
    fn key(&mut self) -> Result<(), Diagnostic> {
        if self.peek() != Some(b'"') {
            return self.unexpected("a name in quotes");
        }
        let start = self.at;
        self.string()?;
        self.push(JsonKind::Key, start)?;
        if self.peek() != Some(b':') {
            return self.unexpected("`:`");
        }
        self.at += 1;
        Ok(())
    }

    /// A string, at its first quote.
    fn string(&mut self) -> Result<(), Diagnostic> {
        let start = self.at;
        self.at += 1;
        loop {
            match self.bytes.get(self.at) {
                Some(b'"') => {
                    self.at += 1;
                    break;
                }
                Some(b'\\') => self.at += 2,
                Some(0..0x20) | None => {
                    let span = Span::new(start, start + 1);
                    return Err(Diagnostic::error(Some(span), "the string is not closed in its line"));
                }
                Some(_) => self.at += 1,
            }
        }
        if std::str::from_utf8(&self.bytes[start..self.at]).is_err() {
            let span = Span::new(start, self.at);
            return Err(Diagnostic::error(Some(span), "the string is not UTF-8"));
        }
        Ok(())
    }

    /// A number: no plus, no zero in front, digits on both sides of a point.
    fn digits(&mut self) -> Result<(), Diagnostic> {
        self.at += usize::from(self.bytes[self.at] == b'-');
        let leading = self.bytes.get(self.at).copied();
        let count = self.run();
        if count == 0 || (leading == Some(b'0') && count > 1) {
            return self.unexpected("a number");
        }
        if self.bytes.get(self.at) == Some(&b'.') {
            self.at += 1;
            if self.run() == 0 {
                return self.unexpected("a digit");
            }
        }
        if matches!(self.bytes.get(self.at), Some(b'e' | b'E')) {
            self.at += 1;
            self.at += usize::from(matches!(self.bytes.get(self.at), Some(b'+' | b'-')));
            if self.run() == 0 {
                return self.unexpected("a digit");
            }
        }
        Ok(())
    }

    /// Goes over digits.
    fn run(&mut self) -> usize {
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_digit) {
            self.at += 1;
        }
        self.at - start
    }
}
