//! Runs a tape: for each block of points, step after step.
//!
//! Everything here is inlined into one function per [`Level`](super::level::Level), each op's loop included.

use crate::entity::Entity;
use crate::op::{Domain, Op};
use crate::selection::Selection;
use crate::table::Tables;

use super::ops::{Handle, Lanes, WIDTH};
use super::place::ScratchPlace;
use super::tape::{Code, FoldStep, OpStep, OpenFold, Scratch, Step, Tape};

/// What to run, on what. Planes and scratch have been checked against the tape.
pub(super) struct Job<'a, 'o> {
    pub tape: &'a Tape,
    pub tables: &'a Tables,
    pub selection: &'a Selection,
    pub inputs: &'a [&'a [f32]],
    pub outputs: &'a mut [&'o mut [f32]],
    pub scratch: &'a mut Scratch,
    /// The length of every plane.
    pub points: usize,
}

/// Runs all blocks.
#[inline(always)]
pub(super) fn execute(job: Job<'_, '_>) {
    let Job { tape, tables, selection, inputs, outputs, scratch, points } = job;
    let Scratch { file, splats, positions, open } = scratch;
    let mut start = 0;
    while start < points {
        let count = (points - start).min(tape.block());
        // The last block has only the chunks that it needs.
        let chunks = count.div_ceil(WIDTH);
        let mut block = Block {
            tape,
            tables,
            selection,
            lanes: Lanes { file: &mut file[..chunks * tape.stride()], stride: tape.stride(), result: 0 },
            splats,
            positions,
            open,
        };
        block.run(inputs, start, count);
        for (&place, output) in tape.outputs.iter().zip(outputs.iter_mut()) {
            block.store(place, &mut output[start..start + count]);
        }
        start += count;
    }
}

/// One block of points.
struct Block<'a> {
    tape: &'a Tape,
    tables: &'a Tables,
    selection: &'a Selection,
    lanes: Lanes<'a>,
    splats: &'a mut [u32],
    positions: &'a mut [u32],
    open: &'a mut Vec<OpenFold>,
}

impl Block<'_> {
    #[inline(always)]
    fn run(&mut self, inputs: &[&[f32]], start: usize, count: usize) {
        let mut at = 0;
        while let Some(&step) = self.tape.steps.get(at) {
            at += 1;
            match step {
                Step::Input { plane, register } => {
                    self.lanes.load(register as usize, &inputs[plane as usize][start..start + count]);
                }
                Step::Move { from, to } => self.copy(from, to),
                Step::Ops { first, end } => {
                    for op in &self.tape.ops[first as usize..end as usize] {
                        self.step(op);
                    }
                }
                Step::Begin { fold } => {
                    let fold = &self.tape.folds[fold as usize];
                    let starts = self.selection.starts(fold.table);
                    let parent = fold.parent.map_or(0, |parent| self.positions[parent.index()] as usize);
                    self.open.push(OpenFold { next: starts[parent], end: starts[parent + 1] });
                    at = self.next_row(fold);
                }
                Step::End { fold } => at = self.next_row(&self.tape.folds[fold as usize]),
            }
        }
    }

    /// Makes the innermost fold's next active row the current one. Returns the position of the next step.
    #[inline(always)]
    fn next_row(&mut self, fold: &FoldStep) -> usize {
        let open = self.open.last_mut().expect("a fold begins before it ends");
        if open.next == open.end {
            self.open.pop();
            return fold.after;
        }
        let row = self.selection.active(fold.table)[open.next as usize];
        self.positions[fold.table.index()] = open.next;
        open.next += 1;
        let numbers = self.tables.tables[fold.table].row(row as usize);
        for &(column, splat) in &fold.columns {
            self.splats[splat as usize] = numbers[column as usize].to_bits();
        }
        fold.body
    }

    #[inline(always)]
    fn handle(&self, place: ScratchPlace) -> Handle {
        if place.is_splat() {
            Handle::Splat(self.splats[place.index()])
        } else {
            Handle::Block(place.index())
        }
    }

    #[inline(always)]
    fn copy(&mut self, from: ScratchPlace, to: ScratchPlace) {
        let from = self.handle(from);
        match from {
            Handle::Splat(bits) if to.is_splat() => self.splats[to.index()] = bits,
            Handle::Splat(_) | Handle::Block(_) => self.lanes.copy(from, to.index()),
        }
    }

    /// Copies the first points of a register, or a splat, to an output plane.
    #[inline(always)]
    fn store(&self, place: ScratchPlace, output: &mut [f32]) {
        match self.handle(place) {
            Handle::Splat(bits) => output.fill(f32::from_bits(bits)),
            Handle::Block(register) => self.lanes.store(register, output),
        }
    }

    #[inline(always)]
    fn step(&mut self, step: &OpStep) {
        match step.code {
            Code::Op(op) => self.op(op, step),
            Code::Pair(pair) => {
                self.lanes.result = step.result.index();
                self.lanes.pair(pair, &step.args, self.splats);
            }
        }
    }

    /// The method of an op. Like [`apply`](crate::op::apply), but without a check of types: the verifier has
    /// checked them.
    #[inline(always)]
    fn op(&mut self, op: Op, step: &OpStep) {
        let [a, b, c, ..] = step.args;
        let args = [self.handle(a), self.handle(b), self.handle(c)];
        self.lanes.result = step.result.index();
        let lanes = &mut self.lanes;
        macro_rules! dispatch {
            ($(
                $(#[doc = $doc:literal])*
                $variant:ident $name:ident ( $($arg:ident : $type:ident),+ ) -> $result:ident $(, $flag:ident)*;
            )+) => {
                match op {
                    $(Op::$variant => {
                        let [$($arg,)+ ..] = args;
                        lanes.$name($($arg),+)
                    })+
                }
            };
        }
        let result = crate::for_each_op!(dispatch);
        if let Handle::Splat(bits) = result {
            self.splats[step.result.index()] = bits;
        }
    }
}
