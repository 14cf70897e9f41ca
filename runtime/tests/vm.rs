//! Programs of instructions compile quickly, and every engine and every pruned box gives their values.
//!
//! The samples are those of the folder `vm`, see `jbt_testkit::samples`.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use std::time::Instant;

use common::answers;
use jbt::boxes::Divisible;
use jbt::{Box3, Compiler, Engine, Points, Pruner, Query};
use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_text::import::vm;

/// Of the largest coordinate or value: f32 rounds some thousand times on the way, most of it near 0.
const BOUND: f64 = 2e-5;

#[test]
fn samples_compile_and_agree() {
    let Some(folder) = samples::folder("vm") else { return };
    let mut rng = fastrand::Rng::with_seed(3);
    for (name, size) in [("hi", 1.5f32), ("bear", 12.0), ("colonnade", 1.2), ("prospero", 1.0)] {
        let start = Instant::now();
        let text = std::fs::read(folder.join(name).with_extension("vm")).unwrap();
        let model = vm(&text).unwrap().model;
        let tree = model.check().unwrap();
        let read = start.elapsed();
        let points: Points =
            (0..200).map(|_| std::array::from_fn(|_| size * (2.0 * rng.f32() - 1.0))).collect();
        let mut first: Option<Vec<u32>> = None;
        let mut times = Vec::new();
        for engine in [Engine::Lanes, Engine::Jit, Engine::Scalar] {
            let start = Instant::now();
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::FIELD).unwrap();
            times.push(start.elapsed());
            let samples = answers(&evaluator, &points);
            let bits = samples.planes().iter().flatten().map(|x| x.to_bits()).collect();
            assert_eq!(*first.get_or_insert_with(|| Vec::clone(&bits)), bits, "{name} {engine:?}");
            for (index, &field) in samples.field().iter().enumerate() {
                let truth = walk(&tree, points.get(index).map(f64::from)).field;
                let bound = BOUND * truth.abs().max(f64::from(size));
                // Far outside of the bear exponentials leave the range of f32.
                let far = name == "bear" && truth < -2.0 && field < -2.0;
                let close = (f64::from(field) - truth).abs() < bound;
                assert!(far || close, "{name}: {field}, not {truth}");
            }
        }
        // With the gradient the longest of them is beyond what machine code is made for.
        let gradients = [Engine::Lanes, Engine::Scalar].map(|engine| {
            let start = Instant::now();
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::GRADIENT).unwrap();
            times.push(start.elapsed());
            let samples = answers(&evaluator, &points);
            samples.planes().iter().flatten().map(|x| x.to_bits()).collect::<Vec<u32>>()
        });
        assert_eq!(gradients[0], gradients[1], "{name}");
        assert_eq!(first.as_deref(), Some(&gradients[0][..points.len()]), "{name}");
        let compiler = Compiler::for_engine(Engine::Lanes);
        let start = Instant::now();
        let pruner = Pruner::new(&compiler, &tree).unwrap();
        times.push(start.elapsed());
        let evaluator = compiler.evaluator(&tree, Query::FIELD).unwrap();
        let part = Box3::new([0.1 * size; 3], [0.15 * size; 3]);
        let region = pruner.region(part).unwrap();
        let rows = pruner.everywhere().rows();
        println!(
            "{name}: read in {read:?}; field by lanes, jit, scalar, gradient by lanes, scalar, pruner {times:?}; {} of {rows} rows in a small box",
            region.rows()
        );
        let inside: Points =
            (0..50).map(|_| std::array::from_fn(|_| size * (0.1 + 0.05 * rng.f32()))).collect();
        let all = answers(&evaluator, &inside);
        let mut pruned = vec![0.0; inside.len()];
        evaluator.eval_region(&region, inside.planes(), &mut [&mut pruned[..]]).unwrap();
        assert_eq!(all.field(), pruned, "{name}");
    }
}
