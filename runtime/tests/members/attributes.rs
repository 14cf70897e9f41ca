//! Ways to mix attributes, by groups of every width; what attribute nodes give: numbers, textures, uv,
//! formulas; and every texture.

use jbt::{CheckedTree, Mixing, Model};
use jbt_model::check::CheckedNode;
use jbt_model::kind::NodeKind;

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

/// Which of several values counts.
mod precedence {
    use jbt::{CheckedTree, Model};
    use jbt_model::attribute::Precedence;
    use jbt_model::check::CheckedNode;
    use jbt_model::kind::NodeKind;

    use crate::check::judge;
    use crate::row::{Family, Row, members, row};

    members! { Precedence {
        Nearest => vec![leaves("color (0 1 0)").attribute("color", [0.0; 3], &[0.25, 0.0, 0.75])],
        Override => vec![
            leaves("override color (0 1 0)").attribute("color", [0.0; 3], &[0.0, 1.0, 0.0]),
            leaves("color (1 1 0) { override color (0.5 0.5 0.5) {").attribute("color", [0.0; 3], &[0.5; 3]),
            leaves("override color expression { (x, 1, 0) } { color (1 1 0) {")
                .attribute("color", [0.0; 3], &[0.0, 1.0, 0.0])
                .attribute("color", [-1.0, 0.0, 0.0], &[-1.0, 1.0, 0.0]),
        ],
    } }

    /// Red and blue particles and a point, below a node or two.
    fn leaves(head: &str) -> Row {
        let (head, end) =
            if head.ends_with('{') { (head.to_owned(), "} }") } else { (format!("{head} {{"), "}") };
        let text = format!(
            "{head} sum {{
            particles {{ at ((-1 0 0) (1 0 0)) radius 2 strength (1 2) color ((1 0 0) (0 0 1)) }}
            color (0 0 1) {{ point {{ at (0 1 0) radius 2 }} }} }} {end}"
        );
        row("below one or two", &text, &[([0.0; 3], 2.0)])
    }

    fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
        let of = |node: &CheckedNode| {
            let NodeKind::Attribute { precedence, .. } = &node.kind else { return None };
            Some(name(precedence))
        };
        tree.nodes().iter().filter_map(of).collect()
    }

    #[test]
    fn every_precedence() {
        judge(Family { name: "precedence", members: members(), found });
    }
}

/// What attribute nodes give.
mod values {
    use jbt::{CheckedTree, Model};
    use jbt_model::attribute::AttributeValue;
    use jbt_model::check::CheckedNode;
    use jbt_model::kind::NodeKind;

    use crate::check::judge;
    use crate::row::{Family, Row, members, row};

    members! { AttributeValue {
        Numbers(_) => vec![row("one number", "attribute rough 1 rough 0.75 { point { radius 1 } }", &[([0.0; 3], 1.0)])
            .attribute("rough", [0.5, 0.0, 0.0], &[0.75])],
        Textured(_) => textured(),
        Uv(_) => uv(),
        Expressed(_) => expressed(),
    } }

    fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
        let of = |node: &CheckedNode| {
            let NodeKind::Attribute { value, .. } = &node.kind else { return None };
            Some(name(value))
        };
        tree.nodes().iter().filter_map(of).collect()
    }

    #[test]
    fn every_kind_of_value() {
        judge(Family { name: "attribute values", members: members(), found });
    }

    fn textured() -> Vec<Row> {
        // The ramp goes along z of the node, which is y of the model.
        let turned = "rotate axis x degrees -90 { color gradient { a (1 0 0) b (0 0 1) from (0 0 0) to (0 0 1) } {
            sum { point { radius 2 } color (0 1 0) { point { radius 2 } } translate (0 0 9) { point { radius 1 } } } } }";
        let following = "param p = 0.25 color gradient { a (p 0 0) b (0 2 * p 1) from (0 0 0) to (4 * p 0 0) } { point { radius 2 } }";
        vec![
            row("in its own space, under a nearer one", turned, &[([0.0; 3], 2.0)])
                .attribute("color", [0.0, 0.25, 0.0], &[0.375, 0.5, 0.125])
                .attribute("color", [0.0, -1.0, 0.0], &[0.5, 0.5, 0.0])
                .attribute("color", [0.0, 9.0, 0.0], &[0.0, 0.0, 1.0])
                // Nobody has a field.
                .attribute("color", [0.0, 5.0, 0.0], &[1.0; 3]),
            row("with parameters", following, &[([1.0, 0.0, 0.0], 0.5)]).attribute(
                "color",
                [0.5, 0.0, 0.0],
                &[0.125, 0.25, 0.5],
            ),
        ]
    }

    fn uv() -> Vec<Row> {
        // Longitude over a turn; latitude over half a turn, from the south pole.
        let ball = "attribute uv 2 uv { point { radius 2 } }";
        let mapped = "attribute uv 2 uv scale (4 2) rotate 90 shift (1 0) { segment { from (0 0 0) to (0 0 2) radius 1 } }";
        vec![
            row("of a ball", ball, &[([1.0, 0.0, 0.0], 0.5)])
                .attribute("uv", [1.0, 0.0, 0.0], &[0.0, 0.5])
                .attribute("uv", [0.0, 0.5, 0.0], &[0.25, 0.5])
                .attribute("uv", [-0.5, 0.0, 0.0], &[0.5, 0.5])
                .attribute("uv", [0.0, 0.5, 0.5], &[0.25, 0.75]),
            // About its axis 3/4 of a turn, 1/4 of the way along it: (3, 1/2), turned to (-1/2, 3).
            row("scaled, turned, shifted", mapped, &[([0.0, -0.5, 0.5], 0.5)]).attribute(
                "uv",
                [0.0, -0.5, 0.5],
                &[0.5, 3.0],
            ),
        ]
    }

    fn expressed() -> Vec<Row> {
        let waves = "color expression { r = sqrt(x^2 + y^2), (r, 1 - r / 2, sin(pi * z)) } {
            sum { point { radius 2 } color (0 0 0) { point { radius 2 } } } }";
        let moved = "param p = 2 attribute rough 1 scale p { translate (1 0 0) { rough expression { p * x } {
            twist rate pi / 2 { sum { point { radius 1 } box { half (0.5 0.5 0.5) radius 1 } } } } } }";
        let odd = "attribute odd 5 odd expression { (x / floor(y), ln(x), sqrt(x), exp(100 + x^2), mod(x, floor(y))) } { point { radius 2 } }";
        let dominant = "attribute kind 1 default 9 dominant union {
            kind expression { floor(x) } { point { at (-1 0 0) radius 1 } } kind expression { 7 } { point { at (1 0 0) radius 1 } } }";
        vec![
            row("of the coordinates", waves, &[([0.0; 3], 2.0), ([1.0, 0.0, 0.0], 1.0)])
                .attribute("color", [0.6, 0.8, 0.0], &[0.5, 0.25, 0.0])
                .attribute("color", [0.0, 0.0, 0.5], &[0.0, 0.5, 0.5])
                .attribute("color", [0.0, 0.0, 5.0], &[1.0; 3]),
            // x = 3 is 2 (0.5 + 1) of the node's.
            row("in its own space, with a parameter", moved, &[([2.0, 0.0, 0.0], 2.0)])
                .attribute("rough", [3.0, 0.0, 0.0], &[1.0])
                .attribute("rough", [1.0, 1.0, 0.5], &[-1.0]),
            // -ln 2^126, and the largest number that there is.
            row("where it has no value", odd, &[([1.0, 0.0, 0.0], 0.5)])
                .attribute("odd", [1.0, 0.0, 0.0], &[0.0, 0.0, 1.0, 2f64.powi(100), 0.0])
                .attribute("odd", [-1.25, -0.5, 0.0], &[1.25, -126.0 * 2f64.ln(), 0.0, 2f64.powi(100), 0.75]),
            row("of the one that decides", dominant, &[([-1.0, 0.0, 0.0], 1.0)])
                .attribute("kind", [-0.75, 0.0, 0.0], &[-1.0])
                .attribute("kind", [-1.25, 0.0, 0.0], &[-2.0])
                .attribute("kind", [1.0, 0.0, 0.0], &[7.0])
                .attribute("kind", [0.0, 5.0, 0.0], &[9.0]),
        ]
    }
}

/// Patterns, from a = 0 to b = 1 of a group of one real.
mod textures {
    use jbt::{CheckedTree, Model};
    use jbt_model::attribute::AttributeValue;
    use jbt_model::check::CheckedNode;
    use jbt_model::kind::NodeKind;
    use jbt_model::texture::TextureKind;

    use crate::check::judge;
    use crate::row::{Family, Row, members, row};

    members! { TextureKind {
        Checker(_) => vec![
            pattern("by its size", "checker", "size 0.5", &[
                ([0.25, 0.25, 0.25], 0.0), ([-0.25, 0.25, 0.25], 1.0), ([-0.25, -0.25, 0.25], 0.0), ([0.75, 0.25, -1.25], 0.0),
                ([0.25, 1.25, 0.25], 0.0), ([0.25, 0.75, 0.25], 1.0),
            ]),
        ],
        Stripes(_) => vec![
            // 1 wide along the diagonal, so sqrt 2 in x + y.
            pattern("along a diagonal", "stripes", "along (1 1 0) width 1", &[
                ([0.5, 0.5, 0.0], 0.0), ([1.0, 1.0, 0.0], 1.0), ([-0.5, -0.5, 0.3], 1.0), ([0.75, -0.5, 1.0], 0.0),
            ]),
            pattern("along an axis", "stripes", "along z width 0.25", &[([0.0, 0.0, 0.1], 0.0), ([0.0, 0.0, 0.3], 1.0), ([0.0, 0.0, -0.1], 1.0)]),
        ],
        Gradient(_) => vec![
            pattern("between two places", "gradient", "from (1 0 0) to (-1 0 0)", &[
                ([1.0, 0.5, 0.0], 0.0), ([0.5, 0.0, 1.0], 0.25), ([0.0, 1.0, 0.0], 0.5), ([-1.5, 0.0, 0.0], 1.0), ([1.5, 0.0, 0.0], 0.0),
            ]),
            pattern("between equal places", "gradient", "from (1 0 0) to (1 0 0)", &[([1.0, 0.0, 0.0], 0.0), ([0.0; 3], 0.0)]),
        ],
        Noise(_) => vec![
            // The hash of zeros is 0; half-way to another corner, there is half of what is there.
            pattern("at corners and between them", "noise", "size 2", &[
                ([0.0; 3], 0.0), ([2.0, 0.0, 0.0], ONE_X), ([1.0, 0.0, 0.0], 0.5 * ONE_X), ([0.0, 0.0, 2.0], ONE_Z), ([0.0, 0.0, 1.0], 0.5 * ONE_Z),
                // 3 t^2 - 2 t^3 at 1/4 is 5/32.
                ([0.5, 0.0, 0.0], 5.0 / 32.0 * ONE_X),
            ]),
        ],
        Rings(_) => vec![
            // From 0 at whole widths to 1 half-way: 3 t^2 - 2 t^3 of 2/5 is 0.352.
            pattern("at rest", "rings", "along z width 1 turbulence 0", &[
                ([0.0, 0.0, 0.7], 0.0), ([0.5, 0.0, 0.0], 1.0), ([0.0, -1.0, 0.4], 0.0), ([0.9, 1.2, 0.0], 1.0), ([0.0, 0.2, 0.0], 0.352), ([0.0, 0.25, 1.0], 0.5),
            ]),
        ],
        Marble(_) => vec![
            pattern("at rest", "marble", "along y width 2 turbulence 0", &[
                ([0.7, 0.0, 0.0], 0.0), ([0.0, 1.0, 0.3], 1.0), ([0.0, 0.5, 0.0], 0.5), ([0.0, -0.5, 0.0], 0.5), ([0.0, 0.4, 1.0], 0.352),
            ]),
            pattern("along a slanted direction", "marble", "along (3 4 0) width 1 turbulence 0", &[([0.3, 0.4, 0.0], 1.0), ([0.8, -0.6, 0.0], 0.0)]),
        ],
    } }

    /// Jenkins' hashes of (1, 0, 0) and (0, 0, 1), their upper 23 bits as a part of 1.
    const ONE_X: f64 = 3_838_250.0 / 8_388_608.0;
    const ONE_Z: f64 = 599_890.0 / 8_388_608.0;

    fn pattern(what: &'static str, word: &str, parameters: &str, values: &[([f64; 3], f64)]) -> Row {
        let text = format!("attribute t 1 t {word} {{ a 0 b 1 {parameters} }} {{ point {{ radius 4 }} }}");
        values
            .iter()
            .fold(row(what, text, &[([0.0; 3], 1.0)]), |row, &(at, value)| row.attribute("t", at, &[value]))
    }

    fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
        let of = |node: &CheckedNode| {
            let NodeKind::Attribute { value: AttributeValue::Textured(textured), .. } = &node.kind else {
                return None;
            };
            Some(name(&textured.texture.kind()))
        };
        tree.nodes().iter().filter_map(of).collect()
    }

    #[test]
    fn every_texture() {
        let members = members();
        assert_eq!(members.len(), TextureKind::ALL.len());
        judge(Family { name: "textures", members, found });
    }
}
