//! What a program has defined, and what of it is being read. `block.rs` has these frames on its stack, and
//! the parser has the program: so this file knows neither.

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use jbt_ir::limits::MAX_SCENE_BYTES;

use crate::files::FileReader;
use crate::lex::TextPlace;
use crate::texts::Texts;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::label::LabelCall;
use jbt_model::number::Number;
use jbt_model::tree::Tree;
use jbt_model::written::{Written, WrittenParticles};

/// The word for the number of a list's elements.
pub(crate) const COUNT: &str = "count";

/// What a name stands for.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Number(Number),
    /// A vector, or a colour.
    Numbers(Arc<[Number]>),
    List(Arc<[Value]>),
    Tree(Tree),
}

impl Value {
    /// What could not be read.
    pub(crate) fn unknown() -> Self {
        Self::Number(f64::NAN.into())
    }

    /// In words.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Numbers(_) => "a vector",
            Self::List(_) => "a list",
            Self::Tree(_) => "a node",
        }
    }

    /// How many elements a list or a vector has.
    pub(crate) fn count(&self) -> Option<usize> {
        match self {
            Self::Number(_) | Self::Tree(_) => None,
            Self::Numbers(numbers) => Some(numbers.len()),
            Self::List(list) => Some(list.len()),
        }
    }

    /// An element of a list or of a vector.
    pub(crate) fn element(&self, place: usize) -> Option<Self> {
        match self {
            Self::Number(_) | Self::Tree(_) => None,
            Self::Numbers(numbers) => numbers.get(place).cloned().map(Self::Number),
            Self::List(list) => list.get(place).cloned(),
        }
    }

    /// The elements of a list or of a vector, each a value. Cost: a copy of all.
    pub(crate) fn elements(&self) -> Option<Vec<Self>> {
        match self {
            Self::Number(_) | Self::Tree(_) => None,
            Self::Numbers(numbers) => Some(numbers.iter().cloned().map(Self::Number).collect()),
            Self::List(list) => Some(list.to_vec()),
        }
    }
}

/// A file, and how it is read: columns, arrays that become attributes, whether the text gives a radius.
pub(crate) type ParticleKey = (String, Vec<String>, Vec<String>, bool);

/// Why a file has no particles.
pub(crate) enum ParticleFault {
    /// It is of a format that has none.
    None,
    /// They cannot be read; with the place, in words.
    Unreadable(String),
}

/// What a program has defined, and how much it may expand.
pub(crate) struct TextProgram<'a> {
    pub(crate) texts: &'a Texts,
    pub(super) files: FileReader,
    /// Files that have been included, by their identity.
    pub(super) included: HashMap<String, Included>,
    /// What files of particles have.
    pub(crate) particles: HashMap<ParticleKey, Result<WrittenParticles, ParticleFault>>,
    /// Those that are being read, each in the one before it: identities and paths.
    pub(super) open: Vec<(String, String)>,
    pub(super) definitions: HashMap<&'a str, Rc<ProgramDefinition<'a>>>,
    /// Styles; nothing for those with errors.
    pub(super) styles: HashMap<&'a str, Option<Rc<TextStyle>>>,
    /// What has been expanded for which arguments.
    pub(super) remembered: HashMap<CallKey, Remembered>,
    /// Values that have a name everywhere below.
    pub(super) values: HashMap<&'a str, Value>,
    /// Arguments and variables, those of the innermost body last.
    pub(super) locals: Vec<(&'a str, Value)>,
    /// The first of them that can be seen: a definition does not see those of its callers.
    pub(super) visible: usize,
    /// The calls and loops around what is read.
    pub(crate) calls: Option<Arc<LabelCall>>,
    /// How many bodies are open.
    pub(super) depth: usize,
    /// Where blocks end that have been looked at, by where they begin.
    pub(super) ends: HashMap<usize, usize>,
    /// Bytes of text that may still be read.
    pub(super) left: usize,
    /// The message about a parameter that is out of its range: nodes that parameters decide are not looked at
    /// then.
    pub(crate) out_of_range: Option<Diagnostic>,
    /// It has been told.
    pub(super) tells_range: bool,
    /// Something has been expanded.
    pub(crate) has_expanded: bool,
}

impl<'a> TextProgram<'a> {
    pub(crate) fn new(whole: &str, texts: &'a Texts, files: FileReader) -> Self {
        Self {
            texts,
            files,
            included: HashMap::new(),
            particles: HashMap::new(),
            open: Vec::new(),
            definitions: HashMap::new(),
            styles: HashMap::new(),
            remembered: HashMap::new(),
            values: HashMap::new(),
            locals: Vec::new(),
            visible: 0,
            calls: None,
            depth: 0,
            ends: HashMap::new(),
            left: MAX_SCENE_BYTES.saturating_sub(whole.len()),
            out_of_range: None,
            tells_range: false,
            has_expanded: false,
        }
    }

    /// What a name stands for, if it is an argument, a variable, or a value with a name.
    pub(crate) fn value(&self, name: &str) -> Option<&Value> {
        let locals = self.locals[self.visible..].iter().rev();
        locals.into_iter().find(|(local, _)| *local == name).map(|(_, value)| value).or_else(|| {
            // Most texts have none.
            if self.values.is_empty() { None } else { self.values.get(name) }
        })
    }

    /// The names of values that can be seen.
    pub(crate) fn value_names(&self) -> impl Iterator<Item = &str> {
        self.locals[self.visible..].iter().map(|(name, _)| *name).chain(self.values.keys().copied())
    }

    /// Gives a value a name everywhere below. Whether it had one already.
    pub(crate) fn define(&mut self, name: &'a str, value: Value) -> bool {
        self.values.insert(name, value).is_some()
    }

    pub(super) fn bind(&mut self, name: &'a str, value: Value) {
        self.locals.push((name, value));
    }

    /// The names of definitions.
    pub(crate) fn definition_names(&self) -> impl Iterator<Item = &str> {
        self.definitions.keys().copied()
    }

    pub(crate) fn defines(&self, name: &str) -> bool {
        !self.definitions.is_empty() && self.definitions.contains_key(name)
    }
}

/// A definition: what a call of it is expanded to.
pub(crate) struct ProgramDefinition<'a> {
    pub(super) name: &'a str,
    /// Where that stands.
    pub(super) span: Span,
    /// Its number, from 0.
    pub(super) number: usize,
    /// Their names, and what they are if they are not given.
    pub(super) arguments: Vec<(&'a str, Option<Value>)>,
    /// Behind its `{`.
    pub(super) body: TextPlace<'a>,
    /// The place of the `{`.
    pub(super) open: u32,
    /// The bytes of its body.
    pub(super) length: usize,
    /// There are errors in its body, which are told once.
    pub(super) is_wrong: Cell<bool>,
}

/// A style: what a use of it is expanded to.
pub(crate) struct TextStyle {
    pub(super) name: Arc<str>,
    /// Its attributes and constants with their places, the outermost first.
    pub(super) values: Vec<(Written, Span)>,
    /// The bytes of its braces.
    pub(super) length: usize,
}

/// A file that has been read.
pub(super) struct Included {
    /// Its node, if it has one.
    pub(super) root: Option<Tree>,
}

/// What an expansion is known by: the number of the definition, and its arguments as words.
pub(super) type CallKey = (usize, Vec<u64>);

/// The nodes of an expansion.
pub(super) struct Remembered(pub(super) Arc<[Tree]>);

/// What a body is of.
pub(crate) enum BodyKind<'a> {
    /// A definition that is called; where to go on behind it, and what it is known by.
    Call {
        definition: Rc<ProgramDefinition<'a>>,
        back: TextPlace<'a>,
        key: Option<CallKey>,
    },
    BodyLoop(Box<BodyLoop<'a>>),
    /// The block of a condition that holds.
    Branch,
}

/// A body that is being read.
pub(crate) struct BodyFrame<'a> {
    pub(super) kind: BodyKind<'a>,
    /// Its first node on the stack of finished subtrees.
    pub(crate) first: usize,
    /// The place of its `{`.
    pub(crate) open: u32,
    /// How many arguments and variables there were before it, and which could be seen.
    pub(super) locals: usize,
    pub(super) visible: usize,
    /// The calls and loops around it.
    pub(super) around: Option<Arc<LabelCall>>,
    /// How many errors there were before it.
    pub(super) errors: usize,
}

/// A name that waits for its node.
pub(crate) struct LocalFrame<'a> {
    pub(super) name: &'a str,
    pub(super) span: Span,
    /// Its first node on the stack of finished subtrees.
    pub(crate) first: usize,
    /// Whether the node stays where it is, with its name; else the name stands for it.
    pub(super) stays: bool,
    /// Whether the node has a name in front of it, which is the one that it keeps.
    pub(super) is_named: bool,
}

/// A call whose arguments are being read.
pub(crate) struct CallFrame<'a> {
    pub(super) definition: Rc<ProgramDefinition<'a>>,
    pub(super) given: Vec<Option<Value>>,
    /// The argument that comes next.
    pub(super) slot: usize,
    /// Some argument has been given.
    pub(super) begun: bool,
    /// Some argument has been given by its name.
    pub(super) named: bool,
    pub(super) span: Span,
    /// The first node of the present argument on the stack of finished subtrees.
    pub(crate) first: usize,
}

impl CallFrame<'_> {
    /// The value of the present argument.
    pub(super) fn give(&mut self, value: Value) {
        self.given[self.slot] = Some(value);
        self.slot += 1;
    }
}

/// The values of a loop's variable.
pub(crate) enum Turns {
    /// So many numbers: any whole one that is not negative, also infinity.
    Numbers { first: f64, step: f64, count: f64 },
    /// The elements of a list.
    Elements(Vec<Value>),
}

impl Turns {
    pub(super) fn count(&self) -> f64 {
        match self {
            Self::Numbers { count, .. } => *count,
            Self::Elements(elements) => elements.len() as f64,
        }
    }
}

/// A loop.
pub(crate) struct BodyLoop<'a> {
    pub(super) variable: &'a str,
    pub(super) turns: Turns,
    /// How many have begun.
    pub(super) begun: usize,
    pub(super) body: TextPlace<'a>,
    /// Its words before the block.
    pub(super) span: Span,
}
