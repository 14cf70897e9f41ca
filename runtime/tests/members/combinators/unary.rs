//! Operators of one field: complement, clamp, shell, offset.

use super::{BAR, BLUE, RED, there};
use crate::falloffs::soft;
use crate::row::{Row, row};

/// Where fields of the balls are, and a little more.
const AROUND: [[f64; 3]; 2] = [[-3.5, -2.5, -2.5], [3.5, 2.5, 2.5]];

/// Looks there, because the field has no end.
fn endless(row: Row) -> Row {
    row.unbounded(AROUND[0], AROUND[1])
}

pub(super) fn complements() -> Vec<Row> {
    vec![
        // The child's colour is seen where both fields are positive.
        endless(row("of a ball", format!("complement {{ {RED} }}"), &there(|a, _| 1.0 - a)))
            .attribute("color", [-1.0, 1.0, 0.0], &[1.0, 0.0, 0.0])
            .attribute("color", [-1.0, 0.0, 0.0], &[1.0; 3])
            .attribute("color", [3.0, 0.0, 0.0], &[1.0; 3]),
        endless(row(
            "by another iso-value",
            format!("iso 0.25 complement {{ {RED} }}"),
            &there(|a, _| 0.5 - a),
        )),
        row(
            "of a complement",
            format!("complement {{ complement {{ {RED} }} }}"),
            &there(|a, _| 1.0 - (1.0 - a)),
        )
        .unbounded([-2.0, -1.0, -1.0], [0.5, 1.0, 1.0]),
        endless(row(
            "of a sum, in a union",
            format!("union {{ {BAR} complement {{ sum {{ {RED} {BLUE} }} }} }}"),
            &[([0.0; 3], 1.0), ([1.0, 0.0, 0.0], 0.0), ([1.0, 1.0, 0.0], 0.5), ([3.0, 0.0, 0.0], 1.0)],
        )),
        // What is bounded bounds it again: a difference without its clamp.
        row(
            "in an intersection",
            format!("intersection {{ sum {{ {RED} {RED} }} complement {{ {BLUE} }} }}"),
            &there(|a, b| (2.0 * a).min(1.0 - b)),
        )
        // 0.61 and 0.31: the blue one's complement decides; where it is not there, it has no colour.
        .attribute("color", [0.25, 0.0, 0.0], &[0.0, 0.0, 1.0])
        .attribute("color", [-1.0, 0.0, 0.0], &[1.0; 3])
        .attribute("color", [0.5, 1.0, 0.25], &[1.0, 0.0, 0.0]),
        row(
            "in a product",
            format!("product {{ {RED} complement {{ {BLUE} }} }}"),
            &there(|a, b| 2.0 * a * (1.0 - b)),
        ),
    ]
}

pub(super) fn clamps() -> Vec<Row> {
    let of = |low: f64, high: f64, child: &str| format!("clamp low {low} high {high} {{ {child} }}");
    let push = format!("sum {{ {RED} point {{ at (1 0 0) radius 2 strength -0.5 }} }}");
    vec![
        row("from above", of(0.0, 0.75, RED), &there(|a, _| a.min(0.75)))
            .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0])
            .attribute("color", [-1.0, 1.0, 0.0], &[1.0, 0.0, 0.0])
            .attribute("color", [2.0, 0.0, 0.0], &[1.0; 3]),
        row("of what may be negative", of(-0.25, 0.5, &push), &there(|a, b| (a - 0.5 * b).clamp(-0.25, 0.5))),
        row("to what is not negative", of(0.0, 8.0, &push), &there(|a, b| (a - 0.5 * b).max(0.0))),
        // Where there is nothing the field is the nearer end.
        endless(row("without zero", of(0.25, 0.75, RED), &there(|a, _| a.clamp(0.25, 0.75)))),
        endless(row("below zero", of(-0.5, -0.125, &push), &there(|a, b| (a - 0.5 * b).clamp(-0.5, -0.125)))),
        row(
            "by parameters",
            format!("param t = 0.25 sum {{ clamp high 2 * t low -t {{ {push} }} {RED} }}"),
            &there(|a, b| (a - 0.5 * b).clamp(-0.25, 0.5) + a),
        ),
    ]
}

pub(super) fn shells() -> Vec<Row> {
    // 1/2 - |f - 1/2|, at least 0, over 1/2 - t / 2, times 1/2.
    let field = |t: f64, f: f64| (0.5 - (f - 0.5).abs()).max(0.0) * 0.5 / (0.5 - 0.5 * t);
    vec![
        row("of a ball", format!("shell 0.25 {{ {RED} }}"), &there(move |a, _| field(0.25, a)))
            .attribute("color", [-1.0, 1.0, 0.0], &[1.0, 0.0, 0.0])
            .attribute("color", [-1.0, 0.0, 0.0], &[1.0; 3]),
        // On the child's surface 1/2 * 4/3, and at the middle of the ball nothing.
        row(
            "by its label",
            format!("shell thickness 0.25 {{ {RED} }}"),
            &[([-1.0, 1.0, 0.0], 2.0 / 3.0), ([-1.0, 0.0, 0.0], 0.0), ([1.0, 0.0, 0.0], 0.0)],
        ),
        // Where the child's field is 1/2 + t/2 or 1/2 - t/2 the shell's is the iso-value.
        row(
            "around where it is the iso-value",
            "shell 0.25 { point { strength 1.25 radius 2 } }",
            &[([0.0, 1.0, 0.0], 0.5), ([0.0; 3], 0.0), ([0.0, 2.0, 0.0], 0.0)],
        ),
        row(
            "of what is deep",
            format!("shell 0.5 {{ sum {{ {RED} {RED} {BLUE} }} }}"),
            &there(move |a, b| field(0.5, 2.0 * a + b)),
        ),
        // The same with 1/4: 1/4 - |f - 1/4|, times 1/4 over 1/4 - 1/16.
        row(
            "by another iso-value",
            format!("iso 0.25 shell 0.125 {{ {RED} }}"),
            &there(|a, _| (0.25 - (a - 0.25).abs()).max(0.0) * 4.0 / 3.0),
        ),
        row(
            "by a parameter",
            format!("param t = 0.25 union {{ shell 2 * t {{ {RED} }} shell t {{ {BLUE} }} }}"),
            &there(move |a, b| field(0.5, a).max(field(0.25, b))),
        ),
    ]
}

pub(super) fn offsets() -> Vec<Row> {
    vec![
        // The level 1/4 becomes 1/2, or the level 1 does.
        row("outwards", format!("offset 0.25 {{ {RED} }}"), &there(|a, _| 2.0 * a)).attribute(
            "color",
            [-1.0, 1.0, 0.0],
            &[1.0, 0.0, 0.0],
        ),
        row("inwards", format!("offset by -0.5 {{ {RED} }}"), &there(|a, _| 0.5 * a)),
        row("by another iso-value", format!("iso 0.25 offset 0.125 {{ {RED} }}"), &there(|a, _| 2.0 * a)),
        row(
            "of one that pushes",
            "offset 0.25 { point { radius 2 strength -0.25 } }",
            &[([0.0; 3], -0.5), ([1.0, 0.0, 0.0], -0.25), ([1.0, 1.0, 1.0], -0.5 * soft(3.0 / 4.0))],
        ),
        row(
            "by a parameter",
            format!("param t = 0.125 union {{ offset 2 * t {{ {RED} }} offset 3 * t {{ {BLUE} }} }}"),
            &there(|a, b| (2.0 * a).max(4.0 * b)),
        ),
    ]
}
