//! The tables of a tree are the same for every query: one list of active rows serves all programs of a model.

#[path = "../../text/tests/mild/mod.rs"]
mod mild;
mod random;

use std::path::Path;

use jbt_lower::lower;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;
use jbt_text::{Options, parse};

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
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for entry in std::fs::read_dir(folder).expect("the project has examples") {
        let path = entry.expect("a readable folder").path();
        if path.extension().is_some_and(|extension| extension == "jbt") {
            let text = std::fs::read(&path).expect("a readable file");
            let tree = parse(&text, &Options::default()).expect("it reads").check().expect("it is a model");
            assert!(same_tables(&tree, &path.display().to_string()));
        }
    }
}

#[test]
fn of_random_trees() {
    let mut rng = fastrand::Rng::with_seed(11);
    for index in 0..400 {
        let tree = mild::model(&mut rng, 3 + index % 30, true).check().expect("its numbers are mild");
        assert!(same_tables(&tree, &format!("mild tree {index}")), "it can be lowered");
    }
    for index in 0..5000 {
        if let Ok(tree) = random::model(&mut rng).check() {
            same_tables(&tree, &format!("wild tree {index}"));
        }
    }
}
