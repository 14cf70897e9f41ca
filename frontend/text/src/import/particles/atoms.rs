//! Atoms: elements at places, of which files say more than one wants. What is left becomes a cloud.

use std::collections::HashMap;

use super::cloud::Cloud;
use super::elements::{ELEMENTS, ElementFacts};
use super::options::ParticleOptions;
use crate::import::imported::ReadModel;
use crate::import::srgb::decoded;
use jbt_model::diagnostic::Diagnostic;

/// Residues that are water.
const WATERS: [&[u8]; 7] = [b"HOH", b"WAT", b"DOD", b"H2O", b"TIP", b"TIP3", b"SOL"];

/// What tells the atoms of a structure apart: chain, number of the residue, insertion code, and the name of
/// the atom. Of several with one name, only one is there at a time.
///
/// Of a million names hardly one has more than 12 bytes: those are numbers, and take no memory of their own.
#[derive(PartialEq, Eq, Hash)]
pub(super) enum AtomName {
    /// The bytes, behind the lengths of the first three parts, in 16 bytes.
    Short(u128),
    Long([Box<[u8]>; 4]),
}

impl AtomName {
    pub(super) fn of(parts: [&[u8]; 4]) -> Self {
        let lengths = parts.map(<[u8]>::len);
        if lengths.iter().sum::<usize>() > 12 {
            return Self::Long(parts.map(Box::from));
        }
        let heads = [1, lengths[0] as u8, lengths[1] as u8, lengths[2] as u8];
        let bytes = heads.iter().chain(parts.into_iter().flatten());
        Self::Short(bytes.fold(0, |packed, &byte| packed << 8 | u128::from(byte)))
    }
}

/// An atom of a file.
pub(super) struct Atom {
    /// By its place in [`ELEMENTS`]; `None` if it is not known.
    pub(super) element: Option<usize>,
    pub(super) at: [f64; 3],
    /// How often it is there, from 0 to 1.
    pub(super) occupancy: f64,
    /// The temperature factor.
    pub(super) bfac: f64,
}

/// The atoms of a file so far.
#[derive(Default)]
pub(super) struct Atoms {
    all: Vec<Atom>,
    /// The place of each name among them.
    names: HashMap<AtomName, usize>,
    /// Whether the file tells temperature factors.
    has_bfac: bool,
    waters: usize,
    alternates: usize,
    unknown: usize,
    /// What else the file says that is left out.
    pub(super) warnings: Vec<Diagnostic>,
}

impl Atoms {
    /// Those of a file that tells temperature factors.
    pub(super) fn with_bfac() -> Self {
        Self { has_bfac: true, ..Self::default() }
    }

    /// One more atom.
    pub(super) fn push(&mut self, atom: Atom) {
        self.unknown += usize::from(atom.element.is_none());
        self.all.push(atom);
    }

    /// One more atom of a structure, unless it is water, or another one of its name is there more often.
    pub(super) fn push_of(
        &mut self,
        name: AtomName,
        residue: &[u8],
        options: &ParticleOptions,
        atom: impl FnOnce() -> Result<Atom, Vec<Diagnostic>>,
    ) -> Result<(), Vec<Diagnostic>> {
        if !options.waters && WATERS.contains(&residue) {
            self.waters += 1;
            return Ok(());
        }
        let atom = atom()?;
        let next = self.all.len();
        let place = *self.names.entry(name).or_insert(next);
        if place == next {
            self.push(atom);
            return Ok(());
        }
        self.alternates += 1;
        if atom.occupancy > self.all[place].occupancy {
            self.all[place] = atom;
        }
        Ok(())
    }

    /// A note about frames or models besides the one that is read, unless an option has chosen it.
    pub(super) fn leave_out_frames(&mut self, count: usize, what: &str, options: &ParticleOptions) {
        if count > 0 && options.frame.is_none() {
            let (plural, verb) = if count == 1 { ("", "is") } else { ("s", "are") };
            let message = format!("{count} more {what}{plural} {verb} left out: --frame chooses one");
            self.warnings.push(Diagnostic::warning(None, message));
        }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The model: radii and colours are those of the elements.
    pub(super) fn model(mut self, options: &ParticleOptions) -> ReadModel {
        let mut warnings = std::mem::take(&mut self.warnings);
        let mut note = |count: usize, one: &str, many: &str, rest: &str| {
            if count > 0 {
                let what = if count == 1 { one } else { many };
                warnings.push(Diagnostic::warning(None, format!("{count} {what}{rest}")));
            }
        };
        note(self.waters, "atom of water is", "atoms of water are", " left out: --waters keeps them");
        note(
            self.alternates,
            "alternative place is",
            "alternative places are",
            " left out: the likeliest ones stay",
        );
        note(self.unknown, "atom is", "atoms are", " of no known element: radius 2, pink");
        let colors = |facts: &ElementFacts| facts.color.map(|byte| decoded(f64::from(byte) / 255.0) as f32);
        let known: Vec<[f32; 3]> = ELEMENTS.iter().map(colors).collect();
        let unknown = colors(&ElementFacts::UNKNOWN);
        let color = |atom: &Atom| atom.element.map_or(unknown, |element| known[element]);
        let radius =
            |atom: &Atom| atom.element.map_or(ElementFacts::UNKNOWN.radius, |it| ELEMENTS[it].radius);
        let mut cloud = Cloud::at(self.all.iter().map(|atom| atom.at).collect::<Vec<[f64; 3]>>());
        cloud.radii = Some(self.all.iter().map(radius).collect::<Vec<f64>>().into());
        cloud.colors = Some(self.all.iter().map(color).collect::<Vec<[f32; 3]>>().into());
        if self.has_bfac {
            let bfac = self.all.iter().map(|atom| atom.bfac).collect::<Vec<f64>>();
            cloud.values.push(("bfac".to_owned(), 1, bfac.into()));
        }
        cloud.warnings = warnings;
        cloud.model(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_differ_by_any_part() {
        let names: [[&[u8]; 4]; 7] = [
            [b"A", b"1", b"", b"CA"],
            [b"A", b"1", b"C", b"A"],
            [b"A", b"1C", b"", b"A"],
            [b"A1", b"", b"C", b"A"],
            [b"A", b"1", b"", b"CA\0"],
            [b"A", b"1", b"", b"a name of many bytes"],
            [b"A", b"1", b"a", b" name of many bytes"],
        ];
        for (at, name) in names.iter().enumerate() {
            for (other, parts) in names.iter().enumerate() {
                assert_eq!(AtomName::of(*name) == AtomName::of(*parts), at == other, "{name:?} {parts:?}");
            }
        }
    }
}
