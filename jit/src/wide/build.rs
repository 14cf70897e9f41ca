//! From the IR to the list: pieces of the plan, folds, ops.

use jbt_ir::pass::{Gate, Gates};
use jbt_ir::plan::{Plan, Slot, Then};
use jbt_ir::{Block, Entity, Fold, FoldKind, Function, Inst, InstKind, Op, Type, Value};
use rustc_hash::FxHashSet as HashSet;

use super::linear::{
    Data, Definition, Home, LinearCode, LinearItem, LinearLoop, LoopId, NONE, Over, POINTERS, Phi, ValueName,
};

/// The list of a function, cut into the pieces of a plan. Plan and gates belong to the function.
pub(crate) fn list(function: &Function, plan: &Plan, gates: &Gates) -> LinearCode {
    let mut builder = Builder {
        function,
        plan,
        gates,
        linear: LinearCode::default(),
        bindings: vec![Binding::Nothing; function.values.len()],
        rows: vec![NONE; function.tables.len()],
        current: NONE,
        points: NONE,
        depth: 0,
        kept: Vec::new(),
    };
    if plan.is_whole() {
        builder.pieces(function.body);
    } else {
        builder.open(Over::Strips, Vec::new());
        builder.pieces(function.body);
        builder.close();
    }
    builder.linear
}

/// The binding of an IR value.
#[derive(Clone, Copy)]
enum Binding {
    Nothing,
    Name(ValueName),
    /// To a leaf that has another name in each loop over points: its home, the last such loop, and its name
    /// there.
    PerPiece(Home, LoopId, ValueName),
}

/// The walk over a function.
struct Builder<'a> {
    function: &'a Function,
    plan: &'a Plan,
    /// The condition under which a row changes nothing, for each fold's body.
    gates: &'a Gates,
    linear: LinearCode,
    bindings: Vec<Binding>,
    /// The open loop over each table.
    rows: Vec<LoopId>,
    current: LoopId,
    /// The open loop over points.
    points: LoopId,
    depth: usize,
    /// The values that the current piece keeps for others.
    kept: Vec<Value>,
}

impl<'a> Builder<'a> {
    fn push(&mut self, item: LinearItem) {
        self.linear.items.push(item);
    }

    fn name(&mut self, data: Data) -> ValueName {
        self.linear.names.push(data);
        self.linear.names.len() as ValueName - 1
    }

    fn open(&mut self, over: Over, phis: Vec<Phi>) -> LoopId {
        let id = self.linear.loops.len() as LoopId;
        let open = self.linear.items.len() as u32;
        self.linear.loops.push(LinearLoop {
            over,
            parent: self.current,
            open,
            close: open,
            phis,
            inputs: 0,
            gate: Vec::new(),
        });
        self.push(LinearItem::Open(id));
        self.current = id;
        if let Some(table) = over.table() {
            self.rows[table.index()] = id;
            self.depth += 1;
            self.linear.depth = self.linear.depth.max(self.depth);
        }
        id
    }

    fn close(&mut self) {
        let id = self.current;
        self.push(LinearItem::Close(id));
        let close = self.linear.items.len() as u32 - 1;
        let data = &mut self.linear.loops[id as usize];
        data.close = close;
        self.current = data.parent;
        if let Some(table) = data.over.table() {
            self.rows[table.index()] = NONE;
            self.depth -= 1;
        }
    }

    /// The pieces of the function's body, or of the body of a fold that is cut.
    fn pieces(&mut self, block: Block) {
        let (function, plan) = (self.function, self.plan);
        let data = &function.blocks[block];
        for piece in plan.pieces(block) {
            let insts = &data.insts[piece.insts.clone()];
            if self.has_no_work(insts, piece.then) {
                insts.iter().for_each(|&inst| self.inst(inst));
            } else {
                self.points = self.open(Over::Points, Vec::new());
                match piece.then {
                    // The accumulators stay in their slots.
                    Then::End => self.insts(block, insts),
                    Then::Next | Then::Fold(_) => insts.iter().for_each(|&inst| self.inst(inst)),
                }
                match piece.then {
                    Then::Next => {}
                    Then::Fold(fold) => {
                        let (fold, _) = self.folded(fold);
                        self.keep_all(&function.blocks[fold.body].params, &fold.initial);
                    }
                    Then::End if block == function.body => self.outputs(&data.results),
                    Then::End => self.keep_all(&data.params, &data.results),
                }
                self.close();
                self.points = NONE;
                for value in std::mem::take(&mut self.kept) {
                    self.bind_slot(value);
                }
            }
            if let Then::Fold(fold) = piece.then {
                let (fold, results) = self.folded(fold);
                for &value in function.blocks[fold.body].params.iter().chain(results) {
                    self.bind_slot(value);
                }
                self.open(Over::RowsOfStrip(fold.table), Vec::new());
                self.pieces(fold.body);
                self.close();
            }
        }
    }

    /// Whether a piece computes nothing, and the fold after it finds its accumulators in their places.
    fn has_no_work(&self, insts: &[Inst], then: Then) -> bool {
        let is_ready = match then {
            Then::Next => true,
            Then::Fold(fold) => {
                let (fold, _) = self.folded(fold);
                self.moves(&self.function.blocks[fold.body].params, &fold.initial).next().is_none()
            }
            Then::End => false,
        };
        is_ready && insts.iter().all(|&inst| self.function.insts[inst].kind.is_leaf())
    }

    /// A fold instruction's fold and results.
    fn folded(&self, inst: Inst) -> (&'a Fold, &'a [Value]) {
        let data = &self.function.insts[inst];
        let InstKind::Fold(fold) = &data.kind else { unreachable!("a fold is cut, and nothing else") };
        (fold, &data.results)
    }

    fn bind_slot(&mut self, value: Value) {
        if let Some(slot) = self.plan.slot(value) {
            self.bindings[value.index()] = Binding::PerPiece(Home::Slot(slot), NONE, NONE);
        }
    }

    /// Pairs of target and source, without pairs that share a slot: these need no move.
    fn moves(&self, targets: &[Value], values: &[Value]) -> impl Iterator<Item = (Value, Value)> {
        let pairs = targets.iter().copied().zip(values.iter().copied());
        pairs.filter(|&(target, value)| self.plan.slot(target) != self.plan.slot(value))
    }

    /// Stores values into the slots of targets, as if all were read before the first is written.
    fn keep_all(&mut self, targets: &[Value], values: &[Value]) {
        let moves: Vec<_> = self.moves(targets, values).collect();
        let written: Vec<Slot> = moves.iter().filter_map(|&(target, _)| self.plan.slot(target)).collect();
        let mut names = Vec::with_capacity(moves.len());
        for &(_, value) in &moves {
            let mut name = self.read(value);
            let data = self.linear.names[name as usize];
            if let Definition::Leaf(Home::Slot(slot)) = data.kind
                && written.contains(&slot)
            {
                let from = name;
                name = self.name(Data { kind: Definition::Computed, ..data });
                self.push(LinearItem::Read { to: name, from });
            }
            names.push(name);
        }
        for ((target, _), value) in moves.into_iter().zip(names) {
            if let Some(slot) = self.plan.slot(target) {
                self.push(LinearItem::Keep { slot, value });
            }
        }
    }

    fn outputs(&mut self, results: &[Value]) {
        for (plane, &result) in results.iter().enumerate() {
            let value = self.read(result);
            self.push(LinearItem::Output { plane, value });
        }
    }

    /// The last instructions of a block, with the gate as early as possible.
    fn insts(&mut self, block: Block, insts: &[Inst]) {
        let function = self.function;
        let is_at_hand = |&(value, _): &(Value, f32)| {
            let here = |&inst: &Inst| {
                function.insts[inst].results.contains(&value) || function.operands(inst).contains(&value)
            };
            insts.iter().any(here) || function.blocks[block].results.contains(&value)
        };
        // A value that only an earlier piece computes, and that no instruction here reads, is not kept.
        let gate = self.gates[block].as_ref().filter(|Gate(gate)| gate.iter().all(is_at_hand));
        let Some(Gate(gate)) = gate else {
            return insts.iter().for_each(|&inst| self.inst(inst));
        };
        let mut wanted: HashSet<Value> = gate.iter().map(|&(value, _)| value).collect();
        let mut is_first = vec![false; insts.len()];
        for (at, &inst) in insts.iter().enumerate().rev() {
            jbt_ir::watch::look();
            let data = &function.insts[inst];
            is_first[at] = data.kind.is_leaf() || data.results.iter().any(|value| wanted.contains(value));
            if is_first[at] {
                wanted.extend(function.operands(inst));
                if let InstKind::Fold(fold) = &data.kind {
                    self.reads(fold.body, &mut wanted);
                }
            }
        }
        let mut both = insts.iter().zip(&is_first);
        both.clone().filter(|&(_, &is_first)| is_first).for_each(|(&inst, _)| self.inst(inst));
        let gate: Vec<_> = gate.iter().map(|&(value, number)| (self.read(value), number.to_bits())).collect();
        let id = self.current;
        self.linear.loops[id as usize].gate = gate;
        self.push(LinearItem::Skip(id));
        both.by_ref().filter(|&(_, &is_first)| !is_first).for_each(|(&inst, _)| self.inst(inst));
    }

    /// Collects the values that a block and its inner blocks read.
    fn reads(&self, block: Block, read: &mut HashSet<Value>) {
        let function = self.function;
        read.extend(&function.blocks[block].results);
        for &inst in &function.blocks[block].insts {
            jbt_ir::watch::look();
            read.extend(function.operands(inst));
            if let InstKind::Fold(fold) = &function.insts[inst].kind {
                self.reads(fold.body, read);
            }
        }
    }

    fn inst(&mut self, inst: Inst) {
        let function = self.function;
        let data = &function.insts[inst];
        let result = data.results.first().copied();
        match &data.kind {
            InstKind::Input(index) => self.bind_leaf(result, Home::Input(*index)),
            InstKind::Constant(number) => self.bind_leaf(result, Home::Number(number.to_bits())),
            InstKind::BitsConstant(bits) => self.bind_leaf(result, Home::Number(*bits)),
            InstKind::Column { table, column } => self.bind_leaf(result, Home::Column(*table, *column)),
            InstKind::Op { op, args } => {
                let result = data.results[0];
                self.op(*op, args, result);
                if let Some(slot) = self.plan.slot(result) {
                    let value = self.read(result);
                    self.push(LinearItem::Keep { slot, value });
                    self.kept.push(result);
                }
            }
            InstKind::Fold(fold) => self.fold(fold, &data.results),
        }
    }

    fn bind_leaf(&mut self, value: Option<Value>, home: Home) {
        let value = value.expect("a verified leaf defines one value").index();
        let scope = match home {
            Home::Number(_) => NONE,
            Home::Column(table, _) => self.rows[table.index()],
            Home::Input(_) | Home::Slot(_) => {
                self.bindings[value] = Binding::PerPiece(home, NONE, NONE);
                return;
            }
        };
        let data = Data { kind: Definition::Leaf(home), is_uniform: true, is_mask: false, scope };
        self.bindings[value] = Binding::Name(self.name(data));
    }

    /// The name of a value that an instruction here reads.
    fn read(&mut self, value: Value) -> ValueName {
        match self.bindings[value.index()] {
            Binding::Nothing => unreachable!("a verified function defines values before it uses them"),
            Binding::Name(name) => name,
            Binding::PerPiece(_, points, name) if points == self.points => name,
            Binding::PerPiece(home, ..) => {
                let is_mask = self.function.values[value] == Type::Mask;
                let data =
                    Data { kind: Definition::Leaf(home), is_uniform: false, is_mask, scope: self.points };
                let name = self.name(data);
                if let Home::Input(index) = home
                    && index < POINTERS
                {
                    self.linear.loops[self.points as usize].inputs |= 1 << index;
                }
                self.bindings[value.index()] = Binding::PerPiece(home, self.points, name);
                name
            }
        }
    }

    fn op(&mut self, op: Op, args: &[Value], result: Value) {
        if matches!(op, Op::StopGradient | Op::LowEnd | Op::ToBits | Op::FromBits) {
            let name = self.read(args[0]);
            self.bindings[result.index()] = Binding::Name(name);
            return;
        }
        let mut names = [NONE; 3];
        for (name, &arg) in names.iter_mut().zip(args) {
            *name = self.read(arg);
        }
        let mut known = names.iter().filter(|&&name| name != NONE);
        let is_uniform = known.all(|&name| self.linear.names[name as usize].is_uniform);
        let is_mask = op.result() == Type::Mask;
        let to = self.name(Data { kind: Definition::Computed, is_uniform, is_mask, scope: self.current });
        self.push(LinearItem::Op { op, to, args: names });
        self.bindings[result.index()] = Binding::Name(to);
    }

    /// A fold that is not cut.
    fn fold(&mut self, fold: &Fold, results: &[Value]) {
        let function = self.function;
        let body = &function.blocks[fold.body];
        let id = self.linear.loops.len() as LoopId;
        let mut phis = Vec::with_capacity(fold.initial.len());
        for (&initial, &param) in fold.initial.iter().zip(&body.params) {
            let initial = self.read(initial);
            let is_mask = function.values[param] == Type::Mask;
            let scope = self.current;
            let value = self.name(Data { kind: Definition::Phi(id), is_uniform: false, is_mask, scope });
            phis.push(Phi { value, initial, next: NONE });
            self.bindings[param.index()] = Binding::Name(value);
        }
        let is_guard = fold.kind == FoldKind::Guard;
        let over = if is_guard { Over::Guard(fold.table) } else { Over::Rows(fold.table) };
        self.open(over, phis);
        self.insts(fold.body, &body.insts);
        for (index, &next) in body.results.iter().enumerate() {
            let next = self.read(next);
            self.linear.loops[id as usize].phis[index].next = next;
        }
        self.close();
        for (&result, phi) in results.iter().zip(&self.linear.loops[id as usize].phis) {
            self.bindings[result.index()] = Binding::Name(phi.value);
        }
    }
}
