//! One cell: which of its edges the surface crosses, and how the crossings join into sheets.
//!
//! ```text
//!        6-------7        corner = x + 2 y + 4 z
//!       /|      /|        edge   = 4 axis + b + 2 c, where (b, c) is its place along the two axes
//!      4-------5 |                 that follow its own (x: y z, y: z x, z: x y)
//!      | 2-----|-3        face   = 2 axis + side
//!      |/      |/
//!      0-------1          z up, y into the page, x to the right
//! ```
//!
//! A face of the cell is crossed on none, two or all four of its edges. Two crossings are joined by a
//! segment. A face with four crossings is *ambiguous*: its corners alternate. Two segments join its crossings
//! in one of two ways, each of which cuts off a pair of opposite corners. The default cuts off the corners
//! inside, which separates their neighbourhoods; a *flipped* face cuts off the corners outside. Every crossed
//! edge lies on two faces and so has two segments: the segments form cycles, and each cycle bounds one
//! *sheet* of the surface in this cell (Nielson 2004, "Dual marching cubes").
//!
//! All 256 cases follow from these sentences and are computed when this crate is compiled.

mod cases;
mod cycles;

pub(crate) use cases::{CellCases, case, low_turns};
pub(crate) use cycles::following;

/// Marks an edge that the surface does not cross.
const NO_SHEET: u8 = u8::MAX;

/// The two corners of an edge, the lower one first.
pub(crate) const EDGE_CORNERS: [[usize; 2]; 12] = {
    let mut corners = [[0; 2]; 12];
    let mut edge = 0;
    while edge < 12 {
        let axis = edge / 4;
        let low = ((edge & 1) << ((axis + 1) % 3)) | (((edge >> 1) & 1) << ((axis + 2) % 3));
        corners[edge] = [low, low | (1 << axis)];
        edge += 1;
    }
    corners
};

/// The two faces that each edge lies on, a bit each.
const EDGE_FACES: [u8; 12] = {
    let mut faces = [0; 12];
    let mut edge = 0;
    while edge < 12 {
        let (b, c) = ((edge / 4 + 1) % 3, (edge / 4 + 2) % 3);
        faces[edge] = 1 << (2 * b + (edge & 1)) | 1 << (2 * c + (edge >> 1 & 1));
        edge += 1;
    }
    faces
};

/// The corners of a face, in the order of a walk around it.
const fn ring(face: usize) -> [usize; 4] {
    let axis = face / 2;
    let start = (face & 1) << axis;
    let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    [start, start | b, start | b | c, start | c]
}

/// The edge between two corners that differ along one axis.
const fn edge_between(p: usize, q: usize) -> usize {
    let axis = (p ^ q).trailing_zeros() as usize;
    4 * axis + ((p >> ((axis + 1) % 3)) & 1) + 2 * ((p >> ((axis + 2) % 3)) & 1)
}

/// The four edges of a face; edge `i` lies between corners `i` and `i + 1` of its [`ring`].
const fn ring_edges(face: usize) -> [usize; 4] {
    let [p, q, r, s] = ring(face);
    [edge_between(p, q), edge_between(q, r), edge_between(r, s), edge_between(s, p)]
}

const fn inside(signs: u8, corner: usize) -> bool {
    signs >> corner & 1 == 1
}

/// Whether the corners of a face alternate between inside and outside.
const fn ambiguous(signs: u8, face: usize) -> bool {
    let [p, q, r, s] = ring(face);
    inside(signs, p) == inside(signs, r)
        && inside(signs, q) == inside(signs, s)
        && inside(signs, p) != inside(signs, q)
}

/// The sheets of the surface in one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sheets {
    /// The sheet that each edge belongs to, or [`NO_SHEET`].
    of_edge: [u8; 12],
    /// The number of sheets, from 0 to 4, in the order of their first edges.
    count: u8,
    /// A bit for each ambiguous face with both segments on one sheet.
    pinched: u8,
}

impl Sheets {
    /// The number of sheets.
    pub(crate) const fn count(&self) -> u32 {
        self.count as u32
    }

    /// The sheet of an edge that the surface crosses.
    #[cfg(test)]
    pub(crate) fn of_edge(&self, edge: usize) -> Option<u32> {
        let sheet = self.of_edge[edge];
        (sheet != NO_SHEET).then_some(u32::from(sheet))
    }

    /// The sheets of all edges in one number.
    pub(crate) const fn numbers(&self) -> SheetNumbers {
        let (mut numbers, mut edge) = (0, 0);
        while edge < 12 {
            if self.of_edge[edge] != NO_SHEET {
                numbers |= (self.of_edge[edge] as u32) << (2 * edge);
            }
            edge += 1;
        }
        SheetNumbers(numbers)
    }

    /// Whether a face is ambiguous and both of its segments lie on one sheet. If this holds in both cells of
    /// the face, their two sheets share an edge of the mesh twice, and that edge has four triangles.
    pub(crate) fn pinched(&self, face: usize) -> bool {
        self.pinched >> face & 1 == 1
    }

    /// The edges of a sheet, a bit each.
    pub(crate) const fn edges(&self, sheet: u32) -> u16 {
        let (mut edges, mut edge) = (0, 0);
        while edge < 12 {
            edges |= ((self.of_edge[edge] as u32 == sheet) as u16) << edge;
            edge += 1;
        }
        edges
    }

    /// The sheets that have quads in a cell that touches these sides of the lattice (a bit for each face): an
    /// edge on a side lacks some of its four cells.
    fn with_quads(self, sides: u8) -> Sheets {
        let mut names = [NO_SHEET; 4];
        let mut count = 0;
        for sheet in 0..self.count {
            if self.edges(u32::from(sheet)) & inner_edges(sides) != 0 {
                names[usize::from(sheet)] = count;
                count += 1;
            }
        }
        let name = |sheet: u8| if sheet == NO_SHEET { NO_SHEET } else { names[usize::from(sheet)] };
        Sheets { of_edge: self.of_edge.map(name), count, ..self }
    }

    /// From the corners that are inside and the faces that are flipped, a bit each; flips of faces that are
    /// not ambiguous have no effect.
    const fn new(signs: u8, flips: u8) -> Sheets {
        // Every crossed edge starts alone, and each segment joins the groups of its ends under the smaller
        // number.
        let mut group = [NO_SHEET; 12];
        let mut edge = 0;
        while edge < 12 {
            let [low, high] = EDGE_CORNERS[edge];
            if inside(signs, low) != inside(signs, high) {
                group[edge] = edge as u8;
            }
            edge += 1;
        }
        let mut face = 0;
        while face < 6 {
            group = join_face(group, signs, face, flips >> face & 1 == 1);
            face += 1;
        }
        let mut pinched = 0;
        face = 0;
        while face < 6 {
            let [p, q, r, s] = ring_edges(face);
            if ambiguous(signs, face) && group[p] == group[q] && group[q] == group[r] && group[r] == group[s]
            {
                pinched |= 1 << face;
            }
            face += 1;
        }
        number(group, pinched)
    }
}

/// Joins the crossings of one face by its segments.
const fn join_face(group: [u8; 12], signs: u8, face: usize, flipped: bool) -> [u8; 12] {
    let (corners, edges) = (ring(face), ring_edges(face));
    let mut group = group;
    if ambiguous(signs, face) {
        let mut i = 0;
        while i < 4 {
            if inside(signs, corners[i]) != flipped {
                group = join(group, edges[(i + 3) % 4], edges[i]);
            }
            i += 1;
        }
    } else {
        let mut first = None;
        let mut i = 0;
        while i < 4 {
            if group[edges[i]] != NO_SHEET {
                match first {
                    None => first = Some(edges[i]),
                    Some(other) => group = join(group, other, edges[i]),
                }
            }
            i += 1;
        }
    }
    group
}

const fn join(group: [u8; 12], a: usize, b: usize) -> [u8; 12] {
    let mut group = group;
    let (low, high) = if group[a] < group[b] { (group[a], group[b]) } else { (group[b], group[a]) };
    let mut edge = 0;
    while edge < 12 {
        if group[edge] == high {
            group[edge] = low;
        }
        edge += 1;
    }
    group
}

/// Numbers the groups from 0. A group is named by its first edge, which comes first in the walk.
const fn number(group: [u8; 12], pinched: u8) -> Sheets {
    let mut of_edge = [NO_SHEET; 12];
    let mut count = 0;
    let mut edge = 0;
    while edge < 12 {
        if group[edge] as usize == edge {
            of_edge[edge] = count;
            count += 1;
        } else if group[edge] != NO_SHEET {
            of_edge[edge] = of_edge[group[edge] as usize];
        }
        edge += 1;
    }
    Sheets { of_edge, count, pinched }
}

/// The sheets of every case without flipped faces.
static DEFAULT: [Sheets; 256] = {
    let mut sheets = [Sheets { of_edge: [NO_SHEET; 12], count: 0, pinched: 0 }; 256];
    let mut signs = 0;
    while signs < 256 {
        sheets[signs] = Sheets::new(signs as u8, 0);
        signs += 1;
    }
    sheets
};

/// For each crossed edge of a cell that has a quad, the number of its sheet: two bits each, and zero for all
/// other edges. One more bit is a mark.
#[derive(Clone, Copy, Default)]
pub(crate) struct SheetNumbers(u32);

impl SheetNumbers {
    const MARK: u32 = 24;

    /// Whether all edges are on the first sheet.
    #[inline(always)]
    pub(crate) fn is_one(self) -> bool {
        self.0 == 0
    }

    /// These with a mark of 0 or 1; they have none yet.
    #[inline(always)]
    pub(crate) fn with_mark(self, mark: u32) -> Self {
        Self(self.0 | mark << Self::MARK)
    }

    /// The mark.
    #[inline(always)]
    pub(crate) fn mark(self) -> u32 {
        self.0 >> Self::MARK
    }

    /// The sheet of an edge; `place` is twice the edge's number.
    #[inline(always)]
    pub(crate) fn at(self, place: u32) -> u32 {
        self.0 >> place & 3
    }
}

/// The sheet numbers of every case without flipped faces.
static DEFAULT_NUMBERS: [SheetNumbers; 256] = {
    let mut numbers = [SheetNumbers(0); 256];
    let mut signs = 0;
    while signs < 256 {
        numbers[signs] = DEFAULT[signs].numbers();
        signs += 1;
    }
    numbers
};

/// The sheets of the edges of a cell without flipped faces, inside the lattice.
#[inline(always)]
pub(crate) fn default_numbers(signs: u8) -> SheetNumbers {
    DEFAULT_NUMBERS[usize::from(signs)]
}

/// The sheets of a cell, from its corners inside and its flipped faces, a bit each.
#[inline]
pub(crate) fn sheets(signs: u8, flips: u8) -> Sheets {
    // Flipped faces are rare, and a table of them would be 64 times as large as the default one.
    if flips == 0 { DEFAULT[usize::from(signs)] } else { Sheets::new(signs, flips) }
}

/// The sheets of a cell without flipped faces.
#[inline]
pub(crate) const fn default_sheets(signs: u8) -> &'static Sheets {
    &DEFAULT[signs as usize]
}

/// The sheets that become vertices of a cell that touches these sides of the lattice.
pub(crate) fn sheets_with_quads(signs: u8, flips: u8, sides: u8) -> Sheets {
    let sheets = sheets(signs, flips);
    if sides == 0 { sheets } else { sheets.with_quads(sides) }
}

/// A set of crossed edges of a cell, all on one sheet, in one number: a bit for each edge; then, in three
/// bits for each axis, the number of edges along other axes that lie on the high side of the cell; then the
/// number of edges.
#[derive(Clone, Copy, Default)]
pub(crate) struct SheetEdges(u32);

impl SheetEdges {
    /// The first bit after the bits of the edges.
    const HIGH: u32 = 12;
    /// The first bit of the number of edges.
    const COUNT: u32 = Self::HIGH + 9;

    /// From the edges, a bit each.
    const fn new(mask: u16) -> Self {
        let (mut code, mut edge) = (mask as u32, 0);
        while edge < 12 {
            let mut axis = 0;
            while axis < 3 {
                let is_high = mask >> edge & 1 == 1 && EDGE_FACES[edge] >> (2 * axis + 1) & 1 == 1;
                code += (is_high as u32) << (Self::HIGH + 3 * axis);
                axis += 1;
            }
            edge += 1;
        }
        Self(code | mask.count_ones() << Self::COUNT)
    }

    /// A bit for each edge.
    #[inline(always)]
    pub(crate) fn mask(self) -> u16 {
        (self.0 & 0xfff) as u16
    }

    /// All ones if an edge is in the set, zero otherwise.
    #[inline(always)]
    pub(crate) fn chosen(self, edge: usize) -> u32 {
        (self.0 >> edge & 1).wrapping_neg()
    }

    /// The number of edges along other axes that lie on the high side of the cell: at most 4.
    #[inline(always)]
    pub(crate) fn high(self, axis: usize) -> f32 {
        (self.0 >> (Self::HIGH + 3 * axis as u32) & 7) as i32 as f32
    }

    /// The number of edges.
    #[inline(always)]
    pub(crate) fn count(self) -> f32 {
        (self.0 >> Self::COUNT) as i32 as f32
    }

    /// The sum of the unit vectors along the edges, from outside to inside, where `signs` are the corners
    /// inside.
    pub(crate) fn rise(self, signs: u8) -> [f32; 3] {
        let mut rise = [0.0; 3];
        for edge in (0..12).filter(|&edge| self.chosen(edge) != 0) {
            rise[edge / 4] += if inside(signs, EDGE_CORNERS[edge][1]) { 1.0 } else { -1.0 };
        }
        rise
    }

    /// Whether any edge of the set has a quad in a cell that touches these sides of the lattice (a bit for
    /// each face): an edge on a side lacks some of its four cells.
    #[inline(always)]
    pub(crate) fn have_quad(self, sides: u8) -> bool {
        self.mask() & inner_edges(sides) != 0
    }

    /// Whether the mesh has a rim in a cell that touches these sides of the lattice. The edges of a sheet are
    /// a cycle, of which each two in a row share an edge of the mesh: where one has a quad and the next one
    /// has none, that edge has triangles on one side alone.
    #[inline(always)]
    pub(crate) fn have_rim(self, sides: u8) -> bool {
        self.have_quad(sides) && self.mask() & !inner_edges(sides) != 0
    }
}

/// The edges of the sheets of every case without flipped faces.
static DEFAULT_EDGES: [[SheetEdges; 4]; 256] = {
    let mut edges = [[SheetEdges(0); 4]; 256];
    let mut signs = 0;
    while signs < 256 {
        let mut sheet = 0;
        while sheet < DEFAULT[signs].count {
            edges[signs][sheet as usize] = SheetEdges::new(DEFAULT[signs].edges(sheet as u32));
            sheet += 1;
        }
        signs += 1;
    }
    edges
};

/// The edges of each sheet of a cell without flipped faces.
#[inline(always)]
pub(crate) fn default_edges(signs: u8) -> &'static [SheetEdges] {
    &DEFAULT_EDGES[usize::from(signs)][..usize::from(DEFAULT[usize::from(signs)].count)]
}

/// The edges of the first sheet of a cell without flipped faces.
#[inline(always)]
pub(crate) fn first_edges(signs: u8) -> SheetEdges {
    DEFAULT_EDGES[usize::from(signs)][0]
}

/// The edges of each sheet of a cell with flipped faces.
pub(crate) fn edges(signs: u8, flips: u8) -> Vec<SheetEdges> {
    let sheets = sheets(signs, flips);
    (0..sheets.count()).map(|sheet| SheetEdges::new(sheets.edges(sheet))).collect()
}

/// The edges with all four cells around them, a bit each, of a cell that touches these sides of the lattice
/// (a bit for each face).
#[inline(always)]
fn inner_edges(sides: u8) -> u16 {
    /// For each set of sides.
    static INNER: [u16; 64] = {
        let mut inner = [0; 64];
        let mut sides = 0;
        while sides < 64 {
            let mut edge = 0;
            while edge < 12 {
                inner[sides as usize] |= ((EDGE_FACES[edge] & sides == 0) as u16) << edge;
                edge += 1;
            }
            sides += 1;
        }
        inner
    };
    INNER[usize::from(sides & 63)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ambiguous_faces(signs: u8) -> u8 {
        (0..6).filter(|&face| ambiguous(signs, face)).fold(0, |mask, face| mask | 1 << face)
    }

    #[test]
    fn edges_and_faces_agree_about_their_corners() {
        for (edge, [low, high]) in EDGE_CORNERS.into_iter().enumerate() {
            assert_eq!(high - low, 1 << (edge / 4));
            assert_eq!(edge_between(low, high), edge);
            assert_eq!(edge_between(high, low), edge);
            let faces = (0..6).filter(|&face| ring_edges(face).contains(&edge)).count();
            assert_eq!(faces, 2);
        }
    }

    #[test]
    fn known_cases() {
        assert_eq!(sheets(0, 0).count(), 0);
        assert_eq!(sheets(255, 0).count(), 0);
        assert_eq!(sheets(0b0000_0001, 0).count(), 1);
        // Two opposite corners of a face: apart by default, one sheet when the face is flipped (face 4 is z =
        // 0).
        assert_eq!(sheets(0b0000_1001, 0).count(), 2);
        assert_eq!(sheets(0b0000_1001, 1 << 4).count(), 1);
        // The checkerboard: four corners cut off, of the one or of the other kind.
        assert_eq!(sheets(0b0110_1001, 0).count(), 4);
        assert_eq!(sheets(0b0110_1001, 0b11_1111).count(), 4);
        assert_eq!(sheets(0b1001_0110, 0).count(), 4);
        // The complement of two opposite corners of a face: a tunnel, which pinches that face.
        let tunnel = sheets(!0b0000_1001, 0);
        assert_eq!(tunnel.count(), 1);
        assert!(tunnel.pinched(4));
        assert_eq!(sheets(!0b0000_1001, 1 << 4).count(), 2);
    }

    #[test]
    fn a_cell_and_its_complement_agree_when_all_faces_flip() {
        for signs in 0..=255_u8 {
            assert_eq!(sheets(signs, 0), sheets(!signs, ambiguous_faces(signs)), "{signs:08b}");
        }
    }

    #[test]
    fn flipping_a_pinched_face_splits_one_sheet_in_two() {
        let mut seen = 0;
        for signs in 0..=255_u8 {
            let ambiguous = ambiguous_faces(signs);
            for flips in (0..64).filter(|flips| flips & !ambiguous == 0) {
                let before = sheets(signs, flips);
                for face in (0..6).filter(|&face| before.pinched(face)) {
                    let after = sheets(signs, flips ^ 1 << face);
                    assert_eq!(after.count(), before.count() + 1);
                    assert!(!after.pinched(face));
                    // Flips never merge sheets: edges of one sheet were on one sheet before.
                    for a in 0..12 {
                        for b in 0..12 {
                            assert!(
                                after.of_edge[a] != after.of_edge[b]
                                    || before.of_edge[a] == before.of_edge[b]
                            );
                        }
                    }
                    seen += 1;
                }
            }
        }
        assert!(seen > 100);
    }

    #[test]
    fn the_edges_of_all_sheets_are_those_that_are_crossed() {
        for signs in 1..255_u8 {
            let sheets = sheets(signs, 0);
            let all = (0..sheets.count()).fold(0, |all, sheet| all | sheets.edges(sheet));
            assert_eq!(all, default_edges(signs).iter().fold(0, |all, sheet| all | sheet.mask()));
        }
    }

    #[test]
    fn edges_know_how_many_they_are_and_where() {
        // Corner 0 is cut off, on the low side of everything; corner 7 is on the high side of two edges each.
        let [low, high] = [1, 128].map(|signs| default_edges(signs)[0]);
        assert_eq!(
            (low.count(), [0, 1, 2].map(|axis| low.high(axis)), low.rise(1)),
            (3.0, [0.0; 3], [-1.0; 3])
        );
        assert_eq!(
            (high.count(), [0, 1, 2].map(|axis| high.high(axis)), high.rise(128)),
            (3.0, [2.0; 3], [1.0; 3])
        );
        // The upper half is inside: four edges along z, two of them on the high side of x and of y.
        let half = default_edges(0b1111_0000)[0];
        assert_eq!((half.mask(), half.count(), half.rise(0b1111_0000)), (0xf00, 4.0, [0.0, 0.0, 4.0]));
        assert_eq!([0, 1, 2].map(|axis| half.high(axis)), [2.0, 2.0, 0.0]);
        assert_eq!([7, 8].map(|edge| half.chosen(edge)), [0, u32::MAX]);
    }

    #[test]
    fn sheets_at_the_side_of_the_lattice_may_have_no_quads() {
        // Corner 0 is cut off by the edges 0, 4 and 8, each of which lies on two of the low faces.
        assert_eq!(sheets_with_quads(1, 0, 0).count(), 1);
        assert_eq!(sheets_with_quads(1, 0, 0b00_0001).count(), 1);
        assert_eq!(sheets_with_quads(1, 0, 0b00_0101).count(), 0);
        // Opposite corners 0 and 7: one sheet is left, and it is the first.
        let left = sheets_with_quads(0b1000_0001, 0, 0b01_0101);
        assert_eq!((left.count(), left.of_edge(0), left.of_edge(3)), (1, None, Some(0)));
    }

    /// For all signs and all flips, each cycle is a sheet; around a single corner the direction is right.
    #[test]
    fn the_way_around_a_sheet_meets_all_its_edges() {
        for signs in 0..=255_u8 {
            for flips in 0..64 {
                let (sheets, next) = (sheets(signs, flips), following(signs, flips));
                for sheet in 0..sheets.count() {
                    let edges = sheets.edges(sheet);
                    let first = edges.trailing_zeros() as usize;
                    let (mut met, mut edge) = (0, first);
                    while met >> edge & 1 == 0 {
                        met |= 1 << edge;
                        edge = usize::from(next[edge]);
                    }
                    assert_eq!((met, edge), (edges, first), "{signs:08b}, flips {flips:06b}, sheet {sheet}");
                }
            }
        }
        // Corner 0 is inside: from x to y to z, which is counter-clockwise as seen from the other corners.
        // Corner 7 is the mirror image.
        assert_eq!([0, 4, 8].map(|edge| following(1, 0)[edge]), [4, 8, 0]);
        assert_eq!([3, 7, 11].map(|edge| following(128, 0)[edge]), [11, 3, 7]);
    }

    #[test]
    fn sheets_have_at_least_three_edges() {
        for signs in 0..=255_u8 {
            let sheets = sheets(signs, 0);
            for sheet in 0..sheets.count() {
                assert!((0..12).filter(|&edge| sheets.of_edge(edge) == Some(sheet)).count() >= 3);
            }
        }
    }
}
