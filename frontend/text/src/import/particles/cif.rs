//! `.cif`: structures of molecules as tables of words (mmCIF, after STAR). Of all tables, `_atom_site` is
//! read; the others are skipped.

use super::atoms::{Atom, AtomName, Atoms};
use super::elements::element;
use super::options::{ParticleOptions, ParticleUse};
use super::scan::{TextWord, fault};
use crate::import::format::{SceneFormatRow, first_line};
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::{Diagnostic, Span};

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow::of_particles(
    &["cif", "mmcif"],
    ("a structure of a molecule (mmCIF)", &[ParticleUse::Waters, ParticleUse::Frame]),
    is_mine,
    read,
);

fn is_mine(bytes: &[u8]) -> bool {
    first_line(bytes).get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"data_"))
}

/// What is read of an atom.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AtomItem {
    Group,
    Symbol,
    Name,
    Residue,
    Chain,
    Number,
    Insertion,
    X,
    Y,
    Z,
    Occupancy,
    Bfac,
    Model,
}

/// Tags behind `_atom_site.`, the better one of two first.
const TAGS: [(&str, AtomItem); 15] = [
    ("group_PDB", AtomItem::Group),
    ("type_symbol", AtomItem::Symbol),
    ("label_atom_id", AtomItem::Name),
    ("label_comp_id", AtomItem::Residue),
    ("auth_asym_id", AtomItem::Chain),
    ("label_asym_id", AtomItem::Chain),
    ("auth_seq_id", AtomItem::Number),
    ("label_seq_id", AtomItem::Number),
    ("pdbx_PDB_ins_code", AtomItem::Insertion),
    ("Cartn_x", AtomItem::X),
    ("Cartn_y", AtomItem::Y),
    ("Cartn_z", AtomItem::Z),
    ("occupancy", AtomItem::Occupancy),
    ("B_iso_or_equiv", AtomItem::Bfac),
    ("pdbx_PDB_model_num", AtomItem::Model),
];

/// A token: a word, or a text in quotes or between lines of semicolons.
#[derive(Clone, Copy)]
struct CifToken<'a> {
    word: TextWord<'a>,
    quoted: bool,
}

impl CifToken<'_> {
    fn is(self, keyword: &str) -> bool {
        !self.quoted && self.word.text.eq_ignore_ascii_case(keyword.as_bytes())
    }

    fn is_tag(self) -> bool {
        !self.quoted && self.word.text.starts_with(b"_")
    }

    /// Whether it ends a loop.
    fn ends_loop(self) -> bool {
        let begins = |prefix: &[u8]| {
            self.word.text.get(..prefix.len()).is_some_and(|start| start.eq_ignore_ascii_case(prefix))
        };
        self.is_tag() || (!self.quoted && (begins(b"loop_") || begins(b"data_") || begins(b"save_")))
    }

    /// The place of a tag among those of atoms.
    fn atom_tag(self) -> Option<&'static str> {
        if !self.is_tag() {
            return None;
        }
        let rest =
            self.word.text.get(11..).filter(|_| self.word.text[..11].eq_ignore_ascii_case(b"_atom_site."))?;
        Some(
            TAGS.iter().find(|(tag, _)| tag.as_bytes().eq_ignore_ascii_case(rest)).map_or("", |(tag, _)| tag),
        )
    }
}

/// The tokens of a file.
struct CifTokens<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> CifTokens<'a> {
    fn token(&mut self, from: usize, to: usize, end: usize, quoted: bool) -> CifToken<'a> {
        self.at = end;
        CifToken { word: TextWord { text: &self.bytes[from..to], start: from }, quoted }
    }
}

impl<'a> Iterator for CifTokens<'a> {
    type Item = CifToken<'a>;

    fn next(&mut self) -> Option<CifToken<'a>> {
        let bytes = self.bytes;
        let find = |from: usize, test: &dyn Fn(u8) -> bool| {
            bytes[from..].iter().position(|&byte| test(byte)).map_or(bytes.len(), |length| from + length)
        };
        loop {
            self.at = find(self.at, &|byte| !byte.is_ascii_whitespace());
            if bytes.get(self.at) != Some(&b'#') {
                break;
            }
            self.at = find(self.at, &|byte| matches!(byte, b'\n' | b'\r'));
        }
        let start = self.at;
        let first = *bytes.get(start)?;
        let begins_line = start == 0 || matches!(bytes[start - 1], b'\n' | b'\r');
        if first == b';' && begins_line {
            let mut end = start;
            loop {
                end = find(end + 1, &|byte| matches!(byte, b'\n' | b'\r'));
                if end >= bytes.len() {
                    return Some(self.token(start + 1, bytes.len(), bytes.len(), true));
                }
                if bytes.get(end + 1) == Some(&b';') {
                    return Some(self.token(start + 1, end, end + 2, true));
                }
            }
        }
        if matches!(first, b'\'' | b'"') {
            let mut end = start;
            loop {
                end = find(end + 1, &|byte| byte == first || matches!(byte, b'\n' | b'\r'));
                let ends = bytes.get(end + 1).is_none_or(u8::is_ascii_whitespace);
                if bytes.get(end) != Some(&first) || ends {
                    return Some(self.token(start + 1, end, (end + 1).min(bytes.len()), true));
                }
            }
        }
        let end = find(start, &|byte| byte.is_ascii_whitespace());
        Some(self.token(start, end, end, false))
    }
}

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let mut tokens = CifTokens { bytes, at: 0 }.peekable();
    let mut table = AtomTable::new(options);
    // A table of one row has no loop: tags with their values.
    let mut single: Vec<(&'static str, TextWord<'_>)> = Vec::new();
    while let Some(token) = tokens.next() {
        if token.is("loop_") {
            let mut tags = Vec::new();
            while let Some(tag) = tokens.next_if(|token| token.is_tag()) {
                tags.push(tag);
            }
            if !tags.iter().any(|tag| tag.atom_tag().is_some()) {
                continue;
            }
            table.begin(token.word.span(), tags.iter().map(|tag| tag.atom_tag().unwrap_or("")))?;
            let mut row = Vec::with_capacity(tags.len());
            while let Some(value) = tokens.next_if(|token| !token.ends_loop()) {
                row.push(value);
                if row.len() == tags.len() {
                    table.row(&row)?;
                    row.clear();
                }
            }
            if let Some(last) = row.last() {
                return Err(fault(
                    last.word.span(),
                    "the last row of atoms is cut off",
                    "as many values as tags",
                ));
            }
        } else if let (Some(tag), Some(value)) = (token.atom_tag(), tokens.peek().copied())
            && !value.ends_loop()
        {
            single.push((tag, value.word));
            tokens.next();
        }
    }
    if table.atoms.is_empty()
        && let Some((_, first)) = single.first().copied()
    {
        table.begin(first.span(), single.iter().map(|(tag, _)| *tag))?;
        let row: Vec<CifToken<'_>> =
            single.iter().map(|&(_, word)| CifToken { word, quoted: false }).collect();
        table.row(&row)?;
    }
    if table.atoms.is_empty() {
        let span = Span::new(bytes.len(), bytes.len());
        return Err(fault(span, "there are no atoms", "a table `_atom_site` with a row of this model"));
    }
    let models = table.model.map_or(1, |(_, count)| count);
    table.atoms.leave_out_frames(models - 1, "model", options);
    table.atoms.model(options)
}

/// The atoms, and where their items stand in a row.
struct AtomTable<'o> {
    options: &'o ParticleOptions,
    atoms: Atoms,
    places: [Option<usize>; TAGS.len()],
    /// The word of the model that is read, and how many there have been.
    model: Option<(Vec<u8>, usize)>,
}

impl<'o> AtomTable<'o> {
    fn new(options: &'o ParticleOptions) -> Self {
        let atoms = Atoms::with_bfac();
        Self { options, atoms, places: [None; TAGS.len()], model: None }
    }

    fn begin(&mut self, span: Span, tags: impl Iterator<Item = &'static str>) -> Result<(), Vec<Diagnostic>> {
        self.places = [None; TAGS.len()];
        for (column, tag) in tags.enumerate() {
            if let Some(known) = TAGS.iter().position(|(known, _)| *known == tag) {
                self.places[known] = Some(column);
            }
        }
        match [AtomItem::X, AtomItem::Y, AtomItem::Z]
            .into_iter()
            .all(|item| column(&self.places, item).is_some())
        {
            true => Ok(()),
            false => Err(fault(span, "atoms have no places", "the tags Cartn_x, Cartn_y and Cartn_z")),
        }
    }

    fn row(&mut self, row: &[CifToken<'_>]) -> Result<(), Vec<Diagnostic>> {
        let places = self.places;
        let value = |item: AtomItem| -> Option<TextWord<'_>> {
            let token = row[column(&places, item)?];
            let is_none = !token.quoted && matches!(token.word.text, b"." | b"?");
            (!is_none).then_some(token.word)
        };
        let text = |item: AtomItem| value(item).map_or(&b""[..], |word| word.text);
        if value(AtomItem::Group).is_some_and(|word| !matches!(word.text, b"ATOM" | b"HETATM")) {
            return Ok(());
        }
        let (model, wanted) = (text(AtomItem::Model), self.options.frame.unwrap_or(1).max(1));
        let frame = match &self.model {
            Some((last, frame)) if *last == model => *frame,
            other => {
                let frame = other.as_ref().map_or(1, |(_, frame)| frame + 1);
                self.model = Some((model.to_vec(), frame));
                frame
            }
        };
        if frame != wanted {
            return Ok(());
        }
        let parts = [AtomItem::Chain, AtomItem::Number, AtomItem::Insertion, AtomItem::Name];
        let name = AtomName::of(parts.map(text));
        let residue = text(AtomItem::Residue);
        let span = row.first().map_or(Span::new(0, 0), |token| token.word.span());
        let number = |item: AtomItem, what: &str| match value(item) {
            Some(word) => word.expect_number(what),
            None => Err(fault(span, format!("{what} is missing"), "a number")),
        };
        let optional = |item: AtomItem, default: f64, what: &str| match value(item) {
            Some(word) => word.expect_number(what),
            None => Ok(default),
        };
        let made = || {
            Ok(Atom {
                element: element(text(AtomItem::Symbol)),
                at: [number(AtomItem::X, "x")?, number(AtomItem::Y, "y")?, number(AtomItem::Z, "z")?],
                occupancy: optional(AtomItem::Occupancy, 1.0, "the occupancy")?,
                bfac: optional(AtomItem::Bfac, 0.0, "the temperature factor")?,
            })
        };
        self.atoms.push_of(name, residue, self.options, made)
    }
}

/// The column of an item: that of the first of its tags that is there.
fn column(places: &[Option<usize>; TAGS.len()], item: AtomItem) -> Option<usize> {
    let tags = TAGS.iter().zip(places).filter(|((_, of), _)| *of == item);
    tags.filter_map(|(_, place)| *place).next()
}
