//! How does the time of a point grow with the number of primitives, and with how many of them overlap there?

use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jbt::{Compiler, Query};
use jbt_benches::check;
use jbt_benches::model::{Blob, blobs, cube, scaled_blobs, tree};

/// Points that are asked.
const POINTS: usize = 2048;

fn scaling(c: &mut Criterion) {
    let mut group = settings(c, "scaling/count");
    for count in [20, 80, 320, 1250, 5000] {
        bench(&mut group, count, &blobs(count, 1));
    }
    group.finish();
    let mut group = settings(c, "scaling/overlap");
    for scale in [0.5, 1.0, 2.0, 4.0] {
        let blobs = scaled_blobs(1000, scale, 1);
        // The mean number of supports that a point of the cube is inside of, as far as they are inside of it.
        let volume: f64 = blobs.iter().map(|blob| f64::from(blob.radius).powi(3)).sum();
        let overlap = volume * 4.0 / 3.0 * std::f64::consts::PI / 8.0;
        bench(&mut group, format!("{overlap:.2}"), &blobs);
    }
    group.finish();
}

fn settings<'a>(c: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = c.benchmark_group(name);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(1200));
    group.sample_size(10).throughput(Throughput::Elements(POINTS as u64));
    group
}

fn bench(group: &mut BenchmarkGroup<'_, WallTime>, parameter: impl ToString, blobs: &[Blob]) {
    let (tree, points) = (tree(blobs), cube(POINTS, 2));
    for query in [Query::FIELD, Query::ALL] {
        let evaluator = Compiler::new().evaluator(&tree, query).expect("blobs compile");
        check::answers(&tree, &evaluator, &points);
        let mut samples = evaluator.samples();
        group.bench_function(BenchmarkId::new(query.name(), parameter.to_string()), |b| {
            b.iter(|| evaluator.eval(&points, &mut samples).expect("the buffers fit"));
        });
    }
}

criterion_group!(benches, scaling);
criterion_main!(benches);
