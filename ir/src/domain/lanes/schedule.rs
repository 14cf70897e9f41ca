//! Puts the instructions of a function in one line, and finds out how long each value lives and which values are splats.
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
//! Time is counted in half positions: an event at `p` reads at `2 p` and writes at `2 p + 1`, so a value that dies where
//! another one is born may share its register.

use crate::entity::{Entity, Inst, Value};
use crate::function::{Fold, Function, InstKind};
use crate::op::Op;

/// What happens at a position.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Event {
    /// An instruction that is not a fold.
    Inst(Inst),
    /// A fold starts: the initial accumulators go to its parameters.
    Begin(Inst),
    /// The body of a fold ends: what it yields goes to its parameters, which are in the end the results.
    End(Inst),
}

/// When a value is alive: from its definition up to and without `end`, in half positions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Range {
    pub start: usize,
    pub end: usize,
}

/// A function in one line.
pub(super) struct Schedule<'a> {
    pub function: &'a Function,
    pub events: Vec<Event>,
    /// The value that holds the bits of each value: itself, unless an op like `hold` or `to_bits` only renames it.
    pub holder: Vec<Value>,
    /// For each holder, whether it is the same in all lanes.
    pub splat: Vec<bool>,
    /// For each holder, when it is alive.
    pub live: Vec<Range>,
}

impl<'a> Schedule<'a> {
    pub fn new(function: &'a Function) -> Self {
        let events = line_up(function);
        let holder = holders(function, &events);
        let splat = splats(function, &holder);
        let live = ranges(function, &events, &holder);
        Self { function, events, holder, splat, live }
    }

    /// The fold of an instruction that the events call one.
    pub fn fold(&self, inst: Inst) -> &'a Fold {
        fold(self.function, inst)
    }

    /// The fold's parameters, each with the value that it begins with, the next one and the result: all as holders.
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

/// Whether the op gives the bits of its operand: then it costs nothing.
fn renames(op: Op) -> bool {
    match op {
        Op::ToBits | Op::FromBits | Op::Hold => true,
        Op::Add
        | Op::Sub
        | Op::Mul
        | Op::Div
        | Op::Fma
        | Op::Neg
        | Op::Abs
        | Op::Sqrt
        | Op::Min
        | Op::Max => false,
        Op::Lt | Op::Le | Op::Eq | Op::Both | Op::Either | Op::Not | Op::Select => false,
        Op::BitAnd | Op::BitOr | Op::BitXor | Op::IntAdd | Op::IntSub | Op::Shl | Op::Shr => false,
        Op::Sin | Op::Cos | Op::Exp | Op::Ln | Op::Pow => false,
    }
}

fn holders(function: &Function, events: &[Event]) -> Vec<Value> {
    let mut holder: Vec<Value> = function.values.keys().collect();
    for event in events {
        let Event::Inst(inst) = *event else { continue };
        let data = &function.insts[inst];
        if let InstKind::Op { op, args } = &data.kind
            && renames(*op)
        {
            holder[data.results[0].index()] = holder[args[0].index()];
        }
    }
    holder
}

/// Follows the inputs to everything that they reach. What they do not reach is the same in all lanes.
fn splats(function: &Function, holder: &[Value]) -> Vec<bool> {
    let mut reaches: Vec<(Value, Value)> = Vec::new();
    let mut found: Vec<Value> = Vec::new();
    for data in function.insts.values() {
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
    for (from, to) in &mut reaches {
        (*from, *to) = (holder[from.index()], holder[to.index()]);
    }
    reaches.sort_unstable();

    let mut splat = vec![true; function.values.len()];
    while let Some(value) = found.pop() {
        if std::mem::replace(&mut splat[value.index()], false) {
            let first = reaches.partition_point(|&(from, _)| from < value);
            found.extend(reaches[first..].iter().take_while(|&&(from, _)| from == value).map(|&(_, to)| to));
        }
    }
    splat
}

fn ranges(function: &Function, events: &[Event], holder: &[Value]) -> Vec<Range> {
    let ends = ends_of_folds(events);
    let mut walk = Walk {
        holder,
        live: vec![Range { start: 0, end: 0 }; function.values.len()],
        depth: vec![0; function.values.len()],
        open: Vec::new(),
    };
    for (position, event) in events.iter().enumerate() {
        match *event {
            Event::Inst(inst) => {
                let data = &function.insts[inst];
                for &operand in function.operands(inst) {
                    walk.read(operand, position);
                }
                // A value that only renames another one has no life of its own.
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
struct Walk<'a> {
    holder: &'a [Value],
    live: Vec<Range>,
    /// How many folds enclose the definition of each value.
    depth: Vec<usize>,
    /// Where the open folds end.
    open: Vec<usize>,
}

impl Walk<'_> {
    fn write(&mut self, value: Value, position: usize) {
        let start = 2 * position + 1;
        self.live[value.index()] = Range { start, end: start + 1 };
        self.depth[value.index()] = self.open.len();
    }

    fn read(&mut self, value: Value, position: usize) {
        let value = self.holder[value.index()].index();
        // A value from outside of a fold is needed again in its next round: it lives to the end of the fold.
        let last = self.open.get(self.depth[value]).copied().unwrap_or(position);
        let range = &mut self.live[value];
        range.end = range.end.max(2 * last + 1);
    }
}
