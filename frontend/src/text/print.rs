//! The printer: a model as text that reads back as the same model.
//!
//! Subtrees with several parents are printed once, as `let`, children first: a text is as long as its graph, however many
//! paths the graph has.
//! Maps and attributes stand on one line with their child; operators open a line for each child, down to a depth where the
//! indentation would outweigh the text.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::DAffine3;

use super::{GROUP_NODE, field_word};
use crate::attribute::AttributeGroup;
use crate::combine::{Combinator, Family};
use crate::falloff::FalloffKind;
use crate::field::{Field, FieldKind, FieldValue};
use crate::model::Model;
use crate::number::{Number, plain};
use crate::recipe::{Angle, FalloffRecipe, FieldNumber, Map, Radius, Recipe};
use crate::tree::{NodeKind, Primitive, Tree};

/// Operators below this depth are printed on one line.
const DEEPEST: usize = 12;

/// The model as text. See [`parse`](super::parse) for the promise.
#[must_use]
pub fn print(model: &Model) -> String {
    let mut out = "jbt 1\n".to_owned();
    for parameter in model.all_parameters() {
        let _ = writeln!(out, "param {} = {}", parameter.name(), parameter.source());
    }
    let _ = writeln!(out, "iso {}", model.iso);
    for group in &model.attributes {
        if *group != AttributeGroup::color() {
            declaration(&mut out, group);
        }
    }
    out.push('\n');
    let (order, names) = shared(&model.root);
    let printer = Printer { names };
    for tree in order {
        let _ = write!(out, "let n{} = ", printer.names[&tree.identity()]);
        printer.tree(&mut out, tree);
        out.push_str("\n\n");
    }
    printer.tree(&mut out, &model.root);
    out.push('\n');
    out
}

fn vector(numbers: impl IntoIterator<Item = impl Into<Number>>) -> String {
    let numbers: Vec<String> = numbers.into_iter().map(|number| number.into().text()).collect();
    format!("({})", numbers.join(" "))
}

/// The values of an attribute: one number without parentheses.
fn group_values<T: Into<Number>>(values: impl IntoIterator<Item = T>) -> String {
    let values: Vec<Number> = values.into_iter().map(Into::into).collect();
    match &values[..] {
        [value] => value.text(),
        values => vector(values),
    }
}

fn declaration(out: &mut String, group: &AttributeGroup) {
    let (width, default, mixing) =
        (group.width(), group_values(group.default.iter().copied()), group.mixing.name());
    let _ = writeln!(out, "attribute {} {width} default {default} {mixing}", group.name);
}

/// The subtrees with more than one use, children before parents, and the number of each by its identity.
fn shared(root: &Tree) -> (Vec<&Tree>, HashMap<usize, usize>) {
    let mut uses: HashMap<usize, usize> = HashMap::new();
    let mut finished = Vec::new();
    // A node is on the stack once before its children (false) and once after them (true).
    let mut stack = vec![(root, false)];
    while let Some((tree, done)) = stack.pop() {
        if done {
            finished.push(tree);
            continue;
        }
        let count = uses.entry(tree.identity()).or_default();
        *count += 1;
        if *count == 1 {
            stack.push((tree, true));
            stack.extend(tree.node().children().iter().rev().map(|child| (child, false)));
        }
    }
    finished.retain(|tree| uses[&tree.identity()] > 1);
    let names = finished.iter().enumerate().map(|(i, tree)| (tree.identity(), i + 1)).collect();
    (finished, names)
}

/// What is left to print.
enum Item<'a> {
    Tree(&'a Tree, usize),
    Text(&'static str),
    Line(usize),
}

struct Printer {
    names: HashMap<usize, usize>,
}

impl Printer {
    /// A subtree, also if it has a name itself.
    fn tree(&self, out: &mut String, root: &Tree) {
        let mut stack = Vec::new();
        Self::open(out, &mut stack, root, 0);
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
                        let _ = write!(out, "use n{name}");
                    }
                    None => Self::open(out, &mut stack, tree, depth),
                },
            }
        }
    }

    /// Prints a node's head and leaves the rest of it on the stack.
    fn open<'a>(out: &mut String, stack: &mut Vec<Item<'a>>, tree: &'a Tree, depth: usize) {
        match tree.node().recipe() {
            Some(recipe) => head_of_recipe(out, recipe),
            None => head(out, tree.node().kind()),
        }
        let children = tree.node().children();
        match tree.node().kind() {
            NodeKind::Primitive(_) => {}
            NodeKind::Combine(_) | NodeKind::Select(_) => {
                out.push_str(" {");
                stack.push(Item::Text("}"));
                stack.push(Item::Line(depth));
                for child in children.iter().rev() {
                    stack.push(Item::Tree(child, depth + 1));
                    stack.push(Item::Line(depth + 1));
                }
            }
            NodeKind::Affine(_) | NodeKind::Warp(_) | NodeKind::Attribute { .. } => {
                out.push_str(" { ");
                stack.push(Item::Text(" }"));
                stack.extend(children.iter().rev().map(|child| Item::Tree(child, depth)));
            }
        }
    }
}

/// What stands before a node's block; of a primitive, all of it.
fn head(out: &mut String, kind: &NodeKind) {
    match kind {
        NodeKind::Primitive(leaf) => primitive(out, leaf),
        NodeKind::Combine(combinator) => {
            operator(out, *combinator, &combinator.numbers().into_iter().map(plain).collect::<Vec<_>>());
        }
        NodeKind::Select(which) => {
            let _ = write!(out, "select {}", plain(*which));
        }
        NodeKind::Affine(map) => affine(out, map),
        NodeKind::Warp(warp) => {
            out.push_str(warp.kind().name());
            for (described, value) in warp.kind().fields().iter().zip(warp.to_fields()) {
                field(out, described.name, described, &value.into());
            }
        }
        NodeKind::Attribute { name, values } => attribute(out, name, &group_values(values.iter().copied())),
    }
}

/// The head of an operator with these numbers.
fn operator(out: &mut String, combinator: Combinator, numbers: &[String]) {
    let _ = match (combinator, numbers) {
        (Combinator::Ricci(_), [exponent]) => write!(out, "blend ricci {exponent}"),
        (Combinator::Clamp { .. }, [low, high]) => write!(out, "clamp low {low} high {high}"),
        (Combinator::RFunction(set, Family::Order(order)), _) => {
            write!(out, "rfunction {} order {order}", set.name())
        }
        (Combinator::RFunction(set, family), [number]) => {
            write!(out, "rfunction {} {} {number}", set.name(), family.name())
        }
        (_, [number]) => write!(out, "{} {number}", combinator.name()),
        _ => write!(out, "{}", combinator.name()),
    };
}

/// The head of a node with numbers that follow parameters: as it was written.
fn head_of_recipe(out: &mut String, recipe: &Recipe) {
    match recipe {
        Recipe::Primitive { skeleton: kind, fields, falloff, radius, strength } => {
            let _ = write!(out, "{} {{", kind.name());
            for (described, value) in kind.fields().iter().zip(fields) {
                field(out, &field_word(*kind, described), described, value);
            }
            let _ = match radius {
                Radius::Support(radius) => write!(out, " radius {radius}"),
                Radius::Surface(radius) => write!(out, " surface_radius {radius}"),
            };
            rest_of_primitive(out, falloff, strength);
        }
        Recipe::Combine { combinator, numbers } => {
            operator(out, *combinator, &numbers.iter().map(Number::text).collect::<Vec<_>>());
        }
        Recipe::Select(which) => {
            let _ = write!(out, "select {which}");
        }
        Recipe::Map(map) => head_of_map(out, map),
        Recipe::Warp { warp, fields } => {
            out.push_str(warp.name());
            for (described, value) in warp.fields().iter().zip(fields) {
                field(out, described.name, described, value);
            }
        }
        Recipe::Attribute { name, values } => attribute(out, name, &group_values(values)),
    }
}

/// The head of a node with numbers that follow parameters, as text: equal for nodes that are equal for all their values.
pub(crate) fn print_head(recipe: &Recipe) -> String {
    let mut out = String::new();
    head_of_recipe(&mut out, recipe);
    out
}

fn head_of_map(out: &mut String, map: &Map) {
    let _ = match map {
        Map::Translate(by) => write!(out, "translate {}", vector(by)),
        Map::Rotate { axis, angle: Angle::Degrees(angle) } => {
            write!(out, "rotate axis {} degrees {angle}", vector(axis))
        }
        Map::Rotate { axis, angle: Angle::Radians(angle) } => {
            write!(out, "rotate axis {} radians {angle}", vector(axis))
        }
        Map::Scale(by) => write!(out, "scale {by}"),
        Map::ScaleAxes(by) => write!(out, "scale {}", vector(by)),
        Map::Reflect(axis) => write!(out, "reflect axis {}", vector(axis)),
        Map::Stretch { axis, by } => write!(out, "stretch axis {} by {by}", vector(axis)),
        Map::Shear { axis, by } => write!(out, "shear axis {} by {}", vector(axis), vector(by)),
        Map::Affine(rows) => write!(out, "affine {}", vector(&**rows)),
    };
}

fn attribute(out: &mut String, name: &str, values: &str) {
    if super::node::is_reserved(name) {
        let _ = write!(out, "{GROUP_NODE} ");
    }
    let _ = write!(out, "{name} {values}");
}

fn primitive(out: &mut String, leaf: &Primitive) {
    let kind = leaf.skeleton.kind();
    let _ = write!(out, "{} {{", kind.name());
    for (described, value) in kind.fields().iter().zip(leaf.skeleton.to_fields()) {
        field(out, &field_word(kind, described), described, &value.into());
    }
    let _ = write!(out, " radius {}", plain(leaf.radius));
    rest_of_primitive(out, &leaf.falloff.into(), &leaf.strength.into());
}

/// What follows a primitive's radius.
fn rest_of_primitive(out: &mut String, falloff: &FalloffRecipe, strength: &Number) {
    if falloff.kind() != FalloffKind::Soft {
        print_falloff(out, falloff);
    }
    if strength.follows() || strength.value().to_bits() != 1f64.to_bits() {
        let _ = write!(out, " strength {strength}");
    }
    out.push_str(" }");
}

/// A falloff, in braces its parameters that do not have their defaults.
fn print_falloff(out: &mut String, falloff: &FalloffRecipe) {
    let mut fields = String::new();
    for (described, value) in falloff.kind().fields().iter().zip(falloff.fields()) {
        field(&mut fields, described.name, described, value);
    }
    let name = falloff.kind().name();
    let _ = if fields.is_empty() {
        write!(out, " falloff {name}")
    } else {
        write!(out, " falloff {name} {{{fields} }}")
    };
}

/// A parameter, unless it has its default.
fn field(out: &mut String, word: &str, described: &Field, value: &FieldNumber) {
    let plain = !value.numbers().iter().any(Number::follows);
    if plain && described.default.is_some_and(|default| same_bits(default, value.value())) {
        return;
    }
    let _ = match (described.kind, value) {
        (FieldKind::Axis, FieldNumber::Vector(axis)) => {
            let index = axis.iter().position(|x| x.value() != 0.0).unwrap_or(2);
            write!(out, " {word} {}", ["x", "y", "z"][index])
        }
        (FieldKind::Choice(words), FieldNumber::Real(value)) => {
            write!(out, " {word} {}", words.get(value.value() as usize).unwrap_or(&words[0]))
        }
        (_, FieldNumber::Real(value)) => write!(out, " {word} {value}"),
        (_, FieldNumber::Vector(values)) => write!(out, " {word} {}", vector(values)),
    };
}

fn same_bits(a: FieldValue, b: FieldValue) -> bool {
    match (a, b) {
        (FieldValue::Real(a), FieldValue::Real(b)) => a.to_bits() == b.to_bits(),
        (FieldValue::Vector(a), FieldValue::Vector(b)) => a.map(f64::to_bits) == b.map(f64::to_bits),
        (FieldValue::Real(_), FieldValue::Vector(_)) | (FieldValue::Vector(_), FieldValue::Real(_)) => false,
    }
}

/// An affine map in its simplest form that gives the same bits.
fn affine(out: &mut String, map: &DAffine3) {
    let bits = |map: &DAffine3| map.to_cols_array().map(f64::to_bits);
    let diagonal = glam::DVec3::new(map.matrix3.x_axis.x, map.matrix3.y_axis.y, map.matrix3.z_axis.z);
    let _ = if bits(map) == bits(&DAffine3::from_translation(map.translation)) {
        write!(out, "translate {}", vector(map.translation.to_array()))
    } else if bits(map) != bits(&DAffine3::from_scale(diagonal)) {
        let [xx, yx, zx, xy, yy, zy, xz, yz, zz, x, y, z] = map.to_cols_array();
        write!(out, "affine {}", vector([xx, xy, xz, x, yx, yy, yz, y, zx, zy, zz, z]))
    } else if diagonal.x.to_bits() == diagonal.y.to_bits() && diagonal.x.to_bits() == diagonal.z.to_bits() {
        write!(out, "scale {}", plain(diagonal.x))
    } else {
        write!(out, "scale {}", vector(diagonal.to_array()))
    };
}
