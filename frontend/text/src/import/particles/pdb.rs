//! `.pdb`: structures of molecules, in columns of fixed width. Blanks separate nothing: numbers and names may
//! touch.

use super::atoms::{Atom, AtomName, Atoms};
use super::elements::element;
use super::options::{ParticleOptions, ParticleUse};
use super::scan::{TextLine, TextLines, fault};
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_model::diagnostic::{Diagnostic, Span};

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow::of_particles(
    &["pdb", "ent"],
    ("a structure of a molecule (PDB)", &[ParticleUse::Waters, ParticleUse::Frame]),
    is_mine,
    read,
);

/// Records that a file begins with.
const FIRST: [&[u8]; 6] = [b"HEADER", b"ATOM  ", b"HETATM", b"REMARK", b"CRYST1", b"TITLE "];

fn is_mine(bytes: &[u8]) -> bool {
    FIRST.iter().any(|record| bytes.starts_with(record))
}

fn read(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    let mut atoms = Atoms::with_bfac();
    let wanted = options.frame.unwrap_or(1).max(1);
    let (mut frame, mut models) = (1, 0_usize);
    for line in TextLines::from(bytes, 0) {
        let record = line.columns(0, 6).text;
        match record {
            b"MODEL" => models += 1,
            b"ENDMDL" if frame == wanted && options.frame.is_some() => break,
            b"ENDMDL" => frame += 1,
            b"ATOM" | b"HETATM" if frame == wanted => read_atom(line, &mut atoms, options)?,
            _ => {}
        }
    }
    if atoms.is_empty() {
        let span = Span::new(bytes.len(), bytes.len());
        let expected = if models > 0 { "a model of this number" } else { "lines of ATOM or HETATM" };
        return Err(fault(span, "there are no atoms", expected));
    }
    atoms.leave_out_frames(models.saturating_sub(1), "model", options);
    atoms.model(options)
}

fn read_atom(
    line: TextLine<'_>,
    atoms: &mut Atoms,
    options: &ParticleOptions,
) -> Result<(), Vec<Diagnostic>> {
    // As they stand, blanks and all: ` CA ` and `CA  ` are two names.
    let mut columns = [b' '; 27];
    let length = line.text.len().min(columns.len());
    columns[..length].copy_from_slice(&line.text[..length]);
    let name = AtomName::of([&columns[21..22], &columns[22..26], &columns[26..], &columns[12..16]]);
    let residue = line.columns(17, 21).text;
    // The fourth column of long names is one of padding in files that keep to three.
    let residue = if residue.len() == 4 { residue } else { line.columns(17, 20).text };
    atoms.push_of(name, residue, options, || {
        let number = |from: usize, to: usize, what: &str| {
            let word = line.columns(from, to);
            if word.text.is_empty() {
                return Err(fault(line.span(), format!("{what} is missing"), "a number in its columns"));
            }
            word.expect_number(what)
        };
        let optional = |from: usize, to: usize, default: f64, what: &str| {
            let word = line.columns(from, to);
            if word.text.is_empty() { Ok(default) } else { word.expect_number(what) }
        };
        Ok(Atom {
            element: element_of(line),
            at: [number(30, 38, "x")?, number(38, 46, "y")?, number(46, 54, "z")?],
            occupancy: optional(54, 60, 1.0, "the occupancy")?,
            bfac: optional(60, 66, 0.0, "the temperature factor")?,
        })
    })
}

/// The element: the one of its own columns, or by the name, whose second column is the last one of a symbol.
fn element_of(line: TextLine<'_>) -> Option<usize> {
    if let Some(known) = element(line.columns(76, 78).text) {
        return Some(known);
    }
    let mut name = [b' '; 4];
    let columns = line.text.get(12..line.text.len().min(16)).unwrap_or_default();
    name[..columns.len()].copy_from_slice(columns);
    let [first, second, ..] = name;
    if !first.is_ascii_alphabetic() {
        return element(&[second]);
    }
    let is_short = name.trim_ascii().len() < 4;
    element(&[first, second])
        .filter(|_| is_short && second.is_ascii_alphabetic())
        .or_else(|| element(&[first]))
}
