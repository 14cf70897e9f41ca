//! From the IR to Cranelift's: blocks of points outside, folds inside, ops by [`Vectors`].
//!
//! ```text
//! entry(planes, bytes, tables):
//!     jump points(0)
//! points(offset):                                   once for each block of 4 K points
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
//!     store planes[inputs + 0] + offset
//!     brif offset + 16 K < bytes, points(offset + 16 K), done
//! ```
//!
//! Inputs, constants and columns are not kept alive from where the IR defines them: each Cranelift block that uses one reads it
//! again, at the first use. An input or a constant is a 16 byte load, which is what a spilled value would cost, and a column a load and a
//! broadcast; they leave the registers to the values that have to be computed. (Cranelift makes no memory operand of such a load
//! unless nothing that follows from it is used twice, which is rare.)

use std::collections::HashMap;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::types::{F32, F32X4, I32X4, I64};
use cranelift_codegen::ir::{self, AbiParam, BlockArg, InstBuilder, MemFlagsData, Signature, UserFuncName};
use cranelift_codegen::isa::CallConv;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use jbt_ir::{Any, Block, Domain, Entity, Fold, Function, Inst, InstKind, Table, Value, Verified, apply};

use crate::compile::VectorCount;
use crate::entry::TableView;
use crate::vectors::{VECTOR_BYTES, Vectors};

/// A Cranelift function that keeps to the ABI of [`crate::entry`]: it reads the input planes, the table views and what
/// these point to as far as checked tables go, writes the output planes, and touches no other memory.
pub(crate) struct Lowered(ir::Function);

impl Lowered {
    /// The function, to be compiled or printed.
    pub(crate) fn into_function(self) -> ir::Function {
        self.0
    }
}

/// Writes the Cranelift IR of a function.
pub(crate) fn lower(function: &Verified, vectors: VectorCount) -> Lowered {
    let function = function.function();
    let mut lowered = ir::Function::with_name_signature(UserFuncName::default(), signature());
    let mut context = FunctionBuilderContext::new();
    let builder = FunctionBuilder::new(&mut lowered, &mut context);
    match vectors {
        VectorCount::One => Lowering::<1>::new(function, builder).function(),
        VectorCount::Two => Lowering::<2>::new(function, builder).function(),
        VectorCount::Four => Lowering::<4>::new(function, builder).function(),
    }
    Lowered(lowered)
}

/// `fn(planes, bytes, tables)`, see [`crate::entry`]. System V also where the system has another convention: the caller is
/// our own assembly.
fn signature() -> Signature {
    let mut signature = Signature::new(CallConv::SystemV);
    signature.params = vec![AbiParam::new(I64); 3];
    signature
}

/// Numbers and pointers that the code reads are in place and stay as they are while it runs.
const READ: MemFlagsData = MemFlagsData::trusted().with_readonly();
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
    /// To be read where it is used.
    Column(Table, usize),
    /// To be read where it is used.
    Input(usize),
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

/// The parameters of the code, and where it is in the planes.
#[derive(Clone, Copy)]
struct Frame {
    planes: ir::Value,
    bytes: ir::Value,
    tables: ir::Value,
    /// The head of the outer loop.
    points: ir::Block,
    /// Its parameter: bytes from the start of each plane.
    offset: ir::Value,
}

/// The walk over a function.
struct Lowering<'f, const K: usize> {
    function: &'f Function,
    vectors: Vectors<'f, K>,
    frame: Frame,
    places: Vec<Option<Place<'f, K>>>,
    /// Constants and columns that the current Cranelift block has made.
    made: HashMap<Value, Any<Vectors<'f, K>>>,
    /// The current row of each table whose fold is open.
    rows: Vec<Option<Row>>,
    /// Where the current block of points of each input plane is, once it has been read.
    input_addresses: Vec<Option<ir::Value>>,
}

impl<'f, const K: usize> Lowering<'f, K> {
    /// Opens the entry block and the block of the outer loop.
    fn new(function: &'f Function, mut builder: FunctionBuilder<'f>) -> Self {
        let entry = builder.create_block();
        builder.append_block_params_for_function_params(entry);
        builder.switch_to_block(entry);
        let &[planes, bytes, tables] = builder.block_params(entry) else {
            unreachable!("the signature has three parameters")
        };
        let start = builder.ins().iconst(I64, 0);
        let points = builder.create_block();
        let offset = builder.append_block_param(points, I64);
        builder.ins().jump(points, &[BlockArg::Value(start)]);
        builder.switch_to_block(points);
        Self {
            function,
            vectors: Vectors::new(builder),
            frame: Frame { planes, bytes, tables, points, offset },
            places: function.values.values().map(|_| None).collect(),
            made: HashMap::new(),
            rows: vec![None; function.tables.len()],
            input_addresses: vec![None; function.inputs.len()],
        }
    }

    /// Emits the body, the stores, and the end of the outer loop.
    fn function(mut self) {
        let outputs = self.block(self.function.body);
        for (index, output) in outputs.into_iter().enumerate() {
            let address = self.plane(self.function.inputs.len() + index);
            for (vector, value) in output.real().into_iter().enumerate() {
                self.vectors.builder.ins().store(PLANE, value, address, offset(vector, VECTOR_BYTES));
            }
        }
        let Frame { bytes, points, offset, .. } = self.frame;
        let mut builder = self.vectors.builder;
        let done = builder.create_block();
        let next = builder.ins().iadd_imm_s(offset, (K * VECTOR_BYTES) as i64);
        let more = builder.ins().icmp(IntCC::UnsignedLessThan, next, bytes);
        builder.ins().brif(more, points, &[BlockArg::Value(next)], done, &[]);
        builder.switch_to_block(done);
        builder.ins().return_(&[]);
        // Sealing is all that the function itself needs; finalizing would ready the context for another one.
        builder.seal_all_blocks();
    }

    /// Emits the instructions of a block and returns its results.
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
            InstKind::Input(index) => {
                self.input_address(*index);
                Place::Input(*index)
            }
            InstKind::Constant(number) => Place::Constant(*number),
            InstKind::BitsConstant(bits) => Place::Bits(*bits),
            InstKind::Column { table, column } => Place::Column(*table, *column),
            InstKind::Op { op, args } => {
                let args = self.operands(args);
                Place::Computed(apply(&mut self.vectors, *op, &args))
            }
            InstKind::Fold(fold) => {
                let accumulators = self.fold(fold);
                for (&result, accumulator) in data.results.iter().zip(accumulators) {
                    self.places[result.index()] = Some(Place::Computed(accumulator));
                }
                return;
            }
        };
        self.places[data.results[0].index()] = Some(place);
    }

    fn operands(&mut self, values: &[Value]) -> Vec<Any<Vectors<'f, K>>> {
        values.iter().map(|&value| self.operand(value)).collect()
    }

    /// A value as the current Cranelift block sees it.
    fn operand(&mut self, value: Value) -> Any<Vectors<'f, K>> {
        let place = self.places[value.index()].as_ref();
        let made = match *place.expect("a verified function defines values before it uses them") {
            Place::Computed(computed) => return computed,
            Place::Constant(_) | Place::Bits(_) | Place::Column(..) | Place::Input(_)
                if self.made.contains_key(&value) =>
            {
                return self.made[&value];
            }
            Place::Constant(number) => Any::Real(self.vectors.constant(number)),
            Place::Bits(bits) => Any::Bits(self.vectors.bits_constant(bits)),
            Place::Column(table, column) => Any::Real(self.column(table, column)),
            Place::Input(index) => Any::Real(self.input(index)),
        };
        self.made.insert(value, made);
        made
    }

    /// Goes on in another Cranelift block, which makes its own constants and columns.
    fn switch_to(&mut self, block: ir::Block) {
        self.vectors.builder.switch_to_block(block);
        self.made.clear();
    }

    /// The address in a plane, inputs first, of the current block of points.
    fn plane(&mut self, index: usize) -> ir::Value {
        let ins = self.vectors.builder.ins();
        let start = ins.load(I64, READ, self.frame.planes, offset(index, size_of::<*const f32>()));
        self.vectors.builder.ins().iadd(start, self.frame.offset)
    }

    /// The address of the current block of points of an input plane. Made where the IR reads the plane, which all uses come after.
    fn input_address(&mut self, index: usize) -> ir::Value {
        assert!(index < self.function.inputs.len(), "a verified function reads the inputs that it has");
        if let Some(address) = self.input_addresses[index] {
            return address;
        }
        let address = self.plane(index);
        self.input_addresses[index] = Some(address);
        address
    }

    /// Loads the current block of points of an input plane.
    fn input(&mut self, index: usize) -> [ir::Value; K] {
        let address = self.input_address(index);
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

    /// Emits the loop over the active rows that the parent's row owns, and returns the final accumulators.
    fn fold(&mut self, fold: &Fold) -> Vec<Any<Vectors<'f, K>>> {
        let initial = self.operands(&fold.initial);
        let Active { numbers, first, begin, end } = self.active(fold.table);
        let builder = &mut self.vectors.builder;
        let [header, body, exit] = [(); 3].map(|()| builder.create_block());
        let cursor = builder.append_block_param(header, I64);
        let accumulators: Vec<_> = initial.iter().map(|value| block_params(builder, header, value)).collect();
        builder.ins().jump(header, &block_args(begin, &initial));

        self.switch_to(header);
        let builder = &mut self.vectors.builder;
        // Of two successors Cranelift places the second next in memory: the body, so that the loop is one stretch of code.
        let over = builder.ins().icmp(IntCC::Equal, cursor, end);
        builder.ins().brif(over, exit, &[], body, &[]);

        self.switch_to(body);
        for (&param, &accumulator) in self.function.blocks[fold.body].params.iter().zip(&accumulators) {
            self.places[param.index()] = Some(Place::Computed(accumulator));
        }
        self.rows[fold.table.index()] = Some(self.read_row(fold.table, numbers, first, cursor));
        let next = self.block(fold.body);
        self.rows[fold.table.index()] = None;
        let builder = &mut self.vectors.builder;
        let next_cursor = builder.ins().iadd_imm_s(cursor, size_of::<u32>() as i64);
        builder.ins().jump(header, &block_args(next_cursor, &next));

        self.switch_to(exit);
        accumulators
    }

    /// The address of a table's numbers, and where its active rows begin and end for the parent's current row.
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
