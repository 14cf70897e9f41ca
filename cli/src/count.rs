//! `jbt count`: how many distances to skeletons a point takes, for every query and from every leaf.
//!
//! ```text
//! query       walks  separate     fused   ratio
//! field           1        95        95    1.00
//! all             6       570        95    6.00
//!
//! line      leaf      uses     field       all
//!    4:12   segment      2         2         2
//! ```
//!
//! *Fused* counts the instructions of the program that runs. *Separate* is what an evaluator does that walks the tree once for the
//! field, four times for a normal by differences (the point and a step along each axis), and once for the attributes.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use jbt::{Engine, Query};
use jbt_frontend::check::CheckedTree;
use jbt_frontend::tree::NodeKind;
use serde_json::json;

use crate::arguments::CountArguments;
use crate::failure::Failure;
use crate::output::{grouped, plural, print};
use crate::scene::Scene;

/// How the walks of separate evaluations add up.
const FORMULA: &str = "separate = walks x evaluations of the field; walks = 1 (field) + 4 (gradient, by differences) + 1 (attributes)";

/// Runs the command.
pub fn run(arguments: &CountArguments, quiet: bool) -> Result<(), Failure> {
    let scene = Scene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    let queries = match arguments.query {
        Some(name) => vec![name.query()],
        None => Query::EVERY.to_vec(),
    };
    let field = fused(&scene, &tree, Query::FIELD)?;
    let counts = queries
        .into_iter()
        .map(|query| {
            let fused = if query == Query::FIELD { field.clone() } else { fused(&scene, &tree, query)? };
            let walks = walks(query);
            Ok(Count { query, walks, separate: walks.saturating_mul(field.total), fused })
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    let leaves = leaves(&scene, &tree);
    if arguments.json {
        print(&format!("{}", json_report(&counts, &leaves, field.total)))
    } else {
        print(&table(&counts, &leaves, field.total))
    }
}

/// The evaluations of a program.
#[derive(Clone)]
struct Fused {
    total: u64,
    by_node: BTreeMap<u32, u64>,
}

/// The evaluations for one query.
struct Count {
    query: Query,
    walks: u64,
    separate: u64,
    fused: Fused,
}

/// A leaf of the tree.
struct Leaf {
    node: u32,
    kind: &'static str,
    place: Option<(usize, usize)>,
    /// How often it stands in the tree once every shared subtree is unfolded.
    uses: u64,
}

fn fused(scene: &Scene, tree: &CheckedTree, query: Query) -> Result<Fused, Failure> {
    // All engines run the same program; this one needs no compilation.
    let evaluations = scene.evaluator(tree, query, Some(Engine::Scalar))?.evaluations_by_node();
    Ok(Fused { total: evaluations.total, by_node: evaluations.per_node })
}

fn walks(query: Query) -> u64 {
    1 + if query.gradient { 4 } else { 0 } + u64::from(query.attributes)
}

fn leaves(scene: &Scene, tree: &CheckedTree) -> Vec<Leaf> {
    let uses = uses(tree);
    let lines = Lines::new(scene.source().text);
    let leaf = |(index, node): (usize, &jbt_frontend::check::CheckedNode)| match &node.kind {
        NodeKind::Primitive(primitive) => Some(Leaf {
            node: index as u32,
            kind: primitive.skeleton.kind().name(),
            place: node.span.map(|span| lines.position(span.start as usize)),
            uses: uses[index],
        }),
        NodeKind::Combine(_) | NodeKind::Affine(_) | NodeKind::Warp(_) | NodeKind::Attribute { .. } => None,
    };
    let mut leaves: Vec<Leaf> = tree.nodes().iter().enumerate().filter_map(leaf).collect();
    leaves.sort_by_key(|leaf| (leaf.place, leaf.node));
    leaves
}

/// How often each node is met from the root. Children come before their parents in the arena.
fn uses(tree: &CheckedTree) -> Vec<u64> {
    let mut uses = vec![0_u64; tree.nodes().len()];
    if let Some(root) = uses.last_mut() {
        *root = 1;
    }
    for (index, node) in tree.nodes().iter().enumerate().rev() {
        for child in &node.children {
            let child = child.0 as usize;
            uses[child] = uses[child].saturating_add(uses[index]);
        }
    }
    uses
}

/// Line starts of a text: places of many nodes without reading the text again for each.
struct Lines<'a> {
    text: &'a [u8],
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a [u8]) -> Self {
        let ends = text.iter().enumerate().filter(|&(_, &byte)| byte == b'\n').map(|(at, _)| at + 1);
        Self { text, starts: std::iter::once(0).chain(ends).collect() }
    }

    /// Line and column, counted from 1; the column counts characters.
    fn position(&self, byte: usize) -> (usize, usize) {
        let byte = byte.min(self.text.len());
        let line = self.starts.partition_point(|&start| start <= byte);
        let before = &self.text[self.starts[line - 1]..byte];
        (line, String::from_utf8_lossy(before).chars().count() + 1)
    }
}

/// For people.
fn table(counts: &[Count], leaves: &[Leaf], occurrences: u64) -> String {
    let mut out = format!(
        "{} in the tree, {} evaluated for a point\n\n",
        plural(leaves.len() as u64, "leaf", "leaves"),
        plural(occurrences, "occurrence", "occurrences")
    );
    let _ = writeln!(out, "{:<12}{:>6}{:>16}{:>16}{:>8}", "query", "walks", "separate", "fused", "ratio");
    for Count { query, walks, separate, fused } in counts {
        let ratio = *separate as f64 / fused.total.max(1) as f64;
        let (separate, fused) = (grouped(*separate), grouped(fused.total));
        let _ = writeln!(out, "{:<12}{walks:>6}{separate:>16}{fused:>16}{ratio:>8.2}", query.name());
    }
    let _ = writeln!(out, "{FORMULA}\n");
    let _ = write!(out, "{:<14}{:<12}{:>12}", "line", "leaf", "uses");
    for count in counts {
        let _ = write!(out, "{:>12}", count.query.name());
    }
    for leaf in leaves {
        let place = leaf
            .place
            .map_or_else(|| format!("node {}", leaf.node), |(line, column)| format!("{line}:{column}"));
        let _ = write!(out, "\n{place:<14}{:<12}{:>12}", leaf.kind, grouped(leaf.uses));
        for count in counts {
            let evaluations = count.fused.by_node.get(&leaf.node).copied().unwrap_or(0);
            let _ = write!(out, "{:>12}", grouped(evaluations));
        }
    }
    out
}

/// For machines.
fn json_report(counts: &[Count], leaves: &[Leaf], occurrences: u64) -> serde_json::Value {
    let queries: Vec<_> = counts
        .iter()
        .map(|Count { query, walks, separate, fused }| {
            json!({ "query": query.name(), "walks": walks, "separate": separate, "fused": fused.total })
        })
        .collect();
    let leaves: Vec<_> = leaves
        .iter()
        .map(|leaf| {
            let evaluations: serde_json::Map<_, _> = counts
                .iter()
                .map(|count| {
                    let evaluations = count.fused.by_node.get(&leaf.node).copied().unwrap_or(0);
                    (count.query.name().to_owned(), evaluations.into())
                })
                .collect();
            json!({
                "node": leaf.node,
                "kind": leaf.kind,
                "line": leaf.place.map(|(line, _)| line),
                "column": leaf.place.map(|(_, column)| column),
                "uses": leaf.uses,
                "evaluations": evaluations,
            })
        })
        .collect();
    json!({ "formula": FORMULA, "occurrences": occurrences, "queries": queries, "leaves": leaves })
}
