//! `jbt check`: everything that is wrong with scenes, or a few lines about each that nothing is wrong with.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use jbt::diagnostic::escape;
use jbt::export::constant_json;
use jbt::tree::Bounds;
use jbt::tree::{ConstantValues, LeafConstant, NodeKind};
use jbt::{
    AttributeGroup, CheckedTree, Classified as _, CompileError, Compiler, Engine, Fixture, Parameter, Query,
    Task,
};
use serde_json::{Map, Value, json};

use crate::arguments::{CheckArguments, SceneArguments};
use crate::failure::Failure;
use crate::lattice;
use crate::message::Message;
use crate::output::{grouped, print, report};
use crate::overlaps::PartFindings;
use crate::scene::LoadedScene;
use crate::standard::is_standard;

/// Runs the command.
pub fn run(arguments: &CheckArguments, quiet: bool) -> Result<(), Failure> {
    if arguments.scenes.iter().filter(|path| is_standard(path)).count() > 1 {
        return Err(Failure::Usage("the standard input can be read once".to_owned()));
    }
    let mut told = Findings::default();
    for path in &arguments.scenes {
        let scene = SceneArguments { path: path.clone(), options: arguments.options.clone() };
        let checked = check(&scene, arguments, quiet);
        if arguments.json {
            told.add(path, &checked);
        }
        match checked {
            Ok(checked) if !quiet && !arguments.json => print(&checked.text())?,
            Ok(_) => {}
            Err(failure) => {
                if !arguments.json {
                    report(&failure);
                }
                told.code = told.code.or(Some(failure.code()));
            }
        }
    }
    if arguments.json {
        print(&json!({ "files": told.files, "diagnostics": told.diagnostics }).to_string())?;
    }
    told.code.map_or(Ok(()), |code| Err(Failure::Told { code }))
}

/// A scene that nothing is wrong with.
struct Checked {
    scene: LoadedScene,
    tree: CheckedTree,
    instances: u64,
    /// What is known of its parts, if that was asked for.
    parts: Option<PartFindings>,
    /// The commands that its programs are too large for, and why.
    too_large: Vec<(&'static str, String)>,
}

/// What commands do with a scene.
const COMMANDS: [(&str, Task); 7] = [
    ("eval", Task::Points(Query::FIELD)),
    ("eval --query all", Task::Points(Query::ALL)),
    ("mesh", Task::Mesh),
    ("render", Task::Rays(Query::SURFACE)),
    ("contour", Task::Slices(Query::ATTRIBUTES)),
    ("sample", Task::Samples(Query::FIELD)),
    ("stats", Task::Solid),
];

fn check(path: &SceneArguments, arguments: &CheckArguments, quiet: bool) -> Result<Checked, Failure> {
    let scene = LoadedScene::load(path)?;
    scene.warn(quiet || arguments.json);
    let tree = scene.check()?;
    // Some numbers leave the range of f32, and some limits are reached, only in the program for all answers.
    let compiled = Compiler::for_engine(Engine::Scalar).compile(&tree);
    let refused = compiled.too_large_for(&COMMANDS.map(|(_, task)| task));
    let refused = refused.map_err(|error| scene.failure(&error))?;
    let why = |task: Task| refused.iter().find(|(refused, _)| *refused == task).map(|(_, why)| why);
    if let Some(why) = why(Task::Points(Query::FIELD)) {
        // Then there is nothing to do with it.
        return Err(scene.failure(why));
    }
    let query = if why(Task::Points(Query::ALL)).is_some() { Query::FIELD } else { Query::ALL };
    let instances = compiled.evaluations_per_point(query).map_err(|error| scene.failure(&error))?;
    let too_large = COMMANDS.into_iter();
    let too_large = too_large.filter_map(|(name, task)| Some((name, in_a_line(why(task)?)))).collect();
    let compare = || PartFindings::new(&scene, &tree, arguments.tolerance, arguments.region);
    let parts = arguments.overlaps.then(compare).transpose()?;
    Ok(Checked { scene, tree, instances, parts, too_large })
}

/// Why a command is refused, without the line of the scene, which the command shows.
fn in_a_line(why: &CompileError) -> String {
    match why.diagnostics().and_then(|told| told.iter().next()) {
        Some(first) => format!("limit: {}", first.message),
        None => why.to_string(),
    }
}

/// What has been found out about the files so far.
#[derive(Default)]
struct Findings {
    files: Vec<Value>,
    diagnostics: Vec<Value>,
    /// Of the first failure.
    code: Option<u8>,
}

impl Findings {
    fn add(&mut self, path: &Path, checked: &Result<Checked, Failure>) {
        let name = if is_standard(path) { "<stdin>".to_owned() } else { path.display().to_string() };
        match checked {
            Ok(checked) => self.diagnostics.extend(checked.scene.notices.iter().map(Message::json)),
            Err(Failure::Input { messages }) => self.diagnostics.extend(messages.iter().map(Message::json)),
            Err(failure) => self.diagnostics.push(failure.about_file(&name).json()),
        }
        let model = checked.as_ref().ok().map(Checked::json);
        self.files.push(json!({ "file": name, "ok": checked.is_ok(), "model": model }));
    }
}

impl Checked {
    fn leaves(&self) -> usize {
        let primitives = |kind: &NodeKind| match kind {
            NodeKind::Primitive(_) => 1,
            NodeKind::Particles(particles) => particles.len(),
            NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => 0,
        };
        self.tree.nodes().iter().map(|node| primitives(&node.kind)).sum()
    }

    /// For machines.
    fn json(&self) -> Value {
        let tree = &self.tree;
        let parameters = tree.parameters().iter().map(|p| (p.name().to_owned(), json!(p.value())));
        let support = tree.support();
        let bounds =
            (!support.is_empty() && support.is_finite()).then(|| [support.low(), support.high()].concat());
        let attribute = |group: &AttributeGroup| json!({ "name": &*group.name, "width": group.width(), "mixing": group.mixing.name(), "direction": group.turns() });
        let controls = tree.parameters().iter().map(|p| (p.name().to_owned(), control(p)));
        json!({
            "nodes": tree.nodes().len(),
            "leaves": self.leaves(),
            "instances": self.instances,
            "iso": tree.iso(),
            "parameters": parameters.collect::<Map<String, Value>>(),
            "names": names(tree),
            "controls": controls.collect::<Map<String, Value>>(),
            "bounds": bounds,
            "origin": tree.origin().point(),
            "attributes": tree.attributes().iter().map(attribute).collect::<Vec<Value>>(),
            "constants": constants(tree),
            "overlaps": self.parts.as_ref().map(PartFindings::json),
            "too_large_for": self.too_large.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
        })
    }

    /// For people.
    fn text(&self) -> String {
        let tree = &self.tree;
        let mut out = format!("{}: no errors\n", escape(self.scene.name()));
        let _ = writeln!(out, "  nodes        {}", grouped(tree.nodes().len() as u64));
        let _ = writeln!(out, "  leaves       {}", grouped(self.leaves() as u64));
        let _ = writeln!(out, "  instances  {}", grouped(self.instances));
        let _ = writeln!(out, "  iso          {}", tree.iso());
        if !tree.parameters().is_empty() {
            let _ = writeln!(out, "  parameters   {}", parameters(tree));
        }
        let _ =
            writeln!(out, "  bounds       {}{}", bounds(tree.support()), lattice::origin_line(tree.origin()));
        let names = names(tree);
        if !names.is_empty() {
            let _ = writeln!(out, "  names        {}", shortened(&names));
        }
        for constant in tree.constants() {
            let values: BTreeSet<String> = constant.values.iter().map(LeafConstant::to_string).collect();
            let values: BTreeSet<&str> = values.iter().map(String::as_str).collect();
            let _ = writeln!(out, "  constant     {}: {}", escape(&constant.name), shortened(&values));
        }
        let groups: Vec<String> = tree.attributes().iter().map(attribute).collect();
        let _ = write!(out, "  attributes   {}", groups.join(", "));
        out.push_str(&self.parts.as_ref().map_or_else(String::new, PartFindings::text));
        if let Some((_, why)) = self.too_large.first() {
            let names: Vec<&str> = self.too_large.iter().map(|(name, _)| *name).collect();
            let _ = write!(out, "\n  too large    for {}: {}", names.join(", "), escape(why));
        }
        out
    }
}

/// The values of the constants of leaves, by name.
fn constants(tree: &CheckedTree) -> Map<String, Value> {
    let entry = |one: ConstantValues| (one.name, one.values.iter().map(constant_json).collect());
    tree.constants().into_iter().map(entry).collect()
}

/// The names of the nodes, each once.
fn names(tree: &CheckedTree) -> BTreeSet<&str> {
    tree.names().collect()
}

/// The first of these names, and how many more there are.
fn shortened(names: &BTreeSet<&str>) -> String {
    const SHOWN: usize = 20;
    let mut shown: Vec<String> = names.iter().take(SHOWN).map(|name| escape(name)).collect();
    if names.len() > SHOWN {
        shown.push(format!("and {} more", names.len() - SHOWN));
    }
    shown.join(", ")
}

/// What an interface needs to know of a parameter besides its value: `fixed` ones take reading the scene
/// again.
fn control(parameter: &Parameter) -> Value {
    let range = parameter.range();
    json!({
        "default": parameter.default(),
        "low": range.map(|range| range.low),
        "high": range.map(|range| range.high),
        "step": range.and_then(|range| range.step),
        "label": parameter.label(),
        "fixed": parameter.fixture().is_some(),
    })
}

/// The range of a parameter, if it has one.
fn in_range(parameter: &Parameter) -> String {
    let step = |step: f64| format!(" step {step}");
    parameter.range().map_or_else(String::new, |range| {
        format!(" in {} .. {}{}", range.low, range.high, range.step.map_or_else(String::new, step))
    })
}

/// What a parameter decides that stays as it was read.
fn fixed(parameter: &Parameter) -> &'static str {
    match parameter.fixture() {
        None => "",
        Some(Fixture::Expansion) => " (decides which nodes there are)",
        Some(Fixture::Declaration) => " (a declaration depends on it)",
    }
}

/// The parameters, and of derived and set ones their present values.
fn parameters(tree: &CheckedTree) -> String {
    const SHOWN: usize = 20;
    let all = tree.parameters();
    let mut shown: Vec<String> = all
        .iter()
        .take(SHOWN)
        .map(|p| format!("{} = {}{}{}", escape(p.name()), p.value(), in_range(p), fixed(p)))
        .collect();
    if all.len() > SHOWN {
        shown.push(format!("and {} more", all.len() - SHOWN));
    }
    shown.join(", ")
}

fn bounds(support: Bounds) -> String {
    if support.is_empty() {
        return "empty: the field is zero everywhere".to_owned();
    }
    if !support.is_finite() {
        return "unbounded: a mesh needs a region".to_owned();
    }
    let corner = |[x, y, z]: [f64; 3]| format!("({x:.6} {y:.6} {z:.6})");
    format!("{} to {}", corner(support.low()), corner(support.high()))
}

fn attribute(group: &AttributeGroup) -> String {
    let what = if group.turns() { ", direction" } else { "" };
    format!("{} ({} x f32, {}{what})", escape(&group.name), group.width(), group.mixing.name())
}
