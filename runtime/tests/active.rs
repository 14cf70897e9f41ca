//! Leaving a row out gives the bits that running it gives, where the row adds nothing: what pruning will rest
//! on.

use jbt::internals::ir::domain::scalar::Scalar;
use jbt::internals::ir::{Entity, FoldKind, Rule, Tables, interpret};
use jbt::{Compiler, Engine, Evaluator, Query};
use jbt_testkit::scene::tree;

/// A sum and a Ricci blend of points and segments with colours, strengths of both signs and another
/// attribute.
fn scene(rng: &mut fastrand::Rng, operator: &str) -> String {
    let mut number = |low: f64, high: f64| low + (high - low) * rng.f64();
    let mut parts = String::new();
    for index in 0..12 {
        let at: [f64; 3] = std::array::from_fn(|_| number(-1.0, 1.0));
        let color: [f64; 3] = std::array::from_fn(|_| number(-1.0, 1.0));
        let strength = if index % 4 == 3 { -0.4 } else { 1.0 };
        let skeleton = if index % 3 == 0 {
            format!("segment {{ from ({} {} {}) to (0 0 0)", at[0], at[1], at[2])
        } else {
            format!("point {{ at ({} {} {})", at[0], at[1], at[2])
        };
        parts += &format!(
            "color ({} {} {}) {{ heat {} {{ {skeleton} radius {} strength {strength} }} }} }}\n",
            color[0],
            color[1],
            color[2],
            number(-1.0, 1.0),
            number(0.2, 0.8)
        );
    }
    format!("jbt 1 attribute heat 1 default 0.5 dominant {operator} {{ {parts} }}")
}

fn answers(evaluator: &Evaluator, tables: &Tables, point: [f32; 3]) -> Vec<u32> {
    let answers = interpret::run(evaluator.program(), tables, &mut Scalar, &point);
    answers.into_iter().map(f32::to_bits).collect()
}

/// The tables without the rows that are neutral where they are zero, and whose leaf is out of reach of the
/// point.
fn reduced(evaluator: &Evaluator, point: [f32; 3]) -> (Tables, usize) {
    let function = evaluator.program().function();
    let mut tables = evaluator.tables().clone();
    let mut dropped = 0;
    for (table, fold) in function.tables.keys().zip(function.folds()) {
        let Some(fold) = fold else { continue };
        let jbt::internals::ir::InstKind::Fold(fold) = &function.insts[fold].kind else { continue };
        if (fold.kind, fold.rule) != (FoldKind::Rows, Rule::Neutral) {
            continue;
        }
        let schema = &function.tables[table];
        let column = |name: &str| schema.columns.iter().position(|column| column == name);
        let rows = &mut tables.tables[table];
        let all = std::mem::take(&mut rows.active);
        for &row in &all {
            let numbers = rows.row(row as usize).to_vec();
            let get = |name: &str| column(name).map_or(0.0, |index| f64::from(numbers[index]));
            // The point in the pose of the skeleton, which lies along the z axis; a point has no length.
            let p = point.map(f64::from);
            let row_of = |axis: &str| ["x", "y", "z", "t"].map(|of| get(&format!("{axis}{of}")));
            let there: [f64; 3] = if column("xx").is_some() {
                ["x", "y", "z"].map(row_of).map(|[x, y, z, t]| x * p[0] + y * p[1] + z * p[2] + t)
            } else {
                let at = ["tx", "ty", "tz"].map(get);
                std::array::from_fn(|k| p[k] - at[k])
            };
            let [x, y, z] = there;
            let square = x * x + y * y + (z.abs() - get("half")).max(0.0).powi(2);
            if 1.0 + square * get("neg_inv_r2") > -1e-3 {
                rows.active.push(row);
            } else {
                dropped += 1;
            }
        }
        assert_eq!(rows.starts, [0, all.len() as u32], "{table} hangs under the one row of the scene");
        rows.starts[1] = rows.active.len() as u32;
    }
    tables.check(function).expect("fewer rows fit as well");
    assert!(function.tables.keys().all(|table| table.index() < tables.tables.len()));
    (tables, dropped)
}

#[test]
fn rows_that_add_nothing_change_no_bit() {
    let mut rng = fastrand::Rng::with_seed(9);
    let (mut dropped, mut points) = (0, 0);
    for operator in ["sum", "blend ricci 2", "blend ricci 3.5", "blend ricci 7"] {
        for _ in 0..10 {
            let text = scene(&mut rng, operator);
            let tree = tree(&text);
            let evaluator =
                Compiler::for_engine(Engine::Scalar).evaluator(&tree, Query::ALL).expect("it compiles");
            for _ in 0..60 {
                let mut point: [f32; 3] = std::array::from_fn(|_| 2.4 * rng.f32() - 1.2);
                if rng.bool() {
                    point[rng.usize(0..3)] = 0.0;
                }
                let (tables, out) = reduced(&evaluator, point);
                dropped += out;
                points += 1;
                assert_eq!(
                    answers(&evaluator, evaluator.tables(), point),
                    answers(&evaluator, &tables, point),
                    "{point:?}, {out} rows out of reach\n{text}"
                );
            }
        }
    }
    assert!(dropped > 5 * points, "most rows are out of reach: {dropped} at {points} points");
}
