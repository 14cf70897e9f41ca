//! Writes the tape of a function, once every value has a place.

use crate::entity::{Entity, Inst, Table, Value};
use crate::function::{Function, InstKind};
use crate::watch::{look, look_now};

use super::assign::{Places, assign};
use super::pairs::MOST_OPERANDS;
use super::place::ScratchPlace;
use super::schedule::{Accumulator, Event, Paired, Schedule};
use super::tape::{Code, FoldStep, OpStep, Step, Tape};

pub(super) fn compile(function: &Function) -> Tape {
    let schedule = Schedule::new(function);
    look_now();
    let places = assign(&schedule);
    look_now();
    let mut compiler = Compiler::new(function, places);
    for event in &schedule.events {
        look();
        match *event {
            Event::Inst(inst) => {
                let result = function.insts[inst].results[0];
                if !schedule.is_first[inst.index()] && schedule.holder[result.index()] == result {
                    compiler.inst(inst, schedule.pair_of(inst));
                }
            }
            Event::Begin(inst) => {
                let accumulators: Vec<Accumulator> = schedule.accumulators(inst).collect();
                compiler.moves(accumulators.iter().map(|of| (of.initial, of.param)));
                compiler.begin(schedule.fold(inst).table);
            }
            Event::End(inst) => {
                let accumulators: Vec<Accumulator> = schedule.accumulators(inst).collect();
                compiler.moves(accumulators.iter().map(|of| (of.next, of.param)));
                compiler.end();
            }
        }
    }
    compiler.finish()
}

struct Compiler<'a> {
    function: &'a Function,
    places: Places,
    tape: Tape,
    /// The folds whose end has not come yet, by their number.
    open: Vec<usize>,
    /// Where a value waits while a cycle of moves is broken: a register and a splat, made when first needed.
    waiting: [Option<ScratchPlace>; 2],
    /// By place, for [`moves`](Self::moves): how many pending moves read it. All zero between calls.
    readers: [Vec<u32>; 2],
}

impl<'a> Compiler<'a> {
    fn new(function: &'a Function, places: Places) -> Self {
        let outputs = &function.blocks[function.body].results;
        let tape = Tape {
            inputs: function.inputs.len(),
            outputs: outputs.iter().map(|value| places.places[value.index()]).collect(),
            steps: Vec::new(),
            ops: Vec::new(),
            folds: Vec::new(),
            constants: places.constants.clone(),
            splats: places.splats,
            registers: places.registers,
            tables: function.tables.len(),
        };
        let readers = [vec![0; places.registers], vec![0; places.splats]];
        Self { function, places, tape, open: Vec::new(), waiting: [None; 2], readers }
    }

    fn finish(self) -> Tape {
        self.tape
    }

    fn place(&self, value: Value) -> ScratchPlace {
        self.places.places[value.index()]
    }

    /// Writes an instruction, or the pair whose second instruction it is.
    fn inst(&mut self, inst: Inst, pair: Option<&Paired>) {
        let data = &self.function.insts[inst];
        let result = self.place(data.results[0]);
        match &data.kind {
            InstKind::Input(plane) => {
                let (plane, register) = (narrow(*plane), narrow(result.index()));
                self.tape.steps.push(Step::Input { plane, register });
            }
            InstKind::Constant(_) | InstKind::BitsConstant(_) => {}
            InstKind::Column { table, column } => {
                let folds = &mut self.tape.folds;
                let fold = self.open.iter().rev().copied().find(|&fold| folds[fold].table == *table);
                let fold = fold.expect("a verified function reads a column inside the fold over its table");
                folds[fold].columns.push((narrow(*column), narrow(result.index())));
            }
            InstKind::Op { op, args } => {
                let (code, values) = match pair {
                    Some(pair) => (Code::Pair(pair.pair), &pair.args[..]),
                    None => (Code::Op(*op), &args[..]),
                };
                let mut places = [result; MOST_OPERANDS];
                for (place, &value) in places.iter_mut().zip(values) {
                    *place = self.place(value);
                }
                self.op(OpStep { code, args: places, result });
            }
            InstKind::Fold(_) => unreachable!("a fold has a beginning and an end"),
        }
    }

    fn op(&mut self, op: OpStep) {
        self.tape.ops.push(op);
        let end = narrow(self.tape.ops.len());
        match self.tape.steps.last_mut() {
            // Only ops directly before join this step; a fold's first step has a Begin before it.
            Some(Step::Ops { end: last, .. }) => *last = end,
            Some(Step::Input { .. } | Step::Move { .. } | Step::Begin { .. } | Step::End { .. }) | None => {
                self.tape.steps.push(Step::Ops { first: end - 1, end });
            }
        }
    }

    fn begin(&mut self, table: Table) {
        let fold = self.tape.folds.len();
        self.tape.steps.push(Step::Begin { fold: narrow(fold) });
        let body = self.tape.steps.len();
        let parent = self.function.tables[table].parent;
        self.tape.folds.push(FoldStep { table, parent, body, after: body, columns: Vec::new() });
        self.open.push(fold);
    }

    fn end(&mut self) {
        let fold = self.open.pop().expect("a fold begins before it ends");
        self.tape.steps.push(Step::End { fold: narrow(fold) });
        self.tape.folds[fold].after = self.tape.steps.len();
    }

    /// Copies values as if all at once: a place is written after all pending reads of it. In a cycle of
    /// moves, one value is first moved aside.
    fn moves(&mut self, moves: impl Iterator<Item = (Value, Value)>) {
        let mut pending: Vec<(ScratchPlace, ScratchPlace)> = moves
            .map(|(from, to)| (self.place(from), self.place(to)))
            .filter(|(from, to)| from != to)
            .collect();
        for &(from, _) in &pending {
            *self.readers_of(from) += 1;
        }
        // Which move writes a place: the last read of the place releases that move.
        let mut ready: Vec<usize> = Vec::new();
        let mut writer: Vec<(ScratchPlace, usize)> =
            pending.iter().enumerate().map(|(index, &(_, to))| (to, index)).collect();
        writer.sort_unstable();
        for (index, &(_, to)) in pending.iter().enumerate() {
            if *self.readers_of(to) == 0 {
                ready.push(index);
            }
        }
        let mut done = vec![false; pending.len()];
        for start in 0..pending.len() {
            while let Some(index) = ready.pop() {
                let (from, to) = pending[index];
                done[index] = true;
                self.tape.steps.push(Step::Move { from, to });
                *self.readers_of(from) -= 1;
                if *self.readers_of(from) == 0
                    && let Ok(found) = writer.binary_search_by_key(&from, |&(place, _)| place)
                {
                    ready.push(writer[found].1);
                }
            }
            if !done[start] {
                // Only cycles are left. In a cycle each place has one reader; the reader of `to` reads the
                // copy instead.
                let (_, to) = pending[start];
                let aside = self.aside(to);
                self.tape.steps.push(Step::Move { from: to, to: aside });
                let reader = pending.iter().zip(&done).position(|(&(from, _), done)| from == to && !done);
                let reader = reader.expect("a place that cannot be written yet has a reader");
                *self.readers_of(to) -= 1;
                *self.readers_of(aside) += 1;
                pending[reader].0 = aside;
                ready.push(start);
            }
        }
    }

    fn readers_of(&mut self, place: ScratchPlace) -> &mut u32 {
        &mut self.readers[usize::from(place.is_splat())][place.index()]
    }

    /// A place of the same kind that holds no value.
    fn aside(&mut self, place: ScratchPlace) -> ScratchPlace {
        let kind = usize::from(place.is_splat());
        let tape = &mut self.tape;
        let readers = &mut self.readers[kind];
        *self.waiting[kind].get_or_insert_with(|| {
            readers.push(0);
            if place.is_splat() {
                tape.splats += 1;
                ScratchPlace::splat(tape.splats - 1)
            } else {
                tape.registers += 1;
                ScratchPlace::block(tape.registers - 1)
            }
        })
    }
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index).expect("limits::MAX_VALUES keeps every index far below 2^32")
}
