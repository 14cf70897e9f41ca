//! Reads the text form, line by line. An error ends the reading of its line; the next line is read as usual.
//!
//! Open folds stand on an explicit stack, so nested text needs no nested calls. The parser checks form only:
//! whether a value is defined before its use is a rule of [`mod@crate::verify`].

use std::collections::HashMap;
use std::sync::Arc;

use crate::entity::{Block, Entity, Store, Value};
use crate::function::{BlockData, Fold, FoldKind, Function, InstData, InstKind, Rule, Schema};
use crate::limits::{MAX_ERRORS, MAX_FOLD_DEPTH, MAX_TABLES};
use crate::op::{Op, Type};

use super::lex::Kind;
use super::line::{Defined, Line, LineSpan, ParseError, Parsed};

/// Reads one function. The text form is described at the head of [`crate::text`].
///
/// # Errors
/// The errors, at most one per line, in order of lines; reading stops after [`MAX_ERRORS`] of them. Value
/// numbers, table numbers and the depth of folds are checked against [`crate::limits`] here, so that the
/// memory of a parse is in proportion to the text.
pub fn parse(text: &str) -> Result<Function, Vec<ParseError>> {
    let mut parser = Parser::new();
    let mut last = (1, "");
    for (index, line) in text.lines().enumerate() {
        last = (index + 1, line);
        parser.line(index + 1, line);
        if parser.errors.len() >= MAX_ERRORS {
            return Err(parser.errors);
        }
    }
    if parser.stage != Stage::End {
        let at = LineSpan { line: last.0, text: last.1, start: last.1.len(), end: last.1.len() };
        parser.errors.push(at.error(parser.stage.expected(parser.open.is_empty())));
    }
    if parser.errors.is_empty() { Ok(parser.function) } else { Err(parser.errors) }
}

/// What the next line can be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Header,
    Tables,
    Body,
    End,
}

impl Stage {
    const fn expected(self, closed: bool) -> &'static str {
        match self {
            Self::Header => "`function`",
            Self::Tables => "a table, or the body, such as `block0:`",
            Self::Body if closed => "`}`",
            Self::Body => "an instruction or `yield`",
            Self::End => "nothing after the function",
        }
    }
}

/// A block where a fold or the function names it. The parameters are there if a colon follows the name.
type Named = (Block, Option<Vec<Defined>>);

struct Parser {
    function: Function,
    stage: Stage,
    /// The blocks that are being written; `None` after a line that looked like a fold but was wrong.
    open: Vec<Option<Block>>,
    /// For each value and block, whether it has been defined.
    defined: Vec<bool>,
    written: Vec<bool>,
    inputs: HashMap<String, usize>,
    columns: Vec<HashMap<String, usize>>,
    errors: Vec<ParseError>,
}

impl Parser {
    fn new() -> Self {
        Self {
            function: Function {
                name: String::new(),
                inputs: Vec::new(),
                outputs: Vec::new(),
                tables: Arc::default(),
                values: Store::new(),
                insts: Store::new(),
                blocks: Store::new(),
                body: Block::new(0),
            },
            stage: Stage::Header,
            open: Vec::new(),
            defined: Vec::new(),
            written: Vec::new(),
            inputs: HashMap::new(),
            columns: Vec::new(),
            errors: Vec::new(),
        }
    }

    fn line(&mut self, number: usize, text: &str) {
        let mut line = Line::new(number, text);
        if line.token.kind == Kind::End {
            return;
        }
        let stage = self.stage;
        let result = match stage {
            Stage::Header => self.header(&mut line),
            Stage::Tables => self.table_or_body(&mut line),
            Stage::Body if self.open.is_empty() => self.close(&mut line),
            Stage::Body => self.inst_or_yield(&mut line),
            Stage::End => Err(line.error(Stage::End.expected(true))),
        };
        if let Err(error) = result {
            self.errors.push(error);
            self.recover(stage, text);
        }
    }

    /// After a wrong line, guesses its kind, so that the error does not spread to the next lines.
    fn recover(&mut self, stage: Stage, text: &str) {
        let text = text.split(';').next().unwrap_or_default().trim();
        match stage {
            Stage::Header => self.stage = Stage::Tables,
            Stage::Tables if text.starts_with("block") && self.stage == Stage::Tables => {
                self.stage = Stage::Body;
                self.open.push(None);
            }
            Stage::Body if text.starts_with("yield") && !self.open.is_empty() => {
                self.open.pop();
            }
            Stage::Body if text.split(' ').any(|word| word == "fold") && text.ends_with(':') => {
                self.open.push(None);
            }
            Stage::Tables | Stage::Body | Stage::End => {}
        }
    }

    fn header(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        line.word("function")?;
        self.function.name = line.quoted("the function's name in quotes")?;
        self.function.inputs = line.names()?;
        self.inputs = by_name(&self.function.inputs);
        line.punctuation("->")?;
        self.function.outputs = line.names()?;
        line.punctuation("{")?;
        line.end()?;
        self.stage = Stage::Tables;
        Ok(())
    }

    fn table_or_body(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        if line.token.kind == Kind::Word("table") {
            return self.table(line);
        }
        if line.number_after("block").is_none() {
            return Err(line.error(Stage::Tables.expected(false)));
        }
        let named = self.named_block(line)?;
        line.end()?;
        self.function.body = named.0;
        self.stage = Stage::Body;
        self.enter(named);
        Ok(())
    }

    fn table(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        line.word("table")?;
        let next = self.function.tables.next_key();
        let start = *line;
        if line.table()? != next {
            return Err(start.error(format!("`{next}`")));
        }
        let name = line.quoted("the table's name in quotes")?;
        let columns = line.names()?;
        let parent = if line.skip_word("in") { Some(line.table()?) } else { None };
        let mut slots = Vec::new();
        if line.skip_word("slots") {
            line.punctuation("(")?;
            slots = line.list(|line| line.integer("a slot, such as 3"))?;
            line.punctuation(")")?;
        }
        line.end()?;
        self.columns.push(by_name(&columns));
        Arc::make_mut(&mut self.function.tables).push(Schema { name, columns, parent, slots });
        Ok(())
    }

    /// `}`, after the body's `yield`.
    fn close(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        line.punctuation("}")?;
        line.end()?;
        self.stage = Stage::End;
        Ok(())
    }

    fn inst_or_yield(&mut self, line: &mut Line<'_>) -> Parsed<()> {
        if line.skip_word("yield") {
            let results = line.values()?;
            line.end()?;
            if let Some(block) = self.open.pop().flatten() {
                self.function.blocks[block].results = results;
            }
            return Ok(());
        }
        let mut results = Vec::new();
        if line.number_after("v").is_some() {
            results = line.list(Line::defined)?;
            line.punctuation("=")?;
        }
        let mut inner = None;
        let kind = self.kind(line, &mut inner)?;
        let origin = line.origin()?;
        line.end()?;
        let usual = kind.result_type();
        let results = results.into_iter().map(|defined| self.define(defined, usual)).collect();
        let inst = self.function.insts.push(InstData { kind, results, origin });
        if let Some(block) = self.open.last().copied().flatten() {
            self.function.blocks[block].insts.push(inst);
        }
        if let Some(named) = inner {
            self.enter(named);
        }
        Ok(())
    }

    /// What an instruction does; the block of a fold goes into `inner`.
    fn kind(&mut self, line: &mut Line<'_>, inner: &mut Option<Named>) -> Parsed<InstKind> {
        let start = *line;
        let Kind::Word(word) = line.token.kind else {
            return Err(line.error("an instruction: an op, or input, const, bits, column, fold"));
        };
        line.advance();
        match word {
            "input" => {
                Ok(InstKind::Input(line.name_or_index("an input, by name or index", Some(&self.inputs))?))
            }
            "const" => Ok(InstKind::Constant(line.real()?)),
            "bits" => Ok(InstKind::BitsConstant(line.hex()?)),
            "column" => {
                let table = line.table()?;
                line.punctuation(".")?;
                let columns = self.columns.get(table.index());
                let column =
                    line.name_or_index(&format!("a column of {table}, by name or index"), columns)?;
                Ok(InstKind::Column { table, column })
            }
            "fold" => {
                let (fold, named) = self.fold(line, &start)?;
                *inner = Some(named);
                Ok(InstKind::Fold(Box::new(fold)))
            }
            name => match Op::ALL.iter().find(|op| op.name() == name) {
                Some(&op) => Ok(InstKind::Op { op, args: line.values()? }),
                None => Err(start.error("an instruction: an op, or input, const, bits, column, fold")),
            },
        }
    }

    fn fold(&self, line: &mut Line<'_>, start: &Line<'_>) -> Parsed<(Fold, Named)> {
        if self.open.len() > MAX_FOLD_DEPTH {
            return Err(start.error(format!("at most {MAX_FOLD_DEPTH} folds in each other")));
        }
        let table = line.table()?;
        let kind = line.choice("what the rows are", &FoldKind::ALL, FoldKind::name)?;
        let rule = line.choice("a rule", &Rule::ALL, Rule::name)?;
        line.punctuation("(")?;
        let initial = line.values()?;
        line.punctuation(")")?;
        let named = self.named_block(line)?;
        Ok((Fold { table, kind, rule, initial, body: named.0 }, named))
    }

    /// `block1`, or `block1:`, or `block1(v5: mask):`, which can be written once only.
    fn named_block(&self, line: &mut Line<'_>) -> Parsed<Named> {
        let start = *line;
        let block = line.entity("block", MAX_TABLES + 1)?;
        let mut params = Vec::new();
        let bound = line.skip("(");
        if bound {
            params = line.list(Line::defined)?;
            line.punctuation(")")?;
        }
        if !bound && line.token.kind != Kind::Punctuation(":") {
            return Ok((block, None));
        }
        line.punctuation(":")?;
        if self.written.get(block.index()).copied().unwrap_or(false) {
            return Err(start.error("a block that has not been written yet"));
        }
        Ok((block, Some(params)))
    }

    /// Makes this block the owner of the instructions that follow.
    fn enter(&mut self, (block, params): Named) {
        let Some(params) = params else { return };
        while self.function.blocks.len() <= block.index() {
            self.function.blocks.push(BlockData::default());
            self.written.push(false);
        }
        self.written[block.index()] = true;
        let params = params.into_iter().map(|defined| self.define(defined, Type::Real)).collect();
        self.function.blocks[block].params = params;
        self.open.push(Some(block));
    }

    /// Gives a value its type. A second definition changes nothing: the verifier refuses it.
    fn define(&mut self, (value, type_): Defined, usual: Type) -> Value {
        while self.function.values.len() <= value.index() {
            self.function.values.push(Type::Real);
            self.defined.push(false);
        }
        if !std::mem::replace(&mut self.defined[value.index()], true) {
            self.function.values[value] = type_.unwrap_or(usual);
        }
        value
    }
}

/// The index of each name. A name that stands more than once has the index of the first.
fn by_name(names: &[String]) -> HashMap<String, usize> {
    let mut indices = HashMap::new();
    for (index, name) in names.iter().enumerate() {
        indices.entry(name.clone()).or_insert(index);
    }
    indices
}
