//! From the IR to Cranelift's: strips of points outside, then pieces of the function, then blocks of points,
//! then folds; ops by [`Vectors`].
//!
//! ```text
//! entry(planes, bytes, tables):
//!     jump strip(0)
//! strip(start):                                     once for each strip; once in all if the function is one piece
//!     end = min(start + strip bytes, bytes)
//!     jump points(start)
//! points(offset):                                   a piece, once for each block of 4 K points
//!     v0 = load planes[0] + offset                  an input
//!     begin, end = active + starts[parent row]
//!     jump header(begin, initial)
//! header(cursor, accumulators):                     a fold
//!     brif cursor == end, exit, body
//! body:
//!     row = load cursor;  numbers + row * stride
//!     ...
//!     jump header(cursor + 4, next)
//! exit:                                             the accumulators are the fold's results
//!     store planes[inputs + 0] + offset             what the last piece gives
//!     brif offset + 16 K < end, points(offset + 16 K), next piece
//! ```
//!
//! If there are several pieces, no fold is in one ([`crate::strips`]). A fold is then the same loop over rows
//! around the `points` loops of its body's pieces, with its accumulators in slots:
//!
//! ```text
//! header(cursor):
//!     brif cursor == end, exit, body
//! body:
//!     row = load cursor;  numbers + row * stride
//!     broadcast columns                             that the piece reads
//!     jump points(start)
//! points(offset):                                   a piece
//!     v7 = ...
//!     store slots[v7] + offset - start              what other pieces read, where it is computed
//!     brif offset + 16 K < end, points(offset + 16 K), next piece
//! next piece:
//!     ...
//!     jump header(cursor + 4)
//! ```
//!
//! Inputs, constants, columns that are not broadcast and what is in slots are not kept alive from where the
//! IR defines them: each Cranelift block that uses one reads it again, at the first use. That is a 16 byte
//! load, which is what a spilled value would cost, and for a column a load and a broadcast; they leave the
//! registers to the values that have to be computed. (Cranelift makes no memory operand of such a load unless
//! nothing that follows from it is used twice, which is rare.)

use std::collections::{HashMap, HashSet};

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::{F32, F32X4, I32X4, I64};
use cranelift_codegen::ir::{
    self, AbiParam, BlockArg, InstBuilder, MemFlagsData, Signature, StackSlotData, StackSlotKind,
    UserFuncName,
};
use cranelift_codegen::isa::CallConv;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use jbt_ir::{Any, Block, Domain, Entity, Fold, Function, Inst, InstKind, Table, Type, Value, apply};

use crate::abi::TableView;
use crate::options::VectorCount;
use crate::vectors::{VECTOR_BYTES, Vectors};
use jbt_ir::plan::{Column, Piece, Plan, Slot, Then};

/// A Cranelift function that keeps to the ABI of [`crate::entry`]: it reads the input planes, the table views
/// and what these point to as far as checked tables go, writes the output planes, and touches no other memory
/// but its own frame.
pub(crate) struct Lowered(ir::Function);

impl Lowered {
    /// The function, to be compiled or printed.
    pub(crate) fn into_function(self) -> ir::Function {
        self.0
    }
}

/// Writes the Cranelift IR of a function, in the pieces of a plan that was made for it.
pub(crate) fn lower(function: &Function, plan: &Plan, vectors: VectorCount) -> Lowered {
    let mut lowered = ir::Function::with_name_signature(UserFuncName::default(), signature());
    let mut context = FunctionBuilderContext::new();
    let builder = FunctionBuilder::new(&mut lowered, &mut context);
    match vectors {
        VectorCount::One => Lowering::<1>::new(function, plan, builder).function(),
        VectorCount::Two => Lowering::<2>::new(function, plan, builder).function(),
        VectorCount::Four => Lowering::<4>::new(function, plan, builder).function(),
    }
    Lowered(lowered)
}

/// `fn(planes, bytes, tables)`, see [`crate::entry`]. System V also where the system has another convention:
/// the caller is our own assembly.
fn signature() -> Signature {
    let mut signature = Signature::new(CallConv::SystemV);
    signature.params = vec![AbiParam::new(I64); 3];
    signature
}

/// Numbers and pointers that the code reads are in place and stay as they are while it runs.
const READ: MemFlagsData = MemFlagsData::trusted().with_readonly();
/// What the frame keeps, which changes.
const SLOT: MemFlagsData = MemFlagsData::trusted();
/// Planes begin at any f32, so a vector of them is not aligned; and outputs change.
const PLANE: MemFlagsData = MemFlagsData::new().with_notrap();

/// Where a value of the IR is.
enum Place<'f, const K: usize> {
    /// Computed; it stays.
    Computed(Any<Vectors<'f, K>>),
    /// To be made where it is used.
    Constant(f32),
    /// To be made where it is used.
    Bits(u32),
    /// To be read where it is used, unless it is broadcast for a piece: then it is computed.
    Column(Table, usize),
    /// To be read where it is used.
    Input(usize),
    /// To be read where it is used.
    Kept(Slot, Type),
}

/// The current row of a table, inside its fold.
#[derive(Clone, Copy)]
struct Row {
    /// Bytes from the table's first active row to it: what leads to the rows that it owns.
    position: ir::Value,
    /// The address of its first number.
    numbers: ir::Value,
}

/// The active rows of a table that the current row of its parent owns: addresses.
#[derive(Clone, Copy)]
struct Active {
    /// Of the first number of the table.
    numbers: ir::Value,
    /// Of the first active row of the whole table.
    first: ir::Value,
    /// Of the first one that is owned.
    begin: ir::Value,
    /// Behind the last one that is owned.
    end: ir::Value,
}

/// The parameters of the code.
#[derive(Clone, Copy)]
struct Frame {
    planes: ir::Value,
    bytes: ir::Value,
    tables: ir::Value,
}

/// A strip of points: bytes from the start of each plane.
#[derive(Clone, Copy)]
struct Strip {
    /// To its first point.
    start: ir::Value,
    /// Behind its last point.
    end: ir::Value,
}

/// The current block of points.
struct Points {
    /// Bytes from the start of each plane.
    offset: ir::Value,
    /// The address in each input plane, for all folds of the one piece that there is; empty if there are
    /// several.
    inputs: Vec<ir::Value>,
    /// The address in the first slot, if there are slots.
    slots: Option<ir::Value>,
}

/// The walk over a function.
struct Lowering<'f, const K: usize> {
    function: &'f Function,
    plan: &'f Plan,
    vectors: Vectors<'f, K>,
    frame: Frame,
    /// Where the frame has the slots of the plan, if it needs any.
    slots: Option<ir::StackSlot>,
    places: Vec<Option<Place<'f, K>>>,
    /// What the current Cranelift block has read anew.
    made: HashMap<Value, Any<Vectors<'f, K>>>,
    /// What the current piece has put into slots, for the pieces after it.
    kept: Vec<Value>,
    /// The current row of each table whose fold is open.
    rows: Vec<Option<Row>>,
    /// `None` outside of a piece.
    points: Option<Points>,
}

impl<'f, const K: usize> Lowering<'f, K> {
    /// Opens the entry block.
    fn new(function: &'f Function, plan: &'f Plan, mut builder: FunctionBuilder<'f>) -> Self {
        let entry = builder.create_block();
        builder.append_block_params_for_function_params(entry);
        builder.switch_to_block(entry);
        let &[planes, bytes, tables] = builder.block_params(entry) else {
            unreachable!("the signature has three parameters")
        };
        let slots = (plan.slot_bytes() > 0).then(|| {
            let size = u32::try_from(plan.slot_bytes()).expect("a plan with so many slots is not made");
            let align_shift = VECTOR_BYTES.ilog2() as u8;
            let slots = StackSlotData::new(StackSlotKind::ExplicitSlot, size, align_shift);
            builder.create_sized_stack_slot(slots)
        });
        Self {
            function,
            plan,
            vectors: Vectors::new(builder),
            frame: Frame { planes, bytes, tables },
            slots,
            places: function.values.values().map(|_| None).collect(),
            made: HashMap::new(),
            kept: Vec::new(),
            rows: vec![None; function.tables.len()],
            points: None,
        }
    }

    /// Emits everything.
    fn function(mut self) {
        let bytes = self.frame.bytes;
        let zero = self.vectors.builder.ins().iconst(I64, 0);
        if self.plan.is_whole() {
            self.pieces(self.function.body, Strip { start: zero, end: bytes });
        } else {
            let strip_bytes = self.plan.strip_bytes();
            self.repeat(zero, bytes, strip_bytes, |lowering, start| {
                let end = lowering.vectors.builder.ins().iadd_imm_s(start, strip_bytes as i64);
                let end = lowering.vectors.builder.ins().umin(end, bytes);
                lowering.pieces(lowering.function.body, Strip { start, end });
            });
        }
        let mut builder = self.vectors.builder;
        builder.ins().return_(&[]);
        // Sealing is all that the function itself needs; finalizing would ready the context for another one.
        builder.seal_all_blocks();
    }

    /// Emits a loop over offsets in the planes, which runs at least once: `from` is before `to`. Its last
    /// step may end behind `to`.
    fn repeat(
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
    fn pieces(&mut self, block: Block, strip: Strip) {
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
                    self.places[value.index()] = Some(Place::Column(table, column));
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
            self.places[value.index()] = Some(Place::Computed(Any::Real(vectors)));
        }
    }

    /// The addresses of a block of points.
    fn points(&mut self, strip: Strip, offset: ir::Value) -> Points {
        let inputs = if self.plan.is_whole() { self.function.inputs.len() } else { 0 };
        let inputs = (0..inputs).map(|index| self.plane(index, offset)).collect();
        let builder = &mut self.vectors.builder;
        let slots = self.slots.map(|slots| {
            let first = builder.ins().stack_addr(I64, slots, 0);
            let within = builder.ins().isub(offset, strip.start);
            builder.ins().iadd(first, within)
        });
        Points { offset, inputs, slots }
    }

    /// The current block of points.
    fn here(&self) -> &Points {
        self.points.as_ref().expect("instructions are in pieces")
    }

    /// Stores the function's outputs.
    fn outputs(&mut self, results: &[Value]) {
        for (index, &result) in results.iter().enumerate() {
            let address = self.plane(self.function.inputs.len() + index, self.here().offset);
            for (vector, value) in self.operand(result).real().into_iter().enumerate() {
                self.vectors.builder.ins().store(PLANE, value, address, offset(vector, VECTOR_BYTES));
            }
        }
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
    fn kept(&self, value: Value) -> Option<Place<'f, K>> {
        self.plan.slot(value).map(|slot| Place::Kept(slot, self.function.values[value]))
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
    fn keep(&mut self, value: Value, computed: &Any<Vectors<'f, K>>) {
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
    fn load_kept(&mut self, slot: Slot, type_: Type) -> Any<Vectors<'f, K>> {
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

    /// Emits the instructions of the body of a fold that is not cut, and returns its results.
    fn block(&mut self, block: Block) -> Vec<Any<Vectors<'f, K>>> {
        let data = &self.function.blocks[block];
        for &inst in &data.insts {
            self.inst(inst);
        }
        self.operands(&data.results)
    }

    /// Emits an instruction, or remembers what to emit where it is used.
    fn inst(&mut self, inst: Inst) {
        let data = &self.function.insts[inst];
        let place = match &data.kind {
            InstKind::Input(index) => Place::Input(*index),
            InstKind::Constant(number) => Place::Constant(*number),
            InstKind::BitsConstant(bits) => Place::Bits(*bits),
            // It may have been broadcast before its piece.
            InstKind::Column { .. } if self.places[data.results[0].index()].is_some() => return,
            InstKind::Column { table, column } => Place::Column(*table, *column),
            InstKind::Op { op, args } => {
                let args = self.operands(args);
                let computed = apply(&mut self.vectors, *op, &args);
                return self.define(data.results[0], computed);
            }
            InstKind::Fold(fold) => {
                let accumulators = self.fold(fold);
                for (&result, accumulator) in data.results.iter().zip(accumulators) {
                    self.define(result, accumulator);
                }
                return;
            }
        };
        self.places[data.results[0].index()] = Some(place);
    }

    /// Notes that a value has been computed, and keeps it if another piece reads it.
    fn define(&mut self, value: Value, computed: Any<Vectors<'f, K>>) {
        if self.plan.slot(value).is_some() {
            self.keep(value, &computed);
            self.kept.push(value);
        }
        self.places[value.index()] = Some(Place::Computed(computed));
    }

    fn operands(&mut self, values: &[Value]) -> Vec<Any<Vectors<'f, K>>> {
        values.iter().map(|&value| self.operand(value)).collect()
    }

    /// A value as the current Cranelift block sees it.
    fn operand(&mut self, value: Value) -> Any<Vectors<'f, K>> {
        let place = self.places[value.index()].as_ref();
        let made = match *place.expect("a verified function defines values before it uses them") {
            Place::Computed(computed) => return computed,
            Place::Constant(_) | Place::Bits(_) | Place::Column(..) | Place::Input(_) | Place::Kept(..)
                if self.made.contains_key(&value) =>
            {
                return self.made[&value];
            }
            Place::Constant(number) => Any::Real(self.vectors.constant(number)),
            Place::Bits(bits) => Any::Bits(self.vectors.bits_constant(bits)),
            Place::Column(table, column) => Any::Real(self.column(table, column)),
            Place::Input(index) => Any::Real(self.input(index)),
            Place::Kept(slot, type_) => self.load_kept(slot, type_),
        };
        self.made.insert(value, made);
        made
    }

    /// Goes on in another Cranelift block, which reads for itself what is not computed.
    fn switch_to(&mut self, block: ir::Block) {
        self.vectors.builder.switch_to_block(block);
        self.made.clear();
    }

    /// The address in a plane, inputs first, at an offset.
    fn plane(&mut self, index: usize, at: ir::Value) -> ir::Value {
        let builder = &mut self.vectors.builder;
        let start = builder.ins().load(I64, READ, self.frame.planes, offset(index, size_of::<*const f32>()));
        builder.ins().iadd(start, at)
    }

    /// Loads the current block of points of an input plane.
    fn input(&mut self, index: usize) -> [ir::Value; K] {
        let Points { offset: here, inputs, .. } = self.here();
        let (here, address) = (*here, inputs.get(index).copied());
        let address = address.unwrap_or_else(|| self.plane(index, here));
        std::array::from_fn(|vector| {
            self.vectors.builder.ins().load(F32X4, PLANE, address, offset(vector, VECTOR_BYTES))
        })
    }

    /// Broadcasts a number of the current row.
    fn column(&mut self, table: Table, column: usize) -> [ir::Value; K] {
        assert!(
            column < self.function.tables[table].columns.len(),
            "a verified function reads columns of its schema"
        );
        let row = self.row(table);
        let ins = self.vectors.builder.ins();
        let number = ins.load(F32, READ, row.numbers, offset(column, size_of::<f32>()));
        [self.vectors.builder.ins().splat(F32X4, number); K]
    }

    /// The current row of a table whose fold is open.
    fn row(&self, table: Table) -> Row {
        self.rows[table.index()].expect("a verified function names a row inside the fold over its table")
    }

    /// Emits a fold that is not cut, and returns the final accumulators.
    fn fold(&mut self, fold: &Fold) -> Vec<Any<Vectors<'f, K>>> {
        let initial = self.operands(&fold.initial);
        self.each_row(fold.table, &initial, |lowering, accumulators| {
            for (&param, &accumulator) in lowering.function.blocks[fold.body].params.iter().zip(accumulators)
            {
                lowering.places[param.index()] = Some(Place::Computed(accumulator));
            }
            lowering.block(fold.body)
        })
    }

    /// Emits a loop over the active rows that the parent's row owns: `body` takes the accumulators and
    /// returns the next ones. Returns the final ones.
    fn each_row(
        &mut self,
        table: Table,
        initial: &[Any<Vectors<'f, K>>],
        body: impl FnOnce(&mut Self, &[Any<Vectors<'f, K>>]) -> Vec<Any<Vectors<'f, K>>>,
    ) -> Vec<Any<Vectors<'f, K>>> {
        let Active { numbers, first, begin, end } = self.active(table);
        let builder = &mut self.vectors.builder;
        let [header, row, exit] = [(); 3].map(|()| builder.create_block());
        let cursor = builder.append_block_param(header, I64);
        let accumulators: Vec<_> = initial.iter().map(|value| block_params(builder, header, value)).collect();
        builder.ins().jump(header, &block_args(begin, initial));

        self.switch_to(header);
        let builder = &mut self.vectors.builder;
        // Of two successors Cranelift places the second next in memory: the row, so that the loop is one
        // stretch of code.
        let over = builder.ins().icmp(IntCC::Equal, cursor, end);
        builder.ins().brif(over, exit, &[], row, &[]);

        self.switch_to(row);
        self.rows[table.index()] = Some(self.read_row(table, numbers, first, cursor));
        let next = body(self, &accumulators);
        self.rows[table.index()] = None;
        let builder = &mut self.vectors.builder;
        let next_cursor = builder.ins().iadd_imm_s(cursor, size_of::<u32>() as i64);
        builder.ins().jump(header, &block_args(next_cursor, &next));

        self.switch_to(exit);
        accumulators
    }

    /// The address of a table's numbers, and where its active rows begin and end for the parent's current
    /// row.
    fn active(&mut self, table: Table) -> Active {
        let parent = self.function.tables[table].parent.map(|parent| self.row(parent).position);
        let view = self.frame.tables;
        let builder = &mut self.vectors.builder;
        let mut field = |field| {
            let at = i32::try_from(table.index() * size_of::<TableView>() + field);
            let at = at.expect("limits::MAX_TABLES keeps every view within 2^31 bytes");
            builder.ins().load(I64, READ, view, at)
        };
        let numbers = field(TableView::NUMBERS);
        let first = field(TableView::ACTIVE);
        let mut starts = field(TableView::STARTS);
        if let Some(parent) = parent {
            // A start is as long as an active row, so the bytes are the same.
            starts = builder.ins().iadd(starts, parent);
        }
        let [begin, end] = [0, 1].map(|which| {
            let position = builder.ins().uload32(READ, starts, offset(which, size_of::<u32>()));
            let skipped = builder.ins().imul_imm_s(position, size_of::<u32>() as i64);
            builder.ins().iadd(first, skipped)
        });
        Active { numbers, first, begin, end }
    }

    /// The row that the cursor points at.
    fn read_row(&mut self, table: Table, numbers: ir::Value, first: ir::Value, cursor: ir::Value) -> Row {
        let row_bytes = self.function.tables[table].columns.len() * size_of::<f32>();
        let builder = &mut self.vectors.builder;
        let index = builder.ins().uload32(READ, cursor, 0);
        let skipped = builder.ins().imul_imm_s(index, row_bytes as i64);
        let numbers = builder.ins().iadd(numbers, skipped);
        Row { position: builder.ins().isub(cursor, first), numbers }
    }
}

/// The offset of an item of an array.
fn offset(index: usize, item_bytes: usize) -> i32 {
    i32::try_from(index * item_bytes).expect("our limits keep every offset within 2^31 bytes")
}

/// Adds a block parameter for each vector of a value of the type of `like`.
fn block_params<'f, const K: usize>(
    builder: &mut FunctionBuilder<'f>,
    block: ir::Block,
    like: &Any<Vectors<'f, K>>,
) -> Any<Vectors<'f, K>> {
    let mut params = |type_| std::array::from_fn(|_| builder.append_block_param(block, type_));
    match like {
        Any::Real(_) => Any::Real(params(F32X4)),
        Any::Mask(_) => Any::Mask(params(I32X4)),
        Any::Bits(_) => Any::Bits(params(I32X4)),
    }
}

/// The cursor and the accumulators of a loop, as its header takes them.
fn block_args<'f, const K: usize>(cursor: ir::Value, accumulators: &[Any<Vectors<'f, K>>]) -> Vec<BlockArg> {
    let vectors = accumulators.iter().flat_map(|accumulator| match accumulator {
        Any::Real(vectors) | Any::Mask(vectors) | Any::Bits(vectors) => *vectors,
    });
    std::iter::once(cursor).chain(vectors).map(BlockArg::Value).collect()
}
