//! Every skeleton as the program of a primitive: its gradient, its silence, and its numbers as parameters.

use fastrand::Rng;
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::{Tables, Verified, interpret};
use jbt_lower::lower;
use jbt_model::check::CheckedTree;
use jbt_model::falloff::Falloff;
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::skeleton::SkeletonKind;
use jbt_model::tree::Tree;
use jbt_model::walk::{walk, walk_gradient};
use jbt_testkit::random::Random;
use jbt_testkit::scene::{compiled, tree};

/// The field and the gradient.
fn run((program, tables): &(Verified, Tables), point: [f32; 3]) -> [f32; 4] {
    let answers = interpret::run(program, tables, &mut Scalar, &point);
    answers.try_into().expect("a field and a gradient")
}

/// A primitive of this kind.
fn primitive(kind: SkeletonKind, random: &mut Random, rng: &mut Rng) -> CheckedTree {
    // Smooth ones: differences are to see the skeleton.
    let falloff = if rng.bool() { Falloff::Soft } else { Falloff::Wyvill };
    let skeleton = random.skeleton(kind);
    let leaf = Primitive { skeleton, falloff, radius: 0.5 + rng.f64(), strength: 1.0 };
    Model::new(Tree::new(NodeKind::Primitive(leaf), Vec::new())).check().expect("its numbers are ordinary")
}

#[test]
fn gradients_are_those_of_plain_formulas() {
    for &kind in SkeletonKind::ALL {
        let (mut random, mut rng, mut compared) = (Random::new(1, 1), Rng::with_seed(1), 0);
        for _ in 0..60 {
            let tree = primitive(kind, &mut random, &mut rng);
            let program = compiled(&tree, Query::GRADIENT);
            for _ in 0..60 {
                let p = random.vector(1.5).map(|x| x as f32);
                let [field, gradient @ ..] = run(&program, p);
                let at = p.map(f64::from);
                let sample = walk(&tree, at);
                assert!((f64::from(field) - sample.field).abs() < 2e-5, "{} at {p:?}: {field}", kind.name());
                if sample.kink_distance < 1e-3 || sample.field == 0.0 {
                    continue;
                }
                compared += 1;
                for (found, expected) in gradient.iter().zip(walk_gradient(&tree, at, 1e-6)) {
                    let off = (f64::from(*found) - expected).abs();
                    assert!(
                        off < 1e-3 * (1.0 + expected.abs()),
                        "{} at {p:?}: {found}, not {expected}",
                        kind.name()
                    );
                }
            }
        }
        assert!(compared > 200, "{}: {compared} points", kind.name());
    }
}

/// At axes, planes, corners and middles, where something is zero or several points are nearest.
#[test]
fn gradients_are_finite_where_a_skeleton_is_singular() {
    let models = [
        "sphere { sphere_radius 1 radius 1 }",
        "sphere { sphere_radius 0 radius 1 }",
        "torus { ring_radius 1 tube_radius 0.5 radius 1 }",
        "torus { ring_radius 0 tube_radius 0 radius 1 }",
        "cone { from (0 0 -1) to (0 0 1) from_radius 1 radius 1 }",
        "cone { from (0 0 0) to (0 0 0) from_radius 1 radius 1 }",
        "cone { from (0 0 0) to (0 0 0) from_radius 0 radius 1 }",
        "round_cone { from (0 0 -1) to (0 0 1) from_radius 1 to_radius 0 radius 1 }",
        "round_cone { from (0 0 -1) to (0 0 1) from_radius 2 to_radius 0 radius 1 }",
        "round_cone { from (0 0 0) to (0 0 0) from_radius 0 to_radius 0 radius 1 }",
        "rectangle { half_length 1 half_width 0.5 radius 1 }",
        "arc { degrees 0 arc_radius 1 radius 2 }",
        "arc { degrees 180 arc_radius 1 radius 2 }",
        "arc { degrees 360 arc_radius 1 radius 2 }",
        "helix { helix_radius 1 pitch 1 turns 2 radius 1 }",
        "helix { helix_radius 1 pitch -0.01 turns 0.5 radius 1 }",
        "helix { helix_radius 0 pitch 1 turns 2 radius 1 }",
        "helix { helix_radius 1 pitch 1 turns 0 radius 1 }",
        "half_space { radius 1 }",
        "ellipsoid { stretch (1 2 0.5) radius 1 }",
        "lmetric { exponent 1 radius 2 }",
        "lmetric { exponent 1.25 radius 2 }",
        "lmetric { exponent 2 radius 2 }",
        "lmetric { exponent 1024 radius 2 }",
        "superquadric { e1 2 e2 2 radius 2 }",
        "superquadric { e1 1.5 e2 0.01 radius 2 }",
        "superquadric { e1 0.01 e2 1.5 radius 2 }",
    ];
    let ticks = [-2.0, -1.0, -0.5, -1e-20, -0.0, 0.0, 1e-38, 1e-45, 1e-7, 0.5, 1.0, 1.5];
    for model in models {
        let tree = tree(&format!("jbt 1 {model}"));
        let program = compiled(&tree, Query::GRADIENT);
        for index in 0..ticks.len().pow(3) {
            let p = [0, 1, 2].map(|axis| ticks[index / ticks.len().pow(axis) % ticks.len()]);
            let [field, gradient @ ..] = run(&program, p);
            let expected = walk(&tree, p.map(f64::from)).field;
            assert!((f64::from(field) - expected).abs() < 1e-5, "{model} at {p:?}: {field}, not {expected}");
            assert!(gradient.iter().all(|g| g.abs() < 10.0), "{model} at {p:?}: {gradient:?}");
        }
    }
}

#[test]
fn fields_are_exactly_zero_from_the_radius_on() {
    for &kind in SkeletonKind::ALL {
        let (mut random, mut rng, mut beyond) = (Random::new(2, 2), Rng::with_seed(2), 0);
        for _ in 0..60 {
            let tree = primitive(kind, &mut random, &mut rng);
            let NodeKind::Primitive(leaf) = &tree.node(tree.root()).kind else {
                unreachable!("it is a leaf")
            };
            let program = compiled(&tree, Query::GRADIENT);
            for _ in 0..60 {
                let p = random.vector(4.0).map(|x| x as f32);
                let distance = leaf.skeleton.distance_squared(p.map(f64::from).into()).sqrt();
                let [field, gradient @ ..] = run(&program, p);
                if distance >= leaf.radius * (1.0 + 1e-5) {
                    beyond += 1;
                    assert_eq!(field.to_bits(), 0, "{} at {p:?}", kind.name());
                    assert!(gradient.iter().all(|&g| g == 0.0), "{} at {p:?}: {gradient:?}", kind.name());
                } else if leaf.falloff.value((distance / leaf.radius).powi(2)) > 1e-6 {
                    assert!(field > 0.0, "{} at {p:?}", kind.name());
                }
            }
        }
        assert!(beyond > 200, "{}: {beyond} points", kind.name());
    }
}

#[test]
fn a_half_space_is_unbounded_until_something_cuts_it() {
    let support = |model: &str| tree(&format!("jbt 1 {model}")).support();
    let half = "half_space { at (0 0 1) normal (0 0 2) radius 0.5 }";
    let alone = support(half);
    assert!(!alone.is_finite() && !alone.is_empty());
    assert_eq!(alone.high(), [f64::INFINITY, f64::INFINITY, 1.5]);
    assert_eq!(alone.low(), [f64::NEG_INFINITY; 3]);
    let ball = "point { radius 2 }";
    assert!(!support(&format!("union {{ {half} {ball} }}")).is_finite());
    assert_eq!(support(&format!("intersection {{ {half} {ball} }}")).high(), [2.0, 2.0, 1.5]);
    assert_eq!(support(&format!("difference {{ {ball} {half} }}")).low(), [-2.0; 3]);
    // Turned away from the axes it has no box at all, and a turn back gives it one again.
    assert_eq!(support(&format!("rotate axis x degrees 30 {{ {half} }}")).high(), [f64::INFINITY; 3]);
    assert_eq!(support(&format!("rotate axis x degrees 90 {{ {half} }}")).low()[1], -1.5);
}

/// Whatever a parameter does to a skeleton, its code serves all values.
#[test]
fn a_parameter_changes_numbers_and_no_code() {
    let models = [
        "sphere { sphere_radius t center (t 0 0) radius 1 }",
        "torus { ring_radius t tube_radius 2 - t normal (t - 1 1 0) radius 1 }",
        "cone { from (t 0 0) to (1 0 0) from_radius t to_radius 2 - t radius 1 }",
        "scale t - 1.5 { cone { from (0 0 0) to (0 0 1) from_radius 1 radius 1 } }",
        "scale 1.5 - t { half_space { normal (1 2 3) radius 1 } }",
        "scale 1.5 - t { half_space { radius 1 } }",
        "round_cone { from (0 0 0) to (0 0 1) from_radius t to_radius 0.5 radius 1 }",
        "round_cone { from (0 0 0) to (0 0 t - 1) from_radius 1 to_radius 0.5 radius 1 }",
        "rectangle { half_length t half_width 1 along (1 t - 1 0) radius 1 }",
        "arc { degrees 180 * t arc_radius 1 radius 1 }",
        "arc { degrees 90 arc_radius t start (1 t 0) radius 1 }",
        "helix { helix_radius t pitch 2 turns t radius 1 }",
        "helix { helix_radius 1 pitch t + 1 turns 2 normal (t - 1 1 0) radius 1 }",
        "half_space { at (0 0 t) normal (0 t - 1 1) radius 1 }",
        "ellipsoid { stretch (1 + t 1 2) radius 1 }",
        "lmetric { exponent 1 + t radius 1 }",
        "superquadric { e1 0.25 + 0.5 * t e2 1 radius 1 }",
    ];
    for model in models {
        let tree = tree(&format!("jbt 1 param t = 1 {model}"));
        let lowered = |tree: &CheckedTree| lower(tree, Query::GRADIENT).expect("it can be lowered").function;
        let before = lowered(&tree);
        for value in [0.0, 0.5, 1.0, 1.25, 2.0] {
            let set = match tree.with_parameters(&[("t", value)]) {
                Ok(set) => set,
                Err(errors) => panic!("{model} at {value}: {errors:?}"),
            };
            assert_eq!(lowered(&set), before, "{model} at {value}");
            let p = [0.25, -0.75, 1.25];
            let [field, ..] = run(&compiled(&set, Query::GRADIENT), p);
            let expected = walk(&set, p.map(f64::from)).field;
            assert!(
                (f64::from(field) - expected).abs() < 1e-5,
                "{model} at {value}: {field}, not {expected}"
            );
        }
    }
}
