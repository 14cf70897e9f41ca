//! Trees of combinations in text files of version 5.
//!
//! ```text
//! - {l cup.s} {u {l rim.s} {l handle.s {1 0 0 5  0 1 0 0  0 0 1 0  0 0 0 1}}}
//! ```
//!
//! A tree may be as deep as the file is long, so the reader keeps a list of the operators that are open.

use jbt_model::diagnostic::{Diagnostic, Span};

use super::database::{Combination, MemberUse, ProgramStep};
use super::tcl::{numbers, shown};

/// The operations by their words.
const OPERATIONS: &[(&[u8], ProgramStep)] = &[
    (b"l", ProgramStep::Member),
    (b"u", ProgramStep::Union),
    (b"n", ProgramStep::Intersection),
    (b"+", ProgramStep::Intersection),
    (b"-", ProgramStep::Difference),
    (b"^", ProgramStep::Exclusive),
    (b"!", ProgramStep::Complement),
];

/// A combination from its tree. One without words has no members.
pub(super) fn combination(bytes: &[u8], tree: Span) -> Result<Combination, Diagnostic> {
    let (at, end) = (tree.start as usize, tree.end as usize);
    let mut reader = TextTreeReader { bytes, at, end, made: Combination::default(), open: Vec::new() };
    if reader.peek().is_none() {
        return Ok(reader.made);
    }
    reader.begin()?;
    while let Some(byte) = reader.peek() {
        let place = Span::new(reader.at, reader.at + 1);
        reader.at += 1;
        match byte {
            b'{' => reader.begin()?,
            // The braces around the whole are those of the word.
            b'}' if reader.open.len() > 1 => reader.finish()?,
            _ => {
                return Err(
                    Diagnostic::error(Some(place), "this is no part of a tree").expected("expected `{`")
                );
            }
        }
    }
    if let [.., outer, _] = &reader.open[..] {
        return Err(Diagnostic::error(Some(outer.span), "this operation has no end").expected("expected `}`"));
    }
    reader.finish()?;
    Ok(reader.made)
}

/// An operation that is open.
struct OpenOperation {
    step: ProgramStep,
    /// How many operands it has.
    operands: usize,
    span: Span,
}

struct TextTreeReader<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
    made: Combination,
    open: Vec<OpenOperation>,
}

impl TextTreeReader<'_> {
    /// The next byte that is no blank.
    fn peek(&mut self) -> Option<u8> {
        while self.at < self.end && (self.bytes[self.at].is_ascii_whitespace() || self.bytes[self.at] == 0) {
            self.at += 1;
        }
        (self.at < self.end).then(|| self.bytes[self.at])
    }

    /// The next word, or what is in the next braces.
    fn word(&mut self, what: &str) -> Result<Span, Diagnostic> {
        let first = self.peek();
        let start = self.at;
        let missing = |at| Diagnostic::error(Some(Span::new(at, at)), format!("{what} is missing"));
        match first {
            None | Some(b'}') => Err(missing(start)),
            Some(b'{') => {
                let length = self.bytes[start..self.end].iter().position(|&byte| byte == b'}');
                let length = length.ok_or_else(|| missing(start))?;
                self.at = start + length + 1;
                Ok(Span::new(start + 1, start + length))
            }
            Some(_) => {
                let is_end = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'{' | b'}' | 0);
                let length = self.bytes[start..self.end].iter().position(is_end);
                self.at = length.map_or(self.end, |length| start + length);
                Ok(Span::new(start, self.at))
            }
        }
    }

    /// Behind an opening brace.
    fn begin(&mut self) -> Result<(), Diagnostic> {
        let word = self.word("an operation")?;
        let bytes = &self.bytes[word.start as usize..word.end as usize];
        let Some(&(_, step)) = OPERATIONS.iter().find(|(name, _)| *name == bytes) else {
            let message = format!("there is no operation `{}`", shown(self.bytes, word));
            return Err(Diagnostic::error(Some(word), message).expected("expected u, n, -, ^, ! or l"));
        };
        self.open.push(OpenOperation { step, operands: 0, span: word });
        if step != ProgramStep::Member {
            return Ok(());
        }
        let name = self.word("the name of a member")?;
        let mut matrix = None;
        if !matches!(self.peek(), None | Some(b'}')) {
            let list = self.word("the matrix of a member")?;
            let entries = <[f64; 16]>::try_from(numbers(self.bytes, list)?).map_err(|found| {
                let message = format!("the matrix has {} numbers", found.len());
                Diagnostic::error(Some(list), message).expected("expected 16, by rows")
            })?;
            matrix = Some(self.made.matrices.len() as u32);
            self.made.matrices.push(entries);
        }
        self.made.members.push(MemberUse { name, matrix });
        self.made.steps.push(ProgramStep::Member);
        Ok(())
    }

    /// At a closing brace.
    fn finish(&mut self) -> Result<(), Diagnostic> {
        let Some(OpenOperation { step, operands, span }) = self.open.pop() else { return Ok(()) };
        if operands < step.takes() {
            let message = format!("`{}` has {operands} operands", shown(self.bytes, span));
            let wanted = step.takes();
            return Err(Diagnostic::error(Some(span), message).expected(format!("expected {wanted}")));
        }
        if step == ProgramStep::Complement {
            self.made.steps.push(step);
        }
        let Some(parent) = self.open.last_mut() else { return Ok(()) };
        parent.operands += 1;
        match parent.step.takes() {
            // More than two operands go from left to right.
            2 if parent.operands >= 2 => self.made.steps.push(parent.step),
            2 => {}
            takes if parent.operands > takes => {
                let message = format!("`{}` has more than {takes} operands", shown(self.bytes, parent.span));
                return Err(Diagnostic::error(Some(parent.span), message));
            }
            _ => {}
        }
        Ok(())
    }
}
