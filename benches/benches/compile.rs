//! Does compiling take longer when a model has more primitives of one shape? (It should not: 2,000 as 20, but for their rows.)

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use jbt::{Compiler, Engine, Query};
use jbt_benches::check;
use jbt_benches::model::{blobs, cube, tree};

fn compile(c: &mut Criterion) {
    let mut group = c.benchmark_group("compile");
    for count in [20, 200, 2000] {
        let tree = tree(&blobs(count, 1));
        let points = cube(1000, 2);
        check::field(&tree, &Compiler::new().evaluator(&tree, Query::FIELD).expect("blobs compile"), &points);
        for query in [Query::FIELD, Query::ALL] {
            for engine in [Engine::Lanes, Engine::Jit] {
                let name = format!("{}/{}", engine.name(), query.name());
                group.bench_with_input(BenchmarkId::new(name, count), &tree, |b, tree| {
                    b.iter(|| {
                        Compiler::for_engine(engine).evaluator(black_box(tree), query).expect("blobs compile")
                    });
                });
            }
        }
        group.bench_with_input(BenchmarkId::new("edit", count), &tree, |b, tree| {
            let other = self::tree(&blobs(count, 3));
            let mut evaluator = Compiler::new().evaluator(tree, Query::ALL).expect("blobs compile");
            b.iter(|| {
                assert_eq!(evaluator.update(black_box(&other)).expect("blobs compile"), jbt::Update::Numbers);
                evaluator.update(black_box(tree)).expect("blobs compile")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, compile);
criterion_main!(benches);
