//! Puts the instructions of a function in one line, and finds out how long each value lives and which values
//! are splats.
//!
//! ```text
//!     position   event                     a value that is defined at 1 and used at 4 lives to 6:
//!        0       v0 = input x              the loop comes back to 4
//!        1       v1 = v0 * v0
//!        2       v2 = const 0
//!        3       begin fold (v2 → v3)      v3 is defined here,
//!        4         v4 = v3 + v1
//!        5         ...
//!        6       end fold (v4 → v3), v5    v4 is used here, the result v5 is defined here
//! ```
//!
//! Time is counted in half positions: an event at `p` reads at `2 p` and writes at `2 p + 1`, so a value that
//! dies where another one is born may share its register.

use crate::entity::{Entity, Inst, Value};
use crate::function::{Fold, Function, InstKind};

use super::pairs::{FusedPair, MOST_OPERANDS, find};
use crate::watch::{look, look_now};

/// What happens at a position.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Event {
    /// An instruction that is not a fold.
    Inst(Inst),
    /// A fold starts: the initial accumulators go to its parameters.
    Begin(Inst),
    /// The body of a fold ends: what it yields goes to its parameters, which after the last row are the
    /// results.
    End(Inst),
}

/// When a value is alive: from its definition up to and without `end`, in half positions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct InstRange {
    pub start: usize,
    pub end: usize,
}

/// A function in one line.
pub(super) struct Schedule<'a> {
    pub function: &'a Function,
    pub events: Vec<Event>,
    /// The value that holds the bits of each value: itself, unless an op like `stop_gradient` or `to_bits`
    /// only renames it.
    pub holder: Vec<Value>,
    /// For each holder, whether it is the same in all lanes.
    pub splat: Vec<bool>,
    /// For each holder, when it is alive.
    pub live: Vec<InstRange>,
    /// By instruction, whether it is the first of a pair, and runs in the loop of the next instruction.
    pub is_first: Vec<bool>,
    /// The pairs, by their second instruction, in order.
    pairs: Vec<Paired>,
}

/// Two instructions that run in one loop.
pub(super) struct Paired {
    second: Inst,
    pub pair: FusedPair,
    pub args: [Value; MOST_OPERANDS],
}

impl<'a> Schedule<'a> {
    pub fn new(function: &'a Function) -> Self {
        let mut events = line_up(function);
        let holder = holders(function, &events);
        let splat = splats(function, &holder);
        let mut pairing = Pairing::new(function, &holder, &splat);
        let insts = |event: &Event| matches!(event, Event::Inst(_));
        for run in events.chunk_by_mut(|a, b| insts(a) && insts(b)) {
            pairing.run(run);
        }
        let Pairing { is_first, mut pairs, .. } = pairing;
        pairs.sort_unstable_by_key(|pair| pair.second);
        let live = ranges(function, &events, &holder);
        Self { function, events, holder, splat, live, is_first, pairs }
    }

    /// The pair whose second instruction this is.
    pub fn pair_of(&self, inst: Inst) -> Option<&Paired> {
        self.pairs.binary_search_by_key(&inst, |pair| pair.second).ok().map(|at| &self.pairs[at])
    }

    /// The fold of an instruction in a `Begin` or `End` event.
    pub fn fold(&self, inst: Inst) -> &'a Fold {
        fold(self.function, inst)
    }

    /// The accumulators of a fold: parameter, initial value, next value and result, all as holders.
    pub fn accumulators(&self, inst: Inst) -> impl Iterator<Item = Accumulator> + use<'_, 'a> {
        let fold = self.fold(inst);
        let body = &self.function.blocks[fold.body];
        let results = &self.function.insts[inst].results;
        (0..body.params.len()).map(move |index| Accumulator {
            param: body.params[index],
            initial: self.holder[fold.initial[index].index()],
            next: self.holder[body.results[index].index()],
            result: results[index],
        })
    }
}

/// One accumulator of a fold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accumulator {
    pub param: Value,
    pub initial: Value,
    pub next: Value,
    pub result: Value,
}

fn fold(function: &Function, inst: Inst) -> &Fold {
    match &function.insts[inst].kind {
        InstKind::Fold(fold) => fold,
        InstKind::Input(_)
        | InstKind::Constant(_)
        | InstKind::BitsConstant(_)
        | InstKind::Column { .. }
        | InstKind::Op { .. } => unreachable!("only folds begin and end"),
    }
}

/// All instructions in order of execution, folds as a beginning and an end.
fn line_up(function: &Function) -> Vec<Event> {
    let mut events = Vec::with_capacity(function.insts.len());
    // The blocks that are being walked: what is left of each, and the fold that it is the body of.
    let mut open = vec![(function.blocks[function.body].insts.iter(), None)];
    while let Some((insts, of)) = open.last_mut() {
        look();
        match insts.next() {
            Some(&inst) => match &function.insts[inst].kind {
                InstKind::Fold(fold) => {
                    events.push(Event::Begin(inst));
                    open.push((function.blocks[fold.body].insts.iter(), Some(inst)));
                }
                InstKind::Input(_)
                | InstKind::Constant(_)
                | InstKind::BitsConstant(_)
                | InstKind::Column { .. }
                | InstKind::Op { .. } => events.push(Event::Inst(inst)),
            },
            None => {
                events.extend(of.map(Event::End));
                open.pop();
            }
        }
    }
    events
}

/// The search for pairs.
struct Pairing<'a> {
    function: &'a Function,
    holder: &'a [Value],
    splat: &'a [bool],
    /// By holder: how often it is read.
    reads: Vec<u32>,
    /// By holder: the instruction of the current run of ops that computes it, if it may be the first of a
    /// pair.
    writer: Vec<Option<Inst>>,
    is_first: Vec<bool>,
    pairs: Vec<Paired>,
}

impl<'a> Pairing<'a> {
    fn new(function: &'a Function, holder: &'a [Value], splat: &'a [bool]) -> Self {
        let mut reads = vec![0; function.values.len()];
        let mut read = |values: &[Value]| {
            for value in values {
                reads[holder[value.index()].index()] += 1;
            }
        };
        for inst in function.insts.keys() {
            look();
            let result = function.insts[inst].results.first();
            if result.is_none_or(|result| holder[result.index()] == *result) {
                read(function.operands(inst));
            }
        }
        function.blocks.values().for_each(|block| read(&block.results));
        let (insts, values) = (function.insts.len(), function.values.len());
        Self {
            function,
            holder,
            splat,
            reads,
            writer: vec![None; values],
            is_first: vec![false; insts],
            pairs: Vec::new(),
        }
    }

    /// Finds the pairs among instructions that follow each other, and puts each first one directly before its
    /// second.
    fn run(&mut self, events: &mut [Event]) {
        let mut first_of: Vec<(Inst, Inst)> = Vec::new();
        for event in events.iter() {
            look();
            if let Event::Inst(inst) = *event
                && let Some(first) = self.pair(inst)
            {
                first_of.push((inst, first));
            }
        }
        let mut order: Vec<Event> = Vec::with_capacity(events.len());
        let mut first_of = first_of.into_iter().peekable();
        for event in events.iter() {
            look();
            let Event::Inst(inst) = *event else {
                order.push(*event);
                continue;
            };
            if let Some((_, first)) = first_of.next_if(|&(second, _)| second == inst) {
                order.push(Event::Inst(first));
            }
            if !self.is_first[inst.index()] {
                order.push(*event);
            }
        }
        look_now();
        events.copy_from_slice(&order);
        for event in order {
            look();
            if let Event::Inst(inst) = event {
                self.writer[self.function.insts[inst].results[0].index()] = None;
            }
        }
    }

    /// The earlier instruction that forms a pair with this one.
    fn pair(&mut self, inst: Inst) -> Option<Inst> {
        let data = &self.function.insts[inst];
        let InstKind::Op { op, .. } = data.kind else { return None };
        let result = data.results[0];
        if self.splat[result.index()] || self.holder[result.index()] != result {
            return None;
        }
        let args = self.holders_of(inst);
        for &t in &args {
            let Some(first) = self.writer[t.index()] else { continue };
            let reads = args.iter().filter(|&&arg| arg == t).count();
            let InstKind::Op { op: first_op, .. } = self.function.insts[first].kind else { continue };
            if self.reads[t.index()] as usize != reads {
                continue;
            }
            let of_first = self.holders_of(first);
            let is_splat = |value: Value| self.splat[value.index()];
            if let Some((pair, args)) = find((first_op, &of_first), t, (op, &args), is_splat) {
                self.is_first[first.index()] = true;
                self.pairs.push(Paired { second: inst, pair, args });
                return Some(first);
            }
        }
        self.writer[result.index()] = Some(inst);
        None
    }

    fn holders_of(&self, inst: Inst) -> Vec<Value> {
        self.function.operands(inst).iter().map(|value| self.holder[value.index()]).collect()
    }
}

fn holders(function: &Function, events: &[Event]) -> Vec<Value> {
    let mut holder: Vec<Value> = function.values.keys().collect();
    for event in events {
        look();
        let Event::Inst(inst) = *event else { continue };
        let data = &function.insts[inst];
        if let InstKind::Op { op, args } = &data.kind
            && op.renames()
        {
            holder[data.results[0].index()] = holder[args[0].index()];
        }
    }
    holder
}

/// Follows the inputs to every value that depends on them. All other values are splats.
fn splats(function: &Function, holder: &[Value]) -> Vec<bool> {
    let mut reaches: Vec<(Value, Value)> = Vec::new();
    let mut found: Vec<Value> = Vec::new();
    for data in function.insts.values() {
        look();
        match &data.kind {
            InstKind::Input(_) => found.push(data.results[0]),
            InstKind::Constant(_) | InstKind::BitsConstant(_) | InstKind::Column { .. } => {}
            InstKind::Op { args, .. } => reaches.extend(args.iter().map(|&arg| (arg, data.results[0]))),
            InstKind::Fold(fold) => {
                let body = &function.blocks[fold.body];
                for (index, &param) in body.params.iter().enumerate() {
                    reaches.push((fold.initial[index], param));
                    reaches.push((body.results[index], param));
                    reaches.push((param, data.results[index]));
                }
            }
        }
    }
    // By value: where those begin that it reaches.
    let mut starts = vec![0_u32; function.values.len() + 1];
    for (from, to) in &mut reaches {
        look();
        (*from, *to) = (holder[from.index()], holder[to.index()]);
        starts[from.index() + 1] += 1;
    }
    for value in 0..function.values.len() {
        starts[value + 1] += starts[value];
    }
    let (mut next, mut reached) = (starts.clone(), vec![Value::new(0); reaches.len()]);
    for (from, to) in reaches {
        look();
        let place = &mut next[from.index()];
        reached[*place as usize] = to;
        *place += 1;
    }

    let mut splat = vec![true; function.values.len()];
    while let Some(value) = found.pop() {
        look();
        if std::mem::replace(&mut splat[value.index()], false) {
            let [first, end] = [0, 1].map(|of| starts[value.index() + of] as usize);
            found.extend(&reached[first..end]);
        }
    }
    splat
}

fn ranges(function: &Function, events: &[Event], holder: &[Value]) -> Vec<InstRange> {
    let ends = ends_of_folds(events);
    let mut walk = ScheduleWalk {
        holder,
        live: vec![InstRange { start: 0, end: 0 }; function.values.len()],
        depth: vec![0; function.values.len()],
        open: Vec::new(),
    };
    for (position, event) in events.iter().enumerate() {
        look();
        match *event {
            Event::Inst(inst) => {
                let data = &function.insts[inst];
                for &operand in function.operands(inst) {
                    walk.read(operand, position);
                }
                // A value that only renames another one has no live range.
                if walk.holder[data.results[0].index()] == data.results[0] {
                    walk.write(data.results[0], position);
                }
            }
            Event::Begin(inst) => {
                let fold = fold(function, inst);
                for &initial in &fold.initial {
                    walk.read(initial, position);
                }
                walk.open.push(ends[position]);
                for &param in &function.blocks[fold.body].params {
                    walk.write(param, position);
                }
            }
            Event::End(inst) => {
                for &next in &function.blocks[fold(function, inst).body].results {
                    walk.read(next, position);
                }
                walk.open.pop();
                for &result in &function.insts[inst].results {
                    walk.write(result, position);
                }
            }
        }
    }
    for &output in &function.blocks[function.body].results {
        walk.read(output, events.len());
    }
    walk.live
}

/// For the position of each beginning, the position of its end.
fn ends_of_folds(events: &[Event]) -> Vec<usize> {
    let mut ends = vec![0; events.len()];
    let mut open = Vec::new();
    for (position, event) in events.iter().enumerate() {
        match event {
            Event::Inst(_) => {}
            Event::Begin(_) => open.push(position),
            Event::End(_) => ends[open.pop().expect("a fold begins before it ends")] = position,
        }
    }
    ends
}

/// The walk over the events that finds the live ranges.
struct ScheduleWalk<'a> {
    holder: &'a [Value],
    live: Vec<InstRange>,
    /// How many folds enclose the definition of each value.
    depth: Vec<usize>,
    /// Where the open folds end.
    open: Vec<usize>,
}

impl ScheduleWalk<'_> {
    fn write(&mut self, value: Value, position: usize) {
        let start = 2 * position + 1;
        self.live[value.index()] = InstRange { start, end: start + 1 };
        self.depth[value.index()] = self.open.len();
    }

    fn read(&mut self, value: Value, position: usize) {
        let value = self.holder[value.index()].index();
        // The next iteration reads a value from outside of the fold again: it lives to the end of the fold.
        let last = self.open.get(self.depth[value]).copied().unwrap_or(position);
        let range = &mut self.live[value];
        range.end = range.end.max(2 * last + 1);
    }
}
