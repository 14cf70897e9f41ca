//! Scenes of tests: models from text, their programs, how many of them to try.

use std::borrow::Borrow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use jbt_ir::domain::scalar::Scalar;
use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{Tables, Verified, interpret, verify};
use jbt_lower::{Lowered, lower};
use jbt_model::check::CheckedTree;
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_text::files::{FileRequest, Files, NamedFile, ResolveError, Resolver};
use jbt_text::{Options, parse, print};

/// The model of a text, which needs no first line. Panics with the text and its errors, if it does not read.
#[must_use]
pub fn model(text: &str) -> Model {
    let head = if text.contains("jbt 1") { "" } else { "jbt 1\n" };
    let text = format!("{head}{text}");
    parse(text.as_bytes(), &options()).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

/// Every operator of several children, as text before the brace; of some the numbers that make a difference.
pub const OPERATORS: [&str; 14] = [
    "sum",
    "product",
    "union",
    "intersection",
    "difference",
    "symmetric_difference",
    "blend ricci 3",
    "blend ricci -2",
    "smooth_union width 0.3",
    "smooth_intersection width 0.3",
    "smooth_difference width 0.3",
    "rfunction union",
    "rfunction intersection alpha 0.5",
    "rfunction difference",
];

/// Reads files below the folder of the examples.
struct ExampleFiles;

impl Resolver for ExampleFiles {
    fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        let path = request.joined();
        let bytes = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(&path))?;
        Ok(NamedFile { identity: path.clone(), path, bytes })
    }
}

/// How a test reads scenes: files that they include are those beside the examples.
#[must_use]
pub fn options() -> Options {
    Options { files: Files::new(Arc::new(ExampleFiles)), ..Options::default() }
}

/// The checked [`model`] of a text. Panics with the text and its errors, if it is no good model.
#[must_use]
pub fn tree(text: &str) -> CheckedTree {
    model(text).check().unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

/// A tree of the builder, checked. Panics with its errors.
#[must_use]
pub fn checked(tree: impl Borrow<Tree>) -> CheckedTree {
    Model::new(tree.borrow().clone()).check().unwrap_or_else(|errors| panic!("{errors:?}"))
}

/// What is printed of a model, read again. Panics unless it is the same model.
#[track_caller]
pub fn assert_reads_back(written: &Model) -> Model {
    let text = print(written);
    let read = model(&text);
    assert_eq!(read, *written, "{text}");
    read
}

/// The example scenes of the project: names of files and texts, by name.
#[must_use]
pub fn examples() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let entries = std::fs::read_dir(folder).expect("the project has examples");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "jbt"));
    paths.sort();
    assert!(paths.len() >= 28, "{} examples", paths.len());
    let read = |path: PathBuf| {
        let name = path.file_name().expect("a file").to_string_lossy().into_owned();
        (name, std::fs::read_to_string(path).expect("a readable text"))
    };
    paths.into_iter().map(read).collect()
}

/// The program of a model for a query, after all passes, with its numbers.
#[must_use]
pub fn compiled(tree: &CheckedTree, query: Query) -> (Verified, Tables) {
    let Lowered { function, tables } = lower(tree, query).expect("it can be lowered");
    let passes = query.passes().chain(PIPELINE);
    (verify(run_pipeline(function, passes, &mut |_, _| {})).expect("passes keep the rules"), tables)
}

/// What a [`compiled`] program answers at a point, by the reference.
#[must_use]
pub fn run((program, tables): &(Verified, Tables), point: [f64; 3]) -> Vec<f64> {
    let answers = interpret::run(program, tables, &mut Scalar, &point.map(|x| x as f32));
    answers.into_iter().map(f64::from).collect()
}

/// How many cases to try: what this environment variable says, or the default.
#[must_use]
pub fn count(variable: &str, default: u64) -> u64 {
    std::env::var(variable).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}
