//! Gives every value a place: a register for a block, a slot for a splat.
//!
//! First, values that a copy would connect join one *class*, where their live ranges do not overlap: a fold's
//! parameter and its result always, its next value and its initial value where possible. So
//! `acc' = fma(a, b, acc)` writes the register that it reads, and a sum of sums keeps one register through
//! all its folds. Then classes get registers in order of their first definition: each the free register with
//! the lowest number (Poletto and Sarkar 1999, "Linear scan register allocation").

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use crate::entity::{Entity, Inst, Value};
use crate::function::InstKind;

use super::place::ScratchPlace;
use super::schedule::{Event, InstRange, Schedule};
use crate::watch::{look, look_now};

/// The places of all values.
pub(super) struct Places {
    /// By value. A value that only renames another one shares its place.
    pub places: Vec<ScratchPlace>,
    /// Number of registers.
    pub registers: usize,
    /// The bits of the constants: the first splats.
    pub constants: Vec<u32>,
    /// Number of splats, constants included.
    pub splats: usize,
}

pub(super) fn assign(schedule: &Schedule<'_>) -> Places {
    let classes = Classes::of(schedule);
    let mut places = Places {
        places: vec![ScratchPlace::splat(0); schedule.function.values.len()],
        registers: 0,
        constants: Vec::new(),
        splats: 0,
    };
    assign_splats(schedule, &mut places);
    assign_registers(schedule, &classes, &mut places);
    for value in schedule.function.values.keys() {
        look();
        places.places[value.index()] = places.places[schedule.holder[value.index()].index()];
    }
    places
}

/// Constants get the first slots, then every other splat gets one. A fold's result has the slot of its
/// parameter.
fn assign_splats(schedule: &Schedule<'_>, places: &mut Places) {
    let function = schedule.function;
    for data in function.insts.values() {
        look();
        let bits = match data.kind {
            InstKind::Constant(number) => number.to_bits(),
            InstKind::BitsConstant(bits) => bits,
            InstKind::Input(_) | InstKind::Column { .. } | InstKind::Op { .. } | InstKind::Fold(_) => {
                continue;
            }
        };
        places.places[data.results[0].index()] = ScratchPlace::splat(places.constants.len());
        places.constants.push(bits);
    }
    places.splats = places.constants.len();
    for event in &schedule.events {
        look();
        match *event {
            Event::Inst(inst) => match function.insts[inst].kind {
                InstKind::Constant(_) | InstKind::BitsConstant(_) => {}
                InstKind::Input(_) | InstKind::Column { .. } | InstKind::Op { .. } | InstKind::Fold(_) => {
                    assign_slot(schedule, places, &function.insts[inst].results);
                }
            },
            Event::Begin(inst) => {
                for accumulator in schedule.accumulators(inst) {
                    assign_slot(schedule, places, &[accumulator.param, accumulator.result]);
                }
            }
            Event::End(_) => {}
        }
    }
}

/// Gives values that share their bits one new slot, if they are splats.
fn assign_slot(schedule: &Schedule<'_>, places: &mut Places, values: &[Value]) {
    if values.iter().all(|value| schedule.splat[value.index()] && schedule.holder[value.index()] == *value) {
        for value in values {
            places.places[value.index()] = ScratchPlace::splat(places.splats);
        }
        places.splats += 1;
    }
}

/// Linear scan over the hulls of the classes.
fn assign_registers(schedule: &Schedule<'_>, classes: &Classes, places: &mut Places) {
    let mut hulls: Vec<Option<InstRange>> = vec![None; schedule.function.values.len()];
    let blocks = || {
        schedule
            .function
            .values
            .keys()
            .filter(|value| schedule.holder[value.index()] == *value && !schedule.splat[value.index()])
    };
    for value in blocks() {
        look();
        let range = schedule.live[value.index()];
        let hull = hulls[classes.root(value).index()].get_or_insert(range);
        hull.start = hull.start.min(range.start);
        hull.end = hull.end.max(range.end);
    }
    let roots = schedule.function.values.keys().zip(hulls);
    let mut order: Vec<(InstRange, Value)> = roots.filter_map(|(root, hull)| Some((hull?, root))).collect();
    look_now();
    order.sort_unstable_by_key(|&(range, value)| (range.start, value));
    look_now();

    let mut free: BinaryHeap<Reverse<usize>> = BinaryHeap::new();
    let mut busy: BinaryHeap<Reverse<(usize, usize)>> = BinaryHeap::new();
    let mut register_of: Vec<u32> = vec![0; schedule.function.values.len()];
    for (range, root) in order {
        look();
        while let Some(&Reverse((end, register))) = busy.peek()
            && end <= range.start
        {
            busy.pop();
            free.push(Reverse(register));
        }
        let register = free.pop().map_or_else(
            || {
                places.registers += 1;
                places.registers - 1
            },
            |Reverse(register)| register,
        );
        busy.push(Reverse((range.end, register)));
        register_of[root.index()] = register as u32;
    }
    for value in blocks() {
        look();
        let register = register_of[classes.root(value).index()];
        places.places[value.index()] = ScratchPlace::block(register as usize);
    }
}

/// Values that share a register, as a forest whose roots name the classes.
struct Classes {
    parent: Vec<Value>,
    /// Number of values in the class of a root.
    size: Vec<u32>,
    /// The live ranges of the class of a root, ascending, never touching. A root without an entry is alone in
    /// its class.
    ranges: HashMap<Value, Vec<InstRange>>,
}

impl Classes {
    fn of(schedule: &Schedule<'_>) -> Self {
        let mut classes = Self {
            parent: schedule.function.values.keys().collect(),
            size: vec![1; schedule.function.values.len()],
            ranges: HashMap::new(),
        };
        let folds: Vec<Inst> = schedule
            .events
            .iter()
            .filter_map(|event| match *event {
                Event::End(inst) => Some(inst),
                Event::Inst(_) | Event::Begin(_) => None,
            })
            .collect();
        let join = |classes: &mut Self, a: Value, b: Value| {
            if !schedule.splat[a.index()] && !schedule.splat[b.index()] {
                classes.join(schedule, a, b);
            }
        };
        for &fold in &folds {
            for accumulator in schedule.accumulators(fold) {
                // Their live ranges never overlap: the parameter dies at the fold's end at the latest, where
                // the result is defined.
                join(&mut classes, accumulator.param, accumulator.result);
            }
        }
        // Copies at the end of a body run once per row, copies at its beginning once per fold. So the copies
        // at the end are removed first.
        for &fold in &folds {
            for accumulator in schedule.accumulators(fold) {
                join(&mut classes, accumulator.param, accumulator.next);
            }
        }
        for &fold in &folds {
            for accumulator in schedule.accumulators(fold) {
                join(&mut classes, accumulator.param, accumulator.initial);
            }
        }
        classes
    }

    fn root(&self, mut value: Value) -> Value {
        while self.parent[value.index()] != value {
            value = self.parent[value.index()];
        }
        value
    }

    /// Joins the classes of two values, unless their live ranges overlap.
    fn join(&mut self, schedule: &Schedule<'_>, a: Value, b: Value) {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return;
        }
        let mut take =
            |root: Value| self.ranges.remove(&root).unwrap_or_else(|| vec![schedule.live[root.index()]]);
        let (a_ranges, b_ranges) = (take(a), take(b));
        // The shorter list is merged into the longer one, so that a long chain of folds stays cheap.
        let (mut ranges, others, swapped) = if a_ranges.len() >= b_ranges.len() {
            (a_ranges, b_ranges, false)
        } else {
            (b_ranges, a_ranges, true)
        };
        let overlap = others.iter().any(|other| {
            let next = ranges.partition_point(|range| range.end <= other.start);
            ranges.get(next).is_some_and(|range| range.start < other.end)
        });
        if overlap {
            let (a_ranges, b_ranges) = if swapped { (others, ranges) } else { (ranges, others) };
            self.ranges.insert(a, a_ranges);
            self.ranges.insert(b, b_ranges);
            return;
        }
        for other in others {
            insert(&mut ranges, other);
        }
        let (root, child) = if self.size[a.index()] >= self.size[b.index()] { (a, b) } else { (b, a) };
        self.size[root.index()] += self.size[child.index()];
        self.parent[child.index()] = root;
        self.ranges.insert(root, ranges);
    }
}

/// Adds a range that overlaps no range of the list. Ranges that touch are merged.
fn insert(ranges: &mut Vec<InstRange>, new: InstRange) {
    let at = ranges.partition_point(|range| range.end <= new.start);
    let joins_before = at > 0 && ranges[at - 1].end == new.start;
    let joins_after = ranges.get(at).is_some_and(|range| range.start == new.end);
    match (joins_before, joins_after) {
        (true, true) => {
            ranges[at - 1].end = ranges[at].end;
            ranges.remove(at);
        }
        (true, false) => ranges[at - 1].end = new.end,
        (false, true) => ranges[at].start = new.start,
        (false, false) => ranges.insert(at, new),
    }
}
