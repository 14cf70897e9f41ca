//! The parts of a lattice that an edit touches: its smallest squares or bricks, and every larger one that has
//! one of them.
//!
//! ```text
//! +-------+-------+     x  bricks that are touched
//! |   |   | . |   |     .  and, with them, the boxes of two, four, eight bricks around them, up to the root:
//! |---+---|---+---|        the division looks into these alone
//! |   |   | x | x |
//! +-------+-------+
//! ```

use jbt_ir::limits::MAX_RESOLUTION;
use rustc_hash::FxHashSet;

/// Bricks of a lattice with so many axes (squares, if there are two), and the boxes around them.
#[derive(Clone)]
pub(crate) struct Touched<const AXES: usize> {
    /// The edge of bricks, in cells.
    edge: usize,
    /// By the logarithm of a box's edge in bricks: the places of boxes, in units of their size.
    levels: Vec<FxHashSet<[u32; AXES]>>,
}

/// The most bricks that the boxes of an edit are followed to, one by one. Beyond, everything counts as
/// touched.
const MOST_TOUCHED: u64 = 1 << 18;
/// Sizes of boxes: from bricks of one cell to the root of the largest lattice.
const LEVELS: usize = MAX_RESOLUTION.ilog2() as usize + 1;

impl<const AXES: usize> Touched<AXES> {
    /// No brick.
    pub(crate) fn new(edge: usize) -> Self {
        Self { edge, levels: vec![FxHashSet::default(); LEVELS] }
    }

    /// The bricks of a lattice that meet any of these boxes, each from a corner to another one; `None` if
    /// they are very many.
    pub(crate) fn by(
        axes: &[Vec<f32>; AXES],
        edge: usize,
        boxes: impl IntoIterator<Item = [[f32; AXES]; 2]>,
    ) -> Option<Self> {
        let mut touched = Self::new(edge);
        let mut work = 0_u64;
        for bounds in boxes {
            let Some(spans) = spans(axes, edge, bounds) else { continue };
            let count =
                spans.iter().fold(1, |all: u64, [low, high]| all.saturating_mul(u64::from(high - low)));
            work = work.saturating_add(count);
            if work > MOST_TOUCHED {
                return None;
            }
            let mut place = spans.map(|[low, _]| low);
            for _ in 0..count {
                touched.add(place);
                // The next place, as a counter with a digit for each axis.
                for (digit, [low, high]) in place.iter_mut().zip(spans) {
                    *digit += 1;
                    if *digit < high {
                        break;
                    }
                    *digit = low;
                }
            }
        }
        Some(touched)
    }

    /// Adds a brick by its place, in units of bricks.
    pub(crate) fn add(&mut self, place: [u32; AXES]) {
        let mut place = place;
        for level in &mut self.levels {
            // Whoever is known is known with everything around it.
            if !level.insert(place) {
                return;
            }
            place = place.map(|index| index / 2);
        }
    }

    /// Cells along the edge of a brick.
    pub(crate) fn edge(&self) -> usize {
        self.edge
    }

    /// The bricks.
    pub(crate) fn bricks(&self) -> impl Iterator<Item = [u32; AXES]> {
        self.levels[0].iter().copied()
    }

    /// Whether a brick is touched.
    pub(crate) fn has_brick(&self, place: [u32; AXES]) -> bool {
        self.levels[0].contains(&place)
    }

    /// Whether any brick of a box of the division is touched. The box begins at a cell and has an edge of so
    /// many cells: of a brick, or of a power of two more.
    pub(crate) fn has(&self, first: [usize; AXES], size: usize) -> bool {
        let level = (size / self.edge).ilog2() as usize;
        self.levels[level.min(LEVELS - 1)].contains(&first.map(|index| (index / size) as u32))
    }
}

/// The bricks that a box meets, along each axis: from one to before another. `None` if it is beside the
/// lattice.
fn spans<const AXES: usize>(
    axes: &[Vec<f32>; AXES],
    edge: usize,
    [low, high]: [[f32; AXES]; 2],
) -> Option<[[u32; 2]; AXES]> {
    let mut spans = [[0; 2]; AXES];
    for (axis, span) in spans.iter_mut().enumerate() {
        let coordinates = &axes[axis];
        let cells = coordinates.len() - 1;
        let (low, high) = (low[axis], high[axis]);
        // Bricks are closed: one that ends where the box begins is met. A NaN meets everything.
        if coordinates[0] > high || coordinates[cells] < low {
            return None;
        }
        let first = coordinates.partition_point(|&at| at < low).saturating_sub(1);
        let end = coordinates.partition_point(|&at| at <= high || high.is_nan()).clamp(first + 1, cells);
        *span = [(first / edge) as u32, end.div_ceil(edge) as u32];
    }
    Some(spans)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boxes::Box3;

    /// Compared with the boxes of all bricks.
    #[test]
    fn boxes_touch_the_bricks_that_they_meet() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..300 {
            let edge = 1 << random.usize(1..4);
            let axes: [Vec<f32>; 3] =
                std::array::from_fn(|_| (0..=random.usize(1..30)).map(|i| 0.5 * i as f32 - 3.0).collect());
            let side = |random: &mut fastrand::Rng| 0.25 * random.i32(-20..60) as f32;
            let low: [f32; 3] = std::array::from_fn(|_| side(&mut random));
            let bounds = Box3::new(low, low.map(|low| low + 0.25 * random.u32(0..12) as f32));
            let touched = Touched::by(&axes, edge, [[bounds.low, bounds.high]]).unwrap();
            let bricks = axes.each_ref().map(|axis| (axis.len() - 1).div_ceil(edge));
            let mut any = false;
            for index in 0..bricks.iter().product::<usize>() {
                let place = [index % bricks[0], index / bricks[0] % bricks[1], index / bricks[0] / bricks[1]];
                let first = place.map(|index| index * edge);
                let corner = |of: &dyn Fn(usize) -> usize| std::array::from_fn(|axis| axes[axis][of(axis)]);
                let end = |axis: usize| (first[axis] + edge).min(axes[axis].len() - 1);
                let meets = Box3::new(corner(&|axis| first[axis]), corner(&end)).meets(&bounds);
                assert_eq!(touched.has_brick(place.map(|index| index as u32)), meets, "{place:?} {bounds:?}");
                assert!(
                    !meets
                        || (0..6).all(|level| touched
                            .has(first.map(|i| i / (edge << level) * (edge << level)), edge << level))
                );
                any |= meets;
            }
            assert_eq!(touched.has([0; 3], edge << 12), any);
        }
        assert!(
            Touched::by(
                &[0; 3].map(|_| (0..=4096).map(|i| i as f32).collect()),
                8,
                [[[0.0; 3], [4096.0; 3]]]
            )
            .is_none()
        );
    }
}
