//! BRL-CAD databases against points that other programs have judged: on every engine, the side of each point
//! exactly, and its colour.

mod common;

use common::answers;
use jbt::text::Options;
use jbt::{Compiler, Engine, Points, Query};
use jbt_testkit::samples;
use jbt_text::import;

/// How far a colour may be off.
const COLOR: f64 = 5e-6;

#[test]
fn every_object_is_the_set_that_others_found() {
    let Some(folder) = samples::folder("brlcad") else { return };
    let file = |name: &str| folder.join(name);
    let mut files: Vec<String> = Vec::new();
    let mut tables: Vec<String> = Vec::new();
    for entry in std::fs::read_dir(&folder).expect("a readable folder") {
        let name = entry.expect("a readable folder").file_name().to_string_lossy().into_owned();
        match name.strip_suffix(".oracle.csv") {
            Some(stem) => tables.push(stem.to_owned()),
            None => files.push(name),
        }
    }
    for table in &tables {
        // A table is called like the file, with its ending where two files share the name, and the object.
        let mut found = files.iter().filter_map(|name| {
            let (stem, _) = name.rsplit_once('.')?;
            let object = |head: &str| table.strip_prefix(head)?.strip_prefix('.').map(str::to_owned);
            Some((name, object(name).or_else(|| object(stem))?))
        });
        let (name, object) = found.find(|(name, object)| reads(&file(name), object)).expect("a file for it");
        let bytes = std::fs::read(file(name)).expect("a readable file");
        let options = Options { object: Some(object), ..Options::default() };
        let tree =
            import::brlcad(&bytes, &options).expect("a good file").model.check().expect("a good model");
        let mut reader = csv::Reader::from_path(file(&format!("{table}.oracle.csv"))).expect("a table");
        let rows: Vec<[f64; 11]> = reader.deserialize().map(|row| row.expect("a row")).collect();
        let points: Points = rows.iter().map(|row| [row[0] as f32, row[1] as f32, row[2] as f32]).collect();
        for engine in Engine::ALL {
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::ALL).expect("it compiles");
            let samples = answers(&evaluator, &points);
            let color = samples.attribute("color").expect("asked for");
            for (index, row) in rows.iter().enumerate() {
                let place = format!("{table} at {:?}, {}", &row[..3], engine.name());
                let field = samples.field()[index];
                assert_eq!(field >= 0.5, row[3] == 1.0, "{place}: field {field}");
                for channel in 0..3 {
                    let expected = row[8 + channel];
                    let off = (f64::from(color[channel][index]) - expected).abs();
                    assert!(
                        row[3] == 0.0 || expected.is_nan() || off < COLOR,
                        "{place}: colour off by {off}"
                    );
                }
            }
        }
    }
    assert_eq!(tables.len(), 18);
}

/// Whether a file has an object of this name.
fn reads(path: &std::path::Path, object: &str) -> bool {
    let options = Options { object: Some(object.to_owned()), ..Options::default() };
    import::brlcad(&std::fs::read(path).expect("a readable file"), &options).is_ok()
}
