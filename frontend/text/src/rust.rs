//! A model as Rust: a function that builds the same model.
//!
//! ```text
//! union { body: point { radius 1 }                 pub fn model() -> jbt::Model {
//!     translate (2 0 0) { point { radius 1 } } }       let body = point([0.0, 0.0, 0.0], 1.0).named("body");
//!                                                      let root = Tree::union([
//!                                                          body.clone(),
//!                                                          point([0.0, 0.0, 0.0], 1.0).translate([2.0, 0.0, 0.0]),
//!                                                      ]);
//! ```
//!
//! Operators, nodes with names and shared subtrees are variables, children first. So the text is as long as
//! the graph, and no expression is deep.

mod names;
mod node;
mod number;

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fmt::Write as _;

use jbt_model::attribute::{AttributeGroup, GroupKind, Mixing};
use jbt_model::model::Model;
use jbt_model::number::Number;
use jbt_model::orientation::{Handed, ModelUp, Orientation};
use jbt_model::parameter::{Parameter, ParameterRange};
use jbt_model::traverse::Visit;
use jbt_model::tree::{StyleUse, Tree};
use jbt_model::written::Written;

use names::RustNames;
use node::{RustTree, is_operator, overriding};
use number::{RustBody, list, literal};

/// Chains of maps longer than this are broken by a variable.
const LONGEST_CHAIN: usize = 400;

/// The model as a function in Rust, `pub fn model() -> jbt::Model`, that builds a model of the same
/// [`hash`](crate::hash()) and with the same names. Calls and loops of the text that the model came from have
/// been expanded, and comments are left out. The model has passed its check: others may give what does not
/// compile.
///
/// ```
/// let ball = jbt_text::model("jbt 1 color (1 0 0) { point { radius 2 } }")?;
/// let rust = jbt_text::print_rust(&ball);
/// assert!(rust.contains("    let root = point([0.0, 0.0, 0.0], 2.0).color([1.0, 0.0, 0.0]);\n"), "{rust}");
/// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
/// ```
#[must_use]
pub fn print_rust(model: &Model) -> String {
    let parameters = model.all_parameters();
    let mut names = RustNames::new();
    let variables = parameters.iter().map(|one| (one.name().to_owned(), names.like(one.name()))).collect();
    let mut body =
        RustBody { names, parameters: variables, mentioned: BTreeSet::new(), statements: String::new() };
    let root = body.tree(&model.root);
    let fields = body.fields(model, &parameters);
    let mut out = String::from("/// Printed by `jbt show --stage rust`.\n");
    out.push_str("#[allow(non_snake_case, unused_imports)]\npub fn model() -> jbt::Model {\n");
    out.push_str("    use jbt::build::*;\n    use jbt::{\n");
    out.push_str(
        "        AttributeGroup, Falloff, Handed, Mixing, Model, ModelUp, Orientation, Parameter,\n",
    );
    out.push_str("        ParameterRange, SetOperation, Tree,\n    };\n\n");
    for parameter in parameters.iter().filter(|one| body.mentioned.contains(one.name())) {
        let (variable, value) = (&body.parameters[parameter.name()], literal(parameter.value()));
        let _ = writeln!(out, "    let {variable} = param({:?}, {value});", parameter.name());
    }
    out.push_str(&body.statements);
    let _ = writeln!(out, "    let root = {root};");
    match fields.is_empty() {
        true => out.push_str("    Model::new(root)\n}\n"),
        false => {
            let _ = write!(out, "    Model {{\n{fields}        ..Model::new(root)\n    }}\n}}\n");
        }
    }
    out
}

impl RustBody {
    /// A tree: statements for what stands by itself, and the rest as a value.
    fn tree(&mut self, root: &Tree) -> String {
        let (mut uses, mut asked): (HashMap<usize, usize>, HashSet<usize>) = Default::default();
        for tree in root.prefix(Visit::Nodes) {
            for child in tree.node().children() {
                *uses.entry(child.identity()).or_default() += 1;
                if matches!(tree.node().written(), Written::Expression(_)) {
                    asked.insert(child.identity());
                }
            }
        }
        let mut done: HashMap<usize, RustTree> = HashMap::new();
        for tree in root.postfix(Visit::Nodes) {
            let node = tree.node();
            let children: Vec<RustTree> = node
                .children()
                .iter()
                .map(|child| {
                    done.get(&child.identity()).cloned().expect("children come before their parents")
                })
                .collect();
            let mut text = self.node(node.written(), &children);
            if let Some(styled) = tree.style().and_then(|style| self.styled(&style, &text)) {
                text = styled;
            }
            for child in node.children() {
                // What stands in one place alone is there now.
                if uses[&child.identity()] == 1 && !done[&child.identity()].is_variable {
                    done.remove(&child.identity());
                }
            }
            if node.label().is_some_and(|label| label.part) {
                text = part(node.name().unwrap_or_default(), &children);
            } else if let Some(name) = node.name() {
                text = format!("{text}.named({name:?})");
            }
            let identity = tree.identity();
            let is_alone = uses.get(&identity).is_some_and(|&uses| uses > 1) || asked.contains(&identity);
            let stands = is_alone || is_operator(tree) || node.name().is_some() || text.len() > LONGEST_CHAIN;
            let is_variable = stands && identity != root.identity();
            if is_variable {
                let variable = match node.name() {
                    Some(name) => self.names.like(name),
                    None => self.names.numbered("n"),
                };
                let _ = writeln!(self.statements, "    let {variable} = {text};");
                text = variable;
            }
            done.insert(identity, RustTree { text, is_variable });
        }
        done.remove(&root.identity()).map_or_else(String::new, |root| root.text)
    }

    /// What a style gives to a tree, as one call; `text` has it as several. Nothing if these have been torn
    /// apart.
    fn styled(&mut self, style: &StyleUse<'_>, text: &str) -> Option<String> {
        let given: Vec<Written> = style.values.iter().map(|&value| value.clone()).collect();
        let below = text.strip_suffix(&self.calls(&given))?;
        let calls = self.calls(&style.definition());
        let end = overriding(style.precedence);
        Some(format!("{below}.styled({:?}, |tree| tree{calls}){end}", style.name))
    }

    /// Calls that put attributes and constants around what stands before them.
    fn calls(&mut self, values: &[Written]) -> String {
        let mut calls = RustTree { text: String::new(), is_variable: false };
        for value in values.iter().rev() {
            calls.text = self.node(value, &[calls.clone()]);
        }
        calls.text
    }

    /// The fields of a model that are not those of every model, a line for each.
    fn fields(&mut self, model: &Model, parameters: &[Parameter]) -> String {
        let mut out = String::new();
        if model.iso.depends_on_parameters() || model.iso.value() != Model::DEFAULT_ISO {
            let iso = self.number(&model.iso);
            let _ = writeln!(out, "        iso: Number::from({iso}),");
        }
        if model.attributes != [AttributeGroup::color()] {
            out.push_str("        attributes: vec![\n");
            model.attributes.iter().for_each(|group| out.push_str(&declaration(group)));
            out.push_str("        ],\n");
        }
        if !parameters.is_empty() {
            out.push_str("        parameters: vec![\n");
            for parameter in parameters {
                let line = self.parameter(parameter);
                let _ = writeln!(out, "            {line},");
            }
            out.push_str("        ],\n");
        }
        if let Some(point) = model.origin {
            let _ = writeln!(out, "        origin: Some({}),", list(point.map(literal)));
        }
        if model.orientation != Orientation::default() {
            let up = match model.orientation.up {
                ModelUp::Y => "Y",
                ModelUp::Z => "Z",
            };
            let handed = match model.orientation.handed {
                Handed::Right => "Right",
                Handed::Left => "Left",
            };
            let _ = writeln!(
                out,
                "        orientation: Orientation {{ up: ModelUp::{up}, handed: Handed::{handed} }},"
            );
        }
        out
    }

    /// A parameter with its default, its range and its label.
    fn parameter(&mut self, parameter: &Parameter) -> String {
        let default: Number = parameter.source();
        let mut text = format!("Parameter::new({:?}, {})", parameter.name(), self.number(&default));
        if let Some(ParameterRange { low, high, step }) = parameter.range() {
            let step = step.map_or_else(|| "None".to_owned(), |step| format!("Some({})", literal(step)));
            let (low, high) = (literal(low), literal(high));
            let _ = write!(text, ".within(ParameterRange {{ low: {low}, high: {high}, step: {step} }})");
        }
        if let Some(label) = parameter.label() {
            let _ = write!(text, ".labelled({label:?})");
        }
        text
    }
}

/// A part of a model.
fn part(name: &str, children: &[RustTree]) -> String {
    format!("Tree::part_of({name:?}, vec!{}, None)", list(children.iter().map(RustTree::owned)))
}

fn declaration(group: &AttributeGroup) -> String {
    let mixing = match group.mixing {
        Mixing::Blend => "Blend",
        Mixing::Dominant => "Dominant",
    };
    let default = list(group.default.iter().copied().map(literal));
    let name = &*group.name;
    match group.kind {
        GroupKind::Numbers => format!(
            "            AttributeGroup {{ name: {name:?}.into(), default: vec!{default}, mixing: Mixing::{mixing}, \
             ..AttributeGroup::color() }},\n"
        ),
        GroupKind::Direction => format!(
            "            AttributeGroup {{ mixing: Mixing::{mixing}, \
             ..AttributeGroup::direction({name:?}, {default}) }},\n"
        ),
    }
}
