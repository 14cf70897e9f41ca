//! Parts of a scene, in words and for machines: their volumes, and which of them overlap.

use std::fmt::Write as _;

use jbt::solid::{PartError, PartPair, PartSolids, Relation, Volume};
use jbt::{Box3, CheckedTree, Compiler, Fineness};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::scene::LoadedScene;

/// Cells along the longest side of a part, for its volume.
const CELLS: usize = 64;

/// Parts of the longest side of a scene that points may be apart and touch.
const TOLERANCES: f64 = 1024.0;

/// What was found out about the parts of a scene.
pub struct PartFindings {
    names: Vec<String>,
    volumes: Vec<Volume>,
    pairs: Vec<PartPair>,
}

impl PartFindings {
    /// Compares all parts. `tolerance`: how near points touch, by default as near as can be told in the time;
    /// `region`: where.
    pub fn new(
        scene: &LoadedScene,
        tree: &CheckedTree,
        tolerance: Option<f64>,
        region: Option<Box3<f64>>,
    ) -> Result<Self, Failure> {
        let failed = |error: &PartError| scene.failure(error);
        let mut parts = PartSolids::new(&Compiler::new(), tree).map_err(|error| failed(&error.into()))?;
        let mut side = tree.support().longest_side();
        if let Some(region @ Box3 { low, high }) = region {
            parts = parts.within(region);
            side = (0..3).fold(0.0, |side: f64, axis| side.max(high[axis] - low[axis])).min(side);
        }
        let usual = if side.is_finite() && side > 0.0 { side / TOLERANCES } else { 1.0 / TOLERANCES };
        let mut pairs = parts.relations(tolerance.unwrap_or(usual)).map_err(|error| failed(&error))?;
        if tolerance.is_none() {
            for pair in &mut pairs {
                coarser(&parts, pair).map_err(|error| failed(&error))?;
            }
        }
        let volume = |part: usize| Ok(parts.measure(part, Fineness::Resolution(CELLS))?.volume);
        let volumes: Result<Vec<Volume>, PartError> = (0..parts.len()).map(volume).collect();
        let volumes = volumes.map_err(|error| failed(&error))?;
        let names = (0..parts.len()).map(|part| parts.name(part).to_owned()).collect();
        Ok(Self { names, volumes, pairs })
    }

    /// For people: a line for each part, and one for each pair that is not apart.
    pub fn text(&self) -> String {
        let mut out = String::new();
        for (name, Volume { low, high, .. }) in self.names.iter().zip(&self.volumes) {
            let _ = write!(out, "\n  part         {name}: volume {} to {}", digits(*low), digits(*high));
        }
        if self.names.is_empty() {
            out.push_str("\n  parts        none: the scene is one solid");
        }
        let mut apart = 0;
        for PartPair { parts, relation } in &self.pairs {
            let [a, b] = parts.map(|part| self.names[part].as_str());
            let _ = match relation {
                Relation::Overlapping { at, volume } => write!(
                    out,
                    "\n  overlap      {a} and {b} near {}: volume {} to {}",
                    place(at),
                    digits(volume.low),
                    digits(volume.high)
                ),
                Relation::Touching { within, at } => {
                    write!(out, "\n  touch        {a} and {b} near {}, within {}", place(at), digits(*within))
                }
                Relation::Undecided { thinner_than, at } => write!(
                    out,
                    "\n  undecided    {a} and {b} near {}: what both have is thinner than {}, or nothing",
                    place(at),
                    digits(*thinner_than)
                ),
                _ => {
                    apart += 1;
                    Ok(())
                }
            };
        }
        if apart > 0 {
            let _ = write!(out, "\n  apart        {apart} of {} pairs", self.pairs.len());
        }
        out
    }

    /// For machines.
    pub fn json(&self) -> Value {
        let part = |(name, volume): (&String, &Volume)| json!({ "name": name, "volume": { "low": volume.low, "high": volume.high, "estimate": volume.estimate } });
        let pair = |PartPair { parts, relation }: &PartPair| {
            let names = parts.map(|part| &self.names[part]);
            match relation {
                Relation::Overlapping { at, volume } => json!({
                    "parts": names, "relation": "overlapping", "at": at,
                    "volume": { "low": volume.low, "high": volume.high, "estimate": volume.estimate },
                }),
                Relation::Touching { within, at } => {
                    json!({ "parts": names, "relation": "touching", "at": at, "within": within })
                }
                Relation::Undecided { thinner_than, at } => {
                    json!({ "parts": names, "relation": "undecided", "at": at, "thinner_than": thinner_than })
                }
                Relation::Apart { more_than } => {
                    json!({ "parts": names, "relation": "apart", "more_than": more_than })
                }
                _ => Value::Null,
            }
        };
        json!({
            "parts": self.names.iter().zip(&self.volumes).map(part).collect::<Vec<_>>(),
            "pairs": self.pairs.iter().map(pair).collect::<Vec<_>>(),
        })
    }
}

/// Asks again for what could not be told of a pair, with the tolerance that was reached.
fn coarser(parts: &PartSolids, pair: &mut PartPair) -> Result<(), PartError> {
    /// Each doubles the tolerance.
    const TURNS: usize = 4;
    let [a, b] = pair.parts;
    for _ in 0..TURNS {
        let Relation::Undecided { thinner_than, .. } = pair.relation else { break };
        pair.relation = parts.relation(a, b, thinner_than)?;
    }
    Ok(())
}

fn place(at: &[f64; 3]) -> String {
    format!("({})", at.map(digits).join(" "))
}

/// A number in four digits.
fn digits(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    rounded.to_string()
}
