//! Items of a printed model, one by one: its statements, and its nodes without their blocks.

use super::part::PART;
use super::print::head::head;
use super::print::{print, print_parameter};
use super::words::EMPTY;
use jbt_model::model::{Comments, Model};
use jbt_model::tree::Tree;
use jbt_model::written::Written;

/// The statements in front of the root, each as it is printed: those that say what the tree means, without
/// comments.
pub(super) fn statements(model: &Model) -> Vec<String> {
    let plain = Model { comments: Comments::new(), root: Tree::empty(), ..model.clone() };
    let mut parameters: Vec<String> = Vec::new();
    for parameter in model.all_parameters() {
        let mut line = String::new();
        print_parameter(&mut line, &parameter);
        parameters.push(line.trim_end().to_owned());
    }
    let rest = print(&plain);
    let rest =
        rest.lines().skip(1).filter(|line| !line.is_empty() && !line.starts_with("param ") && *line != EMPTY);
    parameters.into_iter().chain(rest.map(str::to_owned)).collect()
}

/// The words and numbers of a node, without its block.
pub(super) fn node_words(tree: &Tree) -> String {
    match tree.node().written() {
        Written::Expression(formula) if formula.is_zero() => EMPTY.to_owned(),
        written => {
            let mut out = String::new();
            head(&mut out, written, "t");
            out
        }
    }
}

/// Where a node stands in its model: the same tree is a part below the root of parts, and a union elsewhere.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum ItemPlace {
    /// It is the root.
    Root,
    /// It is a part.
    Part,
    /// It is below a root that has no parts, or below a part.
    Below,
}

/// A node of a model, as the text has it.
#[derive(Clone, Copy)]
pub(super) struct NodeItem<'a> {
    /// The node.
    pub tree: &'a Tree,
    /// Where it stands.
    pub place: ItemPlace,
}

impl<'a> NodeItem<'a> {
    /// The root of a model.
    pub(super) fn root(tree: &'a Tree) -> Self {
        Self { tree, place: ItemPlace::Root }
    }

    /// A node that is neither root nor part.
    pub(super) fn below(tree: &'a Tree) -> Self {
        Self { tree, place: ItemPlace::Below }
    }

    /// The items in its block.
    pub(super) fn children(self) -> impl Iterator<Item = Self> {
        let has_parts = self.place == ItemPlace::Root && !self.tree.parts().is_empty();
        let place = if has_parts { ItemPlace::Part } else { ItemPlace::Below };
        self.tree.node().children().iter().map(move |tree| Self { tree, place })
    }

    /// Its words and numbers, without its block.
    pub(super) fn words(self) -> String {
        match self.place {
            ItemPlace::Part => format!("{PART} \"{}\"", self.tree.node().name().unwrap_or_default()),
            ItemPlace::Root | ItemPlace::Below => node_words(self.tree),
        }
    }

    /// The word for its kind.
    pub(super) fn kind(self) -> String {
        match (self.place, self.tree.node().written()) {
            (ItemPlace::Part, _) => PART.to_owned(),
            (_, Written::Attribute { name, .. }) => name.to_string(),
            _ => node_words(self.tree).split([' ', '{', '(']).next().unwrap_or_default().to_owned(),
        }
    }

    /// Its name, or the word for its kind.
    pub(super) fn name(self) -> String {
        self.tree.node().name().map_or_else(|| self.kind(), str::to_owned)
    }
}
