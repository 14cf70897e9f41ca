//! The sample files against what other programs computed: fields, gradients, colours, temperature factors.

use std::collections::HashMap;
use std::path::Path;

use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_model::particles::Particles;
use jbt_model::walk::{walk, walk_gradient};
use jbt_testkit::samples;
use jbt_text::Options;
use jbt_text::import::SceneFormat;
use jbt_text::import::particles::{ELEMENTS, ElementFacts, ParticleForm, ParticleOptions, element};

/// How far a field, a gradient and an attribute may be off, over one more than they are.
const OFF: [f64; 3] = [5e-6, 5e-5, 5e-6];

fn read(path: &Path, particles: &ParticleOptions) -> Model {
    let name = path.file_name().expect("a file").to_string_lossy().into_owned();
    let bytes = std::fs::read(path).expect("a readable file");
    let options = Options { particles: particles.clone(), ..Options::default() };
    let format = SceneFormat::of(&name, &bytes).expect("a known format");
    assert_ne!(format, SceneFormat::Jbt);
    format.read(&name, &bytes, &options).unwrap_or_else(|error| panic!("{error}")).model
}

/// The particles of a model.
fn particles(tree: &CheckedTree) -> &Particles {
    let NodeKind::Particles(particles) = &tree.node(tree.root()).kind else { panic!("it is one node") };
    particles
}

/// The numbers of a table, by the names of its columns.
fn table(path: &Path) -> (HashMap<String, usize>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    let names = reader.headers().expect("a head").iter().enumerate();
    let names = names.map(|(place, name)| (name.to_owned(), place)).collect();
    let row = |row: csv::StringRecord| row.iter().map(|word| word.parse().expect("a number")).collect();
    (names, reader.records().map(|record| row(record.expect("a row"))).collect())
}

/// Every table of the folder with the file and the form that it is about.
fn tables(folder: &Path) -> Vec<(String, ParticleOptions)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        let Some(stem) = name.strip_suffix(".oracle.csv") else { continue };
        let (form, radius) = match (stem.rsplit_once(".R"), stem.ends_with(".blinn")) {
            (Some((_, support)), _) => (None, Some(support.parse::<f64>().expect("a number") / 2.0)),
            (None, true) => (Some(ParticleForm::Blinn(2.0)), None),
            (None, false) => (None, None),
        };
        found.push((name, ParticleOptions { form, radius, ..ParticleOptions::default() }));
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

/// The file that a table is about.
fn subject(table: &str) -> &str {
    let stem = table.strip_suffix(".oracle.csv").expect("a table");
    let bare = stem.rsplit_once(".R").map(|(file, _)| file);
    bare.or_else(|| stem.strip_suffix(".soft")).or_else(|| stem.strip_suffix(".blinn")).expect("a form")
}

#[test]
fn fields_and_attributes_are_those_of_the_tables() {
    let Some(folder) = samples::folder("particles") else { return };
    let all = tables(&folder);
    assert!(all.len() >= 15, "{} tables", all.len());
    for (name, options) in all {
        let tree = read(&folder.join(subject(&name)), &options).check().expect("a good model");
        let (columns, rows) = table(&folder.join(&name));
        assert!(rows.len() > 50, "{name}");
        let groups: Vec<&str> = tree.attributes().iter().map(|group| &*group.name).collect();
        for row in &rows {
            let of = |names: [&str; 3]| names.map(|name| columns.get(name).map(|&place| row[place]));
            let [Some(x), Some(y), Some(z)] = of(["x", "y", "z"]) else { panic!("{name} has no points") };
            let found = walk(&tree, [x, y, z]);
            let near = |found: f64, expected: f64, off: f64, what: &str| {
                let is_near = (found - expected).abs() <= off * (1.0 + expected.abs());
                assert!(is_near, "{name} ({x} {y} {z}): {what} is {found}, and not {expected}");
            };
            near(found.field, row[columns["field"]], OFF[0], "the field");
            let gradient = walk_gradient(&tree, [x, y, z], 1e-5);
            for (found, expected) in gradient.into_iter().zip(of(["gx", "gy", "gz"]).map(Option::unwrap)) {
                near(found, expected, OFF[1], "a gradient");
            }
            for (channel, expected) in of(["lr", "lg", "lb"]).into_iter().enumerate() {
                if let Some(expected) = expected {
                    near(found.attributes[0][channel], expected, OFF[2], "a colour");
                }
            }
            if let (Some(&place), Some(group)) =
                (columns.get("bfac"), groups.iter().position(|it| *it == "bfac"))
            {
                near(found.attributes[group][0], row[place], OFF[2], "a temperature factor");
            }
        }
    }
}

#[test]
fn atoms_are_counted_as_expected() {
    let Some(folder) = samples::folder("particles") else { return };
    let plain = ParticleOptions::default();
    let counted = |file: &str, options: &ParticleOptions| {
        let tree = read(&folder.join(file), options).check().expect("a good model");
        let all = particles(&tree);
        let mut symbols: HashMap<&str, usize> = HashMap::new();
        for atom in 0..all.len() {
            let same = |facts: &&ElementFacts| (2.0 * facts.radius - all.radius(atom)).abs() < 1e-9;
            // Radii tell these apart.
            for facts in ELEMENTS.iter().filter(same).filter(|it| {
                ["N", "C", "O", "H", "MG", "S"].iter().any(|one| it.symbol.eq_ignore_ascii_case(one))
            }) {
                *symbols.entry(facts.symbol).or_default() += 1;
            }
        }
        let center: Vec<f64> = (0..3)
            .map(|axis| (0..all.len()).map(|i| all.at(i)[axis]).sum::<f64>() / all.len() as f64)
            .collect();
        (all.len(), symbols, center)
    };
    let near = |found: &[f64], expected: [f64; 3]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} {expected:?}");
    };
    let (count, symbols, center) = counted("1A8O.pdb", &plain);
    assert_eq!((count, symbols["N"], symbols["C"], symbols["O"], symbols["S"]), (556, 96, 346, 108, 2));
    near(&center, [18.771525, 35.698245, 16.186777]);
    assert_eq!(counted("1A8O.pdb", &ParticleOptions { waters: true, ..plain.clone() }).0, 556 + 88);
    assert_eq!(read(&folder.join("1A8O.cif"), &plain), read(&folder.join("1A8O.pdb"), &plain));
    assert_eq!(counted("ions.pdb", &plain).1["Mg"], 2);
    let (count, symbols, _) = counted("2n0n_M1.pdb", &plain);
    assert_eq!((count, symbols["N"], symbols["C"], symbols["O"], symbols["H"]), (183, 15, 64, 16, 88));
    let (count, _, center) = counted("disordered.pdb", &plain);
    assert_eq!(count, 47);
    near(&center, [54.321149, 19.87266, 31.572809]);
    near(&counted("h-bn.xyz", &plain).2, [0.625704, -0.36125, 0.0]);
    let sized = ParticleOptions { radius: Some(0.1), ..plain };
    assert_eq!(counted("cube_8_particles.vtk", &sized).0, 8);
    let (count, _, center) = counted("free_particles_125_particles.vtk", &sized);
    assert_eq!(count, 125);
    near(&center, [159.081665, 31.811719, 132.204676]);
}

#[test]
fn elements_are_those_of_the_table() {
    let Some(folder) = samples::folder("particles") else { return };
    let mut reader = csv::Reader::from_path(folder.join("elements.csv")).expect("a table");
    for record in reader.records().map(|record| record.expect("a row")).filter(|record| &record[0] != "0") {
        let facts = ELEMENTS[element(record[1].as_bytes()).expect("an element")];
        assert_eq!(facts, ELEMENTS[record[0].parse::<usize>().expect("a number") - 1]);
        assert_eq!((facts.symbol, Ok(facts.radius)), (&record[1], record[2].parse()));
        let [r, g, b] = facts.color;
        assert_eq!(format!("#{r:02x}{g:02x}{b:02x}"), record[3]);
    }
}
