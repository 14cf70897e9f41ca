//! Removes what no output needs.
//!
//! ```text
//! needed: the outputs, and from a needed value on
//!         an op's result           -> its operands
//!         accumulator i of a fold  -> its initial value and its next value; it is needed if its final value is, or if
//!                                     the needed part of the body reads it
//! ```
//!
//! So an accumulator that only feeds itself is removed, and so is a fold without a needed accumulator. Tables
//! and columns stay, used or not: the rows of numbers keep their layout.

use crate::entity::{Entity, Inst, Store, Value, Values};
use crate::function::{Function, InstKind};
use crate::translate::renumber;
use crate::watch::{look, look_now};

/// Where a value comes from.
#[derive(Clone, Copy)]
enum ValueSource {
    /// The result of an instruction that is no fold.
    Inst(Inst),
    /// An accumulator, inside or after its fold: initial value, next value, and the two values that it is
    /// inside and after.
    Accumulator([Value; 4]),
}

/// The function without values that no output needs.
#[must_use]
pub fn dce(mut function: Function) -> Function {
    let needed = needed(&function);
    look_now();
    let keep = |value: Value| needed[value.index()];

    let Function { insts, blocks, .. } = &mut function;
    let mut removed = vec![false; insts.len()];
    for (removed, data) in removed.iter_mut().zip(insts.values_mut()) {
        look();
        *removed = !data.results.iter().any(|&value| keep(value));
        let InstKind::Fold(fold) = &mut data.kind else { continue };
        let filter = |values: &[Value]| -> Values {
            let kept = values.iter().zip(&data.results).filter(|(_, result)| keep(**result));
            kept.map(|(&value, _)| value).collect()
        };
        let body = &mut blocks[fold.body];
        body.params = filter(&body.params);
        body.results = filter(&body.results);
        fold.initial = filter(&fold.initial);
        data.results.retain(|result| keep(*result));
    }
    for block in blocks.values_mut() {
        block.insts.retain(|inst| !removed[inst.index()]);
    }
    look_now();
    renumber(&function)
}

/// For each value, whether an output needs it. An accumulator inside its fold and its final value are needed
/// together.
fn needed(function: &Function) -> Vec<bool> {
    let sources = sources(function);
    let mut needed = vec![false; function.values.len()];
    let mut work: Vec<Value> = function.blocks[function.body].results.to_vec();
    while let Some(value) = work.pop() {
        look();
        if std::mem::replace(&mut needed[value.index()], true) {
            continue;
        }
        match sources[value].expect("every value is defined") {
            ValueSource::Inst(inst) => work.extend(function.operands(inst)),
            ValueSource::Accumulator(values) => work.extend(values),
        }
    }
    needed
}

fn sources(function: &Function) -> Store<Value, Option<ValueSource>> {
    let mut sources = Store::new();
    for _ in function.values.keys() {
        sources.push(None);
    }
    for (inst, data) in function.insts.iter() {
        look();
        match &data.kind {
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Op { .. } => sources[data.results[0]] = Some(ValueSource::Inst(inst)),
            InstKind::Fold(fold) => {
                let body = &function.blocks[fold.body];
                for (index, &result) in data.results.iter().enumerate() {
                    let param = body.params[index];
                    let source =
                        ValueSource::Accumulator([fold.initial[index], body.results[index], param, result]);
                    sources[param] = Some(source);
                    sources[result] = Some(source);
                }
            }
        }
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::FunctionBuilder;
    use crate::function::{FoldKind, Rule, Schema};
    use crate::op::{Domain, Op};

    fn schema(columns: &[&str]) -> Schema {
        Schema {
            name: "row".into(),
            columns: columns.iter().map(|&column| column.to_owned()).collect(),
            parent: None,
            slots: vec![],
        }
    }

    #[test]
    fn unused_instructions_go() {
        let mut b = FunctionBuilder::new("f", &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let sum = b.add(x, x);
        let product = b.mul(x, y);
        let _unused = b.sqrt(product);
        let function = dce(b.finish(&[("out".into(), sum)]));
        assert_eq!(function.insts.len(), 2);
        assert_eq!(function.values.len(), 2);
        assert_eq!(function.inputs.len(), 2, "the planes stay");
    }

    #[test]
    fn accumulators_that_feed_only_themselves_go() {
        let mut b = FunctionBuilder::new("f", &["x"]);
        let x = b.input(0);
        let zero = b.constant(0.0);
        let table = b.table(schema(&["a", "b"]));
        // 0 is wanted and reads 2; 1 and 3 feed each other only.
        let acc = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero, zero, x, x]);
        let (first, second) = (b.column(table, 0), b.column(table, 1));
        let next =
            [b.add(acc[0], acc[2]), b.mul(acc[3], second), b.mul(acc[2], first), b.add(acc[1], second)];
        let sums = b.end_fold(&next);
        let function = dce(b.finish(&[("out".into(), sums[0])]));
        let fold = function.insts.values().find_map(|data| match &data.kind {
            InstKind::Fold(fold) => Some((fold.clone(), data.results.len())),
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Op { .. } => None,
        });
        let (fold, results) = fold.expect("it is still there");
        assert_eq!((fold.initial.len(), results), (2, 2));
        assert_eq!(function.blocks[fold.body].params.len(), 2);
        assert_eq!(function.blocks[fold.body].insts.len(), 3, "one column, one sum, one product");
        assert_eq!(function.tables[table].columns.len(), 2, "columns stay");
    }

    #[test]
    fn folds_that_nothing_reads_go_and_their_tables_stay() {
        let mut b = FunctionBuilder::new("f", &["x"]);
        let x = b.input(0);
        let table = b.table(schema(&["a"]));
        let acc = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[x]);
        let column = b.column(table, 0);
        let next = b.op(Op::Add, &[acc[0], column]);
        b.end_fold(&[next]);
        let function = dce(b.finish(&[("out".into(), x)]));
        assert_eq!((function.insts.len(), function.blocks.len(), function.tables.len()), (1, 1, 1));
    }
}
