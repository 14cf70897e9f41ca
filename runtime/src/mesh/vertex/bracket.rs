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

use std::borrow::BorrowMut;

use super::super::field::{AttributePlanes, Field};
use super::super::pull::VertexPlanes;

/// Two points, and the field at them: the first is outside, the second inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    pub(super) ends: [[f32; 3]; 2],
    pub(super) values: [f32; 2],
}

impl Bracket {
    /// The middle of its ends. A coordinate that both ends share is kept exactly.
    pub(super) fn middle(&self) -> [f32; 3] {
        middle(self.ends)
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

fn middle([outside, inside]: [[f32; 3]; 2]) -> [f32; 3] {
    [0, 1, 2].map(|axis| 0.5 * outside[axis] + 0.5 * inside[axis])
}

/// Room for points, and the field and its gradient at them.
#[derive(Default)]
pub(super) struct BracketPoints {
    planes: VertexPlanes,
    values: Vec<f32>,
    gradient: VertexPlanes,
}

impl BracketPoints {
    /// Evaluates the field at the points.
    pub(super) fn ask<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        points: impl Iterator<Item = [f32; 3]>,
    ) -> Result<&[f32], F::Error> {
        self.take(points);
        self.evaluate(field, region)?;
        Ok(&self.values)
    }

    fn evaluate<F: Field>(&mut self, field: &F, region: &F::Region) -> Result<(), F::Error> {
        let [x, y, z] = &self.planes;
        self.values.resize(x.len(), 0.0);
        if x.is_empty() { Ok(()) } else { field.field(region, x, y, z, &mut self.values) }
    }

    /// Evaluates the field and its gradient at the points.
    pub(super) fn ask_gradient<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        points: impl Iterator<Item = [f32; 3]>,
    ) -> Result<(&[f32], &VertexPlanes), F::Error> {
        self.take(points);
        let ([x, y, z], values, gradient) = self.with_gradient();
        if !x.is_empty() {
            field.gradient(region, x, y, z, values, gradient)?;
        }
        Ok((&self.values, &self.gradient))
    }

    /// Evaluates everything at the points, of which there are some; `attributes` has room for their planes,
    /// one after the other.
    pub(super) fn ask_all<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        points: impl Iterator<Item = [f32; 3]>,
        attributes: &mut [f32],
    ) -> Result<(&[f32], &VertexPlanes), F::Error> {
        self.take(points);
        let ([x, y, z], values, gradient) = self.with_gradient();
        let mut planes: AttributePlanes<'_> = attributes.chunks_exact_mut(x.len()).collect();
        field.all(region, x, y, z, values, gradient, &mut planes)?;
        Ok((&self.values, &self.gradient))
    }

    /// The points, and room for the field and its gradient at them.
    fn with_gradient(&mut self) -> ([&[f32]; 3], &mut [f32], [&mut [f32]; 3]) {
        let Self { planes, values, gradient } = self;
        let count = planes[0].len();
        values.resize(count, 0.0);
        gradient.iter_mut().for_each(|plane| plane.resize(count, 0.0));
        (planes.each_ref().map(Vec::as_slice), values, gradient.each_mut().map(Vec::as_mut_slice))
    }

    fn take(&mut self, points: impl Iterator<Item = [f32; 3]>) {
        self.planes.iter_mut().for_each(Vec::clear);
        for point in points {
            self.planes.iter_mut().zip(point).for_each(|(plane, coordinate)| plane.push(coordinate));
        }
    }

    /// Halves brackets a number of times. Returns the number of points evaluated.
    pub(super) fn halve<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        brackets: &mut [impl BorrowMut<Bracket>],
        times: usize,
    ) -> Result<u64, F::Error> {
        let most = if brackets.len() <= FEW_BRACKETS { MOST_AT_ONCE } else { 1 };
        let (mut done, mut asked) = (0, 0);
        while done < times {
            let halvings = most.min(times - done);
            asked += self.halve_at_once(field, region, iso, brackets, halvings)?;
            done += halvings;
        }
        Ok(asked)
    }

    /// Halves brackets some times with one question: for all middles that there may be. Returns the number of
    /// points evaluated.
    fn halve_at_once<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        brackets: &mut [impl BorrowMut<Bracket>],
        halvings: usize,
    ) -> Result<u64, F::Error> {
        let parts = 1 << halvings;
        self.planes.iter_mut().for_each(Vec::clear);
        for bracket in &*brackets {
            // The ends of all parts, the outside first.
            let mut ends = [[0.0; 3]; (1 << MOST_AT_ONCE) + 1];
            [ends[0], ends[parts]] = bracket.borrow().ends;
            for step in (0..halvings).map(|halving| parts >> halving) {
                for first in (0..parts).step_by(step) {
                    ends[first + step / 2] = middle([ends[first], ends[first + step]]);
                }
            }
            for (axis, plane) in self.planes.iter_mut().enumerate() {
                plane.extend(ends[1..parts].iter().map(|end| end[axis]));
            }
        }
        self.evaluate(field, region)?;
        for (n, bracket) in brackets.iter_mut().map(BorrowMut::borrow_mut).enumerate() {
            let mut first = 0;
            for step in (1..=halvings).map(|halving| parts >> halving) {
                let index = n * (parts - 1) + first + step - 1;
                let value = self.values[index];
                bracket.cut(iso, self.planes.each_ref().map(|plane| plane[index]), value);
                first += if value >= iso { 0 } else { step };
            }
        }
        Ok(self.values.len() as u64)
    }
}

/// Brackets up to which some halvings are one question: fewer blocks of points then, and fewer calls.
const FEW_BRACKETS: usize = 6;
/// The halvings of such a question.
const MOST_AT_ONCE: usize = 3;

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

    /// A point outside, next to the crossing.
    pub(super) fn outside(&self) -> [f32; 3] {
        self.bracket.ends[0]
    }

    /// A point inside, next to the crossing.
    pub(super) fn inside(&self) -> [f32; 3] {
        self.bracket.ends[1]
    }

    /// The rise of a linear field of this slope along the whole edge.
    pub(super) fn rise_along(&self, slope: [f64; 3]) -> f64 {
        let [outside, inside] = self.bracket.ends;
        let axis = (0..3).find(|&axis| outside[axis] != inside[axis]);
        axis.map_or(0.0, |axis| slope[axis] * f64::from(self.widths[0]))
    }

    /// Newton's step from a point of the edge to where the field is higher by `rise`, along the edge; the
    /// point itself where the slope tells nothing.
    pub(super) fn step(&self, mut point: [f32; 3], rise: f64, slope: [f64; 3]) -> [f32; 3] {
        let [outside, inside] = self.bracket.ends;
        for axis in (0..3).filter(|&axis| outside[axis] != inside[axis]) {
            let next = (f64::from(point[axis]) + rise / slope[axis]) as f32;
            if next.is_finite() {
                let [low, high] = [outside[axis].min(inside[axis]), outside[axis].max(inside[axis])];
                point[axis] = next.clamp(low, high);
            }
        }
        point
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

/// The crossed edges of a brick that were requested, each once.
#[derive(Default)]
pub(super) struct CrossedEdges {
    edges: Vec<CrossedEdge>,
    /// By the place of the low end in the table of the brick's points, and the axis: the number of the edge
    /// plus one, or 0.
    numbers: Vec<u32>,
    /// The entries that are not 0.
    used: Vec<usize>,
    pub(super) points: BracketPoints,
    /// For each sheet of the last question, whether it is left.
    left: Vec<bool>,
    /// Edges that are to be halved; those of them that are not as far yet as a look, and their brackets.
    wanted: Vec<u32>,
    behind: Vec<u32>,
    brackets: Vec<Bracket>,
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

    /// Halves the edges of sheets until it is known which sheets have no edge that may jump: the others are
    /// [left](Self::is_left), and their edges have been halved to the end. Of a sheet that is hardly suspect
    /// (`true` beside its edges), the steepest edge is tested first. Returns the number of points evaluated.
    ///
    /// Whether a sheet is left depends on its own edges alone, not on how far other sheets have halved them.
    pub(super) fn bracket<'a, F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        (count, sheets): (usize, impl Fn(usize) -> (&'a [u32], bool)),
    ) -> Result<u64, F::Error> {
        let mut asked = 0;
        let (mut left, mut wanted) = (std::mem::take(&mut self.left), std::mem::take(&mut self.wanted));
        left.clear();
        left.resize(count, true);
        for look in 1..LOOKS.len() {
            let next = |edges: &Self, sheet: usize| {
                let (all, is_near) = sheets(sheet);
                if is_near && look == 1 { edges.steepest(all) } else { all }
            };
            wanted.clear();
            let those_left = (0..count).filter(|&sheet| left[sheet]);
            wanted.extend(those_left.flat_map(|sheet| next(self, sheet)));
            asked += self.halve(field, region, iso, &mut wanted, look)?;
            for (sheet, is_left) in left.iter_mut().enumerate().filter(|(_, is_left)| **is_left) {
                *is_left = next(self, sheet).iter().any(|&edge| self.get(edge).may_jump(look));
            }
        }
        (self.left, self.wanted) = (left, wanted);
        Ok(asked)
    }

    /// Whether a sheet is left after the last [`bracket`](Self::bracket).
    pub(super) fn is_left(&self, sheet: usize) -> bool {
        self.left[sheet]
    }

    /// Halves some edges to the end.
    pub(super) fn finish<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        edges: &[u32],
    ) -> Result<u64, F::Error> {
        self.halve(field, region, iso, &mut edges.to_vec(), LOOKS.len() - 1)
    }

    /// The crossings of all edges, nearly: by one step of the rule of false position.
    pub(super) fn estimated<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
    ) -> Result<Vec<[f32; 3]>, F::Error> {
        let mut brackets: Vec<Bracket> = self.edges.iter().map(|edge| edge.bracket).collect();
        let points: Vec<[f32; 3]> = brackets.iter().map(|bracket| bracket.secant(iso)).collect();
        let values = self.points.ask(field, region, points.iter().copied())?;
        let cut = brackets.iter_mut().zip(points).zip(values).map(|((bracket, point), &value)| {
            bracket.cut(iso, point, value);
            bracket.secant(iso)
        });
        Ok(cut.collect())
    }

    /// The edge of a sheet with the largest rise of the field; the first of equal ones.
    fn steepest<'a>(&self, edges: &'a [u32]) -> &'a [u32] {
        let rise = |edge: u32| self.get(edge).whole_rise();
        let steepest =
            (1..edges.len()).fold(0, |best, n| if rise(edges[n]) > rise(edges[best]) { n } else { best });
        &edges[steepest..=steepest]
    }

    /// Halves some edges up to a look; those that are wanted twice, once. Returns the number of points
    /// evaluated.
    fn halve<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        wanted: &mut Vec<u32>,
        last: usize,
    ) -> Result<u64, F::Error> {
        // Sheets share edges.
        wanted.sort_unstable();
        wanted.dedup();
        let mut asked = 0;
        for look in 1..=last {
            let is_behind = |edge: &&u32| self.edges[**edge as usize].look < look;
            self.behind.clear();
            self.behind.extend(wanted.iter().filter(is_behind));
            self.brackets.clear();
            self.brackets.extend(self.behind.iter().map(|&edge| self.edges[edge as usize].bracket));
            let times = LOOKS[look] - LOOKS[look - 1];
            asked += self.points.halve(field, region, iso, &mut self.brackets, times)?;
            for (&edge, &bracket) in self.behind.iter().zip(&self.brackets) {
                self.edges[edge as usize].bracket = bracket;
                self.edges[edge as usize].look(look);
            }
        }
        Ok(asked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::testing::PlainField;

    /// Few brackets are halved three times with one question, many once with each. Both keep the same half
    /// each time, so that a bracket does not depend on how many there are beside it.
    #[test]
    fn halvings_at_once_are_those_in_turn() {
        let value = |[x, y, z]: [f32; 3]| (3.0 * x).sin() + 0.3 * y * z - if y > 0.4 { 0.5 } else { 0.0 };
        let field = PlainField { value, range: |_| [f32::NEG_INFINITY, f32::INFINITY] };
        let mut random = fastrand::Rng::with_seed(1);
        let brackets: Vec<Bracket> = std::iter::repeat_with(|| {
            let ends = [0; 2].map(|_| [0; 3].map(|_| 2.0 * random.f32() - 1.0));
            Bracket { ends, values: ends.map(value) }
        })
        .filter(|bracket| bracket.values[0] < 0.1 && bracket.values[1] >= 0.1)
        .take(FEW_BRACKETS * 40)
        .collect();
        for times in [1, 2, 3, 6, 7, 12] {
            let [mut few, mut many] = [0; 2].map(|_| brackets.clone());
            let mut points = BracketPoints::default();
            let mut halve = |some: &mut [Bracket]| points.halve(&field, &(), 0.1, some, times).unwrap();
            let asked: u64 = few.chunks_mut(FEW_BRACKETS).map(&mut halve).sum();
            assert!(halve(&mut many) <= asked, "{times}");
            let bits = |all: &[Bracket]| -> Vec<[u32; 8]> {
                let of = |one: &Bracket| [one.ends.as_flattened(), &one.values].concat();
                let bits = |numbers: Vec<f32>| std::array::from_fn(|n| numbers[n].to_bits());
                all.iter().map(|one| bits(of(one))).collect()
            };
            assert_eq!(bits(&few), bits(&many), "{times}");
            let is_kept = |one: &Bracket| one.values == one.ends.map(value) && one.width() > 0.0;
            assert!(few.iter().all(is_kept), "{times}");
        }
    }
}
