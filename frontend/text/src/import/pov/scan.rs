//! Tokens of a POV-Ray scene, found where they are asked for: loops go back in the text.

use std::ops::Range;

use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;

/// A part of the text.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum PovToken {
    /// A name or a word of the language.
    Word,
    /// A number, which may be infinite: the user of it says what is wrong.
    Number(f64),
    /// A string.
    Text,
    /// A mark of one byte.
    Mark(u8),
    /// `<=`.
    AtMost,
    /// `>=`.
    AtLeast,
    /// `!=`.
    Unequal,
    /// The end of the text.
    End,
}

/// The text, and a place in it.
pub(super) struct PovScanner<'a> {
    /// All texts.
    all: &'a [u8],
    /// Up to the end of this one.
    bytes: &'a [u8],
    /// Where this one begins.
    start: usize,
    at: usize,
    /// The token at the place, and the place behind it, if it was looked at.
    ahead: Option<(PovToken, Span, usize)>,
}

impl<'a> PovScanner<'a> {
    /// One of several texts.
    pub(super) fn of(all: &'a [u8], text: Range<usize>) -> Self {
        Self { all, bytes: &all[..text.end], start: text.start, at: text.start, ahead: None }
    }

    /// Goes on with another text.
    pub(super) fn enter(&mut self, text: Range<usize>) {
        *self = Self::of(self.all, text);
    }

    /// The place where the next token is looked for.
    pub(super) fn place(&self) -> usize {
        self.at
    }

    /// Goes to a place that [`place`](Self::place) gave.
    pub(super) fn go(&mut self, place: usize) {
        self.at = place;
        self.ahead = None;
    }

    /// Whether bytes stand between two places.
    pub(super) fn holds(&self, from: usize, to: usize, bytes: &[u8]) -> bool {
        self.all[from..to].windows(bytes.len()).any(|window| window == bytes)
    }

    /// The bytes of a span as a word; what is no text is no word of the language either.
    pub(super) fn word(&self, span: Span) -> &'a str {
        std::str::from_utf8(&self.all[span.start as usize..span.end as usize]).unwrap_or("?")
    }

    /// A span for a message.
    pub(super) fn shown(&self, span: Span) -> String {
        clip(&String::from_utf8_lossy(&self.all[span.start as usize..span.end as usize]))
    }

    /// The next token, which stays there.
    pub(super) fn peek(&mut self) -> Result<(PovToken, Span), Diagnostic> {
        if self.ahead.is_none() {
            let (token, span) = self.scan()?;
            self.ahead = Some((token, span, span.end as usize + usize::from(token == PovToken::Text)));
        }
        Ok(self.ahead.map_or((PovToken::End, Span::new(self.at, self.at)), |(token, span, _)| (token, span)))
    }

    /// The next token.
    pub(super) fn next(&mut self) -> Result<(PovToken, Span), Diagnostic> {
        let (token, span) = self.peek()?;
        if let Some((_, _, behind)) = self.ahead.take() {
            self.at = behind;
        }
        Ok((token, span))
    }

    /// Takes a mark, if it is the next token.
    pub(super) fn accept(&mut self, mark: u8) -> Result<bool, Diagnostic> {
        let found = self.peek()?.0 == PovToken::Mark(mark);
        if found {
            self.next()?;
        }
        Ok(found)
    }

    /// Takes a mark that has to be there.
    pub(super) fn expect(&mut self, mark: u8) -> Result<Span, Diagnostic> {
        let (token, span) = self.next()?;
        if token == PovToken::Mark(mark) {
            return Ok(span);
        }
        Err(self.unexpected(token, span).expected(format!("expected `{}`", char::from(mark))))
    }

    /// Takes a word that has to be there.
    pub(super) fn expect_word(&mut self, what: &str) -> Result<(&'a str, Span), Diagnostic> {
        let (token, span) = self.next()?;
        if token == PovToken::Word {
            return Ok((self.word(span), span));
        }
        Err(self.unexpected(token, span).expected(format!("expected {what}")))
    }

    /// The next token, if it is a word.
    pub(super) fn peek_word(&mut self) -> Result<Option<&'a str>, Diagnostic> {
        let (token, span) = self.peek()?;
        Ok((token == PovToken::Word).then(|| self.word(span)))
    }

    /// The error about a token.
    pub(super) fn unexpected(&self, token: PovToken, span: Span) -> Diagnostic {
        let message = match token {
            PovToken::End => "the file ends here".to_owned(),
            PovToken::Mark(b'#') => "a directive within something that has to be complete".to_owned(),
            _ => format!("unexpected `{}`", self.shown(span)),
        };
        Diagnostic::error(Some(span), message)
    }

    fn byte(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    fn scan(&mut self) -> Result<(PovToken, Span), Diagnostic> {
        self.skip_blanks()?;
        let start = self.at;
        let Some(&first) = self.bytes.get(start) else {
            return Ok((PovToken::End, Span::new(start, start)));
        };
        let rest = &self.bytes[start..];
        let length = |stays: fn(u8) -> bool| rest.iter().position(|&b| !stays(b)).unwrap_or(rest.len());
        let of = |token, length| Ok((token, Span::new(start, start + length)));
        match first {
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                of(PovToken::Word, length(|byte| byte.is_ascii_alphanumeric() || byte == b'_'))
            }
            b'0'..=b'9' => self.number(start),
            b'.' if self.byte(1).is_ascii_digit() => self.number(start),
            b'"' => self.string(start),
            b'<' if self.byte(1) == b'=' => of(PovToken::AtMost, 2),
            b'>' if self.byte(1) == b'=' => of(PovToken::AtLeast, 2),
            b'!' if self.byte(1) == b'=' => of(PovToken::Unequal, 2),
            0x21..=0x7e => of(PovToken::Mark(first), 1),
            _ => {
                let message = "this is no text of a scene";
                Err(Diagnostic::error(Some(Span::new(start, start + 1)), message))
            }
        }
    }

    fn number(&self, start: usize) -> Result<(PovToken, Span), Diagnostic> {
        let digits = |mut at: usize| {
            while self.bytes.get(at).is_some_and(u8::is_ascii_digit) {
                at += 1;
            }
            at
        };
        let mut end = digits(start);
        if self.bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(self.bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(self.bytes.get(end + 1), Some(b'+' | b'-')));
            if self.bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
                end = digits(end + 1 + sign);
            }
        }
        let span = Span::new(start, end);
        let number = self
            .word(span)
            .parse()
            .map_err(|_| Diagnostic::error(Some(span), format!("`{}` is no number", self.shown(span))))?;
        Ok((PovToken::Number(number), span))
    }

    fn string(&self, start: usize) -> Result<(PovToken, Span), Diagnostic> {
        let mut at = start + 1;
        loop {
            match self.bytes.get(at) {
                Some(b'"') => return Ok((PovToken::Text, Span::new(start + 1, at))),
                Some(b'\\') => at += 2,
                Some(_) => at += 1,
                None => {
                    let span = Span::new(start, start + 1);
                    return Err(Diagnostic::error(Some(span), "the string is not closed"));
                }
            }
        }
    }

    /// Goes over blanks and comments; those with stars may stand within each other.
    fn skip_blanks(&mut self) -> Result<(), Diagnostic> {
        loop {
            match (self.byte(0), self.byte(1)) {
                (b'/', b'/') => {
                    let rest = &self.bytes[self.at..];
                    self.at += rest.iter().position(|&b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
                }
                (b'/', b'*') => self.skip_comment()?,
                (byte, _) if byte.is_ascii_whitespace() => self.at += 1,
                (0 | 0x1a, _) if self.at < self.bytes.len() => self.at += 1,
                // The mark of UTF-8.
                (0xef, 0xbb) if self.at == self.start => self.at = (self.start + 3).min(self.bytes.len()),
                _ => return Ok(()),
            }
        }
    }

    fn skip_comment(&mut self) -> Result<(), Diagnostic> {
        let start = self.at;
        let mut depth = 0usize;
        while self.at < self.bytes.len() {
            let step = match (self.byte(0), self.byte(1)) {
                (b'/', b'*') => {
                    depth += 1;
                    2
                }
                // The first two bytes open a comment, so one is open here.
                (b'*', b'/') => {
                    depth -= 1;
                    2
                }
                _ => 1,
            };
            self.at += step;
            if depth == 0 {
                return Ok(());
            }
        }
        self.at = self.bytes.len();
        Err(Diagnostic::error(Some(Span::new(start, start + 2)), "the comment is not closed"))
    }
}
