//! Where things are asked: formulas in spaces and far boxes have the answers of the oracle, and what stands
//! at one place is one thing.

use jbt_ir::{InstKind, Op, Rule};
use jbt_lower::{lower, lower_ranges};
use jbt_model::query::Query;
use jbt_model::walk::walk;
use jbt_testkit::scene::{compiled, run, tree};

/// Compares field and colour with the oracle's at points about the model's origin.
#[track_caller]
fn assert_answers(text: &str, points: &[[f64; 3]]) {
    let tree = tree(text);
    let program = compiled(&tree, Query::ATTRIBUTES);
    for &point in points {
        let sample = walk(&tree, tree.origin().world(point));
        let expected: Vec<f64> = [sample.field].into_iter().chain(sample.attributes.concat()).collect();
        let found = run(&program, point);
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-4 * b.abs().max(1.0);
        assert!(found.iter().zip(&expected).all(near), "{text} at {point:?}: {found:?}, not {expected:?}");
        assert_eq!(found.len(), expected.len());
    }
}

#[test]
fn formulas_of_attributes_are_asked_where_they_are_bound() {
    let points = [[0.4, 0.1, 0.5], [-0.3, 0.2, -0.4], [0.1, -0.2, 0.3]];
    // Formulas of one form for leaves of one code: the way up to where they are bound is another one.
    let place = "color expression { (x, y, z) }";
    let [here, there] = ["point { at (0.5 0 0) radius 1 }", "point { at (-0.3 0.2 0) radius 1 }"];
    let twisted = |below: &str| format!("twist axis z rate 2 {{ {below} }}");
    let inside = twisted(&format!("sum {{ {here} {place} {{ {there} }} }}"));
    assert_answers(&format!("jbt 1 {place} {{ {inside} }}"), &points);
    let both =
        format!("sum {{ {place} {{ {} }} {} }}", twisted(here), twisted(&format!("{place} {{ {there} }}")));
    assert_answers(&format!("jbt 1 {both}"), &points);
}

#[test]
fn boxes_far_away_have_the_formulas_of_their_places() {
    let points =
        [[0.25, 0.25, 0.25], [0.5, 0.75, 0.1], [-0.25, 0.5, 0.5], [20.25, 0.5, 0.5], [20.75, 0.25, 1.5]];
    let far = |formula: &str| {
        format!(
            "jbt 1 union {{ expression within (100000 0 0) to (100001 1 1) {{ {formula} }}
            translate (100000 0 0) {{ expression within (20 0 0) to (21 1 1) {{ {formula} }} }} }}"
        )
    };
    assert_answers(&far("0.75"), &points);
    assert_answers(&far("0.5 + 0.25 * sin(3 * y)"), &points);
    assert_answers(&far("max(0, 1 - abs(x - 100000.5))"), &points);
}

#[test]
fn maps_that_differ_in_the_sign_of_a_zero_are_one() {
    // The mirror leaves a -0 where it is behind the rotation.
    let leaf = "let leaf = point { at (0.5 0.25 0) radius 1 }";
    let [turn, mirror] = ["rotate axis x degrees 200", "scale (-1 1 1)"];
    let once = format!("{turn} {{ {mirror} {{ use leaf }} }}");
    let again = format!("{mirror} {{ {turn} {{ use leaf }} }}");
    let function = |second: &str| {
        let text =
            format!("jbt 1 {leaf} union {{ sum {{ {once} ring {{ ring_radius 1 radius 1 }} }} {second} }}");
        lower(&tree(&text), Query::FIELD).expect("it lowers").function
    };
    assert_eq!(function(&again), function(&once));
    assert_ne!(function(&again), function("rotate axis x degrees 201 { use leaf }"), "it can be told");
}

#[test]
fn a_selector_of_one_child_is_that_child() {
    let function = |text: &str| lower(&tree(text), Query::ALL).expect("it lowers").function;
    let of = |ball: &str| function(&format!("jbt 1 sum {{ {ball} point {{ at (1 0 0) radius 1 }} }}"));
    assert_eq!(of("select 0 { point { radius 1 } }"), of("point { radius 1 }"));
}

/// What may be the model's answer, behind warps and selectors, is never left out: its attributes are seen
/// even where its field is zero.
#[test]
fn a_choice_that_may_be_the_answer_stays() {
    let rules = |text: &str| {
        let info = lower_ranges(&tree(text)).expect("it lowers").info;
        info.tables.values().map(|table| table.rule).collect::<Vec<Rule>>()
    };
    let select = "select 0 { point { radius 1 } ring { ring_radius 1 radius 1 } }";
    let warped = rules(&format!("jbt 1 twist axis z rate 1 {{ {select} }}"));
    let beside = rules(&format!("jbt 1 sum {{ {select} segment {{ from (0 0 0) to (1 0 0) radius 1 }} }}"));
    assert_eq!(warped, [Rule::Never; 3]);
    assert_eq!(beside[0], Rule::Never, "the scene");
    assert!(beside[1..].iter().all(|&rule| rule == Rule::Neutral), "{beside:?}");
}

/// A union of formulas that may be negative begins with the lowest number, so none of them is kept above it.
#[test]
fn operands_of_a_union_are_bounded_by_it() {
    let text = "jbt 1 union { expression { x - y } expression { x * y } }";
    let function = lower(&tree(text), Query::FIELD).expect("it lowers").function;
    let is_max = |kind: &InstKind| matches!(kind, InstKind::Op { op: Op::Max, .. });
    assert_eq!(function.insts.values().filter(|inst| is_max(&inst.kind)).count(), 2, "one for each operand");
}
