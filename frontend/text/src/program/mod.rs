//! Texts that are programs: definitions, loops, conditions, files, and values with names. They are expanded
//! as they are read.
//!
//! ```text
//! arm(2, hue = 0.1)          the cursor jumps to the body of `arm`, and back behind its `}`
//! for i in 0 .. 3 { .. }     at `}` it jumps back to the body, until `i` has had all its values
//! if i > 0 { .. } else { .. }   one of the blocks is skipped
//! include "parts.jbt"        the cursor goes through another text
//! ```
//!
//! So there is no list of tokens and no tree of syntax: what is open stands on the stack of open blocks
//! (`node.rs`), and nothing recurses, apart from files in files, of which there are
//! [`MAX_INCLUDE_DEPTH`](jbt_ir::limits::MAX_INCLUDE_DEPTH) at most. What an expansion will read is charged
//! before it begins, to the bytes that one scene may have: a scene is never longer than the longest text.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use jbt_ir::limits::{EXPANSION_BYTES, MAX_SCENE_BYTES};

use super::files::FileReader;
use super::state::{Options, Parser};
use super::texts::Texts;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::label::LabelCall;
use jbt_model::number::Number;
use jbt_model::parameter::Fixture;
use jbt_model::tree::Tree;

mod body;
mod call;
mod definition;
mod include;
mod repeat;
mod value;

pub(super) use body::{BodyFrame, BodyKind, LocalFrame};
pub(super) use call::CallFrame;
use call::Remembered;
use definition::ProgramDefinition;
use include::Included;
pub(super) use value::COUNT;

/// What a name stands for.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Number(Number),
    /// A vector, or a colour.
    Numbers(Arc<[Number]>),
    List(Arc<[Value]>),
    Tree(Tree),
}

impl Value {
    /// What could not be read.
    pub(super) fn unknown() -> Self {
        Self::Number(f64::NAN.into())
    }

    /// In words.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Numbers(_) => "a vector",
            Self::List(_) => "a list",
            Self::Tree(_) => "a node",
        }
    }

    /// The elements of a list or of a vector, each a value.
    pub(super) fn elements(&self) -> Option<Vec<Self>> {
        match self {
            Self::Number(_) | Self::Tree(_) => None,
            Self::Numbers(numbers) => Some(numbers.iter().cloned().map(Self::Number).collect()),
            Self::List(list) => Some(list.to_vec()),
        }
    }
}

/// What a program has defined, and how much it may expand.
pub(super) struct Program<'a> {
    pub(super) texts: &'a Texts,
    files: FileReader,
    /// Files that have been included, by their identity.
    included: HashMap<String, Included>,
    /// Those that are being read, each in the one before it: identities and paths.
    open: Vec<(String, String)>,
    definitions: HashMap<&'a str, Rc<ProgramDefinition<'a>>>,
    /// What has been expanded for which arguments.
    remembered: HashMap<call::CallKey, Remembered>,
    /// Values that have a name everywhere below.
    values: HashMap<&'a str, Value>,
    /// Arguments and variables, those of the innermost body last.
    locals: Vec<(&'a str, Value)>,
    /// The first of them that can be seen: a definition does not see those of its callers.
    visible: usize,
    /// The calls and loops around what is read.
    pub(super) calls: Option<Arc<LabelCall>>,
    /// How many bodies are open.
    depth: usize,
    /// Where blocks end that have been looked at, by where they begin.
    ends: HashMap<usize, usize>,
    /// Bytes of text that may still be read.
    left: usize,
    /// Something has been expanded.
    pub(super) has_expanded: bool,
}

impl<'a> Program<'a> {
    pub(super) fn new(whole: &str, texts: &'a Texts, options: &Options) -> Self {
        Self {
            texts,
            files: options.files.reader(),
            included: HashMap::new(),
            open: Vec::new(),
            definitions: HashMap::new(),
            remembered: HashMap::new(),
            values: HashMap::new(),
            locals: Vec::new(),
            visible: 0,
            calls: None,
            depth: 0,
            ends: HashMap::new(),
            left: MAX_SCENE_BYTES.saturating_sub(whole.len()),
            has_expanded: false,
        }
    }

    /// What a name stands for, if it is an argument, a variable, or a value with a name.
    pub(super) fn value(&self, name: &str) -> Option<&Value> {
        let locals = self.locals[self.visible..].iter().rev();
        locals.into_iter().find(|(local, _)| *local == name).map(|(_, value)| value).or_else(|| {
            // Most texts have none.
            if self.values.is_empty() { None } else { self.values.get(name) }
        })
    }

    /// The names of values that can be seen.
    pub(super) fn value_names(&self) -> impl Iterator<Item = &str> {
        self.locals[self.visible..].iter().map(|(name, _)| *name).chain(self.values.keys().copied())
    }

    /// Gives a value a name everywhere below. Whether it had one already.
    pub(super) fn define(&mut self, name: &'a str, value: Value) -> bool {
        self.values.insert(name, value).is_some()
    }

    fn bind(&mut self, name: &'a str, value: Value) {
        self.locals.push((name, value));
    }

    /// The names of definitions.
    pub(super) fn definition_names(&self) -> impl Iterator<Item = &str> {
        self.definitions.keys().copied()
    }

    pub(super) fn defines(&self, name: &str) -> bool {
        !self.definitions.is_empty() && self.definitions.contains_key(name)
    }
}

impl<'a> Parser<'a> {
    /// Whether what is read stands in a file that the scene includes.
    pub(super) fn is_included(&self) -> bool {
        !self.program.open.is_empty()
    }

    /// Charges so many turns of so many bytes each to what may still be read. False, after a message, if that
    /// is too much; then nothing is read any more.
    fn charge(&mut self, turns: f64, bytes: usize, span: Span, what: &str) -> bool {
        self.program.has_expanded = true;
        let cost = turns * (bytes + EXPANSION_BYTES) as f64;
        let is_enough = self.is_enough(cost, span, what);
        if is_enough {
            self.program.left -= cost as usize;
        }
        is_enough
    }

    /// Whether so many turns can be afforded. False after a message; then nothing is read any more.
    fn affords(&mut self, turns: f64, span: Span, what: &str) -> bool {
        self.is_enough(turns * EXPANSION_BYTES as f64, span, what)
    }

    fn is_enough(&mut self, cost: f64, span: Span, what: &str) -> bool {
        if cost <= self.program.left as f64 {
            return true;
        }
        let left = self.program.left;
        let message = format!("{what} would make the text longer by {cost} bytes; {left} are left");
        self.give_up(
            Diagnostic::limit(Some(span), message)
                .expected(format!("an expanded text may have {MAX_SCENE_BYTES}")),
        );
        false
    }

    /// Charges the copy of a formula of so many steps.
    pub(super) fn charge_copy(&mut self, steps: usize, span: Span) -> bool {
        const STEP_BYTES: usize = 16;
        let cost = steps * STEP_BYTES;
        if let Some(left) = self.program.left.checked_sub(cost) {
            self.program.left = left;
            return true;
        }
        let message =
            format!("the formula of this number has {steps} steps, which are too many to copy here");
        self.give_up(Diagnostic::limit(Some(span), message));
        false
    }

    /// Notes that nodes depend on a number which stays as it was read.
    fn decides(&mut self, number: &Number, span: Span) {
        if number.depends_on_parameters() {
            self.declares(Fixture::Expansion, number, span);
        }
    }

    /// A tree with a name, unless it has one.
    pub(super) fn with_name(&self, tree: Tree, name: &str) -> Tree {
        if tree.node().name().is_some() || tree.identity() == self.broken.identity() {
            return tree;
        }
        tree.named(name)
    }
}
