//! One walk through a function, in the order of execution, for all that makes something else of it: another
//! function, or ranges of its values.
//!
//! ```text
//! block:  for each instruction, in order: look its operands up, translate it, remember what its result became
//! fold:   parts = the parts of the initial accumulators
//!         for each run of the body:
//!             accumulators = whole(enter(parts));  block;  parts = leave(the parts of the next accumulators)
//!         results = whole(parts)
//! ```
//!
//! What differs is a `Translation`: what a value becomes, which parts of an accumulator are carried through
//! a fold, and how a fold begins and ends.
//!
//! ```text
//!                        a value becomes    parts of an accumulator                       runs of a body
//! rewrite, renumber      a value            the value                                     1: a new fold is written
//! gradient               a dual             the value, or with it three derivatives       1
//! interval               a range            two bounds, two masks; one value of a point   1
//! enclose                a range            the same, of numbers                          one for each row
//! straight code          a value            the value                                     1, or one for each row
//! ```
//!
//! Two walks are none of these. The interpreter ([`crate::interpret`]) has a loop of its own, because it
//! judges what translations make. The search for facts (`facts.rs`) goes through a function again and again,
//! until the facts of its accumulators agree.
//!
//! The recursion is over nested folds, at most [`crate::limits::MAX_FOLD_DEPTH`] deep; a block may be as long
//! as it likes.

mod copies;

pub use copies::{renumber, rewrite};

use smallvec::SmallVec;

use crate::entity::{Block, Entity, Inst, Table, Value};
use crate::function::{Fold, Function, InstData, InstKind};
use crate::op::Op;
use crate::origin::Origin;
use crate::watch::look;

/// The parts of some accumulators, one accumulator behind the other. Four take no allocation.
pub(crate) type AccumulatorParts<P> = SmallVec<[P; 4]>;

/// What a function becomes, piece by piece. Methods are called in the order of execution.
pub(crate) trait Translation {
    /// What a value becomes.
    type Value: Copy;
    /// A part of an accumulator: what folds carry.
    type Part: Copy;

    /// Comes before each instruction, with the instruction's origin.
    fn begin(&mut self, origin: Origin);

    /// An input plane.
    fn input(&mut self, index: usize) -> Self::Value;

    /// A constant.
    fn constant(&mut self, number: f32) -> Self::Value;

    /// Constant bits.
    fn bits_constant(&mut self, bits: u32) -> Self::Value;

    /// A column of the current row of a table.
    fn column(&mut self, table: Table, column: usize) -> Self::Value;

    /// The result of `inst`, which does `op`, for these operands.
    fn op(&mut self, inst: &InstData, op: Op, args: &[Self::Value]) -> Self::Value;

    /// Appends the parts of a value that the accumulator takes.
    fn split(&mut self, value: Self::Value, accumulator: Value, parts: &mut AccumulatorParts<Self::Part>);

    /// The accumulator, made of the next parts in the order of [`split`](Self::split).
    fn whole(&mut self, accumulator: Value, next: impl FnMut() -> Self::Part) -> Self::Value;

    /// How often the walk goes through the body of a fold: once, if the fold is written again.
    fn runs(&mut self, _fold: &Fold) -> usize {
        1
    }

    /// Before a run of the body: the accumulators inside, from the initial ones or from the last run.
    fn enter(
        &mut self,
        fold: &Fold,
        run: usize,
        parts: AccumulatorParts<Self::Part>,
    ) -> AccumulatorParts<Self::Part>;

    /// After a run of the body: the accumulators outside, from the next ones. `origin` is that of the fold.
    fn leave(
        &mut self,
        fold: &Fold,
        origin: Origin,
        next: AccumulatorParts<Self::Part>,
    ) -> AccumulatorParts<Self::Part>;
}

/// Goes through the whole function. Returns what its outputs became.
pub(crate) fn translate<T: Translation>(function: &Function, translation: &mut T) -> Vec<T::Value> {
    let mut walk = Walk { function, translation, values: vec![None; function.values.len()] };
    walk.block(function.body);
    function.blocks[function.body].results.iter().map(|&value| walk.value(value)).collect()
}

/// A walk through one function.
struct Walk<'a, T: Translation> {
    function: &'a Function,
    translation: &'a mut T,
    /// What each value has become.
    values: Vec<Option<T::Value>>,
}

impl<T: Translation> Walk<'_, T> {
    fn value(&self, value: Value) -> T::Value {
        self.values[value.index()].expect("values are defined before use")
    }

    fn block(&mut self, block: Block) {
        let function = self.function;
        for &inst in &function.blocks[block].insts {
            self.inst(inst);
        }
    }

    fn inst(&mut self, inst: Inst) {
        let function = self.function;
        let data = &function.insts[inst];
        look();
        self.translation.begin(data.origin);
        let result = match &data.kind {
            InstKind::Input(index) => self.translation.input(*index),
            InstKind::Constant(number) => self.translation.constant(*number),
            InstKind::BitsConstant(bits) => self.translation.bits_constant(*bits),
            InstKind::Column { table, column } => self.translation.column(*table, *column),
            InstKind::Op { op, args } => {
                // The op table has at most three operands; unused places repeat the first.
                let mut operands = [self.value(args[0]); 3];
                for (place, &arg) in operands.iter_mut().zip(args).skip(1) {
                    *place = self.value(arg);
                }
                self.translation.op(data, *op, &operands[..args.len()])
            }
            InstKind::Fold(fold) => return self.fold(data, fold),
        };
        self.values[data.results[0].index()] = Some(result);
    }

    fn fold(&mut self, data: &InstData, fold: &Fold) {
        let function = self.function;
        let body = &function.blocks[fold.body];
        let mut parts = self.split(&fold.initial, &body.params);
        for run in 0..self.translation.runs(fold) {
            let inside = self.translation.enter(fold, run, parts);
            self.bind(&body.params, &body.params, inside);
            self.block(fold.body);
            let next = self.split(&body.results, &body.params);
            parts = self.translation.leave(fold, data.origin, next);
        }
        self.bind(&data.results, &body.params, parts);
    }

    /// The parts of these values, as their accumulators take them.
    fn split(&mut self, values: &[Value], accumulators: &[Value]) -> AccumulatorParts<T::Part> {
        let mut parts = AccumulatorParts::new();
        for (&value, &accumulator) in values.iter().zip(accumulators) {
            let value = self.value(value);
            self.translation.split(value, accumulator, &mut parts);
        }
        parts
    }

    /// Gives values the parts of these accumulators.
    fn bind(&mut self, values: &[Value], accumulators: &[Value], parts: AccumulatorParts<T::Part>) {
        let mut parts = parts.into_iter();
        for (&value, &accumulator) in values.iter().zip(accumulators) {
            let next = || parts.next().expect("an accumulator is made of the parts that it was split into");
            self.values[value.index()] = Some(self.translation.whole(accumulator, next));
        }
    }
}
