//! Facts about elements: how large their atoms are, and the colours that chemists know them by.

/// The facts about an element.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ElementFacts {
    /// As it is written.
    pub symbol: &'static str,
    /// The van der Waals radius in Angstrom: Bondi (1964), and Mantina and others (2009) for main-group
    /// elements; 2 for metals that neither has.
    pub radius: f64,
    /// The colour that Jmol gives it, as a screen is given it (sRGB).
    pub color: [u8; 3],
}

impl ElementFacts {
    /// What an atom of no known element has.
    pub const UNKNOWN: Self = Self { symbol: "X", radius: 2.0, color: [0xff, 0x14, 0x93] };

    const fn new((symbol, radius, color): (&'static str, f64, u32)) -> Self {
        let [_, red, green, blue] = color.to_be_bytes();
        Self { symbol, radius, color: [red, green, blue] }
    }
}

/// The elements by their atomic number, from 1: symbol, radius, colour.
#[rustfmt::skip]
const FACTS: [(&str, f64, u32); 109] = [
    ("H", 1.10, 0xffffff), ("He", 1.40, 0xd9ffff), ("Li", 1.81, 0xcc80ff),
    ("Be", 1.53, 0xc2ff00), ("B", 1.92, 0xffb5b5), ("C", 1.70, 0x909090),
    ("N", 1.55, 0x3050f8), ("O", 1.52, 0xff0d0d), ("F", 1.47, 0x90e050),
    ("Ne", 1.54, 0xb3e3f5), ("Na", 2.27, 0xab5cf2), ("Mg", 1.73, 0x8aff00),
    ("Al", 1.84, 0xbfa6a6), ("Si", 2.10, 0xf0c8a0), ("P", 1.80, 0xff8000),
    ("S", 1.80, 0xffff30), ("Cl", 1.75, 0x1ff01f), ("Ar", 1.88, 0x80d1e3),
    ("K", 2.75, 0x8f40d4), ("Ca", 2.31, 0x3dff00), ("Sc", 2.00, 0xe6e6e6),
    ("Ti", 2.00, 0xbfc2c7), ("V", 2.00, 0xa6a6ab), ("Cr", 2.00, 0x8a99c7),
    ("Mn", 2.00, 0x9c7ac7), ("Fe", 2.00, 0xe06633), ("Co", 2.00, 0xf090a0),
    ("Ni", 1.63, 0x50d050), ("Cu", 1.40, 0xc88033), ("Zn", 1.39, 0x7d80b0),
    ("Ga", 1.87, 0xc28f8f), ("Ge", 2.11, 0x668f8f), ("As", 1.85, 0xbd80e3),
    ("Se", 1.90, 0xffa100), ("Br", 1.83, 0xa62929), ("Kr", 2.02, 0x5cb8d1),
    ("Rb", 3.03, 0x702eb0), ("Sr", 2.49, 0x00ff00), ("Y", 2.00, 0x94ffff),
    ("Zr", 2.00, 0x94e0e0), ("Nb", 2.00, 0x73c2c9), ("Mo", 2.00, 0x54b5b5),
    ("Tc", 2.00, 0x3b9e9e), ("Ru", 2.00, 0x248f8f), ("Rh", 2.00, 0x0a7d8c),
    ("Pd", 1.63, 0x006985), ("Ag", 1.72, 0xc0c0c0), ("Cd", 1.58, 0xffd98f),
    ("In", 1.93, 0xa67573), ("Sn", 2.17, 0x668080), ("Sb", 2.06, 0x9e63b5),
    ("Te", 2.06, 0xd47a00), ("I", 1.98, 0x940094), ("Xe", 2.16, 0x429eb0),
    ("Cs", 3.43, 0x57178f), ("Ba", 2.68, 0x00c900), ("La", 2.00, 0x70d4ff),
    ("Ce", 2.00, 0xffffc7), ("Pr", 2.00, 0xd9ffc7), ("Nd", 2.00, 0xc7ffc7),
    ("Pm", 2.00, 0xa3ffc7), ("Sm", 2.00, 0x8fffc7), ("Eu", 2.00, 0x61ffc7),
    ("Gd", 2.00, 0x45ffc7), ("Tb", 2.00, 0x30ffc7), ("Dy", 2.00, 0x1fffc7),
    ("Ho", 2.00, 0x00ff9c), ("Er", 2.00, 0x00e675), ("Tm", 2.00, 0x00d452),
    ("Yb", 2.00, 0x00bf38), ("Lu", 2.00, 0x00ab24), ("Hf", 2.00, 0x4dc2ff),
    ("Ta", 2.00, 0x4da6ff), ("W", 2.00, 0x2194d6), ("Re", 2.00, 0x267dab),
    ("Os", 2.00, 0x266696), ("Ir", 2.00, 0x175487), ("Pt", 1.75, 0xd0d0e0),
    ("Au", 1.66, 0xffd123), ("Hg", 1.55, 0xb8b8d0), ("Tl", 1.96, 0xa6544d),
    ("Pb", 2.02, 0x575961), ("Bi", 2.07, 0x9e4fb5), ("Po", 1.97, 0xab5c00),
    ("At", 2.02, 0x754f45), ("Rn", 2.20, 0x428296), ("Fr", 3.48, 0x420066),
    ("Ra", 2.83, 0x007d00), ("Ac", 2.00, 0x70abfa), ("Th", 2.00, 0x00baff),
    ("Pa", 2.00, 0x00a1ff), ("U", 1.86, 0x008fff), ("Np", 2.00, 0x0080ff),
    ("Pu", 2.00, 0x006bff), ("Am", 2.00, 0x545cf2), ("Cm", 2.00, 0x785ce3),
    ("Bk", 2.00, 0x8a4fe3), ("Cf", 2.00, 0xa136d4), ("Es", 2.00, 0xb31fd4),
    ("Fm", 2.00, 0xb31fba), ("Md", 2.00, 0xb30da6), ("No", 2.00, 0xbd0d87),
    ("Lr", 2.00, 0xc70066), ("Rf", 2.00, 0xcc0059), ("Db", 2.00, 0xd1004f),
    ("Sg", 2.00, 0xd90045), ("Bh", 2.00, 0xe00038), ("Hs", 2.00, 0xe6002e),
    ("Mt", 2.00, 0xeb0026),
];

/// The elements by their atomic number less one.
pub const ELEMENTS: [ElementFacts; 109] = {
    let mut all = [ElementFacts::UNKNOWN; FACTS.len()];
    let mut index = 0;
    while index < FACTS.len() {
        all[index] = ElementFacts::new(FACTS[index]);
        index += 1;
    }
    all
};

/// The element of a symbol, in capitals or not: by its place in [`ELEMENTS`]. D and T are hydrogen.
#[must_use]
pub fn element(symbol: &[u8]) -> Option<usize> {
    let symbol: &[u8] = match symbol {
        b"D" | b"d" | b"T" | b"t" => b"H",
        symbol => symbol,
    };
    ELEMENTS.iter().position(|facts| facts.symbol.as_bytes().eq_ignore_ascii_case(symbol))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Those of Mantina, Chamberlin, Valero, Cramer and Truhlar (J. Phys. Chem. A 113, 5806, 2009), in which
    /// Bondi's (J. Phys. Chem. 68, 441, 1964) of main-group elements are included.
    const MAIN_GROUP: &str = "H 1.10 He 1.40 Li 1.81 Be 1.53 B 1.92 C 1.70 N 1.55 O 1.52 F 1.47 Ne 1.54 Na 2.27 \
        Mg 1.73 Al 1.84 Si 2.10 P 1.80 S 1.80 Cl 1.75 Ar 1.88 K 2.75 Ca 2.31 Ga 1.87 Ge 2.11 As 1.85 Se 1.90 \
        Br 1.83 Kr 2.02 Rb 3.03 Sr 2.49 In 1.93 Sn 2.17 Sb 2.06 Te 2.06 I 1.98 Xe 2.16 Cs 3.43 Ba 2.68 Tl 1.96 \
        Pb 2.02 Bi 2.07 Po 1.97 At 2.02 Rn 2.20 Fr 3.48 Ra 2.83";
    /// Bondi's radii of transition metals and of uranium.
    const OTHERS: &str = "Ni 1.63 Cu 1.40 Zn 1.39 Pd 1.63 Ag 1.72 Cd 1.58 Pt 1.75 Au 1.66 Hg 1.55 U 1.86";

    #[test]
    fn radii_are_those_of_bondi_and_mantina() {
        let words: Vec<&str> = MAIN_GROUP.split_whitespace().chain(OTHERS.split_whitespace()).collect();
        let known: Vec<usize> =
            words.chunks(2).map(|pair| element(pair[0].as_bytes()).expect("it is an element")).collect();
        for (&index, pair) in known.iter().zip(words.chunks(2)) {
            assert_eq!(Ok(ELEMENTS[index].radius), pair[1].parse(), "{}", pair[0]);
        }
        for (index, facts) in ELEMENTS.iter().enumerate() {
            assert!(known.contains(&index) || facts.radius == 2.0, "{}", facts.symbol);
        }
    }

    #[test]
    fn symbols_are_found_in_any_case() {
        let number = |symbol: &str| element(symbol.as_bytes()).map(|index| index + 1);
        assert_eq!([number("CL"), number("cl"), number("D"), number("mt")], [17, 17, 1, 109].map(Some));
        assert_eq!([number("Xx"), number("")], [None; 2]);
        assert_eq!(ELEMENTS[5].color, [0x90; 3]);
    }
}
