//! BRL-CAD databases: every published sample against points that other programs have judged, every solid
//! against its own inequality, and what strangers send.
//!
//! The samples are those of the folder `brlcad`, see `jbt_testkit::samples`.

use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::Options;
use jbt_text::import::{Imported, brlcad};

fn of(object: &str) -> Options {
    Options { object: Some(object.to_owned()), ..Options::default() }
}

fn read(bytes: &[u8], options: &Options) -> Imported {
    brlcad(bytes, options).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn every_sample_agrees_with_its_oracle() {
    let Some(folder) = samples::folder("brlcad") else { return };
    let mut tables = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Some(stem) = name.strip_suffix(".oracle.csv") else { continue };
        let (file, object) = table_of(stem);
        let bytes = std::fs::read(folder.join(file)).unwrap();
        let scene = read(&bytes, &of(object));
        assert_eq!(scene.warnings.to_string(), "", "{name}");
        assert_reads_back(&scene.model);
        let tree = scene.model.check().unwrap_or_else(|errors| panic!("{name}: {errors}"));
        let (mut rows, mut wrong) = (0, Vec::new());
        for row in csv::Reader::from_path(&path).unwrap().deserialize() {
            let [x, y, z, inside, _, _, _, _, r, g, b]: [f64; 11] = row.unwrap();
            let found = walk(&tree, [x, y, z]);
            let is_inside = found.field >= 0.5;
            if is_inside != (inside == 1.0) {
                wrong.push(format!("{x} {y} {z}: field {}, inside {inside}", found.field));
            }
            if is_inside && !r.is_nan() {
                let color = &found.attributes[0];
                let off = [r, g, b].iter().zip(color).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                if off > 1e-9 {
                    wrong.push(format!("{x} {y} {z}: colour {color:?}, expected {r} {g} {b}"));
                }
            }
            rows += 1;
        }
        assert!(wrong.is_empty(), "{name}: {} of {rows} rows, {}", wrong.len(), wrong[..wrong.len().min(5)].join("\n"));
        assert!(rows >= 300, "{name}");
        tables += 1;
    }
    assert_eq!(tables, 18);
}

/// The file and the object of a table.
fn table_of(stem: &str) -> (&str, &str) {
    let ends = ["aet.asc", "moss.asc"];
    if let Some(file) = ends.iter().find(|file| stem.starts_with(**file)) {
        return (file, &stem[file.len() + 1..]);
    }
    let (file, object) = stem.split_once('.').unwrap();
    let file = FILES.iter().find(|name| name.split('.').next() == Some(file)).unwrap();
    (file, object)
}

/// The files that tables are named by.
const FILES: [&str; 15] = [
    "aet.asc", "arbs.g", "axis.asc", "bishop.asc", "boolean-ops.asc", "cup.g", "die.asc", "half_subtracts.g",
    "hilbert_3d.g", "matrix_tests.g", "moss_1.g", "operators.asc", "rook.g", "rounds.asc", "moss.asc",
];
