//! Combinators, of a red ball at (-1, 0, 0) and a blue one at (1, 0, 0) as a rule. Both reach 2 far.
//!
//! Rows of folds and of the difference stand here, those of operators of two fields in `steps`, those of one
//! field in `unary`.

mod steps;
mod unary;

use jbt::{CheckedTree, Combinator, Model};
use jbt_model::check::CheckedNode;
use jbt_model::kind::NodeKind;

use crate::check::judge;
use crate::falloffs::soft;
use crate::row::{Family, Row, members, row};

members! { Combinator {
    Sum(_) => sums(),
    Ricci(_) => blends(),
    Product(_) => products(),
    Union(_) => unions(),
    Intersection(_) => intersections(),
    Difference(_) => differences(),
    SymmetricDifference(_) => steps::symmetric_differences(),
    SmoothUnion(_) => steps::smooth("union"),
    SmoothIntersection(_) => steps::smooth("intersection"),
    SmoothDifference(_) => steps::smooth("difference"),
    RFunction(_) => steps::rfunctions("alpha"),
    RFunctionPower(_) => steps::rfunctions("power"),
    RFunctionOrder(_) => steps::rfunctions("order"),
    Complement(_) => unary::complements(),
    Clamp(_) => unary::clamps(),
    Shell(_) => unary::shells(),
    Offset(_) => unary::offsets(),
} }

fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
    let of = |node: &CheckedNode| {
        let NodeKind::Combine(combinator) = &node.kind else { return None };
        Some(name(combinator))
    };
    tree.nodes().iter().filter_map(of).collect()
}

#[test]
fn every_combinator() {
    judge(Family { name: "combinators", members: members(), found });
}

const RED: &str = "color (1 0 0) { point { at (-1 0 0) radius 2 } }";
const BLUE: &str = "color (0 0 1) { point { at (1 0 0) radius 2 } }";
/// Far from the others: it meets neither.
const GREEN: &str = "color (0 1 0) { point { at (0 8 0) radius 2 } }";
/// Without a colour of its own, across the others.
const BAR: &str = "segment { from (0 -3 0) to (0 3 0) radius 1 }";

/// The fields of the red and the blue ball.
fn fields([x, y, z]: [f64; 3]) -> [f64; 2] {
    [-1.0, 1.0].map(|at| soft(((x - at).powi(2) + y * y + z * z) / 4.0))
}

/// Between the balls, nearer to either, on a skeleton, across, on a rim, and off.
const PLACES: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.5, 0.0, 0.0],
    [-0.25, 0.5, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, -1.0],
    [3.0, 0.0, 0.0],
    [1.5, 1.0, 0.25],
    [0.0, 0.0, 5.0],
];

/// What a formula of the two fields says there.
fn there(field: impl Fn(f64, f64) -> f64) -> [([f64; 3], f64); 8] {
    PLACES.map(|at| {
        let [red, blue] = fields(at);
        (at, field(red, blue))
    })
}

/// Where both balls have a field.
const BETWEEN: [[f64; 3]; 4] = [[0.5, 0.0, 0.0], [-0.25, 0.5, 0.0], [0.75, 0.25, 0.0], [0.5, 1.0, 0.25]];

/// A row of the two balls with the colours that weights give, where both have a field.
fn weighed(row: Row, weights: impl Fn(f64, f64) -> [f64; 2]) -> Row {
    weighed_at(&BETWEEN, row, weights)
}

/// A row of the two balls with the colours that weights give at some places.
fn weighed_at(places: &[[f64; 3]], row: Row, weights: impl Fn(f64, f64) -> [f64; 2]) -> Row {
    places.iter().fold(row, |row, &at| {
        let [red, blue] = fields(at);
        let [red, blue] = weights(red, blue);
        row.attribute("color", at, &[red / (red + blue), 0.0, blue / (red + blue)])
    })
}

fn sums() -> Vec<Row> {
    let push = format!("sum {{ {RED} point {{ at (1 0 0) radius 2 strength -0.5 }} }}");
    vec![
        weighed(row("of two", format!("sum {{ {RED} {BLUE} }}"), &there(|a, b| a + b)), |a, b| [a, b]),
        row("with one that pushes", push, &there(|a, b| a - 0.5 * b)).attribute(
            "color",
            [-1.0, 0.0, 0.0],
            &[1.0, 0.0, 0.0],
        ),
        row("of one", format!("sum {{ {RED} }}"), &there(|a, _| a)),
        row(
            "of many kinds",
            format!("sum {{ {RED} {BAR} {GREEN} {BLUE} {BAR} }}"),
            &[([0.0; 3], 3.0), ([0.0, 8.0, 0.0], 1.0), ([0.0, 3.5, 0.0], 1.0)],
        )
        .attribute("color", [0.0; 3], &[2.5 / 3.0, 2.0 / 3.0, 2.5 / 3.0])
        .attribute("color", [0.0, 6.5, 0.0], &[0.0, 1.0, 0.0])
        .attribute("color", [0.0, 0.0, 5.0], &[1.0; 3]),
    ]
}

fn blends() -> Vec<Row> {
    let of = |name, n: f64| {
        // Scaled by the one that counts most, so that no exponent is too large.
        let scale = move |a: f64, b: f64| if n < 0.0 { a.min(b) } else { a.max(b) };
        let field = move |a: f64, b: f64| {
            let most = scale(a, b);
            if most == 0.0 { 0.0 } else { most * ((a / most).powf(n) + (b / most).powf(n)).powf(1.0 / n) }
        };
        let weights = move |a: f64, b: f64| [a, b].map(|f| (f / scale(a, b)).powf(n));
        weighed(row(name, format!("blend ricci {n} {{ {RED} {BLUE} }}"), &there(field)), weights)
    };
    let mut rows = vec![
        of("by 1, the sum", 1.0),
        of("by 2", 2.0),
        of("by 2.5", 2.5),
        of("by 7", 7.0),
        of("by 16", 16.0),
        of("by 512", 512.0),
        of("by 1024", 1024.0),
        row(
            "with one that pushes",
            format!("blend ricci 3 {{ {RED} point {{ at (1 0 0) radius 2 strength -1 }} }}"),
            &there(|a, _| a),
        ),
        row(
            "of three",
            format!("blend ricci 2 {{ {RED} {BLUE} {BAR} {GREEN} }}"),
            &[([0.0; 3], 1.5f64.sqrt()), ([0.0, 8.0, 0.0], 1.0)],
        ),
        row(
            "by a parameter",
            format!("param n = 3 blend ricci n {{ {RED} {BLUE} }}"),
            &there(|a, b| (a.powi(3) + b.powi(3)).cbrt()),
        ),
    ];
    // Below zero it is an intersection that blends: 0 where any field is.
    let negative = [
        ("by -1", -1.0),
        ("by -2", -2.0),
        ("by -2.5", -2.5),
        ("by -7", -7.0),
        ("by -16", -16.0),
        ("by -512", -512.0),
        ("by -1024", -1024.0),
    ];
    rows.extend(negative.map(|(name, n)| {
        of(name, n).attribute("color", [1.0, 0.0, 0.0], &[1.0; 3]).attribute(
            "color",
            [0.0, 0.0, 5.0],
            &[1.0; 3],
        )
    }));
    rows.extend(intersections_that_blend());
    rows
}

fn intersections_that_blend() -> [Row; 3] {
    let harmonic = "param n = 1 blend ricci -n { RED BLUE }".replace("RED", RED).replace("BLUE", BLUE);
    let push =
        format!("blend ricci -2 {{ sum {{ {RED} point {{ at (1 0 0) radius 2 strength -0.5 }} }} {BAR} }}");
    [
        row(
            "by a negative parameter",
            harmonic,
            &there(|a, b| if a == 0.0 || b == 0.0 { 0.0 } else { 1.0 / (1.0 / a + 1.0 / b) }),
        ),
        // 1 / sqrt(2^2 + 2^2 + 1) of fields 1/2, 1/2 and 1; nothing where the green ball is to be as well.
        row(
            "of three, below zero",
            format!("union {{ blend ricci -2 {{ {RED} {BLUE} {BAR} }} blend ricci -2 {{ {RED} {GREEN} }} }}"),
            &[([0.0; 3], 1.0 / 3.0), ([1.0, 0.0, 0.0], 0.0), ([0.0, 8.0, 0.0], 0.0)],
        )
        .attribute("color", [0.0; 3], &[(4.0 + 1.0) / 9.0, 1.0 / 9.0, (4.0 + 1.0) / 9.0]),
        // A field that is negative makes it 0: 1/2 - 1/4 is in, -1/2 is not.
        row(
            "of what may be negative",
            push,
            &[([0.0; 3], 1.0 / 17.0f64.sqrt()), ([1.0, 0.0, 0.0], 0.0), ([0.5, 0.0, 0.0], 0.0)],
        ),
    ]
}

fn products() -> Vec<Row> {
    let equal = |_, _| [1.0, 1.0];
    vec![
        // f_1 f_2 / iso, with iso 1/2.
        weighed(row("of two", format!("product {{ {RED} {BLUE} }}"), &there(|a, b| 2.0 * a * b)), equal)
            .attribute("color", [1.0, 0.0, 0.0], &[1.0; 3]),
        weighed(
            row(
                "of two, by another iso-value",
                format!("iso 0.25 product {{ {RED} {BLUE} }}"),
                &there(|a, b| 4.0 * a * b),
            ),
            equal,
        ),
        row(
            "of three",
            format!("product {{ {RED} {BLUE} {BAR} }}"),
            &[([0.0; 3], 4.0 * 0.25), ([0.0, 0.0, 0.5], 4.0 * soft(1.25 / 4.0).powi(2) * 0.5), ([1.0, 0.0, 0.0], 0.0)],
        )
        .attribute("color", [0.0; 3], &[2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0]),
        // Two that push are one that does not.
        row(
            "with some that push",
            format!(
                "sum {{ product {{ {BAR} point {{ at (1 0 0) radius 2 strength -0.5 }} }}
                    product {{ point {{ at (-1 0 0) radius 2 strength -1 }} point {{ at (1 0 0) radius 2 strength -1 }} }} }}"
            ),
            &[([0.0; 3], -2.0 * 0.25 + 2.0 * 0.25), ([0.0, 0.5, 0.0], -soft(1.25 / 4.0) + 2.0 * soft(1.25 / 4.0).powi(2))],
        ),
        row("of one", format!("product {{ {RED} }}"), &there(|a, _| a)),
        row(
            "of many kinds",
            format!("union {{ product {{ {RED} {BAR} sum {{ {BLUE} {BAR} }} }} {GREEN} }}"),
            &[([0.0; 3], 4.0 * 0.5 * 1.5), ([0.0, 8.0, 0.0], 1.0), ([-1.0, 0.0, 0.0], 0.0)],
        ),
    ]
}

fn unions() -> Vec<Row> {
    let winner = |a: f64, b: f64| if b > a { [0.0, 1.0] } else { [1.0, 0.0] };
    vec![
        // Of equals the first gives the colour.
        weighed(row("of two", format!("union {{ {RED} {BLUE} }}"), &there(f64::max)), winner)
            .attribute("color", [0.0; 3], &[1.0, 0.0, 0.0])
            .attribute("color", [0.0, 0.0, 5.0], &[1.0; 3]),
        row(
            "with one that pushes",
            format!("union {{ point {{ at (1 0 0) radius 2 strength -0.5 }} {RED} }}"),
            &there(|a, b| a.max(-0.5 * b)),
        ),
        row(
            "of many kinds",
            format!("union {{ {RED} {BAR} {GREEN} sum {{ {BLUE} {BAR} }} }}"),
            &[([0.0; 3], 1.5), ([0.0, 8.0, 0.0], 1.0), ([-1.0, 0.0, 0.0], 1.0)],
        ),
    ]
}

fn intersections() -> Vec<Row> {
    let winner = |a: f64, b: f64| if b < a { [0.0, 1.0] } else { [1.0, 0.0] };
    vec![
        weighed(row("of two", format!("intersection {{ {RED} {BLUE} }}"), &there(f64::min)), winner)
            .attribute("color", [0.0; 3], &[1.0, 0.0, 0.0])
            .attribute("color", [2.5, 0.0, 0.0], &[1.0; 3]),
        row(
            "of three",
            format!("intersection {{ {RED} {BAR} sum {{ {BLUE} {BAR} }} }}"),
            &[([0.0; 3], 0.5), ([0.0, 0.0, 0.5], 0.5f64.min(soft(1.25 / 4.0))), ([-1.0, 0.0, 0.0], 0.0)],
        ),
        row(
            "with one that pushes",
            format!("intersection {{ point {{ at (1 0 0) radius 2 strength -0.5 }} {RED} }}"),
            &there(|a, b| a.min(-0.5 * b)),
        ),
    ]
}

fn differences() -> Vec<Row> {
    let cut = |iso: f64| move |a: f64, b: f64| a.min((2.0 * iso - b).max(0.0));
    let colored = row("of two", format!("difference {{ {RED} {BLUE} }}"), &there(cut(0.5)))
        .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0])
        // At the tie the first child stays, as it does where the other is not there.
        .attribute("color", [0.0; 3], &[1.0, 0.0, 0.0])
        .attribute("color", [-2.5, 0.0, 0.0], &[1.0, 0.0, 0.0]);
    let deep = format!("iso 0.4 difference {{ {RED} {BLUE} }}");
    let bitten = format!(
        "difference {{ {RED} {BAR} {GREEN} {BLUE} color (0 1 0) {{ point {{ at (-1 1 0) radius 1 }} }} }}"
    );
    vec![
        colored,
        row("with a lower surface", deep, &there(cut(0.4)))
            // The cut shows the colour of what cut it.
            .attribute("color", [0.125, 0.0, 0.0], &[0.0, 0.0, 1.0]),
        row(
            "of more than there is",
            format!("difference {{ {RED} sum {{ {BLUE} {BLUE} }} }}"),
            &[([1.0, 0.0, 0.0], 0.0), ([0.0; 3], 0.0), ([-1.0, 0.0, 0.0], 1.0)],
        ),
        row(
            "of several",
            bitten,
            &[
                ([-1.0, 0.0, 0.0], 1.0),
                ([0.0; 3], 0.0),
                ([-1.0, 0.5, 0.0], 0.5),
                ([-1.0, 0.75, 0.0], 1.0 - soft(1.0 / 16.0)),
            ],
        )
        .attribute("color", [-1.0, 0.75, 0.0], &[0.0, 1.0, 0.0]),
        row(
            "of a sum above twice the iso-value",
            format!("difference {{ sum {{ {RED} {RED} {RED} }} {GREEN} }}"),
            &[([-1.0, 0.0, 0.0], 1.0), ([-1.0, 1.0, 0.0], 1.0), ([-1.0, 1.5, 0.0], 3.0 * soft(9.0 / 16.0))],
        )
        .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0]),
    ]
}
