//! The verifier: functions that break rules in ways that no text can say, and functions broken at random.

mod common;

use std::sync::Arc;

use common::sample;
use fastrand::Rng;
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::limits::{MAX_FOLD_DEPTH, MAX_TABLES, MAX_VALUES};
use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::text::annotated;
use jbt_ir::{
    Block, BlockData, Domain as _, Entity, Fold, FoldKind, Function, FunctionBuilder, Inst, InstData,
    InstKind, Op, Origin, Place, Results, Rule, Schema, Table, Type, Value, Values, VerifyError, interpret,
    parse, verify,
};
use smallvec::SmallVec;

/// `f(x) = x + x`, with one instruction for each.
fn double() -> Function {
    parse("function \"f\" (x) -> (a) {\nblock0:\nv0 = input x\nv1 = add v0, v0\nyield v1\n}")
        .expect("it reads")
}

/// The errors of a function, as rule and place.
fn errors(function: Function) -> Vec<(u32, Place)> {
    let errors = verify(function).err().unwrap_or_default();
    errors.into_iter().map(|VerifyError { rule, place, .. }| (rule, place)).collect()
}

#[test]
fn a_good_function_comes_out_as_it_went_in() {
    let verified = verify(double()).expect("it obeys every rule");
    assert_eq!(verified.function(), &double());
    assert_eq!(verified.into_function(), double());
}

#[test]
fn an_instruction_stands_in_one_place() {
    let mut function = double();
    let body = function.body;
    let twice = function.blocks[body].insts[0];
    function.blocks[body].insts.push(twice);
    assert_eq!(errors(function), [(1, Place::Inst(twice))]);

    let mut function = double();
    let nowhere = function.blocks[body].insts.pop().expect("there are two");
    assert_eq!(errors(function), [(3, Place::Yield(body)), (1, Place::Inst(nowhere)), (2, Place::Function)]);

    let mut function = double();
    function.blocks[body].insts.push(Inst::new(77));
    assert_eq!(errors(function), [(1, Place::Inst(Inst::new(77)))]);
}

#[test]
fn a_block_is_the_body_of_something() {
    let mut function = double();
    let block = function.blocks.push(BlockData::default());
    assert_eq!(errors(function), [(1, Place::Block(block))]);
}

#[test]
fn errors_of_what_does_not_print_follow_the_text() {
    let mut function = double();
    function.blocks.push(BlockData::default());
    function.blocks[Block::new(0)].insts.push(Inst::new(77));
    let found = verify(function.clone()).expect_err("it is broken");
    let text = annotated(&function, &found);
    assert!(text.contains("    ; inst77 does not exist ;! rule 1: inst77 does not exist\n"), "{text}");
    assert!(text.ends_with("}\n;! block1: rule 1: it is the body of no fold\n"), "{text}");
}

/// Declares a table without columns.
fn add_table(function: &mut Function) -> Table {
    Arc::make_mut(&mut function.tables).push(Schema {
        name: String::new(),
        columns: vec![],
        parent: None,
        slots: vec![],
    })
}

/// Adds a constant to the function's body.
fn add_constant(function: &mut Function) {
    let value = function.values.push(Type::Real);
    let data = InstData {
        kind: InstKind::Constant(1.0),
        results: Results::from_slice(&[value]),
        origin: Origin::SHARED,
    };
    let inst = function.insts.push(data);
    function.blocks[function.body].insts.push(inst);
}

#[test]
fn the_number_of_tables_is_limited() {
    let mut function = Function::new("f", &[]);
    while function.tables.len() < MAX_TABLES {
        add_table(&mut function);
    }
    let mut function = verify(function).expect("the limit itself is allowed").into_function();
    add_table(&mut function);
    assert_eq!(errors(function), [(14, Place::Function)]);
}

#[test]
fn the_number_of_values_is_limited() {
    let mut function = Function::new("f", &[]);
    while function.values.len() < MAX_VALUES {
        add_constant(&mut function);
    }
    let mut function = verify(function).expect("the limit itself is allowed").into_function();
    add_constant(&mut function);
    assert_eq!(errors(function), [(14, Place::Function)]);
}

#[test]
fn what_grows_beyond_the_limit_grows_no_further() {
    // A sine becomes some 40 values, so these would become 1.6 million.
    let mut b = FunctionBuilder::new("sines", &["x", "y"]);
    let (x, y) = (b.input(0), b.input(1));
    let t = b.table(Schema { name: "t".into(), columns: vec!["c".into()], parent: None, slots: vec![] });
    let mut outside = x;
    for _ in 0..20_000 {
        outside = b.sin(outside);
    }
    let mut inside = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[y])[0];
    let column = b.column(t, 0);
    for _ in 0..20_000 {
        let sine = b.sin(inside);
        let less = b.lt(sine, column);
        inside = b.select(less, sine, inside);
    }
    let folded = b.end_fold(&[inside])[0];
    let sum = b.add(outside, folded);
    let function = b.finish(&[("field".to_owned(), sum)]);
    assert!(function.values.len() < MAX_VALUES);
    let mut ran = Vec::new();
    let made = run_pipeline(function, PIPELINE, &mut |pass, _| ran.push(pass.to_owned()));
    assert!((MAX_VALUES + 1..MAX_VALUES + 10).contains(&made.values.len()), "{}", made.values.len());
    assert_eq!(ran, ["legalize"], "there is nothing to do for the other passes");
    assert!(errors(made).contains(&(14, Place::Function)));
}

/// Folds in each other.
fn nested(depth: usize) -> Function {
    let mut function = Function::new("f", &[]);
    let mut block = function.body;
    for _ in 0..depth {
        let table = add_table(&mut function);
        let body = function.blocks.push(BlockData::default());
        let fold = Fold { table, kind: FoldKind::Guard, rule: Rule::Neutral, initial: Values::new(), body };
        let data = InstData {
            kind: InstKind::Fold(Box::new(fold)),
            results: Results::new(),
            origin: Origin::SHARED,
        };
        let inst = function.insts.push(data);
        function.blocks[block].insts.push(inst);
        block = body;
    }
    function
}

#[test]
fn the_depth_of_folds_is_limited() {
    assert_eq!(errors(nested(MAX_FOLD_DEPTH)), []);
    assert_eq!(errors(nested(MAX_FOLD_DEPTH + 1)), [(14, Place::Inst(Inst::new(MAX_FOLD_DEPTH)))]);
    assert_eq!(errors(nested(50_000)), [(14, Place::Inst(Inst::new(MAX_FOLD_DEPTH)))]);
    let text = nested(5_000).to_string();
    assert_eq!(text.lines().filter(|line| line.contains("fold ")).count(), 5_000, "it prints nevertheless");
}

/// An index that is sometimes wild.
fn any<E: Entity>(rng: &mut Rng, count: usize) -> E {
    match rng.u32(0..12) {
        0 => E::new(count),
        1 => E::new(u32::MAX as usize - 1),
        _ => E::new(rng.usize(0..count.max(1))),
    }
}

/// Changes an element of a list of values, or its length.
fn damage_list<const N: usize>(rng: &mut Rng, list: &mut SmallVec<[Value; N]>, values: usize)
where
    [Value; N]: smallvec::Array<Item = Value>,
{
    let at = rng.usize(0..=list.len());
    match rng.u32(0..4) {
        0 => list.insert(at, any(rng, values)),
        1 if at < list.len() => _ = list.remove(at),
        _ if at < list.len() => list[at] = any(rng, values),
        _ => {}
    }
}

fn damage_inst(rng: &mut Rng, function: &mut Function) {
    let (values, tables, blocks) = (function.values.len(), function.tables.len(), function.blocks.len());
    let inst = Inst::new(rng.usize(0..function.insts.len()));
    let data = &mut function.insts[inst];
    if rng.u32(0..5) == 0 {
        return damage_list(rng, &mut data.results, values);
    }
    match &mut data.kind {
        InstKind::Input(index) => *index = rng.usize(0..5),
        InstKind::Constant(_) => data.kind = InstKind::BitsConstant(1),
        InstKind::BitsConstant(_) => data.kind = InstKind::Constant(1.0),
        InstKind::Column { table, column } => {
            *table = any(rng, tables);
            *column = rng.usize(0..5);
        }
        InstKind::Op { op, args } => match rng.bool() {
            true => *op = *rng.choice(Op::ALL).expect("there are ops"),
            false => damage_list(rng, args, values),
        },
        InstKind::Fold(fold) => match rng.u32(0..3) {
            0 => fold.table = any(rng, tables),
            1 => fold.body = any(rng, blocks),
            _ => damage_list(rng, &mut fold.initial, values),
        },
    }
}

fn damage_block(rng: &mut Rng, function: &mut Function) {
    let (values, insts) = (function.values.len(), function.insts.len());
    let block = Block::new(rng.usize(0..function.blocks.len()));
    let data = &mut function.blocks[block];
    match rng.u32(0..6) {
        0 => damage_list(rng, &mut data.params, values),
        1 => damage_list(rng, &mut data.results, values),
        kind if !data.insts.is_empty() => {
            let (a, b) = (rng.usize(0..data.insts.len()), rng.usize(0..data.insts.len()));
            match kind {
                2 => data.insts.swap(a, b),
                3 => drop(data.insts.remove(a)),
                4 => data.insts[a] = any(rng, insts),
                _ => {
                    let moved = data.insts.remove(a);
                    let to = Block::new(rng.usize(0..function.blocks.len()));
                    let at = rng.usize(0..=function.blocks[to].insts.len());
                    function.blocks[to].insts.insert(at, moved);
                }
            }
        }
        _ => {}
    }
}

fn damage_declarations(rng: &mut Rng, function: &mut Function) {
    let (tables, blocks) = (function.tables.len(), function.blocks.len());
    match rng.u32(0..6) {
        0 => drop(function.inputs.pop()),
        1 => drop(function.outputs.pop()),
        2 => function.body = any(rng, blocks),
        3 => {
            let value = Value::new(rng.usize(0..function.values.len()));
            function.values[value] = rng.choice(Type::ALL).expect("there are types");
        }
        kind => {
            let schema = &mut Arc::make_mut(&mut function.tables)[Table::new(rng.usize(0..tables))];
            match kind {
                4 => schema.parent = rng.bool().then(|| any(rng, tables)),
                _ => drop(schema.columns.pop()),
            }
        }
    }
}

/// Whatever is done to a function: either the verifier reports it, or the function runs. It also prints in
/// any case.
#[test]
fn a_broken_function_is_refused_or_runs() {
    let (mut refused, mut ran) = (0, 0);
    for seed in 0..4000 {
        let mut rng = Rng::with_seed(seed);
        let mut function = sample::function(&mut rng);
        for _ in 0..rng.usize(1..3) {
            match rng.u32(0..4) {
                0 | 1 => damage_inst(&mut rng, &mut function),
                2 => damage_block(&mut rng, &mut function),
                _ => damage_declarations(&mut rng, &mut function),
            }
        }
        let printed = function.to_string();
        match verify(function.clone()) {
            Ok(verified) => {
                ran += 1;
                let tables = sample::tables(verified.function());
                tables.check(verified.function()).expect("the tables fit");
                let inputs = vec![0.5; function.inputs.len()];
                let outputs = interpret::run(&verified, &tables, &mut Scalar, &inputs);
                assert_eq!(outputs.len(), function.outputs.len(), "seed {seed}\n{printed}");
            }
            Err(errors) => {
                refused += 1;
                assert!(annotated(&function, &errors).contains(";! "), "seed {seed}\n{printed}");
            }
        }
    }
    assert!(refused > 1000 && ran > 400, "both must be common: {refused} refused, {ran} ran");
}
