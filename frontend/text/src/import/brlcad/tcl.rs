//! Lists of Tcl: words between blanks, in braces or in quotes.
//!
//! ```text
//! put {rim.s} tor V {0 0 9} r_a 11 \        a brace may run over lines; a backslash continues one
//!     r_h 3                                 this command has ten words
//! ```

use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;

/// Words of a part of a text.
#[derive(Clone, Copy)]
pub(super) struct Words<'a> {
    text: &'a [u8],
    at: usize,
    end: usize,
    /// Whether a line feed or a semicolon ends the list, as that of a command.
    is_command: bool,
}

/// A word that has no end: where it begins.
pub(super) struct Unclosed(pub(super) Span);

impl<'a> Words<'a> {
    /// The commands of a text.
    pub(super) fn commands(text: &'a [u8]) -> Self {
        Self { text, at: 0, end: text.len(), is_command: true }
    }

    /// The words of a list.
    pub(super) fn list(text: &'a [u8], span: Span) -> Self {
        Self { text, at: span.start as usize, end: span.end as usize, is_command: false }
    }

    fn peek(&self, ahead: usize) -> Option<u8> {
        self.text[..self.end].get(self.at + ahead).copied()
    }

    fn ends_command(&self, byte: u8) -> bool {
        self.is_command && matches!(byte, b'\n' | b'\r' | b';')
    }

    /// Goes to the next command. False at the end of the text.
    pub(super) fn next_command(&mut self) -> bool {
        while let Some(byte) = self.peek(0) {
            if byte == b'#' {
                while self.peek(0).is_some_and(|byte| !matches!(byte, b'\n' | b'\r')) {
                    self.at += 1;
                }
            } else if byte.is_ascii_whitespace() || matches!(byte, b';' | 0) {
                self.at += 1;
            } else {
                return true;
            }
        }
        false
    }

    /// The next word without its braces or quotes; `None` at the end of the list.
    pub(super) fn next(&mut self) -> Result<Option<Span>, Unclosed> {
        loop {
            match self.peek(0) {
                None => return Ok(None),
                Some(byte) if self.ends_command(byte) => return Ok(None),
                Some(b'\\') if matches!(self.peek(1), Some(b'\n' | b'\r')) => self.at += 2,
                Some(byte) if byte.is_ascii_whitespace() || byte == 0 => self.at += 1,
                Some(b'{') => return self.braced().map(Some),
                Some(b'"') => return self.quoted().map(Some),
                Some(_) => return Ok(Some(self.bare())),
            }
        }
    }

    fn braced(&mut self) -> Result<Span, Unclosed> {
        let start = self.at;
        let mut depth = 0usize;
        while let Some(byte) = self.peek(0) {
            match byte {
                b'\\' => self.at += 1,
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            self.at += 1;
            if depth == 0 {
                return Ok(Span::new(start + 1, self.at - 1));
            }
        }
        Err(Unclosed(Span::new(start, start + 1)))
    }

    fn quoted(&mut self) -> Result<Span, Unclosed> {
        let start = self.at;
        self.at += 1;
        while let Some(byte) = self.peek(0) {
            self.at += 1 + usize::from(byte == b'\\');
            if byte == b'"' {
                return Ok(Span::new(start + 1, self.at - 1));
            }
        }
        Err(Unclosed(Span::new(start, start + 1)))
    }

    fn bare(&mut self) -> Span {
        let start = self.at;
        while let Some(byte) = self.peek(0) {
            if byte.is_ascii_whitespace() || byte == 0 || self.ends_command(byte) {
                break;
            }
            self.at += 1;
        }
        Span::new(start, self.at)
    }

    /// Goes to the end of the command.
    pub(super) fn skip_command(&mut self) {
        while let Ok(Some(_)) = self.next() {}
    }

    /// The place of the next byte.
    pub(super) fn at(&self) -> usize {
        self.at
    }
}

/// An error about a word that has no end.
pub(super) fn unclosed(word: &Unclosed) -> Diagnostic {
    Diagnostic::error(Some(word.0), "this has no end")
        .expected("expected `}` or `\"` before the end of the file")
}

/// A part of the text, for messages.
pub(super) fn shown(bytes: &[u8], span: Span) -> String {
    clip(&String::from_utf8_lossy(&bytes[span.start as usize..span.end as usize]))
}

/// The numbers of a list.
pub(super) fn numbers(bytes: &[u8], list: Span) -> Result<Vec<f64>, Diagnostic> {
    let mut numbers = Vec::new();
    let mut words = Words::list(bytes, list);
    while let Some(word) = words.next().map_err(|word| unclosed(&word))? {
        numbers.push(number(bytes, word)?);
    }
    Ok(numbers)
}

/// A finite number.
pub(super) fn number(bytes: &[u8], word: Span) -> Result<f64, Diagnostic> {
    let text = std::str::from_utf8(&bytes[word.start as usize..word.end as usize]);
    let number = text.ok().and_then(|text| text.parse::<f64>().ok()).filter(|number| number.is_finite());
    number.ok_or_else(|| {
        Diagnostic::error(Some(word), format!("`{}` is no finite number", shown(bytes, word)))
            .expected("expected a number")
    })
}
