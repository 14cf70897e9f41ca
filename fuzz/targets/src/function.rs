//! IR text: read or refused; what is read prints and reads back, and passes and engines keep its bits.

use std::borrow::Cow;
use std::sync::Arc;

use fastrand::Rng;
use jbt::Engine;
use jbt::internals::ir::domain::scalar::Scalar;
use jbt::internals::ir::engine::BoundProgram;
use jbt::internals::ir::pass::{PIPELINE, legalize, run_pipeline};
use jbt::internals::ir::{
    FoldKind, Function, InstData, InstKind, Level, Rows, Table, Tables, Verified, interpret, parse, verify,
};
use jbt_testkit::bits::assert_same;
use jbt_testkit::points::OPERANDS;

use crate::model::rng;

/// Values, folds, inputs and outputs of a function that runs for one input.
const MAX_VALUES: usize = 400;
const MAX_FOLDS: usize = 7;
const MAX_PLANES: usize = 12;
/// Points that it runs at: more than a block of any engine.
const POINTS: usize = 37;

/// Reads a function, and runs what is read.
pub(crate) fn run(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let function = match parse(text) {
        Ok(function) => function,
        Err(errors) => {
            assert!(!errors.is_empty(), "a refusal has a reason");
            errors.iter().for_each(|error| assert!(error.line > 0 && !error.to_string().is_empty()));
            return;
        }
    };
    let printed = function.to_string();
    match parse(&printed) {
        Ok(again) => assert_eq!(again.to_string(), printed),
        Err(errors) => panic!("{}\n{printed}", errors[0]),
    }
    match verify(function) {
        Ok(verified) if is_small(verified.function()) => compare(&verified, &mut rng(bytes)),
        Ok(_) => {}
        Err(errors) => errors.iter().for_each(|error| assert!(!error.to_string().is_empty())),
    }
}

fn is_small(function: &Function) -> bool {
    let is_fold = |inst: &&InstData| matches!(inst.kind, InstKind::Fold(_));
    function.values.len() <= MAX_VALUES
        && function.insts.values().filter(is_fold).count() <= MAX_FOLDS
        && function.inputs.len() <= MAX_PLANES
        && function.outputs.len() <= MAX_PLANES
        && function.tables.len() <= MAX_FOLDS
}

/// The function whose ops mean something alone: slopes, which no op has alone, are written out.
fn reference(function: &Verified) -> Cow<'_, Verified> {
    let is_slope = |inst: &InstData| matches!(&inst.kind, InstKind::Op { op, .. } if op.is_slope());
    if !function.function().insts.values().any(is_slope) {
        return Cow::Borrowed(function);
    }
    let written = verify(legalize(function.function()));
    Cow::Owned(written.unwrap_or_else(|errors| panic!("slopes keep the rules: {}", errors[0])))
}

/// The bits of all engines against those of the function as it was read.
fn compare(function: &Verified, rng: &mut Rng) {
    let reference = reference(function);
    let tables = tables(function.function(), rng);
    let number = |rng: &mut Rng| match rng.u8(0..3) {
        0 => OPERANDS[rng.usize(0..OPERANDS.len())],
        1 => f32::from_bits(rng.u32(..)),
        _ => rng.f32() * 4.0 - 2.0,
    };
    let inputs: Vec<Vec<f32>> =
        function.function().inputs.iter().map(|_| (0..POINTS).map(|_| number(rng)).collect()).collect();
    let mut expected = vec![vec![0.0; POINTS]; function.function().outputs.len()];
    for point in 0..POINTS {
        let at: Vec<f32> = inputs.iter().map(|plane| plane[point]).collect();
        let answers = interpret::run(&reference, &tables, &mut Scalar, &at);
        expected.iter_mut().zip(answers).for_each(|(plane, answer)| plane[point] = answer);
    }
    let passed = run_pipeline(function.function().clone(), PIPELINE, &mut |_, _| {});
    let passed = verify(passed).unwrap_or_else(|errors| panic!("passes keep the rules: {}", errors[0]));
    let (passed, tables) = (Arc::new(passed), Arc::new(tables));
    for backend in Engine::ALL.into_iter().flat_map(Engine::backends) {
        for level in Level::available().into_iter().filter(|&level| backend.covers(level)) {
            // A function that is beyond a limit of a backend is declined.
            let Ok(program) = backend.compile(&passed, level) else { continue };
            let bound = BoundProgram::new(program, Arc::clone(&tables)).expect("the tables fit");
            let mut planes = vec![vec![-7.0_f32; POINTS]; expected.len()];
            let inputs: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
            let mut views: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
            bound.run(&inputs, &mut views).expect("the planes fit");
            assert_same(&expected, &planes, &format!("{} at {level}", backend.name()));
        }
    }
}

/// Up to two rows of each table for each row of its parent, up to one under a guard.
fn tables(function: &Function, rng: &mut Rng) -> Tables {
    let is_guard = |table: Table| {
        let guards = |kind: &InstKind| matches!(kind, InstKind::Fold(fold) if fold.table == table && fold.kind == FoldKind::Guard);
        function.insts.values().any(|inst| guards(&inst.kind))
    };
    let mut tables = Tables::default();
    for (table, schema) in function.tables.iter() {
        let parents = schema.parent.map_or(1, |parent| tables.tables[parent].len());
        let each = if is_guard(table) { 1 } else { 2 };
        let (stride, rows) = (schema.columns.len(), each * parents);
        let mut active: Vec<u32> = Vec::new();
        let mut starts = vec![0];
        for parent in 0..parents {
            let own = each * parent..each * (parent + 1);
            active.extend(own.filter(|_| rng.u8(0..4) > 0).map(|row| row as u32));
            starts.push(active.len() as u32);
        }
        let numbers = (0..rows * stride).map(|_| rng.f32() * 4.0 - 2.0).collect();
        let nodes = vec![0; rows * schema.slots.len()];
        tables.tables.push(Rows { count: rows, stride, numbers, active, starts, nodes });
    }
    tables
}
