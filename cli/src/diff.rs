//! `jbt diff`: what two scenes differ in, item by item, and where their fields do.

use std::fmt::Write as _;

use jbt::diagnostic::escape;
use jbt::differing::{DifferingError, DifferingPlace, differing_places};
use jbt::text::{ModelDifference, ModelHash, compare, hash};
use jbt::{Box3, CheckedTree, Compiler};
use serde_json::{Value, json};

use crate::arguments::{DiffArguments, SceneArguments};
use crate::failure::Failure;
use crate::output::{plural, print};
use crate::scene::LoadedScene;

/// Differences that are printed; `--json` has all.
const SHOWN: usize = 50;

/// Places of fields that are printed.
const SHOWN_PLACES: usize = 12;

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
    let same = hashes[0] == hashes[1];
    let found = SceneDifferences {
        hashes,
        items: if same { Vec::new() } else { compare(&first.model, &second.model) },
        places: if same { None } else { differing(&second, &trees, arguments.region)? },
    };
    match (arguments.json, quiet) {
        (true, _) => print(&found.json().to_string()),
        (false, true) => Ok(()),
        (false, false) => print(&found.text([first.name(), second.name()])),
    }
}

/// Where fields differ; nothing if they may do so arbitrarily far away.
fn differing(
    scene: &LoadedScene,
    [first, second]: &[CheckedTree; 2],
    region: Option<Box3<f64>>,
) -> Result<Option<Vec<DifferingPlace>>, Failure> {
    match differing_places(&Compiler::new(), [first, second], region) {
        Ok(places) => Ok(Some(places)),
        Err(DifferingError::Unbounded) => Ok(None),
        Err(error) => Err(scene.failure(&error)),
    }
}

struct SceneDifferences {
    hashes: [ModelHash; 2],
    items: Vec<ModelDifference>,
    /// Nothing if the models are the same, or if their fields reach to infinity.
    places: Option<Vec<DifferingPlace>>,
}

impl SceneDifferences {
    fn is_same(&self) -> bool {
        self.hashes[0] == self.hashes[1]
    }

    fn text(&self, names: [&str; 2]) -> String {
        let [a, b] = names.map(escape);
        if self.is_same() {
            return format!("{a} and {b} are the same model, {}", self.hashes[0]);
        }
        let mut out =
            format!("{a} and {b}: {}", plural(self.items.len() as u64, "difference", "differences"));
        for ModelDifference { path, first, second, moved } in self.items.iter().take(SHOWN) {
            if !path.is_empty() {
                let _ = write!(out, "\n  at {}", escape(path));
            }
            if let (Some([from, to]), Some(words)) = (moved, second) {
                let _ = write!(out, "\n  ~ in another order, place {from} is {to}: {}", shortened(words));
                continue;
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
        out + &self.fields()
    }

    /// Where fields differ, a line for each place.
    fn fields(&self) -> String {
        let Some(places) = &self.places else {
            return "\n  fields reach to infinity: --region says where to compare them".to_owned();
        };
        if places.is_empty() {
            return "\n  fields are equal, but for rounding".to_owned();
        }
        let mut out = String::new();
        for DifferingPlace { bounds, at, most, .. } in places.iter().take(SHOWN_PLACES) {
            let [low, high, at] =
                [bounds.low, bounds.high, *at].map(|point| format!("({})", point.map(digits).join(" ")));
            let _ = if *most > 0.0 {
                write!(out, "\n  fields differ from {low} to {high}, most near {at}: by {most}")
            } else {
                write!(out, "\n  fields may differ from {low} to {high}; no point was found at which they do")
            };
        }
        if places.len() > SHOWN_PLACES {
            let _ = write!(out, "\n  and in {} more places", places.len() - SHOWN_PLACES);
        }
        out
    }

    fn json(&self) -> Value {
        let item = |ModelDifference { path, first, second, moved }: &ModelDifference| json!({ "path": path, "first": first, "second": second, "moved": moved });
        let place = |DifferingPlace { bounds, at, most, .. }: &DifferingPlace| {
            let corners = [bounds.low, bounds.high].concat();
            json!({ "box": corners, "at": at, "most": most })
        };
        let places = self.places.as_ref().map(|places| places.iter().map(place).collect::<Vec<_>>());
        let hashes = self.hashes.map(|hash| hash.to_string());
        json!({
            "same": self.is_same(),
            "hashes": hashes,
            "differences": self.items.iter().map(item).collect::<Vec<_>>(),
            "field": places,
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
