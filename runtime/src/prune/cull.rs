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

use jbt_lower::prune_info::{LARGEST_COORDINATE, Support};

use crate::boxes::{Box3, MAX_PARTS};

/// The supports of a table's rows, each in half a cache line, because rows are accessed in any order.
#[derive(Clone)]
pub(super) struct RowSupports {
    rows: Vec<SupportRow>,
}

#[repr(align(32))]
#[derive(Clone, Copy, PartialEq)]
struct SupportRow {
    low: [f32; 3],
    high: [f32; 3],
    radius_squared: f32,
}

/// Up to eight boxes, by coordinates.
pub(super) struct Boxes {
    low: [[f32; MAX_PARTS]; 3],
    high: [[f32; MAX_PARTS]; 3],
    /// A bit for each box.
    all: u8,
    /// The boxes so far out that supports say nothing about them, a bit each.
    far: u8,
}

impl Boxes {
    pub(super) fn new(boxes: &[Box3]) -> Self {
        let mut result = Self {
            low: [[0.0; MAX_PARTS]; 3],
            high: [[0.0; MAX_PARTS]; 3],
            all: u8::MAX >> (MAX_PARTS - boxes.len()),
            far: 0,
        };
        for (lane, bounds) in boxes.iter().enumerate() {
            for axis in 0..3 {
                result.low[axis][lane] = bounds.low[axis];
                result.high[axis][lane] = bounds.high[axis];
            }
            let near = -LARGEST_COORDINATE..=LARGEST_COORDINATE;
            let is_near = bounds.low.iter().chain(&bounds.high).all(|side| near.contains(side));
            result.far |= u8::from(!is_near) << lane;
        }
        result
    }

    /// One set bit for each box.
    pub(super) fn all(&self) -> u8 {
        self.all
    }
}

impl SupportRow {
    fn new(support: &Support) -> Self {
        let &Support { low, high, radius_squared } = support;
        Self { low, high, radius_squared }
    }
}

impl RowSupports {
    pub(super) fn new(supports: &[Support]) -> Self {
        Self { rows: supports.iter().map(SupportRow::new).collect() }
    }

    /// Gives a row another support.
    pub(super) fn set(&mut self, row: usize, support: &Support) {
        self.rows[row] = SupportRow::new(support);
    }

    /// The boxes that a row reaches, a bit each.
    #[inline(always)]
    pub(super) fn reach(&self, row: u32, boxes: &Boxes) -> u8 {
        let row = &self.rows[row as usize];
        let mut square = [0.0_f32; MAX_PARTS];
        for axis in 0..3 {
            let sides = boxes.low[axis].iter().zip(&boxes.high[axis]);
            for (square, (low, high)) in square.iter_mut().zip(sides) {
                let (before, behind) = (row.low[axis] - high, low - row.high[axis]);
                let gap = if before > behind { before } else { behind };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *square += gap * gap;
            }
        }
        // Not `<=`: a distance that is NaN (inf - inf) counts as reached.
        let misses = square.map(|square| square > row.radius_squared);
        let misses =
            misses.iter().enumerate().fold(0_u8, |bits, (lane, &miss)| bits | u8::from(miss) << lane);
        boxes.all & (!misses | boxes.far)
    }

    /// The box around the support of a row, rounded outwards.
    pub(super) fn bounds(&self, row: usize) -> Box3 {
        let SupportRow { low, high, radius_squared } = self.rows[row];
        let radius = radius_squared.sqrt().next_up();
        Box3 {
            low: low.map(|side| (side - radius).next_down()),
            high: high.map(|side| (side + radius).next_up()),
        }
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
        RowSupports::new(&rows.iter().map(support).collect::<Vec<_>>())
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
}
