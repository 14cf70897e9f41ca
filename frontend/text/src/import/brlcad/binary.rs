//! Binary files of version 5 (`.g`): records one behind the other, all numbers with the large end first.
//!
//! ```text
//! 'v' hflags aflags bflags major minor  length/8  [length name] [length attributes] [length body] 0.. '5'
//! ```
//!
//! A flag holds the width of a length (1, 2, 4 or 8 bytes), whether the part is there, and of attributes and
//! body a compression, which nobody writes.

use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;

use super::database::{
    Combination, Database, MemberUse, Object, ObjectContent, PaletteRange, ProgramStep, Properties,
};
use super::solid::{DatabaseSolid, SolidShape, foreign, of_minor};

/// How every file begins: a header record of one chunk.
pub(super) const HEADER: [u8; 8] = [0x76, 1, 0, 0, 0, 0, 1, 0x35];
/// The first byte of a record, and the last.
const MAGIC: (u8, u8) = (0x76, 0x35);
/// Of an object's major kinds: geometry, and attributes alone.
const GEOMETRY: u8 = 1;
const ATTRIBUTES: u8 = 2;
/// The minor kind of combinations.
const COMBINATION: u8 = 31;

/// Bytes of the file, read from the front.
#[derive(Clone, Copy)]
struct Cursor<'a> {
    bytes: &'a [u8],
    /// The place of the next byte, and one past the last.
    at: usize,
    end: usize,
}

/// What is missing where, in words.
type Broken = (Span, String);

impl<'a> Cursor<'a> {
    fn span(&self) -> Span {
        Span::new(self.at, self.end)
    }

    /// The next bytes, as a part of their own.
    fn part(&mut self, length: u64, what: &str) -> Result<Self, Broken> {
        let left = (self.end - self.at) as u64;
        if length > left {
            return Err((self.span(), format!("{what} has {length} bytes, and {left} are left")));
        }
        let part = Self { bytes: self.bytes, at: self.at, end: self.at + length as usize };
        self.at = part.end;
        Ok(part)
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Broken> {
        let part = self.part(N as u64, what)?;
        let mut taken = [0; N];
        taken.copy_from_slice(&self.bytes[part.at..part.end]);
        Ok(taken)
    }

    fn byte(&mut self, what: &str) -> Result<u8, Broken> {
        Ok(self.take::<1>(what)?[0])
    }

    /// A whole number of 1, 2, 4 or 8 bytes, by the code of its width.
    fn number(&mut self, width: u8, what: &str) -> Result<u64, Broken> {
        Ok(match width {
            0 => u64::from(self.byte(what)?),
            1 => u64::from(u16::from_be_bytes(self.take(what)?)),
            2 => u64::from(u32::from_be_bytes(self.take(what)?)),
            _ => u64::from_be_bytes(self.take(what)?),
        })
    }

    fn real(&mut self, what: &str) -> Result<f64, Broken> {
        Ok(f64::from_be_bytes(self.take(what)?))
    }

    /// Bytes up to a NUL, which is taken too.
    fn string(&mut self, what: &str) -> Result<Span, Broken> {
        let rest = &self.bytes[self.at..self.end];
        let Some(length) = rest.iter().position(|&byte| byte == 0) else {
            return Err((self.span(), format!("{what} has no end")));
        };
        let span = Span::new(self.at, self.at + length);
        self.at += length + 1;
        Ok(span)
    }
}

/// Reads all objects. A record that cannot be read ends the file.
pub(super) fn read(database: &mut Database, bytes: &[u8]) {
    let mut file = Cursor { bytes, at: 0, end: bytes.len() };
    while file.at < file.end && !database.errors.is_full() {
        if let Err((span, message)) = record(database, &mut file) {
            database.errors.add_last(Diagnostic::error(Some(span), message));
            return;
        }
    }
}

/// The next record.
fn record(database: &mut Database, file: &mut Cursor) -> Result<(), Broken> {
    let start = file.at;
    let [magic, hflags, aflags, bflags, major, minor] = file.take::<6>("the head of an object")?;
    if magic != MAGIC.0 {
        return Err((Span::new(start, start + 1), format!("no object begins with byte {magic}")));
    }
    let chunks = file.number(hflags >> 6, "the length of an object")?;
    let head = (file.at - start) as u64;
    let length = chunks.checked_mul(8).filter(|length| *length > head);
    let Some(length) = length else {
        return Err((Span::new(start, file.at), format!("an object has {chunks} chunks of 8 bytes")));
    };
    let mut rest = file.part(length - head, "an object")?;
    let span = Span::new(start, rest.end);
    rest.end -= 1;
    if rest.bytes[rest.end] != MAGIC.1 {
        let last = Span::new(rest.end, rest.end + 1);
        return Err((last, format!("the object at byte {start} does not end with byte {}", MAGIC.1)));
    }
    // Headers of joined files, and free places.
    if hflags & 3 != 0 {
        return Ok(());
    }
    if (aflags | bflags) & 7 != 0 {
        return Err((span, "the object is compressed".to_owned()));
    }
    let name = if hflags & 0x20 == 0 {
        Span::new(rest.at, rest.at)
    } else {
        let length = rest.number(hflags >> 3 & 3, "the length of a name")?;
        let mut part = rest.part(length, "a name")?;
        part.string("a name")?
    };
    let mut attributes = optional(&mut rest, aflags, "attributes")?;
    let body = optional(&mut rest, bflags, "a body")?;
    let properties = properties(database, &mut attributes)?;
    let content = match (major, minor) {
        (GEOMETRY, COMBINATION) => combination(database, body)?.map(ObjectContent::Combination),
        (GEOMETRY, _) => geometry(database, minor, body)?,
        (ATTRIBUTES, _) => Some(ObjectContent::Text),
        _ => {
            let shown = clip(&database.text(name));
            let message =
                format!("`{shown}` is no geometry, but data of kind {major}.{minor}: it is left out");
            database.warnings.add(|| Diagnostic::warning(Some(span), message));
            Some(ObjectContent::Text)
        }
    };
    if let Some(content) = content {
        database.add(Object { name, span, content, properties });
    }
    Ok(())
}

/// A part of an object that may be missing, which is an empty one then.
fn optional<'a>(rest: &mut Cursor<'a>, flags: u8, what: &str) -> Result<Cursor<'a>, Broken> {
    if flags & 0x20 == 0 {
        return Ok(Cursor { end: rest.at, ..*rest });
    }
    let length = rest.number(flags >> 6, &format!("the length of {what}"))?;
    rest.part(length, what)
}

/// Attributes: keys and values.
fn properties(database: &mut Database, part: &mut Cursor) -> Result<Properties, Broken> {
    let mut properties = Properties::default();
    let mut rgb = None;
    while part.at < part.end && part.bytes[part.at] != 0 {
        let key = part.string("the name of an attribute")?;
        let value = part.string("the value of an attribute")?;
        match database.at(key) {
            b"regionid_colortable" => palette(database, value),
            // The usual name wins if both are there.
            b"rgb" => rgb = Some(value),
            key => database.set(&mut properties, key, database.at(value), value),
        }
    }
    if let (None, Some(value)) = (properties.color, rgb) {
        database.set(&mut properties, b"rgb", database.at(value), value);
    }
    Ok(properties)
}

/// The colours of regions by their numbers: `{low high red green blue} ..`.
fn palette(database: &mut Database, value: Span) {
    for entry in database.text(value).split(['{', '}']) {
        let numbers: Vec<i64> = entry.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect();
        database.palette.extend(PaletteRange::of(&numbers));
    }
}

/// A solid, or an object of another kind. `None` after a message.
fn geometry(database: &mut Database, minor: u8, mut body: Cursor) -> Result<Option<ObjectContent>, Broken> {
    let Some(row) = of_minor(minor) else { return Ok(Some(ObjectContent::Foreign(foreign(minor)))) };
    let span = body.span();
    let what = format!("the body of the {}", row.words[0]);
    let (fixed, each) = row.shape.counts();
    let (mut numbers, mut count) = (Vec::new(), fixed);
    if each > 0 {
        let entries = u64::from(u32::from_be_bytes(body.take(&what)?));
        let (mut head, mut words) = (0, each);
        if row.shape == SolidShape::Metaball {
            numbers.push(f64::from(u32::from_be_bytes(body.take(&what)?)));
            (head, words) = (1, each);
        }
        let wanted = (entries * words as u64 + head) * 8;
        let left = (body.end - body.at) as u64;
        if wanted > left {
            let message = format!("{what} has a list of {entries}: {wanted} bytes, and {left} are left");
            return Err((span, message));
        }
        count = entries as usize * words + head as usize;
    }
    for _ in 0..count {
        let at = body.at;
        let number = body.real(&what)?;
        if !number.is_finite() {
            let place = Span::new(at, at + 8);
            let word = row.words[0];
            database
                .errors
                .add(|| Diagnostic::error(Some(place), format!("a number of the {word} is {number}")));
            return Ok(None);
        }
        numbers.push(number);
    }
    Ok(Some(ObjectContent::Solid(DatabaseSolid { kind: row.kind, numbers })))
}

/// A combination. `None` after a message.
fn combination(database: &mut Database, mut body: Cursor) -> Result<Option<Combination>, Broken> {
    let span = body.span();
    let width = body.byte("a combination")?;
    if width > 3 {
        return Err((span, format!("a combination has numbers of width {width}")));
    }
    let mut next = |what: &str| body.number(width, what);
    let matrices = next("the number of matrices")?;
    let members = next("the number of members")?;
    let member_bytes = next("the length of the members")?;
    let steps = next("the number of steps")?;
    let _depth = next("the depth of a combination")?;
    let mut part = body.part(matrices.saturating_mul(128), "the list of matrices")?;
    let mut list = body.part(member_bytes, "the list of members")?;
    let program = body.part(steps, "the list of steps")?;
    // A member takes a NUL and an index at least.
    let least = members.saturating_mul(1 + (1 << width));
    if least > member_bytes {
        return Err((list.span(), format!("the list of {members} members has {member_bytes} bytes")));
    }
    if !database.count_members(members as usize, span) {
        return Ok(None);
    }
    let mut combination = Combination::default();
    for _ in 0..matrices {
        let place = Span::new(part.at, part.at + 128);
        let mut matrix = [0.0; 16];
        for entry in &mut matrix {
            *entry = part.real("a matrix")?;
        }
        if matrix.iter().any(|entry| !entry.is_finite()) {
            database.errors.add(|| Diagnostic::error(Some(place), "a matrix has an entry that is no number"));
            return Ok(None);
        }
        combination.matrices.push(matrix);
    }
    for _ in 0..members {
        let name = list.string("the name of a member")?;
        let index = list.number(width, "the matrix of a member")?;
        let is_identity = index >> ((8 << width) - 1) & 1 == 1;
        if !is_identity && index >= matrices {
            return Err((name, format!("there is no matrix {index} among {matrices}")));
        }
        combination.members.push(MemberUse { name, matrix: (!is_identity).then_some(index as u32) });
    }
    for at in program.at..program.end {
        let step = match program.bytes[at] {
            1 => ProgramStep::Member,
            2 => ProgramStep::Union,
            3 => ProgramStep::Intersection,
            4 => ProgramStep::Difference,
            5 => ProgramStep::Exclusive,
            6 => ProgramStep::Complement,
            other => return Err((Span::new(at, at + 1), format!("there is no step {other}"))),
        };
        combination.steps.push(step);
    }
    Ok(Some(combination))
}
