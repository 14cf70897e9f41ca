//! How many values are alive at once: what decides whether registers, and then a frame, can hold a function.
//!
//! A value is alive from its definition to its last use in its own block. A fold uses its initial
//! accumulators once, when it starts. It *captures* the values of enclosing blocks that its body reads: they
//! stay alive until the fold ends. So the values alive at a point inside a body are those of the body and
//! those that its fold keeps alive outside.
//!
//! ```text
//! peak(block) = the largest, over its instructions from last to first, of
//!     the values alive after it and its results
//!     a fold: the values alive after it, without its results, and the captured ones, and peak(its body)
//!     the values alive before it
//! ```

use crate::entity::{Block, Entity, Inst, Store, Value};
use crate::function::{Function, InstKind};

/// The largest number of values that are alive at once, in the present order. Constants, inputs and columns
/// count from their instruction on, like every other value.
#[must_use]
pub fn max_live(function: &Function) -> usize {
    let uses = Uses::new(function);
    let mut liveness = Liveness::new(function);
    let mut peak = 0;
    for &block in &uses.inner_first {
        peak = liveness.peak(&uses, block, &function.blocks[block].insts);
        liveness.peaks[block.index()] = peak;
    }
    peak
}

/// What the instructions of a function read of their own blocks.
pub(super) struct Uses {
    /// All blocks that instructions reach, each after the blocks inside it; the function's body is the last.
    pub inner_first: Vec<Block>,
    /// The block that defines each value.
    pub home: Vec<Option<Block>>,
    /// For each block, the values of enclosing blocks that it and the blocks inside it read, once each.
    captured: Store<Block, Vec<Value>>,
}

impl Uses {
    pub fn new(function: &Function) -> Self {
        let mut uses =
            Self { inner_first: Vec::new(), home: vec![None; function.values.len()], captured: Store::new() };
        for _ in function.blocks.keys() {
            uses.captured.push(Vec::new());
        }
        let mut seen = vec![None; function.values.len()];
        uses.block(function, function.body, &mut seen);
        uses
    }

    /// The values that an instruction reads when it starts, and those that it reads until it ends: only a
    /// fold has the latter. A value may come twice, and values of enclosing blocks are among them.
    pub fn of<'a>(&'a self, function: &'a Function, inst: Inst) -> (&'a [Value], &'a [Value]) {
        let captured = match &function.insts[inst].kind {
            InstKind::Fold(fold) => self.captured[fold.body].as_slice(),
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Op { .. } => &[],
        };
        (function.operands(inst), captured)
    }

    /// Records a block after the blocks inside it; as deep as folds are nested. `seen` is the last block that
    /// captured a value.
    fn block(&mut self, function: &Function, block: Block, seen: &mut [Option<Block>]) {
        let data = &function.blocks[block];
        for &param in &data.params {
            self.home[param.index()] = Some(block);
        }
        let mut captured = Vec::new();
        for &inst in &data.insts {
            crate::watch::look();
            for &value in &function.insts[inst].results {
                self.home[value.index()] = Some(block);
            }
            if let InstKind::Fold(fold) = &function.insts[inst].kind {
                self.block(function, fold.body, seen);
            }
        }
        let mut capture = |home: &[Option<Block>], values: &[Value]| {
            for &value in values {
                if home[value.index()] != Some(block) && seen[value.index()].replace(block) != Some(block) {
                    captured.push(value);
                }
            }
        };
        for &inst in &data.insts {
            crate::watch::look();
            let (operands, inner) = self.of(function, inst);
            capture(&self.home, operands);
            capture(&self.home, inner);
        }
        capture(&self.home, &data.results);
        self.captured[block] = captured;
        self.inner_first.push(block);
    }
}

/// Counts the values that are alive.
pub(super) struct Liveness<'a> {
    function: &'a Function,
    /// The peak of each block that has been counted.
    pub peaks: Vec<usize>,
    alive: Vec<bool>,
    count: usize,
}

impl<'a> Liveness<'a> {
    pub fn new(function: &'a Function) -> Self {
        let peaks = vec![0; function.blocks.len()];
        Self { function, peaks, alive: vec![false; function.values.len()], count: 0 }
    }

    /// The largest number of values of this block, and of the blocks inside it, that are alive at once if its
    /// instructions run in this order. The peaks of the blocks inside are known.
    pub fn peak(&mut self, uses: &Uses, block: Block, order: &[Inst]) -> usize {
        let function = self.function;
        let data = &function.blocks[block];
        self.count = 0;
        let local = |value: &&Value| uses.home[value.index()] == Some(block);
        for value in data.results.iter().filter(local) {
            self.begin(*value);
        }
        let mut peak = self.count;
        for &inst in order.iter().rev() {
            crate::watch::look();
            let inst_data = &function.insts[inst];
            for &value in &inst_data.results {
                self.begin(value);
            }
            peak = peak.max(self.count);
            for &value in &inst_data.results {
                self.end(value);
            }
            let (operands, captured) = uses.of(function, inst);
            for value in captured.iter().filter(local) {
                self.begin(*value);
            }
            if let InstKind::Fold(fold) = &inst_data.kind {
                peak = peak.max(self.count + self.peaks[fold.body.index()]);
            }
            for value in operands.iter().filter(local) {
                self.begin(*value);
            }
            peak = peak.max(self.count);
        }
        for &param in &data.params {
            self.begin(param);
        }
        peak = peak.max(self.count);
        for &param in &data.params {
            self.end(param);
        }
        peak
    }

    fn begin(&mut self, value: Value) {
        self.count += usize::from(!std::mem::replace(&mut self.alive[value.index()], true));
    }

    fn end(&mut self, value: Value) {
        self.count -= usize::from(std::mem::replace(&mut self.alive[value.index()], false));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::FunctionBuilder;
    use crate::function::{FoldKind, Rule, Schema};
    use crate::op::Domain;

    #[test]
    fn a_sum_of_two_inputs_keeps_two_values() {
        let mut b = FunctionBuilder::new("f", &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let sum = b.add(x, y);
        assert_eq!(max_live(&b.finish(&[("out".into(), sum)])), 2);
    }

    #[test]
    fn a_value_that_is_used_later_stays_alive() {
        let mut b = FunctionBuilder::new("f", &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let sum = b.add(x, y);
        let product = b.mul(sum, y);
        let result = b.sub(product, x);
        assert_eq!(max_live(&b.finish(&[("out".into(), result)])), 3);
    }

    #[test]
    fn a_fold_keeps_what_its_body_captures() {
        let mut b = FunctionBuilder::new("f", &["x", "y", "z"]);
        let (x, y, z) = (b.input(0), b.input(1), b.input(2));
        let zero = b.constant(0.0);
        let schema = Schema { name: "row".into(), columns: vec!["a".into()], parent: None, slots: vec![] };
        let table = b.table(schema);
        let acc = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero]);
        let column = b.column(table, 0);
        let product = b.fma(x, column, acc[0]);
        let sum = b.add(product, y);
        let total = b.end_fold(&[sum]);
        let result = b.mul(total[0], z);
        // x and y because the body reads them, z because it is read later, and inside the column and the
        // accumulator.
        assert_eq!(max_live(&b.finish(&[("out".into(), result)])), 5);
    }

    #[test]
    fn results_that_nothing_reads_count_where_they_are_defined() {
        let mut b = FunctionBuilder::new("f", &["x"]);
        let x = b.input(0);
        let _unused = b.neg(x);
        assert_eq!(max_live(&b.finish(&[("out".into(), x)])), 2);
    }
}
