//! Costs: ops by name, and evaluations by leaf, against figures counted by hand and against running the
//! function.

mod common;

use std::collections::BTreeMap;

use common::random;
use jbt_ir::domain::counting::{Counting, evaluations};
use jbt_ir::{
    Domain, Entity, FoldKind, FunctionBuilder, InstKind, Op, Origin, Part, Rows, Rule, Schema, Table, Tables,
    Value, Verified, interpret, verify,
};

fn table(b: &mut FunctionBuilder, columns: usize, parent: Option<Table>, slots: &[u32]) -> Table {
    let columns = (0..columns).map(|column| format!("c{column}")).collect();
    b.table(Schema { name: "row".into(), columns, parent, slots: slots.to_vec() })
}

fn rows(stride: usize, count: usize, active: &[u32], starts: &[u32], nodes: &[u32]) -> Rows {
    Rows {
        count,
        stride,
        numbers: vec![1.0; stride * count],
        active: active.to_vec(),
        starts: starts.to_vec(),
        nodes: nodes.to_vec(),
    }
}

fn finish(b: FunctionBuilder, value: Value) -> Verified {
    verify(b.finish(&[("field".into(), value)])).expect("the function obeys the rules")
}

/// A sum over `t`, in which each slot has a distance of one instruction, made of x and a column, and a
/// falloff of another one.
fn sum(b: &mut FunctionBuilder, t: Table, slots: &[u32], initial: Value) -> Value {
    let x = b.input(0);
    let mut acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[initial])[0];
    for (column, &slot) in slots.iter().enumerate() {
        let c = b.column(t, column);
        b.set_origin(Origin::leaf(slot, Part::Distance));
        let distance = b.sub(x, c);
        b.set_origin(Origin::leaf(slot, Part::Falloff));
        let falloff = b.mul(distance, distance);
        b.set_origin(Origin::SHARED);
        acc = b.add(acc, falloff);
    }
    b.end_fold(&[acc])[0]
}

fn nodes(counts: &[(u32, u64)]) -> BTreeMap<u32, u64> {
    counts.iter().copied().collect()
}

#[test]
fn a_sum_evaluates_each_active_row_once() {
    let mut b = FunctionBuilder::new("sum", &["x"]);
    let t = table(&mut b, 2, None, &[0, 1]);
    let zero = b.constant(0.0);
    let field = sum(&mut b, t, &[0, 1], zero);
    let function = finish(b, field);
    let mut tables = Tables::default();
    tables.tables.push(rows(2, 3, &[0, 2], &[0, 2], &[10, 11, 20, 21, 30, 10]));
    tables.check(function.function()).unwrap();

    let counted = evaluations(&function, &tables);
    assert_eq!(counted.total, 4);
    assert_eq!(counted.per_node, nodes(&[(10, 2), (11, 1), (30, 1)]));

    let mut counting = Counting::new();
    interpret::run(&function, &tables, &mut counting, &[()]);
    assert_eq!(counting.by_name().collect::<Vec<_>>(), [("add", 4), ("sub", 4), ("mul", 4)]);
    assert_eq!((counting.total(), counting.count(Op::Fma)), (12, 0));
}

#[test]
fn rows_of_a_child_count_for_each_parent_row_that_owns_them() {
    let mut b = FunctionBuilder::new("nested", &["x"]);
    let outer = table(&mut b, 1, None, &[]);
    let inner = table(&mut b, 1, Some(outer), &[0]);
    let zero = b.constant(0.0);
    let acc = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let part = sum(&mut b, inner, &[0], acc);
    let field = b.end_fold(&[part])[0];
    let function = finish(b, field);
    let mut tables = Tables::default();
    tables.tables.push(rows(1, 4, &[0, 2, 3], &[0, 3], &[]));
    // Row 1 of the outer table is not active, rows 2 and 3 share inner row 3.
    tables.tables.push(rows(1, 4, &[0, 1, 2, 3, 3], &[0, 2, 3, 4, 5], &[5, 6, 7, 8]));
    tables.check(function.function()).unwrap();
    let counted = evaluations(&function, &tables);
    assert_eq!((counted.total, counted.per_node), (4, nodes(&[(5, 1), (6, 1), (8, 2)])));
}

#[test]
fn a_fold_inside_another_one_that_is_not_its_parent_runs_all_its_rows_each_time() {
    let mut b = FunctionBuilder::new("crossed", &["x"]);
    let outer = table(&mut b, 1, None, &[]);
    let other = table(&mut b, 1, None, &[]);
    let inner = table(&mut b, 1, Some(outer), &[0]);
    let zero = b.constant(0.0);
    let acc = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let acc = b.begin_fold(other, (FoldKind::Rows, Rule::Neutral), &[acc])[0];
    let part = sum(&mut b, inner, &[0], acc);
    let part = b.end_fold(&[part])[0];
    let field = b.end_fold(&[part])[0];
    let function = finish(b, field);
    let mut tables = Tables::default();
    tables.tables.push(rows(1, 2, &[0, 1], &[0, 2], &[]));
    tables.tables.push(rows(1, 4, &[0, 1, 3], &[0, 3], &[]));
    tables.tables.push(rows(1, 3, &[0, 1, 2], &[0, 1, 3], &[5, 6, 7]));
    tables.check(function.function()).unwrap();
    let counted = evaluations(&function, &tables);
    assert_eq!((counted.total, counted.per_node), (9, nodes(&[(5, 3), (6, 3), (7, 3)])));
}

/// A distance that depends on no row: the builder hoists it out of both folds.
fn hoisted(depends_on_outer_row: bool) -> Verified {
    let mut b = FunctionBuilder::new("hoisted", &["x"]);
    let outer = table(&mut b, 1, None, &[]);
    let inner = table(&mut b, 1, Some(outer), &[0]);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let acc = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let scale = if depends_on_outer_row { b.column(outer, 0) } else { x };
    let part = b.begin_fold(inner, (FoldKind::Rows, Rule::Neutral), &[acc])[0];
    b.set_origin(Origin::leaf(0, Part::Distance));
    let distance = b.mul(x, scale);
    b.set_origin(Origin::SHARED);
    let next = b.add(part, distance);
    let part = b.end_fold(&[next])[0];
    let field = b.end_fold(&[part])[0];
    finish(b, field)
}

#[test]
fn a_hoisted_distance_counts_once_for_the_first_active_row_that_it_serves() {
    let mut tables = Tables::default();
    tables.tables.push(rows(1, 3, &[0, 1, 2], &[0, 3], &[]));
    // Outer row 0 owns none that is active, row 1 owns rows 1 and 2, row 2 owns row 3.
    tables.tables.push(rows(1, 4, &[1, 2, 3], &[0, 0, 2, 3], &[5, 6, 7, 8]));

    let function = hoisted(false);
    tables.check(function.function()).unwrap();
    let counted = evaluations(&function, &tables);
    assert_eq!((counted.total, counted.per_node), (1, nodes(&[(6, 1)])));

    let counted = evaluations(&hoisted(true), &tables);
    assert_eq!((counted.total, counted.per_node), (3, nodes(&[(6, 1), (8, 1)])));
}

#[test]
fn a_hoisted_distance_still_runs_where_no_row_is_active() {
    let mut tables = Tables::default();
    tables.tables.push(rows(1, 1, &[], &[0, 0], &[]));
    tables.tables.push(rows(1, 1, &[], &[0, 0], &[5]));
    let counted = evaluations(&hoisted(false), &tables);
    assert_eq!((counted.total, counted.per_node), (1, nodes(&[])));
}

#[test]
fn a_duplicated_distance_counts_twice() {
    let mut b = FunctionBuilder::new("twice", &["x"]);
    let t = table(&mut b, 1, None, &[0]);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let c = b.column(t, 0);
    b.set_origin(Origin::leaf(0, Part::Distance));
    let (first, second) = (b.sub(x, c), b.sub(c, x));
    let product = b.mul(first, second);
    b.set_origin(Origin::SHARED);
    let next = b.add(acc, product);
    let field = b.end_fold(&[next])[0];
    let function = finish(b, field);
    let mut tables = Tables::default();
    tables.tables.push(rows(1, 1, &[0], &[0, 1], &[9]));
    assert_eq!(evaluations(&function, &tables).per_node, nodes(&[(9, 3)]));
}

#[test]
fn a_hundred_thousand_rows_are_counted_without_running_them() {
    let mut b = FunctionBuilder::new("many", &["x"]);
    let t = table(&mut b, 1, None, &[0]);
    let zero = b.constant(0.0);
    let field = sum(&mut b, t, &[0], zero);
    let function = finish(b, field);
    let count = 100_000_u32;
    let all: Vec<u32> = (0..count).collect();
    let mut tables = Tables::default();
    tables.tables.push(rows(1, count as usize, &all, &[0, count], &all));
    let counted = evaluations(&function, &tables);
    assert_eq!((counted.total, counted.per_node.len()), (u64::from(count), count as usize));
}

#[test]
fn the_total_is_what_running_the_function_counts() {
    // All ops of a random function become distances of one slot: then the evaluations are all the ops that
    // run.
    let mut folds = 0;
    for seed in 0..200 {
        let mut function = random::function(seed, 120);
        let mut insts = jbt_ir::Store::new();
        for data in function.insts.values() {
            let mut data = data.clone();
            data.origin = Origin::leaf(0, Part::Distance);
            folds += usize::from(matches!(data.kind, InstKind::Fold(_)));
            insts.push(data);
        }
        function.insts = insts;
        let tables = random::tables(&function, seed);
        if function.tables.is_empty() {
            continue;
        }
        let home = Table::new(function.tables.len() - 1);
        std::sync::Arc::make_mut(&mut function.tables)[home].slots = vec![0];
        let mut tables_with_nodes = tables.clone();
        tables_with_nodes.tables[home].nodes = (0..tables.tables[home].len() as u32).collect();
        tables_with_nodes.check(&function).unwrap();

        let function = verify(function).expect("origins keep the rules");
        let mut counting = Counting::new();
        interpret::run(&function, &tables, &mut counting, &[(); 3]);
        let counted = evaluations(&function, &tables_with_nodes);
        assert_eq!(counted.total, counting.total(), "random function {seed}");
        assert!(counted.per_node.values().sum::<u64>() <= counted.total);
    }
    assert!(folds > 200);
}
