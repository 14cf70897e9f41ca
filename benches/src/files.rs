//! Files of other programs, as large as they are in practice, written from nothing but a seed.

use std::fmt::Write;

use fastrand::Rng;

/// Parts of a database along an axis, and solids in each.
const ACROSS: usize = 10;
/// Solids of a part.
const SOLIDS: usize = 8;

/// A structure of a molecule with so many atoms (PDB), 81 bytes each.
#[must_use]
pub fn structure(atoms: usize) -> Vec<u8> {
    let mut rng = Rng::with_seed(2);
    let mut text = String::with_capacity(81 * atoms + 4);
    let kinds = [(" N  ", "N"), (" CA ", "C"), (" C  ", "C"), (" O  ", "O"), (" CB ", "C"), (" SG ", "S")];
    for atom in 0..atoms {
        let (name, element) = kinds[atom % kinds.len()];
        let residue = atom / kinds.len();
        let chain = char::from(b'A' + (residue / 9999 % 26) as u8);
        let [x, y, z] = [(); 3].map(|()| 300.0 * rng.f64() - 150.0);
        let (serial, number, bfac) = ((atom + 1) % 100_000, residue % 9999 + 1, 60.0 * rng.f64());
        let _ = writeln!(
            text,
            "ATOM  {serial:5} {name} CYS {chain}{number:4}    {x:8.3}{y:8.3}{z:8.3}  1.00{bfac:6.2}          {element:>2}  "
        );
    }
    text.push_str("END\n");
    text.into_bytes()
}

/// A database of 1,000 parts in a lattice, 8,000 solids (BRL-CAD, `.asc` of version 5): each part is a block
/// with three holes, a dent, and three solids on it. Parts are unlike each other, or one part that is used
/// 1,000 times.
#[must_use]
pub fn database(is_one_part: bool) -> Vec<u8> {
    let mut rng = Rng::with_seed(1);
    let mut text = "title {parts}\nunits mm\n".to_owned();
    let parts = ACROSS * ACROSS * ACROSS;
    for part in 0..if is_one_part { 1 } else { parts } {
        write_part(&mut text, part, &mut rng);
    }
    let along = |axis: usize, name: &dyn Fn(usize) -> String| {
        let member = |place: usize| {
            let mut shift = [0; 3];
            shift[axis] = 10 * place;
            let [x, y, z] = shift;
            format!("{{l {} {{1 0 0 {x}  0 1 0 {y}  0 0 1 {z}  0 0 0 1}}}}", name(place))
        };
        (1..ACROSS).fold(member(0), |tree, place| format!("{{u {tree} {}}}", member(place)))
    };
    for z in 0..ACROSS {
        for y in 0..ACROSS {
            let part = |x: usize| if is_one_part { 0 } else { (z * ACROSS + y) * ACROSS + x };
            let row = along(0, &|x| format!("r{}", part(x)));
            let _ = writeln!(text, "put row{z}.{y} comb region no tree {row}");
        }
        let layer = along(1, &|y| format!("row{z}.{y}"));
        let _ = writeln!(text, "put layer{z} comb region no tree {layer}");
    }
    let all = along(2, &|z| format!("layer{z}"));
    let _ = writeln!(text, "put all.g comb region no tree {all}");
    text.into_bytes()
}

/// The solids of a part, and its region.
fn write_part(text: &mut String, part: usize, rng: &mut Rng) {
    let [a, b, c] = [(); 3].map(|()| 3.2 + rng.f64());
    let r = 0.6 + 0.5 * rng.f64();
    let (wide, low, thin, high) = (r + 1.0, 0.6 * r, 0.7 * r, 2.0 * c);
    let solids: [String; SOLIDS] = [
        format!(
            "arb8 V1 {{{a} -{b} -{c}}} V2 {{{a} {b} -{c}}} V3 {{{a} {b} {c}}} V4 {{{a} -{b} {c}}} \
             V5 {{-{a} -{b} -{c}}} V6 {{-{a} {b} -{c}}} V7 {{-{a} {b} {c}}} V8 {{-{a} -{b} {c}}}"
        ),
        format!("tgc V {{-6 0 0}} H {{12 0 0}} A {{0 {r} 0}} B {{0 0 {r}}} C {{0 {r} 0}} D {{0 0 {r}}}"),
        format!("tgc V {{0 -6 0}} H {{0 12 0}} A {{0 0 {r}}} B {{{r} 0 0}} C {{0 0 {r}}} D {{{r} 0 0}}"),
        format!("tgc V {{0 0 -6}} H {{0 0 12}} A {{{r} 0 0}} B {{0 {r} 0}} C {{{r} 0 0}} D {{0 {r} 0}}"),
        format!("ell V {{0 0 -{c}}} A {{2 0 0}} B {{0 1.5 0}} C {{0 0 {r}}}"),
        format!("ell V {{{a} {b} {c}}} A {{{r} 0 0}} B {{0 {r} 0}} C {{0 0 {r}}}"),
        format!("tor V {{0 0 {c}}} H {{0 0 1}} r_a {wide} r_h {low}"),
        format!("part V {{-{a} -{b} -{c}}} H {{0 0 {high}}} r_v {r} r_h {thin}"),
    ];
    for (place, solid) in solids.iter().enumerate() {
        let _ = writeln!(text, "put s{part}.{place} {solid}");
    }
    let step = |tree: String, place: usize| {
        let sign = if (1..5).contains(&place) { '-' } else { 'u' };
        format!("{{{sign} {tree} {{l s{part}.{place}}}}}")
    };
    let tree = (1..SOLIDS).fold(format!("{{l s{part}.0}}"), step);
    let _ = writeln!(text, "put r{part} comb region yes tree {tree}");
    let [red, green, blue] = [(); 3].map(|()| rng.u8(60..));
    let _ = writeln!(text, "attr set {{r{part}}} {{region}} {{R}} {{color}} {{{red}/{green}/{blue}}}");
}
