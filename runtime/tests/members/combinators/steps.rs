//! Operators of two fields: symmetric difference, smooth set operations, R-functions.

use super::{BAR, BETWEEN, BLUE, GREEN, RED, there, weighed, weighed_at};
use crate::falloffs::soft;
use crate::row::{Row, row};

pub(super) fn symmetric_differences() -> Vec<Row> {
    let field = |iso: f64| move |a: f64, b: f64| a.max(b).min((2.0 * iso - a.min(b)).max(0.0));
    // The larger one, unless what is left of the smaller one is smaller still.
    let winner = |a: f64, b: f64| {
        let cuts = 1.0 - a.min(b) < a.max(b);
        if cuts == (a < b) { [1.0, 0.0] } else { [0.0, 1.0] }
    };
    let colored = row("of two", format!("symmetric_difference {{ {RED} {BLUE} }}"), &there(field(0.5)));
    let balls = |n: usize| vec![RED; n].join(" ");
    vec![
        weighed(colored, winner).attribute("color", [1.0, 0.0, 0.0], &[0.0, 0.0, 1.0]).attribute(
            "color",
            [0.0, 0.0, 5.0],
            &[1.0; 3],
        ),
        row(
            "of two, by another iso-value",
            format!("iso 0.25 symmetric_difference {{ {RED} {BLUE} }}"),
            &there(field(0.25)),
        ),
        // From the left: what is inside of an odd number of them.
        row(
            "of three",
            format!("symmetric_difference {{ {RED} {BLUE} sum {{ {} }} }}", balls(2)),
            &there(|a, b| field(0.5)(field(0.5)(a, b), 2.0 * a)),
        ),
        row(
            "of four",
            format!("symmetric_difference {{ {RED} {BLUE} sum {{ {} }} {BAR} }}", balls(2)),
            &[([-1.0, 0.0, 0.0], 0.0), ([1.0, 0.0, 0.0], 1.0), ([0.0, 3.0, 0.0], 1.0), ([0.0; 3], 0.5)],
        ),
        // 1/2 and 1/2 are 1/2; with the bar's 1 it is 1 - 1/2.
        row(
            "of many kinds",
            format!("symmetric_difference {{ {RED} {BLUE} {BAR} {GREEN} }}"),
            &[([0.0; 3], 0.5), ([0.0, 8.0, 0.0], 1.0), ([1.0, 0.0, 0.0], 1.0), ([0.0, 3.0, 0.0], 1.0)],
        ),
        // Far from the other, a side is limited to 2 iso.
        row(
            "of one above twice the iso-value",
            format!("symmetric_difference {{ sum {{ {} }} {BLUE} }}", balls(3)),
            &there(|a, b| (3.0 * a).max(b).min((1.0 - b.min(3.0 * a)).max(0.0))),
        )
        .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0])
        // 0.92 and 0.69: what is left of the smaller one decides.
        .attribute("color", [0.25, 0.0, 0.0], &[0.0, 0.0, 1.0]),
        row(
            "with one that pushes",
            format!("symmetric_difference {{ {RED} point {{ at (1 0 0) radius 2 strength -0.5 }} }}"),
            &there(|a, b| a.max(-0.5 * b).min(1.0 + 0.5 * b)),
        ),
    ]
}

/// `K = k - max(0, 2 k - s)^2 / (4 k)` and its derivative by s; nothing where s is not positive.
fn limited(k: f64, s: f64) -> [f64; 2] {
    let missing = (2.0 * k - s).max(0.0);
    if k == 0.0 || s <= 0.0 { [0.0; 2] } else { [k - missing * missing / (4.0 * k), missing / (2.0 * k)] }
}

/// `D = K q^2 / 4` with `q = 1 - |a - b| / K`, and the derivatives of that by `a + b` and by `-|a - b|`: with
/// `dD/dK = q (2 - q) / 4`.
fn rounding(k: f64, a: f64, b: f64) -> [f64; 3] {
    let [width, slope] = limited(k, a + b);
    let q = if width == 0.0 { 0.0 } else { (1.0 - (a - b).abs() / width).max(0.0) };
    [width * q * q / 4.0, q * (2.0 - q) / 4.0 * slope, q / 2.0]
}

fn union(k: f64) -> impl Fn(f64, f64) -> f64 + Copy {
    move |a, b| a.max(b) + rounding(k, a, b)[0]
}

fn intersection(k: f64) -> impl Fn(f64, f64) -> f64 + Copy {
    move |a, b| a.min(b) - rounding(k, a, b)[0]
}

fn difference(k: f64, iso: f64) -> impl Fn(f64, f64) -> f64 + Copy {
    move |a, b| intersection(limited(k, b)[0])(a, (2.0 * iso - b).max(0.0))
}

/// `f dF/df` of both: the larger field moves `|a - b|` up, the smaller one down.
fn weights(k: f64, is_union: bool) -> impl Fn(f64, f64) -> [f64; 2] + Copy {
    move |a, b| {
        let [_, along, apart] = rounding(k, a, b);
        let [larger, smaller] = if is_union {
            [1.0 - apart + along, apart + along]
        } else {
            [apart - along, 1.0 - apart - along]
        };
        if a >= b { [a * larger, b * smaller] } else { [a * smaller, b * larger] }
    }
}

/// Rows of one of the smooth set operations.
pub(super) fn smooth(set: &str) -> Vec<Row> {
    let word = format!("smooth_{set} ");
    all_smooth().into_iter().filter(|row| row.text.contains(&word)).collect()
}

fn all_smooth() -> Vec<Row> {
    let text = |operator: &str, k: f64| format!("smooth_{operator} {k} {{ {RED} {BLUE} }}");
    let of_unions = [("a narrow union", 0.25), ("a wide union", 0.5), ("a union wider than the fields", 2.0)];
    let of_intersections = [
        ("a narrow intersection", 0.25),
        ("a wide intersection", 0.5),
        ("an intersection wider than the fields", 2.0),
    ];
    let unions = of_unions.map(|(name, k)| {
        weighed(row(name, text("union", k), &there(union(k))), weights(k, true))
            .attribute("color", [0.0; 3], &[0.5, 0.0, 0.5])
            .attribute("color", [3.0, 0.0, 0.0], &[1.0; 3])
    });
    let intersections = of_intersections.map(|(name, k)| {
        weighed(row(name, text("intersection", k), &there(intersection(k))), weights(k, false))
            .attribute("color", [0.0; 3], &[0.5, 0.0, 0.5])
            .attribute("color", [1.0, 0.0, 0.0], &[1.0; 3])
    });
    unions.into_iter().chain(intersections).chain(smooth_differences()).chain(smooth_of_several()).collect()
}

fn smooth_differences() -> [Row; 4] {
    // What is cut away counts by its complement.
    let cut = |k: f64| move |a: f64, b: f64| weights(limited(k, b)[0], false)(a, 1.0 - b);
    let narrow = format!("smooth_difference 0.25 {{ {RED} {BLUE} }}");
    let wide = format!("smooth_difference 0.5 {{ {RED} {BLUE} }}");
    [
        weighed(row("a narrow difference", narrow.clone(), &there(difference(0.25, 0.5))), cut(0.25))
            .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0]),
        weighed(row("a wide difference", wide, &there(difference(0.5, 0.5))), cut(0.5)),
        row(
            "a difference by another iso-value",
            format!("iso 0.75 {narrow}"),
            &there(difference(0.25, 0.75)),
        ),
        // Where nothing is cut away it is min(a, 2 iso).
        row(
            "a difference above twice the iso-value",
            format!("smooth_difference 0.25 {{ sum {{ {RED} {RED} {RED} }} {GREEN} }}"),
            &there(|a, _| (3.0 * a).min(1.0)),
        )
        .attribute("color", [-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0]),
    ]
}

fn smooth_of_several() -> [Row; 5] {
    let push = "point { at (1 0 0) radius 2 strength -0.5 }";
    [
        // 1/2 and 1/2 make 1/2 + 1/8; that and the bar's 1 are 3/8 apart, so 1/8 is left: 1 + (1/8)^2 / 2.
        row(
            "a union of many kinds",
            format!("smooth_union 0.5 {{ {RED} {BLUE} {BAR} {GREEN} }}"),
            &[([0.0; 3], 1.0 + 1.0 / 128.0), ([0.0, 8.0, 0.0], 1.0), ([0.0, 3.5, 0.0], 0.5)],
        ),
        // 1/2 and 1/2 make 1/2 - 1/8, which is more than 1/2 below the bar's 1.
        row(
            "an intersection of many kinds",
            format!("smooth_intersection 0.5 {{ {RED} {BLUE} {BAR} }}"),
            &[([0.0; 3], 0.375), ([1.0, 0.0, 0.0], 0.0), ([0.0, 1.0, 0.0], three_at_one(0.5))],
        ),
        row(
            "a union with one that pushes",
            format!("smooth_union 0.5 {{ {RED} {push} }}"),
            &there(|a, b| a.max(-0.5 * b)),
        ),
        row(
            "an intersection with one that pushes",
            format!("smooth_intersection 0.5 {{ {push} {RED} }}"),
            &there(|a, b| a.min(-0.5 * b)),
        ),
        row(
            "by a parameter",
            format!("param k = 0.25 smooth_union 2 * k {{ {RED} {BLUE} }}"),
            &there(union(0.5)),
        ),
    ]
}

/// Across the balls, 1 from the middle: both are soft(2/4), the bar is 1.
fn three_at_one(k: f64) -> f64 {
    let of_two = intersection(k)(soft(0.5), soft(0.5));
    intersection(k)(of_two, 1.0)
}

/// Where the left ball is, and the right one is not inside; both fields are about as far from the iso-value,
/// so that no slope is near 0.
const LEFT: [[f64; 3]; 4] = [[-0.125, 0.0, 0.0], [-0.25, 0.0, 0.0], [-0.5, 0.0, 0.0], [-0.75, 0.0, 0.0]];

/// R and its derivatives.
type Rvachev = fn(f64, f64, f64) -> [f64; 3];

/// `x + y + sqrt(x^2 + y^2 - 2 alpha x y)`.
fn alpha(x: f64, y: f64, alpha: f64) -> [f64; 3] {
    let s = (x * x + y * y - 2.0 * alpha * x * y).sqrt();
    [x + y + s, 1.0 + (x - alpha * y) / s, 1.0 + (y - alpha * x) / s]
}

/// `(x + y + s) s^m`, `s = sqrt(x^2 + y^2)`; by the product rule, with `ds/dx = x / s`.
fn order(x: f64, y: f64, m: f64) -> [f64; 3] {
    let s = x.hypot(y);
    let slope = |x_or_y: f64| (1.0 + x_or_y / s) * s.powf(m) + (x + y + s) * m * s.powf(m - 1.0) * x_or_y / s;
    [(x + y + s) * s.powf(m), slope(x), slope(y)]
}

/// `x + y + (|x|^p + |y|^p)^(1/p)`.
fn power(x: f64, y: f64, p: f64) -> [f64; 3] {
    let s = (x.abs().powf(p) + y.abs().powf(p)).powf(1.0 / p);
    let slope = |x: f64| 1.0 + (x.abs() / s).powf(p - 1.0) * x.signum();
    [x + y + s, slope(x), slope(y)]
}

/// A set operation by R: `R(x, y)`, `-R(-x, -y)`, `-R(-x, y)` of `x = a / iso - 1`, less its background: `iso
/// (1 - R / B)`, at least 0.
fn rvachev(set: &str, r: Rvachev, number: f64, iso: f64) -> impl Fn(f64, f64) -> [f64; 3] + Copy {
    let [left, right] = match set {
        "union" => [1.0, 1.0],
        "intersection" => [-1.0, -1.0],
        _ => [-1.0, 1.0],
    };
    let at = move |a: f64, b: f64| r(left * (a / iso - 1.0), right * (b / iso - 1.0), number);
    move |a, b| {
        let ([value, by_a, by_b], [background, ..]) = (at(a, b), at(0.0, 0.0));
        [(iso * (1.0 - value / background)).max(0.0), by_a, by_b]
    }
}

/// R_0 of a field f alone, of which nothing is left where f is 0.
fn lone(f: f64) -> f64 {
    let x = 2.0 * f - 1.0;
    0.5 * (1.0 - (x - 1.0 + x.hypot(1.0)) / (2.0f64.sqrt() - 2.0))
}

/// Rows of one family of R-functions; alpha is the one that is taken if none is written.
pub(super) fn rfunctions(family: &str) -> Vec<Row> {
    let of = |text: &str| ["power", "order"].into_iter().find(|word| text.contains(&format!(" {word} ")));
    all_rfunctions().into_iter().filter(|row| of(&row.text).unwrap_or("alpha") == family).collect()
}

fn all_rfunctions() -> Vec<Row> {
    let families: [(&str, Rvachev, &[f64]); 3] = [
        ("alpha", alpha, &[-0.9, 0.0, 0.5]),
        ("order", order, &[1.0, 2.0, 4.0]),
        ("power", power, &[1.1, 2.0, 3.5, 64.0]),
    ];
    let sets = [("union", 1.0), ("intersection", 1.0), ("difference", -1.0)];
    let mut rows = Vec::new();
    for (set, sign) in sets {
        for (family, r, numbers) in families {
            for &number in numbers {
                let of = rvachev(set, r, number, 0.5);
                let text = format!("rfunction {set} {family} {number} {{ {RED} {BLUE} }}");
                // What is subtracted counts by its complement.
                let weigh = move |a: f64, b: f64| {
                    let ([_, by_a, by_b], right) =
                        (of(a, b), if sign < 0.0 { (1.0 - b).max(0.0) } else { b });
                    [a * by_a.max(0.0), right * by_b.max(0.0)]
                };
                let row = row(set_name(set), text, &there(|a, b| of(a, b)[0]));
                // A difference has no field, and so only the default, where the right ball's is large.
                let places = if sign < 0.0 { &LEFT } else { &BETWEEN };
                rows.push(weighed_at(places, row, weigh));
            }
        }
    }
    rows.extend(sharp());
    rows.extend(rvachev_of_others());
    rows
}

fn set_name(set: &str) -> &'static str {
    match set {
        "union" => "a union",
        "intersection" => "an intersection",
        _ => "a difference",
    }
}

/// Alpha of 1: the operations without rounding.
fn sharp() -> [Row; 3] {
    let text = |set: &str| format!("rfunction {set} alpha 1 {{ {RED} {BLUE} }}");
    [
        row("a sharp union", text("union"), &there(f64::max)),
        row("a sharp intersection", text("intersection"), &there(f64::min)),
        row("a sharp difference", text("difference"), &there(|a, b| a.min((1.0 - b).max(0.0)))),
    ]
}

fn rvachev_of_others() -> Vec<Row> {
    let root = 2.0f64.sqrt();
    vec![
        // R_0 of 1 and 0 is 2 - sqrt(2) there, in units of iso: an R-intersection reaches as far as its
        // union.
        row(
            "an intersection of one alone",
            format!("rfunction intersection {{ {RED} {GREEN} }}"),
            &[
                ([-1.0, 0.0, 0.0], 0.5 * (1.0 - root / (2.0 + root))),
                ([0.0, 8.0, 0.0], 0.5 * (1.0 - root / (2.0 + root))),
                ([0.0, 4.0, 0.0], 0.0),
            ],
        ),
        row(
            "of three",
            format!("rfunction union alpha 0 {{ {RED} {GREEN} {GREEN} }}"),
            &there(|a, _| lone(lone(a))),
        ),
        row(
            "by another iso-value",
            format!("iso 0.25 rfunction difference power 3 {{ {RED} {BLUE} }}"),
            &there(|a, b| rvachev("difference", power, 3.0, 0.25)(a, b)[0]),
        ),
        row(
            "by a parameter",
            format!("param alpha = 0.25 rfunction union alpha 2 * alpha {{ {RED} {BLUE} }}"),
            &there(|a, b| rvachev("union", alpha, 0.5, 0.5)(a, b)[0]),
        ),
        row(
            "with one that pushes",
            format!("rfunction union order 1 {{ {RED} point {{ at (1 0 0) radius 2 strength -0.5 }} }}"),
            &there(|a, b| rvachev("union", order, 1.0, 0.5)(a, -0.5 * b)[0]),
        ),
    ]
}
