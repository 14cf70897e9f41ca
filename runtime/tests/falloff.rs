//! Falloffs through the compiler: gradients against the oracle, what happens at the skeleton, at the rim and
//! beyond it, parameters, and that pruning changes nothing.

mod common;

use common::answers;
use jbt::boxes::Divisible;
use jbt::build::{Edge, Term, arctan, blanc, blinn, degree, inverse_power, param, point, segment};
use jbt::walk::{walk, walk_gradient};
use jbt::{Box3, Compiler, Engine, Falloff, Model, Points, Pruner, Query, Samples, Tree, Update};
use jbt_model::written::WrittenFalloff;
use jbt_testkit::scene;

/// Every falloff, those with parameters with several.
fn falloffs() -> Vec<WrittenFalloff> {
    let plain = [
        Falloff::Soft,
        Falloff::Wyvill,
        Falloff::Quartic,
        Falloff::Metaball,
        Falloff::Hermite,
        Falloff::Quintic,
        Falloff::Linear,
    ];
    let mut all: Vec<WrittenFalloff> = plain.into_iter().map(WrittenFalloff::from).collect();
    all.extend([0.5, 1.0, 2.5, 8.0, 65.0].map(degree));
    all.extend([0.0, 0.7, 1.125, 10.0].map(blanc));
    for edge in [Edge::Exact, Edge::Smooth] {
        all.extend([(2.0, 2.0), (3.0, 1.0), (10.0, 1.5)].map(|(h, c)| blinn(h, c, edge)));
        all.extend([0.5, 5.0, 50.0].map(|p| arctan(p, edge)));
        all.extend(
            [(1.0, 4.0), (1.5, 3.0), (2.0, 4.0), (3.0, 2.0), (8.0, 2.0)]
                .map(|(n, c)| inverse_power(n, c, edge)),
        );
    }
    all
}

fn evaluate(tree: &Tree, points: &Points, engine: Engine) -> Samples {
    let tree = Model::new(tree.clone()).check().expect("a good model");
    let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::GRADIENT).expect("it compiles");
    answers(&evaluator, points)
}

fn gradient(samples: &Samples, index: usize) -> [f64; 3] {
    samples.gradient().expect("asked for").map(|plane| f64::from(plane[index]))
}

#[test]
fn gradients_are_those_of_the_oracle() {
    let points: Points = (1..400)
        .map(|i| {
            let (r, turn) = (i as f32 / 380.0, i as f32 * 2.4);
            [r * turn.cos() * 0.8, r * turn.sin() * 0.8, 0.6 * r]
        })
        .collect();
    let mut compared = 0;
    for falloff in falloffs() {
        for tree in [point([0.0; 3], 0.9), segment([0.0; 3], [0.3, -0.2, 0.1], 0.7)] {
            let tree = tree.falloff(falloff.clone());
            let checked = Model::new(tree.clone()).check().unwrap();
            let samples = evaluate(&tree, &points, Engine::Scalar);
            for index in 0..points.len() {
                let p = points.get(index).map(f64::from);
                let oracle = walk(&checked, p);
                if oracle.kink_distance < 1e-4 {
                    continue;
                }
                let [fine, coarse] = [1e-6, 1e-5].map(|step| walk_gradient(&checked, p, step));
                let size = fine.iter().fold(1.0, |size: f64, g| size.max(g.abs()));
                if (0..3).any(|k| (fine[k] - coarse[k]).abs() > 1e-4 * size) {
                    continue;
                }
                compared += 1;
                let bound = size * 4e-6;
                let (field, found) = (f64::from(samples.field()[index]), gradient(&samples, index));
                assert!(
                    (field - oracle.field).abs() < bound,
                    "{falloff:?} at {p:?}: {field}, not {}",
                    oracle.field
                );
                for axis in 0..3 {
                    let close = (found[axis] - fine[axis]).abs() < 1e-3 * size;
                    assert!(close, "{falloff:?} at {p:?}: {found:?}, not {fine:?}");
                }
            }
        }
    }
    assert!(compared > 400 * falloffs().len(), "only {compared} gradients were compared");
}

#[test]
fn nothing_is_lost_at_the_skeleton_and_at_the_rim() {
    let near = [0.0, 1e-45, 1e-30, 1e-10, 1e-7, 6e-8, 1e-5, 2.4e-4, 2.5e-4, 1e-3];
    let rim = [0.999, 0.999_99, 0.999_999_9, 1.0 - 6e-8, 1.0, 1.0 + 1.2e-7, 1.001, 3.0, 1e15, 1e30];
    let points: Points = near.into_iter().chain(rim).map(|x| [x, 0.0, 0.0]).collect();
    for falloff in falloffs() {
        // The support radius is 1, so it is the rim that the last points surround.
        for tree in [point([0.0; 3], 1.0), segment([0.0; 3], [-1.0, 0.0, 0.0], 1.0)] {
            let tree = tree.falloff(falloff.clone());
            for engine in Engine::ALL {
                let samples = evaluate(&tree, &points, engine);
                for index in 0..points.len() {
                    let (x, gradient) = (points.get(index)[0], gradient(&samples, index));
                    assert!(gradient.iter().all(|g| g.is_finite()), "{falloff:?} at {x}: {gradient:?}");
                    assert!(gradient[0] <= 0.0, "{falloff:?} at {x} rises: {gradient:?}");
                    let field = samples.field()[index];
                    if x >= 1.0 {
                        assert_eq!((field.to_bits(), gradient), (0, [0.0; 3]), "{falloff:?} at {x}");
                    }
                    if x == 0.0 {
                        assert!(
                            (field - 1.0).abs() < 1e-6 && gradient == [0.0; 3],
                            "{falloff:?}: {field} {gradient:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn no_seam_has_a_gap() {
    // Halves, quarters and thirds, where pieces meet, and the numbers next to them.
    let mut places: Vec<f32> = (8..1014).map(|i| i as f32 / 1024.0).collect();
    for seam in [0.25f32, 1.0 / 3.0, 0.5, 0.5f32.sqrt(), 0.75, 0.95] {
        let near = |ulps: i32| f32::from_bits(seam.to_bits().wrapping_add_signed(ulps));
        places.extend((-20..=20).map(near));
    }
    let points: Points = places.into_iter().map(|x| [x, 0.0, 0.0]).collect();
    for falloff in falloffs() {
        let tree = point([0.0; 3], 1.0).falloff(falloff.clone());
        let samples = evaluate(&tree, &points, Engine::Scalar);
        for index in 0..points.len() {
            let (x, [found, ..]) = (points.get(index)[0], gradient(&samples, index));
            let r = f64::from(x);
            let falloff = falloff.falloff();
            let plain = |r: f64| falloff.value(r * r);
            let step = 1e-5;
            let (before, after) = (plain(r - step), plain(r + step));
            let curvature = (before + after - 2.0 * plain(r)).abs() / (step * step);
            let expected = (after - before) / (2.0 * step);
            // A slope may have a bend here.
            let bound = 2e-3 * (1.0 + expected.abs()) + 2.0 * step * curvature;
            let falls = found < 0.0 || expected > -1e-30;
            assert!(falls && (found - expected).abs() < bound, "{falloff:?} at {x}: {found}, not {expected}");
        }
    }
}

/// Formulas of r as falloffs: one that is published, one that rises and falls, one that is negative.
fn formulas() -> [fn(Term) -> Term; 3] {
    [
        |r| 1.0 - 3.0 * r.square() + 2.0 * r.powf(3.0),
        |r| (1.0 - &r) * (9.0 * &r).cos().square(),
        |r| r.square() * (&r - 1.0),
    ]
}

#[test]
fn a_falloff_may_be_a_formula() {
    let mut rng = fastrand::Rng::with_seed(5);
    let points: Points = (0..400).map(|_| std::array::from_fn(|_| 3.0 * rng.f32() - 1.5)).collect();
    let balls =
        point([0.0; 3], 0.75) + segment([0.5, 0.0, 0.0], [1.0, 0.5, 0.0], 0.5).strength(param("s", 2.0));
    for formula in formulas() {
        let tree = balls.falloff_by(formula);
        let checked = Model::new(tree.clone()).check().expect("a good model");
        assert!(checked.support().is_finite());
        let compiler = Compiler::new();
        let evaluator = compiler.evaluator(&checked, Query::GRADIENT).expect("it compiles");
        let all = answers(&evaluator, &points);
        let pruner = Pruner::new(&compiler, &checked).expect("it compiles");
        let mut beyond = 0;
        for index in 0..points.len() {
            let p = points.get(index);
            let sample = walk(&checked, p.map(f64::from));
            let field = all.field()[index];
            assert!((f64::from(field) - sample.field).abs() < 1e-5, "{p:?}: {field}, not {}", sample.field);
            let bounds = Box3 { low: p.map(|x| x - 0.01), high: p.map(|x| x + 0.01) };
            let region = pruner.region(bounds).expect("the box is proper");
            let mut pruned = [0f32; 4];
            let mut planes: Vec<&mut [f32]> = pruned.chunks_mut(1).collect();
            evaluator
                .eval_region(&region, p.each_ref().map(std::slice::from_ref), &mut planes)
                .expect("the buffers fit");
            assert_eq!(pruned[0].to_bits(), field.to_bits(), "at {p:?}");
            if sample.field == 0.0 && region.rows() < pruner.everywhere().rows() {
                beyond += 1;
                assert_eq!(field.to_bits(), 0, "at {p:?}");
            }
        }
        assert!(beyond > 50, "{beyond} points are beyond all supports");
    }
    // The published one is what has a word of its own.
    let [hermite, ..] = formulas();
    let own = Model::new(balls.falloff(Falloff::Hermite)).check().expect("a good model");
    let same = Model::new(balls.falloff_by(hermite)).check().expect("a good model");
    for index in 0..points.len() {
        let [a, b] = [&own, &same].map(|tree| walk(tree, points.get(index).map(f64::from)).field);
        assert!((a - b).abs() < 1e-12, "{a} and {b}");
    }
}

#[test]
fn parameters_of_falloffs_are_numbers() {
    let t = || param("t", 2.0);
    let half = || t() * 0.5;
    let falloffs = [
        degree(t()),
        blanc(t()),
        blinn(t(), half(), Edge::Exact),
        arctan(t(), Edge::Smooth),
        inverse_power(t(), half() + 1.0, Edge::Smooth),
    ];
    let points: Points = (0..200).map(|i| [i as f32 / 180.0, 0.1, 0.0]).collect();
    for falloff in falloffs {
        let tree = Model::new(point([0.0; 3], 1.0).falloff(falloff.clone())).check().unwrap();
        let mut evaluator = Compiler::new().evaluator(&tree, Query::GRADIENT).unwrap();
        for value in [2.0, 1.0, 3.0, 2.7, 8.0] {
            let set = tree.with_parameters(&[("t", value)]).unwrap();
            assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers, "{falloff:?}");
            let samples = answers(&evaluator, &points);
            for index in 0..points.len() {
                let expected = walk(&set, points.get(index).map(f64::from)).field;
                let found = f64::from(samples.field()[index]);
                assert!((found - expected).abs() < 1e-5, "{falloff:?} for {value}: {found}, not {expected}");
            }
        }
        assert!(tree.with_parameters(&[("t", -1.0)]).is_err(), "{falloff:?}");
    }
}

#[test]
fn a_surface_radius_is_where_the_surface_is() {
    for falloff in [
        "soft",
        "quintic",
        "degree { exponent 2.5 }",
        "blinn",
        "arctan { stiffness 2 }",
        "inverse",
        "blanc { hardness 3 }",
    ] {
        let text = format!("jbt 1 param size = 0.5 point {{ surface_radius size falloff {falloff} }}");
        let tree = scene::tree(&text);
        for size in [0.5, 2.0] {
            let field = walk(&tree.with_parameters(&[("size", size)]).unwrap(), [0.0, size, 0.0]).field;
            assert!((field - 0.5).abs() < 1e-12, "{falloff}: {field}");
        }
    }
}

#[test]
fn bad_parameters_are_refused() {
    for (falloff, message) in [
        ("degree { exponent 0 }", "the `exponent` of the degree falloff is 0"),
        ("degree { exponent 1025 }", "the `exponent` of the degree falloff is 1025"),
        ("blinn { hardness -1 }", "the `hardness` of the blinn falloff is -1"),
        ("blinn { cutoff 0 }", "the `cutoff` of the blinn falloff is 0"),
        ("inverse_power { exponent 0.5 }", "the `exponent` of the inverse_power falloff is 0.5"),
        ("inverse_power { cutoff -2 }", "the `cutoff` of the inverse_power falloff is -2"),
        ("arctan { stiffness 0 }", "the `stiffness` of the arctan falloff is 0"),
        ("blanc { hardness 101 }", "the `hardness` of the blanc falloff is 101"),
        ("blanc { hardness -0.1 }", "the `hardness` of the blanc falloff is -0.1"),
    ] {
        let text = format!("jbt 1 point {{ radius 1 falloff {falloff} }}");
        let errors = scene::model(&text).check().unwrap_err();
        assert_eq!(errors.len(), 1, "{falloff}");
        assert_eq!(errors[0].message, message);
    }
}
