//! How the crossings of one cell join into sheets, for each of its 256 cases.
//!
//! Corners are numbered `x + 2 y + 4 z`; edges `4 axis + b + 2 c`, with `(b, c)` their place along the two
//! axes that follow their own; faces `2 axis + side`. On each face, the crossings of its edges are joined in
//! pairs. Where four are crossed (the corners alternate), each corner inside is cut off, or each one outside
//! if the face is flipped. Edges that are joined bound one sheet.

/// The sheets of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheets {
    /// The sheet of each crossed edge, from 0 in the order of the edges; [`NONE`] where an edge is not
    /// crossed.
    pub(super) of_edge: [u8; 12],
    /// How many there are: 0 to 4.
    pub(super) count: u8,
    /// Ambiguous faces, a bit each, whose four crossings are all on one sheet. If they are so in both cells,
    /// the mesh is pinched there.
    pub(super) pinched: u8,
}

/// No sheet.
const NONE: u8 = u8::MAX;

/// The corner that an edge begins at. The other one is a step along its axis further.
pub(super) const fn first_corner(edge: usize) -> usize {
    let axis = edge / 4;
    (edge % 2) << ((axis + 1) % 3) | (edge / 2 % 2) << ((axis + 2) % 3)
}

const fn is_inside(signs: u8, corner: usize) -> bool {
    signs >> corner & 1 == 1
}

const fn is_crossed(signs: u8, edge: usize) -> bool {
    let corner = first_corner(edge);
    is_inside(signs, corner) != is_inside(signs, corner | 1 << (edge / 4))
}

/// The corners of a face in a ring, and the edges that follow them in it.
const fn ring(face: usize) -> ([usize; 4], [usize; 4]) {
    let (axis, side) = (face / 2, face % 2);
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let start = side << axis;
    let corners = [start, start | 1 << b, start | 1 << b | 1 << c, start | 1 << c];
    // The edges along b are at (c, axis) of their own numbering, those along c at (axis, b).
    let edges = [4 * b + 2 * side, 4 * c + side + 2, 4 * b + 1 + 2 * side, 4 * c + side];
    (corners, edges)
}

/// Gives all edges of one group the name of the other.
const fn join(mut group: [u8; 12], a: usize, b: usize) -> [u8; 12] {
    let (from, to) = (group[a], group[b]);
    let mut edge = 0;
    while edge < 12 {
        if group[edge] == from {
            group[edge] = to;
        }
        edge += 1;
    }
    group
}

/// The sheets of a cell with these corners inside and these ambiguous faces flipped, a bit each.
pub(super) const fn sheets(signs: u8, flips: u8) -> Sheets {
    let mut group = [NONE; 12];
    let mut edge = 0;
    while edge < 12 {
        if is_crossed(signs, edge) {
            group[edge] = edge as u8;
        }
        edge += 1;
    }
    let mut ambiguous = 0_u8;
    let mut face = 0;
    while face < 6 {
        let (corners, edges) = ring(face);
        let mut crossed = [0; 4];
        let mut count = 0;
        let mut n = 0;
        while n < 4 {
            if is_crossed(signs, edges[n]) {
                crossed[count] = edges[n];
                count += 1;
            }
            n += 1;
        }
        if count == 2 {
            group = join(group, crossed[0], crossed[1]);
        } else if count == 4 {
            ambiguous |= 1 << face;
            // Corner n + 1 is between the edges n and n + 1.
            let cuts_odd = is_inside(signs, corners[1]) != (flips >> face & 1 == 1);
            let first = if cuts_odd { 0 } else { 1 };
            group = join(group, edges[first], edges[first + 1]);
            group = join(group, edges[first + 2], edges[(first + 3) % 4]);
        }
        face += 1;
    }
    number(group, ambiguous)
}

/// Numbers groups in the order of their first edges, and finds the pinched ones among the ambiguous faces.
const fn number(group: [u8; 12], ambiguous: u8) -> Sheets {
    let mut names = [NONE; 12];
    let mut sheets = Sheets { of_edge: [NONE; 12], count: 0, pinched: 0 };
    let mut edge = 0;
    while edge < 12 {
        if group[edge] != NONE {
            let name = group[edge] as usize;
            if names[name] == NONE {
                names[name] = sheets.count;
                sheets.count += 1;
            }
            sheets.of_edge[edge] = names[name];
        }
        edge += 1;
    }
    let mut face = 0;
    while face < 6 {
        let (_, [p, q, r, s]) = ring(face);
        if ambiguous >> face & 1 == 1 && group[p] == group[q] && group[q] == group[r] && group[r] == group[s]
        {
            sheets.pinched |= 1 << face;
        }
        face += 1;
    }
    sheets
}

/// The sheets of the cells without flipped faces.
pub(super) static SHEETS: [Sheets; 256] = {
    let mut all = [Sheets { of_edge: [NONE; 12], count: 0, pinched: 0 }; 256];
    let mut signs = 0;
    while signs < 256 {
        all[signs] = sheets(signs as u8, 0);
        signs += 1;
    }
    all
};

/// The sheet of a crossed edge.
#[inline]
pub(super) fn sheet_of_edge(signs: u8, flips: u8, edge: usize) -> u32 {
    // Flipped faces are rare.
    let sheets = if flips == 0 { &SHEETS[usize::from(signs)] } else { &sheets(signs, flips) };
    u32::from(sheets.of_edge[edge])
}

/// The crossed edges, a bit each.
pub(super) static CROSSED: [u16; 256] = {
    let mut all = [0; 256];
    let mut signs = 0;
    while signs < 256 {
        let mut edge = 0;
        while edge < 12 {
            all[signs] |= (is_crossed(signs as u8, edge) as u16) << edge;
            edge += 1;
        }
        signs += 1;
    }
    all
};
