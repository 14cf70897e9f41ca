//! Builds functions. The builder is itself a [`Domain`]: code written over `Domain` and run on it becomes
//! instructions.
//!
//! Two things happen on the way, unless a function is copied as it is (`translate::renumber`):
//!
//! * **Hash-consing.** An instruction that exists already where it can be seen is not written again.
//! * **Hoisting.** An instruction goes into the outermost open block that has all its operands, so whatever
//!   does not depend on the row or the accumulators of a fold is computed outside of it.
//!
//! ```
//! use jbt_ir::{Domain, FoldKind, FunctionBuilder, Rule, Schema, verify};
//!
//! // The sum of the x column of a table, added to the input.
//! let mut b = FunctionBuilder::new("f", &["x"]);
//! let schema = Schema { name: "numbers".into(), columns: vec!["x".into()], parent: None, slots: vec![] };
//! let t = b.table(schema);
//! let x = b.input(0);
//! let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[x])[0];
//! let column = b.column(t, 0);
//! let next = b.add(acc, column);
//! let sum = b.end_fold(&[next])[0];
//! verify(b.finish(&[("sum".to_owned(), sum)])).unwrap();
//! ```

mod known;

use std::fmt;
use std::sync::Arc;

use crate::entity::{Block, Entity, Inst, Results, Table, Value, Values};
use crate::function::{BlockData, Fold, FoldKind, Function, InstData, InstKind, Rule, Schema};
use crate::limits::MAX_VALUES;
use crate::op::{Domain, Op, Type};
use crate::origin::{Origin, Part};
use crate::watch::{self, look};

use known::{Key, KnownInsts};

/// What is known of a value while its function is written.
#[derive(Clone, Copy)]
struct KnownValue {
    /// How many blocks enclose its definition: 0 is the function's body.
    depth: u16,
    /// The block that it is defined in: it is seen while that is open.
    block: Block,
    /// The instruction that defines it; accumulators have none.
    definition: Option<Inst>,
    /// Whether it is the same at all points of a row.
    uniform: bool,
}

/// A block that is still being written.
struct OpenBlock {
    block: Block,
    /// The table of its fold; `None` for the function's body.
    fold: Option<(Table, (FoldKind, Rule), Values)>,
}

/// Writes a [`Function`]. See the module for the idea.
pub struct FunctionBuilder {
    function: Function,
    open: Vec<OpenBlock>,
    known: KnownInsts,
    values: Vec<KnownValue>,
    /// By type, what stands for more values than a function may have.
    stand_ins: [Option<Value>; Type::ALL.len()],
    origin: Origin,
    /// Whether equal instructions are shared, and hoisted.
    shares: bool,
}

impl fmt::Debug for FunctionBuilder {
    /// What has been written so far.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FunctionBuilder").field("function", &self.function).finish_non_exhaustive()
    }
}

impl FunctionBuilder {
    /// Starts a function with these input planes.
    #[must_use]
    pub fn new(name: &str, inputs: &[&str]) -> Self {
        let function = Function::new(name, inputs);
        let open = vec![OpenBlock { block: function.body, fold: None }];
        Self {
            function,
            open,
            known: KnownInsts::default(),
            values: Vec::new(),
            stand_ins: [None; Type::ALL.len()],
            origin: Origin::SHARED,
            shares: true,
        }
    }

    /// Starts a function with the planes and tables of another one, to write a changed version of it.
    #[must_use]
    pub fn like(function: &Function) -> Self {
        let mut builder = Self { shares: true, ..Self::verbatim(function) };
        // Some passes write several instructions for one. Places that are never taken cost nothing: the
        // system gives their memory when it is first written.
        builder.known.reserve((4 * function.insts.len()).min(MAX_VALUES), |_| None);
        builder
    }

    /// As [`like`](Self::like), for a copy: each instruction is written where it is asked for, and shared
    /// with no other.
    #[must_use]
    pub(crate) fn verbatim(function: &Function) -> Self {
        let inputs: Vec<&str> = function.inputs.iter().map(String::as_str).collect();
        let mut builder = Self::new(&function.name, &inputs);
        builder.function.tables = Arc::clone(&function.tables);
        // A changed version is about as long.
        let count = function.values.len();
        let each = size_of::<Type>() + size_of::<KnownValue>();
        watch::take(count * each + function.insts.len() * size_of::<InstData>());
        builder.function.values.reserve(count);
        builder.function.insts.reserve(function.insts.len());
        builder.values.reserve(count);
        builder.shares = false;
        builder
    }

    /// Gives the function other input planes. None has been read yet.
    pub(crate) fn set_inputs(&mut self, inputs: Vec<String>) {
        self.function.inputs = inputs;
    }

    /// Declares a table.
    pub fn table(&mut self, schema: Schema) -> Table {
        Arc::make_mut(&mut self.function.tables).push(schema)
    }

    /// Adds a column to a table and returns its index. Lowering learns the columns of a row while it writes
    /// the body.
    pub fn add_column(&mut self, table: Table, name: &str) -> usize {
        let columns = &mut Arc::make_mut(&mut self.function.tables)[table].columns;
        columns.push(name.to_owned());
        columns.len() - 1
    }

    /// Adds a leaf slot to a table.
    pub fn add_slot(&mut self, table: Table, slot: u32) {
        Arc::make_mut(&mut self.function.tables)[table].slots.push(slot);
    }

    /// Sets the origin of the instructions that follow, and returns the one before.
    pub fn set_origin(&mut self, origin: Origin) -> Origin {
        std::mem::replace(&mut self.origin, origin)
    }

    /// The origin of the instructions that follow.
    #[must_use]
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// Changes the origin of the instruction that defines `value`.
    pub fn mark(&mut self, value: Value, origin: Origin) {
        if let Some(inst) = self.values[value.index()].definition {
            self.function.insts[inst].origin = origin;
        }
    }

    /// Marks a value that replaces a distance, if an op computes it: the distance stays one for the counters,
    /// also if the value was there already for something else.
    pub(crate) fn keep_distance(&mut self, value: Value, origin: Origin) {
        if origin.part == Part::Distance && matches!(self.definition(value), Some(InstKind::Op { .. })) {
            self.mark(value, origin);
        }
    }

    /// The function so far: types of values, tables, definitions.
    #[must_use]
    pub fn function(&self) -> &Function {
        &self.function
    }

    /// Whether the function has more values than any may have. What is written then stands for nothing: the
    /// next value of a type is the first one of that type again, so that whoever writes comes to an end in
    /// little time and memory, and whoever asks for the function counts its values.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.function.values.len() > MAX_VALUES
    }

    /// How many folds are open.
    #[must_use]
    pub fn fold_depth(&self) -> usize {
        self.open.len() - 1
    }

    /// What computes the value; `None` for an accumulator, which its block binds.
    #[must_use]
    pub fn definition(&self, value: Value) -> Option<&InstKind> {
        Some(&self.function.insts[self.values[value.index()].definition?].kind)
    }

    /// The number, if the value is a constant.
    #[must_use]
    pub fn as_constant(&self, value: Value) -> Option<f32> {
        match self.function.insts[self.values[value.index()].definition?].kind {
            InstKind::Constant(number) => Some(number),
            InstKind::Input(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Op { .. }
            | InstKind::Fold(_) => None,
        }
    }

    /// Whether the value is the same at all points, for given rows: made of constants and columns alone.
    /// Engines compute it once for a row.
    #[must_use]
    pub fn is_uniform(&self, value: Value) -> bool {
        self.values[value.index()].uniform
    }

    /// An input plane.
    pub fn input(&mut self, index: usize) -> Value {
        self.insert(0, InstKind::Input(index))
    }

    /// A column of the current row of a table, whose fold must be open.
    pub fn column(&mut self, table: Table, column: usize) -> Value {
        let depth = self
            .open
            .iter()
            .rposition(|open| open.fold.as_ref().is_some_and(|(of, ..)| *of == table))
            .expect("a column is read inside the fold over its table");
        self.insert(depth, InstKind::Column { table, column })
    }

    /// Any op.
    pub fn op(&mut self, op: Op, args: &[Value]) -> Value {
        let depth = args.iter().map(|arg| self.values[arg.index()].depth).max().unwrap_or(0);
        self.insert(depth as usize, InstKind::Op { op, args: args.into() })
    }

    /// Opens a fold over `table` and returns its accumulators; what follows is its body, up to
    /// [`end_fold`](Self::end_fold).
    pub fn begin_fold(&mut self, table: Table, kind: (FoldKind, Rule), initial: &[Value]) -> Vec<Value> {
        let block = self.function.blocks.push(BlockData::default());
        self.open.push(OpenBlock { block, fold: Some((table, kind, initial.into())) });
        let depth = self.open.len() - 1;
        let params: Vec<Value> =
            initial.iter().map(|&value| self.new_value(self.function.values[value], depth)).collect();
        self.function.blocks[block].params = params.as_slice().into();
        params
    }

    /// Gives the innermost fold one more accumulator, behind the others, and returns it: for code that learns
    /// in the body what it has to carry out.
    pub fn add_accumulator(&mut self, initial: Value) -> Value {
        let depth = self.open.len() - 1;
        let param = self.new_value(self.function.values[initial], depth);
        let open = self.open.last_mut().expect("the function's body is open");
        self.function.blocks[open.block].params.push(param);
        open.fold.as_mut().expect("a fold is open").2.push(initial);
        param
    }

    /// Closes the innermost fold with the next accumulators, and returns the final ones.
    pub fn end_fold(&mut self, next: &[Value]) -> Vec<Value> {
        let open = self.open.pop().expect("begin_fold came first");
        let (table, (kind, rule), initial) = open.fold.expect("begin_fold came first");
        let depth = self.open.len() - 1;
        let results: Vec<Value> =
            initial.iter().map(|&value| self.new_value(self.function.values[value], depth)).collect();
        self.function.blocks[open.block].results = next.into();
        let fold = Fold { table, kind, rule, initial, body: open.block };
        self.append(depth, InstKind::Fold(Box::new(fold)), results.as_slice().into());
        results
    }

    /// Ends the function: these are its output planes.
    #[must_use]
    pub fn finish(mut self, outputs: &[(String, Value)]) -> Function {
        assert_eq!(self.open.len(), 1, "every fold is closed");
        let body = self.function.body;
        self.function.outputs = outputs.iter().map(|(name, _)| name.clone()).collect();
        self.function.blocks[body].results = outputs.iter().map(|&(_, value)| value).collect();
        self.function
    }

    fn new_value(&mut self, type_: Type, depth: usize) -> Value {
        let block = self.open[depth].block;
        // Nobody verifies a function with more than `MAX_FOLD_DEPTH` folds in each other.
        let known = KnownValue {
            depth: u16::try_from(depth).unwrap_or(u16::MAX),
            block,
            definition: None,
            uniform: false,
        };
        watch::take(watch::growth(&self.values, 1) + self.function.values.growth(1));
        self.values.push(known);
        let value = self.function.values.push(type_);
        self.stand_ins[type_ as usize].get_or_insert(value);
        value
    }

    fn append(&mut self, depth: usize, kind: InstKind, results: Results) -> Inst {
        let definition = self.function.insts.next_key();
        for result in &results {
            self.values[result.index()].definition = Some(definition);
        }
        let block = &self.function.blocks[self.open[depth].block];
        watch::take(self.function.insts.growth(1) + watch::growth(&block.insts, 1));
        let inst = self.function.insts.push(InstData { kind, results, origin: self.origin });
        self.function.blocks[self.open[depth].block].insts.push(inst);
        inst
    }

    fn insert(&mut self, depth: usize, kind: InstKind) -> Value {
        look();
        let type_ = kind.result_type();
        if let Some(value) = self.stand_ins[type_ as usize].filter(|_| self.is_full()) {
            return value;
        }
        let depth = depth.min(self.open.len() - 1);
        if !self.shares {
            let value = self.new_value(type_, depth);
            self.append(self.open.len() - 1, kind, Results::from_slice(&[value]));
            return value;
        }
        let key = Key::new(&kind).expect("folds are written by `end_fold`");
        let Self { known, values, function, .. } = self;
        let key_of = |value: Value| Key::new(&function.insts[values[value.index()].definition?].kind);
        let (found, place) = known.find(key, key_of);
        // What stands in a block that has been closed is seen no more.
        if let Some(value) = found.filter(|value| values[value.index()].block == self.open[depth].block) {
            return value;
        }
        let value = self.new_value(type_, depth);
        self.values[value.index()].uniform = match &kind {
            InstKind::Constant(_) | InstKind::BitsConstant(_) | InstKind::Column { .. } => true,
            InstKind::Op { args, .. } => args.iter().all(|&arg| self.is_uniform(arg)),
            InstKind::Input(_) | InstKind::Fold(_) => false,
        };
        self.append(depth, kind, Results::from_slice(&[value]));
        self.known.set(place, value);
        value
    }
}

macro_rules! emitting {
    ($(
        $(#[doc = $doc:literal])*
        $variant:ident $name:ident ( $($arg:ident : $type:ident),+ ) -> $result:ident $(, $flag:ident)*;
    )+) => {
        /// Emitting: every op becomes an instruction, or the one that exists already.
        impl Domain for FunctionBuilder {
            type Real = Value;
            type Mask = Value;
            type Bits = Value;

            fn constant(&mut self, value: f32) -> Value {
                self.insert(0, InstKind::Constant(value))
            }

            fn bits_constant(&mut self, value: u32) -> Value {
                self.insert(0, InstKind::BitsConstant(value))
            }

            $(
                fn $name(&mut self, $($arg: Value),+) -> Value {
                    self.op(Op::$variant, &[$($arg),+])
                }
            )+
        }
    };
}

crate::for_each_op!(emitting);
