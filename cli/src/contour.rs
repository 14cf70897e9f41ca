//! `jbt contour`: a slice of a scene as a drawing or an image, and what it took.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use jbt::contour::{
    Contour, ContourLevel, Detail, ImageDetail, ImageMode, Rectangle, SliceError, Slicer, circles,
};
use jbt::diagnostic::escape;
use jbt::export::svg::{Paint, Style, write_svg};
use jbt::export::write_png;
use jbt::tree::normalized;
use jbt::{CheckedTree, Fineness, ModelOrigin, Picture, Query};
use serde_json::{Value, json};

use crate::arguments::{ContourArguments, ModeName, PaintName};
use crate::failure::Failure;
use crate::formats::SliceKind;
use crate::lattice;
use crate::output::{Output, grouped, plural, warn};
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;

/// Runs the command. `start` is when the process began, for the total time.
pub fn run(arguments: &ContourArguments, quiet: bool, start: Instant) -> Result<(), Failure> {
    let destination = arguments.output.destination(&arguments.scene.path)?;
    arguments.work.check_output(&destination.path, "slice")?;
    let drawing = destination.kind;
    check_options(arguments, drawing)?;
    let fineness = fineness(arguments, drawing)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    check_attributes(arguments, drawing, &tree)?;
    let compiler = arguments.work.compiler()?;
    let query = if drawing == SliceKind::Svg || mode(arguments).1 { Query::ATTRIBUTES } else { Query::FIELD };
    let slicer =
        Slicer::new(&compiler, &tree, &arguments.plane, query).map_err(|error| scene.failure(&error))?;
    let rectangle = match arguments.region {
        Some(rectangle) => rectangle,
        None => slicer.rectangle().map_err(|error| scene.failure(&error))?,
    };
    let mut progress = ProgressLine::new("slicing", quiet);
    let mut work = || make(arguments, drawing, &slicer, &rectangle, fineness, &mut progress);
    let made = arguments.work.run(&mut work).map_err(|error| scene.failure(&error))?;
    drop(progress);

    let mut output = Output::open(&destination)?;
    match &made {
        Made::Contour(contour) => write_svg(contour, &style(arguments, &tree), &mut output),
        Made::Picture { picture, .. } => write_png(picture, &mut output),
    }
    .map_err(|error| output.failure(error))?;
    output.finish()?;

    let mut warnings = warnings(&made);
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
    }
    warnings.splice(0..0, scene.warnings.iter().cloned());
    let report = ContourReport {
        made: &made,
        slicer: &slicer,
        origin: tree.origin(),
        warnings: &warnings,
        total: start.elapsed(),
    };
    let told = arguments.work.told(quiet);
    told.report(&destination.path, || report.json().to_string(), |name| report.text(name))
}

/// Options that mean nothing for what is made.
fn check_options(arguments: &ContourArguments, drawing: SliceKind) -> Result<(), Failure> {
    let wrong = match drawing {
        SliceKind::Svg => {
            [("--mode", arguments.mode.is_some()), ("--samples", arguments.samples.is_some()), ("", false)]
        }
        SliceKind::Png => [
            ("--stroke", arguments.stroke.is_some()),
            ("--fill", arguments.fill.is_some()),
            ("--quadtree", arguments.quadtree),
        ],
    };
    let (kind, other) = match drawing {
        SliceKind::Svg => ("a drawing (.svg)", "an image (.png)"),
        SliceKind::Png => ("an image (.png)", "a drawing (.svg)"),
    };
    match wrong.iter().find(|(_, given)| *given) {
        Some((option, _)) => {
            Err(Failure::Usage(format!("{option} is for {other}, and {kind} was asked for")))
        }
        None => Ok(()),
    }
}

fn fineness(arguments: &ContourArguments, drawing: SliceKind) -> Result<Fineness, Failure> {
    match (arguments.cell, arguments.resolution) {
        (Some(cell), _) if !cell.is_finite() || cell <= 0.0 => Err(Failure::Usage(format!(
            "the edge of a cell must be a finite number greater than zero, and it is {cell}"
        ))),
        (Some(cell), _) => Ok(Fineness::Cell(cell)),
        (None, Some(0)) => Err(Failure::Usage("a slice needs at least one cell".to_owned())),
        (None, Some(cells)) => Ok(Fineness::Resolution(cells)),
        (None, None) => Ok(Fineness::Resolution(match drawing {
            SliceKind::Svg => 256,
            SliceKind::Png => 512,
        })),
    }
}

/// The attribute that the options speak of, where they do not name it.
fn attribute(arguments: &ContourArguments) -> Cow<'_, str> {
    normalized(arguments.attribute.as_deref().unwrap_or("color"))
}

/// The mode of an image, and whether it needs attributes.
fn mode(arguments: &ContourArguments) -> (ImageMode, bool) {
    match arguments.mode.unwrap_or(ModeName::Field) {
        ModeName::Inside => (ImageMode::Inside, false),
        ModeName::Field => (ImageMode::Field, false),
        ModeName::Grey => (ImageMode::Grey, false),
        ModeName::Height => (ImageMode::Height, false),
        ModeName::Attribute => (ImageMode::Attribute(attribute(arguments).into_owned()), true),
    }
}

/// An attribute that is asked for is there.
fn check_attributes(
    arguments: &ContourArguments,
    drawing: SliceKind,
    tree: &CheckedTree,
) -> Result<(), Failure> {
    let paints = [arguments.stroke, arguments.fill].contains(&Some(PaintName::Attribute));
    let asked = match drawing {
        SliceKind::Svg => paints || arguments.attribute.is_some(),
        SliceKind::Png => mode(arguments).1 || arguments.attribute.is_some(),
    };
    let name = &*attribute(arguments);
    if !asked || tree.attributes().iter().any(|group| &*group.name == name) {
        return Ok(());
    }
    let names: Vec<&str> = tree.attributes().iter().map(|group| &*group.name).collect();
    Err(Failure::Usage(format!("the scene has no attribute `{}`: it has {}", escape(name), names.join(", "))))
}

/// What was made.
enum Made {
    Contour(Contour),
    Picture { picture: Picture, rectangle: Rectangle },
}

fn make(
    arguments: &ContourArguments,
    drawing: SliceKind,
    slicer: &Slicer,
    rectangle: &Rectangle,
    fineness: Fineness,
    progress: &mut ProgressLine,
) -> Result<Made, SliceError> {
    match drawing {
        SliceKind::Svg => {
            let block = arguments.quadtree.then_some(1);
            let detail = Detail { fineness, block, quadtree: arguments.quadtree };
            progress.run(slicer.contour(rectangle, &detail)).map(Made::Contour)
        }
        SliceKind::Png => {
            let samples = arguments.samples.map_or(1, usize::from);
            let (mode, _) = mode(arguments);
            let detail = ImageDetail { fineness, samples };
            let picture = progress.run(slicer.picture(rectangle, &mode, &detail))?;
            Ok(Made::Picture { picture, rectangle: *rectangle })
        }
    }
}

fn style(arguments: &ContourArguments, tree: &CheckedTree) -> Style {
    let paint = |name: PaintName| match name {
        PaintName::None => Paint::None,
        PaintName::Color(color) => Paint::Color(color),
        PaintName::Attribute => Paint::Attribute(attribute(arguments).into_owned()),
    };
    let plain = Style::default();
    let fill = match arguments.fill {
        Some(fill) => paint(fill),
        // The quadtree is to be seen.
        None if arguments.quadtree => Paint::None,
        None => plain.fill.clone(),
    };
    // A thin line leaves the cells that it crosses to be seen.
    let stroke_width = if arguments.quadtree { 1.0 / 1600.0 } else { plain.stroke_width };
    Style {
        stroke: arguments.stroke.map_or(plain.stroke.clone(), paint),
        stroke_width,
        fill,
        quadtree: arguments.quadtree,
        circles: if arguments.quadtree { circles(tree, &arguments.plane) } else { Vec::new() },
        ..plain
    }
}

/// What may not be as people expect.
fn warnings(made: &Made) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Made::Contour(contour) = made {
        if contour.loops.is_empty() {
            let message = "the slice is empty: no cell is crossed by the contour; cells may be too large";
            warnings.push(message.to_owned());
        }
        let cut = cut(contour);
        if !cut.is_empty() {
            warnings.push(format!(
                "the region cuts the solid at its sides {cut}: the contour follows them there"
            ));
        }
    }
    warnings
}

/// The sides that cut the solid, in words.
fn cut(contour: &Contour) -> String {
    let names = ["-u", "-v", "+u", "+v"];
    let cut: Vec<&str> =
        names.into_iter().zip(contour.cut_sides).filter_map(|(name, cut)| cut.then_some(name)).collect();
    cut.join(" ")
}

/// What is told about a slice.
struct ContourReport<'a> {
    made: &'a Made,
    slicer: &'a Slicer,
    origin: ModelOrigin,
    warnings: &'a [String],
    total: Duration,
}

impl ContourReport<'_> {
    /// For machines.
    fn json(&self) -> Value {
        let (ranges, field, full) = self.slicer.counters();
        let mut report = json!({
            "plane": self.slicer.plane().to_string(),
            "origin": self.origin.point(),
            "ranges": ranges.boxes,
            "interval_evaluations": ranges.interval_evaluations,
            "field_evaluations": field.points,
            "full_evaluations": full.points,
            "primitive_evaluations": field.primitive_evaluations + full.primitive_evaluations,
            "evaluations_pruned": field.evaluations_pruned + full.evaluations_pruned,
            "engine": self.slicer.engine().name(),
            "total_ms": self.total.as_secs_f64() * 1e3,
            "warnings": self.warnings,
        });
        let more = match self.made {
            Made::Contour(contour) => contour_json(contour),
            Made::Picture { picture, rectangle } => json!({
                "pixels": [picture.width(), picture.height()],
                "region": corners(rectangle),
            }),
        };
        if let (Value::Object(report), Value::Object(more)) = (&mut report, more) {
            report.extend(more);
        }
        report
    }

    /// For people.
    fn text(&self, name: &str) -> String {
        let (ranges, field, full) = self.slicer.counters();
        let name = escape(name);
        let what = match self.made {
            Made::Contour(contour) => format!("{name}: {}", contour_text(contour)),
            Made::Picture { picture, rectangle } => format!(
                "{name}: {} x {} pixels\n  region       {}",
                picture.width(),
                picture.height(),
                region_text(rectangle)
            ),
        };
        format!(
            "{what}{}\n\
             \x20 evaluations  {} of the field, {} with attributes, {} of ranges of squares\n\
             \x20 primitives   {} evaluated, {} over squares, {} left out at points, by engine {}\n\
             \x20 time         {:.1} ms in total",
            lattice::origin_line(self.origin),
            grouped(field.points),
            grouped(full.points),
            grouped(ranges.boxes),
            grouped(field.primitive_evaluations + full.primitive_evaluations),
            grouped(ranges.interval_evaluations),
            grouped(field.evaluations_pruned + full.evaluations_pruned),
            self.slicer.engine().name(),
            self.total.as_secs_f64() * 1e3,
        )
    }
}

fn corners(rectangle: &Rectangle) -> [f64; 4] {
    let ([u0, v0], [u1, v1]) = (rectangle.low(), rectangle.high());
    [u0, v0, u1, v1]
}

fn region_text(rectangle: &Rectangle) -> String {
    let [u0, v0, u1, v1] = corners(rectangle);
    format!("from ({u0:.4} {v0:.4}) to ({u1:.4} {v1:.4})")
}

fn contour_json(contour: &Contour) -> Value {
    let level = |level: &ContourLevel| {
        json!({
            "depth": level.depth,
            "cells": level.cells,
            "divided": level.divided,
            "inside": level.inside,
            "outside": level.outside,
            "crossed": level.crossed,
            "evaluated": level.evaluated,
        })
    };
    json!({
        "loops": contour.loops.len(),
        "holes": contour.holes(),
        "vertices": contour.positions.len(),
        "area": contour.area(),
        "length": contour.length(),
        "cut_sides": cut(contour),
        "region": corners(&contour.rectangle),
        "cell": contour.cell,
        "cells": contour.cells,
        "squares": contour.levels.iter().map(level).collect::<Vec<Value>>(),
    })
}

fn contour_text(contour: &Contour) -> String {
    let [width, height] = contour.cells;
    let mut text = format!(
        "{}, {} of them holes, {}\n\
         \x20 slice        area {:.6}, length {:.6}\n\
         \x20 lattice      {width} x {height} cells of {:.6}, {}",
        plural(contour.loops.len() as u64, "loop", "loops"),
        contour.holes(),
        plural(contour.positions.len() as u64, "vertex", "vertices"),
        contour.area(),
        contour.length(),
        contour.cell,
        region_text(&contour.rectangle),
    );
    for level in &contour.levels {
        text += &format!(
            "\n  depth {:<2}     {} of {}: {} divided, {} inside, {} outside, {} crossed, {} evaluated for nothing",
            level.depth,
            plural(level.squares(), "square", "squares"),
            plural(level.cells.into(), "cell", "cells"),
            grouped(level.divided),
            grouped(level.inside),
            grouped(level.outside),
            grouped(level.crossed),
            grouped(level.evaluated),
        );
    }
    text
}
