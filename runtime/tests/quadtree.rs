//! The example with the quadtrees: its figures are the published ones.

#[path = "../examples/quadtree/circles.rs"]
mod circles;
#[path = "../examples/quadtree/divided.rs"]
mod divided;
#[path = "../examples/quadtree/lattice.rs"]
mod lattice;
#[path = "../examples/quadtree/picture.rs"]
mod picture;
#[path = "../examples/quadtree/published.rs"]
mod published;

use circles::{CIRCLES, Circle, ISO};
use jbt::{Compiler, Engine};
use jbt_testkit::samples;
use lattice::Block;
use picture::{Panel, svg};

#[test]
fn the_published_algorithm_has_its_published_counts() {
    let found = published::run(&CIRCLES);
    assert_eq!(found.lookups, 26_612);
    assert_eq!(found.reused(), 19_731);
    assert_eq!(found.evaluated, 6_881);
    assert_eq!(found.circle_evaluations, 137_620);
    assert_eq!(found.leaves().count(), 1_532);
    assert_eq!(found.created, 3_302);
    assert_eq!(found.nodes.len(), 3_049);
    assert_eq!(found.depth(), 8);
    assert_eq!(found.missed, [[80, 57], [81, 57]]);
}

#[test]
fn a_scene_without_circles_is_a_root() {
    let found = published::run(&[]);
    assert_eq!((found.nodes.len(), found.created, found.lookups), (1, 0, 16));
}

#[test]
fn ranges_miss_nothing_and_cost_less() {
    // The best engine of this machine, and the reference.
    for compiler in [Compiler::new(), Compiler::for_engine(Engine::Scalar)] {
        let found = divided::run(&compiler, &CIRCLES).expect("a scene of points");
        assert_eq!(found.found.len(), 1_534);
        assert_eq!(found.missed, [[0; 2]; 0]);
        assert_eq!(found.evaluated, 3_507);
        assert_eq!(found.circle_evaluations, 6_719);
        assert_eq!(found.ranges, 7_468);
        assert_eq!(found.interval_evaluations, 15_390);
        assert_eq!(found.leaves, 1_991);
        assert_eq!((found.decided, found.depth), (11_329, 16));
        let cells: u32 = found.blocks.iter().map(|block| block.sides[0] * block.sides[1]).sum();
        assert_eq!(cells, lattice::CELLS * lattice::CELLS);
    }
}

#[test]
fn a_scene_that_is_no_model_is_an_error() {
    let nowhere = Circle { radius: 0.0, center: [0.0; 2] };
    let error = divided::run(&Compiler::new(), &[nowhere]).err().expect("a radius of 0").to_string();
    assert!(error.contains("radius"), "{error}");
}

#[test]
fn the_samples_agree() {
    let Some(folder) = samples::folder("quadtree") else { return };
    let mut reader = csv::Reader::from_path(folder.join("circles_seed1.csv")).expect("a table of circles");
    let rows: Vec<[f64; 5]> = reader.deserialize().collect::<Result<_, _>>().expect("five numbers a row");
    let circles: Vec<Circle> =
        rows.iter().map(|&[_, radius, x, _, z]| Circle { radius, center: [x, z] }).collect();
    assert!(rows.iter().all(|row| row[0] == 1.0 && row[3] == 0.0));
    assert_eq!(circles, CIRCLES);

    let text = std::fs::read_to_string(folder.join("expected.json")).expect("the expected counts");
    let expected: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let found = published::run(&CIRCLES);
    let count = |name: &str| expected[name].as_u64().unwrap_or_else(|| panic!("a count of {name}"));
    assert_eq!(expected["iso"].as_f64(), Some(ISO));
    assert_eq!(found.reused(), count("vert_hits"));
    assert_eq!(found.evaluated, count("vert_misses"));
    assert_eq!(found.lookups, count("total"));
    assert_eq!(found.created as u64, count("nodes_created_excl_root"));
    assert_eq!(found.leaves().count() as u64, count("leaves"));
    assert_eq!(found.nodes.len() as u64, count("nodes_after_prune_incl_root (\"Wrote N polygons\")"));
    assert_eq!(u64::from(found.depth()), count("max_depth"));
    let crossing = (found.leaves().count() + found.missed.len()) as u64;
    assert_eq!(crossing, count("uniform_256_grid_crossing_cells"));
    assert_eq!(serde_json::json!(found.missed), expected["missed_cells_ij"]);
}

#[test]
fn the_picture_is_small() {
    let panel = || Panel { blocks: Block::WHOLE.quarters().to_vec(), cells: vec![[80, 57]] };
    let text = svg(&CIRCLES, &[panel(), panel()]);
    assert_eq!(text.matches("<circle").count(), 2 * CIRCLES.len());
    assert_eq!(text.matches("M0 128h128v128h-128z").count(), 2);
    assert_eq!(text.matches("<svg").count(), text.matches("</svg>").count());
    assert!(text.len() < 10_000);
}
