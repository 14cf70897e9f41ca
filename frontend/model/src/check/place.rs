//! Where a node stands in a tree that came from no text: names, or kinds, on the way from the root.

use std::collections::HashSet;
use std::fmt::Write as _;

use crate::diagnostic::Diagnostic;
use crate::report::{Report, clip};
use crate::tree::{Node, Tree};
use crate::word::is_identifier;
use crate::written::Written;

/// A name is letters, digits and underscores.
pub(super) fn check_name(report: &mut Report, node: &Node) {
    if let Some(name) = node.name().filter(|name| !is_identifier(name)) {
        report.add(|| {
            Diagnostic::error(node.span(), format!("a node is called `{}`", clip(name)))
                .expected("expected letters, digits and underscores, beginning with a letter")
        });
    }
}

/// The way from the root to the first place of a node, as `union.1/arm.0/point`: of each node its name, or
/// the word of its kind, and the number of the child that leads on.
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
    let mut text = String::new();
    let (last, above) = way.split_last().expect("the node is in its tree");
    for (tree, child) in above {
        let _ = write!(text, "{}.{child}/", word(tree.node()));
    }
    text + word(last.0.node())
}

/// The name of a node, or the word of its kind.
fn word(node: &Node) -> &str {
    node.name().unwrap_or_else(|| match node.written() {
        Written::Primitive { skeleton, .. } => skeleton.name(),
        Written::Particles(_) => "particles",
        Written::Combine { combinator, .. } => combinator.name(),
        Written::Expression(_) => "expression",
        Written::Select(_) => "select",
        Written::Map { map, .. } => map.name(),
        Written::Warp { warp, .. } => warp.name(),
        Written::FormulaWarp(_) => "warp",
        Written::Attribute { name, .. } | Written::Constant { name, .. } => name,
    })
}
