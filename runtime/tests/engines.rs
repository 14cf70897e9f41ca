//! The door of all engines: each of them refuses the same planes, rows and levels in the same way.

use std::sync::Arc;

use jbt::internals::ir::engine::{Backend, BoundProgram, RunError, choose};
use jbt::internals::ir::{
    Domain, FoldKind, FunctionBuilder, Level, Rows, Rule, Schema, Selection, Store, Tables, Verified, verify,
};
use jbt::{CompileError, Compiler, Engine, EvalError, Model, Query, build};

/// The sum over rows of `c * x`, and `y`.
fn function() -> Verified {
    let mut b = FunctionBuilder::new("door", &["x", "y"]);
    let columns = vec!["c".to_owned()];
    let t = b.table(Schema { name: "rows".to_owned(), columns, parent: None, slots: Vec::new() });
    let (x, y, zero) = (b.input(0), b.input(1), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let c = b.column(t, 0);
    let next = b.fma(c, x, acc[0]);
    let out = b.end_fold(&[next]);
    verify(b.finish(&[("sum".to_owned(), out[0]), ("y".to_owned(), y)])).expect("it obeys the rules")
}

/// Rows 1, 2, 3, ...
fn rows(count: u32) -> Tables {
    let mut tables = Store::new();
    tables.push(Rows {
        count: count as usize,
        stride: 1,
        numbers: (1..=count).map(|row| row as f32).collect(),
        active: (0..count).collect(),
        starts: vec![0, count],
        nodes: Vec::new(),
    });
    Tables { tables }
}

/// All backends of all engines, at all levels that this CPU has.
fn backends() -> Vec<(&'static dyn Backend, Level)> {
    let all = Engine::ALL.into_iter().flat_map(Engine::backends).copied();
    let levels = all.flat_map(|backend| Level::available().into_iter().map(move |level| (backend, level)));
    let found: Vec<_> = levels.filter(|(backend, level)| backend.covers(*level)).collect();
    assert!(found.len() >= 3, "{found:?}");
    found
}

fn bind(backend: &dyn Backend, level: Level, tables: Tables) -> BoundProgram {
    let program = backend.compile(&Arc::new(function()), level).expect("this CPU has the level");
    BoundProgram::new(program, Arc::new(tables)).expect("the tables fit")
}

#[test]
fn planes_and_rows_that_do_not_fit_are_one_error_on_every_engine() {
    for (backend, level) in backends() {
        let bound = bind(backend, level, rows(3));
        let foreign = Selection::new(function().function(), &rows(4));
        let plane: &[f32] = &[1.0; 24];
        let (mut a, mut b) = ([7.0_f32; 24], [7.0_f32; 24]);
        let length = |plane, given| RunError::Length { plane, expected: 24, given };
        let cases = [
            (bound.run_selected(&foreign, &[plane; 2], &mut [&mut a, &mut b]), RunError::Selection),
            (bound.run_selected(&foreign, &[plane], &mut []), RunError::Selection),
            (bound.run(&[plane], &mut [&mut a, &mut b]), RunError::Inputs { expected: 2, given: 1 }),
            (bound.run(&[plane; 3], &mut [&mut a, &mut b]), RunError::Inputs { expected: 2, given: 3 }),
            (bound.run(&[plane; 2], &mut [&mut a]), RunError::Outputs { expected: 2, given: 1 }),
            (bound.run(&[plane; 2], &mut []), RunError::Outputs { expected: 2, given: 0 }),
            (bound.run(&[plane, &plane[..16]], &mut [&mut a, &mut b]), length(1, 16)),
            (bound.run(&[plane; 2], &mut [&mut a, &mut b[..8]]), length(3, 8)),
            (bound.run(&[plane; 2], &mut [&mut a[..0], &mut b]), length(2, 0)),
        ];
        for (given, expected) in cases {
            assert_eq!(given, Err(expected), "{} at {level}", backend.name());
        }
        assert_eq!((a, b), ([7.0; 24], [7.0; 24]), "{} at {level} has written", backend.name());
    }
}

#[test]
fn every_engine_takes_any_number_of_points() {
    for (backend, level) in backends() {
        let bound = bind(backend, level, rows(3));
        for points in (0..70).chain([511, 512, 513]) {
            let x: Vec<f32> = (0..points).map(|point| point as f32).collect();
            let (mut sum, mut y) = (vec![-1.0; points], vec![-1.0; points]);
            bound.run(&[&x, &x], &mut [&mut sum, &mut y]).expect("the planes fit");
            let expected: Vec<f32> = x.iter().map(|x| 6.0 * x).collect();
            assert_eq!((&sum, &y), (&expected, &x), "{points} points by {} at {level}", backend.name());
        }
    }
}

#[test]
fn tables_that_do_not_fit_are_refused_by_every_engine() {
    for (backend, level) in backends() {
        let program = backend.compile(&Arc::new(function()), level).expect("this CPU has the level");
        assert!(BoundProgram::new(program, Arc::default()).is_err(), "{}", backend.name());
    }
}

/// What the door says becomes what evaluators say.
#[test]
fn evaluators_tell_the_same() {
    let tree = Model::new(build::point([0, 0, 0], 1)).check().expect("it is a model");
    for engine in Engine::ALL.into_iter().filter(|engine| !engine.backends().is_empty()) {
        let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::FIELD).expect("it compiles");
        let (plane, mut field, mut more) = ([0.5_f32; 5], [0.0; 5], [0.0; 5]);
        let planes = evaluator.eval_planes([&plane; 3], &mut [&mut field, &mut more]);
        assert_eq!(planes, Err(EvalError::Planes { expected: 1, given: 2 }), "{engine}");
        let length = evaluator.eval_planes([&plane; 3], &mut [&mut field[..4]]);
        assert_eq!(length, Err(EvalError::Length { expected: 5, given: 4 }), "{engine}");
    }
}

#[test]
fn levels_that_the_cpu_lacks_are_one_error_on_every_engine() {
    let tree = Model::new(build::point([0, 0, 0], 1)).check().expect("it is a model");
    for level in Level::ALL {
        for engine in Engine::ALL {
            if let Some(backend) = choose(engine.backends(), level) {
                assert_eq!(backend.supports(level).is_ok(), level.is_available(), "{}", backend.name());
            }
            let made = Compiler::for_engine(engine).at_level(level).evaluator(&tree, Query::FIELD);
            if let Err(missing) = level.require() {
                let Err(CompileError::Engine { reason, .. }) = made else { panic!("{engine} at {level}") };
                assert_eq!(reason, missing.to_string());
            }
        }
    }
}
