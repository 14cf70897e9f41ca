//! Where a long function is cut: each piece runs over a strip of points before the next piece does.
//!
//! Code that is longer than the nearest caches is fetched anew for every block of points, and that takes longer than running it.
//! A piece fits, so all blocks of a strip but the first find it there. The price is memory: a value that another piece
//! reads is kept for the whole strip, in the frame.
//!
//! ```text
//! v3 = sqrt v0           ┐                     for each block of the strip
//! v4 = fold t0 ...       ┘ piece 0, keeps v4
//! v9 = fold t1 (v4):                           for each row of t1
//!     v6 = mul v5, v3    ┐                         for each block of the strip
//!     ...                ┘ piece 1
//!     yield v8           ] piece 2, keeps v9       for each block of the strip
//! yield v9               ] piece 3             for each block of the strip
//! ```
//!
//! A fold whose body fits a piece is never cut. The accumulators of one that is cut live in the frame: piece 0 keeps the initial
//! ones, the last piece of the body keeps the next ones.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::ops::Range;

use jbt_ir::{Block, Entity, Fold, Function, Inst, InstKind, Value};

/// Points of a strip: enough that fetching the code of a piece does not count.
const STRIP_POINTS: usize = 64;
/// Bytes of a strip in a plane, and of a slot.
pub(crate) const STRIP_BYTES: usize = STRIP_POINTS * size_of::<f32>();

/// A stretch of the instructions of one block.
pub(crate) struct Piece {
    /// Positions in the block.
    pub(crate) insts: Range<usize>,
    /// What comes after it.
    pub(crate) then: Then,
}

/// What follows a piece.
#[derive(Clone, Copy)]
pub(crate) enum Then {
    /// The next piece of the block.
    Next,
    /// A fold that is cut. Then the next piece of the block.
    Fold(Inst),
    /// Nothing: it ends with the results of the block.
    End,
}

/// A place for one value at all points of a strip.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Slot(pub(crate) usize);

/// The pieces of a function, and what they hand to each other.
pub(crate) struct Plan {
    /// Of the function's body and of the bodies of folds that are cut.
    pieces: HashMap<Block, Vec<Piece>>,
    /// Where a value is kept, if a piece reads it that does not define it.
    slots: Vec<Option<Slot>>,
    slot_count: usize,
    /// The piece that defines a value, in order of execution.
    homes: Vec<usize>,
}

impl Plan {
    /// Cuts a function into pieces of at most so many instructions, where it can be cut.
    pub(crate) fn new(function: &Function, longest: usize) -> Self {
        let mut pieces = HashMap::new();
        cut(function, function.body, longest, &mut pieces);
        let lives = Lives::new(function, &pieces);
        let (slots, slot_count) = lives.slots();
        let homes = lives.homes;
        Self { pieces, slots, slot_count, homes }
    }

    /// The pieces of the function's body or of the body of a fold that is cut.
    pub(crate) fn pieces(&self, block: Block) -> &[Piece] {
        &self.pieces[&block]
    }

    /// Whether there is but one piece.
    pub(crate) fn is_whole(&self) -> bool {
        self.pieces.len() == 1 && self.pieces.values().all(|pieces| pieces.len() == 1)
    }

    /// Where a value is kept, if it is.
    pub(crate) fn slot(&self, value: Value) -> Option<Slot> {
        self.slots[value.index()]
    }

    /// Bytes of all slots. Values that are not alive together share one.
    pub(crate) fn slot_bytes(&self) -> usize {
        self.slot_count * STRIP_BYTES
    }

    /// The piece that defines a value, in order of execution.
    pub(crate) fn home(&self, value: Value) -> usize {
        self.homes[value.index()]
    }
}

/// Instructions of a block and of all folds in it.
fn length(function: &Function, block: Block) -> usize {
    let inst_length = |&inst: &Inst| match fold(function, inst) {
        Some(fold) => 1 + length(function, fold.body),
        None => 1,
    };
    function.blocks[block].insts.iter().map(inst_length).sum()
}

/// What the instruction folds, if it does.
fn fold(function: &Function, inst: Inst) -> Option<&Fold> {
    if let InstKind::Fold(fold) = &function.insts[inst].kind { Some(fold) } else { None }
}

/// Cuts a block, and the bodies of folds that are too long for a piece.
fn cut(function: &Function, block: Block, longest: usize, pieces: &mut HashMap<Block, Vec<Piece>>) {
    let insts = &function.blocks[block].insts;
    let mut done = Vec::new();
    let (mut from, mut so_far) = (0, 0);
    for (position, &inst) in insts.iter().enumerate() {
        let fold = fold(function, inst);
        let length = 1 + fold.map_or(0, |fold| length(function, fold.body));
        if let Some(fold) = fold.filter(|_| length > longest) {
            done.push(Piece { insts: from..position, then: Then::Fold(inst) });
            cut(function, fold.body, longest, pieces);
            (from, so_far) = (position + 1, 0);
        } else {
            if so_far + length > longest && from < position {
                done.push(Piece { insts: from..position, then: Then::Next });
                (from, so_far) = (position, 0);
            }
            so_far += length;
        }
    }
    done.push(Piece { insts: from..insts.len(), then: Then::End });
    pieces.insert(block, done);
}

/// The walk over all pieces in order of execution: which of them define and read a value.
struct Lives<'a> {
    function: &'a Function,
    pieces: &'a HashMap<Block, Vec<Piece>>,
    /// Pieces so far.
    piece: usize,
    /// The piece that defines a value. For accumulators of a fold that is cut: the one before the fold.
    homes: Vec<usize>,
    /// The last piece that reads a value; its home if none does.
    last: Vec<usize>,
    /// How many cut folds enclose the definition of each value.
    depth: Vec<usize>,
    /// For each cut fold that is being walked, what it reads from outside.
    captured: Vec<Vec<Value>>,
    /// Accumulators of cut folds: as the body binds them, and as the fold's results.
    accumulators: Vec<[Value; 2]>,
}

impl<'a> Lives<'a> {
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
        lives.cut_block(function.body);
        lives
    }

    fn cut_block(&mut self, block: Block) {
        let data = &self.function.blocks[block];
        for piece in &self.pieces[&block] {
            self.insts(&data.insts[piece.insts.clone()]);
            match piece.then {
                Then::Next => {}
                Then::Fold(inst) => self.cut_fold(inst),
                Then::End => self.read(&data.results),
            }
            self.piece += 1;
        }
    }

    /// Instructions of the current piece.
    fn insts(&mut self, insts: &[Inst]) {
        for &inst in insts {
            self.read(self.function.operands(inst));
            if let Some(fold) = fold(self.function, inst) {
                let body = &self.function.blocks[fold.body];
                self.define(&body.params);
                self.insts(&body.insts);
                self.read(&body.results);
            }
            self.define(&self.function.insts[inst].results);
        }
    }

    /// A fold that is cut, behind the current piece.
    fn cut_fold(&mut self, inst: Inst) {
        let Some(fold) = fold(self.function, inst) else { unreachable!("a fold is cut, and nothing else") };
        let (params, results) = (&self.function.blocks[fold.body].params, &self.function.insts[inst].results);
        self.read(&fold.initial);
        let before = self.piece;
        self.define(results);
        self.captured.push(Vec::new());
        self.define(params);
        self.piece += 1;
        self.cut_block(fold.body);
        // The last piece that counts is the one that ends the body; the caller goes on behind it.
        self.piece -= 1;
        for value in self.captured.pop().into_iter().flatten() {
            self.last[value.index()] = self.piece;
        }
        for (&param, &result) in params.iter().zip(results) {
            self.last[result.index()] = self.piece;
            self.homes[result.index()] = before;
            self.accumulators.push([param, result]);
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

    /// A slot for every value that is read away from home, and for every accumulator of a fold that is cut. And how many there are.
    fn slots(&self) -> (Vec<Option<Slot>>, usize) {
        let mut slots = vec![None; self.function.values.len()];
        // An accumulator has one slot, which is that of its result.
        let mut is_result = vec![false; slots.len()];
        for [_, result] in &self.accumulators {
            is_result[result.index()] = true;
        }
        let mut is_param = vec![false; slots.len()];
        for [param, _] in &self.accumulators {
            is_param[param.index()] = true;
        }
        let remade = self.remade();
        let mut wanted: Vec<usize> = (0..slots.len())
            .filter(|&value| is_result[value] || self.last[value] > self.homes[value])
            .filter(|&value| !is_param[value] && !remade[value])
            .collect();
        wanted.sort_by_key(|&value| self.homes[value]);
        let (mut free, mut count) = (BinaryHeap::new(), 0);
        let mut taken = BinaryHeap::new();
        for value in wanted {
            while let Some(&Reverse((last, slot))) = taken.peek()
                && last < self.homes[value]
            {
                taken.pop();
                free.push(Reverse(slot));
            }
            let Reverse(slot) = free.pop().unwrap_or_else(|| {
                count += 1;
                Reverse(Slot(count - 1))
            });
            taken.push(Reverse((self.last[value], slot)));
            slots[value] = Some(slot);
        }
        for [param, result] in &self.accumulators {
            slots[param.index()] = slots[result.index()];
        }
        (slots, count)
    }

    /// By value: whether it is read anew wherever it is used, from where it is anyway.
    fn remade(&self) -> Vec<bool> {
        let mut remade = vec![false; self.function.values.len()];
        for data in self.function.insts.values() {
            match data.kind {
                InstKind::Input(_)
                | InstKind::Constant(_)
                | InstKind::BitsConstant(_)
                | InstKind::Column { .. } => remade[data.results[0].index()] = true,
                InstKind::Op { .. } | InstKind::Fold(_) => {}
            }
        }
        remade
    }
}

#[cfg(test)]
mod tests {
    use jbt_ir::{Domain, Function, FunctionBuilder, InstKind, Reduction, Schema, Value};

    use super::{Plan, STRIP_BYTES, Then};

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
    fn what_fits_a_piece_is_not_cut() {
        let mut b = FunctionBuilder::new("whole", &["x"]);
        let x = b.input(0);
        let out = roots(&mut b, x, 9);
        let function = finish(b, out);
        assert!(Plan::new(&function, 10).is_whole());
        assert_eq!(Plan::new(&function, 10).slot_bytes(), 0);
        assert!(!Plan::new(&function, 9).is_whole());
    }

    #[test]
    fn slots_are_shared_by_values_that_are_not_alive_together() {
        let mut b = FunctionBuilder::new("chain", &["x"]);
        let x = b.input(0);
        let out = roots(&mut b, x, 99);
        let function = finish(b, out);
        let plan = Plan::new(&function, 10);
        assert_eq!(plan.pieces(function.body).len(), 10);
        // Each piece hands one root to the next one: a piece reads one slot and writes the other.
        assert_eq!(plan.slot_bytes(), 2 * STRIP_BYTES);
        assert_eq!(plan.slot(x), None, "an input is read where it is");
    }

    #[test]
    fn a_fold_that_is_cut_keeps_its_accumulators_and_what_it_reads_from_outside() {
        let mut b = FunctionBuilder::new("fold", &["x"]);
        let columns = vec!["c".to_owned()];
        let t = b.table(Schema { name: "t".to_owned(), columns, parent: None, slots: Vec::new() });
        let x = b.input(0);
        let [outside, zero] = [b.sqrt(x), b.constant(0.0)];
        let acc = b.begin_fold(t, Reduction::Sum, &[zero]);
        let c = b.column(t, 0);
        let inside = b.mul(c, outside);
        let inside = roots(&mut b, inside, 20);
        let next = b.add(acc[0], inside);
        let out = b.end_fold(&[next])[0];
        let function = finish(b, out);

        let plan = Plan::new(&function, 8);
        let before = &plan.pieces(function.body)[0];
        let Then::Fold(fold) = before.then else { panic!("the fold is longer than a piece") };
        let InstKind::Fold(fold) = &function.insts[fold].kind else { panic!("a fold is cut") };
        assert!(plan.pieces(fold.body).len() > 2);
        assert_eq!(plan.slot(acc[0]), plan.slot(out));
        let [outside, accumulator] = [outside, out].map(|value| plan.slot(value).expect("pieces read it"));
        assert_ne!(outside, accumulator, "the next row reads both");
        assert_eq!(plan.slot(c), None, "a column is read where it is");

        assert!(Plan::new(&function, 40).is_whole());
    }
}
