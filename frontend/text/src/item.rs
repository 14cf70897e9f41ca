//! Items of a printed model, one by one: its statements, and its nodes without their blocks.

use super::print::head::head;
use super::print::{print, print_parameter};
use super::words::EMPTY;
use jbt_model::model::{Comments, Model};
use jbt_model::tree::Tree;

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
    let mut out = String::new();
    head(&mut out, tree.node().written(), "t");
    out
}
