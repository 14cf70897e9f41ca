//! How long does a mesh take, normals and colours included, by the size of its lattice?

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jbt::{Compiler, Fineness, Polygonize};
use jbt_benches::check;
use jbt_benches::model::{HERO, blobs, example, tree};

fn mesh(c: &mut Criterion) {
    for (name, tree) in [("64 blobs", tree(&blobs(64, 1))), ("hero", example(HERO))] {
        let mut group = c.benchmark_group(format!("mesh/{name}"));
        group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
        group.sample_size(10);
        for cells in [32, 64, 128] {
            // The compiler remembers the code, so that none is made while the clock runs.
            let compiler = Compiler::new();
            let settings = Polygonize { fineness: Fineness::Resolution(cells), ..Polygonize::default() };
            let run = || settings.mesh(&compiler, &tree).run().expect("the model has a surface");
            let made = run();
            check::mesh(&tree, &made);
            group.throughput(Throughput::Elements(made.lattice.point_count()));
            group.bench_function(BenchmarkId::from_parameter(cells), |b| b.iter(run));
        }
        group.finish();
    }
}

criterion_group!(benches, mesh);
criterion_main!(benches);
