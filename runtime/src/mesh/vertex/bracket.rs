//! Brackets: segments with one end inside and one outside, so that the surface is between them; and the
//! crossed edges of the lattice as brackets.
//!
//! ```text
//!     outside o-----------------------------------o inside     halved again and again,
//!                               o-----------------o            the surface stays between the ends
//!                               o--------o
//! ```
//!
//! The difference of the values at the ends tells a *jump* from a continuous field: where the field is
//! continuous, each halving about halves the difference; at a jump it stays. The ends of edges are points of
//! the lattice, and a middle depends on its two ends alone, so all cells around an edge, in any brick, find
//! the same.

use super::super::field::Field;
use crate::boxes::Box3;

/// Two points, and the field at them: the first is outside, the second inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    pub(super) ends: [[f32; 3]; 2],
    pub(super) values: [f32; 2],
}

impl Bracket {
    /// The middle of its ends. A coordinate that both ends share is kept exactly.
    pub(super) fn middle(&self) -> [f32; 3] {
        let [outside, inside] = self.ends;
        [0, 1, 2].map(|axis| 0.5 * outside[axis] + 0.5 * inside[axis])
    }

    /// The rise of the field from outside to inside. NaN where the field at an end is not finite.
    fn rise(&self) -> f32 {
        self.values[1] - self.values[0]
    }

    /// The largest distance of the ends along an axis.
    fn width(&self) -> f32 {
        let [outside, inside] = self.ends;
        (0..3).fold(0.0, |width, axis| (outside[axis] - inside[axis]).abs().max(width))
    }

    /// Where the surface is between its ends, for a linear field.
    fn secant(&self, iso: f32) -> [f32; 3] {
        let part = (iso - self.values[0]) / self.rise();
        let part = if (0.0..=1.0).contains(&part) { part } else { 0.5 };
        let [outside, inside] = self.ends;
        [0, 1, 2].map(|axis| {
            let (from, to) = (outside[axis], inside[axis]);
            if from == to { from } else { from * (1.0 - part) + to * part }
        })
    }

    /// Keeps the half that holds the surface.
    fn cut(&mut self, iso: f32, middle: [f32; 3], value: f32) {
        let end = usize::from(value >= iso);
        (self.ends[end], self.values[end]) = (middle, value);
    }
}

/// Room for points and the field at them.
#[derive(Default)]
pub(super) struct BracketPoints {
    planes: [Vec<f32>; 3],
    values: Vec<f32>,
}

impl BracketPoints {
    /// Evaluates the field at the points.
    pub(super) fn ask<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        points: impl Iterator<Item = [f32; 3]>,
    ) -> Result<&[f32], F::Error> {
        self.planes.iter_mut().for_each(Vec::clear);
        for point in points {
            self.planes.iter_mut().zip(point).for_each(|(plane, coordinate)| plane.push(coordinate));
        }
        let [x, y, z] = &self.planes;
        self.values.resize(x.len(), 0.0);
        if !x.is_empty() {
            field.field(region, x, y, z, &mut self.values)?;
        }
        Ok(&self.values)
    }

    /// Halves brackets a number of times. Returns the number of points evaluated.
    pub(super) fn halve<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        brackets: &mut [&mut Bracket],
        times: usize,
    ) -> Result<u64, F::Error> {
        for _ in 0..times {
            let values = self.ask(field, region, brackets.iter().map(|bracket| bracket.middle()))?;
            for (bracket, &value) in brackets.iter_mut().zip(values) {
                bracket.cut(iso, bracket.middle(), value);
            }
        }
        Ok((times * brackets.len()) as u64)
    }
}

/// The numbers of halvings after which an edge is examined; after the last one the bracket has its final
/// length.
const LOOKS: [usize; 4] = [0, 3, 6, 12];

/// A crossed edge of the lattice.
pub(super) struct CrossedEdge {
    bracket: Bracket,
    /// The rises and the widths at [`LOOKS`], up to the current look.
    rises: [f32; LOOKS.len()],
    widths: [f32; LOOKS.len()],
    /// The current look.
    look: usize,
}

impl CrossedEdge {
    /// An edge between two lattice points, the first outside and the second inside.
    pub(super) fn new(bracket: Bracket) -> Self {
        let mut edge = Self { bracket, rises: [0.0; LOOKS.len()], widths: [0.0; LOOKS.len()], look: 0 };
        edge.look(0);
        edge
    }

    fn look(&mut self, look: usize) {
        (self.rises[look], self.widths[look]) = (self.bracket.rise(), self.bracket.width());
        self.look = look;
    }

    /// The rise of the field along the whole edge; infinite where the field at an end is not finite.
    fn whole_rise(&self) -> f32 {
        if self.rises[0].is_nan() { f32::INFINITY } else { self.rises[0] }
    }

    /// The crossing of the surface: after the last look within 2^-13 of the edge.
    pub(super) fn crossing(&self) -> [f32; 3] {
        self.bracket.middle()
    }

    /// A point inside, next to the crossing.
    pub(super) fn inside(&self) -> [f32; 3] {
        self.bracket.ends[1]
    }

    /// Whether the rise is still more than a quarter of the rise at the previous look, where an eighth is
    /// usual; at the last look, whether it is a jump.
    fn may_jump(&self, look: usize) -> bool {
        if look + 1 == LOOKS.len() {
            return self.is_jump();
        }
        let [before, rise] = [self.rises[look - 1], self.rises[look]];
        !rise.is_finite() || rise > 0.25 * before
    }

    /// Whether the field jumps at the crossing: the last six halvings left more than a quarter of the rise,
    /// where 1/64 is usual. So a rise within 2^-12 of an edge counts as a jump.
    ///
    /// Far from the origin there may be no f32 left between the ends. Then all halvings count, with a
    /// stricter limit if they were few. With fewer than four halvings it is no jump.
    pub(super) fn is_jump(&self) -> bool {
        let [first, _, middle, last] = [0, 1, 2, 3].map(|look| (self.rises[look], self.widths[look]));
        if !last.0.is_finite() {
            return true;
        }
        let stays = |before: (f32, f32), narrowing: f32, limit: f32| {
            last.1 <= narrowing * before.1 && last.0 > limit * before.0
        };
        if last.1 <= middle.1 / 32.0 {
            return stays(middle, 1.0, 0.25);
        }
        stays(first, 1.0 / 32.0, 0.25) || stays(first, 1.0 / 16.0, 0.5)
    }
}

/// How a wall leans at a crossing: its crossings with the edge, and with two lines beside it.
///
/// ```text
///     o-----x--------o     the edge
///     o------x-------o     a line beside it, a little towards the middle of the cell
/// ```
pub(super) struct Leaning {
    axis: usize,
    /// The sides of the lines, and the lines; the edge is the first one.
    beside: [(usize, f32); 2],
    brackets: [Bracket; 3],
}

impl CrossedEdge {
    /// How the wall at its crossing leans towards the mean of the crossings around, in a cell with edges of
    /// this size.
    pub(super) fn leaning(&self, mean: [f64; 3], size: f32, cell: Box3) -> Leaning {
        /// How far the lines are beside the edge, in cells.
        const BESIDE: f32 = 1.0 / 256.0;
        /// How far they reach to both sides of the crossing.
        const REACH: f32 = 1.0 / 16.0;
        let [outside, inside] = self.bracket.ends;
        let at = self.crossing();
        let axis = (0..3).fold(0, |best, axis| {
            let length = |axis: usize| (outside[axis] - inside[axis]).abs();
            if length(axis) > length(best) { axis } else { best }
        });
        let outward = (outside[axis] - inside[axis]).signum();
        let beside = [(axis + 1) % 3, (axis + 2) % 3].map(|other| {
            let towards = (mean[other] as f32 - at[other]).clamp(-BESIDE * size, BESIDE * size);
            (other, towards)
        });
        let line = |(other, towards): (usize, f32)| {
            let mut ends = [at, at];
            for (end, way) in ends.iter_mut().zip([outward, -outward]) {
                end[other] += towards;
                end[axis] = (end[axis] + way * REACH * size).clamp(cell.low[axis], cell.high[axis]);
            }
            Bracket { ends, values: [0.0; 2] }
        };
        Leaning { axis, beside, brackets: [self.bracket, line(beside[0]), line(beside[1])] }
    }
}

impl Leaning {
    /// The unit normal of the wall; `None` if it is not between the ends of the lines, or if there is no way
    /// to the side.
    pub(super) fn normal<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        points: &mut BracketPoints,
    ) -> Result<Option<[f64; 3]>, F::Error> {
        /// Halvings: as many as there are numbers in between.
        const HALVINGS: usize = 16;
        let ends = self.brackets.iter().flat_map(|bracket| bracket.ends);
        let values: Vec<f32> = points.ask(field, region, ends)?.to_vec();
        for (bracket, values) in self.brackets.iter_mut().zip(values.as_chunks().0) {
            bracket.values = *values;
            if bracket.values.map(|value| value >= iso) != [false, true] {
                return Ok(None);
            }
        }
        if self.beside.iter().any(|(_, way)| *way == 0.0) {
            return Ok(None);
        }
        let outward = (self.brackets[0].ends[0][self.axis] - self.brackets[0].ends[1][self.axis]).signum();
        let mut brackets: Vec<&mut Bracket> = self.brackets.iter_mut().collect();
        points.halve(field, region, iso, &mut brackets, HALVINGS)?;
        let height = |n: usize| f64::from(self.brackets[n].middle()[self.axis]);
        let mut normal = [0.0; 3];
        normal[self.axis] = 1.0;
        for (n, &(other, way)) in self.beside.iter().enumerate() {
            normal[other] = -(height(n + 1) - height(0)) / f64::from(way);
        }
        let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt() * f64::from(outward);
        Ok(Some(normal.map(|c| c / length)))
    }
}

/// The crossed edges of a brick that were requested, each once.
#[derive(Default)]
pub(super) struct CrossedEdges {
    edges: Vec<CrossedEdge>,
    /// By the place of the low end in the table of the brick's points, and the axis: the number of the edge
    /// plus one, or 0.
    numbers: Vec<u32>,
    /// The entries that are not 0.
    used: Vec<usize>,
    points: BracketPoints,
}

impl CrossedEdges {
    /// Removes all edges. The next edges are of a brick with this many points.
    pub(super) fn clear(&mut self, points: usize) {
        self.edges.clear();
        for key in self.used.drain(..) {
            self.numbers[key] = 0;
        }
        self.numbers.resize(3 * points, 0);
    }

    /// The number of the edge along an axis at a point of the brick's table.
    pub(super) fn number(&mut self, low: usize, axis: usize, edge: impl FnOnce() -> CrossedEdge) -> u32 {
        let key = 3 * low + axis;
        if self.numbers[key] == 0 {
            self.edges.push(edge());
            self.numbers[key] = self.edges.len() as u32;
            self.used.push(key);
        }
        self.numbers[key] - 1
    }

    /// The edge with a number.
    pub(super) fn get(&self, number: u32) -> &CrossedEdge {
        &self.edges[number as usize]
    }

    /// Halves the edges of sheets until it is known which sheets have no edge that may jump. Of a sheet that
    /// is hardly suspect (`true` beside its edges), the steepest edge is tested first. Returns the remaining
    /// sheets, whose edges have been halved to the end, and the number of points evaluated.
    ///
    /// Whether a sheet remains depends on its own edges alone, not on how far other sheets have halved them.
    pub(super) fn bracket<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        sheets: &[(&[u32], bool)],
    ) -> Result<(Vec<bool>, u64), F::Error> {
        let mut is_left = vec![true; sheets.len()];
        let mut asked = 0;
        for look in 1..LOOKS.len() {
            let next: Vec<(usize, &[u32])> = (0..sheets.len())
                .filter(|&sheet| is_left[sheet])
                .map(|sheet| {
                    let (edges, is_near) = sheets[sheet];
                    (sheet, if is_near && look == 1 { self.steepest(edges) } else { edges })
                })
                .collect();
            asked += self.halve(field, region, iso, next.iter().flat_map(|(_, edges)| *edges), look)?;
            for (sheet, edges) in next {
                is_left[sheet] = edges.iter().any(|&edge| self.get(edge).may_jump(look));
            }
        }
        Ok((is_left, asked))
    }

    /// Halves some edges to the end.
    pub(super) fn finish<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        edges: &[u32],
    ) -> Result<u64, F::Error> {
        self.halve(field, region, iso, edges.iter(), LOOKS.len() - 1)
    }

    /// The crossings of all edges, nearly: by the rule of false position.
    pub(super) fn estimated<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
    ) -> Result<Vec<[f32; 3]>, F::Error> {
        /// Evaluations for each edge.
        const STEPS: usize = 2;
        let mut brackets: Vec<Bracket> = self.edges.iter().map(|edge| edge.bracket).collect();
        let mut points: Vec<[f32; 3]> = brackets.iter().map(|bracket| bracket.secant(iso)).collect();
        for _ in 0..STEPS {
            let values = self.points.ask(field, region, points.iter().copied())?;
            for ((bracket, point), &value) in brackets.iter_mut().zip(&mut points).zip(values) {
                bracket.cut(iso, *point, value);
                *point = bracket.secant(iso);
            }
        }
        Ok(points)
    }

    /// The edge of a sheet with the largest rise of the field; the first of equal ones.
    fn steepest<'a>(&self, edges: &'a [u32]) -> &'a [u32] {
        let rise = |edge: u32| self.get(edge).whole_rise();
        let steepest =
            (1..edges.len()).fold(0, |best, n| if rise(edges[n]) > rise(edges[best]) { n } else { best });
        &edges[steepest..=steepest]
    }

    /// Halves some edges up to a look. Returns the number of points evaluated.
    fn halve<'a, F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        edges: impl Iterator<Item = &'a u32>,
        last: usize,
    ) -> Result<u64, F::Error> {
        let mut wanted = vec![false; self.edges.len()];
        edges.for_each(|&edge| wanted[edge as usize] = true);
        let mut asked = 0;
        for look in 1..=last {
            let both = self.edges.iter_mut().zip(&wanted);
            let mut behind: Vec<&mut CrossedEdge> =
                both.filter(|(edge, wanted)| **wanted && edge.look < look).map(|(edge, _)| edge).collect();
            let mut brackets: Vec<&mut Bracket> = behind.iter_mut().map(|edge| &mut edge.bracket).collect();
            asked += self.points.halve(field, region, iso, &mut brackets, LOOKS[look] - LOOKS[look - 1])?;
            behind.into_iter().for_each(|edge| edge.look(look));
        }
        Ok(asked)
    }
}
