//! Where a node stands in a tree that came from no text: names, or kinds, on the way from the root.

use std::collections::HashSet;

use crate::diagnostic::Diagnostic;
use crate::path::path_of;
use crate::report::{Report, clip};
use crate::tree::order::PlainNodes;
use crate::tree::{Node, Tree};
use crate::word::is_identifier;

/// A name is letters, digits and underscores.
pub(super) fn check_name(report: &mut Report, node: &Node) {
    if let Some(name) = node.name().filter(|name| !is_identifier(name)) {
        report.add(|| {
            Diagnostic::error(node.span(), format!("a node is called `{}`", clip(name)))
                .expected("expected letters, digits and underscores, beginning with a letter")
        });
    }
}

/// The [path](crate::path) of the first place of a node, which leads to it alone.
pub(super) fn way_to(root: &Tree, node: &Tree) -> String {
    let mut seen = HashSet::new();
    let mut way: Vec<(&Tree, usize)> = vec![(root, 0)];
    while let Some((tree, next)) = way.last_mut() {
        if tree.identity() == node.identity() {
            break;
        }
        match tree.node().children().get(*next) {
            Some(child) if seen.insert(child.identity()) => way.push((child, 0)),
            Some(_) => *next += 1,
            None => {
                way.pop();
                if let Some((_, next)) = way.last_mut() {
                    *next += 1;
                }
            }
        }
    }
    let (last, above) = way.split_last().expect("the node is in its tree");
    path_of(PlainNodes::new(), root, above, last.0)
}
