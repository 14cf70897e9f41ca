//! Solids: the field is 1 everywhere in them.

use crate::falloffs::soft;
use crate::row::{Row, row};

pub fn spheres() -> Vec<Row> {
    vec![
        row(
            "anywhere",
            "sphere { center (1 0 0) sphere_radius 2 radius 2 }",
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([2.0, 1.0, 0.0], 1.0),
                ([3.0, 0.0, 0.0], 1.0),
                ([4.0, 0.0, 0.0], 0.5),
                // (2, 2, 1) is 3 long.
                ([3.0, 2.0, 1.0], 0.5),
                ([1.0, 0.0, -4.0], 0.0),
            ],
        ),
        row(
            "of no size",
            "sphere { sphere_radius 0 radius 2 }",
            &[([0.0; 3], 1.0), ([0.0, 1.0, 0.0], 0.5), ([0.0, 0.0, 2.0], 0.0)],
        ),
    ]
}

pub fn tori() -> Vec<Row> {
    vec![
        // On the axis all of it is equally far.
        row(
            "about an axis",
            "torus { normal x ring_radius 3 tube_radius 1 radius 4 }",
            &[
                ([0.0, 3.0, 0.0], 1.0),
                ([1.0, 0.0, 3.0], 1.0),
                ([0.0, 0.0, -4.0], 1.0),
                ([0.0, 6.0, 0.0], 0.5),
                ([3.0, 3.0, 0.0], 0.5),
                ([0.0; 3], 0.5),
                ([1.0, 0.0, 0.0], soft((10f64.sqrt() - 1.0).powi(2) / 16.0)),
                ([4.0, 0.0, 0.0], 0.0),
            ],
        ),
        row(
            "about any direction",
            "torus { center (0 0 1) normal (1 2 2) ring_radius 1 tube_radius 0.5 radius 2 }",
            &[
                ([0.0, 0.0, 1.0], soft(0.25 / 4.0)),
                ([2.0, -1.0, 1.0], soft((5f64.sqrt() - 1.5).powi(2) / 4.0)),
            ],
        ),
        row(
            "whose tube is thicker than its ring",
            "torus { ring_radius 1 tube_radius 2 radius 2 }",
            &[([0.0; 3], 1.0), ([4.0, 0.0, 0.0], 0.5), ([0.0, 0.0, 8f64.sqrt()], 0.5)],
        ),
        row(
            "without a ring: a ball",
            "torus { ring_radius 0 tube_radius 1 radius 2 }",
            &[([0.0; 3], 1.0), ([0.0, 2.0, 0.0], 0.5), ([0.0, 0.0, -2.0], 0.5), ([3.0, 0.0, 0.0], 0.0)],
        ),
        row(
            "without a tube: a ring",
            "torus { ring_radius 1 tube_radius 0 radius 2 }",
            &[([1.0, 0.0, 0.0], 1.0), ([0.0; 3], 0.5), ([0.0, 1.0, 1.0], 0.5)],
        ),
    ]
}

pub fn cones() -> Vec<Row> {
    vec![
        // Its side faces (4, 3) / 5.
        row(
            "with a tip",
            "cone { from (0 0 0) to (0 0 4) from_radius 3 radius 2 }",
            &[
                ([0.0, 0.0, 1.0], 1.0),
                ([0.0, 0.0, 4.0], 1.0),
                ([0.0, -3.0, 0.0], 1.0),
                ([1.5 + 4.0 / 5.0, 0.0, 2.0 + 3.0 / 5.0], 0.5),
                ([0.0, 0.0, 5.0], 0.5),
                ([1.0, 1.0, -1.0], 0.5),
                ([4.0, 0.0, 0.0], 0.5),
                ([0.0, 4.0, -1.0], soft(2.0 / 4.0)),
                ([0.0, 0.0, 6.0], 0.0),
            ],
        ),
        // Its side faces (4, -3) / 5, outwards and along.
        row(
            "cut off, growing",
            "cone { from (0 0 0) to (4 0 0) from_radius 1 to_radius 4 radius 2 }",
            &[
                ([2.0, 2.0, 0.0], 1.0),
                ([2.0 - 3.0 / 5.0, 2.5 + 4.0 / 5.0, 0.0], 0.5),
                ([5.0, 0.0, 2.0], 0.5),
                ([-1.0, 0.5, 0.0], 0.5),
                ([4.0, 0.0, 5.0], 0.5),
            ],
        ),
        // As the cylinder that it is.
        row(
            "with equal radii, in any direction",
            "cone { from (0 0 0) to (1 2 2) from_radius 1 to_radius 1 radius 2 }",
            &[
                ([0.5, 1.0, 1.0], 1.0),
                ([2.5, 0.0, 1.0], soft((5f64.sqrt() - 1.0).powi(2) / 4.0)),
                ([4.0 / 3.0, 8.0 / 3.0, 8.0 / 3.0], 0.5),
            ],
        ),
        row(
            "of no length: a disc",
            "cone { from (0 0 1) to (0 0 1) from_radius 1 to_radius 0.5 radius 2 }",
            &[([0.75, 0.0, 1.0], 1.0), ([0.0, 0.0, 2.0], 0.5), ([0.0, -2.0, 1.0], 0.5)],
        ),
        row(
            "of no radius: a segment",
            "cone { from (0 0 0) to (0 2 0) from_radius 0 to_radius 0 radius 2 }",
            &[([0.0, 1.0, 0.0], 1.0), ([1.0, 1.0, 0.0], 0.5), ([0.0, 3.0, 0.0], 0.5)],
        ),
    ]
}

pub fn round_cones() -> Vec<Row> {
    // The radius grows by k = 0.3 of the way, so the flank faces (-k, sqrt(1 - k^2)): 1 outside of the ball
    // of radius 1.1 at x = 2.
    let (k, far) = (0.3, 1.1 + 1.0);
    let beside = [2.0 - far * k, far * (1f64 - k * k).sqrt(), 0.0];
    vec![
        row(
            "that grows a little",
            "round_cone { from (0 0 0) to (5 0 0) from_radius 0.5 to_radius 2 radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([2.0, 0.0, 1.0], 1.0),
                ([6.0, 1.0, 1.0], 1.0),
                (beside, 0.5),
                ([-1.5, 0.0, 0.0], 0.5),
                ([8.0, 0.0, 0.0], 0.5),
                ([5.0, -4.0, 0.0], 0.0),
            ],
        ),
        // k = -3/5: the flank faces (3, 4) / 5.
        row(
            "that shrinks much",
            "round_cone { from (0 0 0) to (0 0 5) from_radius 4 to_radius 1 radius 2 }",
            &[
                ([0.0, 3.5, 0.0], 1.0),
                ([0.0, 3.5 * 4.0 / 5.0, 2.5 + 3.5 * 3.0 / 5.0], 0.5),
                ([0.0, 0.0, 7.0], 0.5),
                ([0.0, 0.0, -5.0], 0.5),
                // Beside the axis, where the large ball begins: at the angle of the flank.
                ([0.0, 5.0 * 4.0 / 5.0, 5.0 * 3.0 / 5.0], 0.5),
            ],
        ),
        // k = -2.
        row(
            "of which one ball holds the other",
            "round_cone { from (0 0 0) to (1 0 0) from_radius 3 to_radius 1 radius 2 }",
            &[
                ([2.0, 0.0, 0.0], 1.0),
                ([4.0, 0.0, 0.0], 0.5),
                ([0.0, 0.0, -4.0], 0.5),
                ([0.0, 5.0, 0.0], 0.0),
            ],
        ),
        // k = 1.
        row(
            "of which one ball touches the other from inside",
            "round_cone { from (0 0 0) to (1 0 0) from_radius 0.5 to_radius 1.5 radius 2 }",
            &[([0.0; 3], 1.0), ([1.0, 2.5, 0.0], 0.5), ([-1.5, 0.0, 0.0], 0.5), ([3.5, 0.0, 0.0], 0.5)],
        ),
        row(
            "with equal radii: a capsule",
            "round_cone { from (-1 0 0) to (1 0 0) from_radius 1 to_radius 1 radius 2 }",
            &[([2.0, 0.0, 0.0], 1.0), ([0.0, 2.0, 0.0], 0.5), ([-3.0, 0.0, 0.0], 0.5)],
        ),
        row(
            "of no length: the larger ball",
            "round_cone { from (0 1 0) to (0 1 0) from_radius 0.5 to_radius 1 radius 2 }",
            &[([0.0, 1.0, 0.0], 1.0), ([0.0, 3.0, 0.0], 0.5), ([2.0, 1.0, 0.0], 0.5)],
        ),
    ]
}

pub fn half_spaces() -> Vec<Row> {
    vec![
        row(
            "across an axis",
            "half_space { at (1 0 0) normal x radius 2 }",
            &[
                ([0.0, 5.0, -7.0], 1.0),
                ([1.0, 0.0, 0.0], 1.0),
                ([2.0, 0.0, 0.0], 0.5),
                ([2.5, 9.0, 9.0], soft(9.0 / 16.0)),
                ([3.0, 0.0, 0.0], 0.0),
            ],
        )
        .unbounded([-2.0; 3], [4.0; 3]),
        row(
            "across any direction",
            "half_space { at (0 0 1) normal (1 2 2) radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([2.0, -1.0, 1.0], 1.0),
                ([1.0 / 3.0, 2.0 / 3.0, 5.0 / 3.0], 0.5),
                ([2.0, 2.0, 1.0], 0.0),
            ],
        )
        .unbounded([-2.0; 3], [3.0; 3]),
        row(
            "that cuts",
            "intersection { half_space { radius 1 } sphere { sphere_radius 1 radius 1 } }",
            &[
                ([0.0; 3], 1.0),
                ([0.0, 0.0, 0.5], 0.5),
                ([0.0, -1.5, 0.0], 0.5),
                ([0.0, 0.0, -1.5], 0.5),
                ([0.0, 0.0, 1.0], 0.0),
            ],
        ),
    ]
}
