//! Warps that show one child several times: mirror and repetitions. Walls stand between what they show; what
//! does not fit ends there, with a jump.

use crate::falloffs::soft;
use crate::row::{Row, row};

pub(super) fn mirrors() -> Vec<Row> {
    vec![
        row(
            "of a ball beside it",
            "mirror axis x { color (1 0 0) { point { at (2 0 0) radius 1 } } }",
            &[
                ([2.0, 0.0, 0.0], 1.0),
                ([-2.0, 0.0, 0.0], 1.0),
                ([-2.5, 0.0, 0.0], 0.5),
                ([-2.0, 0.5, 0.0], 0.5),
                ([0.0; 3], 0.0),
            ],
        )
        .attribute("color", [-2.0, 0.25, 0.0], &[1.0, 0.0, 0.0]),
        // The two sides meet in a crease.
        row(
            "of a ball across it",
            "mirror { point { at (0 0 0.5) radius 2 } }",
            &[
                ([0.0; 3], soft(0.25 / 4.0)),
                ([0.0, 0.0, -0.5], 1.0),
                ([0.0, 0.0, 1.5], 0.5),
                ([1.0, 0.0, -0.5], 0.5),
            ],
        ),
        // What is on the other side is not seen.
        row(
            "of one that it hides and one that it shows",
            "mirror axis y { sum { point { at (0 -3 0) radius 1 } point { at (0 2 0) radius 1 } } }",
            &[
                ([0.0, -3.0, 0.0], 0.0),
                ([0.0, 3.0, 0.0], 0.0),
                ([0.0, -2.0, 0.0], 1.0),
                ([0.0, 2.0, 0.0], 1.0),
            ],
        ),
        row(
            "in three planes",
            "mirror axis x { mirror axis y { mirror axis z { segment { from (1 1 1) to (2 1 1) radius 1 } } } }",
            &[([-1.5, -1.0, -1.0], 1.0), ([1.5, -1.0, 0.5], 0.5), ([-2.5, 1.0, -1.0], 0.5), ([0.0; 3], 0.0)],
        ),
    ]
}

pub(super) fn repetitions() -> Vec<Row> {
    let ball = "color (1 0 0) { point { radius 0.75 } }";
    vec![
        row(
            "of three",
            format!("repeat axis x spacing 2 count 3 {{ {ball} }}"),
            &[
                ([0.0; 3], 1.0),
                ([2.0, 0.0, 0.0], 1.0),
                ([4.0, 0.0, 0.0], 1.0),
                ([-2.0, 0.0, 0.0], 0.0),
                ([6.0, 0.0, 0.0], 0.0),
                ([-0.375, 0.0, 0.0], 0.5),
                ([2.375, 0.0, 0.0], 0.5),
                ([4.0, 0.375, 0.0], 0.5),
                ([1.25, 0.0, 0.0], 0.0),
            ],
        )
        .attribute("color", [2.25, 0.0, 0.0], &[1.0, 0.0, 0.0]),
        // The wall is at 1. On its one side the ball is 0.4 away, on the other one 1.4; the first and the
        // last copy end where they do.
        row(
            "that walls cut",
            "repeat axis x spacing 2 count 2 { point { at (0.5 0 0) radius 2 } }",
            &[
                ([0.5, 0.0, 0.0], 1.0),
                ([0.875, 0.0, 0.0], soft(0.375 * 0.375 / 4.0)),
                ([1.125, 0.0, 0.0], soft(1.375 * 1.375 / 4.0)),
                ([2.5, 0.0, 0.0], 1.0),
                ([-0.5, 0.0, 0.0], 0.5),
                ([3.5, 0.0, 0.0], 0.5),
                ([4.5, 0.0, 0.0], 0.0),
            ],
        ),
        row(
            "of one",
            format!("repeat spacing 0.5 count 1 {{ {ball} }}"),
            &[([0.0; 3], 1.0), ([0.0, 0.0, 0.375], 0.5), ([0.0, 0.0, 0.75], 0.0)],
        ),
        row(
            "without end",
            "repeat axis z spacing 1.5 { point { radius 0.5 } }",
            &[
                ([0.0; 3], 1.0),
                ([0.0, 0.0, -15.0], 1.0),
                ([0.0, 0.25, 150.0], 0.5),
                ([0.0, 0.0, 3.25], 0.5),
                ([0.0, 0.0, 0.75], 0.0),
            ],
        )
        .unbounded([-0.75, -0.75, -4.0], [0.75, 0.75, 4.0]),
        row(
            "of a repetition",
            "repeat axis y spacing 2 count 2 { repeat axis x spacing 3 count 4 { segment { from (-0.5 0 0) to (0.5 0 0) radius 0.5 } } }",
            &[
                ([9.0, 2.0, 0.0], 1.0),
                ([6.5, 2.25, 0.0], 0.5),
                ([3.75, 0.0, 0.0], 0.5),
                ([1.5, 0.0, 0.0], 0.0),
                ([12.0, 0.0, 0.0], 0.0),
            ],
        ),
        row(
            "by a parameter",
            format!("param n = 1 repeat axis y spacing 2 * n count n + 1 {{ {ball} }}"),
            &[([0.0, 2.0, 0.0], 1.0), ([0.0, 2.375, 0.0], 0.5), ([0.0, 4.0, 0.0], 0.0)],
        ),
    ]
}

pub(super) fn repetitions_around() -> Vec<Row> {
    let spoke = "color (1 0 0) { segment { from (1 0 0) to (2 0 0) radius 0.5 } }";
    let height = 3.0f64.sqrt() / 2.0;
    vec![
        row(
            "of four spokes",
            format!("repeat_around count 4 {{ {spoke} }}"),
            &[
                ([1.5, 0.0, 0.0], 1.0),
                ([0.0, 1.5, 0.0], 1.0),
                ([-1.5, 0.0, 0.0], 1.0),
                ([0.0, -1.5, 0.25], 0.5),
                ([0.0, 2.25, 0.0], 0.5),
                ([-0.75, 0.0, 0.0], 0.5),
                ([0.0; 3], 0.0),
                ([1.5, 1.5, 0.0], 0.0),
            ],
        )
        .attribute("color", [0.0, 1.5, 0.0], &[1.0, 0.0, 0.0]),
        // About x the first stands along y, the others at 120 degrees.
        row(
            "of three about x",
            "repeat_around axis x count 3 { segment { from (0 1 0) to (0 2 0) radius 0.5 } }",
            &[
                ([0.0, 1.5, 0.0], 1.0),
                ([0.0, -0.75, 1.5 * height], 1.0),
                ([0.0, -0.75, -1.5 * height], 1.0),
                ([0.25, -1.0, -2.0 * height], 0.5),
                ([0.0, -1.5, 0.0], 0.0),
            ],
        ),
        // All meet on the axis; half way between two spokes, both are 1/2 away across.
        row(
            "that meet",
            "repeat_around axis y count 6 { segment { from (0 0 0) to (0 0 2) radius 1 } }",
            &[
                ([0.0; 3], 1.0),
                ([0.0, 0.5, 0.0], 0.5),
                ([height, 0.0, 0.5], 1.0),
                ([0.5, 0.0, height], soft(0.25)),
                ([height, 0.5, -0.5], 0.5),
            ],
        ),
        // The wall is x = 0. Beyond it (0.125, -0.5, 0) is asked.
        row(
            "that walls cut",
            "repeat_around count 2 { point { at (1 0.5 0) radius 1 } }",
            &[
                ([1.0, 0.5, 0.0], 1.0),
                ([-1.0, -0.5, 0.0], 1.0),
                ([0.125, 0.5, 0.0], soft(0.875 * 0.875)),
                ([-0.125, 0.5, 0.0], 0.0),
                ([-1.5, -0.5, 0.0], 0.5),
            ],
        ),
        row(
            "of one",
            format!("repeat_around count 1 {{ {spoke} }}"),
            &[([1.5, 0.0, 0.0], 1.0), ([-1.5, 0.0, 0.0], 0.0), ([1.5, 0.25, 0.0], 0.5)],
        ),
        row(
            "by a parameter",
            format!("param n = 1 repeat_around count 4 * n {{ {spoke} }}"),
            &[([0.0, 1.5, 0.0], 1.0), ([0.0, -1.5, 0.25], 0.5)],
        ),
    ]
}
