//! How long does one primitive take at one point, on each engine, for each query?

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jbt::{Compiler, Engine, Query};
use jbt_benches::check;
use jbt_benches::model::{blobs, cube, tree};

fn evaluate(c: &mut Criterion) {
    let mut group = c.benchmark_group("evaluate");
    let (primitives, count) = (200, 16_384);
    let (tree, points) = (tree(&blobs(primitives, 1)), cube(count, 2));
    group.throughput(Throughput::Elements((primitives * count) as u64));
    for engine in [Engine::Lanes, Engine::Jit] {
        for query in [Query::FIELD, Query::GRADIENT, Query::ALL] {
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, query).expect("blobs compile");
            check::field(&tree, &evaluator, &points);
            let mut samples = evaluator.samples();
            group.bench_function(BenchmarkId::new(engine.name(), query.name()), |b| {
                b.iter(|| evaluator.eval(&points, &mut samples).expect("the buffers fit"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
