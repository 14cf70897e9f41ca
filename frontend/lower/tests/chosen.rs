//! Trees that answer for some attribute groups: the values of all groups, and programs that know no others.

use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_lower::lower;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;
use jbt_model::walk::walk;
use jbt_testkit::scene::tree;

/// A model of twenty groups of eight reals beside the colour, that mix in both ways.
fn many() -> CheckedTree {
    let mut head = "jbt 1 param p = 1\n".to_owned();
    let mut nodes = String::new();
    for group in 0..20 {
        let mixing = ["blend", "dominant"][group % 2];
        head += &format!("attribute g{group} 8 default (1 2 3 4 5 6 7 8) {mixing}\n");
        let values: Vec<String> = (0..8).map(|i| format!("{}", (group * 8 + i) % 7)).collect();
        nodes += &format!("g{group} ({}) {{ ", values.join(" "));
    }
    let close = "}".repeat(20);
    tree(&format!(
        "{head} sum {{ {nodes} color (1 p 0) {{ point {{ radius 1 }} }} {close}
           g3 (p 1 p 1 p 1 p 1) {{ point {{ at (0.5 0 0) radius 1 }} }} point {{ at (0 0.5 0) radius p }} }}"
    ))
}

fn instructions(tree: &CheckedTree) -> usize {
    let lowered = lower(tree, Query::ATTRIBUTES).expect("it can be lowered");
    run_pipeline(lowered.function, Query::ATTRIBUTES.passes().chain(PIPELINE), &mut |_, _| {}).values.len()
}

#[test]
fn chosen_groups_have_their_values() {
    let all = many();
    for names in [vec!["color"], vec!["g3"], vec!["g3", "color", "g18"], vec![]] {
        let chosen = all.of_attributes(&names).unwrap();
        let kept: Vec<usize> = all
            .attributes()
            .iter()
            .enumerate()
            .filter(|(_, group)| names.contains(&&*group.name))
            .map(|(index, _)| index)
            .collect();
        assert_eq!(chosen.attributes().len(), names.len());
        for p in [[0.0; 3], [0.3, 0.2, 0.0], [0.7, 0.0, 0.1], [0.0, 0.9, 0.0], [9.0; 3]] {
            for p_value in [1.0, 0.75] {
                let [all, chosen] =
                    [&all, &chosen].map(|tree| walk(&tree.with_parameters(&[("p", p_value)]).unwrap(), p));
                assert_eq!(all.field.to_bits(), chosen.field.to_bits());
                let wanted: Vec<&Vec<f64>> = kept.iter().map(|&index| &all.attributes[index]).collect();
                assert_eq!(chosen.attributes.iter().collect::<Vec<_>>(), wanted, "{names:?} {p:?}");
            }
        }
    }
    let error = all.of_attributes(&["colour"]).unwrap_err();
    assert_eq!(error[0].message, "no attribute is named `colour`");
    assert_eq!(error[0].help.as_deref(), Some("perhaps `color`"));
}

#[test]
fn what_is_not_chosen_costs_nothing() {
    let plain = tree(
        "jbt 1 param p = 1 sum { color (1 p 0) { point { radius 1 } } point { at (0.5 0 0) radius 1 } point { at (0 0.5 0) radius p } }",
    );
    let all = many();
    let chosen = all.of_attributes(&["color"]).unwrap();
    assert_eq!(instructions(&chosen), instructions(&plain));
    assert!(
        instructions(&all) > 10 * instructions(&chosen),
        "{} {}",
        instructions(&all),
        instructions(&chosen)
    );
    let none = all.of_attributes(&[""; 0]).unwrap();
    let field = |tree: &CheckedTree| lower(tree, Query::FIELD).unwrap().function.values.len();
    assert_eq!(lower(&none, Query::ATTRIBUTES).unwrap().function.values.len(), field(&plain));
}
