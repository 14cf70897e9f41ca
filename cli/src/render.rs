//! `jbt render`: a picture of a scene, and what it took.

use std::time::{Duration, Instant};

use jbt::ModelOrigin;
use jbt::diagnostic::escape;
use jbt::export::{PngEffort, write_png_with};
use jbt::render::{Camera, Quality, Render, RenderMode, RenderReport, Rendered, Stance, View};
use jbt::tree::{OWNER, normalized};
use serde_json::json;

use crate::arguments::{GroundName, RenderArguments};
use crate::failure::Failure;
use crate::formats::PictureKind;
use crate::lattice;
use crate::output::{Output, grouped, plural, warn};
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;

/// Runs the command. `start` is when the process began, for the total time.
pub fn run(arguments: &RenderArguments, quiet: bool, start: Instant) -> Result<(), Failure> {
    let destination = arguments.output.destination(&arguments.scene.path)?;
    arguments.work.check_output(&destination.path, "picture")?;
    let mut settings = settings(arguments)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = match &settings.mode {
        RenderMode::Attribute(name) if is_owner(&arguments.mode) => scene.owner_colors(name)?,
        _ => scene.check()?,
    };
    settings.region = arguments.region.map(|region| lattice::local(region, tree.origin()));
    let compiler = arguments.work.compiler()?;

    let mut progress = ProgressLine::new("rendering", quiet);
    let mut work = || progress.run(settings.picture(&compiler, &tree));
    let made = arguments.work.run(&mut work).map_err(|error| scene.failure(&error))?;
    drop(progress);

    let mut output = Output::open(&destination)?;
    match destination.kind {
        PictureKind::Png => write_png_with(&made.picture, effort(settings.quality), &mut output),
    }
    .map_err(|error| output.failure(error))?;
    output.finish()?;

    let mut warnings: Vec<String> =
        made.report.notice.iter().map(|notice| notice.text().to_owned()).collect();
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
    }
    warnings.splice(0..0, scene.warnings.iter().cloned());
    let report = RenderSummary {
        made: &made,
        mode: &settings.mode,
        origin: tree.origin(),
        warnings: &warnings,
        total: start.elapsed(),
    };
    let told = arguments.work.told(quiet);
    told.report(&destination.path, || report.json().to_string(), |name| report.text(name))
}

/// The trouble for a file: less than a tenth of the time that its picture takes.
fn effort(quality: Quality) -> PngEffort {
    match quality {
        Quality::Draft | Quality::Good => PngEffort::Quick,
        Quality::Best => PngEffort::Small,
    }
}

/// What the options say.
fn settings(arguments: &RenderArguments) -> Result<Render, Failure> {
    let stance = match (arguments.eye, arguments.target, arguments.view) {
        (Some(eye), Some(target), _) => Stance::At { eye, target },
        (_, _, Some(stance)) => stance,
        (None, _, None) | (_, None, None) => View::default().stance,
    };
    let view = View {
        stance,
        up: arguments.up,
        lens: arguments.lens,
        zoom: arguments.zoom,
        orthographic: arguments.orthographic,
    };
    Ok(Render {
        size: arguments.size,
        view,
        mode: mode(&arguments.mode)?,
        quality: arguments.quality.quality(),
        antialias: arguments.antialias,
        background: arguments.background,
        ground: arguments.ground == GroundName::Shadow,
        // That counts from the origin of the model.
        region: None,
    })
}

/// Whether some words ask for the leaf that decides.
fn is_owner(words: &[String]) -> bool {
    matches!(words, [word] if word == OWNER)
}

/// The mode that some words name.
fn mode(words: &[String]) -> Result<RenderMode, Failure> {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["shaded"] => Ok(RenderMode::Shaded),
        ["normal"] => Ok(RenderMode::Normal),
        ["depth"] => Ok(RenderMode::Depth),
        ["evaluations"] => Ok(RenderMode::Evaluations),
        ["owner"] => Ok(RenderMode::Attribute(OWNER.to_owned())),
        ["attribute", name] => Ok(RenderMode::Attribute(normalized(name).into_owned())),
        ["attribute"] => Err(Failure::Usage("--mode attribute needs the name of an attribute".to_owned())),
        _ => Err(Failure::Usage(format!(
            "there is no mode `{}`; there are shaded, normal, depth, owner, attribute NAME and evaluations",
            words.join(" ")
        ))),
    }
}

/// What is told about a picture.
struct RenderSummary<'a> {
    made: &'a Rendered,
    mode: &'a RenderMode,
    origin: ModelOrigin,
    warnings: &'a [String],
    total: Duration,
}

impl RenderSummary<'_> {
    fn pixels(&self) -> u64 {
        u64::from(self.made.picture.width()) * u64::from(self.made.picture.height())
    }

    /// Evaluations for a pixel.
    fn per_pixel(&self) -> f64 {
        self.made.report.evaluations as f64 / self.pixels() as f64
    }

    /// For machines.
    fn json(&self) -> serde_json::Value {
        let RenderReport { pixels_hit, rays, evaluations, range, tolerance, camera, .. } = &self.made.report;
        let camera = camera.map(|Camera { eye, right, up, back, half, orthographic }| {
            json!({
                "eye": eye, "right": right, "up": up, "back": back, "half": half, "orthographic": orthographic,
            })
        });
        let [compile, frame, mesh, trace, shade] = self.times();
        json!({
            "width": self.made.picture.width(),
            "height": self.made.picture.height(),
            "pixels": self.pixels(),
            "pixels_hit": pixels_hit,
            "rays": { "camera": rays.camera, "shadow": rays.shadow, "sky": rays.sky, "total": rays.total() },
            "evaluations": evaluations,
            "triangles": self.made.report.triangles,
            "evaluations_per_pixel": self.per_pixel(),
            "range": range,
            "camera": camera,
            "origin": self.origin.point(),
            "tolerance": tolerance,
            "engine": self.made.report.engine.name(),
            "compile_ms": compile,
            "frame_ms": frame,
            "mesh_ms": mesh,
            "trace_ms": trace,
            "shade_ms": shade,
            "total_ms": milliseconds(self.total),
            "warnings": self.warnings,
        })
    }

    /// For people.
    fn text(&self, name: &str) -> String {
        let RenderReport { pixels_hit, rays, evaluations, range, tolerance, camera, engine, .. } =
            &self.made.report;
        let (width, height) = (self.made.picture.width(), self.made.picture.height());
        let mut out =
            format!("{}: {width} x {height} pixels, {} of them hit\n", escape(name), grouped(*pixels_hit));
        if let Some(camera) = camera {
            let [x, y, z] = camera.eye;
            out += &format!(
                "  camera       at ({x:.4} {y:.4} {z:.4}), tolerance {tolerance:.6}{}\n",
                lattice::origin_line(self.origin)
            );
        }
        if let Some([least, most]) = range {
            out += &format!("  range        {} from {least} to {most}\n", self.what());
        }
        let [compile, frame, mesh, trace, shade] = self.times();
        out + &format!(
            "  rays         {}: {} of the camera, {} to the light, {} to the sky\n\
             \x20 primitives   {} evaluated, {:.1} a pixel, by engine {}\n\
             \x20 time         {compile:.1} ms to compile, {frame:.1} to frame, {mesh:.1} to mesh, {trace:.1} to trace, \
             {shade:.1} to shade, {:.1} ms in total",
            plural(rays.total(), "ray", "rays"),
            grouped(rays.camera),
            grouped(rays.shadow),
            grouped(rays.sky),
            grouped(*evaluations),
            self.per_pixel(),
            engine.name(),
            milliseconds(self.total),
        )
    }

    /// What the range is one of.
    fn what(&self) -> String {
        match self.mode {
            RenderMode::Shaded | RenderMode::Normal => "colours".to_owned(),
            RenderMode::Depth => "distances from white to dark:".to_owned(),
            RenderMode::Attribute(name) => format!("`{}` from blue to yellow:", escape(name)),
            RenderMode::Evaluations => "evaluations of a pixel, from black to yellow:".to_owned(),
        }
    }

    /// Milliseconds to compile, frame, mesh, trace and shade.
    fn times(&self) -> [f64; 5] {
        let RenderReport { compile_time, frame_time, mesh_time, trace_time, shade_time, .. } =
            &self.made.report;
        [compile_time, frame_time, mesh_time, trace_time, shade_time].map(|time| milliseconds(*time))
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
