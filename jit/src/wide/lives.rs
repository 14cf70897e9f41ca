//! Uses of values, their live ranges, and the register needs of loops.
//!
//! A value is alive from the item that defines it to its last use. If a value from outside is used inside a
//! loop, it is alive until the loop ends, because the next iteration reads it again. An accumulator has two
//! live ranges: in an iteration of its loop, from the top to its last use there (then it is set again), and
//! from the end of the loop to its last use after the loop.

use super::linear::{Definition, LinearCode, LinearItem, LoopId, NONE, Over, ValueName};

/// A value that a loop reads but does not compute.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Captured {
    pub(crate) name: ValueName,
    /// The number of reads in an iteration; reads in inner loops weigh more.
    pub(crate) weight: f32,
}

/// The assumed number of rows of a loop.
const ROWS: f32 = 8.0;

/// See the module.
pub(crate) struct Lives {
    /// Where the positions of each name's uses begin; one more entry for the end.
    starts: Vec<u32>,
    positions: Vec<u32>,
    /// The last position of each name, loops counted as a whole.
    pub(crate) last: Vec<u32>,
    /// The last position of an accumulator inside of its loop.
    pub(crate) last_in_body: Vec<u32>,
    /// The names whose live range ends at each position, the range inside of a loop included.
    death_starts: Vec<u32>,
    deaths: Vec<ValueName>,
    /// The names that each loop reads from outside, once each. The loop's own accumulators are among them.
    pub(crate) captured: Vec<Vec<Captured>>,
}

/// The operands of an item that is no loop.
fn operands(item: &LinearItem) -> ([ValueName; 3], usize) {
    match *item {
        LinearItem::Op { op, args, .. } => (args, op.operands().len()),
        LinearItem::Read { from, .. } => ([from, NONE, NONE], 1),
        LinearItem::Keep { value, .. } | LinearItem::Output { value, .. } => ([value, NONE, NONE], 1),
        LinearItem::Skip(_) | LinearItem::Open(_) | LinearItem::Close(_) => ([NONE; 3], 0),
    }
}

/// The name that an item computes.
pub(crate) fn computed(item: &LinearItem) -> Option<ValueName> {
    match *item {
        LinearItem::Op { to, .. } | LinearItem::Read { to, .. } => Some(to),
        LinearItem::Keep { .. }
        | LinearItem::Output { .. }
        | LinearItem::Skip(_)
        | LinearItem::Open(_)
        | LinearItem::Close(_) => None,
    }
}

/// Calls back with each use, in order: the name, the position, the loop that it is in.
fn for_each_use(linear: &LinearCode, mut each: impl FnMut(ValueName, u32, LoopId)) {
    let mut current = NONE;
    for (position, item) in (0..).zip(&linear.items) {
        let (args, count) = operands(item);
        for (index, &name) in args[..count].iter().enumerate() {
            if !args[..index].contains(&name) {
                each(name, position, current);
            }
        }
        match *item {
            LinearItem::Open(id) => {
                for phi in &linear.loops[id as usize].phis {
                    each(phi.initial, position, current);
                }
                current = id;
            }
            LinearItem::Close(id) => {
                for phi in &linear.loops[id as usize].phis {
                    each(phi.next, position, current);
                }
                current = linear.loops[id as usize].parent;
            }
            // An iteration that ends here passes the accumulators on unchanged.
            LinearItem::Skip(id) => {
                let data = &linear.loops[id as usize];
                let phis = data.phis.iter().map(|phi| phi.value);
                let phis = phis.filter(|phi| data.gate.iter().all(|(value, _)| value != phi));
                for name in data.gate.iter().map(|&(value, _)| value).chain(phis) {
                    each(name, position, current);
                }
            }
            LinearItem::Op { .. }
            | LinearItem::Read { .. }
            | LinearItem::Keep { .. }
            | LinearItem::Output { .. } => {}
        }
    }
}

/// Lists of items by key: where each key's list begins, and the items.
fn by_key(keys: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; keys + 1];
    for (key, _) in pairs.clone() {
        starts[key as usize + 1] += 1;
    }
    for key in 0..keys {
        starts[key + 1] += starts[key];
    }
    let (mut next, mut items) = (starts.clone(), vec![0; starts[keys] as usize]);
    for (key, item) in pairs {
        items[next[key as usize] as usize] = item;
        next[key as usize] += 1;
    }
    (starts, items)
}

impl Lives {
    pub(crate) fn new(linear: &LinearCode) -> Self {
        let names = linear.names.len();
        let (mut last, mut last_in_body) = (vec![0; names], vec![0; names]);
        for (position, item) in (0..).zip(&linear.items) {
            if let Some(name) = computed(item) {
                last[name as usize] = position;
            }
        }
        for data in &linear.loops {
            for phi in &data.phis {
                last[phi.value as usize] = data.close;
                last_in_body[phi.value as usize] = data.open;
            }
        }
        let mut uses = Vec::new();
        let mut raw: Vec<Vec<Captured>> = linear.loops.iter().map(|_| Vec::new()).collect();
        for_each_use(linear, |name, position, at| {
            uses.push((name, position));
            let (scope, is_in_body) = scope_at(linear, name, position);
            let mut end = position;
            for id in linear.outwards(at, scope) {
                end = linear.loops[id as usize].close;
            }
            let last = if is_in_body { &mut last_in_body } else { &mut last };
            last[name as usize] = last[name as usize].max(end);
            if at != scope {
                raw[at as usize].push(Captured { name, weight: 1.0 });
            }
        });
        let (starts, positions) = by_key(names, uses.iter().copied());
        let ends = ends(linear, &last, &last_in_body);
        let (death_starts, deaths) = by_key(linear.items.len(), ends.iter().copied());
        let captured = captured(linear, raw);
        Self { starts, positions, last, last_in_body, death_starts, deaths, captured }
    }

    /// The positions at which a name is used, ascending.
    pub(crate) fn uses(&self, name: ValueName) -> &[u32] {
        let [start, end] = [0, 1].map(|side| self.starts[name as usize + side] as usize);
        &self.positions[start..end]
    }

    /// The range of deaths at a position: names whose live range ends there, the range inside of a loop
    /// included.
    pub(crate) fn deaths(&self, position: u32) -> std::ops::Range<usize> {
        let [start, end] = [0, 1].map(|side| self.death_starts[position as usize + side] as usize);
        start..end
    }

    pub(crate) fn death(&self, index: usize) -> ValueName {
        self.deaths[index]
    }

    /// The last position that reads the value that a name has at `position`.
    pub(crate) fn end(&self, linear: &LinearCode, name: ValueName, position: u32) -> u32 {
        let (_, is_in_body) = scope_at(linear, name, position);
        if is_in_body { self.last_in_body[name as usize] } else { self.last[name as usize] }
    }
}

/// The loop whose iterations change a name, as seen from a position; and whether the name is an accumulator
/// inside of its loop.
fn scope_at(linear: &LinearCode, name: ValueName, position: u32) -> (LoopId, bool) {
    let data = &linear.names[name as usize];
    if let Definition::Phi(id) = data.kind {
        let own = &linear.loops[id as usize];
        if own.open < position && position <= own.close {
            return (id, true);
        }
    }
    (data.scope, false)
}

/// The ends of all live ranges: positions and names.
fn ends(linear: &LinearCode, last: &[u32], last_in_body: &[u32]) -> Vec<(u32, ValueName)> {
    let mut ends = Vec::with_capacity(linear.names.len());
    for (name, data) in (0..).zip(&linear.names) {
        ends.push((last[name as usize], name));
        if let Definition::Phi(_) = data.kind {
            ends.push((last_in_body[name as usize], name));
        }
    }
    ends
}

/// The values that each loop reads from outside, from the reads directly in each loop.
fn captured(linear: &LinearCode, mut raw: Vec<Vec<Captured>>) -> Vec<Vec<Captured>> {
    // Inner loops have larger ids than the loops around them.
    for id in (0..linear.loops.len()).rev() {
        let mut list = std::mem::take(&mut raw[id]);
        list.sort_unstable_by_key(|captured| captured.name);
        list.dedup_by(|next, first| {
            let is_same = next.name == first.name;
            if is_same {
                first.weight += next.weight;
            }
            is_same
        });
        let data = &linear.loops[id];
        if data.parent != NONE {
            let rounds = if matches!(data.over, Over::Guard(_)) { 1.0 } else { ROWS };
            let is_outside =
                |captured: &&Captured| scope_at(linear, captured.name, data.open).0 != data.parent;
            let outside = list.iter().filter(is_outside);
            let outside =
                outside.map(|&Captured { name, weight }| Captured { name, weight: weight * rounds });
            let outside: Vec<_> = outside.collect();
            raw[data.parent as usize].extend(outside);
        }
        for phi in &data.phis {
            let weight = linear_weight(phi.next == phi.value);
            list.push(Captured { name: phi.value, weight });
        }
        raw[id] = list;
    }
    raw
}

/// The weight of an accumulator in a register: each iteration reads and writes it.
const fn linear_weight(is_constant: bool) -> f32 {
    if is_constant { 0.5 } else { 3.0 }
}

/// For each loop, the largest number of registers, vectors and masks, for the values that it computes itself;
/// `vectors` is the number of vectors of a value.
pub(crate) fn pressure(
    linear: &LinearCode,
    lives: &Lives,
    vectors: usize,
    has_masks: bool,
) -> Vec<[usize; 2]> {
    let mut most = vec![[0; 2]; linear.loops.len()];
    // For each open loop, the live values that it computes directly.
    let mut alive: Vec<(LoopId, [isize; 2])> = vec![(NONE, [0; 2])];
    let size = |name: ValueName| {
        let data = &linear.names[name as usize];
        let count = if data.is_uniform { 1 } else { vectors as isize };
        (count, usize::from(data.is_mask && has_masks))
    };
    let mut add = |alive: &mut Vec<(LoopId, [isize; 2])>, level: usize, name: ValueName| {
        let (count, class) = size(name);
        alive[level].1[class] += count;
        let mut sum = [0; 2];
        for (id, alive) in alive.iter().rev() {
            sum = [sum[0] + alive[0], sum[1] + alive[1]];
            if *id != NONE {
                let most = &mut most[*id as usize];
                *most = [0, 1].map(|class| most[class].max(usize::try_from(sum[class]).unwrap_or(0)));
            }
        }
        level as u32
    };
    let mut levels = vec![NONE; linear.names.len()];
    for (position, item) in (0..).zip(&linear.items) {
        for index in lives.deaths(position) {
            let name = lives.death(index);
            let level = levels[name as usize];
            if level != NONE && lives.last[name as usize] == position {
                let (count, class) = size(name);
                alive[level as usize].1[class] -= count;
                levels[name as usize] = NONE;
            }
        }
        match *item {
            LinearItem::Op { to, .. } | LinearItem::Read { to, .. } => {
                let level = alive.len() - 1;
                let level = add(&mut alive, level, to);
                // Nobody reads it: it dies at once.
                if lives.last[to as usize] == position {
                    let (count, class) = size(to);
                    alive[level as usize].1[class] -= count;
                } else {
                    levels[to as usize] = level;
                }
            }
            LinearItem::Open(id) => {
                for phi in &linear.loops[id as usize].phis {
                    let level = alive.len() - 1;
                    levels[phi.value as usize] = add(&mut alive, level, phi.value);
                }
                alive.push((id, [0; 2]));
            }
            LinearItem::Close(_) => {
                alive.pop();
            }
            LinearItem::Keep { .. } | LinearItem::Output { .. } | LinearItem::Skip(_) => {}
        }
    }
    most
}
