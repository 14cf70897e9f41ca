//! Kinds of nodes. Those that hold an open set of their own have a row here for what has nothing to do with
//! its members.

mod expressions;

use jbt::{CheckedTree, Model};
use jbt_model::kind::NodeKind;

use crate::check::judge;
use crate::falloffs::soft;
use crate::row::{Family, Row, members, row};

members! { NodeKind {
    Primitive(_) => vec![row("alone", "color (1 0 0) { point { radius 1 strength 2 } }", &[
        ([0.0; 3], 2.0),
        ([0.5, 0.0, 0.0], 1.0),
    ])
    // A lone leaf keeps its colour where it has no field.
    .attribute("color", [5.0, 0.0, 0.0], &[1.0, 0.0, 0.0])],
    Particles(_) => vec![row("two and a point", "sum {
        particles { at ((-1 0 0) (1 0 0)) radius 2 strength (1 3) color ((1 0 0) (0 0 1)) }
        translate (0 4 0) { particles { at ((0 0 0)) radius 1 } }
    }", &[
        ([0.0; 3], 2.0),
        ([-1.0, 0.0, 0.0], 1.0),
        ([2.0, 0.0, 0.0], 1.5),
        ([0.0, 4.5, 0.0], 0.5),
    ])
    .attribute("color", [0.0; 3], &[0.25, 0.0, 0.75])
    .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0])
    // Without values of its own, a particle has what is bound above it: here the default.
    .attribute("color", [0.0, 4.0, 0.0], &[1.0, 1.0, 1.0])],
    Combine(_) => vec![nested(), shared()],
    Expression(_) => expressions::rows(),
    Select(_) => selectors(),
    Affine(_) => maps(),
    Warp(_) => vec![row("between maps", "translate (2 0 0) { twist rate pi / 2 { scale (1 0.5 1) { translate (1 0 1) { point { radius 1 } } } } }", &[
        ([2.0, 1.0, 1.0], 1.0),
        ([1.75, 1.0, 1.0], 0.5),
        ([2.0, 1.5, 1.0], 0.5),
    ])],
    Attribute { .. } => vec![row("above others", "color (0 1 0) { sum { color (1 0 0) { point { at (-1 0 0) radius 2 } } point { at (1 0 0) radius 2 } } }", &[
        ([0.0; 3], 1.0),
    ])
    // The nearer one counts.
    .attribute("color", [0.0; 3], &[0.5, 0.5, 0.0])
    .attribute("color", [-2.0, 0.0, 0.0], &[1.0, 0.0, 0.0])
    .attribute("color", [2.0, 0.0, 0.0], &[0.0, 1.0, 0.0])],
    Constant { .. } => vec![row("which no program knows", "constant color \"red\" { color (0 1 0) { constant part 17 { point { radius 1 } } } }", &[([0.0; 3], 1.0)])
        .attribute("color", [0.5, 0.0, 0.0], &[0.0, 1.0, 0.0])],
} }

fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
    tree.nodes().iter().map(|node| name(&node.kind)).collect()
}

#[test]
fn every_kind_of_node() {
    judge(Family { name: "nodes", members: members(), found });
}

fn nested() -> Row {
    let text = "difference {
        intersection { sum { point { radius 2 } point { at (1 0 0) radius 2 } } box { half (2 0.5 0.5) radius 0.5 } }
        blend ricci 2 { point { at (3 0 0) radius 2 } segment { from (0 1 0) to (1 1 0) radius 1 } }
        union { ring { ring_radius 2 radius 0.5 } point { at (-2 0 0) radius 1 } }
    }";
    row(
        "in each other",
        text,
        &[
            ([0.0; 3], 1.0),
            ([0.5, 0.0, 0.0], 1.0),
            ([0.0, 0.5, 0.0], 0.5),
            ([-2.0, 0.0, 0.0], 0.0),
            ([0.0, 0.0, 0.75], 0.5),
            ([2.0, 0.0, 0.0], 0.0),
        ],
    )
}

fn shared() -> Row {
    let text = "let ball = point { radius 1 } let pair = sum { use ball translate (1 0 0) { use ball } }
        union { use pair color (1 0 0) { use ball } translate (0 0 3) { use pair } }";
    row(
        "of shared subtrees",
        text,
        &[([0.0; 3], 1.0), ([0.5, 0.0, 0.0], 1.0), ([0.5, 0.0, 3.0], 1.0), ([1.5, 0.0, 3.0], 0.5)],
    )
}

fn selectors() -> Vec<Row> {
    let of = |which: &str| {
        format!(
            "param which = 1 select {which} {{
                point {{ radius 1 }}
                color (1 0 0) {{ point {{ at (2 0 0) radius 2 }} }}
                box {{ half (1 1 1) radius 1 }}
            }}"
        )
    };
    vec![
        row("the second", of("1"), &[([2.0, 0.0, 0.0], 1.0), ([3.0, 0.0, 0.0], 0.5), ([0.0; 3], 0.0)])
            .attribute("color", [2.0, 0.0, 0.0], &[1.0, 0.0, 0.0]),
        row("by a parameter", of("2 * which + 0.25"), &[([1.0, 1.0, 1.5], 0.5), ([3.0, 0.0, 0.0], 0.0)]),
        row(
            "in a sum",
            format!("sum {{ {} point {{ at (2 1 0) radius 2 }} }}", of("1.4").replace("param which = 1", "")),
            &[([2.0, 0.0, 0.0], 1.5), ([0.0; 3], 0.0)],
        ),
    ]
}

fn maps() -> Vec<Row> {
    vec![
        row(
            "a shift",
            "translate (1 2 3) { segment { from (0 0 0) to (1 0 0) radius 1 } }",
            &[([1.5, 2.0, 3.0], 1.0), ([2.5, 2.0, 3.0], 0.5)],
        ),
        row(
            "an ellipsoid",
            "scale (2 1 0.5) { point { radius 1 } }",
            &[
                ([1.0, 0.0, 0.0], 0.5),
                ([0.0, 0.5, 0.0], 0.5),
                ([0.0, 0.0, 0.25], 0.5),
                ([1.0, 0.5, 0.0], soft(0.5)),
            ],
        ),
        row(
            "a mirror",
            "scale (-1 1 1) { segment { from (1 0 0) to (2 0 0) radius 1 } }",
            &[([-1.5, 0.5, 0.0], 0.5), ([-2.0, 0.0, 0.0], 1.0), ([1.5, 0.0, 0.0], 0.0)],
        ),
        row(
            "a shear",
            "affine (1 1 0 0  0 1 0 0  0 0 1 0) { point { radius 1 } }",
            &[([0.5, 0.5, 0.0], 0.5), ([1.0, 0.5, 0.0], soft(0.5))],
        ),
        row(
            "a shear across an axis",
            "shear axis y by (0 0 1) { segment { from (0 -1 0) to (0 1 0) radius 1 } }",
            &[([0.0, 1.0, 1.0], 1.0), ([0.0, -1.0, -1.5], 0.5), ([0.0, 1.0, -0.5], 0.0)],
        ),
        row(
            "a reflection",
            "reflect axis (1 1 0) { point { at (1 0 0) radius 1 } }",
            &[([0.0, -1.0, 0.0], 1.0), ([0.5, -1.0, 0.0], 0.5), ([1.0, 0.0, 0.0], 0.0)],
        ),
        row(
            "a stretch",
            "stretch axis (0 0 2) by 3 { point { radius 1 } }",
            &[([0.0, 0.0, 1.5], 0.5), ([0.5, 0.0, 0.0], 0.5), ([0.5, 0.0, 1.5], soft(0.5))],
        ),
        row(
            "a quarter turn",
            "rotate axis x degrees 90 { translate (0 0 1) { ring { ring_radius 1 radius 1 } } }",
            &[([1.0, -1.0, 0.0], 1.0), ([1.5, -1.0, 0.0], 0.5), ([0.0, -1.0, -1.5], 0.5)],
        ),
        // The axes go round: x becomes y, y becomes z, z becomes x.
        row(
            "a similarity",
            "translate (1 2 3) { scale 2 { rotate axis (1 1 1) degrees 120 { box { half (0.5 0.25 0.125) radius 1 } } } }",
            &[
                ([1.0, 2.0, 3.0], 1.0),
                ([1.0, 4.0, 3.0], 0.5),
                ([1.0, 2.0, 4.5], 0.5),
                ([2.25, 2.0, 3.0], 0.5),
            ],
        ),
        row(
            "a turned plate under uneven scale",
            "scale (1 2 1) { rotate axis z degrees 90 { triangle { a (0 0 0) b (1 0 0) c (0 1 0) radius 1 } } }",
            &[([0.0, 2.0, 0.0], 1.0), ([-1.0, 0.0, 0.5], 0.5), ([0.0, 3.0, 0.0], 0.5)],
        ),
    ]
}
