//! How many values are alive at once, before any code is made.
//!
//! A value is alive from its definition to its last use. If a value from outside is used inside a fold, it is
//! alive until the fold ends, because the next row reads it again. Inputs, constants, columns and values of
//! other pieces are read anew in each block that uses them and do not count. (Columns that are broadcast for
//! a piece are alive in it, but do not count either: if there are many, they are spilled and read from the
//! frame.)
//!
//! ```text
//! v2 = sqrt v1          ┐
//! v3 = mul v2, v2       │ ┐
//! fold t0 (v3):         │ ┴
//!     v5 = add v4, v2   │          used in the loop: alive to its end
//!     yield v5          ┘
//! ```

use super::strips::{Plan, Then};
use crate::entity::{Block, Entity, Inst, Value};
use crate::function::{Function, InstData, InstKind};

/// A function whose loops carry at most this many values is a field, without gradient or attributes: larger
/// blocks of points pay longer.
pub const FIELD_CARRIES: usize = 3;
/// The walk over all instructions in order of execution.
struct PressureWalk<'a> {
    function: &'a Function,
    plan: &'a Plan,
    /// Pieces so far.
    piece: usize,
    /// Instructions and block ends so far.
    position: usize,
    /// How many folds enclose the definition of each value.
    depth: Vec<usize>,
    /// From where to where each value is alive; empty where it does not count.
    alive: Vec<(usize, usize)>,
    /// For each fold that is being walked, what it reads from the block that it stands in.
    captured: Vec<Vec<Value>>,
}

/// The largest number of values that are alive at the same time.
#[must_use]
pub fn live_values(function: &Function, plan: &Plan) -> usize {
    let values = function.values.len();
    let mut walk = PressureWalk {
        function,
        plan,
        piece: 0,
        position: 0,
        depth: vec![0; values],
        alive: vec![(0, 0); values],
        captured: vec![],
    };
    walk.pieces(function.body);
    let mut change = vec![0_isize; walk.position + 2];
    for (from, to) in walk.alive.into_iter().filter(|(from, to)| from < to) {
        change[from] += 1;
        change[to] -= 1;
    }
    let mut alive = 0;
    let most = change.into_iter().map(|change| {
        alive += change;
        alive
    });
    most.max().unwrap_or(0).unsigned_abs()
}

/// The largest number of values that a loop hands from row to row: few for a field, more for a gradient, most
/// for attributes. In a function of one piece they compete for registers with all values of the body.
#[must_use]
pub fn carried_values(function: &Function) -> usize {
    let carried =
        |inst: &InstData| if let InstKind::Fold(fold) = &inst.kind { fold.initial.len() } else { 0 };
    function.insts.values().map(carried).max().unwrap_or(0)
}

impl PressureWalk<'_> {
    /// The function's body, or that of a fold that is cut.
    fn pieces(&mut self, block: Block) {
        let data = &self.function.blocks[block];
        for piece in self.plan.pieces(block) {
            self.insts(&data.insts[piece.insts.clone()]);
            match piece.then {
                Then::Next => {}
                Then::Fold(fold) => self.reads(self.function.operands(fold)),
                Then::End => self.reads(&data.results),
            }
            self.piece += 1;
            if let Then::Fold(fold) = piece.then
                && let InstKind::Fold(fold) = &self.function.insts[fold].kind
            {
                self.pieces(fold.body);
            }
        }
    }

    fn insts(&mut self, insts: &[Inst]) {
        for &inst in insts {
            crate::watch::look();
            self.reads(self.function.operands(inst));
            let data = &self.function.insts[inst];
            match &data.kind {
                InstKind::Input(_)
                | InstKind::Constant(_)
                | InstKind::BitsConstant(_)
                | InstKind::Column { .. } => continue,
                InstKind::Op { .. } => {}
                InstKind::Fold(fold) => self.fold(fold.body),
            }
            for &result in &data.results {
                self.define(result);
            }
        }
    }

    /// A fold that is not cut.
    fn fold(&mut self, body: Block) {
        self.captured.push(Vec::new());
        let data = &self.function.blocks[body];
        for &param in &data.params {
            self.define(param);
        }
        self.insts(&data.insts);
        self.reads(&data.results);
        for value in self.captured.pop().into_iter().flatten() {
            self.alive[value.index()].1 = self.position + 1;
        }
    }

    fn define(&mut self, value: Value) {
        self.depth[value.index()] = self.captured.len();
        // Never 0, so that (0, 0) keeps its meaning.
        self.alive[value.index()] = (self.position + 1, self.position + 1);
    }

    /// Records reads, one step after the last read or definition.
    fn reads(&mut self, values: &[Value]) {
        self.position += 1;
        for &value in values {
            self.read(value);
        }
    }

    fn read(&mut self, value: Value) {
        if self.plan.home(value) != self.piece {
            return;
        }
        let alive = &mut self.alive[value.index()];
        if alive.0 == 0 {
            return;
        }
        alive.1 = self.position + 1;
        if let Some(captured) = self.captured.get_mut(self.depth[value.index()]) {
            captured.push(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Domain, FoldKind, Function, FunctionBuilder, Rule, Schema, Value};

    use super::{carried_values, live_values};
    use crate::plan::Plan;

    fn live(function: &Function) -> usize {
        live_values(function, &Plan::whole(function))
    }

    fn count(b: FunctionBuilder, out: Value) -> usize {
        live(&b.finish(&[("out".to_owned(), out)]))
    }

    #[test]
    fn a_value_is_alive_to_its_last_use() {
        let mut b = FunctionBuilder::new("chain", &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let one = b.constant(1.0);
        let mut last = b.add(x, one);
        for _ in 0..10 {
            last = b.mul(last, y);
        }
        // x and y are read where they are used; there is the last product.
        assert_eq!(count(b, last), 1);
    }

    /// The sum of x, its root, the root of that and so on, 20 in all, which are added up in the order in
    /// which they were made.
    fn waiting() -> Function {
        let mut b = FunctionBuilder::new("wait", &["x"]);
        let mut values = vec![b.input(0)];
        for index in 1..20 {
            let next = b.sqrt(values[index - 1]);
            values.push(next);
        }
        let sum = values.into_iter().reduce(|sum, value| b.add(sum, value)).expect("there are values");
        b.finish(&[("sum".to_owned(), sum)])
    }

    #[test]
    fn values_that_wait_are_alive() {
        // The last root together with the 18 before it.
        assert_eq!(live(&waiting()), 19);
    }

    #[test]
    fn what_a_fold_reads_from_outside_is_alive_to_its_end() {
        let mut b = FunctionBuilder::new("fold", &["x", "y", "z"]);
        let columns = vec!["c".to_owned()];
        let t = b.table(Schema { name: "t".to_owned(), columns, parent: None, slots: Vec::new() });
        let outside = [0, 1, 2].map(|index| {
            let input = b.input(index);
            b.sqrt(input)
        });
        let zero = b.constant(0.0);
        let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero]);
        let c = b.column(t, 0);
        // Each value from outside is read once, and for the last time in its row, but the next row reads it
        // again.
        let mut next = b.add(acc[0], c);
        for value in outside {
            next = b.fma(value, c, next);
        }
        let out = b.end_fold(&[next]);
        let function = b.finish(&[("out".to_owned(), out[0])]);
        assert_eq!(live(&function), 4);
        assert_eq!(carried_values(&function), 1);
    }

    #[test]
    fn what_another_piece_has_computed_is_not_alive() {
        // In each piece the last root or sum waits for the next one; all roots are in slots for the sum.
        let function = waiting();
        assert_eq!(live_values(&function, &Plan::cut(&function, 10)), 1);
    }

    #[test]
    fn nothing_is_alive_in_nothing() {
        let mut b = FunctionBuilder::new("constant", &[]);
        let one = b.constant(1.0);
        assert_eq!(count(b, one), 0);
    }
}
