//! Expressions: formulas as leaves, over children, within boxes, and of distances.

use crate::falloffs::soft;
use crate::row::{Row, row};

/// A red ball at (-1, 0, 0), a blue one at (1, 0, 0), both 2 far, and a plain one in the middle.
const BALLS: &str = "let red = color (1 0 0) { point { at (-1 0 0) radius 2 } } let blue = color (0 0 1) { point { at (1 0 0) radius 2 } }
    let ball = point { radius 1 }";

/// The fields of the red and the blue ball.
fn fields([x, y, z]: [f64; 3]) -> [f64; 2] {
    [-1.0, 1.0].map(|at| soft(((x - at).powi(2) + y * y + z * z) / 4.0))
}

pub(super) fn rows() -> Vec<Row> {
    leaves().into_iter().chain(boxes()).chain(over_children()).chain(distances()).collect()
}

fn leaves() -> [Row; 4] {
    [
        // A cone whose axis is z: the root has no gradient there.
        row(
            "a cone",
            "color (1 0 0) { expression { 1 - sqrt(x^2 + y^2) / 2 } }",
            &[([0.0; 3], 1.0), ([1.0, 0.0, 7.0], 0.5), ([3.0, 4.0, 0.0], -1.5)],
        )
        // As a leaf that is alone it has its colour everywhere.
        .attribute("color", [1.0, 1.0, 1.0], &[1.0, 0.0, 0.0])
        .unbounded([-2.0; 3], [2.0; 3]),
        row(
            "a definition that is used twice",
            "param k = 8 expression { r = length(x, y, z), 1 - r + sin(k * r) / 8 }",
            &[([0.0; 3], 1.0), ([0.0, 0.75, 1.0], 1.0 - 1.25 + 10.0f64.sin() / 8.0)],
        )
        .unbounded([-1.5; 3], [1.5; 3]),
        // Poles are 0, and so is what has no root.
        row(
            "poles",
            "expression within (-2 -2 -2) to (2 2 2) { clamp(1 / x, -2, 2) + sqrt(y) + z^-2 / (1 + z^-2) }",
            &[
                ([0.0; 3], 0.0),
                ([2.0, 1.0, 1.0], 0.5 + 1.0 + 0.5),
                ([-0.25, -1.0, 0.0], -2.0),
                ([1.0, 0.25, -2.0], 1.0 + 0.5 + 0.2),
            ],
        ),
        row(
            "in the space of maps",
            "translate (1 0 0) { scale 2 { rotate axis z degrees 90 { expression within (-1 -1 -1) to (1 1 1) { 0.5 + x / 4 + y / 8 } } } }",
            &[
                ([1.0, 0.0, 0.0], 0.5),
                ([1.0, 1.0, 0.0], 0.5 + 0.125),
                ([0.0, 0.0, 0.0], 0.5 + 0.0625),
                ([4.0, 0.0, 0.0], 0.0),
            ],
        ),
    ]
}

fn boxes() -> [Row; 3] {
    [
        // Outside it is exactly 0, however much it is at the sides, which belong to it.
        row(
            "within a box",
            "expression within (-1 -1 -1) to (1 1 0.5) { 2 + x * y * z }",
            &[
                ([0.0; 3], 2.0),
                ([0.5, 0.5, 0.5], 2.125),
                ([1.0, -1.0, -1.0], 3.0),
                ([0.5, 0.5, 0.5625], 0.0),
                ([-1.0625, 0.0, 0.0], 0.0),
            ],
        ),
        row(
            "a tree within a box",
            "within (0 0 0) to (1 1 1) { color (1 0 0) { point { radius 1 } } }",
            &[
                ([0.5, 0.0, 0.0], 0.5),
                ([-0.5, 0.0, 0.0], 0.0),
                ([0.5, 0.5, 0.0], soft(0.5)),
                ([0.5, -0.25, 0.0], 0.0),
            ],
        )
        .attribute("color", [0.5, 0.25, 0.25], &[1.0, 0.0, 0.0])
        // The only child has a field there, and so its colour.
        .attribute("color", [-0.5, 0.25, 0.25], &[1.0, 0.0, 0.0])
        .attribute("color", [2.0, 0.25, 0.25], &[1.0; 3]),
        row(
            "within a box that depends on a parameter, in a sum",
            "param t = 0.5 sum { expression within (-t -t -t) to (t t t) { 1 - x^2 } box { half (1 1 1) radius 0.5 } }",
            &[
                ([0.0; 3], 2.0),
                ([0.25, 0.5, -0.5], 0.9375 + 1.0),
                ([0.75, 0.0, 0.0], 1.0),
                ([0.0, 1.25, 0.0], 0.5),
            ],
        ),
    ]
}

fn over_children() -> Vec<Row> {
    let of = |formula: &str| format!("{BALLS} expression {{ {formula} }}");
    let places = [[0.0; 3], [0.5, 0.0, 0.0], [-0.25, 0.5, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
    let there = |field: fn(f64, f64) -> f64| {
        places.map(|at| {
            let [red, blue] = fields(at);
            (at, field(red, blue))
        })
    };
    let purple = |red: f64, blue: f64| [red / (red + blue), 0.0, blue / (red + blue)];
    let at = [0.5, 0.25, 0.0];
    let [red, blue] = fields(at);
    let sum = red + 0.5 * blue;
    vec![
        // Weights are f dF/df: those of a sum are its terms.
        row("a sum", of("field(red) + 0.5 * field(blue)"), &there(|a, b| a + 0.5 * b))
            .attribute("color", at, &purple(red / sum, 0.5 * blue / sum))
            .attribute("color", [0.0, 0.0, 5.0], &[1.0; 3]),
        // Those of a product are equal, those of powers as the exponents.
        row("a product", of("2 * field(red) * field(blue)"), &there(|a, b| 2.0 * a * b))
            .attribute("color", [0.0; 3], &[0.5, 0.0, 0.5])
            .attribute("color", [0.0, 0.5, 0.0], &[0.5, 0.0, 0.5]),
        row("a product of powers", of("field(red)^3 * field(blue)"), &there(|a, b| a.powi(3) * b)),
        row(
            "with one subtracted",
            of("0.7 * field(red) * field(ball) - 0.3 * field(blue)^2"),
            &[
                ([0.0; 3], 0.35 - 0.075),
                ([1.0, 0.0, 0.0], -0.3),
                ([-0.5, 0.0, 0.0], 0.35 * soft(1.0 / 16.0) - 0.3 * soft(9.0 / 16.0).powi(2)),
            ],
        ),
        // By the point as well: it reaches as far as its child does.
        row(
            "of a child and the point",
            of("field(red) * (1 + 0.5 * sin(pi * x))"),
            &[
                ([0.0; 3], 0.5),
                ([-0.5, 0.0, 0.0], 0.5 * soft(1.0 / 16.0)),
                ([0.5, 0.0, 0.0], 1.5 * soft(9.0 / 16.0)),
                ([3.0, 0.0, 0.0], 0.0),
            ],
        )
        .attribute("color", [-0.5, 0.25, 0.0], &[1.0, 0.0, 0.0]),
        row("a maximum", of("max(field(red), field(blue))"), &there(f64::max)).attribute(
            "color",
            at,
            &[0.0, 0.0, 1.0],
        ),
        // What is not 0 with its children reaches everywhere.
        row("a complement", of("1 - field(red)"), &there(|a, _| 1.0 - a))
            .unbounded([-3.5, -2.5, -2.5], [1.5, 2.5, 2.5]),
        row(
            "in each other, and in a blend",
            format!(
                "{BALLS} let both = expression {{ field(red) + field(blue) }} blend ricci 2 {{ expression {{ field(both)^2 }} use ball }}"
            ),
            &[
                ([0.0; 3], 2.0f64.sqrt()),
                ([1.0, 0.0, 0.0], 1.0),
                ([0.0, 0.5, 0.0], (2.0 * soft(1.25 / 4.0)).powi(2).hypot(0.5)),
            ],
        ),
    ]
}

fn distances() -> [Row; 3] {
    [
        // A box with half sides of 1: 1 inside, 1/2 at 1/2, 0 from 1 on.
        row(
            "the falloff of a distance",
            "within (-1.5 -1.5 -1.5) to (1.5 1.5 1.5) { falloff soft radius 1 { expression { max(abs(x) - 1, abs(y) - 1, abs(z) - 1) } } }",
            &[
                ([0.0; 3], 1.0),
                ([1.0, 0.5, 0.25], 1.0),
                ([1.5, 0.5, 0.0], 0.5),
                ([0.0, -1.25, 1.5], 0.5),
                ([2.25, 0.0, 0.0], 0.0),
            ],
        ),
        row(
            "the falloff of a distance without end",
            "falloff wyvill radius 2 { expression { length(x, y, z) - 1 } }",
            &[([0.0; 3], 1.0), ([0.0, 2.0, 0.0], 0.75f64.powi(3)), ([0.0, 0.0, -3.0], 0.0)],
        )
        .unbounded([-4.0; 3], [4.0; 3]),
        row(
            "a falloff that is called",
            "expression within (-2 -2 -2) to (2 2 2) { wyvill(length(x, y)) + soft(z) }",
            &[([0.0; 3], 2.0), ([0.5, 0.0, 1.0], 0.75f64.powi(3)), ([1.0, 0.0, 0.5], 0.5)],
        ),
    ]
}
