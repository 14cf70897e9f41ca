//! `jbt eval`: points of a CSV file in, answers out, in the same order.
//!
//! Threads take whole batches, by [`Evaluator::eval`] and not by `par_eval`: so the text of the answers is
//! made in parallel too, and memory stays at one batch a thread.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write as _};

use jbt::tree::{LeafWays, OWNER};
use jbt::{CheckedTree, Evaluator, NodeId, Samples};
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

/// The longest way down to a leaf that is written, in bytes: a chain of a million nodes has a longer one.
const LONGEST_PATH: usize = 1000;

/// What a line says about a point.
struct AnswerTable<'a> {
    evaluator: &'a Evaluator,
    paths: Option<OwnerColumn<'a>>,
}

/// The ways down to the leaves that decide.
struct OwnerColumn<'a> {
    name: &'static str,
    /// The plane with the numbers of leaves.
    plane: Option<usize>,
    ways: LeafWays<'a>,
}

impl<'a> OwnerColumn<'a> {
    fn new(name: &'static str, evaluator: &Evaluator, tree: &'a CheckedTree) -> Self {
        let plane = evaluator.layout().attributes().find(|(group, ..)| *group == OWNER);
        Self { name, plane: plane.map(|(_, plane, _)| plane), ways: LeafWays::new(tree) }
    }

    /// The field of the table for a point: empty where no leaf decides.
    fn at(&self, samples: &Samples, index: usize) -> String {
        let number =
            self.plane.and_then(|plane| samples.planes().get(plane)).map_or(-1.0, |plane| plane[index]);
        // Numbers of nodes are whole in f32.
        let leaf = (number >= 0.0).then_some(NodeId(number as u32));
        quoted(&leaf.and_then(|leaf| self.ways.path(leaf, LONGEST_PATH)).unwrap_or_default())
    }
}

/// Text as a field of CSV (RFC 4180): in quotes where it has a comma, a quote or the end of a line.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

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
    // Owners are numbered by the nodes of the scene, and not of what answers for it.
    let whole =
        arguments.query.text_column().map(|name| scene.check().map(|whole| (name, whole))).transpose()?;
    let answers = AnswerTable {
        evaluator: &evaluator,
        paths: whole.as_ref().map(|(name, whole)| OwnerColumn::new(name, &evaluator, whole)),
    };
    let threads = Threads::new(arguments.threads);
    if is_standard(&arguments.points) {
        return stream(
            &answers,
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
    stream(&answers, points, Some(length), &threads, &destination, quiet)
}

/// Evaluates batches, one on each thread, and writes the answers in the order of the points.
fn stream(
    table: &AnswerTable<'_>,
    mut points: PointReader<impl BufRead>,
    length: Option<u64>,
    threads: &Threads,
    destination: &Destination<TableKind>,
    quiet: bool,
) -> Result<(), Failure> {
    let mut output = Output::open(destination)?;
    let mut progress = ProgressLine::new("evaluating", quiet);
    let names = table.evaluator.layout().names().iter().map(String::as_str);
    let names: Vec<&str> = names.chain(table.paths.as_ref().map(|paths| paths.name)).collect();
    writeln!(output, "x,y,z,{}", names.join(",")).map_err(|error| output.failure(error))?;
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
        let answers: Vec<_> = threads.run(|| batches.par_iter().map(|batch| answers(table, batch)).collect());
        for text in answers {
            output.write_all(&text?).map_err(|error| output.failure(error))?;
        }
        if let Some(length) = length {
            progress.set(points.bytes() as f32 / length.max(1) as f32);
        }
    }
}

/// The lines of some points.
fn answers(table: &AnswerTable<'_>, points: &[[f64; 3]]) -> Result<Vec<u8>, Failure> {
    let evaluator = table.evaluator;
    let mut local = evaluator.points();
    points.iter().for_each(|&point| local.push_world(point));
    let mut samples = evaluator.samples();
    evaluator.eval(&local, &mut samples).map_err(|error| Failure::Defect(error.to_string()))?;
    let mut text = Vec::new();
    let is_far = !evaluator.origin().is_world();
    write(&mut text, (points, is_far), &samples, table.paths.as_ref())
        .map_err(|error| Failure::Defect(error.to_string()))?;
    Ok(text)
}

/// One line for each point. Numbers are the shortest decimals that read back as the same f32; coordinates of
/// a model that is far away, as the same f64.
fn write(
    output: &mut Vec<u8>,
    (points, is_far): (&[[f64; 3]], bool),
    samples: &Samples,
    paths: Option<&OwnerColumn<'_>>,
) -> io::Result<()> {
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
        if let Some(paths) = paths {
            write!(output, ",{}", paths.at(samples, index))?;
        }
        writeln!(output)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_quoted_where_a_table_needs_it() {
        for (text, expected) in [
            ("0.union/1.arm", "0.union/1.arm"),
            ("left arm", "left arm"),
            ("left, big.1/\"x\"", "\"left, big.1/\"\"x\"\"\""),
            ("a\nb", "\"a\nb\""),
            ("", ""),
        ] {
            assert_eq!(quoted(text), expected);
        }
    }
}
