//! Constants cost nothing: with them and without them there are the same programs and the same rows.

use jbt_ir::table::Tables;
use jbt_ir::verify::Verified;
use jbt_model::query::Query;
use jbt_testkit::scene::{compiled, tree};

type Program = (Verified, Tables);

/// The same code, and the same numbers in the same rows, whatever nodes are called.
fn assert_same(a: &Program, b: &Program) {
    assert_eq!(a.0.function().to_string(), b.0.function().to_string());
    let rows = |(_, tables): &Program| {
        let of =
            |rows: &jbt_ir::table::Rows| (rows.count, rows.stride, rows.numbers.clone(), rows.starts.clone());
        tables.tables.iter().map(|(_, rows)| of(rows)).collect::<Vec<_>>()
    };
    assert_eq!(rows(a), rows(b));
}

#[test]
fn programs_know_no_constants() {
    let with = |of: fn(&str, usize) -> String| {
        let leaf = "ball: point { radius 1 }";
        let [a, b, c, d] = [0, 1, 2, 3].map(|n| of(leaf, n));
        let text = format!(
            "jbt 1 union {{ {a} color (1 0 0) {{ {b} }} twist axis z rate 1 {{ {c} }} translate (2 0 0) {{ {d} }} }}"
        );
        compiled(&tree(&text), Query::ALL)
    };
    let plain = with(|leaf, _| leaf.to_owned());
    let constant = with(|leaf, n| format!("constant color \"red\" {{ constant part {n} {{ {leaf} }} }}"));
    assert_same(&plain, &constant);
    // Two leaves that differ in constants alone stand at one place, and are one.
    let shared = "jbt 1 let a = point { radius 1 } sum { constant n 1 { use a } constant n 2 { use a } }";
    let both = compiled(&tree(shared), Query::FIELD);
    let same = compiled(&tree("jbt 1 let a = point { radius 1 } sum { use a use a }"), Query::FIELD);
    assert_same(&both, &same);
}
