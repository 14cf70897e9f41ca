//! The rules of a function. Engines and passes rely on them and check nothing again: [`Verified`] is their
//! only door.
//!
//!  1. *Shape.* The function's body exists. Every other block is the body of exactly one fold, and every
//!     instruction stands exactly once in exactly one block, so that the blocks are a tree.
//!  2. *Definition.* Every value is defined exactly once: as the result of an instruction, or as the
//!     accumulator that the body of a fold binds.
//!  3. *Use.* A value is used after its definition, in the same block or in one inside it. A fold's body sees
//!     its own accumulators but not the fold's results.
//!  4. *Results.* An instruction that is not a fold defines one value: real for an input, a constant or a
//!     column, bits for a bits constant, and what the op table says for an op.
//!  5. *Operands.* An op has as many operands as its row of the op table, of the same types.
//!  6. *Shifts.* The amount of `shl` and `shr` is a bits constant: vector units shift all lanes alike.
//!  7. *Inputs.* An input that is read exists.
//!  8. *Columns.* A column that is read exists, and the fold over its table encloses the reading.
//!  9. *Tables.* The table of a fold exists, and no table is folded twice. The parent of a table is declared
//!     before it.
//! 10. *Nesting.* The fold over a table with a parent stands inside the fold over the parent, at any depth:
//!     the parent's current row says which rows run. A fold over a table without parent runs all rows of the
//!     table, even inside another fold.
//! 11. *Accumulators.* A fold's initial values, its body's accumulators, what its body yields, and the fold's
//!     results agree in number and type.
//! 12. *Outputs.* The function's body binds nothing and yields one real for each output name.
//! 13. *Slots.* A leaf slot belongs to one table and stands there once. The slot of an origin belongs to some
//!     table.
//! 14. *Limits.* There are at most [`MAX_VALUES`] values and [`MAX_TABLES`] tables, and at most
//!     [`MAX_FOLD_DEPTH`] folds in each other.
//!
//! ```text
//! declare the tables and their slots
//! enter the body;  for each instruction: check its operands, then itself, then make its results visible
//!   a fold:        check its accumulators, enter its body;  at the end check the yield, hide the body's values
//! blocks and instructions that were not entered, and values without a definition, are errors too
//! ```

use std::collections::HashMap;
use std::fmt;

use crate::entity::{Block, Entity, Inst, Store, Table, Value};
use crate::function::{Fold, Function, InstData, InstKind};
use crate::limits::{MAX_FOLD_DEPTH, MAX_TABLES, MAX_VALUES};
use crate::op::{Op, Type};

/// A function that obeys every rule: the only thing that an engine accepts.
#[derive(Clone, Debug)]
pub struct Verified(Function);

impl Verified {
    /// The function.
    #[must_use]
    pub const fn function(&self) -> &Function {
        &self.0
    }

    /// The function, for a pass to change: it has to be verified again.
    #[must_use]
    pub fn into_function(self) -> Function {
        self.0
    }
}

/// A place in a function, for an error to point at.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Place {
    /// The function as a whole.
    Function,
    /// The declaration of a table.
    Table(Table),
    /// The head of a block.
    Block(Block),
    /// An instruction.
    Inst(Inst),
    /// What a block yields.
    Yield(Block),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Function => f.write_str("function"),
            Self::Table(table) => table.fmt(f),
            Self::Block(block) => block.fmt(f),
            Self::Inst(inst) => inst.fmt(f),
            Self::Yield(block) => write!(f, "yield of {block}"),
        }
    }
}

/// One broken rule. [`crate::text::annotated`] prints a function with its errors on the lines that earn them.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{place}: rule {rule}: {message}")]
pub struct VerifyError {
    /// Where.
    pub place: Place,
    /// The number of the rule at the head of [`mod@crate::verify`].
    pub rule: u32,
    /// What breaks it.
    pub message: String,
}

/// Checks a function.
///
/// # Errors
/// Every rule that is broken, in the order of the function; each instruction, yield and table may add its
/// own.
pub fn verify(function: Function) -> Result<Verified, Vec<VerifyError>> {
    let mut verifier = Verifier::new(&function);
    verifier.tables();
    verifier.blocks();
    verifier.leftovers();
    let errors = verifier.errors;
    if errors.is_empty() { Ok(Verified(function)) } else { Err(errors) }
}

/// Where a value can be used.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scope {
    Undefined,
    Visible,
    /// It was defined in a block that has ended.
    Ended,
}

/// A block that is being checked.
struct Open {
    block: Block,
    /// The position of the next instruction.
    next: usize,
    /// What it has defined.
    defined: Vec<Value>,
    /// The fold whose body it is; `None` for the function's body.
    fold: Option<Inst>,
    /// The table that its fold has made readable.
    table: Option<Table>,
}

/// What has been seen so far. Every index that comes from the function is looked up with `get`: it may be
/// wild.
struct Verifier<'a> {
    function: &'a Function,
    errors: Vec<VerifyError>,
    scopes: Vec<Scope>,
    /// Values that a bits constant defines.
    constants: Vec<bool>,
    blocks: Vec<bool>,
    insts: Vec<bool>,
    /// Tables whose fold has been seen, and those whose fold is open.
    folded: Vec<bool>,
    open_tables: Vec<bool>,
    slots: HashMap<u32, Table>,
    open: Vec<Open>,
}

impl<'a> Verifier<'a> {
    fn new(function: &'a Function) -> Self {
        Self {
            function,
            errors: Vec::new(),
            scopes: vec![Scope::Undefined; function.values.len()],
            constants: vec![false; function.values.len()],
            blocks: vec![false; function.blocks.len()],
            insts: vec![false; function.insts.len()],
            folded: vec![false; function.tables.len()],
            open_tables: vec![false; function.tables.len()],
            slots: HashMap::new(),
            open: Vec::new(),
        }
    }

    fn error(&mut self, place: Place, rule: u32, message: impl Into<String>) {
        self.errors.push(VerifyError { place, rule, message: message.into() });
    }

    /// Rules 9, 13 and 14, as far as they speak of declarations.
    fn tables(&mut self) {
        let function = self.function;
        if function.values.len() > MAX_VALUES {
            let message = format!("{} values, at most {MAX_VALUES} are allowed", function.values.len());
            self.error(Place::Function, 14, message);
        }
        if function.tables.len() > MAX_TABLES {
            let message = format!("{} tables, at most {MAX_TABLES} are allowed", function.tables.len());
            self.error(Place::Function, 14, message);
        }
        for (table, schema) in function.tables.iter() {
            let place = Place::Table(table);
            if let Some(parent) = schema.parent.filter(|parent| *parent >= table) {
                self.error(place, 9, format!("the parent {parent} is not declared before {table}"));
            }
            for &slot in &schema.slots {
                if let Some(owner) = self.slots.insert(slot, table) {
                    self.error(place, 13, format!("slot {slot} belongs to {owner} already"));
                }
            }
        }
    }

    /// Walks the tree of blocks on an explicit stack.
    fn blocks(&mut self) {
        let function = self.function;
        self.outputs();
        if self.enter(Place::Function, function.body, None, None)
            && !function.blocks[function.body].params.is_empty()
        {
            self.error(Place::Block(function.body), 12, "the function's body binds no values");
        }
        while let Some(open) = self.open.last_mut() {
            let insts = &function.blocks[open.block].insts;
            let next = insts.get(open.next).copied();
            open.next += 1;
            match next {
                Some(inst) => self.inst(inst),
                None => self.leave(),
            }
        }
    }

    /// Rule 12, for what the body yields.
    fn outputs(&mut self) {
        let function = self.function;
        let Some(body) = function.blocks.get(function.body) else { return };
        let place = Place::Yield(function.body);
        if body.results.len() != function.outputs.len() {
            let (given, wanted) = (body.results.len(), function.outputs.len());
            self.error(place, 12, format!("{} for {}", count(given, "value"), count(wanted, "output")));
        }
        for &value in &body.results {
            if let Some(type_) = self.type_of(value).filter(|type_| *type_ != Type::Real) {
                self.error(place, 12, format!("the output {value} is {type_}, not real"));
            }
        }
    }

    /// Opens a block and defines its parameters; whether it can be opened (rule 1).
    fn enter(&mut self, place: Place, block: Block, fold: Option<Inst>, table: Option<Table>) -> bool {
        let Some(seen) = self.blocks.get_mut(block.index()) else {
            self.error(place, 1, format!("{block} does not exist"));
            return false;
        };
        if std::mem::replace(seen, true) {
            self.error(place, 1, format!("{block} is a body already"));
            return false;
        }
        self.open.push(Open { block, next: 0, defined: Vec::new(), fold, table });
        self.define(Place::Block(block), &self.function.blocks[block].params);
        true
    }

    /// Ends the innermost block: its values are hidden, and its fold's results can be seen.
    fn leave(&mut self) {
        let Some(open) = self.open.last() else { return };
        let (block, table, fold) = (open.block, open.table, open.fold);
        self.uses(Place::Yield(block), &self.function.blocks[block].results);
        let defined = self.open.pop().map(|open| open.defined).unwrap_or_default();
        for value in defined {
            self.scopes[value.index()] = Scope::Ended;
        }
        if let Some(table) = table {
            self.open_tables[table.index()] = false;
        }
        if let Some(fold) = fold {
            self.define(Place::Inst(fold), &self.function.insts[fold].results);
        }
    }

    fn inst(&mut self, inst: Inst) {
        crate::watch::look();
        let place = Place::Inst(inst);
        let Some(seen) = self.insts.get_mut(inst.index()) else {
            return self.error(place, 1, format!("{inst} does not exist"));
        };
        if std::mem::replace(seen, true) {
            return self.error(place, 1, format!("{inst} stands in a block already"));
        }
        let data = &self.function.insts[inst];
        self.uses(place, self.function.operands(inst));
        if let Some(slot) = data.origin.slot().filter(|slot| !self.slots.contains_key(slot)) {
            self.error(place, 13, format!("slot {slot} belongs to no table"));
        }
        match &data.kind {
            InstKind::Input(index) => self.input(place, *index),
            InstKind::Constant(_) => {}
            InstKind::BitsConstant(_) => {
                if let Some(constant) =
                    data.results.first().and_then(|value| self.constants.get_mut(value.index()))
                {
                    *constant = true;
                }
            }
            InstKind::Column { table, column } => self.column(place, *table, *column),
            InstKind::Op { op, args } => self.operands(place, *op, args),
            InstKind::Fold(fold) => return self.fold(inst, data, fold),
        }
        self.results(place, data);
        self.define(place, &data.results);
    }

    /// Rule 4.
    fn results(&mut self, place: Place, data: &InstData) {
        let [result] = data.results[..] else {
            return self.error(place, 4, format!("{} defined, not one", count(data.results.len(), "value")));
        };
        let expected = data.kind.result_type();
        if let Some(type_) = self.type_of(result).filter(|type_| *type_ != expected) {
            self.error(place, 4, format!("{result} is {type_}, not {expected}"));
        }
    }

    /// Rules 5 and 6.
    fn operands(&mut self, place: Place, op: Op, args: &[Value]) {
        let expected = op.operands();
        if args.len() != expected.len() {
            let (name, wanted, given) = (op.name(), count(expected.len(), "operand"), args.len());
            return self.error(place, 5, format!("{name} takes {wanted}, not {given}"));
        }
        for (&arg, &expected) in args.iter().zip(expected) {
            if let Some(type_) = self.type_of(arg).filter(|type_| *type_ != expected) {
                self.error(place, 5, format!("{arg} is {type_}, not {expected}"));
            }
        }
        if let (Op::Shl | Op::Shr, &[_, by]) = (op, args) {
            let variable = self.constants.get(by.index()).is_some_and(|constant| !constant);
            if variable && self.type_of(by) == Some(Type::Bits) {
                self.error(place, 6, format!("the amount {by} is not a bits constant"));
            }
        }
    }

    /// Rule 7.
    fn input(&mut self, place: Place, index: usize) {
        let inputs = self.function.inputs.len();
        if index >= inputs {
            self.error(place, 7, format!("no input {index}: {} counted from 0", count(inputs, "input")));
        }
    }

    /// Rule 8.
    fn column(&mut self, place: Place, table: Table, column: usize) {
        let Some(schema) = self.function.tables.get(table) else {
            return self.error(place, 8, format!("{table} does not exist"));
        };
        let columns = schema.columns.len();
        if column >= columns {
            self.error(
                place,
                8,
                format!("no column {column} in {table}: {} counted from 0", count(columns, "column")),
            );
        }
        if !self.open_tables[table.index()] {
            self.error(place, 8, format!("no fold over {table} encloses this"));
        }
    }

    /// Rules 9 to 11 and 14, then its body.
    fn fold(&mut self, inst: Inst, data: &InstData, fold: &Fold) {
        let place = Place::Inst(inst);
        let function = self.function;
        let mut readable = None;
        match function.tables.get(fold.table) {
            None => self.error(place, 9, format!("{} does not exist", fold.table)),
            Some(schema) => {
                if std::mem::replace(&mut self.folded[fold.table.index()], true) {
                    self.error(place, 9, format!("{} is folded already", fold.table));
                }
                let outside =
                    |parent: &Table| !self.open_tables.get(parent.index()).is_some_and(|open| *open);
                if let Some(parent) = schema.parent.filter(outside) {
                    self.error(place, 10, format!("no fold over {parent}, the parent, encloses this"));
                }
                if !std::mem::replace(&mut self.open_tables[fold.table.index()], true) {
                    readable = Some(fold.table);
                }
            }
        }
        if self.open.len() == MAX_FOLD_DEPTH + 1 {
            self.error(place, 14, format!("more than {MAX_FOLD_DEPTH} folds in each other"));
        }
        if let Some(body) = function.blocks.get(fold.body) {
            self.accumulators(place, fold, "accumulator", &body.params);
            self.accumulators(Place::Yield(fold.body), fold, "next value", &body.results);
        }
        self.accumulators(place, fold, "result", &data.results);
        if !self.enter(place, fold.body, Some(inst), readable) {
            if let Some(table) = readable {
                self.open_tables[table.index()] = false;
            }
            self.define(place, &data.results);
        }
    }

    /// Rule 11: `values` agree with the initial values in number and type.
    fn accumulators(&mut self, place: Place, fold: &Fold, what: &str, values: &[Value]) {
        if values.len() != fold.initial.len() {
            let (given, wanted) = (count(values.len(), what), count(fold.initial.len(), "initial value"));
            return self.error(place, 11, format!("{given} for {wanted}"));
        }
        for (&value, &initial) in values.iter().zip(&fold.initial) {
            if let (Some(given), Some(wanted)) = (self.type_of(value), self.type_of(initial))
                && given != wanted
            {
                self.error(place, 11, format!("{value} is {given}, the initial {initial} is {wanted}"));
            }
        }
    }

    fn type_of(&self, value: Value) -> Option<Type> {
        self.function.values.get(value).copied()
    }

    /// Rule 2: these values begin here, in the innermost block.
    fn define(&mut self, place: Place, values: &[Value]) {
        for &value in values {
            match self.scopes.get(value.index()) {
                None => self.error(place, 2, format!("{value} does not exist")),
                Some(Scope::Visible | Scope::Ended) => {
                    self.error(place, 2, format!("{value} is defined already"));
                }
                Some(Scope::Undefined) => {
                    self.scopes[value.index()] = Scope::Visible;
                    if let Some(open) = self.open.last_mut() {
                        open.defined.push(value);
                    }
                }
            }
        }
    }

    /// Rule 3 (and 2, for values that do not exist at all).
    fn uses(&mut self, place: Place, values: &[Value]) {
        for &value in values {
            match self.scopes.get(value.index()) {
                Some(Scope::Visible) => {}
                None => self.error(place, 2, format!("{value} does not exist")),
                Some(Scope::Undefined) => self.error(place, 3, format!("{value} is not defined before this")),
                Some(Scope::Ended) => {
                    self.error(place, 3, format!("{value} is defined inside a fold that has ended"));
                }
            }
        }
    }

    /// Rules 1 and 2, for what the walk never met.
    fn leftovers(&mut self) {
        for block in missing(&self.function.blocks, &self.blocks) {
            self.error(Place::Block(block), 1, "it is the body of no fold");
        }
        for inst in missing(&self.function.insts, &self.insts) {
            self.error(Place::Inst(inst), 1, "it stands in no block");
        }
        let undefined = self.scopes.iter().filter(|scope| **scope == Scope::Undefined).count();
        if let Some(first) = self.scopes.iter().position(|scope| *scope == Scope::Undefined) {
            let first = Value::new(first);
            let message = match undefined {
                1 => format!("{first} is defined nowhere"),
                count => format!("{count} values are defined nowhere, {first} is the first"),
            };
            self.error(Place::Function, 2, message);
        }
    }
}

/// `2 values`, or `1 value`.
fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// The entities that were not seen.
fn missing<K: Entity, V>(store: &Store<K, V>, seen: &[bool]) -> Vec<K> {
    store.keys().filter(|key| !seen[key.index()]).collect()
}
