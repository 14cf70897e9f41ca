//! TextLines, words and numbers of texts that hold particles.

use jbt_model::diagnostic::{Diagnostic, Span};

/// A line, without its end.
#[derive(Clone, Copy)]
pub(super) struct TextLine<'a> {
    pub(super) text: &'a [u8],
    /// The byte at which it begins.
    pub(super) start: usize,
}

/// The lines of a text from a byte on: they end with a line feed, a carriage return, or both.
pub(super) struct TextLines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> TextLines<'a> {
    pub(super) fn from(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The byte that is next.
    pub(super) fn at(&self) -> usize {
        self.at
    }
}

impl<'a> Iterator for TextLines<'a> {
    type Item = TextLine<'a>;

    fn next(&mut self) -> Option<TextLine<'a>> {
        let start = self.at;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let length = end.unwrap_or(rest.len());
        // A number of two characters becomes eight bytes.
        jbt_ir::watch::take(4 * length);
        let is_pair = rest[length..].starts_with(b"\r\n");
        self.at = start + length + if is_pair { 2 } else { usize::from(end.is_some()) };
        Some(TextLine { text: &rest[..length], start })
    }
}

impl<'a> TextLine<'a> {
    /// Where it stands.
    pub(super) fn span(self) -> Span {
        Span::new(self.start, self.start + self.text.len())
    }

    /// Whether there are blanks alone.
    pub(super) fn is_blank(self) -> bool {
        self.text.iter().all(u8::is_ascii_whitespace)
    }

    /// Its words, with blanks between.
    pub(super) fn words(self) -> impl Iterator<Item = TextWord<'a>> {
        let is_blank = |byte: &u8| byte.is_ascii_whitespace();
        let mut at = 0;
        std::iter::from_fn(move || {
            at += self.text[at..].iter().position(|byte| !is_blank(byte))?;
            let length = self.text[at..].iter().position(is_blank).unwrap_or(self.text.len() - at);
            let word = TextWord { text: &self.text[at..][..length], start: self.start + at };
            at += length;
            Some(word)
        })
    }

    /// The columns from one to before another, counted from 0, without blanks around: fewer where it is
    /// short.
    pub(super) fn columns(self, from: usize, to: usize) -> TextWord<'a> {
        let end = to.min(self.text.len());
        let from = from.min(end);
        TextWord { text: &self.text[from..end], start: self.start + from }.trimmed()
    }
}

/// A part of a text.
#[derive(Clone, Copy)]
pub(super) struct TextWord<'a> {
    pub(super) text: &'a [u8],
    /// The byte at which it begins.
    pub(super) start: usize,
}

impl<'a> TextWord<'a> {
    /// Where it stands.
    pub(super) fn span(self) -> Span {
        Span::new(self.start, self.start + self.text.len())
    }

    /// Without the blanks around.
    pub(super) fn trimmed(self) -> Self {
        let text = self.text.trim_ascii_start();
        Self { text: text.trim_ascii_end(), start: self.start + self.text.len() - text.len() }
    }

    /// As text, with a sign where bytes are none.
    pub(super) fn shown(self) -> String {
        jbt_model::report::clip(&String::from_utf8_lossy(self.text))
    }

    /// The number that it is; exponents may have a D, as those of Fortran. Neither infinity nor NaN is one.
    pub(super) fn number(self) -> Option<f64> {
        let text = std::str::from_utf8(self.text).ok()?;
        let parsed = text.parse::<f64>().or_else(|error| match text.find(['d', 'D']) {
            Some(at) => format!("{}e{}", &text[..at], &text[at + 1..]).parse::<f64>(),
            None => Err(error),
        });
        parsed.ok().filter(|number| number.is_finite())
    }

    /// The whole number that it is.
    pub(super) fn whole(self) -> Option<usize> {
        std::str::from_utf8(self.text).ok()?.parse().ok()
    }

    /// The number that it is, or a message that it is none.
    pub(super) fn expect_number(self, what: &str) -> Result<f64, Vec<Diagnostic>> {
        self.number()
            .ok_or_else(|| fault(self.span(), format!("{what} is `{}`", self.shown()), "a finite number"))
    }
}

/// An error at a place.
pub(super) fn fault(span: Span, message: impl Into<String>, expected: &str) -> Vec<Diagnostic> {
    vec![Diagnostic::error(Some(span), message.into()).expected(format!("expected {expected}"))]
}

/// An error at a byte of a file that is no text.
pub(super) fn fault_at(byte: usize, message: &str, expected: &str) -> Vec<Diagnostic> {
    vec![Diagnostic::error(None, format!("byte {byte}: {message}")).expected(format!("expected {expected}"))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_all_ways() {
        let lines: Vec<(usize, &[u8])> =
            TextLines::from(b"a\nb\r\n\rc", 0).map(|line| (line.start, line.text)).collect();
        assert_eq!(lines, [(0, &b"a"[..]), (2, b"b"), (5, b""), (6, b"c")]);
    }

    #[test]
    fn numbers_may_have_the_exponents_of_fortran() {
        let number = |text: &str| TextWord { text: text.as_bytes(), start: 0 }.number();
        assert_eq!(
            [number("1.5D+01"), number("-2d0"), number("3e1"), number(".5")],
            [15.0, -2.0, 30.0, 0.5].map(Some)
        );
        assert_eq!([number("D"), number("nan"), number("inf"), number("1x"), number("")], [None; 5]);
    }

    #[test]
    fn columns_of_a_short_line_are_empty() {
        let line = TextLine { text: b" ab  c", start: 10 };
        let word = line.columns(0, 4);
        assert_eq!((word.text, word.start), (&b"ab"[..], 11));
        assert_eq!(line.columns(5, 99).text, b"c");
        assert_eq!(line.columns(50, 99).text, b"");
    }
}
