//! Cuts a line into tokens, one at a time: nothing is kept, so a line of any length costs no memory.

/// What a token is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind<'a> {
    /// Letters, digits and underscores, not beginning with a digit: `fold`, `v3`.
    Word(&'a str),
    /// Anything that begins like a number: `3`, `-1.5e-7`, `-inf`, `0x7f800000`.
    Number(&'a str),
    /// What stands between quotes, escapes still in it.
    Quoted(&'a str),
    /// One of `( ) { } , : = . @ ->`.
    Punctuation(&'static str),
    /// A character that begins no token, or a string without its closing quote.
    Unknown,
    /// The end of the line, or the comment that ends it.
    End,
}

/// A token and the bytes of the line that it covers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Token<'a> {
    /// What it is.
    pub kind: Kind<'a>,
    /// Its first byte.
    pub start: usize,
    /// The byte after it.
    pub end: usize,
}

/// What is left of a line.
#[derive(Clone, Copy, Debug)]
pub struct Lexer<'a> {
    line: &'a str,
    position: usize,
}

/// All punctuation; a longer one stands before its own beginning.
const PUNCTUATION: [&str; 10] = ["->", "(", ")", "{", "}", ",", ":", "=", ".", "@"];

impl<'a> Lexer<'a> {
    /// Starts at the beginning of a line.
    pub const fn new(line: &'a str) -> Self {
        Self { line, position: 0 }
    }

    /// The next token; at the end of the line always [`Kind::End`].
    pub fn next(&mut self) -> Token<'a> {
        let rest = self.line[self.position..].trim_start();
        let start = self.line.len() - rest.len();
        let (kind, length) = first(rest);
        self.position = start + length;
        Token { kind, start, end: self.position }
    }
}

/// The token that `rest` begins with, and its length in bytes.
fn first(rest: &str) -> (Kind<'_>, usize) {
    let Some(letter) = rest.chars().next() else { return (Kind::End, 0) };
    if letter == ';' {
        return (Kind::End, 0);
    }
    if let Some(&text) = PUNCTUATION.iter().find(|&&text| rest.starts_with(text)) {
        return (Kind::Punctuation(text), text.len());
    }
    if letter == '"' {
        return quoted(rest);
    }
    if letter == '-' || letter.is_ascii_digit() {
        let length = number_length(rest);
        return (Kind::Number(&rest[..length]), length);
    }
    match word_end(rest.as_bytes(), 0) {
        0 => (Kind::Unknown, letter.len_utf8()),
        length => (Kind::Word(&rest[..length]), length),
    }
}

/// Where the letters, digits and underscores from `at` on end.
fn word_end(bytes: &[u8], at: usize) -> usize {
    let word = bytes[at..].iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_');
    at + word.count()
}

/// The length of a number: digits or a word after a sign, then a fraction, then a signed exponent. A dot
/// without a digit after it is not part of it, so that `@3.distance` reads well.
fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let mut end = word_end(bytes, 1);
    let whole = bytes[0].is_ascii_digit() || end > 1;
    if whole
        && bytes[1..end].iter().all(u8::is_ascii_digit)
        && bytes.get(end) == Some(&b'.')
        && digit(end + 1)
    {
        end = word_end(bytes, end + 1);
    }
    let exponent = matches!(bytes[end - 1], b'e' | b'E') && !rest.starts_with("0x");
    if exponent && matches!(bytes.get(end), Some(b'+' | b'-')) && digit(end + 1) {
        end = word_end(bytes, end + 1);
    }
    end
}

/// A string: up to the next quote that no backslash precedes.
fn quoted(rest: &str) -> (Kind<'_>, usize) {
    let mut escaped = false;
    for (at, byte) in rest.bytes().enumerate().skip(1) {
        match byte {
            b'"' if !escaped => return (Kind::Quoted(&rest[1..at]), at + 1),
            b'\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    (Kind::Unknown, rest.len())
}

/// The string that a quoted token stands for; `None` if an escape is not `\"`, `\\` or `\u{hex}`.
pub fn unescape(raw: &str) -> Option<String> {
    let mut text = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(at) = rest.find('\\') {
        text.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix("u{") {
            let (digits, after) = after.split_once('}')?;
            text.push(char::from_u32(u32::from_str_radix(digits, 16).ok()?)?);
            rest = after;
        } else {
            let letter = rest.chars().next().filter(|letter| matches!(letter, '"' | '\\'))?;
            text.push(letter);
            rest = &rest[1..];
        }
    }
    text.push_str(rest);
    Some(text)
}

/// Whether a name is written without quotes: words joined by dots, such as `color.r`.
pub(super) fn is_bare(name: &str) -> bool {
    name.split('.').all(|word| {
        let mut letters = word.bytes();
        letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == b'_')
            && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == b'_')
    })
}

/// Whether a character can be shown to a terminal as it is: no control characters, no invisible or reordering
/// ones.
pub(super) fn is_printable(letter: char) -> bool {
    letter == ' ' || letter.is_ascii_graphic() || (!letter.is_ascii() && letter.is_alphanumeric())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tokens of a line, as they are written.
    fn tokens(line: &str) -> Vec<&str> {
        let mut lexer = Lexer::new(line);
        let mut texts = Vec::new();
        loop {
            let token = lexer.next();
            if token.kind == Kind::End {
                return texts;
            }
            texts.push(&line[token.start..token.end]);
        }
    }

    #[test]
    fn a_dot_belongs_to_a_number_only_before_a_digit() {
        assert_eq!(tokens("@3.distance"), ["@", "3", ".", "distance"]);
        assert_eq!(tokens("t0.3"), ["t0", ".", "3"]);
        assert_eq!(tokens("-1.5e-7,-inf 0x7fe"), ["-1.5e-7", ",", "-inf", "0x7fe"]);
        assert_eq!(tokens("1e+3 0x1e-3"), ["1e+3", "0x1e", "-3"]);
        assert_eq!(tokens("- -> -.5"), ["-", "->", "-", ".", "5"]);
    }

    #[test]
    fn strings_end_at_a_quote_without_backslash() {
        assert_eq!(tokens(r#""a\"b;" ; c"#), [r#""a\"b;""#]);
        assert_eq!(tokens(r#""a\\" b"#), [r#""a\\""#, "b"]);
        assert_eq!(tokens(r#""a\"#), [r#""a\"#]);
        assert_eq!(unescape(r#"a\"\\\u{1F600}"#).as_deref(), Some("a\"\\\u{1F600}"));
        assert_eq!(unescape(r"\n"), None);
        assert_eq!(unescape(r"\u{d800}"), None);
        assert_eq!(unescape(r"\u{41"), None);
        assert_eq!(unescape("\\ü"), None);
    }
}
