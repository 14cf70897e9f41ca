//! ParsIP scenes against values that a separate f64 program computed: on every engine, for field, gradient
//! and colour.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use common::answers;
use jbt::{Compiler, Engine, Points, Query};
use jbt_testkit::samples;
use jbt_text::import;

/// Field absolute, gradient relative to `1 + |g|`, colour absolute.
const FIELD: f64 = 2e-5;
const GRADIENT: f64 = 5e-4;
const COLOR: f64 = 1e-3;

/// The rows of a table: x, y, z, field, r, g, b, gx, gy, gz.
fn oracle(path: &std::path::Path) -> Vec<[f64; 10]> {
    let mut reader = csv::Reader::from_path(path).expect("a readable table");
    let header: Vec<_> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    assert_eq!(header, ["x", "y", "z", "field", "r", "g", "b", "gx", "gy", "gz"]);
    reader
        .records()
        .map(|record| {
            let record = record.expect("a row");
            std::array::from_fn(|column| record[column].parse().expect("a number"))
        })
        .collect()
}

#[test]
fn every_scene_has_the_values_that_others_computed() {
    let Some(folder) = samples::folder("parsip") else { return };
    let mut scenes = 0;
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        let is_scene = path.extension().is_some_and(|extension| extension == "blob" || extension == "scene");
        if !is_scene {
            continue;
        }
        scenes += 1;
        let name = path.file_name().expect("a file").to_string_lossy().into_owned();
        let imported =
            import::parsip(&std::fs::read(&path).expect("a readable scene")).expect("a good scene");
        let tree = imported.model.check().expect("a good model");
        let rows = oracle(&path.with_extension("oracle.csv"));
        let points: Points = rows.iter().map(|row| [row[0] as f32, row[1] as f32, row[2] as f32]).collect();
        for engine in Engine::ALL {
            let evaluator =
                Compiler::for_engine(engine).evaluator(&tree, Query::ALL).expect("the scene compiles");
            let samples = answers(&evaluator, &points);
            let gradient = samples.gradient().expect("asked for");
            let color = samples.attribute("color").expect("asked for");
            let mut worst = [0.0f64; 3];
            for (index, row) in rows.iter().enumerate() {
                let steep = 1.0 + row[7..].iter().map(|g| g * g).sum::<f64>().sqrt();
                worst[0] = worst[0].max((f64::from(samples.field()[index]) - row[3]).abs());
                for axis in 0..3 {
                    worst[1] = worst[1].max((f64::from(gradient[axis][index]) - row[7 + axis]).abs() / steep);
                    worst[2] = worst[2].max((f64::from(color[axis][index]) - row[4 + axis]).abs());
                }
            }
            println!(
                "{name:28} {:7} {:5} rows: field {:.1e}, gradient {:.1e}, colour {:.1e}",
                engine.name(),
                rows.len(),
                worst[0],
                worst[1],
                worst[2]
            );
            assert!(
                worst[0] <= FIELD && worst[1] <= GRADIENT && worst[2] <= COLOR,
                "{name}, {}: {worst:?}",
                engine.name()
            );
        }
    }
    assert_eq!(scenes, 11, "all scenes are there");
}
