//! The solids: a row for each kind, with its number in binary files, its words in text, and its parameters.
//!
//! ```text
//! tor   binary 1   V 3 numbers, H 3, r_a 1, r_h 1    text: put {rim.s} tor V {0 0 9} H {0 0 1} r_a 11 r_h 3
//! ```
//!
//! The body of a binary object has the same numbers in the same order. Three kinds have lists of any length.

/// A kind of solid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum SolidKind {
    Torus,
    Cone,
    Ellipsoid,
    Block,
    Half,
    Planes,
    Pipe,
    Particle,
    ParabolicCylinder,
    HyperbolicCylinder,
    Paraboloid,
    Hyperboloid,
    EllipticalTorus,
    Superellipsoid,
    Waist,
    Metaball,
}

/// How the numbers of a solid are counted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum SolidShape {
    /// Parameters and how many numbers each has, up to 24 together.
    Fixed(&'static [(&'static str, usize)]),
    /// A list of entries, in text with numbered keys: each key, and how many numbers it has.
    List(&'static [(&'static str, usize)]),
    /// A method and a threshold, and a list of entries of five numbers.
    Metaball,
}

/// What is said of a kind.
pub(super) struct SolidRow {
    pub(super) kind: SolidKind,
    /// Its numbers in binary files.
    pub(super) minors: &'static [u8],
    /// Its words in text files, the usual one first.
    pub(super) words: &'static [&'static str],
    pub(super) shape: SolidShape,
}

/// A solid with its numbers, all finite.
pub(super) struct DatabaseSolid {
    pub(super) kind: SolidKind,
    /// Those of the row's shape, in order; of a metaball the method, the threshold and the list.
    pub(super) numbers: Vec<f64>,
}

/// All kinds.
pub(super) const SOLIDS: &[SolidRow] = &[
    row(SolidKind::Torus, &[1], &["tor"], &[("V", 3), ("H", 3), ("r_a", 1), ("r_h", 1)]),
    row(
        SolidKind::Cone,
        &[2, 7],
        &["tgc", "rec", "rcc", "trc", "tec"],
        &[("V", 3), ("H", 3), ("A", 3), ("B", 3), ("C", 3), ("D", 3)],
    ),
    row(SolidKind::Ellipsoid, &[3, 10], &["ell", "sph"], &[("V", 3), ("A", 3), ("B", 3), ("C", 3)]),
    row(
        SolidKind::Block,
        &[4],
        &["arb8", "arb7", "arb6", "arb5", "arb4", "rpp", "box", "raw"],
        &[("V1", 3), ("V2", 3), ("V3", 3), ("V4", 3), ("V5", 3), ("V6", 3), ("V7", 3), ("V8", 3)],
    ),
    row(SolidKind::Half, &[6], &["half"], &[("N", 3), ("d", 1)]),
    SolidRow {
        kind: SolidKind::Planes,
        minors: &[14],
        words: &["arbn"],
        shape: SolidShape::List(&[("P", 4)]),
    },
    SolidRow {
        kind: SolidKind::Pipe,
        minors: &[15],
        words: &["pipe"],
        shape: SolidShape::List(&[("V", 3), ("I", 1), ("O", 1), ("R", 1)]),
    },
    row(SolidKind::Particle, &[16], &["part"], &[("V", 3), ("H", 3), ("r_v", 1), ("r_h", 1)]),
    row(SolidKind::ParabolicCylinder, &[17], &["rpc"], &[("V", 3), ("H", 3), ("B", 3), ("r", 1)]),
    row(SolidKind::HyperbolicCylinder, &[18], &["rhc"], &[("V", 3), ("H", 3), ("B", 3), ("r", 1), ("c", 1)]),
    row(SolidKind::Paraboloid, &[19], &["epa"], &[("V", 3), ("H", 3), ("A", 3), ("r_1", 1), ("r_2", 1)]),
    row(
        SolidKind::Hyperboloid,
        &[20],
        &["ehy"],
        &[("V", 3), ("H", 3), ("A", 3), ("r_1", 1), ("r_2", 1), ("c", 1)],
    ),
    row(SolidKind::EllipticalTorus, &[21], &["eto"], &[("V", 3), ("N", 3), ("C", 3), ("r", 1), ("r_d", 1)]),
    row(
        SolidKind::Superellipsoid,
        &[35],
        &["superell"],
        &[("V", 3), ("A", 3), ("B", 3), ("C", 3), ("n", 1), ("e", 1)],
    ),
    row(SolidKind::Waist, &[38], &["hyp"], &[("V", 3), ("H", 3), ("A", 3), ("b", 1), ("bnr", 1)]),
    SolidRow { kind: SolidKind::Metaball, minors: &[36], words: &["metaball"], shape: SolidShape::Metaball },
];

/// Kinds of objects without a counterpart, by their numbers in binary files.
const FOREIGN: &[(u8, &str)] = &[
    (5, "ars"),
    (8, "poly"),
    (9, "bspline"),
    (11, "nmg"),
    (12, "ebm"),
    (13, "vol"),
    (22, "grip"),
    (23, "joint"),
    (24, "hf"),
    (25, "dsp"),
    (26, "sketch"),
    (27, "extrude"),
    (28, "submodel"),
    (29, "cline"),
    (30, "bot"),
    (37, "brep"),
    (39, "constraint"),
    (40, "revolve"),
    (41, "pnts"),
    (42, "annot"),
    (43, "hrt"),
    (44, "datum"),
    (45, "script"),
    (46, "material"),
];

const fn row(
    kind: SolidKind,
    minors: &'static [u8],
    words: &'static [&'static str],
    fields: &'static [(&'static str, usize)],
) -> SolidRow {
    SolidRow { kind, minors, words, shape: SolidShape::Fixed(fields) }
}

impl SolidShape {
    /// How many numbers it has without its list, and each entry of the list.
    pub(super) fn counts(self) -> (usize, usize) {
        let sum = |fields: &[(&str, usize)]| fields.iter().map(|(_, count)| count).sum();
        match self {
            Self::Fixed(fields) => (sum(fields), 0),
            Self::List(fields) => (0, sum(fields)),
            Self::Metaball => (2, 5),
        }
    }
}

impl SolidKind {
    /// Its word in text files.
    pub(super) fn word(self) -> &'static str {
        SOLIDS.iter().find(|row| row.kind == self).map_or("solid", |row| row.words[0])
    }
}

/// The row of a number of binary files.
pub(super) fn of_minor(minor: u8) -> Option<&'static SolidRow> {
    SOLIDS.iter().find(|row| row.minors.contains(&minor))
}

/// The row of a word of text files.
pub(super) fn of_word(word: &[u8]) -> Option<&'static SolidRow> {
    SOLIDS.iter().find(|row| row.words.iter().any(|own| own.as_bytes() == word))
}

/// The name of a kind that is not read, by its number in binary files.
pub(super) fn foreign(minor: u8) -> String {
    let known = FOREIGN.iter().find(|(number, _)| *number == minor);
    known.map_or_else(|| format!("kind {minor}"), |(_, name)| (*name).to_owned())
}

/// Where each of the 8 points of a block is among fewer points: those of an arb4 to an arb7.
pub(super) const fn block_points(count: usize) -> Option<[usize; 8]> {
    match count {
        4 => Some([0, 1, 2, 2, 3, 3, 3, 3]),
        5 => Some([0, 1, 2, 3, 4, 4, 4, 4]),
        6 => Some([0, 1, 2, 3, 4, 4, 5, 5]),
        7 => Some([0, 1, 2, 3, 4, 5, 6, 4]),
        8 => Some([0, 1, 2, 3, 4, 5, 6, 7]),
        _ => None,
    }
}
