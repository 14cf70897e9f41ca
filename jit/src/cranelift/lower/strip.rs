//! The pieces of a function, each over a strip of points, and what they hand to each other.

use std::collections::HashSet;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::{F32X4, I32X4, I64};
use cranelift_codegen::ir::{self, BlockArg, InstBuilder};
use jbt_ir::plan::{Column, Piece, Slot, Then};
use jbt_ir::{Any, Block, Entity, Fold, Inst, InstKind, Type, Value};

use super::{Lowering, PointBlock, SLOT, Strip, ValuePlace, offset};
use crate::cranelift::vectors::{VECTOR_BYTES, Vectors};

impl<'f, const K: usize> Lowering<'f, K> {
    /// Emits a loop over offsets in the planes, which runs at least once: `from` is before `to`. Its last
    /// step may end behind `to`.
    pub(super) fn repeat(
        &mut self,
        from: ir::Value,
        to: ir::Value,
        step: usize,
        body: impl FnOnce(&mut Self, ir::Value),
    ) {
        let builder = &mut self.vectors.builder;
        let [head, done] = [(); 2].map(|()| builder.create_block());
        let offset = builder.append_block_param(head, I64);
        builder.ins().jump(head, &[BlockArg::Value(from)]);
        self.switch_to(head);
        body(self, offset);
        let builder = &mut self.vectors.builder;
        let next = builder.ins().iadd_imm_s(offset, step as i64);
        let more = builder.ins().icmp(IntCC::UnsignedLessThan, next, to);
        builder.ins().brif(more, head, &[BlockArg::Value(next)], done, &[]);
        self.switch_to(done);
    }

    /// Emits the function's body, or that of a fold that is cut: piece by piece, each for the whole strip.
    pub(super) fn pieces(&mut self, block: Block, strip: Strip) {
        let (data, plan) = (&self.function.blocks[block], self.plan);
        for piece in plan.pieces(block) {
            let insts = &data.insts[piece.insts.clone()];
            if self.has_no_work(insts, piece) {
                // It says where columns and constants are.
                insts.iter().for_each(|&inst| self.inst(inst));
            } else {
                self.broadcast(&piece.columns);
                self.repeat(strip.start, strip.end, K * VECTOR_BYTES, |lowering, offset| {
                    lowering.points = Some(lowering.points(strip, offset));
                    insts.iter().for_each(|&inst| lowering.inst(inst));
                    match piece.then {
                        Then::Next => {}
                        Then::Fold(fold) => lowering.hand_over(fold),
                        Then::End if block == lowering.function.body => lowering.outputs(&data.results),
                        Then::End => lowering.keep_all(&data.params, &data.results),
                    }
                    lowering.points = None;
                });
                for &Column { value, table, column } in &piece.columns {
                    self.places[value.index()] = Some(ValuePlace::Column(table, column));
                }
                for value in std::mem::take(&mut self.kept) {
                    self.places[value.index()] = self.kept(value);
                }
            }
            if let Then::Fold(fold) = piece.then {
                self.cut_fold(fold, strip);
            }
        }
    }

    /// Whether a piece computes nothing, and the fold behind it finds its accumulators where they have to be.
    fn has_no_work(&self, insts: &[Inst], piece: &Piece) -> bool {
        let is_ready = match piece.then {
            Then::Next => true,
            Then::Fold(fold) => {
                let (fold, _) = self.folded(fold);
                self.moves(&self.function.blocks[fold.body].params, &fold.initial).is_empty()
            }
            Then::End => false,
        };
        is_ready && insts.iter().all(|&inst| self.function.insts[inst].kind.is_leaf())
    }

    /// Reads columns that a whole piece needs, once for all its blocks of points.
    fn broadcast(&mut self, columns: &[Column]) {
        for &Column { value, table, column } in columns {
            let vectors = self.column(table, column);
            self.places[value.index()] = Some(ValuePlace::Computed(Any::Real(vectors)));
        }
    }

    /// The addresses of a block of points.
    pub(super) fn points(&mut self, strip: Strip, offset: ir::Value) -> PointBlock {
        let inputs = if self.plan.is_whole() { self.function.inputs.len() } else { 0 };
        let inputs = (0..inputs).map(|index| self.plane(index, offset)).collect();
        let builder = &mut self.vectors.builder;
        let slots = self.slots.map(|slots| {
            let first = builder.ins().stack_addr(I64, slots, 0);
            let within = builder.ins().isub(offset, strip.start);
            builder.ins().iadd(first, within)
        });
        PointBlock { offset, inputs, slots }
    }

    /// The current block of points.
    pub(super) fn here(&self) -> &PointBlock {
        self.points.as_ref().expect("instructions are in pieces")
    }

    /// Stores the initial accumulators of a fold that is cut.
    fn hand_over(&mut self, inst: Inst) {
        let (fold, _) = self.folded(inst);
        self.keep_all(&self.function.blocks[fold.body].params, &fold.initial);
    }

    /// Emits a fold that is cut.
    fn cut_fold(&mut self, inst: Inst, strip: Strip) {
        let (fold, results) = self.folded(inst);
        let params = &self.function.blocks[fold.body].params;
        for &accumulator in params.iter().chain(results) {
            self.places[accumulator.index()] = self.kept(accumulator);
        }
        self.each_row(fold.table, &[], |lowering, _| {
            lowering.pieces(fold.body, strip);
            Vec::new()
        });
    }

    /// A fold and its results.
    fn folded(&self, inst: Inst) -> (&'f Fold, &'f [Value]) {
        let data = &self.function.insts[inst];
        let InstKind::Fold(fold) = &data.kind else { unreachable!("a fold is cut, and nothing else") };
        (fold, &data.results)
    }

    /// Where a value is that has a slot.
    fn kept(&self, value: Value) -> Option<ValuePlace<'f, K>> {
        self.plan.slot(value).map(|slot| ValuePlace::Kept(slot, self.function.values[value]))
    }

    /// Stores values of the current block of points into the slots of others, as if all were read before the
    /// first is written.
    fn keep_all(&mut self, targets: &[Value], values: &[Value]) {
        let moves = self.moves(targets, values);
        let written: HashSet<Slot> = moves.iter().filter_map(|&(target, _)| self.plan.slot(target)).collect();
        for &(_, value) in &moves {
            if self.plan.slot(value).is_some_and(|slot| written.contains(&slot)) {
                // Read now, it stays in `made`.
                self.operand(value);
            }
        }
        for (target, value) in moves {
            let computed = self.operand(value);
            self.keep(target, &computed);
        }
    }

    /// Pairs of values of which the first is to have what the second is, without those that share a slot:
    /// they have it.
    fn moves(&self, targets: &[Value], values: &[Value]) -> Vec<(Value, Value)> {
        let pairs = targets.iter().copied().zip(values.iter().copied());
        pairs.filter(|&(target, value)| self.plan.slot(target) != self.plan.slot(value)).collect()
    }

    /// Stores a value into its slot, if it has one.
    pub(super) fn keep(&mut self, value: Value, computed: &Any<Vectors<'f, K>>) {
        let Some(slot) = self.plan.slot(value) else { return };
        let address = self.here().slots.expect("a plan with a slot has bytes for it");
        let (Any::Real(vectors) | Any::Mask(vectors) | Any::Bits(vectors)) = *computed;
        let offsets = self.offsets(slot);
        for (part, at) in vectors.into_iter().zip(offsets) {
            self.vectors.builder.ins().store(SLOT, part, address, at);
        }
    }

    /// The vectors of a block of points in a slot, from the block's place in the first slot.
    fn offsets(&self, slot: Slot) -> [i32; K] {
        let start = offset(slot.0, self.plan.strip_bytes());
        std::array::from_fn(|vector| start + offset(vector, VECTOR_BYTES))
    }

    /// Loads what is in a slot.
    pub(super) fn load_kept(&mut self, slot: Slot, type_: Type) -> Any<Vectors<'f, K>> {
        let address = self.here().slots.expect("a plan with a slot has bytes for it");
        let offsets = self.offsets(slot);
        let builder = &mut self.vectors.builder;
        let mut load = |lanes| offsets.map(|at| builder.ins().load(lanes, SLOT, address, at));
        match type_ {
            Type::Real => Any::Real(load(F32X4)),
            Type::Mask => Any::Mask(load(I32X4)),
            Type::Bits => Any::Bits(load(I32X4)),
        }
    }
}
