//! Points with coordinates that are not finite: an infinity is the largest number, a NaN has no answer; on
//! all engines.

mod common;

use common::answers;
use jbt::{CheckedTree, Compiler, Engine, Points, Pruner, Query};
use jbt_testkit::bits::bits;
use jbt_testkit::scene;

const MODELS: [&str; 4] = [
    // In its pose a NaN would be in the disc.
    "color (1 0 0) { disc { center (0 0 0) normal (0 0 1) disc_radius 1 radius 1 } }",
    "sum { point { radius 1 } complement { rotate axis x degrees 30 { half_space { radius 1 } } } }",
    "expression { min(x, 3) + 1 }",
    "twist axis z rate 2 { union { box { half (1 1 1) radius 1 } expression { sin(x) / y } } }",
];

fn tree(root: &str) -> CheckedTree {
    scene::tree(&format!("attribute rough 2 default (0.25 -0)\nattribute kind 1 default 3 dominant\n{root}"))
}

/// Points with these numbers in one place, ordinary ones among them.
fn with(spice: &[f32]) -> Vec<[f32; 3]> {
    let mut points = vec![[0.25, -0.5, 0.125]; 19];
    for (index, &x) in spice.iter().enumerate() {
        for axis in 0..3 {
            points[3 * index + axis + 1][axis] = x;
        }
    }
    points
}

#[test]
fn a_point_with_a_nan_has_no_answer() {
    for model in MODELS {
        let tree = tree(model);
        for engine in Engine::ALL {
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::ALL).expect("it compiles");
            let points: Points = with(&[f32::NAN, -f32::NAN]).into_iter().collect();
            let samples = answers(&evaluator, &points);
            for index in 0..points.len() {
                let nowhere = points.get(index).iter().any(|x| x.is_nan());
                let field = samples.field()[index];
                assert_eq!(field.is_nan(), nowhere, "{model}, {}, {:?}", engine.name(), points.get(index));
                let gradient = samples.gradient().expect("asked for");
                assert!(gradient.iter().all(|plane| plane[index].is_nan() == nowhere), "{model}");
                if nowhere {
                    for (group, default) in
                        [("color", &[1.0; 3][..]), ("rough", &[0.25, 0.0]), ("kind", &[3.0])]
                    {
                        let channels = samples.attribute(group).expect("it is declared");
                        let values: Vec<u32> = channels.iter().map(|plane| plane[index].to_bits()).collect();
                        let expected: Vec<u32> = default.iter().map(|x: &f32| x.to_bits()).collect();
                        assert_eq!(values, expected, "{model}, {group}");
                    }
                }
            }
        }
    }
}

#[test]
fn an_infinity_is_the_largest_number() {
    for model in MODELS {
        let tree = tree(model);
        for engine in Engine::ALL {
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::ALL).expect("it compiles");
            let answers = |points: Vec<[f32; 3]>| {
                let samples = answers(&evaluator, &points);
                bits(samples.planes())
            };
            let infinite = answers(with(&[f32::INFINITY, f32::NEG_INFINITY]));
            assert_eq!(infinite, answers(with(&[f32::MAX, f32::MIN])), "{model}, {}", engine.name());
        }
    }
}

#[test]
fn regions_and_probes_answer_alike() {
    let tree = tree(MODELS[0]);
    let compiler = Compiler::new();
    let evaluator = compiler.evaluator(&tree, Query::ALL).expect("it compiles");
    let points: Points = with(&[f32::NAN, f32::INFINITY]).into_iter().collect();
    let samples = answers(&evaluator, &points);
    let everywhere = Pruner::new(&compiler, &tree).expect("it compiles").everywhere();
    let mut planes = vec![vec![0.0; points.len()]; samples.planes().len()];
    let mut buffers: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.eval_region(&everywhere, points.planes(), &mut buffers).expect("the buffers fit");
    let found: Vec<Vec<u32>> =
        planes.iter().map(|plane| plane.iter().map(|x| x.to_bits()).collect()).collect();
    assert_eq!(found, bits(samples.planes()));
    let probe = evaluator.probe([0.0, f32::NAN, 0.0]);
    assert!(probe.value().is_nan());
    assert_eq!((probe.normal(), probe.color()), (None, Some([1.0; 3])));
}
