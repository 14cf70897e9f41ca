//! How much does one fused query save against the separate ones that one would ask otherwise: the field, the
//! field four times for a gradient by differences (or the exact gradient), and the attributes?

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jbt::{Compiler, Engine, Evaluator, Points, Query};
use jbt_benches::check;
use jbt_benches::model::{HERO, blobs, example, inside, tree};

/// Points that are asked.
const POINTS: usize = 4096;
/// The step of the differences: of the order of the square root of what f32 resolves.
const STEP: f32 = 1e-3;

fn fusion(c: &mut Criterion) {
    for (name, tree) in [("200 blobs", tree(&blobs(200, 1))), ("hero", example(HERO))] {
        for engine in [Engine::Lanes, Engine::Jit] {
            let mut group = c.benchmark_group(format!("fusion/{name}/{}", engine.name()));
            group.warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800));
            group.sample_size(10).throughput(Throughput::Elements(POINTS as u64));
            let points = inside(&tree, POINTS, 2);
            let stepped = stepped(&points);
            let evaluator = |query| {
                let evaluator =
                    Compiler::for_engine(engine).evaluator(&tree, query).expect("the model compiles");
                check::answers(&tree, &evaluator, &points);
                evaluator
            };
            let [field, gradient, attributes, all] =
                [Query::FIELD, Query::GRADIENT, Query::ATTRIBUTES, Query::ALL].map(evaluator);
            type Asked<'a> = Vec<(&'a Evaluator, &'a Points)>;
            let four: Asked<'_> = [&points].into_iter().chain(&stepped).map(|p| (&field, p)).collect();
            let once: Asked<'_> = vec![(&field, &points)];
            let mixed: Asked<'_> = vec![(&attributes, &points)];
            let ways: [(&str, Asked<'_>); 7] = [
                ("fused", vec![(&all, &points)]),
                ("field", once.clone()),
                ("differences", four.clone()),
                ("gradient", vec![(&gradient, &points)]),
                ("attributes", mixed.clone()),
                ("separate, differences", [once, four, mixed].concat()),
                // The query for the gradient answers the field too.
                ("separate, exact gradient", vec![(&gradient, &points), (&attributes, &points)]),
            ];
            for (way, asked) in ways {
                let mut samples: Vec<_> = asked.iter().map(|(evaluator, _)| evaluator.samples()).collect();
                group.bench_function(BenchmarkId::from_parameter(way), |b| {
                    b.iter(|| {
                        for ((evaluator, points), samples) in asked.iter().zip(&mut samples) {
                            evaluator.eval(points, samples).expect("the buffers fit");
                        }
                    });
                });
            }
            group.finish();
        }
    }
}

/// The points a step along each axis away.
fn stepped(points: &Points) -> [Points; 3] {
    std::array::from_fn(|axis| {
        let step = |index| {
            let mut p = points.get(index);
            p[axis] += STEP;
            p
        };
        (0..points.len()).map(step).collect()
    })
}

criterion_group!(benches, fusion);
criterion_main!(benches);
