//! Where the field is the iso-value on an edge of the lattice: all edges of a block at once, by false
//! position.
//!
//! ```text
//!  field
//!    o               from a point inside to one outside; the line through both fields meets the iso-value at x;
//!    | `.            f(x) takes the place of the end on its side. An end that stays counts half as much the next time
//!  --+---`x----+--   (the Illinois method: Dowell and Jarratt 1971, "A modified regula falsi method"), so that both ends close in.
//!    |     `.  |     Where a field is no number, the edge is halved.
//!              o
//! ```

use crate::error::EvalError;

/// Evaluations of a vertex at most.
const ROUNDS: usize = 24;
/// The field is the iso-value, if it differs from it by not more than this part of what the ends of the edge
/// differ by.
const TOLERANCE: f64 = 1e-5;
/// A place is known, if the ends are not farther apart than this part of the edge: where the field jumps.
const WIDTH: f64 = 1.0 / 16384.0;
/// How near a vertex may come to the end of its edge, in lengths of the edge. So no two vertices are at the
/// same place.
const MARGIN: f64 = 1.0 / 4096.0;

/// An edge with a point inside and one outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutEdge {
    /// The axis that it is along: 0 is u, 1 is v.
    pub(super) axis: usize,
    /// The coordinate along the other axis.
    pub(super) beside: f32,
    /// The coordinates of the inside point and the outside one.
    pub(super) ends: [f32; 2],
    /// The field there.
    pub(super) values: [f32; 2],
}

/// An edge on its way to its root.
struct RootSearch {
    edge: CutEdge,
    /// The ends that the root is between: inside, outside.
    ends: [f64; 2],
    /// The field less the iso-value at these, or less of it.
    values: [f64; 2],
    /// The side that moved last.
    moved: Option<usize>,
    scale: f64,
    at: f32,
    /// How far the field is from the iso-value at the ends.
    errors: [f64; 2],
    done: bool,
}

/// Whether the field is near enough to the iso-value.
fn near(error: f64, scale: f64) -> bool {
    error <= TOLERANCE * scale && scale.is_finite()
}

impl RootSearch {
    fn new(edge: CutEdge, iso: f32) -> Self {
        let values = edge.values.map(|value| f64::from(value) - f64::from(iso));
        let ends = edge.ends.map(f64::from);
        let scale = (values[0] - values[1]).abs();
        let errors = values.map(f64::abs);
        let done = near(errors[0], scale);
        Self { edge, ends, values, moved: None, scale, at: 0.0, errors, done }
    }

    /// Where to look next.
    fn next(&mut self) -> f32 {
        let [inside, outside] = self.values;
        let part = inside / (inside - outside);
        let part = if part.is_finite() && part > 0.0 && part < 1.0 { part } else { 0.5 };
        // Not where it has been looked.
        let part = part.clamp(1.0 / 1024.0, 1023.0 / 1024.0);
        self.at = (self.ends[0] + part * (self.ends[1] - self.ends[0])) as f32;
        self.at
    }

    /// Takes the field at the place that was asked for.
    fn take(&mut self, value: f32, iso: f32) {
        let side = usize::from(value < iso || value.is_nan());
        if self.moved == Some(side) {
            self.values[1 - side] *= 0.5;
        }
        self.moved = Some(side);
        self.ends[side] = f64::from(self.at);
        self.values[side] = f64::from(value) - f64::from(iso);
        self.errors[side] = self.values[side].abs();
        let length = f64::from(self.edge.ends[1]) - f64::from(self.edge.ends[0]);
        let narrow = (self.ends[1] - self.ends[0]).abs() <= WIDTH * length.abs();
        self.done = near(self.errors[side], self.scale) || narrow;
    }

    /// The place of the vertex, strictly between the ends of the edge if any f32 is.
    fn place(&self) -> [f32; 2] {
        let [a, b] = self.edge.ends.map(f64::from);
        let (low, high) = (a.min(b), a.max(b));
        let margin = MARGIN * (high - low);
        // An error that is no number is never the smaller one: it is outside.
        let best = if self.errors[1] < self.errors[0] { self.ends[1] } else { self.ends[0] };
        let at = best.clamp(low + margin, high - margin) as f32;
        let (low, high) = ((low as f32).next_up(), (high as f32).next_down());
        let at = if low <= high { at.clamp(low, high) } else { at };
        if self.edge.axis == 0 { [at, self.edge.beside] } else { [self.edge.beside, at] }
    }
}

/// What gives the field at points by their coordinates along u and v.
pub(super) type FieldAt<'a> = dyn FnMut([&[f32]; 2], &mut Vec<f32>) -> Result<(), EvalError> + 'a;

/// The places of the vertices on some edges.
pub(super) fn solve(
    edges: &[CutEdge],
    iso: f32,
    field: &mut FieldAt<'_>,
) -> Result<Vec<[f32; 2]>, EvalError> {
    let mut searches: Vec<RootSearch> = edges.iter().map(|&edge| RootSearch::new(edge, iso)).collect();
    let (mut points, mut values) = ([Vec::new(), Vec::new()], Vec::new());
    for _ in 0..ROUNDS {
        points.iter_mut().for_each(Vec::clear);
        for search in searches.iter_mut().filter(|search| !search.done) {
            points[search.edge.axis].push(search.next());
            points[1 - search.edge.axis].push(search.edge.beside);
        }
        if points[0].is_empty() {
            break;
        }
        field([&points[0], &points[1]], &mut values)?;
        for (search, &value) in searches.iter_mut().filter(|search| !search.done).zip(&values) {
            search.take(value, iso);
        }
    }
    Ok(searches.iter().map(RootSearch::place).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The place on the edge from 0 (inside) to 1 (outside) at v = 3, and the evaluations.
    fn root(f: impl Fn(f64) -> f64) -> (f64, usize) {
        let edge = CutEdge { axis: 0, beside: 3.0, ends: [0.0, 1.0], values: [f(0.0) as f32, f(1.0) as f32] };
        let mut count = 0;
        let mut field = |[u, v]: [&[f32]; 2], values: &mut Vec<f32>| {
            assert_eq!(v, vec![3.0; u.len()]);
            count += u.len();
            *values = u.iter().map(|&u| f(f64::from(u)) as f32).collect();
            Ok(())
        };
        let places = solve(&[edge], 0.5, &mut field).unwrap();
        assert_eq!(places[0][1], 3.0);
        (f64::from(places[0][0]), count)
    }

    #[test]
    fn smooth_fields_take_few_evaluations() {
        let (at, count) = root(|x| 1.0 - x);
        assert!((at - 0.5).abs() < 1e-6 && count == 1, "{at} {count}");
        let (at, count) = root(|x| 1.0 - x * x);
        assert!((at - 0.5_f64.sqrt()).abs() < 3e-5 && count <= 6, "{at} {count}");
        let (at, count) = root(|x| (-10.0 * x * x).exp());
        assert!((at - (0.5_f64.ln() / -10.0).sqrt()).abs() < 1e-4 && count <= 12, "{at} {count}");
    }

    #[test]
    fn jumps_and_fields_that_are_no_numbers_are_halved() {
        let (at, count) = root(|x| if x < 0.3 { 1.0 } else { 0.0 });
        assert!((at - 0.3).abs() < 2.0 * WIDTH && count <= ROUNDS, "{at} {count}");
        let (at, count) = root(|x| if x < 0.3 { 1.0 } else { f64::NAN });
        assert!((at - 0.3).abs() < 2.0 * WIDTH && count <= ROUNDS, "{at} {count}");
        let (at, _) = root(|x| if x < 0.6 { 1e30 } else { f64::NEG_INFINITY });
        assert!((at - 0.6).abs() < 2.0 * WIDTH, "{at}");
    }

    #[test]
    fn a_vertex_stays_off_the_ends() {
        assert_eq!(root(|x| 0.5 - x).0, MARGIN);
        let (at, _) = root(|x| if x < 1.0 { 1.0 } else { 0.0 });
        assert!(at <= 1.0 - MARGIN && at > 0.999, "{at}");
    }
}
