//! The boxes of a division that an edit touches: bricks, and every larger box that has one of them.
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

use crate::boxes::Box3;

/// Bricks of a lattice, and the boxes around them.
#[derive(Clone)]
pub(crate) struct Touched {
    /// The edge of bricks, in cells.
    edge: usize,
    /// By the logarithm of a box's edge in bricks: the places of boxes, in units of their size.
    levels: Vec<FxHashSet<[u32; 3]>>,
}

/// The most bricks that the boxes of an edit are followed to, one by one. Beyond, everything counts as
/// touched.
const MOST_TOUCHED: u64 = 1 << 18;
/// Sizes of boxes: from bricks of one cell to the root of the largest lattice.
const LEVELS: usize = MAX_RESOLUTION.ilog2() as usize + 1;

impl Touched {
    /// No brick.
    pub(crate) fn new(edge: usize) -> Self {
        Self { edge, levels: vec![FxHashSet::default(); LEVELS] }
    }

    /// The bricks of a lattice that meet any of these boxes; `None` if they are very many.
    pub(crate) fn by(axes: &[Vec<f32>; 3], edge: usize, boxes: &[Box3]) -> Option<Self> {
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
            let [xs, ys, zs] = spans.map(|[low, high]| low..high);
            let places = zs.flat_map(|z| {
                let xs = xs.clone();
                ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
            });
            places.for_each(|place| touched.add(place));
        }
        Some(touched)
    }

    /// Adds a brick by its place, in units of bricks.
    pub(crate) fn add(&mut self, place: [u32; 3]) {
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
    pub(crate) fn bricks(&self) -> impl Iterator<Item = [u32; 3]> {
        self.levels[0].iter().copied()
    }

    /// Whether a brick is touched.
    pub(crate) fn has_brick(&self, place: [u32; 3]) -> bool {
        self.levels[0].contains(&place)
    }

    /// Whether any brick of a box of the division is touched. The box begins at a cell and has an edge of so
    /// many cells: of a brick, or of a power of two more.
    pub(crate) fn has(&self, first: [usize; 3], size: usize) -> bool {
        let level = (size / self.edge).ilog2() as usize;
        self.levels[level.min(LEVELS - 1)].contains(&first.map(|index| (index / size) as u32))
    }
}

/// The bricks that a box meets, along each axis: from one to before another. `None` if it is beside the
/// lattice.
fn spans(axes: &[Vec<f32>; 3], edge: usize, bounds: &Box3) -> Option<[[u32; 2]; 3]> {
    let mut spans = [[0; 2]; 3];
    for (axis, span) in spans.iter_mut().enumerate() {
        let coordinates = &axes[axis];
        let cells = coordinates.len() - 1;
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
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
    use super::super::brick::box_of;
    use super::*;

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
            let touched = Touched::by(&axes, edge, &[bounds]).unwrap();
            let bricks = axes.each_ref().map(|axis| (axis.len() - 1).div_ceil(edge));
            let mut any = false;
            for index in 0..bricks.iter().product::<usize>() {
                let place = [index % bricks[0], index / bricks[0] % bricks[1], index / bricks[0] / bricks[1]];
                let first = place.map(|index| index * edge);
                let meets = box_of(&axes, first, first.map(|index| index + edge)).meets(&bounds);
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
                &[Box3::new([0.0; 3], [4096.0; 3])]
            )
            .is_none()
        );
    }
}
