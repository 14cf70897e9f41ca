//! `jbt count`: how many distances to skeletons a point takes, for every query and from every leaf; how many
//! a lattice takes, and how many of these matter.
//!
//! ```text
//! query       walks  separate    cached     fused   ratio
//! field           1       127        95        95    1.34
//! all             6       762       380        95    8.02
//!
//! line      leaf      uses     field       all   in support
//!    4:12   segment      2         2         2       12,345
//! ```
//!
//! *Fused* counts the instructions of the program that runs. *Separate* is what an evaluator does that walks
//! the tree once for the field, four times for a normal by differences (the point and a step along each
//! axis), and once for the attributes; a walk meets a shared leaf again at each of its uses. *Cached* is such
//! an evaluator with a memory for each point. `jbt::statistics` counts.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use jbt::diagnostic::SourceText;
use jbt::mesh::Lattice;
use jbt::statistics::{PerPoint, Statistics, SupportCounts, walks};
use jbt::tree::NodeKind;
use jbt::{
    AnswerKind, Box3, CheckedTree, Compiled, Compiler, Engine, MeshCounters, ModelOrigin, Polygonize,
    PolygonizeError, Query,
};
use serde_json::{Value, json};

use crate::arguments::CountArguments;
use crate::failure::Failure;
use crate::lattice;
use crate::output::{grouped, plural, print, warn};
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;
use crate::stages;

/// How the evaluations of separate walks add up.
fn formula() -> String {
    let sum = |terms: [(u64, &str); AnswerKind::ALL.len()]| {
        let terms = terms.iter().filter(|(count, _)| *count > 0);
        terms.map(|(count, what)| format!("{count} ({what})")).collect::<Vec<_>>().join(" + ")
    };
    format!(
        "separate = walks x uses of leaves; walks = {}; cached = places x instances of leaves; places = {}",
        sum(AnswerKind::ALL.map(|answer| answer.row().walks)),
        sum(AnswerKind::ALL.map(|answer| answer.row().places))
    )
}

/// Runs the command.
pub fn run(arguments: &CountArguments, quiet: bool) -> Result<(), Failure> {
    let settings = lattice::settings(&arguments.lattice)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    let queries = match arguments.query {
        Some(query) => vec![query],
        None => Query::EVERY.to_vec(),
    };
    let statistics = Statistics::new(&tree);
    // All engines run the same programs; this one needs no code.
    let compiled = Compiler::for_engine(Engine::Scalar).compile(&tree);
    let field = QueryCount::new(&scene, &compiled, &statistics, Query::FIELD)?;
    let counts = queries
        .into_iter()
        .map(|query| QueryCount::new(&scene, &compiled, &statistics, query))
        .collect::<Result<_, _>>()?;
    let mut warnings = Vec::new();
    let lattice = match settings.lattice(&tree) {
        Ok(lattice) => Some(lattice),
        // Nobody asked for it: what a point takes can be told all the same.
        Err(error) if !arguments.lattice.given() => {
            warnings.push(without_lattice(&error));
            None
        }
        Err(error) => return Err(scene.failure(&error)),
    };
    let supports =
        lattice.as_ref().map(|lattice| supports(&scene, &statistics, lattice, quiet)).transpose()?;
    let mesh = lattice.as_ref().map(|_| mesh(&scene, &tree, &settings, quiet)).transpose()?;
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
    }
    warnings.splice(0..0, scene.warnings.iter().cloned());
    let report = CountReport {
        origin: tree.origin(),
        counts,
        leaves: leaves(&scene, &tree),
        uses: statistics.uses(),
        instances: statistics.instances(),
        evaluations: field.evaluations.fused,
        lattice: lattice.zip(supports),
        mesh,
        warnings,
    };
    if arguments.json { print(&report.json().to_string()) } else { print(&report.text()) }
}

/// Why nothing is counted on a lattice.
fn without_lattice(error: &PolygonizeError) -> String {
    format!("nothing is counted on a lattice: {error}; --region and --cell give one")
}

/// Counts what matters on a lattice.
fn supports(
    scene: &LoadedScene,
    statistics: &Statistics<'_>,
    lattice: &Lattice,
    quiet: bool,
) -> Result<SupportCounts, Failure> {
    let mut progress = ProgressLine::new("counting", quiet);
    let counted = progress.run(statistics.supports(&Compiler::new(), lattice));
    counted.map_err(|error| scene.failure(&error))
}

/// Makes the mesh, to count what that takes.
fn mesh(
    scene: &LoadedScene,
    tree: &CheckedTree,
    settings: &Polygonize,
    quiet: bool,
) -> Result<MeshCounters, Failure> {
    let mut progress = ProgressLine::new("meshing", quiet);
    let made = progress.run(settings.mesh(&Compiler::new(), tree));
    made.map(|made| made.counters).map_err(|error| scene.failure(&error))
}

/// The evaluations for one query.
struct QueryCount {
    query: Query,
    evaluations: PerPoint,
    by_node: BTreeMap<u32, u64>,
}

impl QueryCount {
    fn new(
        scene: &LoadedScene,
        compiled: &Compiled,
        statistics: &Statistics<'_>,
        query: Query,
    ) -> Result<Self, Failure> {
        let evaluator = scene.evaluator(compiled, query)?;
        let by_node = evaluator.evaluations_by_node().per_node;
        Ok(Self { query, evaluations: statistics.per_point(&evaluator), by_node })
    }

    fn of(&self, leaf: &CountedLeaf) -> u64 {
        self.by_node.get(&leaf.node).copied().unwrap_or(0)
    }
}

/// A leaf of the tree.
struct CountedLeaf {
    node: u32,
    kind: &'static str,
    place: Option<(usize, usize)>,
    /// How often it stands in the tree once every shared subtree is unfolded; of particles, all of them.
    uses: u64,
}

fn leaves(scene: &LoadedScene, tree: &CheckedTree) -> Vec<CountedLeaf> {
    let uses = tree.asked();
    let lines = Lines::new(scene.text());
    let leaf = |(index, node): (usize, &jbt::tree::CheckedNode)| match &node.kind {
        NodeKind::Primitive(primitive) => Some(CountedLeaf {
            node: index as u32,
            kind: primitive.skeleton.kind().name(),
            place: node.span.and_then(|span| lines.position(span.start as usize)),
            uses: uses[index],
        }),
        NodeKind::Particles(particles) => Some(CountedLeaf {
            node: index as u32,
            kind: "particles",
            place: node.span.and_then(|span| lines.position(span.start as usize)),
            uses: uses[index].saturating_mul(particles.len() as u64),
        }),
        NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. } => None,
    };
    let mut leaves: Vec<CountedLeaf> = tree.nodes().iter().enumerate().filter_map(leaf).collect();
    leaves.sort_by_key(|leaf| (leaf.place, leaf.node));
    leaves
}

/// Line starts of a scene's own text: places of many nodes without reading the text again for each.
struct Lines<'a> {
    text: &'a [u8],
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a SourceText) -> Self {
        Self { text: text.text(), starts: text.source().line_starts() }
    }

    /// Line and column, counted from 1; the column counts characters. Nothing in a file that is included.
    fn position(&self, byte: usize) -> Option<(usize, usize)> {
        let line = self.starts.partition_point(|&start| start <= byte);
        let before = self.text.get(self.starts[line - 1]..byte)?;
        Some((line, String::from_utf8_lossy(before).chars().count() + 1))
    }
}

/// What is told.
struct CountReport {
    /// That of the model.
    origin: ModelOrigin,
    counts: Vec<QueryCount>,
    leaves: Vec<CountedLeaf>,
    uses: u64,
    instances: u64,
    /// Evaluations that the field of one point takes.
    evaluations: u64,
    lattice: Option<(Lattice, SupportCounts)>,
    /// What a mesh over the lattice takes.
    mesh: Option<MeshCounters>,
    warnings: Vec<String>,
}

impl CountReport {
    /// Points of the lattice.
    fn points(&self) -> u64 {
        self.lattice.as_ref().map_or(0, |(_, supports)| supports.points)
    }

    /// Evaluations that the field of the whole lattice takes.
    fn field_of_lattice(&self) -> u64 {
        self.evaluations.saturating_mul(self.points())
    }

    /// Evaluations of primitives over boxes that a mesh takes.
    fn interval_evaluations(&self) -> u64 {
        self.mesh.map_or(0, |mesh| mesh.division.interval_evaluations)
    }

    fn waste(&self) -> Option<f64> {
        let (_, supports) = self.lattice.as_ref()?;
        supports.waste(self.field_of_lattice())
    }

    fn pairs_of(&self, leaf: &CountedLeaf) -> u64 {
        self.lattice.as_ref().and_then(|(_, supports)| supports.by_node.get(&leaf.node).copied()).unwrap_or(0)
    }

    /// For people.
    fn text(&self) -> String {
        let mut out = format!(
            "{} in the tree, {} of them along all paths, {} at different places\n\n",
            plural(self.leaves.len() as u64, "leaf", "leaves"),
            plural(self.uses, "use", "uses"),
            plural(self.instances, "instance", "instances")
        );
        self.write_queries(&mut out, 1);
        let _ = writeln!(out, "{}\n", formula().replace("; cached", "\ncached"));
        if let Some((lattice, supports)) = &self.lattice {
            let points = plural(supports.points, "point", "points");
            let _ = writeln!(out, "lattice: {points}, {}\n", lattice::describe(lattice, self.origin));
            self.write_queries(&mut out, supports.points);
            let waste =
                self.waste().map_or("no pair".to_owned(), |waste| format!("{waste:.2} for each pair"));
            let _ = writeln!(
                out,
                "{} of a point and a primitive whose support it is inside of\n\
                 {} of the field, if no point and no primitive is left out: {waste}\n",
                plural(supports.pairs, "pair", "pairs"),
                plural(self.field_of_lattice(), "evaluation", "evaluations"),
            );
        }
        if let Some(mesh) = &self.mesh {
            let _ = writeln!(out, "a mesh over the lattice takes\n{}\n", stages::text(mesh));
        }
        self.write_leaves(&mut out);
        out
    }

    /// The evaluations of all queries, for so many points.
    fn write_queries(&self, out: &mut String, points: u64) {
        let _ = writeln!(
            out,
            "{:<12}{:>6}{:>20}{:>20}{:>20}{:>8}",
            "query", "walks", "separate", "cached", "fused", "ratio"
        );
        for QueryCount { query, evaluations: PerPoint { separate, cached, fused }, .. } in &self.counts {
            let ratio = *separate as f64 / (*fused).max(1) as f64;
            let [separate, cached, fused] =
                [separate, cached, fused].map(|count| grouped(count.saturating_mul(points)));
            let (name, walks) = (query.name(), walks(*query));
            let _ = writeln!(out, "{name:<12}{walks:>6}{separate:>20}{cached:>20}{fused:>20}{ratio:>8.2}");
        }
    }

    fn write_leaves(&self, out: &mut String) {
        let _ = write!(out, "{:<14}{:<12}{:>12}", "line", "leaf", "uses");
        for count in &self.counts {
            let _ = write!(out, "{:>12}", count.query.name());
        }
        let _ = write!(out, "{:>16}", "in support");
        for leaf in &self.leaves {
            let place = leaf
                .place
                .map_or_else(|| format!("node {}", leaf.node), |(line, column)| format!("{line}:{column}"));
            let _ = write!(out, "\n{place:<14}{:<12}{:>12}", leaf.kind, grouped(leaf.uses));
            for count in &self.counts {
                let _ = write!(out, "{:>12}", grouped(count.of(leaf)));
            }
            let _ = write!(out, "{:>16}", grouped(self.pairs_of(leaf)));
        }
    }

    /// For machines.
    fn json(&self) -> Value {
        let lattice = self.lattice.as_ref().map(|(lattice, _)| {
            let Box3 { low, high } = lattice::bounds(lattice, self.origin);
            let region = [low, high].concat();
            json!({ "region": region, "cell": lattice.spacing(), "cells": lattice.cells() })
        });
        json!({
            "formula": formula(),
            "instances": self.instances,
            "uses": self.uses,
            "queries": self.counts.iter().map(|count| self.json_query(count)).collect::<Vec<_>>(),
            "leaves": self.leaves.iter().map(|leaf| self.json_leaf(leaf)).collect::<Vec<_>>(),
            "lattice": lattice,
            "origin": self.origin.point(),
            "points": self.points(),
            "evaluations": self.field_of_lattice(),
            "interval_evaluations": self.interval_evaluations(),
            "pairs_in_support": self.lattice.as_ref().map_or(0, |(_, supports)| supports.pairs),
            "waste": self.waste(),
            "mesh": self.mesh.as_ref().map(|mesh| json!({
                "stages": stages::json(mesh),
                "avoided_by_support": mesh.avoided_by_support,
                "avoided_by_interval": mesh.avoided_by_interval,
            })),
            "warnings": self.warnings,
        })
    }

    fn json_query(&self, count: &QueryCount) -> Value {
        let PerPoint { separate, cached, fused } = count.evaluations;
        let total = |evaluations: u64| evaluations.saturating_mul(self.points());
        json!({
            "query": count.query.name(),
            "walks": walks(count.query),
            "separate": separate,
            "cached": cached,
            "fused": fused,
            "total": { "separate": total(separate), "cached": total(cached), "fused": total(fused) },
        })
    }

    fn json_leaf(&self, leaf: &CountedLeaf) -> Value {
        let evaluations: serde_json::Map<_, _> = self
            .counts
            .iter()
            .map(|count| (count.query.name().into_owned(), count.of(leaf).into()))
            .collect();
        json!({
            "node": leaf.node,
            "kind": leaf.kind,
            "line": leaf.place.map(|(line, _)| line),
            "column": leaf.place.map(|(_, column)| column),
            "uses": leaf.uses,
            "evaluations": evaluations,
            "pairs_in_support": self.pairs_of(leaf),
        })
    }
}
