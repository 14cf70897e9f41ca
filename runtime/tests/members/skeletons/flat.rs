//! Flat regions: polygons, rectangles.

use crate::falloffs::soft;
use crate::row::{Row, row};

pub fn polygons() -> Vec<Row> {
    vec![
        row(
            "that is concave",
            "polygon { points ((0 0 0) (4 0 0) (4 2 0) (2 2 0) (2 4 0) (0 4 0)) radius 2 }",
            &[
                // Inside, on edges and corners, above the inside.
                ([1.0, 3.0, 0.0], 1.0),
                ([3.0, 1.0, 0.0], 1.0),
                ([2.0, 3.0, 0.0], 1.0),
                ([2.0, 2.0, 0.0], 1.0),
                ([1.0, 1.0, 1.0], 0.5),
                // In its notch.
                ([3.0, 3.0, 0.0], 0.5),
                ([2.5, 3.5, 0.0], soft(1.0 / 16.0)),
                ([3.0, 3.0, 1.0], soft(2.0 / 4.0)),
                // At the heights of corners, where rays meet two edges or run along one.
                ([1.0, 2.0, 0.0], 1.0),
                ([-1.0, 2.0, 0.0], 0.5),
                ([5.0, 2.0, 0.0], 0.5),
                ([-1.0, 4.0, 0.0], 0.5),
                ([-1.0, 0.0, 0.0], 0.5),
                // Outside.
                ([5.0, 1.0, 0.0], 0.5),
                ([5.0, 3.0, 0.0], soft(2.0 / 4.0)),
                ([-1.0, -1.0, 1.0], soft(3.0 / 4.0)),
                ([6.0, 1.0, 0.0], 0.0),
                ([1.0, 1.0, -2.0], 0.0),
            ],
        ),
        // Its normal is (1, 1, 1).
        row(
            "in any plane",
            "polygon { points ((0 0 1) (0 1 0) (1 0 0)) radius 2 }",
            &[([1.0 / 3.0; 3], 1.0), ([2.0 / 3.0; 3], soft(1.0 / 12.0)), ([2.0, 0.0, 0.0], soft(1.0 / 4.0))],
        ),
        // Around a square, across to a smaller one, around that, and back.
        row(
            "with a hole",
            "polygon {
                points ((0 0 0) (6 0 0) (6 6 0) (0 6 0) (0 0 0) (2 2 0) (2 4 0) (4 4 0) (4 2 0) (2 2 0))
                radius 2
            }",
            &[
                ([1.0, 3.0, 0.0], 1.0),
                ([1.0, 1.0, 0.0], 1.0),
                ([5.0, 5.0, 1.0], 0.5),
                ([3.0, 3.0, 0.0], 0.5),
                ([3.0, 3.0, 1.0], soft(2.0 / 4.0)),
                ([3.5, 3.0, 0.0], soft(1.0 / 16.0)),
                ([7.0, 3.0, 0.0], 0.5),
            ],
        ),
    ]
}

pub fn rectangles() -> Vec<Row> {
    vec![
        row(
            "across an axis",
            "rectangle { center (1 0 0) normal x along y half_length 2 half_width 1 radius 2 }",
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([1.0, -2.0, 1.0], 1.0),
                ([2.0, 1.5, 0.5], 0.5),
                ([1.0, 3.0, 0.0], 0.5),
                ([1.0, 0.0, -2.0], 0.5),
                ([1.0, 3.0, 2.0], soft(2.0 / 4.0)),
                ([0.0, -3.0, 2.0], soft(3.0 / 4.0)),
                ([3.0, 0.0, 0.0], 0.0),
            ],
        ),
        // (3, 1, 2) is (2, -1, 0) and the normal; (2, 4, -5), which is sqrt(45) long, is across both.
        row(
            "across any direction",
            "rectangle { normal (1 2 2) along (3 1 2) half_length 1 half_width 2 radius 2 }",
            &[
                ([1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], 0.5),
                ([2.0, -1.0, 0.0], soft((5f64.sqrt() - 1.0).powi(2) / 4.0)),
                ([1.0, 2.0, -2.5], soft((45f64.sqrt() / 2.0 - 2.0).powi(2) / 4.0)),
            ],
        ),
        row(
            "of no width",
            "rectangle { half_length 1 half_width 0 radius 1 }",
            &[
                ([0.5, 0.0, 0.0], 1.0),
                ([0.5, 0.5, 0.0], 0.5),
                ([-1.5, 0.0, 0.0], 0.5),
                ([0.0, 0.0, 1.0], 0.0),
            ],
        ),
    ]
}
