//! The boxes that a row reaches: one row against up to eight boxes at a time, a lane each.
//!
//! ```text
//!         +-----+          gap_x = max(core.low_x - box.high_x, box.low_x - core.high_x, 0), and so on
//!   .-.   | box |          the row reaches the box if gap_x^2 + gap_y^2 + gap_z^2 <= radius^2
//!  ( c )  |     |
//!   `-'   +-----+          c: the core, rounded by the radius; a support without a radius is its core
//! ```
//!
//! A support exceeds the true support by more than the error of these few roundings (see
//! `jbt_lower::prune_info::Support`).

use std::sync::Arc;

use jbt_lower::prune_info::{LARGEST_COORDINATE, Support};
use wide::f32x8;

use crate::boxes::{Box3, MAX_PARTS};

/// The supports of a table's rows.
#[derive(Clone)]
pub(super) struct RowSupports {
    rows: Arc<Vec<Support>>,
}

/// Up to eight boxes, by coordinates, a lane each.
pub(super) struct Boxes {
    low: [f32x8; 3],
    high: [f32x8; 3],
    /// A bit for each box.
    all: u8,
    /// The boxes so far out that supports say nothing about them, a bit each.
    far: u8,
}

impl Boxes {
    pub(super) fn new(boxes: &[Box3]) -> Self {
        let (mut low, mut high, mut far) = ([[0.0; MAX_PARTS]; 3], [[0.0; MAX_PARTS]; 3], 0);
        for (lane, bounds) in boxes.iter().enumerate() {
            for axis in 0..3 {
                low[axis][lane] = bounds.low[axis];
                high[axis][lane] = bounds.high[axis];
            }
            let near = -LARGEST_COORDINATE..=LARGEST_COORDINATE;
            let is_near = bounds.low.iter().chain(&bounds.high).all(|side| near.contains(side));
            far |= u8::from(!is_near) << lane;
        }
        let all = u8::MAX >> (MAX_PARTS - boxes.len());
        Self { low: low.map(f32x8::new), high: high.map(f32x8::new), all, far }
    }

    /// Whether supports say nothing about any of the boxes.
    pub(super) fn are_far(&self) -> bool {
        self.far == self.all
    }

    /// One set bit for each box.
    pub(super) fn all(&self) -> u8 {
        self.all
    }
}

impl RowSupports {
    pub(super) fn new(supports: &Arc<Vec<Support>>) -> Self {
        Self { rows: Arc::clone(supports) }
    }

    /// The boxes that a row reaches, a bit each.
    #[inline(always)]
    pub(super) fn reach(&self, row: u32, boxes: &Boxes) -> u8 {
        let row = &self.rows[row as usize];
        let mut square = f32x8::ZERO;
        for axis in 0..3 {
            let before = f32x8::splat(row.low[axis]) - boxes.high[axis];
            let behind = boxes.low[axis] - f32x8::splat(row.high[axis]);
            // Not `max`, which leaves open what becomes of a NaN (inf - inf): here it is a gap of 0.
            let gap = before.simd_gt(behind).select(before, behind);
            let gap = gap.simd_gt(f32x8::ZERO).select(gap, f32x8::ZERO);
            square += gap * gap;
        }
        let misses = square.simd_gt(f32x8::splat(row.radius_squared)).to_bitmask() as u8;
        boxes.all & (!misses | boxes.far)
    }

    /// A box that meets every box that the row [`reach`](Self::reach)es, whatever `reach` rounds: squares of
    /// tiny gaps are 0.
    pub(super) fn reach_box(&self, row: u32) -> Box3 {
        let Support { low, high, radius_squared } = self.rows[row as usize];
        let radius = radius_squared.sqrt().max(1e-18) * (1.0 + 4.0 * f32::EPSILON);
        // A difference of infinities is NaN, and counts as reached.
        let side = |side: f32, open: f32| if side.is_nan() { open } else { side };
        Box3 {
            low: low.map(|low| side((low - radius).next_down(), f32::NEG_INFINITY)),
            high: high.map(|high| side((high + radius).next_up(), f32::INFINITY)),
        }
    }
}

/// The box around a support, rounded outwards.
pub(super) fn around(support: &Support) -> Box3 {
    let radius = support.radius_squared.sqrt().next_up();
    Box3 {
        low: support.low.map(|side| (side - radius).next_down()),
        high: support.high.map(|side| (side + radius).next_up()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn supports(rows: &[([f32; 3], [f32; 3], f32)]) -> RowSupports {
        let support = |&(low, high, radius): &([f32; 3], [f32; 3], f32)| Support {
            low,
            high,
            radius_squared: radius * radius,
        };
        RowSupports::new(&Arc::new(rows.iter().map(support).collect()))
    }

    #[test]
    fn a_ball_reaches_by_distance_and_not_by_its_box() {
        let ball = supports(&[([0.0; 3], [0.0; 3], 1.0)]);
        let at = |x: f32, y: f32| Box3::new([x, y, -1.0], [x + 1.0, y + 1.0, 1.0]);
        // Touching, just beside, at the corner of the ball's box, over the edge of the ball.
        let boxes = [at(1.0, -0.5), at(1.001, -0.5), at(0.9, 0.9), at(0.7, 0.7)];
        assert_eq!(ball.reach(0, &Boxes::new(&boxes)), 0b1001);
    }

    #[test]
    fn a_box_reaches_what_it_touches() {
        let core = supports(&[([0.0; 3], [1.0; 3], 0.0), ([f32::NEG_INFINITY; 3], [f32::INFINITY; 3], 0.0)]);
        let boxes = Boxes::new(&[Box3::new([1.0; 3], [2.0; 3]), Box3::new([1.0001, 0.0, 0.0], [2.0; 3])]);
        assert_eq!(core.reach(0, &boxes), 0b01);
        assert_eq!(core.reach(1, &boxes), 0b11, "what is unbounded reaches everything");
        let far = Boxes::new(&[Box3::new([1e7; 3], [2e7; 3])]);
        assert_eq!(core.reach(0, &far), 0b1, "so far out supports promise nothing");
    }

    #[test]
    fn eight_boxes_have_eight_bits() {
        let core = supports(&[([0.0; 3], [0.5; 3], 0.25)]);
        let boxes: Vec<Box3> =
            (0..8).map(|i| Box3::new([i as f32, 0.0, 0.0], [i as f32 + 0.5, 1.0, 1.0])).collect();
        assert_eq!(core.reach(0, &Boxes::new(&boxes)), 0b0000_0001);
        assert_eq!(Boxes::new(&boxes).all(), u8::MAX);
    }

    #[test]
    fn boxes_around_a_ball_touch_it() {
        let support = Support { low: [1.0, 2.0, 3.0], high: [2.0, 3.0, 4.0], radius_squared: 0.25 };
        let near = |found: [f32; 3], expected: [f32; 3]| {
            found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-5)
        };
        for bounds in [around(&support), RowSupports::new(&Arc::new(vec![support])).reach_box(0)] {
            assert!(near(bounds.low, [0.5, 1.5, 2.5]) && near(bounds.high, [2.5, 3.5, 4.5]), "{bounds:?}");
            assert!(bounds.low[0] <= 0.5 && bounds.high[2] >= 4.5, "{bounds:?}");
        }
    }
}
