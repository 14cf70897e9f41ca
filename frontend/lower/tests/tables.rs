//! The tables of a tree are the same for every query: one list of active rows serves all programs of a model.

use jbt_lower::lower;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;
use jbt_testkit::random::{Numbers, Random, Settings};
use jbt_testkit::scene::{examples, tree};

fn same_tables(tree: &CheckedTree, what: &str) -> bool {
    let Ok(first) = lower(tree, Query::FIELD) else { return false };
    for query in Query::EVERY {
        let other = lower(tree, query).expect("what can be lowered for one query can be for all");
        assert_eq!(first.tables.tables.len(), other.tables.tables.len(), "{what}, {}", query.name());
        for (table, rows) in first.tables.tables.iter() {
            let (schema, others) = (&other.function.tables[table], &other.tables.tables[table]);
            let what = format!("{what}, {table}, {}", query.name());
            assert_eq!(first.function.tables[table].name, schema.name, "{what}");
            assert_eq!(first.function.tables[table].parent, schema.parent, "{what}");
            assert_eq!(first.function.tables[table].slots, schema.slots, "{what}");
            assert_eq!(rows.len(), others.len(), "{what}");
            assert_eq!(rows.starts, others.starts, "{what}");
            assert_eq!(rows.active, others.active, "{what}");
            assert_eq!(rows.nodes, others.nodes, "{what}");
        }
    }
    true
}

#[test]
fn of_examples() {
    for (name, text) in examples() {
        assert!(same_tables(&tree(&text), &name));
    }
}

#[test]
fn of_random_trees() {
    for index in 0..400 {
        let tree = Random::new(index, !index).model(1 + index as usize % 20).check().expect("a good model");
        assert!(same_tables(&tree, &format!("ordinary tree {index}")), "it can be lowered");
    }
    let settings = Settings { numbers: Numbers::Hostile, ..Settings::default() };
    let mut good = 0;
    for index in 0..5000 {
        let model = Random::with_settings(index, !index, settings).model(1 + index as usize % 9);
        if let Ok(tree) = model.check() {
            good += 1;
            same_tables(&tree, &format!("hostile tree {index}"));
        }
    }
    assert!(good > 100, "{good} hostile trees are good models");
}
