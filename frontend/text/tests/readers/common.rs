//! What tests of readers share: tables of reference values, messages, damaged files.

use std::path::Path;
use std::time::{Duration, Instant};

use jbt_model::diagnostic::{Diagnostics, Severity, Source};
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::walk::{walk, walk_gradient};
use jbt_testkit::scene::{assert_reads_back, compiled, run};
use jbt_text::import::Imported;

/// What a reader may take for a hostile file: a second on a quiet machine, and ten times as long on a
/// loaded one.
pub const SOON: Duration = Duration::from_secs(10);

/// A reader.
pub type Read = fn(&[u8]) -> Result<Imported, Diagnostics>;

/// All messages, with their places.
pub fn messages(bytes: &[u8], diagnostics: &Diagnostics) -> String {
    let source = Source { name: "scene", text: bytes };
    diagnostics.iter().map(|diagnostic| source.render(diagnostic) + "\n").collect()
}

/// What a good file reads as.
#[track_caller]
pub fn good(read: Read, bytes: &[u8]) -> Imported {
    let imported = read(bytes).unwrap_or_else(|errors| panic!("{}", messages(bytes, &errors)));
    imported.model.check().unwrap_or_else(|errors| panic!("{}", messages(bytes, &errors)));
    assert_reads_back(&imported.model);
    imported
}

/// The messages about a bad file.
#[track_caller]
pub fn bad(read: Read, text: &str) -> String {
    let errors = read(text.as_bytes()).expect_err(text);
    messages(text.as_bytes(), &errors)
}

/// The field of a good file at a point, without warnings.
#[track_caller]
pub fn field(read: Read, text: &str, p: [f64; 3]) -> f64 {
    let imported = good(read, text.as_bytes());
    assert_eq!(messages(text.as_bytes(), &imported.warnings), "");
    walk(&imported.model.check().unwrap(), p).field
}

#[track_caller]
pub fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found}, expected {expected}");
}

/// What a table says of a point.
struct Row {
    place: [f64; 3],
    field: f64,
    gradient: [f64; 3],
    color: Option<[f64; 3]>,
}

/// The rows of a table; `colors` names its three columns of linear colours.
fn rows(table: &Path, colors: [&str; 3]) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    let headers = reader.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name);
    let columns = |names: [&str; 3]| {
        let found: Vec<usize> = names.into_iter().filter_map(column).collect();
        <[usize; 3]>::try_from(found).ok()
    };
    let (place, gradient) = (columns(["x", "y", "z"]).unwrap(), columns(["gx", "gy", "gz"]).unwrap());
    let (field, color) = (column("field").unwrap(), columns(colors));
    let row = |record: csv::StringRecord| {
        let at = |column: usize| record[column].parse::<f64>().unwrap();
        Row {
            place: place.map(at),
            field: at(field),
            gradient: gradient.map(at),
            color: color.map(|columns| columns.map(at)),
        }
    };
    reader.records().map(|record| row(record.unwrap())).collect()
}

/// Compares a model with a table, by the oracle and by its compiled program in f32. Where `colored` says so
/// of a row's place, colours are compared. `exact` is how far the oracle may be off, for fields of about 1.
#[track_caller]
pub fn compare(
    model: &Model,
    table: &Path,
    colors: [&str; 3],
    exact: f64,
    colored: &dyn Fn([f64; 3]) -> bool,
) {
    let tree = model.check().unwrap();
    let program = compiled(&tree, Query::ALL);
    let rows = rows(table, colors);
    assert!(rows.len() >= 300, "{} rows", rows.len());
    for Row { place, field, gradient, color } in rows {
        let at = format!("{} at {place:?}", table.display());
        let found = walk(&tree, place);
        let slack = 5e-6 * (1.0 + field.abs());
        assert!(
            (found.field - field).abs() < exact * (1.0 + field.abs()),
            "{at}: {} of {field}",
            found.field
        );
        assert_eq!(found.field >= tree.iso(), field >= tree.iso(), "{at}");
        let steepness = gradient.iter().map(|slope| slope * slope).sum::<f64>().sqrt();
        let steep = 5e-5 * (1.0 + steepness);
        let slopes = walk_gradient(&tree, place, 1e-6);
        assert!(all_near(&slopes, &gradient, steep), "{at}: {slopes:?} of {gradient:?}");
        let answers = run(&program, place);
        assert!((answers[0] - field).abs() <= slack, "{at}: in f32 {} of {field}", answers[0]);
        assert!(all_near(&answers[1..4], &gradient, steep), "{at}: in f32 {answers:?} of {gradient:?}");
        if let Some(color) = color.filter(|color| field > 0.0 && color[0].is_finite() && colored(place)) {
            let mixed = &found.attributes[0];
            assert!(all_near(mixed, &color, 5e-6), "{at}: colour {mixed:?} of {color:?}");
            assert!(all_near(&answers[4..7], &color, 5e-6), "{at}: in f32 {answers:?} of {color:?}");
        }
    }
}

fn all_near(found: &[f64], expected: &[f64], slack: f64) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= slack)
}

/// Whatever a file says, a reader ends soon, and its errors have places.
#[track_caller]
pub fn ends(read: Read, bytes: &[u8]) -> Duration {
    let start = Instant::now();
    match read(bytes) {
        Ok(Imported { model, warnings }) => {
            let _ = messages(bytes, &warnings);
            if let Err(errors) = model.check() {
                let _ = messages(bytes, &errors);
            }
        }
        Err(errors) => {
            let shown = messages(bytes, &errors);
            let located =
                errors.iter().any(|error| error.span.is_some() || error.severity == Severity::Limit);
            assert!(located, "{shown}");
        }
    }
    start.elapsed()
}

/// A file that ends after each twentieth.
#[track_caller]
pub fn truncated(read: Read, bytes: &[u8]) {
    for part in 0..20 {
        let took = ends(read, &bytes[..bytes.len() * part / 20]);
        assert!(took < SOON, "{took:?}");
    }
}

/// The files of a folder of samples that have an ending, by name.
pub fn files(folder: &Path, ending: &str) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|own| own == ending)).collect();
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
}

/// What a file is no model for has a place in the file.
#[track_caller]
pub fn no_model(read: Read, text: &str) -> String {
    let model = read(text.as_bytes()).unwrap_or_else(|errors| panic!("{errors}")).model;
    let errors = model.check().expect_err(text);
    assert!(errors.iter().all(|error| error.span.is_some()), "{errors}");
    messages(text.as_bytes(), &errors)
}
