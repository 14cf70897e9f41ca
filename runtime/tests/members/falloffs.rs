//! Falloffs, around a point and where the gradient of the distance jumps: around a ring, on whose axis all of
//! it is equally near.

use jbt::{CheckedTree, Falloff, Model};
use jbt_model::check::CheckedNode;
use jbt_model::falloff::FalloffKind;
use jbt_model::kind::NodeKind;

use crate::check::judge;
use crate::row::{Family, Row, members, row};

members! { Falloff {
    Soft => rows("soft", &soft),
    Wyvill => rows("wyvill", &|s| depth(s).powi(3)),
    Quartic => rows("quartic", &|s| depth(s).powi(2)),
    Metaball => rows("metaball", &metaball),
    Hermite => rows("hermite", &hermite),
    Quintic => rows("quintic", &quintic),
    Linear => rows("linear", &|s| (1.0 - s.sqrt()).max(0.0)),
    Degree(_) => degrees(),
    Blinn(_) => blinns(),
    ArcTan(_) => arctans(),
    InversePower(_) => inverse_powers(),
    Blanc(_) => blancs(),
} }

/// `1 - s`, and 0 outside of the support.
fn depth(s: f64) -> f64 {
    (1.0 - s).max(0.0)
}

/// The soft object's falloff (Wyvill, McPheeters and Wyvill 1986): `u^2 (5 + 4u) / 9` in `u = 1 - s`.
pub fn soft(s: f64) -> f64 {
    let u = depth(s);
    u * u * (5.0 + 4.0 * u) / 9.0
}

/// The metaball of Nishimura et al. (1985), in `r = sqrt(s)`.
fn metaball(s: f64) -> f64 {
    let r = s.sqrt();
    if r <= 1.0 / 3.0 { 1.0 - 3.0 * r * r } else { 1.5 * (1.0 - r).max(0.0).powi(2) }
}

/// The cubic with slopes of 0 at both ends, `1 - 3 r^2 + 2 r^3`, by its roots.
fn hermite(s: f64) -> f64 {
    let r = s.sqrt();
    (1.0 - r).max(0.0).powi(2) * (1.0 + 2.0 * r)
}

/// The quintic with slopes and curvatures of 0 at both ends, `1 - 10 r^3 + 15 r^4 - 6 r^5`, by its roots.
fn quintic(s: f64) -> f64 {
    let r = s.sqrt();
    (1.0 - r).max(0.0).powi(3) * (1.0 + 3.0 * r + 6.0 * r * r)
}

/// The falloff of Blanc and Schlick (1995).
fn blanc(p: f64, s: f64) -> f64 {
    match s {
        0.0 => 1.0,
        ..=0.25 => 1.0 - 9.0 * s * s / (p + (4.5 - 4.0 * p) * s),
        _ => depth(s).powi(2) / (0.75 - p + (1.5 + 4.0 * p) * s),
    }
}

/// A function that is cut off at the rim.
fn exact(value: f64, s: f64) -> f64 {
    if s < 1.0 { value } else { 0.0 }
}

/// A function that is led to zero from `s = 1/2`: times `z^2 (2 - z^2)`, with `z = 2 (1 - s)` up to 1.
fn smooth(value: f64, s: f64) -> f64 {
    let square = (2.0 * depth(s)).min(1.0).powi(2);
    value * square * (2.0 - square)
}

/// Whole exponents and others.
fn degrees() -> Vec<Row> {
    let words = |n: f64| format!("degree {{ exponent {n} }}");
    let of = |n: f64| rows(&words(n), &|s| depth(s).powf(n));
    [1.0, 8.0, 0.75, 2.5].into_iter().flat_map(of).collect()
}

/// The defaults are a hardness and a cutoff of 2: `exp(-8 s)`.
fn blinns() -> Vec<Row> {
    let mut all = rows("blinn", &|s| smooth((-8.0 * s).exp(), s));
    all.extend(rows("blinn { edge exact }", &|s| exact((-8.0 * s).exp(), s)));
    // Softer: it falls by exp(-9/4) only, to 0.105, and jumps from there.
    all.extend(rows("blinn { hardness 1 cutoff 1.5 edge exact }", &|s| exact((-2.25 * s).exp(), s)));
    all
}

/// With a tip at the skeleton. Where the edge is exact they end in a crease and do not jump.
fn arctans() -> Vec<Row> {
    let plain = |p: f64, s: f64| 0.5 + (p * (1.0 - 2.0 * s.sqrt())).atan() / (2.0 * p.atan());
    let mut all = rows("arctan", &|s| exact(plain(50.0, s), s));
    all.extend(rows("arctan { stiffness 2 }", &|s| exact(plain(2.0, s), s)));
    all.extend(rows("arctan { stiffness 5 edge smooth }", &|s| smooth(plain(5.0, s), s)));
    all
}

/// Even, odd and broken exponents; that of 1 has a tip at the skeleton.
fn inverse_powers() -> Vec<Row> {
    let plain = |n: f64, c: f64, s: f64| 1.0 / (1.0 + (c * s.sqrt()).powf(n));
    let mut all = rows("inverse_power", &|s| smooth(plain(2.0, 4.0, s), s));
    let jumps = |s: f64| exact(plain(3.0, 2.0, s), s);
    all.extend(rows("inverse_power { exponent 3 cutoff 2 edge exact }", &jumps));
    let pointed = |s: f64| smooth(plain(1.0, 4.0, s), s);
    all.extend(rows("inverse_power { exponent 1 }", &pointed));
    let broken = |s: f64| exact(plain(2.5, 3.0, s), s);
    all.extend(rows("inverse_power { exponent 2.5 cutoff 3 edge exact }", &broken));
    all
}

/// Nearly linear in s inside, in the middle, and nearly a step.
fn blancs() -> Vec<Row> {
    let words = |p: f64| format!("blanc {{ hardness {p} }}");
    let of = |p: f64| rows(&words(p), &|s| blanc(p, s));
    [0.0, 0.5, 4.0].into_iter().flat_map(of).collect()
}

fn found(_: &Model, tree: &CheckedTree) -> Vec<&'static str> {
    let of = |node: &CheckedNode| {
        let NodeKind::Primitive(leaf) = &node.kind else { return None };
        Some(name(&leaf.falloff))
    };
    tree.nodes().iter().filter_map(of).collect()
}

#[test]
fn every_falloff() {
    let members = members();
    assert_eq!(members.len(), FalloffKind::ALL.len());
    judge(Family { name: "falloffs", members, found });
}

/// The rows of a falloff, by its word and its value at `s = d^2 / radius^2`.
fn rows(word: &str, value: &dyn Fn(f64) -> f64) -> Vec<Row> {
    let distances = [0.0, 0.125, 0.5, 1.0, 1.5, 1.875, 2.0, 3.0];
    let field = |d: f64| ([1.0, d, 0.0], value(d * d / 4.0));
    let around_ring = [
        ([0.0; 3], value(1.0 / 4.0)),
        ([0.0, 0.0, 1.0], value(2.0 / 4.0)),
        ([1.0, 0.0, 0.0], value(0.0)),
        ([0.0, 2.0, 0.0], value(1.0 / 4.0)),
        ([0.0, 3.0, 0.0], 0.0),
    ];
    vec![
        row(
            "around a point",
            format!("point {{ at (1 0 0) radius 2 falloff {word} }}"),
            &distances.map(field),
        ),
        row("around a ring", format!("ring {{ ring_radius 1 radius 2 falloff {word} }}"), &around_ring),
        row(
            "that is stronger",
            format!("point {{ radius 1 falloff {word} strength 3 }}"),
            &[([0.0; 3], 3.0), ([0.0, 0.5, 0.0], 3.0 * value(0.25))],
        ),
        row(
            "by its surface",
            format!("iso 0.25 point {{ surface_radius 0.75 falloff {word} }}"),
            &[([0.0; 3], 1.0), ([0.0, 0.75, 0.0], 0.25), ([0.0, 0.0, -0.75], 0.25)],
        ),
    ]
}

/// The formulas above are those that were published.
#[test]
fn published_values() {
    assert_eq!((soft(0.0), soft(0.25), soft(1.0)), (1.0, 0.5, 0.0));
    let s: f64 = 0.3;
    let r = s.sqrt();
    for (factors, expanded) in [
        (soft(s), 1.0 - 22.0 / 9.0 * s + 17.0 / 9.0 * s * s - 4.0 / 9.0 * s * s * s),
        (hermite(s), 1.0 - 3.0 * s + 2.0 * r * s),
        (quintic(s), 1.0 - 10.0 * r * s + 15.0 * s * s - 6.0 * r * s * s),
    ] {
        assert!((factors - expanded).abs() < 1e-15, "{factors}, not {expanded}");
    }
    for p in [0.0, 0.5, 4.0] {
        assert_eq!((blanc(p, 0.0), blanc(p, 0.25), blanc(p, 1.0)), (1.0, 0.5, 0.0));
        assert!((blanc(p, 0.25 + 1e-9) - 0.5).abs() < 1e-7, "both pieces meet");
    }
    // The two parabolas of a metaball touch at 2/3.
    assert!((metaball(1.0 / 9.0) - 2.0 / 3.0).abs() < 1e-15);
    assert!((metaball(0.112) - (1.0 - 3.0 * 0.112)).abs() < 1e-5);
    // An edge is led to zero with a slope of 0 at both ends: 1 at s = 1/2, 7/16 at s = 3/4.
    assert_eq!([0.25, 0.5, 0.75, 1.0].map(|s| smooth(1.0, s)), [1.0, 1.0, 7.0 / 16.0, 0.0]);
}
