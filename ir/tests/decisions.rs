//! Signatures: each side of each row of a union has its own; and their code grows with the columns and the
//! marked ops, not with the product of both.

use jbt_ir::domain::scalar::Scalar;
use jbt_ir::interpret::run;
use jbt_ir::pass::{PIPELINE, decisions, run_pipeline};
use jbt_ir::{
    Domain, FoldKind, Function, FunctionBuilder, Origin, Rows, Rule, Schema, Tables, Verified, verify,
};

/// The union of rows, each of which is the intersection of as many half-spaces as a row has numbers. The
/// field of the row that wins is chosen by a `select`, or is a `max`.
fn union(columns: usize, by_select: bool) -> Function {
    let mut b = FunctionBuilder::new("union", &["x", "y", "z"]);
    let names = (0..columns).map(|column| format!("c{column}")).collect();
    let schema = Schema { name: "row".into(), columns: names, parent: None, slots: vec![] };
    let table = b.table(schema);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let united = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    b.set_origin(Origin::CREASE);
    let first = b.column(table, 0);
    let mut within = b.sub(first, x);
    for column in 1..columns {
        let number = b.column(table, column);
        let side = if column % 2 == 0 { b.sub(number, x) } else { b.add(number, x) };
        within = b.min(within, side);
    }
    let next = if by_select {
        let takes = b.lt(united, within);
        b.select(takes, within, united)
    } else {
        b.max(within, united)
    };
    b.set_origin(Origin::SHARED);
    let union = b.end_fold(&[next])[0];
    b.finish(&[("field".to_owned(), union)])
}

fn tables(rows: &[[f32; 4]]) -> Tables {
    let mut tables = Tables::default();
    let count = rows.len() as u32;
    let (active, starts) = ((0..count).collect(), vec![0, count]);
    let numbers = rows.concat().into_iter().collect();
    tables.tables.push(Rows { count: rows.len(), stride: 4, numbers, starts, active, nodes: vec![] });
    tables
}

/// Field and signature at points of the x-axis.
fn signatures(function: &Verified, rows: &[[f32; 4]], points: &[f32]) -> Vec<(f32, f32)> {
    let of = |&x: &f32| {
        let answers = run(function, &tables(rows), &mut Scalar, &[x, 0.0, 0.0]);
        (answers[0], answers[1])
    };
    points.iter().map(of).collect()
}

#[test]
fn each_side_of_each_row_has_a_signature() {
    // Segments [-c1, c0] and [-c3, c2] of the x-axis: both must hold.
    let [left, right] = [[-1.0, 3.0, 9.0, 9.0], [3.0, -1.0, 9.0, 9.0]];
    let points = [-2.75, -2.5, -1.5, -1.25, 1.25, 1.5, 2.5, 2.75];
    for by_select in [false, true] {
        let plain = decisions(&union(4, by_select)).expect("it has edges");
        let function = verify(run_pipeline(plain, PIPELINE, &mut |_, _| {})).expect("it keeps the rules");
        let found = signatures(&function, &[left, right], &points);
        for (at, &(value, signature)) in points.iter().zip(&found) {
            assert_eq!(value, 1.0 - (at.abs() - 2.0).abs(), "at {at}");
            assert!((1.0..2.0).contains(&signature), "at {at}: {signature}");
        }
        // Two points on each side have one signature, and sides have different ones.
        for pair in found.chunks_exact(2) {
            assert_eq!(pair[0].1, pair[1].1);
        }
        let sides: Vec<u32> = found.iter().step_by(2).map(|(_, signature)| signature.to_bits()).collect();
        for (n, side) in sides.iter().enumerate() {
            assert!(!sides[..n].contains(side), "sides {sides:?} of two rows");
        }
        assert_eq!(signatures(&function, &[right, left], &points), found, "rows the other way round");
        let beside = [[0.0, -9.0, 1.0, 1.0], left, [0.5, -9.0, 1.0, 1.0], right];
        assert_eq!(signatures(&function, &beside, &points), found, "with rows that are 0 there");
    }
}

#[test]
fn code_grows_with_columns_and_marked_ops() {
    let added = |columns: usize| {
        let function = union(columns, false);
        let with = decisions(&function).expect("it has edges");
        run_pipeline(with, PIPELINE, &mut |_, _| {}).insts.len() - function.insts.len()
    };
    let [few, many] = [added(16), added(64)];
    assert!(many <= 4 * few, "{few} instructions for 16 columns, {many} for 64");
}

/// The sum of two unions in one fold, beside a sum that nothing decides. A row of the second union is 0
/// beyond its first number, on both sides of its second.
fn two_unions() -> Function {
    let mut b = FunctionBuilder::new("two", &["x", "y", "z"]);
    let names = (0..4).map(|column| format!("c{column}")).collect();
    let table = b.table(Schema { name: "row".into(), columns: names, parent: None, slots: vec![] });
    let (x, zero) = (b.input(0), b.constant(0.0));
    let accumulators = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero, zero, zero]);
    let [count, first, second] = [0, 1, 2].map(|place| accumulators[place]);
    let columns = [0, 1, 2, 3].map(|column| b.column(table, column));
    let count = b.add(count, columns[0]);
    b.set_origin(Origin::CREASE);
    let sides = [b.sub(columns[0], x), b.add(columns[1], x)];
    let within = b.min(sides[0], sides[1]);
    let first = b.max(first, within);
    let (beyond, from) = (b.sub(columns[2], x), b.sub(x, columns[3]));
    let (near, away) = (b.max(beyond, zero), b.abs(from));
    let term = b.mul(near, away);
    let second = b.max(second, term);
    b.set_origin(Origin::SHARED);
    let results = b.end_fold(&[count, first, second]);
    let sum = b.add(results[1], results[2]);
    let function = b.finish(&[("field".to_owned(), sum), ("count".to_owned(), results[0])]);
    verify(function).expect("it keeps the rules").into_function()
}

#[test]
fn what_is_0_does_not_count() {
    let plain = decisions(&two_unions()).expect("it has edges");
    let function = verify(plain).expect("it keeps the rules");
    // The first union is 1 - x to the right of 0; the second is 0 beyond 0.5, with another side beyond 0.75.
    let rows = [[1.0, 1.0, 0.5, 0.75]];
    let found = signatures(&function, &rows, &[0.55, 0.7, 0.8, 0.9, -0.25, -0.5, 0.25]);
    let signature: Vec<f32> = found.iter().map(|&(_, signature)| signature).collect();
    assert_eq!(signature[..4], [signature[0]; 4], "one side of the first union, and the second is 0");
    assert_eq!(signature[4], signature[5], "both unions, on one side of each");
    assert_ne!(signature[0], signature[6], "the second union is no longer 0");
    assert_ne!(signature[4], signature[6], "the first union has another side");
}

#[test]
fn what_nothing_decides_has_no_signature() {
    let before = two_unions();
    let with = decisions(&before).expect("it has edges");
    let accumulators =
        |function: &Function| -> usize { function.blocks.values().map(|block| block.params.len()).sum() };
    assert_eq!((accumulators(&before), accumulators(&with)), (3, 5), "a signature for each union alone");
}

#[test]
fn what_is_0_counts_outside_of_folds() {
    // 0 beyond 0.5, on both sides of 0.75; both may be on the surface of the sum.
    for fused in [false, true] {
        let mut b = FunctionBuilder::new("sum", &["x", "y", "z"]);
        let (x, y, zero) = (b.input(0), b.input(1), b.constant(0.0));
        let [end, middle] = [0.5, 0.75].map(|number| b.constant(number));
        b.set_origin(Origin::CREASE);
        let (beyond, from) = (b.sub(end, x), b.sub(x, middle));
        let (near, away) = (b.max(beyond, zero), b.abs(from));
        b.set_origin(Origin::SHARED);
        let sum = if fused {
            b.fma(near, away, y)
        } else {
            let product = b.mul(near, away);
            b.add(product, y)
        };
        let plain = decisions(&b.finish(&[("field".to_owned(), sum)])).expect("it has edges");
        let function = verify(plain).expect("it keeps the rules");
        let found = signatures(&function, &[], &[0.55, 0.7, 0.8, 0.9]);
        let signature: Vec<f32> = found.iter().map(|&(_, signature)| signature).collect();
        assert_eq!((signature[0], signature[2]), (signature[1], signature[3]));
        assert_ne!(signature[0], signature[2]);
    }
}
