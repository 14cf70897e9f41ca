//! Particles have the programs and the rows of the points that they mean, and errors that name them.

use fastrand::Rng;
use jbt_ir::Rows;
use jbt_ir::limits::MAX_ERRORS;
use jbt_lower::{Lowered, lower};
use jbt_model::attribute::{AttributeGroup, Mixing};
use jbt_model::builder::{param, particles, point};
use jbt_model::check::CheckedTree;
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_testkit::scene::{checked, tree};

/// Coloured particles of different sizes.
fn cloud(seed: u64, count: usize) -> Tree {
    let mut rng = Rng::with_seed(seed);
    let at: Vec<[f32; 3]> = (0..count).map(|_| std::array::from_fn(|_| 2.0 * rng.f32() - 1.0)).collect();
    let radius: Vec<f32> = (0..count).map(|_| 0.2 + 0.5 * rng.f32()).collect();
    particles(at, radius).colors((0..3 * count).map(|_| rng.f32()).collect::<Vec<f32>>())
}

/// A cloud of these strengths, again and again.
fn signed(count: usize, strengths: &[f64]) -> Tree {
    cloud(3, count)
        .strengths((0..count).map(|index| strengths[index % strengths.len()]).collect::<Vec<f64>>())
}

#[track_caller]
fn assert_same_rows(name: &str, [a, b]: [&Lowered; 2]) {
    assert_eq!(a.function, b.function, "{name}");
    for (a, b) in a.tables.tables.values().zip(b.tables.tables.values()) {
        let shape = |rows: &Rows| (rows.count, rows.stride, rows.nodes.len());
        assert_eq!(shape(a), shape(b), "{name}");
        assert_eq!((&a.active, &a.starts), (&b.active, &b.starts), "{name}");
        let bits = |rows: &Rows| rows.numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert!(bits(a) == bits(b), "{name}: other numbers");
    }
}

/// The model and that of points, with a group more: a number of the leaf whose field is the largest.
fn twins(written: &Tree) -> [CheckedTree; 2] {
    let heat = AttributeGroup {
        name: "heat".into(),
        default: vec![0.25],
        mixing: Mixing::Dominant,
        ..AttributeGroup::color()
    };
    [written.clone(), written.as_points()].map(|tree| {
        let mut model = Model::new(tree);
        model.attributes.push(heat.clone());
        model.check().expect("a good model")
    })
}

#[test]
fn programs_and_rows_are_those_of_points() {
    let scenes = [
        ("alone", cloud(1, 30)),
        ("one", cloud(2, 1)),
        ("of one strength", cloud(4, 9).strength(0.5)),
        ("of strengths", signed(9, &[0.5, 2.0])),
        ("of strength 1 at last", signed(9, &[0.5, -0.75, 1.0])),
        ("of strength 1 at first", signed(10, &[1.0, 1.0, 0.5])),
        ("beside points", Tree::sum([point([0.0; 3], 0.5), signed(8, &[1.0, 0.5]), point([0.3; 3], 0.6)])),
        ("of groups, of which one dominates", {
            let heat = |count: usize| (0..count).map(|index| index as f32).collect::<Vec<f32>>();
            let hot = signed(8, &[1.0, 0.5]).values("heat", 1, heat(8));
            Tree::sum([point([0.0; 3], 0.7).attribute("heat", &[9.0]), hot, point([0.3; 3], 0.6)])
        }),
        ("of a union", signed(8, &[1.0, 0.5]) | point([0.3; 3], 0.6) | cloud(5, 4)),
        ("moved", signed(7, &[1.0, 0.5]).rotate([1, 0, 0], 30.0).scale(0.8).translate([0.1, 0.2, 0.3])),
        ("skewed", cloud(6, 7).scale_axes([0.5, 1.0, 1.5])),
        ("that depend on a parameter", cloud(7, 5).strength(param("power", 1.0))),
    ];
    for (name, written) in scenes {
        let twins = twins(&written);
        for query in Query::EVERY {
            let [a, b] = twins.each_ref().map(|tree| lower(tree, query).expect("it lowers"));
            assert_same_rows(name, [&a, &b]);
        }
    }
}

#[test]
fn rows_of_many_particles_are_those_of_points() {
    // More than one worker writes at a time.
    let [a, b] =
        twins(&signed(40_000, &[1.0, 0.5, 0.25])).map(|tree| lower(&tree, Query::FIELD).expect("it lowers"));
    assert_same_rows("many", [&a, &b]);
}

#[test]
fn numbers_that_leave_f32_are_those_of_a_particle() {
    let text = "scale 1e-10 { particles { at ((0 0 0) (1 0 0) (2 0 0) (3 0 0)) radius (1 1e-15 1e-15 1) } }";
    let errors = lower(&tree(text), Query::FIELD).expect_err("1e50 is none in f32");
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(
        errors[0].message.contains("a number derived from particle 1 leaves the range of f32: -9.99"),
        "{errors:?}"
    );
    let speck = |x: usize| point([x as f64, 0.0, 0.0], 1e-15).scale(1e-10);
    let errors =
        lower(&checked(Tree::sum((0..2 * MAX_ERRORS).map(speck))), Query::FIELD).expect_err("nor here");
    assert_eq!(errors.len(), MAX_ERRORS);
    assert!(errors[0].message.contains("a number derived from this part leaves"), "{errors:?}");
}
