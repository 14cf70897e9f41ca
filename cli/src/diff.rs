//! `jbt diff`: what two scenes differ in, item by item, and where their fields do.

use std::fmt::Write as _;

use jbt::diagnostic::escape;
use jbt::text::{ModelDifference, ModelHash, compare, hash};
use jbt::{CheckedTree, Compiler, Points, Query};
use serde_json::{Value, json};

use crate::arguments::{DiffArguments, SceneArguments};
use crate::failure::Failure;
use crate::output::{plural, print};
use crate::scene::LoadedScene;

/// Points along each axis at which fields are compared.
const SAMPLES: usize = 48;
/// Fields that are nearer to each other than this part of their size, plus it, are the same.
const TOLERANCE: f32 = 1e-6;
/// Differences that are printed; `--json` has all.
const SHOWN: usize = 50;

/// Runs the command.
pub fn run(arguments: &DiffArguments, quiet: bool) -> Result<(), Failure> {
    let load = |path: &std::path::PathBuf| {
        let scene = SceneArguments { path: path.clone(), options: arguments.options.clone() };
        LoadedScene::load(&scene)
    };
    let (first, second) = (load(&arguments.first)?, load(&arguments.second)?);
    first.warn(quiet || arguments.json);
    second.warn(quiet || arguments.json);
    let trees = [first.check()?, second.check()?];
    let hashes = [hash(&first.model), hash(&second.model)];
    let items = if hashes[0] == hashes[1] { Vec::new() } else { compare(&first.model, &second.model) };
    let place = if items.is_empty() { None } else { differing(&[&first, &second], &trees)? };
    let found = SceneDifferences { hashes, items, place };
    match (arguments.json, quiet) {
        (true, _) => print(&found.json().to_string()),
        (false, true) => Ok(()),
        (false, false) => print(&found.text([first.name(), second.name()])),
    }
}

/// Where fields differ, at the points that were asked.
struct DifferingPlace {
    /// The box around all such points, in the world.
    low: [f64; 3],
    high: [f64; 3],
    /// Where they differ most, and by how much.
    at: [f64; 3],
    most: f32,
}

struct SceneDifferences {
    hashes: [ModelHash; 2],
    items: Vec<ModelDifference>,
    place: Option<DifferingPlace>,
}

/// Compares both fields on a lattice over both supports; nothing if they agree or reach to infinity.
fn differing(
    scenes: &[&LoadedScene; 2],
    trees: &[CheckedTree; 2],
) -> Result<Option<DifferingPlace>, Failure> {
    let whole = trees[0].support().hull(trees[1].support());
    if whole.is_empty() || !whole.is_finite() {
        return Ok(None);
    }
    let (low, high) = (whole.low(), whole.high());
    let coordinate = |axis: usize, index: usize| {
        low[axis] + (high[axis] - low[axis]) * index as f64 / (SAMPLES - 1) as f64
    };
    let lattice = (0..SAMPLES * SAMPLES * SAMPLES).map(|index| {
        let place = [index % SAMPLES, index / SAMPLES % SAMPLES, index / (SAMPLES * SAMPLES)];
        [0, 1, 2].map(|axis| coordinate(axis, place[axis]))
    });
    let world: Vec<[f64; 3]> = lattice.collect();
    let field = |side: usize| -> Result<Vec<f32>, Failure> {
        let compiled = Compiler::new().compile(&trees[side]);
        let evaluator = scenes[side].evaluator(&compiled, Query::FIELD)?;
        let local: Vec<[f32; 3]> =
            world.iter().map(|&point| trees[side].origin().local(point).map(|x| x as f32)).collect();
        let mut points: Points = evaluator.points();
        points.extend(local);
        let mut samples = evaluator.samples();
        evaluator.par_eval(&points, &mut samples).map_err(|error| scenes[side].failure(&error))?;
        Ok(samples.field().to_vec())
    };
    let (a, b) = (field(0)?, field(1)?);
    let mut found: Option<DifferingPlace> = None;
    for ((&point, a), b) in world.iter().zip(a).zip(b) {
        let apart = (a - b).abs();
        if apart <= TOLERANCE * (1.0 + a.abs().max(b.abs())) {
            continue;
        }
        let place = found.get_or_insert(DifferingPlace { low: point, high: point, at: point, most: 0.0 });
        for (axis, x) in point.into_iter().enumerate() {
            place.low[axis] = place.low[axis].min(x);
            place.high[axis] = place.high[axis].max(x);
        }
        if apart > place.most {
            (place.at, place.most) = (point, apart);
        }
    }
    Ok(found)
}

impl SceneDifferences {
    fn text(&self, names: [&str; 2]) -> String {
        let [a, b] = names.map(escape);
        if self.items.is_empty() {
            return format!("{a} and {b} are the same model, {}", self.hashes[0]);
        }
        let mut out =
            format!("{a} and {b}: {}", plural(self.items.len() as u64, "difference", "differences"));
        for ModelDifference { path, first, second } in self.items.iter().take(SHOWN) {
            if !path.is_empty() {
                let _ = write!(out, "\n  at {}", escape(path));
            }
            for (mark, words) in [('-', first), ('+', second)] {
                if let Some(words) = words {
                    let _ = write!(out, "\n  {mark} {}", shortened(words));
                }
            }
        }
        if self.items.len() > SHOWN {
            let _ = write!(out, "\n  and {} more", self.items.len() - SHOWN);
        }
        if let Some(DifferingPlace { low, high, at, most }) = &self.place {
            let [low, high, at] = [low, high, at].map(|point| format!("({})", point.map(digits).join(" ")));
            let _ = write!(out, "\n  fields differ from {low} to {high}, most near {at}: by {most}");
        }
        out
    }

    fn json(&self) -> Value {
        let item = |ModelDifference { path, first, second }: &ModelDifference| json!({ "path": path, "first": first, "second": second });
        let place = self.place.as_ref().map(|place| {
            let corners = [place.low, place.high].concat();
            json!({ "box": corners, "at": place.at, "most": place.most })
        });
        let hashes = self.hashes.map(|hash| hash.to_string());
        json!({
            "same": self.items.is_empty(),
            "hashes": hashes,
            "differences": self.items.iter().map(item).collect::<Vec<_>>(),
            "field": place,
        })
    }
}

/// The beginning of the words of a node.
fn shortened(words: &str) -> String {
    const LONGEST: usize = 160;
    let mut shown: String = escape(words).chars().take(LONGEST).collect();
    if words.chars().count() > LONGEST {
        shown.push_str("..");
    }
    shown
}

/// A number in four digits.
fn digits(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    rounded.to_string()
}
