//! Where a long function is cut: each piece runs over a strip of points before the next piece does.
//!
//! Code that is longer than the nearest caches is fetched anew for every block of points, and that takes
//! longer than running it. A piece fits into the cache, so all blocks of a strip but the first find it there.
//! And one block need not wait for another block's results, which keeps the processor busy where a formula is
//! one long chain. The price is memory: a value that another piece reads is kept in the frame for the whole
//! strip.
//!
//! ```text
//! v3 = sqrt v0           ┐                     for each block of the strip
//! v4 = mul v0, v3        ┘ piece 0, keeps v3, and v4 as the fold's accumulator
//! v9 = fold t0 (v4) block1(v5):                for each row of t0
//!     v6 = column t0.x   ┐                         broadcast before the piece
//!     v7 = mul v6, v3    ┤                         for each block of the strip
//!     ...                ┘ piece 1, keeps v7
//!     v8 = add v5, v7    ┐                         for each block of the strip
//!     yield v8           ┘ piece 2, keeps the accumulator
//! yield v9               ] piece 3             for each block of the strip
//! ```
//!
//! So a cut function has rows outside and points inside, an uncut function the other way round. The
//! accumulators of a fold live in the frame: piece 0 writes the initial ones, the last piece of the body
//! writes the next ones.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::entity::{Block, Entity, Inst, Table, Value};
use crate::function::{Function, InstData, InstKind};

/// Bytes of all slots that leave room for other things in the nearest cache.
const NEAR_BYTES: usize = 32 << 10;
/// Points of the shortest and of the longest strip: enough to make fetching a piece negligible, and no more
/// than a caller may be expected to have.
const STRIP_POINTS: [usize; 2] = [64, 1024];

/// A stretch of the instructions of one block.
#[derive(Debug)]
pub struct Piece {
    /// Positions in the block.
    pub insts: Range<usize>,
    /// What comes after it.
    pub then: Then,
    /// The columns that it reads, if folds are cut.
    pub columns: Vec<Column>,
}

/// A column of the current row of a table.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// What the column gives.
    pub value: Value,
    /// The table.
    pub table: Table,
    /// Its place in a row.
    pub column: usize,
}

/// What follows a piece.
#[derive(Clone, Copy, Debug)]
pub enum Then {
    /// The next piece of the block.
    Next,
    /// A fold that is cut. Then the next piece of the block.
    Fold(Inst),
    /// Nothing: it ends with the results of the block.
    End,
}

/// A place for one value at all points of a strip.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Slot(
    /// Its number, from 0.
    pub usize,
);

/// The pieces of a function, and what they hand to each other.
#[derive(Debug)]
pub struct Plan {
    /// Of the function's body and of the bodies of folds, if these are cut.
    pieces: HashMap<Block, Vec<Piece>>,
    /// Where a value is kept, if a piece reads it that does not define it.
    slots: Vec<Option<Slot>>,
    slot_count: usize,
    /// The piece that defines a value, in order of execution.
    homes: Vec<usize>,
}

impl Plan {
    /// One piece, in which all folds are.
    #[must_use]
    pub fn whole(function: &Function) -> Self {
        let insts = 0..function.blocks[function.body].insts.len();
        let all = Piece { insts, then: Then::End, columns: Vec::new() };
        let values = function.values.len();
        Self {
            pieces: HashMap::from_iter([(function.body, vec![all])]),
            slots: vec![None; values],
            slot_count: 0,
            homes: vec![0; values],
        }
    }

    /// Pieces of at most so many instructions, with a cut before and behind every fold.
    #[must_use]
    pub fn cut(function: &Function, longest: usize) -> Self {
        let mut cutter = Cutter::new(function, longest);
        cutter.cut(function.body);
        let pieces = cutter.pieces;
        let lives = PieceLives::new(function, &pieces);
        let (slots, slot_count) = lives.slots();
        let homes = lives.homes;
        Self { pieces, slots, slot_count, homes }
    }

    /// The pieces of the function's body or of the body of a fold that is cut. Panics on another block.
    #[must_use]
    pub fn pieces(&self, block: Block) -> &[Piece] {
        &self.pieces[&block]
    }

    /// Whether there is but one piece.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.pieces.len() == 1 && self.pieces.values().all(|pieces| pieces.len() == 1)
    }

    /// Where a value is kept, if it is.
    #[must_use]
    pub fn slot(&self, value: Value) -> Option<Slot> {
        self.slots[value.index()]
    }

    /// Bytes of a strip in a plane, and of a slot: as many points as let all slots be near.
    #[must_use]
    pub fn strip_bytes(&self) -> usize {
        let number = size_of::<f32>();
        let points = NEAR_BYTES / number / self.slot_count.max(1);
        let [shortest, longest] = STRIP_POINTS;
        number * (1 << points.clamp(shortest, longest).ilog2())
    }

    /// Bytes of all slots. Values that are not alive together share one.
    #[must_use]
    pub fn slot_bytes(&self) -> usize {
        self.slot_count * self.strip_bytes()
    }

    /// The piece that defines a value, in order of execution.
    #[must_use]
    pub fn home(&self, value: Value) -> usize {
        self.homes[value.index()]
    }
}

/// The walk that cuts.
struct Cutter<'a> {
    function: &'a Function,
    longest: usize,
    /// The values that are columns.
    columns: HashMap<Value, Column>,
    pieces: HashMap<Block, Vec<Piece>>,
}

impl<'a> Cutter<'a> {
    fn new(function: &'a Function, longest: usize) -> Self {
        let column = |data: &InstData| match data.kind {
            InstKind::Column { table, column } => {
                let value = data.results[0];
                Some((value, Column { value, table, column }))
            }
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Op { .. }
            | InstKind::Fold(_) => None,
        };
        let columns = function.insts.values().filter_map(column).collect();
        Self { function, longest, columns, pieces: HashMap::default() }
    }

    /// Cuts a block, and the bodies of its folds.
    fn cut(&mut self, block: Block) {
        let insts = &self.function.blocks[block].insts;
        let mut pieces = Vec::new();
        let mut from = 0;
        for (position, &inst) in insts.iter().enumerate() {
            crate::watch::look();
            if let InstKind::Fold(fold) = &self.function.insts[inst].kind {
                pieces.push(self.piece(block, from..position, Then::Fold(inst)));
                self.cut(fold.body);
                from = position + 1;
            } else if position - from == self.longest.max(1) {
                pieces.push(self.piece(block, from..position, Then::Next));
                from = position;
            }
        }
        pieces.push(self.piece(block, from..insts.len(), Then::End));
        self.pieces.insert(block, pieces);
    }

    /// A piece of a block.
    fn piece(&self, block: Block, insts: Range<usize>, then: Then) -> Piece {
        let data = &self.function.blocks[block];
        let last: &[Value] = match then {
            Then::Next => &[],
            Then::Fold(inst) => self.function.operands(inst),
            Then::End => &data.results,
        };
        let read =
            data.insts[insts.clone()].iter().flat_map(|&inst| self.function.operands(inst)).chain(last);
        let mut seen = HashSet::default();
        let columns = read.filter_map(|value| self.columns.get(value).copied());
        let columns = columns.filter(|column| seen.insert(column.value)).collect();
        Piece { insts, then, columns }
    }
}

/// The walk over all pieces in order of execution: which of them define and read a value.
struct PieceLives<'a> {
    function: &'a Function,
    pieces: &'a HashMap<Block, Vec<Piece>>,
    /// Pieces so far.
    piece: usize,
    /// The piece that defines a value. For an accumulator, the one before the fold.
    homes: Vec<usize>,
    /// The last piece that needs a value: the last that reads it, or the last piece of a fold that reads it
    /// or has it as a result.
    last: Vec<usize>,
    /// How many folds enclose the definition of each value.
    depth: Vec<usize>,
    /// For each fold that is being walked, what it reads from outside.
    captured: Vec<Vec<Value>>,
    accumulators: Vec<FoldAccumulator>,
}

/// What a fold hands from row to row.
struct FoldAccumulator {
    /// As the fold is given it.
    initial: Value,
    /// As the body binds it.
    param: Value,
    /// As the fold gives it.
    result: Value,
}

impl<'a> PieceLives<'a> {
    fn new(function: &'a Function, pieces: &'a HashMap<Block, Vec<Piece>>) -> Self {
        let zeros = vec![0; function.values.len()];
        let mut lives = Self {
            function,
            pieces,
            piece: 0,
            homes: zeros.clone(),
            last: zeros.clone(),
            depth: zeros,
            captured: Vec::new(),
            accumulators: Vec::new(),
        };
        lives.block(function.body);
        lives
    }

    fn block(&mut self, block: Block) {
        let data = &self.function.blocks[block];
        for piece in &self.pieces[&block] {
            for &inst in &data.insts[piece.insts.clone()] {
                crate::watch::look();
                self.read(self.function.operands(inst));
                self.define(&self.function.insts[inst].results);
            }
            match piece.then {
                Then::Next => {}
                Then::Fold(inst) => self.fold(inst),
                Then::End => self.read(&data.results),
            }
            self.piece += 1;
        }
    }

    /// The fold behind the current piece.
    fn fold(&mut self, inst: Inst) {
        let data = &self.function.insts[inst];
        let InstKind::Fold(fold) = &data.kind else { unreachable!("a piece ends before a fold") };
        let params = &self.function.blocks[fold.body].params;
        self.read(&fold.initial);
        self.define(&data.results);
        self.captured.push(Vec::new());
        self.define(params);
        self.piece += 1;
        self.block(fold.body);
        // The body's last piece is the fold's. The caller goes on behind it.
        self.piece -= 1;
        for value in self.captured.pop().into_iter().flatten() {
            self.last[value.index()] = self.piece;
        }
        for ((&initial, &param), &result) in fold.initial.iter().zip(params).zip(&data.results) {
            self.last[result.index()] = self.piece;
            self.accumulators.push(FoldAccumulator { initial, param, result });
        }
    }

    fn define(&mut self, values: &[Value]) {
        for value in values {
            self.homes[value.index()] = self.piece;
            self.last[value.index()] = self.piece;
            self.depth[value.index()] = self.captured.len();
        }
    }

    fn read(&mut self, values: &[Value]) {
        for &value in values {
            self.last[value.index()] = self.piece;
            if let Some(captured) = self.captured.get_mut(self.depth[value.index()]) {
                captured.push(value);
            }
        }
    }

    /// A slot for every value that is read outside of its piece and for every accumulator, and the number of
    /// slots.
    fn slots(&self) -> (Vec<Option<Slot>>, usize) {
        let mut slots: Vec<Option<Slot>> = vec![None; self.function.values.len()];
        // A parameter has the slot of the fold's result; leaves are read where they are.
        let (mut is_elsewhere, mut initial) = (vec![false; slots.len()], vec![None; slots.len()]);
        for accumulator in &self.accumulators {
            is_elsewhere[accumulator.param.index()] = true;
            initial[accumulator.result.index()] = Some(accumulator.initial.index());
        }
        for data in self.function.insts.values().filter(|data| data.kind.is_leaf()) {
            is_elsewhere[data.results[0].index()] = true;
        }
        let mut wanted: Vec<usize> = (0..slots.len())
            .filter(|&value| initial[value].is_some() || self.last[value] > self.homes[value])
            .filter(|&value| !is_elsewhere[value])
            .collect();
        wanted.sort_by_key(|&value| self.homes[value]);
        // For each slot, the last piece that reads its value.
        let mut taken: Vec<usize> = Vec::new();
        let (mut free, mut ends) = (BinaryHeap::new(), BinaryHeap::new());
        for value in wanted {
            let home = self.homes[value];
            while let Some(&Reverse((last, slot))) = ends.peek()
                && last < home
            {
                ends.pop();
                // Unless an accumulator has taken it over.
                if taken[slot] == last {
                    free.push(Reverse(slot));
                }
            }
            // An accumulator takes over the slot of its initial value, if the fold is the last to read that
            // value.
            let handed_on = initial[value].and_then(|initial| slots[initial]);
            let handed_on = handed_on.filter(|&Slot(slot)| taken[slot] == home).map(|Slot(slot)| slot);
            let slot = handed_on.or_else(|| free.pop().map(|Reverse(slot)| slot)).unwrap_or_else(|| {
                taken.push(0);
                taken.len() - 1
            });
            taken[slot] = self.last[value];
            ends.push(Reverse((self.last[value], slot)));
            slots[value] = Some(Slot(slot));
        }
        for accumulator in &self.accumulators {
            slots[accumulator.param.index()] = slots[accumulator.result.index()];
        }
        (slots, taken.len())
    }
}

#[cfg(test)]
mod tests {
    use crate::{Domain, FoldKind, Function, FunctionBuilder, InstKind, Rule, Schema, Value};

    use super::{Plan, Then};

    fn finish(b: FunctionBuilder, out: Value) -> Function {
        b.finish(&[("out".to_owned(), out)])
    }

    /// Roots of roots, so many deep.
    fn roots(b: &mut FunctionBuilder, mut value: Value, count: usize) -> Value {
        for _ in 0..count {
            value = b.sqrt(value);
        }
        value
    }

    #[test]
    fn slots_are_shared_by_values_that_are_not_alive_together() {
        let mut b = FunctionBuilder::new("chain", &["x"]);
        let x = b.input(0);
        let out = roots(&mut b, x, 99);
        let function = finish(b, out);
        let plan = Plan::cut(&function, 10);
        assert_eq!(plan.pieces(function.body).len(), 10);
        // Each piece hands one root to the next one: a piece reads one slot and writes the other.
        assert_eq!(plan.slot_bytes(), 2 * plan.strip_bytes());
        assert_eq!(plan.slot(x), None, "an input is read where it is");
        let whole = Plan::whole(&function);
        assert!(whole.is_whole() && whole.slot_bytes() == 0);
    }

    #[test]
    fn many_slots_make_short_strips() {
        let mut b = FunctionBuilder::new("wait", &["x"]);
        let mut values = vec![b.input(0)];
        for index in 1..=100 {
            let next = b.sqrt(values[index - 1]);
            values.push(next);
        }
        let sum = values.into_iter().reduce(|sum, value| b.add(sum, value)).expect("there are values");
        let function = finish(b, sum);
        let [few, many] = [150, 10].map(|longest| Plan::cut(&function, longest));
        assert!(few.strip_bytes() > many.strip_bytes());
        // All roots but the last few wait for the sum.
        assert!(many.slot_bytes() / many.strip_bytes() > 90);
        assert!(many.slot_bytes() <= super::NEAR_BYTES);
    }

    /// A fold whose accumulator begins with a root, its body a chain of so many roots.
    fn fold(length: usize) -> (Function, [Value; 5]) {
        let mut b = FunctionBuilder::new("fold", &["x"]);
        let columns = vec!["c".to_owned()];
        let t = b.table(Schema { name: "t".to_owned(), columns, parent: None, slots: Vec::new() });
        let x = b.input(0);
        let outside = b.sqrt(x);
        let initial = b.abs(outside);
        let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[initial]);
        let c = b.column(t, 0);
        let inside = b.mul(c, outside);
        let inside = roots(&mut b, inside, length);
        let next = b.add(acc[0], inside);
        let out = b.end_fold(&[next])[0];
        (finish(b, out), [outside, initial, acc[0], c, out])
    }

    #[test]
    fn a_fold_keeps_its_accumulators_and_what_it_reads_from_outside() {
        let (function, [outside, initial, acc, c, out]) = fold(20);
        let plan = Plan::cut(&function, 8);
        let before = &plan.pieces(function.body)[0];
        let Then::Fold(fold) = before.then else { panic!("a piece ends before a fold") };
        let InstKind::Fold(fold) = &function.insts[fold].kind else { panic!("a fold is cut") };
        let body = plan.pieces(fold.body);
        assert_eq!(body.len(), 3);
        assert!(body[0].columns.iter().map(|column| column.value).eq([c]) && body[1].columns.is_empty());
        assert_eq!(plan.slot(c), None, "a column is read where it is");
        assert_eq!(plan.slot(acc), plan.slot(out));
        let [outside, out] = [outside, out].map(|value| plan.slot(value).expect("pieces read it"));
        assert_ne!(outside, out, "the next row reads both");
        assert_eq!(plan.slot(initial), None, "the piece that computes it hands it over");
    }

    #[test]
    fn an_accumulator_begins_where_its_initial_value_is() {
        let mut b = FunctionBuilder::new("folds", &["x"]);
        let x = b.input(0);
        let first = b.sqrt(x);
        let mut last = first;
        for index in 0..4 {
            let schema = Schema { name: index.to_string(), columns: vec![], parent: None, slots: Vec::new() };
            let t = b.table(schema);
            let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[last]);
            let next = b.add(acc[0], first);
            last = b.end_fold(&[next])[0];
        }
        let function = finish(b, last);
        let plan = Plan::cut(&function, 100);
        // One for the root, which all folds read, and one for the accumulators of all.
        assert_eq!(plan.slot_bytes(), 2 * plan.strip_bytes());
        assert_ne!(plan.slot(first), plan.slot(last));
    }
}
