//! How many points does each engine answer in a second, for each query, on a sum of blobs and on models that
//! people draw?

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jbt::{Compiler, Engine, Query};
use jbt_benches::check;
use jbt_benches::model::{GOBLET, HERO, blobs, example, inside, tree};

fn evaluate(c: &mut Criterion) {
    let models = [("200 blobs", tree(&blobs(200, 1))), ("hero", example(HERO)), ("goblet", example(GOBLET))];
    for (name, tree) in models {
        let mut group = c.benchmark_group(format!("evaluate/{name}"));
        group.warm_up_time(Duration::from_millis(150)).measurement_time(Duration::from_millis(500));
        group.sample_size(10);
        for engine in Engine::ALL {
            // The reference is so slow that fewer points tell as much.
            let count = if engine == Engine::Scalar { 64 } else { 4096 };
            let points = inside(&tree, count, 2);
            group.throughput(Throughput::Elements(count as u64));
            for query in Query::EVERY {
                let evaluator =
                    Compiler::for_engine(engine).evaluator(&tree, query).expect("the model compiles");
                check::answers(&tree, &evaluator, &points);
                let mut samples = evaluator.samples();
                group.bench_function(BenchmarkId::new(engine.name(), query.name()), |b| {
                    b.iter(|| evaluator.eval(&points, &mut samples).expect("the buffers fit"));
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
