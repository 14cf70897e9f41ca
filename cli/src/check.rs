//! `jbt check`: everything that is wrong with a scene, or a line that says that nothing is.

use std::fmt::Write as _;

use jbt::{Engine, Query};
use jbt_frontend::attribute::AttributeGroup;
use jbt_frontend::bounds::Bounds;
use jbt_frontend::check::CheckedTree;
use jbt_frontend::diagnostic::escape;
use jbt_frontend::tree::NodeKind;

use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::output::{grouped, print};
use crate::scene::Scene;

/// Runs the command.
pub fn run(arguments: &CheckArguments, quiet: bool) -> Result<(), Failure> {
    let scene = Scene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    // Some numbers leave the range of f32, and some limits are reached, only in the program for all answers.
    let evaluator = scene.evaluator(&tree, Query::ALL, Some(Engine::Scalar))?;
    if quiet {
        return Ok(());
    }
    print(&summary(scene.name(), &tree, evaluator.evaluations_per_point()))
}

/// What the model is, in short.
fn summary(name: &str, tree: &CheckedTree, occurrences: u64) -> String {
    let primitive = |kind: &NodeKind| match kind {
        NodeKind::Primitive(_) => true,
        NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. } => false,
    };
    let leaves = tree.nodes().iter().filter(|node| primitive(&node.kind)).count();
    let mut out = format!("{}: no errors\n", escape(name));
    let _ = writeln!(out, "  nodes        {}", grouped(tree.nodes().len() as u64));
    let _ = writeln!(out, "  leaves       {}", grouped(leaves as u64));
    let _ = writeln!(out, "  occurrences  {}", grouped(occurrences));
    let _ = writeln!(out, "  iso          {}", tree.iso());
    if !tree.parameters().is_empty() {
        let _ = writeln!(out, "  parameters   {}", parameters(tree));
    }
    let _ = writeln!(out, "  bounds       {}", bounds(tree.support()));
    let groups: Vec<String> = tree.attributes().iter().map(attribute).collect();
    let _ = write!(out, "  attributes   {}", groups.join(", "));
    out
}

/// The parameters, and of derived and set ones their present values.
fn parameters(tree: &CheckedTree) -> String {
    const SHOWN: usize = 20;
    let all = tree.parameters();
    let mut shown: Vec<String> =
        all.iter().take(SHOWN).map(|p| format!("{} = {}", escape(p.name()), p.value())).collect();
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
    format!("{} ({} x f32, {})", escape(&group.name), group.width(), group.mixing.name())
}
