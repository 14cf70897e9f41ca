//! Warps, of balls and rods with the soft object's falloff: 1 on the skeleton, 1/2 at half the radius. A row
//! names the child's point where that is not plain.

mod cells;
mod local;

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_4};

use jbt::{CheckedTree, Model};
use jbt_model::check::CheckedNode;
use jbt_model::kind::NodeKind;
use jbt_model::warp::Warp;

use crate::check::judge;
use crate::falloffs::soft;
use crate::row::{Family, Row, members, row};

members! { Warp {
    Twist(_) => twists(),
    Taper(_) => tapers(),
    Bend(_) => bends(),
    Mirror(_) => cells::mirrors(),
    Repeat(_) => cells::repetitions(),
    RepeatAround(_) => cells::repetitions_around(),
    SpaceMap(_) => local::space_maps(),
    Deform(_) => local::deformations(),
    // A shear: what is at height y is asked y farther back.
    Formula(_) => vec![row("a shear", "warp (x - y, y, z) { point { radius 1 } }", &[
        ([0.0; 3], 1.0),
        ([0.5, 0.5, 0.0], 0.5),
        ([1.5, 1.0, 0.0], 0.0),
    ]).unbounded([-1.5, -1.0, -1.0], [1.5, 1.0, 1.0])],
} }

fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
    let of = |node: &CheckedNode| {
        let NodeKind::Warp(warp) = &node.kind else { return None };
        Some(name(warp))
    };
    tree.nodes().iter().filter_map(of).collect()
}

#[test]
fn every_warp() {
    judge(Family { name: "warps", members: members(), found });
}

fn twists() -> Vec<Row> {
    // A quarter turn for each unit of height takes a rod that stands beside the axis to a spiral.
    let spiral = |axis: char, from: &str, to: &str| {
        format!("twist axis {axis} rate pi / 2 {{ segment {{ from {from} to {to} radius 1 }} }}")
    };
    let double = "twist axis z rate pi / 2 { twist axis z rate pi / 2 { segment { from (1 0 -2) to (1 0 2) radius 1 } } }";
    let mixed = "union { point { at (0 0 4) radius 1 }
        twist axis z rate 1 { sum { color (1 0 0) { point { at (0.5 0 0) radius 1 } } color (0 0 1) { point { at (-0.5 0 0) radius 1 } } } } }";
    let mut rows = vec![
        row(
            "about z",
            spiral('z', "(1 0 -2)", "(1 0 2)"),
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([0.0, 1.0, 1.0], 1.0),
                ([0.0, 1.5, 1.0], 0.5),
                ([0.0, 0.0, 0.3], 0.0),
                ([FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.5], 1.0),
                ([0.5 * FRAC_1_SQRT_2, 0.5 * FRAC_1_SQRT_2, 0.5], 0.5),
                ([0.0, -1.0, -1.0], 1.0),
                ([-1.0, 0.0, 2.0], 1.0),
                ([1.0, 0.0, 2.0], 0.0),
            ],
        ),
        row(
            "about x",
            spiral('x', "(-2 1 0)", "(2 1 0)"),
            &[([0.0, 1.0, 0.0], 1.0), ([1.0, 0.0, 1.0], 1.0), ([1.0, 0.0, 0.5], 0.5), ([1.0, 1.0, 0.0], 0.0)],
        ),
        row(
            "about y",
            spiral('y', "(0 -2 1)", "(0 2 1)"),
            &[([0.0, 0.0, 1.0], 1.0), ([1.0, 1.0, 0.0], 1.0), ([0.5, 1.0, 0.0], 0.5), ([0.0, 1.0, 1.0], 0.0)],
        ),
        row(
            "of no rate",
            "twist rate 0 { point { at (1 0 0) radius 2 } }",
            &[([1.0, 0.0, 0.0], 1.0), ([2.0, 0.0, 0.0], 0.5), ([1.0, 1.0, 1.0], soft(2.0 / 4.0))],
        ),
        row(
            "of a twist",
            double,
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([-1.0, 0.0, 1.0], 1.0),
                ([-1.0, 0.0, -1.0], 1.0),
                ([-0.5, 0.0, 1.0], 0.5),
            ],
        ),
        row(
            "of a blend in a union",
            mixed,
            &[([0.0; 3], 1.0), ([0.0, 0.0, 0.5], 2.0 * soft(0.5)), ([0.0, 0.0, 4.0], 1.0)],
        )
        .attribute("color", [0.0, 0.0, 0.25], &[0.5, 0.0, 0.5])
        .attribute("color", [1.0, 0.0, 0.0], &[1.0, 0.0, 0.0]),
    ];
    rows.extend(local::weighted_twists());
    rows
}

fn tapers() -> Vec<Row> {
    let rods = "segment { from (1 0 -2) to (1 0 4) radius 1 }";
    let cone = "taper from 0 to 2 end 0 { cylinder { from (0 0 0) to (0 0 4) cylinder_radius 1 radius 1 } }";
    vec![
        // 3/4 as wide at height 1, half as wide from 2 on.
        row(
            "to half the width",
            format!("taper axis z from 0 to 2 end 0.5 {{ {rods} }}"),
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([1.0, 0.0, -1.0], 1.0),
                ([0.75, 0.0, 1.0], 1.0),
                ([0.375, 0.0, 1.0], 0.5),
                ([0.75, 0.375, 1.0], 0.5),
                ([0.5, 0.0, 2.0], 1.0),
                ([0.75, 0.0, 3.0], 0.5),
                ([1.0, 0.0, 3.0], 0.0),
            ],
        ),
        row(
            "the other way round",
            format!("taper from 2 to 0 start 0.5 end 1 {{ color (1 0 0) {{ {rods} }} }}"),
            &[([1.0, 0.0, -1.0], 1.0), ([0.75, 0.0, 1.0], 1.0), ([0.75, 0.0, 3.0], 0.5)],
        )
        .attribute("color", [0.75, 0.0, 1.0], &[1.0, 0.0, 0.0]),
        // Twice as wide at -1, as it is from 1 on; along x, across it y and z.
        row(
            "about x",
            "taper axis x from -1 to 1 start 2 end 1 { segment { from (-3 0 1) to (3 0 1) radius 1 } }",
            &[
                ([-2.0, 0.0, 2.0], 1.0),
                ([-2.0, 1.0, 2.0], 0.5),
                ([0.0, 0.0, 1.5], 1.0),
                ([0.0, 0.75, 1.5], 0.5),
                ([2.0, 0.5, 1.0], 0.5),
            ],
        ),
        // A cone whose tip is at 2. On the axis everything is as it was; at the tip, and beyond, nothing is
        // beside it.
        row(
            "to a tip",
            cone,
            &[
                ([1.0, 0.0, 0.0], 1.0),
                ([0.5, 0.0, 1.0], 1.0),
                ([0.0, 0.75, 1.0], 0.5),
                ([0.0, 0.0, 2.0], 1.0),
                ([0.0, 0.0, 3.0], 1.0),
                ([0.25, 0.0, 2.0], 0.0),
                ([0.0, 0.25, 2.5], 0.0),
            ],
        ),
        row(
            "by a parameter",
            format!("param t = 1 taper from t - 1 to 2 * t end t / 2 {{ {rods} }}"),
            &[([0.75, 0.0, 1.0], 1.0), ([0.375, 0.0, 1.0], 0.5)],
        ),
    ]
}

fn bends() -> Vec<Row> {
    // A quarter turn for each unit of the spine: a radius of 2 / pi. A place s of the spine at height z comes
    // to r sin(t) - z sin(t), r - (r - z) cos(t) with t = pi / 2 * s.
    let r = 2.0 * FRAC_1_PI;
    let (sin, cos) = FRAC_PI_4.sin_cos();
    let inner = r - 0.125;
    let quarter = |rate: &str| {
        format!(
            "bend axis x rate {rate} from -1 to 1 {{ segment {{ from (0 -2 0) to (0 2 0) radius 0.5 }} }}"
        )
    };
    let places = [
        ([0.0; 3], 1.0),
        ([0.0, r, r], 1.0),
        ([0.0, -r, r], 1.0),
        ([0.0, r * sin, r - r * cos], 1.0),
        ([0.0, inner * sin, r - inner * cos], soft(1.0 / 16.0)),
        ([0.25, r, r], 0.5),
        // Straight again, along z.
        ([0.0, r, r + 1.0], 1.0),
        ([0.0, r + 0.25, r + 0.5], 0.5),
        ([0.0, r, r + 1.25], 0.5),
        ([0.0, 2.0, 0.0], 0.0),
        // The centre of curvature.
        ([0.0, 0.0, r], 0.0),
    ];
    let turned_over = places.map(|([x, y, z], field)| ([x, y, -z], field));
    let one_sided =
        "bend axis z rate pi / 2 from 1 to 2 center 1 { segment { from (-1 0 0) to (4 0 0) radius 0.5 } }";
    let past_half = "bend axis y rate 2 from -3 to 3 { segment { from (0 0 -3) to (0 0 3) radius 1 } }";
    vec![
        row("by half a turn", quarter("pi / 2"), &places),
        row("the other way", quarter("-pi / 2"), &turned_over),
        row(
            "of no rate",
            quarter("0"),
            &[
                ([0.0; 3], 1.0),
                ([0.0, 2.0, 0.0], 1.0),
                ([0.0, 1.5, 0.25], 0.5),
                ([0.0, -2.25, 0.0], 0.5),
                ([0.0, r, r], 0.0),
            ],
        ),
        // About z the spine is x and turns to y; it stays what it is up to 1.
        row(
            "from the place that stays",
            one_sided,
            &[
                ([0.0; 3], 1.0),
                ([-1.25, 0.0, 0.0], 0.5),
                ([1.0, 0.0, 0.25], 0.5),
                ([1.0 + r, r, 0.0], 1.0),
                ([1.0 + r, r + 1.0, 0.0], 1.0),
                ([1.25 + r, r + 1.0, 0.0], 0.5),
                ([3.0, 0.0, 0.0], 0.0),
            ],
        ),
        // About y the spine is z and turns to x. A circle of radius 1/2 is closed by less than 3 to both
        // sides: what is more is not seen; at its centre the rod is 1/2 away.
        row(
            "past half a turn",
            past_half,
            &[
                ([0.0; 3], 1.0),
                ([0.5, 0.0, 0.5], 1.0),
                ([0.5, 0.0, -0.5], 1.0),
                ([0.5, 0.5, 0.5], 0.5),
                ([-0.5, 0.0, 0.0], 0.5),
            ],
        ),
        row(
            "by a parameter",
            format!("param k = pi {}", quarter("k / 2").replace("from -1", "from -k / pi")),
            &places,
        ),
    ]
}
