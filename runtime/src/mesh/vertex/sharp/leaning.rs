//! How a wall leans at a crossing: by its crossings with lines beside the edge.
//!
//! ```text
//!     o-----x--------o     the edge
//!     o------x-------o     a line beside it, a little towards the middle of the cell
//!     o-------x------o     one twice as far: if the three are not on a line, an edge of the wall is between
//! ```

use super::super::super::field::Field;
use super::super::bracket::{Bracket, BracketPoints, CrossedEdge};
use super::super::margin::four_steps;
use super::super::sheet::Sheet;

/// How far the outer lines are beside the edge, and how far all reach to both sides of the crossing, in
/// cells: at first usual ones, then for walls along the edge, then for corners of the cell.
const LINES: [[f32; 2]; 4] =
    [[1.0 / 256.0, 1.0 / 16.0], [1.0 / 256.0, 0.5], [1.0 / 2048.0, 1.0 / 16.0], [1.0 / 8192.0, 1.0 / 16.0]];
/// Halvings: as many as there are numbers in between.
const HALVINGS: usize = 19;
/// How far off a line three crossings may be, in parts of the way from the first to the last; rounding comes
/// on top.
const BENT: f64 = 1.0 / 128.0;

/// The unit normal away from the inside of the wall at a crossed edge of a sheet; `None` if it is not seen.
pub(super) fn normal<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    (sheet, edge): (&Sheet, &CrossedEdge),
    points: &mut BracketPoints,
) -> Result<Option<[f64; 3]>, F::Error> {
    for lines in LINES {
        let Some(mut leaning) = Leaning::new(sheet, edge, lines) else { return Ok(None) };
        if let Some(normal) = leaning.normal(field, region, iso, points)? {
            return Ok(Some(normal));
        }
    }
    Ok(None)
}

/// The edge and four lines beside it: two along each other axis, the nearer one first.
struct Leaning {
    axis: usize,
    /// The direction of the outside along the axis.
    outward: f32,
    brackets: [Bracket; 5],
    /// The other axis along which each line is away from the edge, and how far.
    ways: [(usize, f64); 4],
}

impl Leaning {
    fn new(sheet: &Sheet, edge: &CrossedEdge, [beside, reach]: [f32; 2]) -> Option<Self> {
        let (ends, at) = ([edge.outside(), edge.inside()], edge.crossing());
        let axis = (0..3).find(|&axis| ends[0][axis] != ends[1][axis])?;
        let outward = (ends[0][axis] - ends[1][axis]).signum();
        let (mut brackets, mut ways) = ([Bracket { ends, values: [0.0; 2] }; 5], [(0, 0.0); 4]);
        for n in 0..4 {
            let other = (axis + 1 + n / 2) % 3;
            let inward = (sheet.cell.middle(other) - at[other]).signum();
            let part = if n % 2 == 0 { 0.5 } else { 1.0 };
            let beside = at[other] + inward * part * beside * sheet.size;
            let Bracket { ends, .. } = &mut brackets[n + 1];
            for (end, way) in ends.iter_mut().zip([outward, -outward]) {
                *end = at;
                end[other] = beside;
                let along = at[axis] + way * reach * sheet.size;
                end[axis] = along.clamp(sheet.cell.low[axis], sheet.cell.high[axis]);
            }
            ways[n] = (other, f64::from(beside) - f64::from(at[other]));
        }
        Some(Self { axis, outward, brackets, ways })
    }

    fn normal<F: Field>(
        &mut self,
        field: &F,
        region: &F::Region,
        iso: f32,
        points: &mut BracketPoints,
    ) -> Result<Option<[f64; 3]>, F::Error> {
        let ends = self.brackets.iter().flat_map(|bracket| bracket.ends);
        let values: Vec<f32> = points.ask(field, region, ends)?.to_vec();
        for (bracket, values) in self.brackets.iter_mut().zip(values.as_chunks().0) {
            bracket.values = *values;
        }
        let is_across = |bracket: &Bracket| bracket.values.map(|value| value >= iso) == [false, true];
        if !self.brackets.iter().all(is_across) || self.ways.iter().any(|(_, way)| *way == 0.0) {
            return Ok(None);
        }
        let mut brackets: Vec<&mut Bracket> = self.brackets.iter_mut().collect();
        points.halve(field, region, iso, &mut brackets, HALVINGS)?;
        let heights = self.brackets.each_ref().map(|bracket| f64::from(bracket.middle()[self.axis]));
        let [outside, inside] = self.brackets[0].ends;
        let rounding = f64::from(four_steps(outside[self.axis], inside[self.axis]));
        let mut normal = [0.0; 3];
        normal[self.axis] = 1.0;
        for near in [0, 2] {
            let [rise, far] = [near, near + 1].map(|n| heights[n + 1] - heights[0]);
            let [(_, near_way), (other, far_way)] = [self.ways[near], self.ways[near + 1]];
            let bend = far - rise * far_way / near_way;
            if bend.abs() > BENT * far_way.hypot(far) + rounding {
                return Ok(None);
            }
            normal[other] = -far / far_way;
        }
        let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt() * f64::from(self.outward);
        Ok(Some(normal.map(|c| c / length)))
    }
}
