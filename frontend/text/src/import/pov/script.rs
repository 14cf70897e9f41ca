//! The state of running a scene: names and their values, what has been spent, what is open.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use jbt_ir::limits::{MAX_BLOCK_DEPTH, MAX_SCRIPT_STEPS};
use jbt_model::diagnostic::{Diagnostic, Span};

use super::amount::{Amount, Streams, vector};
use super::open::{PovBlock, PovFrame};
use super::scan::PovScanner;
use super::shape::PovShapes;
use super::texts::{PovReturn, PovTexts};
use crate::import::tally::LeftOut;

/// What a name stands for.
#[derive(Clone)]
pub(super) enum PovValue {
    Amount(Amount),
    Shapes(Arc<PovShapes>),
    /// A pigment, a texture or a material: its colour, if it has one.
    Look(Option<[f64; 3]>),
    Transform(DAffine3),
    /// Something else.
    Other,
}

/// A scene that is being run.
pub(super) struct Script<'a> {
    pub(super) scanner: PovScanner<'a>,
    pub(super) texts: &'a PovTexts,
    /// Files that are being run.
    pub(super) returns: Vec<PovReturn>,
    names: HashMap<String, PovValue>,
    /// Declared shapes, in the order of their first declarations.
    pub(super) declared: Vec<String>,
    pub(super) streams: Streams,
    /// Steps that are left.
    left: usize,
    /// How often names and streams of numbers have been asked: a condition that asks none never changes.
    pub(super) asked: usize,
    pub(super) blocks: Vec<(PovBlock, Span)>,
    pub(super) frames: Vec<(PovFrame, Span)>,
    /// What the file places.
    pub(super) scene: PovShapes,
    pub(super) left_out: LeftOut,
    /// Files that were named and are not read.
    pub(super) missing: Vec<String>,
    /// What display values are raised to, to be linear.
    pub(super) gamma: f64,
    /// The colour of what has none.
    pub(super) default_color: Option<[f64; 3]>,
}

impl<'a> Script<'a> {
    pub(super) fn new(texts: &'a PovTexts) -> Self {
        Self {
            scanner: PovScanner::of(&texts.bytes, 0..texts.own()),
            texts,
            returns: Vec::new(),
            names: HashMap::new(),
            declared: Vec::new(),
            streams: Streams::default(),
            // What is written out pays for itself.
            left: MAX_SCRIPT_STEPS + texts.bytes.len() / 4,
            asked: 0,
            blocks: Vec::new(),
            frames: Vec::new(),
            scene: PovShapes::default(),
            left_out: LeftOut::default(),
            missing: Vec::new(),
            gamma: 1.0,
            default_color: None,
        }
    }

    /// What a name stands for.
    pub(super) fn value(&self, name: &str) -> Option<&PovValue> {
        self.names.get(name)
    }

    pub(super) fn declare(&mut self, name: &str, value: PovValue) {
        if matches!(value, PovValue::Shapes(_)) && !self.declared.iter().any(|known| known == name) {
            self.declared.push(name.to_owned());
        }
        match self.names.get_mut(name) {
            Some(known) => *known = value,
            None => {
                self.names.insert(name.to_owned(), value);
            }
        }
    }

    pub(super) fn forget(&mut self, name: &str) {
        self.names.remove(name);
    }

    /// Takes steps from what is left.
    pub(super) fn spend(&mut self, steps: usize, span: Span) -> Result<(), Diagnostic> {
        self.left = self.left.checked_sub(steps).ok_or_else(|| {
            let message = format!("the scene takes more than {MAX_SCRIPT_STEPS} steps");
            Diagnostic::limit(Some(span), message).expected("loops, calls and components count")
        })?;
        Ok(())
    }

    /// Opens something that ends with a brace.
    pub(super) fn open(&mut self, frame: PovFrame, span: Span) -> Result<(), Diagnostic> {
        if self.frames.len() == MAX_BLOCK_DEPTH {
            let message = format!("more than {MAX_BLOCK_DEPTH} blocks within each other");
            return Err(Diagnostic::limit(Some(span), message));
        }
        self.frames.push((frame, span));
        Ok(())
    }

    /// A finite number that is used at a place.
    pub(super) fn real(&self, amount: Amount, span: Span) -> Result<f64, Diagnostic> {
        match amount {
            Amount::Number(number) if number.is_finite() => Ok(number),
            Amount::Number(number) => {
                Err(Diagnostic::error(Some(span), format!("this number is {number}, which is not finite")))
            }
            Amount::Vector(..) => Err(Diagnostic::error(Some(span), "a vector stands where a number should")),
            Amount::Unknown(name) => Err(self.unknown(name)),
        }
    }

    /// Three finite numbers that are used at a place; one counts for all.
    pub(super) fn reals(&self, amount: Amount, span: Span) -> Result<DVec3, Diagnostic> {
        if let Amount::Unknown(name) = amount {
            return Err(self.unknown(name));
        }
        let found = vector(amount);
        if found.is_finite() {
            return Ok(found);
        }
        Err(Diagnostic::error(Some(span), "this vector has a number that is not finite"))
    }

    /// The error about a name without a number.
    pub(super) fn unknown(&self, span: Span) -> Diagnostic {
        let error = Diagnostic::error(Some(span), format!("`{}` has no number", self.scanner.shown(span)));
        match self.missing.last() {
            Some(file) => error.expected(format!("perhaps it is in {file}, which is not read")),
            None => error,
        }
    }
}
