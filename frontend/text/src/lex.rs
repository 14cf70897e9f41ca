//! Bytes to tokens, one at a time: a file is never a list of tokens in memory.

use jbt_model::diagnostic::Span;
use jbt_model::word::{begins_name, continues_name};

/// The kind of a token.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum TokenKind {
    /// A name or a keyword: a letter of any script, then letters, digits and underscores.
    Word,
    /// An unsigned decimal number.
    Number,
    /// One of `{ } ( ) [ ] , = : + - * / ^`, or [`RANGE`] or [`COMPARISON`].
    Mark(u8),
    /// Text in double quotes, all on one line.
    Quoted,
    /// Bytes that begin no token.
    Unknown,
    /// The end of the text.
    End,
}

/// The mark of two points, between the ends of a range.
pub(super) const RANGE: u8 = b'.';

/// The mark of `<`, `<=`, `>`, `>=`, `==` and `!=`.
pub(super) const COMPARISON: u8 = b'<';

/// A token and where it stands, among all texts that are read together.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Token {
    /// Where it stands.
    pub(super) fn span(self) -> Span {
        Span::new(self.start, self.end)
    }

    /// Whether it is this mark.
    pub(super) fn is(self, mark: u8) -> bool {
        self.kind == TokenKind::Mark(mark)
    }
}

/// A place to which a cursor can go back.
#[derive(Clone, Copy)]
pub(super) struct TextPlace<'a> {
    text: &'a str,
    base: usize,
    /// From the beginning of this text.
    at: usize,
}

impl<'a> TextPlace<'a> {
    /// The beginning of a text whose first byte has this place.
    pub(super) fn start(text: &'a str, base: usize) -> Self {
        let at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        Self { text, base, at }
    }
}

/// A cursor over a text with one token of lookahead.
pub(super) struct Lexer<'a> {
    text: &'a str,
    /// The place of the text's first byte.
    base: usize,
    token: Token,
    previous_end: usize,
}

impl<'a> Lexer<'a> {
    /// A cursor before the first token.
    pub(super) fn new(text: &'a str) -> Self {
        let token = Token { kind: TokenKind::End, start: 0, end: 0 };
        let mut lexer = Self { text, base: 0, token, previous_end: 0 };
        lexer.jump(TextPlace::start(text, 0));
        lexer
    }

    /// The place before the next token.
    pub(super) fn place(&self) -> TextPlace<'a> {
        TextPlace { text: self.text, base: self.base, at: self.token.start - self.base }
    }

    /// Goes on at another place.
    pub(super) fn jump(&mut self, place: TextPlace<'a>) {
        (self.text, self.base) = (place.text, place.base);
        self.previous_end = place.base + place.at;
        self.token = self.scan(self.previous_end);
    }

    /// The text that is being read, from a place in it.
    pub(super) fn rest(&self, from: usize) -> &'a str {
        &self.text[from - self.base..]
    }

    /// The place behind the text that is being read.
    pub(super) fn end(&self) -> usize {
        self.base + self.text.len()
    }

    /// The place of the first byte of the text that is being read.
    pub(super) fn start(&self) -> usize {
        self.base
    }

    /// The token that is next.
    pub(super) fn peek(&self) -> Token {
        self.token
    }

    /// The token after the next one.
    pub(super) fn peek_behind(&self) -> Token {
        self.scan(self.token.end)
    }

    /// Takes the next token.
    pub(super) fn next(&mut self) -> Token {
        let token = self.token;
        self.previous_end = token.end;
        self.token = self.scan(token.end);
        token
    }

    /// The bytes between two places, if they are in the text that is being read.
    pub(super) fn text(&self, start: usize, end: usize) -> Option<&'a str> {
        self.text.get(start.checked_sub(self.base)?..end.checked_sub(self.base)?)
    }

    /// Where the last taken token ended.
    pub(super) fn previous_end(&self) -> usize {
        self.previous_end
    }

    /// Whether a blank stands before the next token and none after it.
    pub(super) fn leans_right(&self) -> bool {
        let after = &self.text.as_bytes()[self.token.end - self.base..];
        let blank = match after.first() {
            None => true,
            Some(b'/') => after.get(1) == Some(&b'/'),
            Some(byte) => byte.is_ascii_whitespace() || *byte == b'#',
        };
        self.token.start > self.previous_end && !blank
    }

    /// Goes back into what has been skipped as a comment.
    pub(super) fn resume(&mut self, at: usize) {
        self.previous_end = at;
        self.token = self.scan(at);
    }

    /// Goes to the end of the text.
    pub(super) fn finish(&mut self) {
        let end = self.end();
        self.token = Token { kind: TokenKind::End, start: end, end };
    }

    /// The token behind a place.
    fn scan(&self, from: usize) -> Token {
        let token = scan(self.text, from - self.base);
        Token { kind: token.kind, start: self.base + token.start, end: self.base + token.end }
    }
}

/// The token behind a byte of a text.
fn scan(text: &str, from: usize) -> Token {
    let bytes = text.as_bytes();
    let start = skip_blanks(bytes, from);
    let run = |from: usize, test: fn(u8) -> bool| {
        bytes[from..].iter().position(|&b| !test(b)).map_or(bytes.len(), |n| from + n)
    };
    let token = |kind, end| Token { kind, start, end };
    let next = bytes.get(start + 1);
    match bytes.get(start) {
        None => token(TokenKind::End, start),
        Some(b'a'..=b'z' | b'A'..=b'Z') => token(TokenKind::Word, word_end(text, start)),
        Some(b'.') if next == Some(&b'.') => token(TokenKind::Mark(RANGE), start + 2),
        Some(b'0'..=b'9' | b'.') => match number(bytes, start) {
            // Letters right after a number belong to it: `2x` is a mistake, not two tokens.
            Some(end) if !bytes.get(end).is_some_and(|&b| is_word(b) || ends_in_point(bytes, end)) => {
                token(TokenKind::Number, end)
            }
            _ => token(TokenKind::Unknown, run(start, |b| is_word(b) || b == b'.').max(start + 1)),
        },
        Some(b'=' | b'!' | b'<' | b'>') if next == Some(&b'=') => {
            token(TokenKind::Mark(COMPARISON), start + 2)
        }
        Some(b'<' | b'>') => token(TokenKind::Mark(COMPARISON), start + 1),
        Some(
            &mark @ (b'{' | b'}' | b'(' | b')' | b'[' | b']' | b',' | b'=' | b':' | b'+' | b'-' | b'*' | b'/'
            | b'^'),
        ) => token(TokenKind::Mark(mark), start + 1),
        Some(b'"') => match bytes[start + 1..].iter().position(|b| matches!(b, b'"' | b'\n' | b'\r')) {
            Some(n) if bytes[start + 1 + n] == b'"' => token(TokenKind::Quoted, start + n + 2),
            // Without its end, a quote goes as far as a word, so that what it holds begins no comment.
            _ => token(
                TokenKind::Unknown,
                run(start, |b| !b.is_ascii_whitespace() && !matches!(b, b'{' | b'}' | b'(' | b')')),
            ),
        },
        Some(byte) if byte.is_ascii() => token(TokenKind::Unknown, start + 1),
        Some(_) if text[start..].starts_with(begins_name) => token(TokenKind::Word, word_end(text, start)),
        Some(_) => token(TokenKind::Unknown, run(start, |b| !b.is_ascii())),
    }
}

/// The end of a word that begins here.
fn word_end(text: &str, start: usize) -> usize {
    let rest = &text.as_bytes()[start..];
    match rest.iter().position(|&byte| !is_word(byte)) {
        None => text.len(),
        Some(n) if rest[n].is_ascii() => start + n,
        // Most words are ASCII.
        Some(_) => text[start..].find(|c| !continues_name(c)).map_or(text.len(), |n| start + n),
    }
}

/// Whether a point that is not the first one of a range stands here.
fn ends_in_point(bytes: &[u8], at: usize) -> bool {
    bytes[at] == b'.' && bytes.get(at + 1) != Some(&b'.')
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Past blanks, line ends and comments.
fn skip_blanks(bytes: &[u8], mut at: usize) -> usize {
    loop {
        match (bytes.get(at), bytes.get(at + 1)) {
            (Some(b' ' | b'\t' | b'\n' | b'\r'), _) => at += 1,
            (Some(b'#'), _) | (Some(b'/'), Some(b'/')) => {
                at = bytes[at..]
                    .iter()
                    .position(|b| matches!(b, b'\n' | b'\r'))
                    .map_or(bytes.len(), |n| at + n);
            }
            (Some(_), _) => return at,
            (None, _) => return bytes.len(),
        }
    }
}

/// The end of `digits [. digits] [e [+-] digits]`, with a digit on at least one side of the point.
fn number(bytes: &[u8], start: usize) -> Option<usize> {
    let digits = |from: usize| {
        bytes[from..].iter().position(|b| !b.is_ascii_digit()).map_or(bytes.len(), |n| from + n)
    };
    let mut end = digits(start);
    let mut count = end - start;
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1) != Some(&b'.') {
        let fraction = digits(end + 1);
        count += fraction - end - 1;
        end = fraction;
    }
    if count == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let from = (end + 1 + sign).min(bytes.len());
        let exponent = digits(from);
        if exponent > from {
            end = exponent;
        }
    }
    Some(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind() {
        let text = "# c\na_1{2.5e-3//x\n.5 3. 1e 2x é$ - -1 #\r\"#f80\" \"#f8 {\"\n\"";
        let mut lexer = Lexer::new(text);
        let mut shown = Vec::new();
        loop {
            let token = lexer.next();
            if token.kind == TokenKind::End {
                break;
            }
            shown.push(format!("{:?} {}", token.kind, lexer.text(token.start, token.end).unwrap()));
        }
        assert_eq!(
            shown.join("; "),
            "Word a_1; Mark(123) {; Number 2.5e-3; Number .5; Number 3.; Unknown 1e; Unknown 2x; Word é; \
             Unknown $; Mark(45) -; Mark(45) -; Number 1; Quoted \"#f80\"; Quoted \"#f8 {\"; Unknown \""
        );
    }

    #[test]
    fn leaning() {
        let leans = |text| {
            let mut lexer = Lexer::new(text);
            lexer.next();
            lexer.leans_right()
        };
        assert!(leans("1 -2"));
        assert!(leans("1# c\n-2"));
        assert!(!leans("1 - 2"));
        assert!(!leans("1-2"));
        assert!(!leans("1- 2"));
        assert!(!leans("1 -# c\n2"));
        assert!(!leans("1 -"));
    }
}
