//! Particles in texts: what is read, what is printed, and what is wrong.

use jbt::build::particles;
use jbt_model::particles::NumberArray;
use jbt_model::written::Written;
use jbt_testkit::scene::{assert_reads_back, model as read};

use crate::scenes::{model, scenes};

#[test]
fn every_scene_reads_back() {
    for (_, tree) in scenes() {
        assert_reads_back(&model(tree));
    }
}

#[test]
fn a_number_stands_for_all_and_a_list_for_each() {
    let scene = read("attribute radius 1  attribute heat 1
        particles { at ((0 0 0), (1 2 3)) radius (0.5 2 * 3) strength 2 color \"#f00\" with radius 4 heat (1 -2) }");
    let Written::Particles(found) = scene.root.node().written() else { panic!("it is a node of particles") };
    let expected = particles([[0.0; 3], [1.0, 2.0, 3.0]], vec![0.5, 6.0])
        .strength(2.0)
        .values("color", 3, [1.0, 0.0, 0.0])
        .values("radius", 1, [4.0])
        .values("heat", 1, [1.0, -2.0]);
    assert_eq!(Written::Particles(found.clone()), *expected.node().written());
    assert_reads_back(&scene);
}

#[test]
fn what_is_wrong_has_its_place() {
    for (text, message, place) in [
        ("particles { radius 1 }", "`particles` needs `at`", 0),
        ("particles { at ((0 0 0)) }", "`particles` needs `radius`", 0),
        (
            "particles { at ((0 0 0)) radius 1 surface_radius 1 }",
            "`surface_radius` and `radius` of one node",
            0,
        ),
        ("particles { at (0 0 0) radius 1 }", "numbers where positions should be", 15),
        ("particles { at ((0 0 0) (1 2)) radius 1 }", "2 numbers", 24),
        ("particles { at ((0 0 0) 1) radius 1 }", "unexpected `1`", 24),
        ("particles { at ((0 0 0) (1 2 3) radius 1 }", "this `(` is not closed", 15),
        ("particles { at () radius 1 }", "there are no particles", 0),
        ("particles { at ((0 0 0)) radius (1 2) }", "1 particles have 2 radii", 0),
        ("particles { at ((0 0 0)) radius 1 strength (1 2 3) }", "1 particles have 3 strengths", 0),
        ("particles { at ((0 0 0) (0 0 0)) radius 1 color (1 2) }", "2 numbers", 48),
        (
            "particles { at ((0 0 0) (0 0 0)) radius 1 color ((1 2 3) (4 5 6) (7 8 9)) }",
            "2 particles have 9 numbers of `color`",
            0,
        ),
        ("particles { at ((0 0 0)) radius 1 size 3 }", "`particles` has no parameter `size`", 34),
        ("particles { at ((0 0 0)) at ((0 0 0)) radius 1 }", "a second `at`", 25),
        ("attribute heat 1 particles { at ((0 0 0)) radius 1 heat 1 heat 2 }", "a second `heat`", 58),
        (
            "param p = 1 particles { at ((0 0 p)) radius 1 }",
            "a number of particles depends on a parameter",
            33,
        ),
        (
            "particles { at ((0 0 0) (0 1e16 0)) radius 1 }",
            "the position of particle 1 is (0 10000000000000000 0)",
            0,
        ),
        ("particles { at ((0 0 0) (0 1 0)) radius (1 0) }", "the radius of particle 1 is 0", 0),
        (
            "particles { at ((0 0 0) (0 1 0)) surface_radius (1 -1) }",
            "of particle 1: the surface radius is -1",
            0,
        ),
        (
            "particles { at ((0 0 0) (0 1 0)) surface_radius 1 strength (1 0.25) }",
            "of particle 1: with strength 0.25 the primitive has no surface at iso 0.5",
            0,
        ),
        ("particles { at ((0 0 0)) radius 1", "this `{` is not closed", 10),
    ] {
        let text = format!("jbt 1\n{text}");
        let errors = match jbt::text::parse(text.as_bytes(), &jbt::text::Options::default()) {
            Ok(model) => model.check().expect_err(&text),
            Err(errors) => errors,
        };
        assert_eq!(errors[0].message, message, "{text}\n{errors}");
        assert_eq!(errors[0].span.map(|span| span.start), Some(place + 6), "{text}\n{errors}");
    }
}

#[test]
fn arrays_of_other_lengths_and_values_are_errors() {
    let error = |tree: jbt::Tree| model(tree).check().unwrap_err()[0].message.clone();
    let two = || particles([[0.0_f32; 3], [1.0; 3]], 1.0);
    assert_eq!(error(particles(vec![0.0_f32; 4], 1.0)), "the positions of particles are 4 numbers");
    assert_eq!(error(two().strengths([1.0_f32])), "2 particles have 1 strengths");
    assert_eq!(error(two().colors([1.0_f32; 4])), "2 particles have 4 numbers of `color`");
    assert_eq!(error(two().values("heat", 2, [1.0_f32; 4])), "the attribute `heat` has width 1, not 2");
    assert_eq!(error(two().values("cold", 1, [1.0_f32; 2])), "there is no attribute `cold`");
    assert_eq!(
        error(particles([[0.0_f32; 3], [0.0, f32::NAN, 0.0]], 1.0)),
        "the position of particle 1 is (0 NaN 0)"
    );
    assert_eq!(error(two().strengths([1.0, f64::INFINITY])), "the strength of particle 1 is inf");
    assert_eq!(
        error(two().values("heat", 1, [1.0_f32, f32::NAN])),
        "the attribute `heat` of particle 1 is NaN"
    );
    let repeated =
        (0..5).fold(particles(NumberArray::from(vec![0.0_f32; 3 << 18]), 1.0), |tree, _| &tree + &tree);
    assert!(error(repeated).starts_with("unfolded, the tree has 8126"), "used again, particles are budgeted");
}
