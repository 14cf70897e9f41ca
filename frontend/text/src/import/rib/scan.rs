//! Tokens of a RIB file, and the arguments of a request.

use jbt_ir::limits::MAX_LIST_NUMBERS;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;

/// What an argument takes beside its values, in numbers.
const ARGUMENT: usize = 8;

/// A part of the file.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum RibToken {
    /// A bare word: a request.
    Word,
    /// A string; its span is what stands between the quotes.
    Text,
    /// A finite number.
    Number(f64),
    /// `[`.
    Open,
    /// `]`.
    Close,
}

/// An argument of a request: an array, or a lone number or string, which may stand for an array of one.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Argument {
    pub(super) values: ArgumentValues,
    pub(super) span: Span,
    /// Whether it stands without brackets.
    pub(super) is_lone: bool,
}

/// The values of an argument.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum ArgumentValues {
    /// Numbers; an empty array is one of them.
    Numbers(Vec<f64>),
    /// Strings, by their places in the file.
    Texts(Vec<Span>),
}

/// The tokens of a file, one after the other.
pub(super) struct RibScanner<'a> {
    bytes: &'a [u8],
    at: usize,
    /// A token that was looked at.
    ahead: Option<(RibToken, Span)>,
}

impl<'a> RibScanner<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, ahead: None }
    }

    /// The bytes of a place, as text.
    pub(super) fn text(&self, span: Span) -> String {
        String::from_utf8_lossy(&self.bytes[span.start as usize..span.end as usize]).into_owned()
    }

    /// The next token, which stays there; `None` at the end.
    fn peek(&mut self) -> Result<Option<(RibToken, Span)>, Diagnostic> {
        if self.ahead.is_none() {
            self.ahead = self.scan()?;
        }
        Ok(self.ahead)
    }

    /// The next token.
    pub(super) fn next(&mut self) -> Result<Option<(RibToken, Span)>, Diagnostic> {
        let next = self.peek()?;
        self.ahead = None;
        Ok(next)
    }

    /// Goes on to the next request, and says how it is called; `None` at the end.
    pub(super) fn request(&mut self) -> Result<Option<Span>, Diagnostic> {
        while let Some((token, span)) = self.next()? {
            if token == RibToken::Word {
                return Ok(Some(span));
            }
        }
        Ok(None)
    }

    /// The arguments up to the next request.
    pub(super) fn arguments(&mut self) -> Result<Vec<Argument>, Diagnostic> {
        let mut all = Vec::new();
        let mut room = MAX_LIST_NUMBERS;
        while let Some((token, span)) = self.peek()?.filter(|(token, _)| *token != RibToken::Word) {
            self.ahead = None;
            let lone = |values| Argument { values, span, is_lone: true };
            all.push(match token {
                RibToken::Number(number) => lone(ArgumentValues::Numbers(vec![number])),
                RibToken::Text => lone(ArgumentValues::Texts(vec![span])),
                RibToken::Open => self.array(span, &mut room)?,
                RibToken::Close => return Err(Diagnostic::error(Some(span), "no array is open here")),
                RibToken::Word => unreachable!("words end the arguments"),
            });
            room = room.checked_sub(ARGUMENT).ok_or_else(|| too_many(span))?;
        }
        Ok(all)
    }

    /// An array, whose bracket has been read.
    fn array(&mut self, open: Span, room: &mut usize) -> Result<Argument, Diagnostic> {
        let (mut numbers, mut texts) = (Vec::new(), Vec::new());
        loop {
            let Some((token, span)) = self.next()? else {
                return Err(Diagnostic::error(Some(open), "the array is not closed").expected("expected `]`"));
            };
            match token {
                RibToken::Number(number) => numbers.push(number),
                RibToken::Text => texts.push(span),
                RibToken::Close => {
                    let span = Span { start: open.start, end: span.end };
                    let values = match (numbers.is_empty(), texts.is_empty()) {
                        (_, true) => ArgumentValues::Numbers(numbers),
                        (true, false) => ArgumentValues::Texts(texts),
                        (false, false) => {
                            let message = "the array has numbers and strings";
                            return Err(Diagnostic::error(Some(span), message));
                        }
                    };
                    return Ok(Argument { values, span, is_lone: false });
                }
                RibToken::Open | RibToken::Word => {
                    let error = Diagnostic::error(Some(span), "this stands in an array");
                    return Err(error.expected("expected numbers or strings, then `]`"));
                }
            }
            *room = room.checked_sub(1).ok_or_else(|| too_many(open))?;
        }
    }

    /// The token at the present place, after blanks and comments.
    fn scan(&mut self) -> Result<Option<(RibToken, Span)>, Diagnostic> {
        let first = loop {
            match self.bytes.get(self.at) {
                None => return Ok(None),
                Some(b'#') => self.skip(|byte| !matches!(byte, b'\n' | b'\r')),
                Some(byte) if byte.is_ascii_whitespace() || *byte == 0 => self.at += 1,
                Some(&byte) => break byte,
            }
        };
        let start = self.at;
        let span = |end| Span::new(start, end);
        match first {
            b'[' | b']' => {
                self.at += 1;
                let token = if first == b'[' { RibToken::Open } else { RibToken::Close };
                Ok(Some((token, span(self.at))))
            }
            b'"' => self.string(start).map(Some),
            _ => {
                self.skip(|byte| {
                    !byte.is_ascii_whitespace() && !matches!(byte, b'"' | b'[' | b']' | b'#' | 0)
                });
                let span = span(self.at);
                if !matches!(first, b'0'..=b'9' | b'+' | b'-' | b'.') {
                    return Ok(Some((RibToken::Word, span)));
                }
                let word = std::str::from_utf8(&self.bytes[start..self.at]).ok();
                let number = word.and_then(|word| word.parse::<f64>().ok()).filter(|x| x.is_finite());
                let error = || {
                    let message = format!("`{}` is no finite number", clip(&self.text(span)));
                    Diagnostic::error(Some(span), message)
                };
                Ok(Some((RibToken::Number(number.ok_or_else(error)?), span)))
            }
        }
    }

    /// A string, at its first quote.
    fn string(&mut self, start: usize) -> Result<(RibToken, Span), Diagnostic> {
        self.at += 1;
        loop {
            self.skip(|byte| !matches!(byte, b'"' | b'\\'));
            match self.bytes.get(self.at) {
                Some(b'"') => {
                    self.at += 1;
                    return Ok((RibToken::Text, Span::new(start + 1, self.at - 1)));
                }
                Some(_) => self.at = (self.at + 2).min(self.bytes.len()),
                None => {
                    let span = Span::new(start, start + 1);
                    return Err(Diagnostic::error(Some(span), "the string is not closed"));
                }
            }
        }
    }

    fn skip(&mut self, stays: impl Fn(u8) -> bool) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|&byte| !stays(byte)).unwrap_or(rest.len());
    }
}

fn too_many(span: Span) -> Diagnostic {
    let message = format!("the request has more than {MAX_LIST_NUMBERS} numbers and strings");
    Diagnostic::limit(Some(span), message)
}
