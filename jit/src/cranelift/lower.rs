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
//! If there are several pieces, no fold is in one ([`jbt_ir::plan::strips`]). A fold is then the same loop
//! over rows around the `points` loops of its body's pieces, with its accumulators in slots:
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

mod row;
mod strip;

use std::collections::HashMap;

use cranelift_codegen::ir::types::{F32, F32X4, I64};
use cranelift_codegen::ir::{
    self, AbiParam, InstBuilder, MemFlagsData, Signature, StackSlotData, StackSlotKind, UserFuncName,
};
use cranelift_codegen::isa::CallConv;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use jbt_ir::plan::{Plan, Slot};
use jbt_ir::{Any, Block, Domain, Entity, Function, Inst, InstKind, Table, Type, Value, apply};

use crate::cranelift::vectors::{VECTOR_BYTES, Vectors};
use crate::options::VectorCount;

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
enum ValuePlace<'f, const K: usize> {
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
struct CurrentRow {
    /// Bytes from the table's first active row to it: what leads to the rows that it owns.
    position: ir::Value,
    /// The address of its first number.
    numbers: ir::Value,
}

/// The parameters of the code.
#[derive(Clone, Copy)]
struct CodeParameters {
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
struct PointBlock {
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
    frame: CodeParameters,
    /// Where the frame has the slots of the plan, if it needs any.
    slots: Option<ir::StackSlot>,
    places: Vec<Option<ValuePlace<'f, K>>>,
    /// What the current Cranelift block has read anew.
    made: HashMap<Value, Any<Vectors<'f, K>>>,
    /// What the current piece has put into slots, for the pieces after it.
    kept: Vec<Value>,
    /// The current row of each table whose fold is open.
    rows: Vec<Option<CurrentRow>>,
    /// `None` outside of a piece.
    points: Option<PointBlock>,
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
            frame: CodeParameters { planes, bytes, tables },
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

    /// Stores the function's outputs.
    fn outputs(&mut self, results: &[Value]) {
        for (index, &result) in results.iter().enumerate() {
            let address = self.plane(self.function.inputs.len() + index, self.here().offset);
            for (vector, value) in self.operand(result).real().into_iter().enumerate() {
                self.vectors.builder.ins().store(PLANE, value, address, offset(vector, VECTOR_BYTES));
            }
        }
    }

    /// Emits the instructions of the body of a fold that is not cut, and returns its results.
    fn block(&mut self, block: Block) -> Vec<Any<Vectors<'f, K>>> {
        let data = &self.function.blocks[block];
        for &inst in &data.insts {
            jbt_ir::watch::look();
            self.inst(inst);
        }
        self.operands(&data.results)
    }

    /// Emits an instruction, or remembers what to emit where it is used.
    fn inst(&mut self, inst: Inst) {
        let data = &self.function.insts[inst];
        let place = match &data.kind {
            InstKind::Input(index) => ValuePlace::Input(*index),
            InstKind::Constant(number) => ValuePlace::Constant(*number),
            InstKind::BitsConstant(bits) => ValuePlace::Bits(*bits),
            // It may have been broadcast before its piece.
            InstKind::Column { .. } if self.places[data.results[0].index()].is_some() => return,
            InstKind::Column { table, column } => ValuePlace::Column(*table, *column),
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
        self.places[value.index()] = Some(ValuePlace::Computed(computed));
    }

    fn operands(&mut self, values: &[Value]) -> Vec<Any<Vectors<'f, K>>> {
        values.iter().map(|&value| self.operand(value)).collect()
    }

    /// A value as the current Cranelift block sees it.
    fn operand(&mut self, value: Value) -> Any<Vectors<'f, K>> {
        let place = self.places[value.index()].as_ref();
        let made = match *place.expect("a verified function defines values before it uses them") {
            ValuePlace::Computed(computed) => return computed,
            ValuePlace::Constant(_)
            | ValuePlace::Bits(_)
            | ValuePlace::Column(..)
            | ValuePlace::Input(_)
            | ValuePlace::Kept(..)
                if self.made.contains_key(&value) =>
            {
                return self.made[&value];
            }
            ValuePlace::Constant(number) => Any::Real(self.vectors.constant(number)),
            ValuePlace::Bits(bits) => Any::Bits(self.vectors.bits_constant(bits)),
            ValuePlace::Column(table, column) => Any::Real(self.column(table, column)),
            ValuePlace::Input(index) => Any::Real(self.input(index)),
            ValuePlace::Kept(slot, type_) => self.load_kept(slot, type_),
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
        let PointBlock { offset: here, inputs, .. } = self.here();
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
    fn row(&self, table: Table) -> CurrentRow {
        self.rows[table.index()].expect("a verified function names a row inside the fold over its table")
    }
}

/// The offset of an item of an array.
fn offset(index: usize, item_bytes: usize) -> i32 {
    i32::try_from(index * item_bytes).expect("our limits keep every offset within 2^31 bytes")
}
