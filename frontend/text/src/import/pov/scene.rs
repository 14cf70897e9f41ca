//! From the blobs of a scene to a model.

use glam::DAffine3;
use jbt_model::combine::{Combinator, Sum};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::falloff::Falloff;
use jbt_model::kind::Primitive;
use jbt_model::model::Model;
use jbt_model::orientation::Orientation;
use jbt_model::report::{clip, nearest};
use jbt_model::tree::Tree;

use super::script::{PovValue, Script};
use super::shape::{Color, Component, PlacedBlob, PovBlob};

/// Words that begin the text of a scene, as a rule.
const BEGINNINGS: [&str; 8] =
    ["blob", "camera", "global_settings", "light_source", "background", "object", "union", "sky_sphere"];

/// Directives that scenes begin with.
const DIRECTIVES: [&str; 7] = ["version", "include", "declare", "local", "default", "macro", "ifndef"];

/// Whether a text is a scene by its first word behind comments.
pub(super) fn is_scene(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 14)]);
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let comment = if rest.starts_with("//") {
            rest.find('\n')
        } else if rest.starts_with("/*") {
            rest.find("*/").map(|end| end + 1)
        } else {
            break;
        };
        let Some(end) = comment else { return false };
        rest = rest[end + 1..].trim_start();
    }
    let word = |rest: &str| {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        (rest[..end].to_owned(), rest[end..].trim_start().starts_with('{'))
    };
    match rest.strip_prefix('#') {
        Some(rest) => DIRECTIVES.contains(&word(rest).0.as_str()),
        None => {
            let (word, opens) = word(rest);
            opens && BEGINNINGS.contains(&word.as_str())
        }
    }
}

/// The model of what the scene places, or of a declared object.
pub(super) fn model(script: &mut Script<'_>, object: Option<&str>) -> Result<Model, Diagnostic> {
    let blobs = match object {
        None => placed(script)?,
        Some(name) => chosen(script, name)?,
    };
    let thresholds: Vec<f64> = blobs.iter().map(|placed| placed.blob.threshold).collect();
    let first = thresholds.first().copied().unwrap_or(1.0);
    let same = thresholds.iter().all(|threshold| *threshold == first);
    let mut trees: Vec<Tree> =
        blobs.iter().map(|placed| tree(placed, if same { 1.0 } else { placed.blob.threshold })).collect();
    let root = if trees.len() == 1 { trees.remove(0) } else { Tree::union(trees) };
    let iso = if same { first } else { 1.0 };
    Ok(Model { iso: iso.into(), orientation: Orientation::Y_LEFT, ..Model::new(root) })
}

/// The blobs that the scene places.
fn placed(script: &Script<'_>) -> Result<Vec<PlacedBlob>, Diagnostic> {
    let blobs = &script.scene.blobs;
    let names = || {
        let names = holders(script);
        if names.is_empty() { None } else { Some(format!("--object reads one alone: {}", names.join(", "))) }
    };
    let with_names = |error: Diagnostic| match names() {
        Some(help) => error.expected(help),
        None => error,
    };
    if let Some((placed, fault)) = blobs.iter().find_map(|placed| Some((placed, placed.fault.as_ref()?))) {
        return Err(with_names(Diagnostic::error(Some(placed.blob.span), fault.to_string())));
    }
    if blobs.is_empty() {
        let end = script.scanner.place();
        return Err(with_names(Diagnostic::error(Some(Span::new(end, end)), "the scene places no blob")));
    }
    Ok(blobs.clone())
}

/// The declared names that hold blobs.
fn holders(script: &Script<'_>) -> Vec<String> {
    let holds = |name: &&String| matches!(script.value(name), Some(PovValue::Shapes(shapes)) if !shapes.blobs.is_empty());
    script.declared.iter().filter(holds).map(|name| clip(name)).take(20).collect()
}

/// The blobs of a declared name, or the one of this number, from 1, among those that the scene places. Blobs
/// in set operations are read alone, as they are in their own space.
fn chosen(script: &mut Script<'_>, name: &str) -> Result<Vec<PlacedBlob>, Diagnostic> {
    let number = name.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let mut blobs = match (script.value(name), number) {
        (Some(PovValue::Shapes(shapes)), _) => shapes.blobs.clone(),
        (_, Some(number)) => script.scene.blobs.get(number).cloned().into_iter().collect(),
        _ => Vec::new(),
    };
    if blobs.is_empty() {
        let error = Diagnostic::error(None, format!("no object with blobs is called {}", clip(name)));
        let names = holders(script);
        return Err(match nearest(name, names.iter().map(String::as_str)) {
            Some(near) => error.expected(format!("perhaps {near}")),
            None if names.is_empty() => error.expected("the scene declares none"),
            None => error.expected(format!("there are {}", names.join(", "))),
        });
    }
    for placed in &mut blobs {
        if let Some(fault) = placed.fault.take() {
            script.left_out.note(placed.blob.span, &format!("{fault}: it is read alone, in its own space"));
            placed.map = DAffine3::IDENTITY;
        }
    }
    Ok(blobs)
}

/// The tree of a blob whose strengths are divided by a number.
fn tree(placed: &PlacedBlob, divisor: f64) -> Tree {
    let PovBlob { components, map, color, span, .. } = &*placed.blob;
    let mut leaves: Vec<Tree> = components.iter().map(|component| leaf(component, divisor)).collect();
    let sum =
        if leaves.len() == 1 { leaves.remove(0) } else { Tree::at(*span, Combinator::from(Sum {}), leaves) };
    mapped(&(placed.map * *map), colored(sum, color.or(placed.color))).located(*span)
}

fn leaf(component: &Component, divisor: f64) -> Tree {
    let Component { skeleton, radius, strength, map, color, span } = component;
    let strength = strength / divisor;
    let leaf = Primitive { skeleton: skeleton.clone(), falloff: Falloff::Quartic, radius: *radius, strength };
    colored(mapped(map, Tree::at(*span, leaf, Vec::new())), *color).located(*span)
}

fn mapped(map: &DAffine3, tree: Tree) -> Tree {
    if *map == DAffine3::IDENTITY { tree } else { Tree::new(*map, vec![tree]) }
}

fn colored(tree: Tree, color: Option<Color>) -> Tree {
    color.map_or_else(|| tree.clone(), |color| tree.color(color))
}
