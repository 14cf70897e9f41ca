//! Writes the text form. Total: a broken function prints too, so that one can see what is wrong with it.
//!
//! The walk over nested folds keeps an explicit stack, and no block is written twice: a second mention is
//! only its name.

use std::collections::{HashMap, HashSet};
use std::fmt::{self, Write};

use crate::entity::{Block, Entity, Inst, Table, Value};
use crate::function::{Function, InstKind};
use crate::limits::MAX_FOLD_DEPTH;
use crate::op::Type;
use crate::origin::Origin;
use crate::verify::{Place, VerifyError};

use super::lex::{is_bare, is_printable};

impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Printer::new(self, &[]).function(f)
    }
}

/// The text form with each error as a comment, `;! rule 5: ...`, at the end of the line that earns it.
///
/// Errors of parts that do not print (an instruction in no block) follow after the last line.
#[must_use]
pub fn annotated(function: &Function, errors: &[VerifyError]) -> String {
    let mut text = String::new();
    let mut printer = Printer::new(function, errors);
    printer.function(&mut text).expect("a string takes all text");
    for error in errors {
        if !printer.noted.contains(&error.place) {
            writeln!(text, ";! {error}").expect("a string takes all text");
        }
    }
    text
}

/// What a printer knows besides the function.
struct Printer<'a> {
    function: &'a Function,
    /// For each input, whether its name means it.
    inputs: Vec<bool>,
    /// For each table and column, whether its name means it.
    columns: Vec<Vec<bool>>,
    written: HashSet<Block>,
    notes: HashMap<Place, Vec<&'a VerifyError>>,
    noted: HashSet<Place>,
}

/// A block that is being written.
struct PrintedBlock {
    block: Block,
    next: usize,
}

impl<'a> Printer<'a> {
    fn new(function: &'a Function, errors: &'a [VerifyError]) -> Self {
        let mut notes: HashMap<Place, Vec<&VerifyError>> = HashMap::new();
        for error in errors {
            notes.entry(error.place).or_default().push(error);
        }
        Self {
            function,
            inputs: first_of_name(&function.inputs),
            columns: function.tables.values().map(|schema| first_of_name(&schema.columns)).collect(),
            written: HashSet::new(),
            notes,
            noted: HashSet::new(),
        }
    }

    fn function(&mut self, w: &mut impl Write) -> fmt::Result {
        let function = self.function;
        write!(w, "function {} ", Quoted(&function.name))?;
        names(w, &function.inputs)?;
        w.write_str(" -> ")?;
        names(w, &function.outputs)?;
        w.write_str(" {")?;
        self.end_line(w, &[Place::Function])?;
        for table in function.tables.keys() {
            self.table(w, table)?;
        }
        let body = function.body;
        let opened = self.block(w, body)?;
        self.end_line(w, &[Place::Block(body)])?;
        let mut open = Vec::new();
        if opened {
            open.push(PrintedBlock { block: body, next: 0 });
        }
        while let Some(PrintedBlock { block, next }) = open.last_mut() {
            let (block, at) = (*block, *next);
            *next += 1;
            indent(w, open.len())?;
            match function.blocks[block].insts.get(at) {
                Some(&inst) => {
                    if let Some(inner) = self.inst(w, inst)? {
                        open.push(PrintedBlock { block: inner, next: 0 });
                    }
                }
                None => {
                    w.write_str("yield")?;
                    spaced_list(w, &function.blocks[block].results)?;
                    self.end_line(w, &[Place::Yield(block)])?;
                    open.pop();
                }
            }
        }
        w.write_str("}\n")
    }

    fn table(&mut self, w: &mut impl Write, table: Table) -> fmt::Result {
        let schema = &self.function.tables[table];
        indent(w, 1)?;
        write!(w, "table {table} {} ", Quoted(&schema.name))?;
        names(w, &schema.columns)?;
        if let Some(parent) = schema.parent {
            write!(w, " in {parent}")?;
        }
        if !schema.slots.is_empty() {
            w.write_str(" slots (")?;
            list(w, &schema.slots)?;
            w.write_str(")")?;
        }
        self.end_line(w, &[Place::Table(table)])
    }

    /// Writes a block's name and parameters; whether its instructions are to follow.
    fn block(&mut self, w: &mut impl Write, block: Block) -> Result<bool, fmt::Error> {
        write!(w, "{block}")?;
        let Some(data) = self.function.blocks.get(block) else { return Ok(false) };
        if !self.written.insert(block) {
            return Ok(false);
        }
        if !data.params.is_empty() {
            w.write_str("(")?;
            self.defined(w, &data.params, Type::Real)?;
            w.write_str(")")?;
        }
        w.write_str(":")?;
        Ok(true)
    }

    /// Writes an instruction up to the end of its line, and returns the block whose instructions follow.
    fn inst(&mut self, w: &mut impl Write, inst: Inst) -> Result<Option<Block>, fmt::Error> {
        let function = self.function;
        let Some(data) = function.insts.get(inst) else {
            write!(w, "; {inst} does not exist")?;
            self.end_line(w, &[Place::Inst(inst)])?;
            return Ok(None);
        };
        if !data.results.is_empty() {
            self.defined(w, &data.results, data.kind.result_type())?;
            w.write_str(" = ")?;
        }
        let mut inner = None;
        let mut places = vec![Place::Inst(inst)];
        match &data.kind {
            InstKind::Input(index) => {
                w.write_str("input ")?;
                let by_name = self.inputs.get(*index).copied().unwrap_or(false);
                self.name_or_index(w, by_name.then(|| &*function.inputs[*index]), *index)?;
            }
            InstKind::Constant(number) => write!(w, "const {}", Real(*number))?,
            InstKind::BitsConstant(bits) => write!(w, "bits {bits:#010x}")?,
            InstKind::Column { table, column } => {
                write!(w, "column {table}.")?;
                let first = self.columns.get(table.index()).and_then(|columns| columns.get(*column));
                let by_name = first.copied().unwrap_or(false);
                self.name_or_index(w, by_name.then(|| &*function.tables[*table].columns[*column]), *column)?;
            }
            InstKind::Op { op, args } => {
                w.write_str(op.name())?;
                spaced_list(w, args)?;
            }
            InstKind::Fold(fold) => {
                write!(w, "fold {} {} {} (", fold.table, fold.kind.name(), fold.rule.name())?;
                list(w, &fold.initial)?;
                w.write_str(") ")?;
                if self.block(w, fold.body)? {
                    inner = Some(fold.body);
                    places.push(Place::Block(fold.body));
                }
            }
        }
        if data.origin != Origin::SHARED {
            write!(w, " {}", data.origin)?;
        }
        self.end_line(w, &places)?;
        Ok(inner)
    }

    fn name_or_index(&self, w: &mut impl Write, name: Option<&str>, index: usize) -> fmt::Result {
        match name {
            Some(name) => write!(w, "{}", Name(name)),
            None => write!(w, "{index}"),
        }
    }

    /// Values at their definition, with the types that are not `usual`.
    fn defined(&self, w: &mut impl Write, values: &[Value], usual: Type) -> fmt::Result {
        for (at, &value) in values.iter().enumerate() {
            write!(w, "{}{value}", if at == 0 { "" } else { ", " })?;
            if let Some(type_) = self.function.values.get(value).filter(|type_| **type_ != usual) {
                write!(w, ": {type_}")?;
            }
        }
        Ok(())
    }

    /// The errors of these places, and the end of the line.
    fn end_line(&mut self, w: &mut impl Write, places: &[Place]) -> fmt::Result {
        for place in places {
            self.noted.insert(*place);
            for error in self.notes.get(place).into_iter().flatten() {
                write!(w, " ;! rule {}: {}", error.rule, error.message)?;
            }
        }
        w.write_str("\n")
    }
}

/// For each name, whether no earlier one is the same.
fn first_of_name(names: &[String]) -> Vec<bool> {
    let mut seen = HashSet::new();
    names.iter().map(|name| seen.insert(name)).collect()
}

/// Four spaces a level. No verified function is deeper than the limit, and a broken one need not be legible
/// there.
fn indent(w: &mut impl Write, levels: usize) -> fmt::Result {
    (0..levels.min(MAX_FOLD_DEPTH + 1)).try_for_each(|_| w.write_str("    "))
}

fn list<T: fmt::Display>(w: &mut impl Write, items: &[T]) -> fmt::Result {
    for (at, item) in items.iter().enumerate() {
        write!(w, "{}{item}", if at == 0 { "" } else { ", " })?;
    }
    Ok(())
}

/// A list after a keyword: a space before it, unless it is empty.
fn spaced_list<T: fmt::Display>(w: &mut impl Write, items: &[T]) -> fmt::Result {
    if !items.is_empty() {
        w.write_str(" ")?;
    }
    list(w, items)
}

fn names(w: &mut impl Write, names: &[String]) -> fmt::Result {
    w.write_str("(")?;
    let names: Vec<Name<'_>> = names.iter().map(|name| Name(name)).collect();
    list(w, &names)?;
    w.write_str(")")
}

/// A name as it is written: bare if it can be.
struct Name<'a>(&'a str);

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if is_bare(self.0) { f.write_str(self.0) } else { Quoted(self.0).fmt(f) }
    }
}

/// A string in quotes, with nothing in it that a terminal would obey.
struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"")?;
        for letter in self.0.chars() {
            match letter {
                '"' | '\\' => write!(f, "\\{letter}")?,
                letter if is_printable(letter) => f.write_char(letter)?,
                letter => write!(f, "\\u{{{:x}}}", u32::from(letter))?,
            }
        }
        f.write_str("\"")
    }
}

/// A real as it is written: the shortest decimal that reads back as the same f32.
struct Real(f32);

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.to_bits() {
            0x7fc0_0000 => f.write_str("nan"),
            bits if self.0.is_nan() => write!(f, "nan:{bits:#010x}"),
            _ => write!(f, "{:?}", self.0),
        }
    }
}
