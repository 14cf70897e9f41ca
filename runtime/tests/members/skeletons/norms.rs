//! Points whose distance is another norm: of a radius R, the field is 1/2 where the norm is R/2.

use crate::falloffs::soft;
use crate::row::{Row, row};

pub fn ellipsoids() -> Vec<Row> {
    vec![
        row(
            "along the axes",
            "ellipsoid { center (1 0 0) stretch (2 1 0.5) radius 2 }",
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([3.0, 0.0, 0.0], 0.5),
                ([1.0, -1.0, 0.0], 0.5),
                ([1.0, 0.0, 0.5], 0.5),
                ([3.0, 1.0, 0.0], soft(2.0 / 4.0)),
                ([-1.0, 1.0, -0.5], soft(3.0 / 4.0)),
                ([5.0, 0.0, 0.0], 0.0),
                ([1.0, 0.0, 1.0], 0.0),
            ],
        ),
        row(
            "that is turned",
            "rotate axis z degrees 90 { ellipsoid { stretch (2 1 1) radius 2 } }",
            &[([0.0; 3], 1.0), ([0.0, 2.0, 0.0], 0.5), ([1.0, 0.0, 0.0], 0.5), ([0.0, 0.0, -1.0], 0.5)],
        ),
    ]
}

pub fn lmetrics() -> Vec<Row> {
    vec![
        row(
            "of exponent 1: an octahedron",
            "lmetric { exponent 1 radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([0.0, 1.0, 0.0], 0.5),
                ([0.5, 0.5, 0.0], 0.5),
                ([0.5, -0.25, 0.25], 0.5),
                ([0.5, 0.5, 0.5], soft(1.5 * 1.5 / 4.0)),
                ([1.0, 0.5, -0.5], 0.0),
            ],
        ),
        // (1 + 1)^(2/3), squared.
        row(
            "of exponent 3/2, stretched",
            "lmetric { center (0 0 1) exponent 1.5 stretch (2 1 1) radius 2 }",
            &[
                ([0.0, 0.0, 1.0], 1.0),
                ([2.0, 0.0, 1.0], 0.5),
                ([2.0, 1.0, 1.0], soft(2f64.powf(4.0 / 3.0) / 4.0)),
            ],
        ),
        row(
            "of exponent 2: a ball",
            "lmetric { exponent 2 radius 2 }",
            &[([1.0, 0.0, 0.0], 0.5), ([1.0, -1.0, 0.0], soft(2.0 / 4.0)), ([0.0, 0.0, 2.0], 0.0)],
        ),
        // (1 + 1)^(1/4), squared, and so on.
        row(
            "of exponent 4",
            "lmetric { exponent 4 radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([0.0, 0.0, -1.0], 0.5),
                ([1.0, 1.0, 0.0], soft(2f64.sqrt() / 4.0)),
                ([1.0, -1.0, 1.0], soft(3f64.sqrt() / 4.0)),
                ([2.0, 0.0, 0.0], 0.0),
            ],
        ),
        // All but a cube: half of a coordinate, to this power, is 0 in f64 too.
        row(
            "of the largest exponent",
            "lmetric { exponent 1024 radius 2 }",
            &[([1.0, 0.5, -0.25], 0.5), ([1.0, 1.0, 1.0], soft(3f64.powf(2.0 / 1024.0) / 4.0))],
        ),
    ]
}

pub fn superquadrics() -> Vec<Row> {
    vec![
        // Slices are round, profiles have the exponent 4.
        row(
            "like a barrel",
            "superquadric { e1 0.5 e2 1 radius 2 }",
            &[
                ([0.0; 3], 1.0),
                ([1.0, 0.0, 0.0], 0.5),
                ([0.0, 0.0, 1.0], 0.5),
                ([1.0, 1.0, 0.0], soft(2.0 / 4.0)),
                ([1.0, 0.0, -1.0], soft(2f64.sqrt() / 4.0)),
                ([1.0, 1.0, 1.0], soft(5f64.sqrt() / 4.0)),
                ([0.0, 0.0, 2.0], 0.0),
            ],
        ),
        // Slices have the exponent 4, profiles are round.
        row(
            "like a cushion, stretched",
            "superquadric { center (0 1 0) e1 1 e2 0.5 stretch (1 2 0.5) radius 2 }",
            &[
                ([0.0, 1.0, 0.0], 1.0),
                ([0.0, 3.0, 0.0], 0.5),
                ([1.0, 3.0, 0.0], soft(2f64.sqrt() / 4.0)),
                ([1.0, -1.0, 0.5], soft((2f64.sqrt() + 1.0) / 4.0)),
            ],
        ),
        row(
            "with facets: an octahedron",
            "superquadric { e1 2 e2 2 radius 2 }",
            &[([0.0; 3], 1.0), ([0.5, 0.25, 0.25], 0.5), ([0.0, -0.5, 0.5], 0.5), ([0.0, 0.0, 1.0], 0.5)],
        ),
        row(
            "like a ball",
            "superquadric { e1 1 e2 1 radius 2 }",
            &[([0.0, 0.0, 1.0], 0.5), ([1.0, 1.0, -1.0], soft(3.0 / 4.0))],
        ),
    ]
}
