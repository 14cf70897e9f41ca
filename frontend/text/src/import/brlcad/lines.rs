//! Text files of version 4 (`.asc`): an object a line, with the members of a combination behind it.
//!
//! ```text
//! I 1 v4
//! A cup                                     a title
//! S 18 cup.s 5 0 0 0 ..                     a solid: its kind, name, a number, and 24 numbers
//! C Y cup.r 1000 0 2 0 1 100 1 255 0 0      a region of two members, with its colour
//! M u cup.s 1 0 0 0 .. 0                    a member with its matrix: u begins a product of sets,
//! M - hole.s 1 0 0 0 .. 0                   - and + go on with it
//! ```

use jbt_model::diagnostic::{Diagnostic, Span};

use super::database::{
    Combination, Database, MemberUse, Object, ObjectContent, PaletteRange, ProgramStep, Properties, line_of,
};
use super::solid::{DatabaseSolid, SolidKind};
use super::tcl::{number, shown};

/// How a file begins.
pub(super) const FIRST_WORD: &[u8] = b"I";

/// Solids by their numbers: the kind, and how many numbers count.
const SOLIDS: &[(i64, SolidKind, usize)] = &[
    (16, SolidKind::Torus, 9),
    (18, SolidKind::Cone, 18),
    (19, SolidKind::Ellipsoid, 12),
    (20, SolidKind::Block, 24),
    (24, SolidKind::Half, 4),
    (26, SolidKind::ParabolicCylinder, 10),
    (27, SolidKind::HyperbolicCylinder, 11),
    (28, SolidKind::Paraboloid, 11),
    (29, SolidKind::Hyperboloid, 12),
    (30, SolidKind::EllipticalTorus, 11),
    (33, SolidKind::Waist, 11),
];

/// FileLines that begin objects without a counterpart: their letters, and what they are.
const FOREIGN: &[(u8, &str)] = &[
    (b'A', "ars"),
    (b'P', "poly"),
    (b'b', "bspline"),
    (b's', "string solid"),
    (b'N', "nmg"),
    (b'd', "sketch"),
    (b'e', "extrude"),
    (b'c', "cline"),
    (b't', "bot"),
];

/// The words of a line.
struct FileLine<'a> {
    bytes: &'a [u8],
    words: Vec<Span>,
    span: Span,
}

impl<'a> FileLine<'a> {
    fn word(&self, place: usize, what: &str) -> Result<Span, Diagnostic> {
        let end = Span { start: self.span.end, ..self.span };
        let missing = || Diagnostic::error(Some(end), format!("{what} is missing"));
        self.words.get(place).copied().ok_or_else(missing)
    }

    fn slice(&self, place: usize) -> &'a [u8] {
        self.words.get(place).map_or(&[], |word| &self.bytes[word.start as usize..word.end as usize])
    }

    fn integer(&self, place: usize) -> Option<i64> {
        std::str::from_utf8(self.slice(place)).ok()?.parse().ok()
    }

    fn integers(&self, from: usize) -> Vec<i64> {
        (from..self.words.len()).filter_map(|place| self.integer(place)).collect()
    }

    /// Finite numbers from a word on.
    fn numbers(&self, from: usize, count: usize) -> Result<Vec<f64>, Diagnostic> {
        (from..from + count).map(|place| number(self.bytes, self.word(place, "a number")?)).collect()
    }
}

/// The lines of a file.
struct FileLines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> FileLines<'a> {
    fn next(&mut self) -> Option<FileLine<'a>> {
        if self.at >= self.bytes.len() {
            return None;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        let span = Span::new(self.at, self.at + length);
        self.at += length + 1;
        // Half of a CR LF.
        if rest.get(length) == Some(&b'\r') && rest.get(length + 1) == Some(&b'\n') {
            self.at += 1;
        }
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
        let mut words = Vec::new();
        let mut start = span.start as usize;
        for word in self.bytes[start..span.end as usize].split(is_blank) {
            if !word.is_empty() {
                words.push(Span::new(start, start + word.len()));
            }
            start += word.len() + 1;
        }
        Some(FileLine { bytes: self.bytes, words, span })
    }

    /// What begins the next line.
    fn peek(&self) -> &'a [u8] {
        let next = FileLines { bytes: self.bytes, at: self.at }.next();
        next.map_or(&[], |line| line.slice(0))
    }
}

/// Reads all objects.
pub(super) fn read(database: &mut Database, bytes: &[u8]) {
    let mut lines = FileLines { bytes, at: 0 };
    while let Some(line) = lines.next() {
        if database.errors.is_full() {
            return;
        }
        if let Err(error) = object(database, &mut lines, &line) {
            database.errors.add(|| error);
        }
    }
}

/// The object that begins with a line.
fn object(database: &mut Database, lines: &mut FileLines, line: &FileLine) -> Result<(), Diagnostic> {
    let plain = |content| ObjectContent::Solid(content);
    let (name, content) = match line.slice(0) {
        b"" | b"M" | b"B" | b"D" | b"Q" | b"F" | b"X" => return Ok(()),
        FIRST_WORD => {
            // The title is a line of its own.
            lines.next();
            return Ok(());
        }
        b"m" => {
            database.palette.extend(PaletteRange::of(&line.integers(2)));
            return Ok(());
        }
        b"S" => {
            let name = line.word(2, "the name of a solid")?;
            (name, solid(line)?)
        }
        b"p" => {
            let numbers = line.numbers(2, 8)?;
            (line.word(1, "a name")?, plain(DatabaseSolid { kind: SolidKind::Particle, numbers }))
        }
        b"n" if line.words.len() == 3 => {
            let mut numbers = Vec::new();
            while lines.peek() == b"n" {
                let Some(plane) = lines.next() else { break };
                if plane.words.len() == 3 {
                    break;
                }
                numbers.extend(plane.numbers(1, 4)?);
            }
            (line.word(1, "a name")?, plain(DatabaseSolid { kind: SolidKind::Planes, numbers }))
        }
        b"w" => (line.word(1, "a name")?, plain(pipe(lines, line)?)),
        b"C" => return combination(database, lines, line),
        [letter] => match FOREIGN.iter().find(|(known, _)| known == letter) {
            Some((_, kind)) => (line.word(1, "a name")?, ObjectContent::Foreign((*kind).to_owned())),
            None => return unknown(database, line),
        },
        _ => return unknown(database, line),
    };
    database.add(Object { name, span: line.span, content, properties: Properties::default() });
    Ok(())
}

/// A line that means nothing here: parts of objects that are not read are such lines, too.
fn unknown(database: &mut Database, line: &FileLine) -> Result<(), Diagnostic> {
    let (first, count) = (line.words[0], line.words.len());
    // Numbers continue what is not read.
    if number(line.bytes, first).is_err() {
        let shown = shown(line.bytes, first);
        database.warnings.add(|| {
            Diagnostic::warning(
                Some(first),
                format!("a line of {count} words begins with `{shown}`: it is left out"),
            )
        });
    }
    Ok(())
}

/// A solid of 24 numbers.
fn solid(line: &FileLine) -> Result<ObjectContent, Diagnostic> {
    let code = line.integer(1);
    let known = SOLIDS.iter().find(|(number, ..)| Some(*number) == code);
    let Some(&(_, kind, count)) = known else {
        let shown = line.words.get(1).map_or_else(String::new, |word| shown(line.bytes, *word));
        return Ok(ObjectContent::Foreign(format!("solid {shown}")));
    };
    let mut numbers = line.numbers(4, count)?;
    match kind {
        // Lengths of vectors are the radii.
        SolidKind::Torus => {
            let length = |at: usize| numbers[at].hypot(numbers[at + 1]).hypot(numbers[at + 2]);
            let radii = [length(6), length(3)];
            numbers.truncate(6);
            numbers.extend(radii);
        }
        // Points are counted from the first one.
        SolidKind::Block => {
            for at in 3..24 {
                numbers[at] += numbers[at % 3];
            }
        }
        _ => {}
    }
    Ok(ObjectContent::Solid(DatabaseSolid { kind, numbers }))
}

/// A pipe: a line for each point, with inner and outer diameter and the radius of the bend in front of it.
fn pipe(lines: &mut FileLines, line: &FileLine) -> Result<DatabaseSolid, Diagnostic> {
    let mut numbers = Vec::new();
    while let Some(point) = lines.next() {
        if point.slice(0).starts_with(b"END_PIPE") {
            return Ok(DatabaseSolid { kind: SolidKind::Pipe, numbers });
        }
        let all = point.numbers(0, 6)?;
        numbers.extend_from_slice(&all[3..]);
        numbers.extend_from_slice(&all[..3]);
    }
    Err(Diagnostic::error(Some(line.span), "the pipe has no end").expected("expected a line END_PIPE"))
}

/// A combination and the lines of its members.
fn combination(database: &mut Database, lines: &mut FileLines, line: &FileLine) -> Result<(), Diagnostic> {
    let name = line.word(2, "the name of a combination")?;
    let mut properties = Properties { is_region: line.slice(1) != b"N", ..Properties::default() };
    properties.region = line.integer(3);
    properties.aircode = line.integer(4);
    properties.material = line.integer(7);
    // A number that is not 0 says that the colour counts.
    if line.integer(9).is_some_and(|override_color| override_color != 0) {
        let rgb = [10, 11, 12].map(|place| line.integer(place).and_then(|byte| u8::try_from(byte).ok()));
        if let [Some(r), Some(g), Some(b)] = rgb {
            properties.color = Some([r, g, b]);
        }
    }
    properties.inherits = line.integer(15) == Some(1);
    // Flags say whether lines about the material follow.
    for place in [13, 14] {
        if line.integer(place) == Some(1) && lines.peek() != b"M" {
            let said = lines.next().filter(|_| place == 13);
            let words = said.map(|line| line_of(&database.text(line.span))).filter(|words| !words.is_empty());
            properties.shader = words.or(properties.shader);
        }
    }
    let mut made = Combination::default();
    let mut is_product_open = false;
    while lines.peek() == b"M" {
        let Some(member) = lines.next() else { break };
        let step = match member.slice(1) {
            _ if made.members.is_empty() => ProgramStep::Union,
            b"u" => ProgramStep::Union,
            b"-" => ProgramStep::Difference,
            b"+" | b"n" => ProgramStep::Intersection,
            b"^" => ProgramStep::Exclusive,
            _ => {
                let word = member.word(1, "an operation")?;
                let message = format!("there is no operation `{}`", shown(member.bytes, word));
                return Err(Diagnostic::error(Some(word), message).expected("expected u, - or +"));
            }
        };
        let name = member.word(2, "the name of a member")?;
        let entries = <[f64; 16]>::try_from(member.numbers(3, 16)?).unwrap_or_default();
        // A product is complete where the next one begins.
        if step == ProgramStep::Union && std::mem::replace(&mut is_product_open, !made.members.is_empty()) {
            made.steps.push(ProgramStep::Union);
        }
        made.members.push(MemberUse { name, matrix: Some(made.matrices.len() as u32) });
        made.matrices.push(entries);
        made.steps.push(ProgramStep::Member);
        if step != ProgramStep::Union {
            made.steps.push(step);
        }
    }
    if is_product_open {
        made.steps.push(ProgramStep::Union);
    }
    if !database.count_members(made.members.len(), line.span) {
        return Ok(());
    }
    let content = ObjectContent::Combination(made);
    database.add(Object { name, span: line.span, content, properties });
    Ok(())
}
