//! `jbt eval`: points of a CSV file in, answers out, in the same order.
//!
//! Threads take whole batches, by [`Evaluator::eval`] and not by `par_eval`: so the text of the answers is
//! made in parallel too, and memory stays at one batch a thread.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write as _};

use jbt::{Evaluator, Samples};
use rayon::prelude::*;

use crate::arguments::EvalArguments;
use crate::failure::Failure;
use crate::formats::TableKind;
use crate::output::{Destination, Output};
use crate::points::PointReader;
use crate::progress::ProgressLine;
use crate::scene::LoadedScene;
use crate::standard::is_standard;
use crate::threads::Threads;

/// Points that a thread answers at once.
const BATCH: usize = 1 << 14;

/// Runs the command.
pub fn run(arguments: &EvalArguments, quiet: bool) -> Result<(), Failure> {
    if is_standard(&arguments.points) && is_standard(&arguments.scene.path) {
        return Err(Failure::Usage(
            "the scene and the points cannot both come from the standard input".to_owned(),
        ));
    }
    let destination = arguments.output.destination(&arguments.scene.path)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check_for(&arguments.query)?;
    let evaluator = scene.evaluator(&arguments.engine.compiler()?.compile(&tree), arguments.query.query)?;
    let threads = Threads::new(arguments.threads);
    if is_standard(&arguments.points) {
        return stream(
            &evaluator,
            PointReader::new(io::stdin().lock(), "<stdin>".to_owned())?,
            None,
            &threads,
            &destination,
            quiet,
        );
    }
    let name = arguments.points.display().to_string();
    let fail = |error| Failure::io("read", &name, error);
    let file = File::open(&arguments.points).map_err(fail)?;
    let length = file.metadata().map_err(fail)?.len();
    let points = PointReader::new(BufReader::with_capacity(1 << 16, file), name)?;
    stream(&evaluator, points, Some(length), &threads, &destination, quiet)
}

/// Evaluates batches, one on each thread, and writes the answers in the order of the points.
fn stream(
    evaluator: &Evaluator,
    mut points: PointReader<impl BufRead>,
    length: Option<u64>,
    threads: &Threads,
    destination: &Destination<TableKind>,
    quiet: bool,
) -> Result<(), Failure> {
    let mut output = Output::open(destination)?;
    let mut progress = ProgressLine::new("evaluating", quiet);
    let names = evaluator.layout().names().join(",");
    writeln!(output, "x,y,z,{names}").map_err(|error| output.failure(error))?;
    loop {
        let mut batches = Vec::new();
        while batches.len() < threads.count() {
            let batch = points.batch(BATCH)?;
            if batch.is_empty() {
                break;
            }
            batches.push(batch);
        }
        if batches.is_empty() {
            return output.finish();
        }
        let answers: Vec<_> =
            threads.run(|| batches.par_iter().map(|batch| answers(evaluator, batch)).collect());
        for text in answers {
            output.write_all(&text?).map_err(|error| output.failure(error))?;
        }
        if let Some(length) = length {
            progress.set(points.bytes() as f32 / length.max(1) as f32);
        }
    }
}

/// The lines of some points.
fn answers(evaluator: &Evaluator, points: &[[f64; 3]]) -> Result<Vec<u8>, Failure> {
    let mut local = evaluator.points();
    points.iter().for_each(|&point| local.push_world(point));
    let mut samples = evaluator.samples();
    evaluator.eval(&local, &mut samples).map_err(|error| Failure::Defect(error.to_string()))?;
    let mut text = Vec::new();
    let is_far = !evaluator.origin().is_world();
    write(&mut text, (points, is_far), &samples).map_err(|error| Failure::Defect(error.to_string()))?;
    Ok(text)
}

/// One line for each point. Numbers are the shortest decimals that read back as the same f32; coordinates of
/// a model that is far away, as the same f64.
fn write(output: &mut Vec<u8>, (points, is_far): (&[[f64; 3]], bool), samples: &Samples) -> io::Result<()> {
    for (index, &[x, y, z]) in points.iter().enumerate() {
        if is_far {
            write!(output, "{x},{y},{z}")?;
        } else {
            let [x, y, z] = [x, y, z].map(|x| x as f32);
            write!(output, "{x},{y},{z}")?;
        }
        for plane in samples.planes() {
            write!(output, ",{}", plane[index])?;
        }
        writeln!(output)?;
    }
    Ok(())
}
