//! `jbt mesh`: the surface of a scene as a file of triangles, and what it took.

use std::time::{Duration, Instant};

use jbt::diagnostic::escape;
use jbt::export::{self, ColorEncoding, ExportOptions, Format, LengthUnit};
use jbt::mesh::{Mesh, MeshPiece, Simplify, ThinReport};
use jbt::{Box3, CheckedTree, MeshCounters, Model, ModelOrigin, ModelUp, Polygonize, Polygonized, Tree};
use serde_json::json;

use crate::arguments::{MeshArguments, Switch};
use crate::failure::Failure;
use crate::lattice;
use crate::output::{Destination, finish_all, grouped, plural, warn};
use crate::part_files::{self, MeshFileError};
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;
use crate::sequence;
use crate::shade;
use crate::stages;

/// Runs the command. `start` is when the process began, for the total time.
pub fn run(arguments: &MeshArguments, quiet: bool, start: Instant) -> Result<(), Failure> {
    if sequence::is_sequence(&arguments.scene.path) {
        return sequence::run(arguments, quiet);
    }
    if arguments.parts {
        part_files::check(arguments.output.output.as_deref())?;
    }
    let destination = arguments.output.destination(&arguments.scene.path)?;
    arguments.work.check_output(&destination.path, "mesh")?;
    let mut options = options(arguments, destination.kind)?;
    let settings = settings(arguments)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    let parts = || part_files::destinations(&destination, &arguments.scene.path, &tree);
    let parts = arguments.parts.then(parts).transpose()?;
    options.name = scene.part_name(&arguments.scene.options.parts).map(str::to_owned);
    options.constants = tree.constants_of_pieces();
    let compiler = arguments.work.compiler()?;

    let mut progress = ProgressLine::new("meshing", quiet);
    let mut mesh = |tree: &CheckedTree| {
        let mut work = || progress.run(settings.mesh(&compiler, tree));
        arguments.work.run(&mut work).map_err(|error| scene.failure(&error))
    };
    let mut made = mesh(&tree)?;
    let height = arguments.flat_bottom;
    if let Some(flat) = height.map(|height| flattened(&scene.model, &made, height)).transpose()?.flatten() {
        let tree = flat.check().map_err(|error| scene.failure(&error))?;
        options.constants = tree.constants_of_pieces();
        made = mesh(&tree)?;
    }
    drop(progress);
    shaded(arguments, &mut made.mesh)?;

    // The file is written while the mesh is measured.
    let places = parts.as_deref().unwrap_or(std::slice::from_ref(&destination));
    let write = || match parts {
        Some(_) => part_files::write_parts(&made.mesh, &options, places),
        None => part_files::write(&made.mesh, &destination, &options).map(|written| vec![written]),
    };
    let mut both = || rayon::join(write, || MeshMeasures::new(&made));
    let (written, measures) = arguments.work.run(&mut both);
    finish_all(written.map_err(|error| match error {
        MeshFileError::Output(failure) => failure,
        MeshFileError::Export(error) => scene.failure(&error),
    })?)?;

    let mut warnings = warnings(&made, destination.kind);
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
    }
    warnings.splice(0..0, scene.warnings);
    let report = MeshSummary {
        made: &made,
        measures,
        format: destination.kind,
        options,
        warnings: &warnings,
        parts: parts.as_deref(),
        total: start.elapsed(),
    };
    let told = arguments.work.told(quiet);
    told.report(&destination.path, || report.json().to_string(), |name| report.text(name))
}

/// Colours, and fewer triangles, as far as these are wanted.
fn shaded(arguments: &MeshArguments, mesh: &mut Mesh) -> Result<(), Failure> {
    if let Some(name) = &arguments.color_by {
        shade::shade(mesh, name, arguments.ramp, arguments.color_range)?;
    }
    if let Some(until) = arguments.simplify {
        *mesh = simplified(mesh, until)?;
    }
    Ok(())
}

/// How the mesh is to be made.
fn settings(arguments: &MeshArguments) -> Result<Polygonize, Failure> {
    Ok(Polygonize {
        thin_parts: !arguments.no_thin,
        verify: arguments.verify,
        sharp: arguments.sharp == Switch::On,
        ..lattice::settings(&arguments.lattice)?
    })
}

/// How the file is to be written.
fn options(arguments: &MeshArguments, format: Format) -> Result<ExportOptions, Failure> {
    if arguments.colors.is_some() && format.conventions().colors.is_none() {
        return Err(Failure::Usage(format!("a .{format} file has no colours that --colors could be about")));
    }
    if arguments.unit.is_some() && format.conventions().unit.is_none() {
        return Err(Failure::Usage(format!("a .{format} file states no unit that --unit could be about")));
    }
    if arguments.palette.is_some() && !format.conventions().materials {
        return Err(Failure::Usage(format!(
            "a .{format} file has no materials that --palette could be about"
        )));
    }
    let &MeshArguments { up, colors, unit, palette, .. } = arguments;
    Ok(ExportOptions { up, colors, unit, palette, ..ExportOptions::default() })
}

/// A mesh of fewer triangles, of which something is left.
fn simplified(whole: &Mesh, until: Simplify) -> Result<Mesh, Failure> {
    let mesh = whole.simplified(until);
    if mesh.triangles.is_empty() && !whole.triangles.is_empty() {
        let message = "--simplify leaves nothing of the mesh: expected less than the thickness of the model";
        return Err(Failure::Usage(message.to_owned()));
    }
    Ok(mesh)
}

/// A model without what is lower than `height` above the lowest vertex of its mesh; `None` if there is none.
///
/// # Errors
/// A height that leaves nothing.
fn flattened(model: &Model, made: &Polygonized, height: f64) -> Result<Option<Model>, Failure> {
    let origin = ModelOrigin::new(made.mesh.origin);
    let Some(bounds) = made.mesh.bounds() else { return Ok(None) };
    let Box3 { low: lowest, high: highest } = bounds.map(|corner| origin.world(corner.map(f64::from)));
    let cell = made.lattice.spacing();
    let Box3 { low, high } = lattice::bounds(&made.lattice, origin);
    let (mut low, high) = (low.map(|c| c - cell), high.map(|c| c + cell));
    let up = match model.orientation.up {
        ModelUp::Y => 1,
        ModelUp::Z => 2,
    };
    let whole = highest[up] - lowest[up];
    if height >= whole {
        let message = format!("--flat-bottom {height} leaves nothing: the model is {whole} high");
        return Err(Failure::Usage(message));
    }
    low[up] = lowest[up] + height;
    let parts = model.root.parts();
    // Parts stay parts.
    let named = |part| (Tree::node(part).name().unwrap_or_default(), part.within(low, high));
    let root = match parts {
        [] => model.root.within(low, high),
        parts => Tree::of_parts(parts.iter().map(named)),
    };
    Ok(Some(Model { root, ..model.clone() }))
}

/// What may not be as people expect.
fn warnings(made: &Polygonized, format: Format) -> Vec<String> {
    let mut warnings = Vec::new();
    if export::loses_digits(&made.mesh, format) {
        let [x, y, z] = made.mesh.origin;
        let keep = Format::ALL.into_iter().filter(|&format| !export::loses_digits(&made.mesh, format));
        let keep: Vec<String> = keep.map(|format| format!(".{format}")).collect();
        warnings.push(format!(
            "the model stands near ({x} {y} {z}), where a .{format} file has not enough digits: its vertices are rounded; \
             {} keep them",
            keep.join(", ")
        ));
    }
    if made.mesh.triangles.is_empty() {
        warnings
            .push("the mesh is empty: no cell is crossed by the surface; cells may be too large".to_owned());
    }
    if made.report.cut_sides.any() {
        warnings.push(format!(
            "the region cuts the surface at its sides {}: the mesh is open there",
            made.report.cut_sides
        ));
    } else if !made.report.closed {
        warnings.push("the mesh is not closed".to_owned());
    }
    if made.report.crowded {
        let cell = made.lattice.spacing();
        warnings.push(format!(
            "cells of {cell} are hardly longer than the steps of f32 so far from the origin: \
             the mesh is coarse, and vertices may coincide"
        ));
    }
    warnings.extend(made.report.thin.as_ref().and_then(thin_warning));
    warnings
}

/// Points that a warning about thin parts names.
const NAMED: usize = 3;

/// That parts are too thin for the cells, if any were found.
fn thin_warning(thin: &ThinReport) -> Option<String> {
    let cell = thin.cell?;
    let named: Vec<String> =
        thin.near.iter().take(NAMED).map(|point| format!("({})", point.map(digits).join(", "))).collect();
    let places = plural(thin.places, "place", "places");
    Some(format!("{places} may hold parts thinner than a cell, near {}; try --cell {cell}", named.join(", ")))
}

/// The measures of a mesh.
#[derive(Clone, Copy)]
struct MeshMeasures {
    /// Relative to its origin.
    bounds: Option<Box3>,
    area: f64,
    /// Of a closed mesh.
    volume: Option<f64>,
}

impl MeshMeasures {
    fn new(Polygonized { mesh, report, .. }: &Polygonized) -> Self {
        Self { bounds: mesh.bounds(), area: mesh.area(), volume: report.closed.then(|| mesh.volume()) }
    }
}

/// What is told about a mesh.
struct MeshSummary<'a> {
    made: &'a Polygonized,
    measures: MeshMeasures,
    format: Format,
    options: ExportOptions,
    warnings: &'a [String],
    /// The files of parts, if each has one.
    parts: Option<&'a [Destination<Format>]>,
    total: Duration,
}

impl MeshSummary<'_> {
    /// For machines.
    fn json(&self) -> serde_json::Value {
        let Polygonized { mesh, report, lattice, counters, .. } = self.made;
        let origin = ModelOrigin::new(mesh.origin);
        let Box3 { low, high } = lattice::bounds(lattice, origin);
        let world = |corner: [f32; 3]| origin.world(corner.map(f64::from));
        let MeshMeasures { bounds, area, volume } = self.measures;
        let bounds = bounds.map(|bounds| bounds.map(world));
        json!({
            "triangles": mesh.triangles.len(),
            "vertices": mesh.positions.len(),
            "closed": report.closed,
            "bounds": bounds.map(|bounds| [bounds.low, bounds.high].concat()),
            "size": bounds.map(size),
            "volume": volume,
            "area": area,
            "format": self.format.extension(),
            "up": self.options.up_in(self.format).name(),
            "colors": self.options.colors_in(self.format).map(ColorEncoding::name),
            "unit": self.options.unit_in(self.format).map(LengthUnit::name),
            "cut_sides": report.cut_sides.to_string(),
            "field_evaluations": report.field_evaluations + report.jump_evaluations,
            "jump_evaluations": report.jump_evaluations,
            "jump_vertices": report.jump_vertices,
            "sharp_vertices": report.sharp_vertices,
            "gradient_evaluations": report.gradient_evaluations,
            "full_evaluations": report.full_evaluations,
            "primitive_evaluations": self.made.primitive_evaluations,
            "stages": stages::json(counters),
            "dense_evaluations": counters.dense_evaluations,
            "avoided_by_support": counters.avoided_by_support,
            "avoided_by_interval": counters.avoided_by_interval,
            "interval_evaluations": counters.division.interval_evaluations,
            "bricks": report.bricks,
            "crossing_cells": report.crossing_cells,
            "thin": report.thin.as_ref().map(|thin| thin_json(thin, counters)),
            "engine": self.made.engine.name(),
            "region": [low[0], low[1], low[2], high[0], high[1], high[2]],
            "cell": lattice.spacing(),
            "cells": lattice.cells(),
            "origin": mesh.origin,
            "parts": self.parts.map(|places| self.parts_json(places)),
            "compile_ms": milliseconds(self.made.compile_time),
            "total_ms": milliseconds(self.total),
            "warnings": self.warnings,
        })
    }

    /// The files of parts, for machines.
    fn parts_json(&self, places: &[Destination<Format>]) -> serde_json::Value {
        let part = |(piece, place): (&MeshPiece<'_>, &Destination<Format>)| {
            json!({
                "name": piece.name,
                "file": place.path.display().to_string(),
                "triangles": piece.triangles.len(),
                "vertices": piece.vertices.len(),
            })
        };
        self.made.mesh.pieces().iter().zip(places).map(part).collect()
    }

    /// The size of the mesh in words: `2 x 2 x 2, volume 4.18854, area 12.5661`.
    fn measures(&self) -> String {
        let MeshMeasures { bounds, area, volume } = self.measures;
        let Some(bounds) = bounds else { return "nothing".to_owned() };
        let sides = size(bounds.map(|corner| corner.map(f64::from))).map(digits);
        let volume = volume.map_or_else(|| "none (open)".to_owned(), digits);
        format!("{}, volume {volume}, area {}", sides.join(" x "), digits(area))
    }

    /// For people.
    fn text(&self, name: &str) -> String {
        let Polygonized { mesh, report, lattice, counters, .. } = self.made;
        let closed = if report.closed {
            "closed".to_owned()
        } else if report.cut_sides.any() {
            format!("open (cut at {})", report.cut_sides)
        } else {
            "not closed".to_owned()
        };
        format!(
            "{}: {}, {}, {closed}\n\
             \x20 size         {}\n\
             {}\
             \x20 lattice      {}{}\n\
             \x20 evaluations  {} of the field, {} with gradient, {} with everything\n\
             \x20 primitives   {} evaluated, {} over boxes, by engine {}\n\
             \x20 avoided      {} out of reach, {} where no surface is\n\
             \x20 time         {:.1} ms to compile, {:.1} ms in total",
            escape(name),
            plural(mesh.triangles.len() as u64, "triangle", "triangles"),
            plural(mesh.positions.len() as u64, "vertex", "vertices"),
            self.measures(),
            self.parts.map_or_else(String::new, parts_line),
            lattice::describe(lattice, ModelOrigin::new(mesh.origin)),
            lattice::origin_line(ModelOrigin::new(mesh.origin)),
            grouped(report.field_evaluations + report.jump_evaluations),
            grouped(report.gradient_evaluations),
            grouped(report.full_evaluations),
            grouped(self.made.primitive_evaluations),
            grouped(counters.division.interval_evaluations),
            self.made.engine.name(),
            grouped(counters.avoided_by_support),
            grouped(counters.avoided_by_interval),
            milliseconds(self.made.compile_time),
            milliseconds(self.total),
        )
    }
}

/// The files of parts, for people.
fn parts_line(places: &[Destination<Format>]) -> String {
    const SHOWN: usize = 6;
    let mut names: Vec<String> =
        places.iter().take(SHOWN).map(|place| escape(&place.path.display().to_string())).collect();
    if places.len() > SHOWN {
        names.push(format!("and {} more", places.len() - SHOWN));
    }
    format!("  files        {}\n", names.join(", "))
}

/// Thin parts, for machines.
fn thin_json(thin: &ThinReport, counters: &MeshCounters) -> serde_json::Value {
    json!({
        "places": thin.places,
        "near": thin.near,
        "cell": thin.cell,
        "missed": thin.missed,
        "shredded": thin.shredded,
        "unproven": thin.unproven,
        "boxes": thin.boxes,
        "evaluations": counters.thin,
        "interval_evaluations": counters.thin_intervals,
    })
}

/// The sides of a box.
fn size(Box3 { low, high }: Box3<f64>) -> [f64; 3] {
    std::array::from_fn(|axis| high[axis] - low[axis])
}

/// A number in six digits.
fn digits(number: f64) -> String {
    // A number that has been printed as such is one.
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    rounded.to_string()
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
