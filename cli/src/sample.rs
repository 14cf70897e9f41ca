//! `jbt sample`: the answers at the points of a lattice, as an array for numpy.

use std::time::{Duration, Instant};

use jbt::mesh::Lattice;
use jbt::sample::{Sampler, VdbField, VdbVolume, Wanted, write_npy, write_vdb};
use jbt::{AnswerKind, Box3, Counters};
use serde_json::json;

use crate::arguments::SampleArguments;
use crate::failure::Failure;
use crate::formats::ArrayKind;
use crate::lattice;
use crate::output::{Output, grouped};
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;

/// What is said of distances that are none to the last digit.
const FIRST_ORDER: &str = "distances of the level set are those of tangents, (iso - field) / |gradient|: exact at the \
                           surface, and less so the farther off";

/// Runs the command. `start` is when the process began, for the total time.
pub fn run(arguments: &SampleArguments, quiet: bool, start: Instant) -> Result<(), Failure> {
    let destination = arguments.output.destination(&arguments.scene.path)?;
    arguments.work.check_output(&destination.path, "samples")?;
    if arguments.level_set && destination.kind != ArrayKind::Vdb {
        return Err(Failure::Usage("a level set is written as .vdb".to_owned()));
    }
    let settings = lattice::settings(&arguments.lattice)?;
    let mut scene = LoadedScene::load(&arguments.scene)?;
    if arguments.level_set {
        scene.warnings.push(FIRST_ORDER.to_owned());
    }
    scene.warn(quiet);
    arguments.query.check_numbers()?;
    let tree = scene.check_for(&arguments.query)?;
    let lattice = settings.lattice(&tree).map_err(|error| scene.failure(&error))?;
    let compiler = arguments.work.compiler()?;
    let asked = arguments.query.query;
    let query = if arguments.level_set { asked.and(AnswerKind::Gradient) } else { asked };
    let sampler = Sampler::new(&compiler, &tree, query).map_err(|error| scene.failure(&error))?;
    let mut progress = ProgressLine::new("sampling", quiet);
    match destination.kind {
        ArrayKind::Npy => {
            let mut work = || progress.run(sampler.dense(&lattice));
            let planes = arguments.work.run(&mut work).map_err(|error| scene.failure(&error))?;
            drop(progress);
            let mut output = Output::open(&destination)?;
            write_npy(lattice.points(), &planes, &mut output).map_err(|error| output.failure(error))?;
            output.finish()?;
        }
        ArrayKind::Vdb => {
            lattice.check_points().map_err(|error| scene.failure(&error))?;
            let mut work = || progress.run(sampler.blocks(&lattice, Wanted::Support));
            let blocks = arguments.work.run(&mut work).map_err(|error| scene.failure(&error))?;
            drop(progress);
            let evaluator = sampler.evaluator();
            let (origin, names) = (evaluator.origin().point(), evaluator.layout().names());
            let iso = tree.iso() as f32;
            let field = if arguments.level_set { VdbField::LevelSet { iso } } else { VdbField::Fog };
            let volume = VdbVolume { lattice: &lattice, origin, names, field };
            let mut output = Output::open(&destination)?;
            write_vdb(volume, &blocks, &mut output).map_err(|error| output.failure(error))?;
            output.finish()?;
        }
    }
    let report = SampleReport {
        sampler: &sampler,
        lattice: &lattice,
        counters: sampler.evaluator().counters(),
        warnings: &scene.warnings,
        total: start.elapsed(),
    };
    let told = arguments.work.told(quiet);
    told.report(&destination.path, || report.json().to_string(), |name| report.text(name))
}

/// What is told about samples.
struct SampleReport<'a> {
    sampler: &'a Sampler,
    lattice: &'a Lattice,
    counters: Counters,
    warnings: &'a [String],
    total: Duration,
}

impl SampleReport<'_> {
    /// For machines.
    fn json(&self) -> serde_json::Value {
        let Box3 { low, high } = lattice::bounds(self.lattice, self.sampler.evaluator().origin());
        json!({
            "planes": self.sampler.evaluator().layout().names(),
            "points": self.lattice.points(),
            "region": [low[0], low[1], low[2], high[0], high[1], high[2]],
            "cell": self.lattice.spacing(),
            "origin": self.sampler.evaluator().origin().point(),
            "points_evaluated": self.counters.points,
            "primitive_evaluations": self.counters.primitive_evaluations,
            "evaluations_pruned": self.counters.evaluations_pruned,
            "engine": self.sampler.evaluator().engine().name(),
            "total_ms": self.total.as_secs_f64() * 1e3,
            "warnings": self.warnings,
        })
    }

    /// For people.
    fn text(&self, name: &str) -> String {
        let [x, y, z] = self.lattice.points();
        format!(
            "{}: {} at {x} x {y} x {z} points\n\
             \x20 lattice      {}{}\n\
             \x20 primitives   {} evaluated at {} points, {} left out there, by engine {}\n\
             \x20 time         {:.1} ms in total",
            jbt::diagnostic::escape(name),
            self.sampler.evaluator().layout().names().join(", "),
            lattice::describe(self.lattice, self.sampler.evaluator().origin()),
            lattice::origin_line(self.sampler.evaluator().origin()),
            grouped(self.counters.primitive_evaluations),
            grouped(self.counters.points),
            grouped(self.counters.evaluations_pruned),
            self.sampler.evaluator().engine().name(),
            self.total.as_secs_f64() * 1e3,
        )
    }
}
