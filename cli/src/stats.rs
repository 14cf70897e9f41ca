//! `jbt stats`: what the solid of a scene is like: bounds, volume, area, and the division of space that tells
//! them.
//!
//! ```text
//! depth        splits       solid         air     surface
//!     3           208         104         200           0
//!     4           592         568         504           0
//! ```

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use jbt::diagnostic::escape;
use jbt::solid::{Measure, MeasureLevel, Measures, Solid, TightBounds};
use jbt::tree::Bounds;
use jbt::{Box3, Compiler, Fineness, ModelOrigin, Polygonize};
use serde_json::{Value, json};

use crate::arguments::StatsArguments;
use crate::failure::Failure;
use crate::lattice;
use crate::output::{grouped, plural, print, warn};
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;

/// The tolerance of the bounds when nothing else is said, as a part of the region's longest side.
const TOLERANCE: f32 = 1.0 / 1024.0;

/// Runs the command. `start` is when the process began, for the total time.
pub fn run(arguments: &StatsArguments, quiet: bool, start: Instant) -> Result<(), Failure> {
    let asked = lattice::settings(&arguments.lattice)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    let settings = settings(arguments, &asked, tree.origin());
    let solid = Solid::new(&Compiler::new(), &tree).map_err(|error| scene.failure(&error))?;
    let mut progress = ProgressLine::new("measuring", quiet);
    let measured = progress.run(solid.measure(&settings));
    let measures = measured.map_err(|error| scene.failure(&error))?;
    drop(progress);
    let tolerance = arguments.tolerance.unwrap_or(TOLERANCE * measures.region.longest_side());
    let tight = solid.tight_bounds(settings.region, tolerance).map_err(|error| scene.failure(&error))?;
    let mut warnings = warnings(&tight, tolerance);
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
    }
    warnings.splice(0..0, scene.warnings.iter().cloned());
    let report = StatsReport {
        name: scene.name(),
        support: tree.support(),
        solid: &solid,
        measures,
        tight,
        tolerance,
        warnings,
        total: start.elapsed(),
    };
    if arguments.json { print(&report.json().to_string()) } else { print(&report.text()) }
}

/// What the options say.
fn settings(arguments: &StatsArguments, asked: &Polygonize, origin: ModelOrigin) -> Measure {
    let fineness = match arguments.depth {
        Some(depth) => Fineness::Resolution(1 << depth),
        None => asked.fineness,
    };
    Measure { region: asked.region.map(|region| lattice::local(region, origin)), fineness }
}

/// What may not be as people expect.
fn warnings(tight: &TightBounds, tolerance: f32) -> Vec<String> {
    let mut warnings = Vec::new();
    if tight.outer.is_none() {
        warnings.push("the solid is empty: no point of the region is inside".to_owned());
    } else if !tight.converged {
        warnings.push(format!("the bounds hold the solid, but may be wider than by {tolerance}"));
    }
    warnings
}

/// What is told.
struct StatsReport<'a> {
    name: &'a str,
    support: Bounds,
    solid: &'a Solid,
    measures: Measures,
    tight: TightBounds,
    tolerance: f32,
    warnings: Vec<String>,
    total: Duration,
}

impl StatsReport<'_> {
    fn origin(&self) -> ModelOrigin {
        self.solid.tree().origin()
    }

    /// Both corners of a box, in the world; in f32, as they are, where that is where they count from.
    fn six(&self, bounds: &Box3) -> Value {
        let corners = [bounds.low, bounds.high];
        if self.origin().is_world() {
            return json!(corners.concat());
        }
        json!(corners.map(|corner| self.origin().world(corner.map(f64::from))).concat())
    }

    /// Points, evaluations of primitives at them, boxes, evaluations of primitives over them.
    fn evaluations(&self) -> [u64; 4] {
        let [field, normals] = self.solid.counters();
        let ranges = self.solid.pruner().counters();
        [
            field.points + normals.points,
            field.primitive_evaluations + normals.primitive_evaluations,
            ranges.boxes,
            ranges.interval_evaluations,
        ]
    }

    /// The shares of solid, air and surface boxes in the region.
    fn shares(&self) -> [f64; 3] {
        let Measures { volume, air, surface, .. } = &self.measures;
        [volume.low, *air, *surface].map(|part| part / self.measures.total())
    }

    /// For people.
    fn text(&self) -> String {
        let Measures { region, cell, volume, area, center, contents, .. } = &self.measures;
        let boxes = self.measures.boxes();
        let mut out = format!("{}: volume {:.6}, area {area:.6}\n", escape(self.name), volume.estimate);
        let corners = |low: [f64; 3], high: [f64; 3]| format!("{} to {}", point(low), point(high));
        let support = if self.support.is_empty() {
            "empty".to_owned()
        } else if self.support.is_finite() {
            corners(self.support.low(), self.support.high())
        } else {
            "unbounded".to_owned()
        };
        let world = |corner: [f32; 3]| self.origin().world(corner.map(f64::from));
        let box3 = |bounds: &Box3| corners(world(bounds.low), world(bounds.high));
        let tight = self.tight.outer.as_ref().map_or("empty".to_owned(), box3);
        let _ = writeln!(out, "  support      {support}{}", lattice::origin_line(self.origin()));
        let _ = writeln!(out, "  tight        {tight}, tolerance {}", self.tolerance);
        let _ = writeln!(out, "  volume       at least {:.6}, at most {:.6}", volume.low, volume.high);
        let _ = writeln!(out, "  centre       {}", center.map_or("none".to_owned(), point));
        let _ = writeln!(out, "  region       {}, cells of {cell:.6}", box3(region));
        let [solid, air, surface] = self.shares().map(|share| 100.0 * share);
        let _ = writeln!(out, "  shares       {solid:.2}% solid, {air:.2}% air, {surface:.2}% surface");
        let _ = writeln!(
            out,
            "  contents     {:.2} primitives in a surface box, at most {}",
            contents.mean,
            grouped(contents.most)
        );
        let [points, evaluations, ranges, interval_evaluations] = self.evaluations();
        let _ = writeln!(
            out,
            "  evaluations  {} at {}, {} over {}",
            grouped(evaluations),
            plural(points, "point", "points"),
            grouped(interval_evaluations),
            plural(ranges, "box", "boxes"),
        );
        let _ = writeln!(out, "  time         {:.1} ms\n", self.total.as_secs_f64() * 1e3);
        let _ = write!(out, "{:<8}{:>12}{:>12}{:>12}{:>12}", "depth", "splits", "solid", "air", "surface");
        for (depth, level) in self.measures.levels.iter().enumerate() {
            write_level(&mut out, &depth.to_string(), level);
        }
        write_level(&mut out, "all", &boxes);
        out
    }

    /// For machines.
    fn json(&self) -> Value {
        let Measures { region, cell, volume, area, center, contents, levels, .. } = &self.measures;
        let support = (!self.support.is_empty() && self.support.is_finite())
            .then(|| [self.support.low(), self.support.high()].concat());
        let boxes = self.measures.boxes();
        let [solid, air, surface] = self.shares();
        let [points, evaluations, ranges, interval_evaluations] = self.evaluations();
        let level = |(depth, level): (usize, &MeasureLevel)| {
            json!({
                "depth": depth,
                "splits": level.splits, "solid": level.solid, "air": level.air, "surface": level.surface,
            })
        };
        json!({
            "support": support,
            "region": self.six(region),
            "origin": self.origin().point(),
            "cell": cell,
            "tight": {
                "outer": self.tight.outer.as_ref().map(|bounds| self.six(bounds)),
                "inner": self.tight.inner.as_ref().map(|bounds| self.six(bounds)),
                "tolerance": self.tolerance,
                "converged": self.tight.converged,
            },
            "volume": { "low": volume.low, "high": volume.high, "estimate": volume.estimate },
            "area": area,
            "center": center,
            "division": {
                "boxes": boxes.splits + boxes.solid + boxes.air + boxes.surface,
                "splits": boxes.splits, "solid": boxes.solid, "air": boxes.air, "surface": boxes.surface,
                "levels": levels.iter().enumerate().map(level).collect::<Vec<_>>(),
            },
            "shares": { "solid": solid, "air": air, "surface": surface },
            "contents": { "mean": contents.mean, "most": contents.most },
            "points": points,
            "evaluations": evaluations,
            "ranges": ranges,
            "interval_evaluations": interval_evaluations,
            "total_ms": self.total.as_secs_f64() * 1e3,
            "warnings": self.warnings,
        })
    }
}

fn write_level(out: &mut String, depth: &str, level: &MeasureLevel) {
    let [splits, solid, air, surface] = [level.splits, level.solid, level.air, level.surface].map(grouped);
    let _ = write!(out, "\n{depth:<8}{splits:>12}{solid:>12}{air:>12}{surface:>12}");
}

fn point([x, y, z]: [f64; 3]) -> String {
    format!("({x:.6} {y:.6} {z:.6})")
}
