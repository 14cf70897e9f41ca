//! A line that is being read: each method takes one piece of the text form, or says which piece it expected.

use std::collections::HashMap;
use std::fmt;

use crate::entity::{Entity, Table, Value, Values};
use crate::limits::{MAX_TABLES, MAX_VALUES};
use crate::op::Type;
use crate::origin::{Origin, Part};

use super::lex::{Kind, Lexer, Token, is_printable, unescape};

/// Why a line is not part of a function.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ParseError {
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    /// What could stand there.
    pub expected: String,
    /// What stands there.
    pub found: String,
    /// The line, or its part around the column, and below it a caret at the column.
    pub snippet: String,
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, column, expected, found, snippet } = self;
        write!(f, "{line}:{column}: expected {expected}, found {found}\n{snippet}")
    }
}

impl std::error::Error for ParseError {}

/// A stretch of a line.
pub struct LineSpan<'a> {
    /// The number of the line, from 1.
    pub line: usize,
    /// The line.
    pub text: &'a str,
    /// The first byte.
    pub start: usize,
    /// The byte after it.
    pub end: usize,
}

impl LineSpan<'_> {
    /// The error that something else could stand here. It repeats no character that a terminal would obey.
    pub fn error(&self, expected: impl Into<String>) -> ParseError {
        /// Characters of the line shown before and after the place.
        const AROUND: usize = 60;
        let show = |text: &str| -> String {
            text.chars().map(|letter| if is_printable(letter) { letter } else { '\u{b7}' }).collect()
        };
        let (before, after) = self.text.split_at(self.start);
        let column = before.chars().count() + 1;
        let skipped =
            before.char_indices().rev().nth(AROUND).map_or(0, |(at, letter)| at + letter.len_utf8());
        let shown_before = show(&before[skipped..]);
        let shown_after = show(&after.chars().take(AROUND).collect::<String>());
        let caret = " ".repeat(shown_before.chars().count());
        let token = &self.text[self.start..self.end];
        let found = match token.chars().take(40).collect::<String>() {
            none if none.is_empty() => "the end of the line".to_owned(),
            token => format!("`{}`", show(&token)),
        };
        ParseError {
            line: self.line,
            column,
            expected: expected.into(),
            found,
            snippet: format!("    {shown_before}{shown_after}\n    {caret}^"),
        }
    }
}

/// A value at its definition, and its type if the type is written.
pub type Defined = (Value, Option<Type>);

/// The result of reading a part of a line.
pub type Parsed<T> = Result<T, ParseError>;

/// A line and its current token.
#[derive(Clone, Copy)]
pub struct Line<'a> {
    number: usize,
    text: &'a str,
    lexer: Lexer<'a>,
    /// The current token.
    pub token: Token<'a>,
}

impl<'a> Line<'a> {
    /// Begins to read a line.
    pub fn new(number: usize, text: &'a str) -> Self {
        let mut lexer = Lexer::new(text);
        let token = lexer.next();
        Self { number, text, lexer, token }
    }

    /// Goes on to the next token.
    pub fn advance(&mut self) {
        self.token = self.lexer.next();
    }

    /// The error that something else could stand in place of the current token.
    pub fn error(&self, expected: impl Into<String>) -> ParseError {
        let (start, end) = (self.token.start, self.token.end);
        LineSpan { line: self.number, text: self.text, start, end }.error(expected)
    }

    /// Takes the token if `read` makes something of it.
    pub fn take<T>(&mut self, expected: &str, read: impl FnOnce(Kind<'a>) -> Option<T>) -> Parsed<T> {
        let result = read(self.token.kind).ok_or_else(|| self.error(expected))?;
        self.advance();
        Ok(result)
    }

    /// Takes this punctuation if it stands here.
    pub fn skip(&mut self, punctuation: &str) -> bool {
        let found = matches!(self.token.kind, Kind::Punctuation(text) if text == punctuation);
        if found {
            self.advance();
        }
        found
    }

    /// Takes this word if it stands here.
    pub fn skip_word(&mut self, word: &str) -> bool {
        let found = self.token.kind == Kind::Word(word);
        if found {
            self.advance();
        }
        found
    }

    /// Takes this punctuation.
    pub fn punctuation(&mut self, punctuation: &str) -> Parsed<()> {
        if self.skip(punctuation) { Ok(()) } else { Err(self.error(format!("`{punctuation}`"))) }
    }

    /// Takes this word.
    pub fn word(&mut self, word: &str) -> Parsed<()> {
        if self.skip_word(word) { Ok(()) } else { Err(self.error(format!("`{word}`"))) }
    }

    /// Checks that nothing follows.
    pub fn end(&self) -> Parsed<()> {
        if self.token.kind == Kind::End { Ok(()) } else { Err(self.error("the end of the line")) }
    }

    /// A string.
    pub fn quoted(&mut self, expected: &str) -> Parsed<String> {
        self.take(expected, |kind| match kind {
            Kind::Quoted(raw) => unescape(raw),
            Kind::Word(_) | Kind::Number(_) | Kind::Punctuation(_) | Kind::Unknown | Kind::End => None,
        })
    }

    /// Items with commas between them; none if a closing parenthesis, an origin or the end comes at once.
    pub fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Parsed<T>) -> Parsed<Vec<T>> {
        let mut items = Vec::new();
        if matches!(self.token.kind, Kind::Punctuation(")" | "@") | Kind::End) {
            return Ok(items);
        }
        loop {
            items.push(item(self)?);
            if !self.skip(",") {
                return Ok(items);
            }
        }
    }

    /// Values with commas between them.
    pub fn values(&mut self) -> Parsed<Values> {
        Ok(self.list(|line| line.entity("v", MAX_VALUES))?.into())
    }

    /// Names in parentheses.
    pub fn names(&mut self) -> Parsed<Vec<String>> {
        self.punctuation("(")?;
        let names = self.list(|line| line.name("a name"))?;
        self.punctuation(")")?;
        Ok(names)
    }

    /// A string, or words joined by dots.
    pub fn name(&mut self, expected: &str) -> Parsed<String> {
        if matches!(self.token.kind, Kind::Quoted(_)) {
            return self.quoted("a name without escapes other than `\\\"`, `\\\\` and `\\u{1f}`");
        }
        let word = |line: &mut Self, expected: &str| {
            line.take(expected, |kind| if let Kind::Word(word) = kind { Some(word) } else { None })
        };
        let mut name = word(self, expected)?.to_owned();
        while self.skip(".") {
            name.push('.');
            name.push_str(word(self, "the rest of a name")?);
        }
        Ok(name)
    }

    /// The index that stands here, or the index of the name that stands here.
    pub fn name_or_index(&mut self, expected: &str, names: Option<&HashMap<String, usize>>) -> Parsed<usize> {
        if matches!(self.token.kind, Kind::Number(_)) {
            return Ok(self.integer(expected)? as usize);
        }
        let start = *self;
        let name = self.name(expected)?;
        names.and_then(|names| names.get(&name)).copied().ok_or_else(|| start.error(expected))
    }

    /// A whole number from 0.
    pub fn integer(&mut self, expected: &str) -> Parsed<u32> {
        self.take(expected, |kind| if let Kind::Number(text) = kind { decimal(text) } else { None })
    }

    /// The number in a word such as `v3`.
    pub fn number_after(&self, prefix: &str) -> Option<u32> {
        let Kind::Word(word) = self.token.kind else { return None };
        decimal(word.strip_prefix(prefix)?)
    }

    /// An entity such as `v3`, with an index below `limit`.
    pub fn entity<E: Entity>(&mut self, prefix: &str, limit: usize) -> Parsed<E> {
        match self.number_after(prefix) {
            Some(index) if (index as usize) < limit => {
                self.advance();
                Ok(E::new(index as usize))
            }
            Some(_) => Err(self.error(format!("at most {prefix}{}", limit - 1))),
            None => Err(self.error(format!("`{prefix}` with a number, such as {prefix}3"))),
        }
    }

    /// A table such as `t0`.
    pub fn table(&mut self) -> Parsed<Table> {
        self.entity("t", MAX_TABLES)
    }

    /// One of a few words.
    pub fn choice<T: Copy>(&mut self, what: &str, all: &[T], name: impl Fn(T) -> &'static str) -> Parsed<T> {
        let found = all.iter().find(|&&item| self.token.kind == Kind::Word(name(item)));
        let Some(&found) = found else {
            let names: Vec<&str> = all.iter().map(|&item| name(item)).collect();
            return Err(self.error(format!("{what}: {}", names.join(", "))));
        };
        self.advance();
        Ok(found)
    }

    /// A value, and its type if that is written.
    pub fn defined(&mut self) -> Parsed<Defined> {
        let value = self.entity("v", MAX_VALUES)?;
        let type_ = if self.skip(":") { Some(self.choice("a type", &Type::ALL, Type::name)?) } else { None };
        Ok((value, type_))
    }

    /// An origin; without one, work that belongs to no single leaf.
    pub fn origin(&mut self) -> Parsed<Origin> {
        if !self.skip("@") {
            return Ok(Origin::SHARED);
        }
        let mut slot = None;
        if matches!(self.token.kind, Kind::Number(_)) {
            slot = Some(self.take("a slot, such as 3", |kind| {
                let Kind::Number(text) = kind else { return None };
                decimal(text).filter(|&slot| slot <= Origin::MAX_SLOT)
            })?);
            self.punctuation(".")?;
        }
        let part = self.choice("a part", &Part::ALL, Part::name)?;
        Ok(Origin::new(slot, part))
    }

    /// A decimal, an infinity or a NaN.
    pub fn real(&mut self) -> Parsed<f32> {
        if self.skip_word("nan") {
            if !self.skip(":") {
                return Ok(f32::from_bits(0x7fc0_0000));
            }
            let start = *self;
            let number = f32::from_bits(self.hex()?);
            return if number.is_nan() { Ok(number) } else { Err(start.error("the encoding of a NaN")) };
        }
        self.take("a number within the range of f32, or inf, -inf, nan", |kind| match kind {
            Kind::Word("inf") => Some(f32::INFINITY),
            Kind::Number("-inf") => Some(f32::NEG_INFINITY),
            Kind::Number(text) if text.ends_with(|last: char| last.is_ascii_digit()) => {
                text.parse().ok().filter(|number: &f32| number.is_finite())
            }
            Kind::Word(_) | Kind::Number(_) | Kind::Quoted(_) | Kind::Punctuation(_) => None,
            Kind::Unknown | Kind::End => None,
        })
    }

    /// Bits.
    pub fn hex(&mut self) -> Parsed<u32> {
        self.take("bits in hexadecimal, such as 0x7f800000", |kind| match kind {
            Kind::Number(text) => u32::from_str_radix(text.strip_prefix("0x")?, 16).ok(),
            Kind::Word(_) | Kind::Quoted(_) | Kind::Punctuation(_) | Kind::Unknown | Kind::End => None,
        })
    }
}

/// A decimal number of digits only, as `u32` prints it: no sign, no leading zero.
fn decimal(text: &str) -> Option<u32> {
    let canonical =
        text.bytes().all(|byte| byte.is_ascii_digit()) && (text.len() == 1 || !text.starts_with('0'));
    if canonical { text.parse().ok() } else { None }
}
