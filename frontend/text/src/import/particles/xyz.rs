//! `.xyz`: atoms as chemists write them, clouds of points, and raw numbers of simulators. The content
//! decides.
//!
//! ```text
//! 3                           C 0 0 0 ..                   a number, a line of any text, then symbol x y z [more] as often
//! water                       0.1 0.2 0.3 [r g b]          a cloud: three numbers a line, or six
//! O 0 0 0.117                 bytes, 12 for each point     little-endian f32
//! H 0 0.757 -0.469
//! H 0 -0.757 -0.469
//! ```

use super::atoms::{Atom, Atoms};
use super::bytes::NumberType;
use super::cloud::Cloud;
use super::csv;
use super::elements::{ELEMENTS, element};
use super::options::{ParticleOptions, ParticleUse};
use super::scan::{TextLine, TextLines, TextWord, fault};
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::{Diagnostic, Span};

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow::of_particles(
    &["xyz"],
    ("atoms, a cloud of points or raw numbers", &[ParticleUse::Columns, ParticleUse::Frame]),
    is_atoms,
    read,
);

/// Whether these are atoms: a number alone, a line of any text, a word and three numbers. Of a cloud nothing
/// tells that it is one.
fn is_atoms(bytes: &[u8]) -> bool {
    let mut lines = TextLines::from(bytes, 0);
    let count = lines.next().and_then(|head| head.columns(0, usize::MAX).whole());
    let first = lines.nth(1);
    let mut words = first.into_iter().flat_map(TextLine::words).skip(1);
    count.is_some() && (0..3).all(|_| words.next().is_some_and(|word| word.number().is_some()))
}

/// The beginning of a file that tells text from numbers.
const BEGINNING: usize = 4096;

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let beginning = &bytes[..bytes.len().min(BEGINNING)];
    let is_text = beginning.iter().all(|byte| matches!(byte, b'\t' | b'\n' | b'\r' | b' '..=b'~' | 0x80..));
    let is_text =
        is_text && std::str::from_utf8(beginning).map_or_else(|it| it.error_len().is_none(), |_| true);
    if !is_text {
        return raw(bytes, options);
    }
    let first = TextLines::from(bytes, 0).next();
    let mut words = first.into_iter().flat_map(TextLine::words);
    match (words.next(), words.next()) {
        (Some(count), None) if count.whole().is_some() => chemistry(bytes, options),
        _ => csv::cloud(bytes, options),
    }
}

/// Triples of f32.
fn raw(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    if !bytes.len().is_multiple_of(12) {
        let message = format!("{} bytes, which are neither text nor points of 12 bytes each", bytes.len());
        return Err(vec![Diagnostic::error(None, message)]);
    }
    Cloud::at(NumberType::F32.array(bytes, false)).model(options)
}

/// Frames of atoms, of which one is read.
fn chemistry(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let wanted = options.frame.unwrap_or(1).max(1);
    let mut lines = TextLines::from(bytes, 0);
    for frame in 1.. {
        let Some(head) = next_frame(&mut lines) else {
            let message = format!("the file has {} frames, and not {wanted}", frame - 1);
            return Err(vec![Diagnostic::error(None, message)]);
        };
        let Some(count) = head.columns(0, usize::MAX).whole() else {
            return Err(fault(head.span(), "this begins no frame", "the number of its atoms"));
        };
        let comment = lines.next();
        let end = |lines: &TextLines<'_>| Span::new(lines.at().min(bytes.len()), bytes.len().min(lines.at()));
        if frame < wanted {
            let skipped = lines.by_ref().take(count).count();
            if skipped < count {
                return Err(too_few(end(&lines), count, skipped));
            }
            continue;
        }
        let columns = comment.map_or(XyzColumns::PLAIN, XyzColumns::of);
        let mut atoms = Atoms::default();
        for number in 0..count {
            let Some(line) = lines.next().filter(|line| !line.is_blank()) else {
                return Err(too_few(end(&lines), count, number));
            };
            atoms.push(atom(line, &columns)?);
        }
        if atoms.is_empty() {
            return Err(fault(head.span(), "there are no atoms", "at least one"));
        }
        atoms.warnings.extend(columns.left_out);
        let (others, rest) = other_frames(&mut lines);
        atoms.leave_out_frames(others, "frame", options);
        atoms.warnings.extend(rest.map(|line| {
            Diagnostic::warning(Some(line.span()), "what begins no frame is left out, up to the end")
        }));
        return atoms.model(options);
    }
    unreachable!("a file has an end")
}

/// How many frames follow, and the first line behind them that begins none.
fn other_frames<'a>(lines: &mut TextLines<'a>) -> (usize, Option<TextLine<'a>>) {
    let mut frames = 0;
    while let Some(head) = next_frame(lines) {
        let Some(count) = head.columns(0, usize::MAX).whole() else { return (frames, Some(head)) };
        lines.take(count.saturating_add(1)).for_each(drop);
        frames += 1;
    }
    (frames, None)
}

/// The head of the next frame: blank lines may stand before it.
fn next_frame<'a>(lines: &mut TextLines<'a>) -> Option<TextLine<'a>> {
    lines.find(|line| !line.is_blank())
}

fn too_few(span: Span, count: usize, found: usize) -> Vec<Diagnostic> {
    fault(span, format!("the frame ends after {found} atoms"), &format!("{count}, as it says"))
}

/// Where symbol and place stand in a line.
struct XyzColumns {
    symbol: usize,
    place: usize,
    /// A note about properties that are left out.
    left_out: Option<Diagnostic>,
}

impl XyzColumns {
    const PLAIN: Self = Self { symbol: 0, place: 1, left_out: None };

    /// Those that an extended file tells in its second line: `Properties=species:S:1:pos:R:3:..`.
    fn of(comment: TextLine<'_>) -> Self {
        let text = String::from_utf8_lossy(comment.text);
        let Some((_, rest)) = text.split_once("Properties=") else { return Self::PLAIN };
        let list = rest.trim_start_matches('"');
        let list = list.split(|c: char| c.is_whitespace() || c == '"').next().unwrap_or("");
        let (mut at, mut symbol, mut place, mut others) = (0_usize, None, None, Vec::new());
        let parts: Vec<&str> = list.split(':').collect();
        for property in parts.chunks_exact(3) {
            match property[0] {
                "species" | "Z" => symbol = Some(at),
                "pos" => place = Some(at),
                other => others.push(other.to_owned()),
            }
            at = at.saturating_add(property[2].parse().unwrap_or(1));
        }
        let Some((symbol, place)) = symbol.zip(place) else { return Self::PLAIN };
        let note = |told| Diagnostic::warning(None, format!("{told} left out"));
        Self { symbol, place, left_out: csv::listed(others.iter()).map(note) }
    }
}

fn atom(line: TextLine<'_>, columns: &XyzColumns) -> Result<Atom, Vec<Diagnostic>> {
    let words: Vec<TextWord<'_>> =
        line.words().take(columns.place.max(columns.symbol).saturating_add(3)).collect();
    let word = |index: usize, what: &str| {
        words.get(index).ok_or_else(|| fault(line.span(), "an atom ends too early", what))
    };
    let symbol = word(columns.symbol, "a symbol, and three numbers")?;
    let mut at = [0.0; 3];
    for (axis, at) in at.iter_mut().enumerate() {
        let place = columns.place.saturating_add(axis);
        *at = word(place, "a symbol, and three numbers")?.expect_number("a coordinate")?;
    }
    Ok(Atom { element: element_of(symbol.text), at, occupancy: 1.0, bfac: 0.0 })
}

/// The element of a symbol with digits behind it, or of an atomic number.
fn element_of(symbol: &[u8]) -> Option<usize> {
    let letters = symbol.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
    if letters == 0 {
        let number: usize = std::str::from_utf8(symbol).ok()?.parse().ok()?;
        return number.checked_sub(1).filter(|index| *index < ELEMENTS.len());
    }
    element(&symbol[..letters])
}
