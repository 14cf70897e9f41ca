//! Ways to mix attributes, by groups of every width.

use jbt::{CheckedTree, Mixing, Model};
use jbt_frontend::check::CheckedNode;
use jbt_frontend::tree::NodeKind;

use crate::check::judge;
use crate::falloffs::soft;
use crate::row::{Family, Row, members, row};

members! { Mixing {
    Blend => blended(),
    Dominant => dominant(),
} }

/// The mixing of every group that a node gives.
fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
    let gives = |node: &CheckedNode, group: &str| matches!(&node.kind, NodeKind::Attribute { name, .. } if &**name == group);
    let given = |group: &str| tree.nodes().iter().any(|node| gives(node, group));
    tree.attributes().iter().filter(|group| given(&group.name)).map(|group| name(&group.mixing)).collect()
}

#[test]
fn every_mixing() {
    let members = members();
    assert_eq!(members.len(), Mixing::ALL.len());
    judge(Family { name: "attributes", members, found });
}

/// The fields of points at (-1, 0, 0) and (1, 0, 0) that reach 2 far, half way from the middle to the second.
fn fields() -> [f64; 2] {
    [1.5, 0.5].map(|d: f64| soft(d * d / 4.0))
}

fn blended() -> Vec<Row> {
    let text = "attribute rough 1 default 0.5 blend attribute uv 2 default (0 1) blend attribute axis 4 default (1 2 3 4)
        sum {
            rough 1 { uv (0.5 0.25) { axis (0 0 0 8) { point { at (-1 0 0) radius 2 } } } }
            rough -1 { color (0 0 0) { point { at (1 0 0) radius 2 } } }
        }";
    let [left, right] = fields();
    let part = left / (left + right);
    let push = "attribute rough 1 default 0.5
        sum { rough 1 { point { at (-1 0 0) radius 2 } } rough 0 { point { at (1 0 0) radius 2 strength -0.25 } } }";
    vec![
        row("of a sum", text, &[([0.0; 3], 1.0)])
            .attribute("rough", [0.0; 3], &[0.0])
            .attribute("rough", [0.5, 0.0, 0.0], &[part - (1.0 - part)])
            .attribute("rough", [0.0, 0.0, 5.0], &[0.5])
            // The second leaf counts with the defaults.
            .attribute("uv", [0.0; 3], &[0.25, 0.625])
            .attribute("uv", [2.0, 0.0, 0.0], &[0.0, 1.0])
            .attribute("axis", [0.0; 3], &[0.5, 1.0, 1.5, 6.0])
            .attribute("color", [0.0; 3], &[0.5; 3]),
        // What pushes has no say.
        row("with one that pushes", push, &[([0.5, 0.0, 0.0], left - 0.25 * right)])
            .attribute("rough", [0.0; 3], &[1.0])
            .attribute("rough", [-1.0, 1.0, 0.0], &[1.0]),
    ]
}

fn dominant() -> Vec<Row> {
    let text = "attribute material 1 default 7 dominant attribute uv 2 default (0 1) dominant
        sum {
            material 1 { uv (1 0) { point { at (-1 0 0) radius 2 } } }
            material 2 { point { at (1 0 0) radius 2 } }
            union { point { at (0 3 0) radius 2 } }
        }";
    let many = "attribute material 1 default 0 dominant
        blend ricci 2 {
            sum { material 1 { point { at (1 0 0) radius 2 } } material 2 { point { at (1 0.5 0) radius 2 } } }
            material 3 { point { at (-1 0 0) radius 2 } }
        }";
    vec![
        row("of a sum", text, &[([0.0; 3], 1.0)])
            // Of equals the first.
            .attribute("material", [0.0; 3], &[1.0])
            .attribute("material", [-0.5, 0.0, 0.0], &[1.0])
            .attribute("material", [0.5, 0.0, 0.0], &[2.0])
            .attribute("material", [0.0, 3.0, 0.0], &[7.0])
            .attribute("material", [0.0, 0.0, 5.0], &[7.0])
            .attribute("uv", [-0.5, 0.0, 0.0], &[1.0, 0.0])
            .attribute("uv", [0.5, 0.0, 0.0], &[0.0, 1.0]),
        row("of leaves, not of operands", many, &[([1.0, 0.0, 0.0], 1.0 + soft(1.0 / 16.0))])
            .attribute("material", [1.0, 0.0, 0.0], &[1.0])
            .attribute("material", [1.0, 1.0, 0.0], &[2.0])
            .attribute("material", [-1.0, 0.0, 0.0], &[3.0]),
    ]
}
