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

/// The unit normals away from the inside of walls at crossed edges of sheets; `None` where none is seen. All
/// edges are asked at once, so that the field gets many points at a time.
pub(super) fn normals<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    edges: &[(&Sheet, &CrossedEdge)],
    points: &mut BracketPoints,
) -> Result<Vec<Option<[f64; 3]>>, F::Error> {
    let mut found = vec![None; edges.len()];
    let mut left: Vec<usize> = (0..edges.len()).collect();
    for lines in LINES {
        let begun = left.iter().filter_map(|&n| Some((n, Leaning::new(edges[n].0, edges[n].1, lines)?)));
        let mut leanings: Vec<(usize, Leaning)> = begun.collect();
        if leanings.is_empty() {
            break;
        }
        let ends = leanings.iter().flat_map(|(_, one)| one.brackets.iter().flat_map(|bracket| bracket.ends));
        let values = points.ask(field, region, ends)?;
        let brackets = leanings.iter_mut().flat_map(|(_, one)| &mut one.brackets);
        brackets.zip(values.as_chunks().0).for_each(|(bracket, values)| bracket.values = *values);
        left.clear();
        let is_crossed = |(n, one): &(usize, Leaning)| {
            let is_crossed = one.is_crossed(iso);
            if !is_crossed {
                left.push(*n);
            }
            is_crossed
        };
        leanings.retain(is_crossed);
        let mut brackets: Vec<&mut Bracket> =
            leanings.iter_mut().flat_map(|(_, one)| &mut one.brackets).collect();
        points.halve(field, region, iso, &mut brackets, HALVINGS)?;
        for (n, one) in leanings {
            found[n] = one.normal();
            if found[n].is_none() {
                left.push(n);
            }
        }
    }
    Ok(found)
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

    /// Whether all lines are crossed where they are looked at, and none is the edge itself.
    fn is_crossed(&self, iso: f32) -> bool {
        let is_across = |bracket: &Bracket| bracket.values.map(|value| value >= iso) == [false, true];
        self.brackets.iter().all(is_across) && self.ways.iter().all(|(_, way)| *way != 0.0)
    }

    /// The normal, if the halved lines are crossed along a plane.
    fn normal(&self) -> Option<[f64; 3]> {
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
                return None;
            }
            normal[other] = -far / far_way;
        }
        let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt() * f64::from(self.outward);
        Some(normal.map(|c| c / length))
    }
}
