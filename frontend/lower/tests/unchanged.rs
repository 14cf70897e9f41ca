//! What costs nothing where nobody uses it: the programs of the examples have as many instructions as the
//! record says, and styles, parts, constants and names are no code.
//!
//! `golden/unchanged/examples.txt` has a line for each example: the values of its programs, as they are
//! lowered and after all passes, for the field, with the gradient, with attributes, with everything. A number
//! that grows there says that a feature is paid for by models without it. They are those of the commit
//! feb690b1, before names, parts, styles and directions were there; but for `castle`, which is younger, two
//! values of `machine` that passes take out again, and gradients of intersections, which stand still at 0.

use std::fmt::Write as _;

use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{Function, InstKind};
use jbt_lower::lower;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;
use jbt_testkit::golden::{compare, folder};
use jbt_testkit::scene::{examples, tree};

fn lowered(tree: &CheckedTree, query: Query) -> Function {
    lower(tree, query).expect("it can be lowered").function
}

fn asks_slopes(function: &Function) -> bool {
    function.insts.values().any(|inst| matches!(inst.kind, InstKind::Op { op, .. } if op.is_slope()))
}

#[test]
fn examples_have_the_programs_that_they_had() {
    let mut lines = String::new();
    let mut directions = 0;
    for (name, text) in examples() {
        let tree = tree(&text);
        let turns = tree.attributes().iter().any(jbt_model::attribute::AttributeGroup::turns);
        directions += usize::from(turns);
        let _ = write!(lines, "{name}");
        for query in Query::EVERY {
            let function = lowered(&tree, query);
            assert!(turns || !asks_slopes(&function), "{name}: slopes without a direction");
            let lowered = function.values.len();
            let passes = query.passes().chain(PIPELINE);
            let optimized = run_pipeline(function, passes, &mut |_, _| {}).values.len();
            let _ = write!(lines, "  {query} {lowered} {optimized}");
        }
        lines.push('\n');
    }
    assert!(directions < examples().len(), "most examples have no directions");
    compare(&folder("unchanged").join("examples.txt"), &lines);
}

#[test]
fn what_people_call_things_is_no_code() {
    let head = "jbt 1 attribute rough 1";
    let ball = "point { radius 1 }";
    let rod = "segment { from (0 0 0) to (1 0 0) radius 1 }";
    let plain = format!("union {{ color (1 0 0) {{ rough 0.5 {{ {ball} }} }} {rod} }}");
    for other in [
        format!("union {{ red: color (1 0 0) {{ rough 0.5 {{ ball: {ball} }} }} rod: {rod} }}"),
        format!("style oak = {{ color (1 0 0) rough 0.5 }} union {{ style oak {{ {ball} }} {rod} }}"),
        format!("union {{ override color (1 0 0) {{ rough 0.5 {{ color (0 0 1) {{ {ball} }} }} }} {rod} }}"),
        format!("part \"a\" {{ color (1 0 0) {{ rough 0.5 {{ {ball} }} }} }} part \"b\" {{ {rod} }}"),
        format!("union {{ constant part 7 {{ color (1 0 0) {{ rough 0.5 {{ {ball} }} }} }} {rod} }}"),
        format!(
            "def red(r) {{ color (1 0 0) {{ rough 0.5 {{ point {{ radius r }} }} }} }} union {{ red(1) {rod} }}"
        ),
    ] {
        let [plain, tree] = [&plain, &other].map(|text| tree(&format!("{head} {text}")));
        for query in Query::EVERY {
            assert_eq!(lowered(&tree, query).to_string(), lowered(&plain, query).to_string(), "{other}");
        }
    }
}

/// Slopes come with directions behind a warp, where attributes are asked for, and with nothing else.
#[test]
fn slopes_come_with_directions_alone() {
    let scene = |group: &str, inside: &str| {
        tree(&format!(
            "jbt 1 attribute grain {group} {inside} {{ grain (0 0 1) {{ point {{ radius 1 }} }} }}"
        ))
    };
    for (group, inside, expected) in [
        ("direction", "twist axis z rate 1", true),
        ("direction", "rotate axis z degrees 20", false),
        ("3", "twist axis z rate 1", false),
    ] {
        let tree = scene(group, inside);
        for query in Query::EVERY {
            let asked = query.contains(jbt_model::query::AnswerKind::Attributes);
            assert_eq!(asks_slopes(&lowered(&tree, query)), expected && asked, "{group} {inside} {query}");
        }
    }
}
