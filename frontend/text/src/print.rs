//! The printer: a model as text that reads back as the same model.
//!
//! Subtrees with several parents are printed once, as `let`, children first: a text is as long as its graph,
//! however many paths the graph has. Maps and attributes stand on one line with their child; operators open a
//! line for each child, down to a depth where the indentation would outweigh the text.

use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

use super::comment::{END, HEAD, ROOT};
use super::part::PART;
use super::words::{EMPTY, WEIGHTED};
use jbt_model::attribute::{AttributeGroup, DIRECTION};
use jbt_model::combine::CombinatorKind;
use jbt_model::model::Model;
use jbt_model::number::Number;
use jbt_model::orientation::Orientation;
use jbt_model::parameter::{Parameter, ParameterRange};
use jbt_model::tree::Tree;
use jbt_model::word::{STYLE, is_identifier, is_statement};
use jbt_model::written::Written;

mod attribute;
mod comment;
mod formula;
pub(super) mod head;
mod list;
mod numbers;
mod style;

use attribute::before;
use comment::comment;
use formula::expression;
use head::head;
use numbers::{group_values, vector};
use style::Styles;

/// Operators below this depth are printed on one line.
const DEEPEST: usize = 12;

/// The model as text. See [`parse`](super::parse) for the promise.
#[must_use]
pub fn print(model: &Model) -> String {
    let mut out = String::new();
    comment(&mut out, model, "jbt");
    out.push_str("jbt 1\n");
    comment(&mut out, model, HEAD);
    for parameter in model.all_parameters() {
        comment(&mut out, model, &format!("param {}", parameter.name()));
        print_parameter(&mut out, &parameter);
    }
    comment(&mut out, model, "iso");
    let _ = writeln!(out, "iso {}", model.iso);
    if let Some(point) = model.origin {
        comment(&mut out, model, "origin");
        let _ = writeln!(out, "origin {}", vector(point));
    }
    if model.orientation != Orientation::default() {
        comment(&mut out, model, "orientation");
        let Orientation { up, handed } = model.orientation;
        let _ = writeln!(out, "orientation up {} handed {}", up.name(), handed.name());
    }
    for group in &model.attributes {
        if *group != AttributeGroup::color() {
            comment(&mut out, model, &format!("attribute {}", group.name));
            declaration(&mut out, group);
        }
    }
    out.push('\n');
    let definitions = free_prefix(model);
    let styles = Styles::of(model);
    styles.print(&mut out, model, &definitions);
    let (order, names) = shared(model, &styles);
    let printer = Printer { names, definitions, styles };
    for tree in order {
        let name = &printer.names[&tree.identity()];
        comment(&mut out, model, &format!("let {name}"));
        let _ = write!(out, "let {name} = ");
        printer.tree(&mut out, tree, Some(name));
        out.push_str("\n\n");
    }
    let parts = model.root.parts();
    for (place, part) in parts.iter().enumerate() {
        let name = part.node().name().unwrap_or_default();
        out.push_str(if place > 0 { "\n" } else { "" });
        comment(&mut out, model, &format!("{PART} {name}"));
        let _ = write!(out, "{PART} \"{name}\"");
        printer.part(&mut out, part);
        out.push('\n');
    }
    if parts.is_empty() {
        comment(&mut out, model, ROOT);
        printer.tree(&mut out, &model.root, None);
        out.push('\n');
    }
    comment(&mut out, model, END);
    out
}

pub(super) fn print_parameter(out: &mut String, parameter: &Parameter) {
    let _ = write!(out, "param {} = {}", parameter.name(), parameter.source());
    if let Some(ParameterRange { low, high, step }) = parameter.range() {
        let _ = write!(out, " in {} .. {}", Number::from(low), Number::from(high));
        if let Some(step) = step {
            let _ = write!(out, " step {}", Number::from(step));
        }
    }
    if let Some(label) = parameter.label() {
        let _ = write!(out, " \"{label}\"");
    }
    out.push('\n');
}

fn declaration(out: &mut String, group: &AttributeGroup) {
    let width = if group.turns() { DIRECTION.to_owned() } else { group.width().to_string() };
    let (default, mixing) = (group_values(group.default.iter().copied()), group.mixing.name());
    let _ = writeln!(out, "attribute {} {width} default {default} {mixing}", group.name);
}

/// What names of definitions begin with, before a number, so that no parameter has such a name.
fn free_prefix(model: &Model) -> String {
    let parameters = model.all_parameters();
    let mut prefix = "t".to_owned();
    let is_taken = |prefix: &str| {
        let rests = parameters.iter().filter_map(|parameter| parameter.name().strip_prefix(prefix));
        rests.into_iter().any(|rest| rest.bytes().all(|byte| byte.is_ascii_digit()))
    };
    while is_taken(&prefix) {
        prefix.push('t');
    }
    prefix
}

/// The subtrees that stand by themselves, children before parents, and the name of each by its identity:
/// those that have more than one use, that stand in a formula, or that have a comment.
fn shared<'a>(model: &'a Model, styles: &Styles) -> (Vec<&'a Tree>, HashMap<usize, String>) {
    let mut uses: HashMap<usize, usize> = HashMap::new();
    let mut alone = HashSet::new();
    let mut finished = Vec::new();
    // A node is on the stack once before its children (false) and once after them (true).
    let mut stack = vec![(&model.root, false)];
    while let Some((tree, done)) = stack.pop() {
        if done {
            finished.push(tree);
            continue;
        }
        let count = uses.entry(tree.identity()).or_default();
        *count += 1;
        if *count == 1 {
            stack.push((tree, true));
            let node = tree.node();
            if matches!(node.written(), Written::Expression(_)) {
                alone.extend(node.children().iter().map(Tree::identity));
            }
            let is_said =
                |name: &str| is_statement(name) || model.comments.contains_key(&format!("let {name}"));
            if node.name().is_some_and(is_said) {
                alone.insert(tree.identity());
            }
            match styles.used(tree) {
                Some(style) => stack.push((style.below, false)),
                None => stack.extend(node.children().iter().rev().map(|child| (child, false))),
            }
        }
    }
    finished.retain(|tree| uses[&tree.identity()] > 1 || alone.contains(&tree.identity()));
    let mut taken: HashSet<String> = model.all_parameters().iter().map(|one| one.name().to_owned()).collect();
    let own: HashSet<&str> = finished.iter().filter_map(|tree| tree.node().name()).collect();
    let mut next = 0;
    let mut name = |tree: &Tree| match tree.node().name() {
        // The first one of a name has it; others are named where they stand.
        Some(name) if is_identifier(name) && taken.insert(name.to_owned()) => name.to_owned(),
        Some(_) | None => loop {
            next += 1;
            let name = format!("n{next}");
            if !own.contains(name.as_str()) && taken.insert(name.clone()) {
                break name;
            }
        },
    };
    let names = finished.iter().map(|tree| (tree.identity(), name(tree))).collect();
    (finished, names)
}

/// What is left to print.
enum Item<'a> {
    Tree(&'a Tree, usize),
    Text(&'static str),
    Line(usize),
}

struct Printer {
    names: HashMap<usize, String>,
    /// What names of definitions begin with.
    definitions: String,
    styles: Styles,
}

impl Printer {
    /// A subtree, also if it stands by itself. `said`: the name that stands in front of it already.
    fn tree(&self, out: &mut String, root: &Tree, said: Option<&str>) {
        let mut stack = Vec::new();
        if let Some(name) = root.node().name().filter(|name| said != Some(*name)) {
            let _ = write!(out, "{name}: ");
        }
        self.open(out, &mut stack, root, 0);
        self.rest(out, stack);
    }

    /// The block of a part.
    fn part(&self, out: &mut String, part: &Tree) {
        let mut stack = Vec::new();
        block(out, &mut stack, part.node().children(), 0);
        self.rest(out, stack);
    }

    /// What is left to print.
    fn rest<'a>(&self, out: &mut String, mut stack: Vec<Item<'a>>) {
        while let Some(item) = stack.pop() {
            match item {
                Item::Text(text) => out.push_str(text),
                Item::Line(depth) if depth <= DEEPEST => {
                    out.push('\n');
                    out.extend(std::iter::repeat_n("    ", depth));
                }
                Item::Line(_) => out.push(' '),
                Item::Tree(tree, depth) => match self.names.get(&tree.identity()) {
                    Some(name) => {
                        let _ = write!(out, "use {name}");
                    }
                    None => {
                        if let Some(name) = tree.node().name() {
                            let _ = write!(out, "{name}: ");
                        }
                        self.open(out, &mut stack, tree, depth);
                    }
                },
            }
        }
    }

    /// What a node uses that is there for its name alone, `left: use arm`: a union of one subtree that stands
    /// by itself and is called otherwise.
    fn named_use(&self, tree: &Tree) -> Option<&str> {
        let node = tree.node();
        // One that stands by itself is called like its `let` when it is read.
        let name = node.name().or_else(|| Some(self.names.get(&tree.identity())?.as_str()))?;
        let is_plain = matches!(node.written(), Written::Combine { combinator: CombinatorKind::Union, .. });
        let [child] = node.children() else { return None };
        let used = self.names.get(&child.identity())?;
        (is_plain && child.node().name() != Some(name)).then_some(used)
    }

    /// Prints a node's head and leaves the rest of it on the stack.
    fn open<'a>(&self, out: &mut String, stack: &mut Vec<Item<'a>>, tree: &'a Tree, depth: usize) {
        if let Some(name) = self.named_use(tree) {
            let _ = write!(out, "use {name}");
            return;
        }
        if let Some(style) = self.styles.used(tree) {
            before(out, style.precedence);
            let _ = write!(out, "{STYLE} {} {{ ", style.name);
            stack.extend([Item::Text(" }"), Item::Tree(style.below, depth)]);
            return;
        }
        let children = tree.node().children();
        let child = |place: usize| match children.get(place) {
            Some(child) => self.names[&child.identity()].clone(),
            None => format!("missing{place}"),
        };
        match tree.node().written() {
            Written::Expression(formula) if formula.is_zero() => out.push_str(EMPTY),
            Written::Expression(formula) => expression(out, formula, child, &self.definitions),
            written => head(out, written, &self.definitions),
        }
        match tree.node().written() {
            Written::Primitive { .. } | Written::Particles(_) | Written::Expression(_) => {}
            Written::Combine { .. } | Written::Select(_) => {
                block(out, stack, children, depth);
            }
            Written::Map { .. }
            | Written::Warp { .. }
            | Written::FormulaWarp(_)
            | Written::Attribute { .. }
            | Written::Constant { .. } => {
                let weighted = children.len() > 1;
                let _ = if weighted { write!(out, " {WEIGHTED} {{ ") } else { write!(out, " {{ ") };
                stack.push(Item::Text(" }"));
                for (place, child) in children.iter().enumerate().rev() {
                    stack.push(Item::Tree(child, depth));
                    if place > 0 {
                        stack.push(Item::Text(" "));
                    }
                }
            }
        }
    }
}

/// The block of an operator at a depth: a line for each child.
fn block<'a>(out: &mut String, stack: &mut Vec<Item<'a>>, children: &'a [Tree], depth: usize) {
    out.push_str(" {");
    stack.push(Item::Text("}"));
    stack.push(Item::Line(depth));
    for child in children.iter().rev() {
        stack.push(Item::Tree(child, depth + 1));
        stack.push(Item::Line(depth + 1));
    }
}
