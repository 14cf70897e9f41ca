//! Warps of a part of space: the space map, the deformation, and any warp with a weight.

use crate::falloffs::soft;
use crate::row::{Row, row};

pub(super) fn space_maps() -> Vec<Row> {
    // (1 - t)^3 / (1 + t) is 1 at 0, 1/12 at 1/2 and 27/80 at 1/4.
    let half = 0.5 - 1.0 / 24.0;
    let pulled = "space_map from (0 0 0) to (0 0.5 0) radius 2 { color (1 0 0) { point { radius 2 } } }";
    vec![
        row(
            "of a ball",
            pulled,
            &[
                ([0.0, 0.5, 0.0], 1.0),
                ([1.0, 0.5, 0.0], soft((1.0 + half * half) / 4.0)),
                ([0.0, 1.5, 0.0], soft((1.0 + half).powi(2) / 4.0)),
                ([0.0; 3], soft((27.0f64 / 160.0).powi(2) / 4.0)),
                // At the rim, and beyond it, nothing moves.
                ([0.0, -1.5, 0.0], soft(2.25 / 4.0)),
                ([0.0, -1.75, 0.0], soft(1.75 * 1.75 / 4.0)),
                ([0.0, 2.5, 0.0], 0.0),
            ],
        )
        .attribute("color", [0.0, 1.0, 0.0], &[1.0, 0.0, 0.0]),
        // Space folds: the middle of the ball is seen where it is and where it is pulled to.
        row(
            "that folds",
            "space_map from (0 0 0) to (0 0 1) radius 1 { point { radius 1 } }",
            &[
                ([0.0; 3], 1.0),
                ([0.0, 0.0, 1.0], 1.0),
                ([0.0, 0.0, 0.5], soft(25.0 / 144.0)),
                ([0.0, 0.0, -0.5], 0.5),
                ([0.5, 0.0, 1.0], soft(0.25 + 121.0 / 144.0)),
            ],
        ),
        row(
            "to where it is",
            "space_map from (1 0 0) to (1 0 0) radius 3 { point { radius 1 } }",
            &[([0.0; 3], 1.0), ([0.5, 0.0, 0.0], 0.5), ([1.0, 0.0, 0.0], 0.0)],
        ),
        // The ball is out of reach; a part of the sum is not.
        row(
            "in a sum",
            "param t = 0.25 sum { space_map from (0 0 0) to (4 * t 0 0) radius 4 * t { point { at (0 3 0) radius 2 } } point { radius 1 } }",
            &[([0.0, 3.0, 0.0], 1.0), ([0.0; 3], 1.0), ([1.0, 3.0, 0.0], 0.5)],
        ),
    ]
}

pub(super) fn deformations() -> Vec<Row> {
    // A quarter turn about (1, 0) after a stretch to twice the length: (x, y) goes to (1 - y, 2 (x - 1)).
    let turned =
        "deform degrees 90 size (2 1 1) center (1 0 0) { segment { from (1 0 0) to (2 0 0) radius 1 } }";
    let mut rows = vec![
        row(
            "that moves",
            "deform by (0 1 0.5) { color (1 0 0) { point { radius 1 } } }",
            &[([0.0, 1.0, 0.5], 1.0), ([0.5, 1.0, 0.5], 0.5), ([0.0; 3], 0.0)],
        )
        .attribute("color", [0.0, 1.0, 0.5], &[1.0, 0.0, 0.0]),
        row(
            "that scales and turns",
            turned,
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([1.0, 2.0, 0.0], 1.0),
                ([0.5, 1.0, 0.0], 0.5),
                ([1.0, 3.0, 0.0], 0.5),
                ([1.0, 1.0, -0.5], 0.5),
                ([1.0, -1.0, 0.0], 0.5),
            ],
        ),
        // The axes go round: x becomes y, y becomes z.
        row(
            "about any axis",
            "param t = 1 deform by (0 0 t) axis (t t t) degrees 120 * t { segment { from (0 0 0) to (2 0 0) radius 1 } }",
            &[([0.0, 1.0, 1.0], 1.0), ([0.0, 2.5, 1.0], 0.5), ([0.0, 1.0, 1.5], 0.5), ([2.0, 0.0, 0.0], 0.0)],
        ),
    ];
    rows.extend(weighted_deformations());
    rows
}

/// The child, a ball, is moved up by as much as the weight says.
fn weighted_deformations() -> [Row; 4] {
    let lifted = |weight: &str| {
        format!(
            "deform by (0 0 1) weighted {{ color (1 0 0) {{ point {{ radius 2 }} }} color (0 0 1) {{ {weight} }} }}"
        )
    };
    [
        // The weight is 1 at (0, 0, 1), 1/2 half a unit away from there, 0 one unit away.
        row(
            "by a weight",
            lifted("point { at (0 0 1) radius 1 }"),
            &[
                ([0.0, 0.0, 1.0], 1.0),
                ([0.0, 0.0, 0.5], 1.0),
                ([0.0; 3], 1.0),
                ([0.5, 0.0, 1.0], soft(0.5 / 4.0)),
                ([0.0, 0.0, 1.5], 0.5),
                ([0.0, 0.0, -1.0], 0.5),
                ([1.0, 0.0, 1.0], soft(2.0 / 4.0)),
            ],
        )
        // The weight's colour does not count.
        .attribute("color", [0.0, 0.0, 1.0], &[1.0, 0.0, 0.0]),
        row(
            "by a weight above 1",
            lifted("point { at (0 0 1) radius 1 strength 2 }"),
            &[
                ([0.0, 0.0, 1.0], 1.0),
                ([0.0, 0.0, 0.5], soft(0.25 / 4.0)),
                ([0.0, 0.0, 1.5], soft(0.25 / 4.0)),
            ],
        ),
        row(
            "by a weight below 0",
            lifted("sum { point { at (0 0 1) radius 1 } point { at (0 0 -1) radius 1 strength -1 } }"),
            &[([0.0, 0.0, 0.5], 1.0), ([0.0, 0.0, -1.0], 0.5), ([0.0, 1.0, 0.0], 0.5)],
        ),
        // Everywhere the same: half of the way.
        row(
            "by a weight without end",
            lifted("expression { 0.5 }"),
            &[
                ([0.0, 0.0, 0.5], 1.0),
                ([0.0, 0.0, -0.5], 0.5),
                ([1.0, 0.0, 0.5], 0.5),
                ([0.0, 0.0, 2.5], 0.0),
            ],
        )
        .unbounded([-2.5; 3], [2.5; 3]),
    ]
}

/// Other warps with a weight.
pub(super) fn weighted_twists() -> [Row; 2] {
    [
        // At height 1/2 it is a quarter turn, which takes (1/2, 0) from (0, -1/2); half of the way is (1/4,
        // -1/4).
        row(
            "by a weight",
            "twist rate pi weighted { point { at (0.25 -0.25 0.5) radius 1 } point { at (0.5 0 1) radius 1 } }",
            &[([0.5, 0.0, 0.5], 1.0), ([0.5, 0.0, 0.0], soft(0.375)), ([0.25, 0.25, -0.5], 0.0)],
        ),
        // Two children under one weight; the second stands in the sum without it.
        row(
            "by a weight that is seen",
            "let ball = point { at (0 0 1) radius 1 }
            sum { twist rate 2 weighted { segment { from (-1 0 0) to (1 0 0) radius 0.5 } use ball } use ball twist rate 1 weighted { point { radius 0.5 } use ball } }",
            &[([0.0, 0.0, 1.0], 1.0), ([1.0, 0.0, 0.0], 1.0), ([0.25, 0.0, 0.0], 1.5), ([0.0, 0.0, 0.25], 0.5 + 0.5 + soft(0.75 * 0.75))],
        ),
    ]
}
