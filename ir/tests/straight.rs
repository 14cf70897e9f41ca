//! Straight code gives the bits of the folds that it was made from, and its tables follow theirs or refuse.

mod common;

use common::random;
use jbt_ir::domain::counting::{Counting, evaluations};
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::interpret;
use jbt_ir::pass::{GRADIENT, PIPELINE, run_pipeline};
use jbt_ir::{Entity, Function, InstKind, Rows, Straight, Table, Tables, Verified, parse, verify};

fn verified(function: &Function) -> Verified {
    verify(function.clone()).expect("the function obeys the rules")
}

/// The bits of the answers at a point; all NaNs are one.
fn bits(function: &Verified, tables: &Tables, at: &[f32]) -> Vec<u32> {
    tables.check(function.function()).expect("the tables fit");
    let answers = interpret::run(function, tables, &mut Scalar, at);
    answers.into_iter().map(|x| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() }).collect()
}

/// Makes every row active: row-major, an equal share for each row of the parent.
fn activate(function: &Function, tables: &mut Tables) {
    let schemas: Vec<_> = function.tables.iter().map(|(table, schema)| (table, schema.parent)).collect();
    for (table, parent) in schemas {
        let parents = parent.map_or(1, |parent| tables.tables[parent].len());
        let rows = &mut tables.tables[table];
        rows.active = (0..rows.count as u32).collect();
        rows.starts = (0..=parents).map(|p| (p * rows.count / parents.max(1)) as u32).collect();
        rows.starts[0] = 0;
    }
}

/// One row for the first table.
fn single(tables: &mut Tables) {
    let rows = &mut tables.tables[Table::new(0)];
    if rows.count == 0 {
        return;
    }
    rows.active = vec![0];
    rows.starts = vec![0, 1];
}

#[test]
fn random_functions_keep_their_bits() {
    let (mut made, mut folds) = (0, 0);
    for seed in 0..600 {
        let function = random::function(seed, 120);
        if function.tables.is_empty() {
            continue;
        }
        let mut tables = random::tables(&function, seed);
        if seed % 3 > 0 {
            activate(&function, &mut tables);
        }
        single(&mut tables);
        let Some(straight) = Straight::if_worth(&function, &tables, f64::INFINITY) else { continue };
        made += 1;
        folds += usize::from(straight.function().tables.len() > 1);
        let own = straight.tables(&tables).expect("it was made for these");
        let (before, after) = (verified(&function), verified(straight.function()));
        let optimised = verified(&run_pipeline(straight.function().clone(), PIPELINE, &mut |_, _| {}));
        let mut rng = fastrand::Rng::with_seed(seed);
        for _ in 0..5 {
            let at: Vec<f32> = (0..3).map(|_| random::number(&mut rng)).collect();
            let known = bits(&before, &tables, &at);
            assert_eq!(known, bits(&after, &own, &at), "seed {seed} at {at:?}");
            assert_eq!(known, bits(&optimised, &own, &at), "seed {seed} at {at:?}, optimised");
        }
    }
    assert!(made > 60 && folds > 20, "{made} functions had straight code, {folds} of them folds as well");
}

/// A union of planes: three ops of the first number, two more of both.
fn planes() -> Function {
    with_points("", "")
}

/// The same, and after it more code and another table. That code makes v13 of v4, v0 and what the tables
/// hold.
fn with_points(table: &str, code: &str) -> Function {
    let code = if code.is_empty() { "v13 = stop_gradient v4" } else { code };
    let text = format!(
        r#"function "union" (x, y, z) -> (field) {{
    table t0 "scene" (iso2)
    table t1 "plane" (a, b) in t0
    {table}
block0:
    v0 = input x
    v1 = const 0.0
    v2 = fold t0 guard neutral (v1) block1(v3):
        v4 = fold t1 rows neutral (v3) block2(v5):
            v6 = column t1.a
            v7 = mul v0, v6
            v8 = sqrt v7
            v9 = mul v8, v8
            v10 = column t1.b
            v11 = add v9, v10
            v12 = max v5, v11
            yield v12
        {code}
        v14 = column t0.iso2
        v15 = add v13, v14
        yield v15
    yield v2
}}
"#
    );
    let lines: String =
        text.lines().filter(|line| !line.trim().is_empty()).map(|l| format!("{l}\n")).collect();
    parse(&lines).unwrap_or_else(|errors| panic!("{errors:?}"))
}

fn table(stride: usize, numbers: &[f32], starts: &[u32]) -> Rows {
    let count = numbers.len() / stride;
    Rows {
        count,
        stride,
        numbers: numbers.to_vec(),
        active: (0..count as u32).collect(),
        starts: starts.to_vec(),
        nodes: Vec::new(),
    }
}

fn three(numbers: &[f32]) -> Tables {
    let mut tables = Tables::default();
    tables.tables.push(table(1, &[0.5], &[0, 1]));
    tables.tables.push(table(2, numbers, &[0, numbers.len() as u32 / 2]));
    tables
}

fn ops(function: &Function, tables: &Tables) -> u64 {
    let mut counting = Counting::new();
    interpret::run(&verified(function), tables, &mut counting, &[(); 3].map(|()| Default::default()));
    counting.total()
}

#[test]
fn equal_numbers_are_one_column_and_their_work_is_done_once() {
    let function = planes();
    let tables = three(&[2.0, 1.0, 2.0, 3.0, 2.0, 5.0]);
    let straight = Straight::new(&function, &tables).expect("two thirds are saved");
    let made = straight.function();
    assert_eq!(made.tables.len(), 1);
    let root = &made.tables.values().next().unwrap().columns;
    assert_eq!(root, &["a", "b", "b", "b", "iso2"]);
    let folds = made.insts.values().filter(|data| matches!(data.kind, InstKind::Fold(_))).count();
    assert_eq!(folds, 1);
    let own = straight.tables(&tables).unwrap();
    // Three ops once, two for each row, and two for the scene.
    assert_eq!((ops(&function, &tables), ops(made, &own)), (17, 11));
    for x in [-1.0, 0.0, 0.25, 7.0] {
        let at = [x, 0.0, 0.0];
        assert_eq!(bits(&verified(&function), &tables, &at), bits(&verified(made), &own, &at));
    }
    let gradient = run_pipeline(made.clone(), [&GRADIENT].into_iter().chain(PIPELINE), &mut |_, _| {});
    verified(&gradient);
}

#[test]
fn what_shares_nothing_stays_folds() {
    let tables = three(&[2.0, 1.0, 3.0, 4.0, 5.0, 6.0]);
    assert!(Straight::new(&planes(), &tables).is_none());
    assert!(Straight::if_worth(&planes(), &tables, f64::INFINITY).is_some());
}

#[test]
fn many_rows_stay_rows() {
    let many = |rows: usize| three(&[1.0, 2.0].repeat(rows));
    assert!(Straight::new(&planes(), &many(64)).is_some());
    assert!(Straight::new(&planes(), &many(65)).is_none());
}

#[test]
fn tables_follow_edits_that_change_neither_rows_nor_what_is_equal() {
    let function = planes();
    let straight = Straight::new(&function, &three(&[2.0, 1.0, 2.0, 3.0, 2.0, 5.0])).unwrap();
    // All that is shared moves together; the others may do as they like, and be equal too.
    for numbers in [[9.0, 1.0, 9.0, 3.0, 9.0, 5.0], [2.0, 7.0, 2.0, 7.0, 2.0, 7.0]] {
        let tables = three(&numbers);
        let own = straight.tables(&tables).expect("the numbers that share a column are equal");
        let at = [0.3, 0.0, 0.0];
        let after = bits(&verified(straight.function()), &own, &at);
        assert_eq!(bits(&verified(&function), &tables, &at), after);
    }
    assert!(straight.tables(&three(&[2.0, 1.0, 2.5, 3.0, 2.0, 5.0])).is_none(), "one of the shared moved");
    assert!(straight.tables(&three(&[2.0, 1.0, 2.0, 3.0])).is_none(), "a row less");
    assert!(straight.tables(&three(&[-0.0, 1.0, 0.0, 3.0, 0.0, 5.0])).is_none(), "zeros have signs");
}

#[test]
fn a_number_that_moved_stays_in_a_column_of_its_own() {
    let function = planes();
    let first = Straight::new(&function, &three(&[2.0, 1.0, 2.0, 3.0, 2.0, 5.0])).unwrap();
    let moved = three(&[2.0, 1.0, 2.5, 3.0, 2.0, 5.0]);
    let second = first.again(&function, &moved).expect("two rows still share");
    let back = three(&[2.0, 1.0, 2.0, 3.0, 2.0, 5.0]);
    let third = second.again(&function, &back).unwrap();
    assert_eq!(second.function(), third.function(), "what has moved once is not shared again");
    assert!(third.tables(&moved).is_some());
}

#[test]
fn rows_of_primitives_stay_rows_and_keep_their_counts() {
    let code = "v13 = fold t2 rows neutral (v4) block3(v16):
            v17 = column t2.c
            v18 = mul v0, v17 @0.distance
            v19 = add v16, v18
            yield v19";
    let function = with_points("table t2 \"point\" (c) in t0 slots (0)", code);
    let mut tables = three(&[2.0, 1.0, 2.0, 3.0, 2.0, 5.0]);
    let points = Rows { nodes: vec![7, 8], ..table(1, &[1.0, 1.0], &[0, 2]) };
    tables.tables.push(points);
    let straight = Straight::new(&function, &tables).unwrap();
    let own = straight.tables(&tables).unwrap();
    assert_eq!(straight.function().tables.len(), 2);
    let (before, after) = (verified(&function), verified(straight.function()));
    assert_eq!(bits(&before, &tables, &[0.3, 0.0, 0.0]), bits(&after, &own, &[0.3, 0.0, 0.0]));
    assert_eq!(evaluations(&before, &tables), evaluations(&after, &own));
}
