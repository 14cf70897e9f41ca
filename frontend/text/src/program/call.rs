//! Calls of definitions: `arm(2, hue = 0.1, tip = point { radius 1 })`.
//!
//! The same definition with the same arguments is expanded once: a definition that calls itself twice, forty
//! deep, is forty expansions.

use std::rc::Rc;
use std::sync::Arc;

use jbt_ir::limits::{CALL_BYTES, EXPANSION_BYTES};

use super::known::{BodyKind, CallFrame, CallKey, Remembered, Value};
use crate::block::Begun;
use crate::lex::{Token, TokenKind};
use crate::state::Parser;
use crate::words::NAMES_FIRST;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::label::LabelCall;
use jbt_model::number::{Number, Step};
use jbt_model::report::{clip, nearest};

/// What follows in a call.
pub(super) enum Next {
    /// A node that is an argument.
    Node,
    /// Nothing: all arguments have been read.
    Done,
    /// Nothing: there was an error.
    Broken,
}

impl<'a> Parser<'a> {
    /// A call whose name, `start`, has just been taken.
    pub(crate) fn call(&mut self, start: Token, word: &str) -> Begun<'a> {
        let Some(definition) = self.program.definitions.get(word).cloned() else { return Begun::Nothing };
        self.report_again();
        if self.accept(b'(').is_none() {
            let names: Vec<&str> = definition.arguments.iter().map(|(name, _)| *name).collect();
            let expected = format!("expected its arguments: {word}({})", names.join(", "));
            self.expected_at(self.peek(), &expected);
            return Begun::Leaf(self.broken.clone());
        }
        let given = vec![None; definition.arguments.len()];
        let span = start.span();
        let frame = CallFrame { definition, given, slot: 0, begun: false, named: false, span, first: 0 };
        Begun::Call(Box::new(frame))
    }

    /// Reads arguments up to one that is a node, or to the end.
    pub(super) fn arguments(&mut self, frame: &mut CallFrame<'a>) -> Next {
        loop {
            if self.accept(b')').is_some() {
                return Next::Done;
            }
            if frame.begun && self.accept(b',').is_none() {
                let expected = format!("expected `,` or `)` in the call of `{}`", frame.definition.name);
                return self.broken_call(&expected);
            }
            frame.begun = true;
            if !self.argument_slot(frame) {
                self.mute();
                return self.broken_call("");
            }
            if self.begins_plain() {
                match self.value() {
                    Some(value) => frame.give(value),
                    None => return self.broken_call(""),
                }
                continue;
            }
            let token = self.peek();
            let word = self.peek_word();
            match word {
                // The name of a node, by itself.
                Some(word)
                    if self.is_tree(word) && (!self.begins_node(word) || NAMES_FIRST.contains(&word)) =>
                {
                    frame.give(Value::Tree(self.use_node()));
                }
                Some(_) => return Next::Node,
                None => {
                    self.expected_at(token, "expected a number, a vector, a colour, a list or a node");
                    return self.broken_call("");
                }
            }
        }
    }

    /// Whether a word is the name of a node.
    fn is_tree(&self, word: &str) -> bool {
        matches!(self.program.value(word), Some(Value::Tree(_))) || self.lets.contains_key(word)
    }

    /// Finds the place of the argument that is next, behind its name if it has one.
    fn argument_slot(&mut self, frame: &mut CallFrame<'a>) -> bool {
        let token = self.peek();
        let arguments = &frame.definition.arguments;
        let is_named = token.kind == TokenKind::Word && self.peek_behind().is(b'=');
        if is_named {
            let name = self.text(token);
            let Some(slot) = arguments.iter().position(|(other, _)| *other == name) else {
                self.report(|| {
                    let names = || arguments.iter().map(|(name, _)| *name);
                    let message = format!("`{}` has no argument `{}`", frame.definition.name, clip(name));
                    let error = Diagnostic::error(Some(token.span()), message);
                    match (nearest(name, names()), arguments.len()) {
                        (Some(near), _) => error.expected(format!("perhaps `{near}`")),
                        (None, 0) => error.expected("it has none"),
                        (None, _) => {
                            error.expected(format!("it has {}", names().collect::<Vec<_>>().join(", ")))
                        }
                    }
                });
                return false;
            };
            self.next();
            self.next();
            frame.named = true;
            frame.slot = slot;
        } else if frame.named || frame.slot >= arguments.len() {
            let (name, count) = (frame.definition.name, arguments.len());
            let plural = if count == 1 { "" } else { "s" };
            self.report(|| {
                let error = |what: String| Diagnostic::error(Some(token.span()), what);
                if frame.named {
                    error("an argument without a name stands behind one with a name".to_owned())
                } else {
                    error(format!("`{name}` has {count} argument{plural}"))
                }
            });
            return false;
        }
        if frame.given[frame.slot].is_some() {
            let name = arguments[frame.slot].0;
            self.report(|| Diagnostic::error(Some(token.span()), format!("a second `{name}`")));
            return false;
        }
        true
    }

    /// Past the arguments of a call that has an error.
    fn broken_call(&mut self, expected: &str) -> Next {
        if !expected.is_empty() {
            self.expected_at(self.peek(), expected);
        }
        self.skip_to_close();
        Next::Broken
    }

    /// Goes to the body of a definition, or gives the nodes that it stands for with these arguments.
    pub(super) fn enter(&mut self, frame: CallFrame<'a>) -> Begun<'a> {
        let CallFrame { definition, given, span, .. } = frame;
        let mut values = Vec::new();
        let mut missing = Vec::new();
        for (value, (name, default)) in given.into_iter().zip(&definition.arguments) {
            match value.or_else(|| default.clone()) {
                Some(value) => values.push(value),
                None => missing.push(format!("`{name}`")),
            }
        }
        if !missing.is_empty() {
            let message = format!("`{}` needs {}", definition.name, missing.join(" and "));
            self.report(|| Diagnostic::error(Some(span), message));
        }
        if !missing.is_empty() || definition.is_wrong.get() {
            return Begun::Many([self.broken.clone()].into());
        }
        let key = key(definition.number, &values);
        if let Some(Remembered(nodes)) = key.as_ref().and_then(|key| self.program.remembered.get(key)) {
            let nodes = Arc::clone(nodes);
            let what = format!("these {} nodes of `{}`", nodes.len(), definition.name);
            return match self.charge(nodes.len() as f64, 0, span, &what) {
                true => Begun::Many(nodes),
                false => Begun::Nothing,
            };
        }
        let what = format!("this call of `{}`", definition.name);
        if !self.charge(1.0, definition.length + (CALL_BYTES - EXPANSION_BYTES), span, &what) {
            return Begun::Nothing;
        }
        let back = self.lexer.place();
        let around = self.program.calls.clone();
        let open = Token { kind: TokenKind::Mark(b'{'), start: definition.open as usize, end: 0 };
        let body = BodyKind::Call { definition: Rc::clone(&definition), back, key };
        let begun = self.open_body(open, span, body);
        if matches!(begun, Begun::Body(_)) {
            let call = LabelCall { name: definition.name.into(), turn: None, span, above: around };
            self.program.calls = Some(Arc::new(call));
            self.program.visible = self.program.locals.len();
            for ((name, _), value) in definition.arguments.iter().zip(values) {
                self.program.bind(name, value);
            }
            self.lexer.jump(definition.body);
        }
        begun
    }
}

/// What an expansion is known by; nothing if its arguments are long.
fn key(definition: usize, values: &[Value]) -> Option<CallKey> {
    const LONGEST: usize = 256;
    let mut words = Vec::new();
    let mut stack: Vec<&Value> = values.iter().rev().collect();
    while let Some(value) = stack.pop() {
        match value {
            Value::Number(number) => add_number(&mut words, number),
            Value::Numbers(numbers) if numbers.len() > LONGEST => return None,
            Value::Numbers(numbers) => {
                words.extend([1, numbers.len() as u64]);
                numbers.iter().for_each(|number| add_number(&mut words, number));
            }
            Value::List(list) if list.len() > LONGEST => return None,
            Value::List(list) => {
                words.extend([2, list.len() as u64]);
                stack.extend(list.iter().rev());
            }
            Value::Tree(tree) => words.extend([3, tree.identity() as u64]),
        }
        if words.len() > LONGEST {
            return None;
        }
    }
    Some((definition, words))
}

fn add_number(words: &mut Vec<u64>, number: &Number) {
    words.extend([0, number.value().to_bits()]);
    let steps = number.formula().map_or(&[][..], |formula| formula.steps());
    words.push(steps.len() as u64);
    for step in steps {
        match step {
            Step::Literal(value) => words.extend([0, value.to_bits()]),
            Step::Parameter { name, .. } => {
                words.extend([1, name.len() as u64]);
                words.extend(name.bytes().map(u64::from));
            }
            Step::Variable(_) => words.push(2),
            Step::Negate => words.push(3),
            Step::Binary(binary) => words.extend([4, *binary as u64]),
            Step::Call(function, count) => {
                words.extend([5, u64::from(*count)]);
                words.extend(function.name().bytes().map(u64::from));
                words.push(u64::MAX);
            }
        }
    }
}
