//! How long does each stage of compiling take, by number of primitives and by number of shapes? (Primitives
//! of one shape should cost their rows alone; shapes cost code.)

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use jbt::import::vm;
use jbt::internals::ir::domain::lanes::Tape;
use jbt::internals::ir::engine::choose;
use jbt::internals::ir::pass::run_pipeline;
use jbt::internals::ir::verify;
use jbt::internals::kernel::Purpose;
use jbt::internals::lower::lower;
use jbt::{CheckedTree, Compiler, Engine, Level, Query, Update};
use jbt_benches::check;
use jbt_benches::model::{cube, varied};
use jbt_testkit::samples;

fn compile(c: &mut Criterion) {
    let mut group = c.benchmark_group("compile");
    group.warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(350));
    group.sample_size(10);
    for count in [20, 200, 2000] {
        for shapes in [1, 4, 16] {
            let tree = varied(count, shapes, 1);
            let evaluator = Compiler::new().evaluator(&tree, Query::ALL).expect("the model compiles");
            check::answers(&tree, &evaluator, &cube(200, 2));
            stages(&mut group, &format!("{count} primitives, {shapes} shapes"), &tree);
        }
        edit(&mut group, count);
    }
    if let Some(prospero) = program("prospero") {
        stages(&mut group, "prospero", &prospero);
    }
    group.finish();
}

/// A long program of the samples, if they are here.
fn program(name: &str) -> Option<CheckedTree> {
    let bytes = samples::file(&format!("vm/{name}.vm")).ok()?;
    let imported = vm(&bytes).expect("the program reads");
    Some(imported.model.check().expect("the program is a model"))
}

/// The stages on the way to an evaluator of everything, each on what the one before it made.
fn stages(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, tree: &CheckedTree) {
    group.bench_function(BenchmarkId::new("lower", name), |b| {
        b.iter(|| lower(black_box(tree), Query::ALL).expect("the model lowers"));
    });
    let lowered = lower(tree, Query::ALL).expect("the model lowers").function;
    let passes = |function| {
        run_pipeline(function, jbt::internals::kernel::passes(Purpose::Answers(Query::ALL)), &mut |_, _| {})
    };
    group.bench_function(BenchmarkId::new("passes", name), |b| {
        b.iter_batched(|| lowered.clone(), passes, BatchSize::SmallInput);
    });
    let function = passes(lowered.clone());
    group.bench_function(BenchmarkId::new("verify", name), |b| {
        b.iter_batched(|| function.clone(), verify, BatchSize::SmallInput);
    });
    let verified = Arc::new(verify(function).expect("passes keep the rules"));
    let level = Level::best();
    let generator = choose(Engine::Jit.backends(), level).expect("this build has a JIT");
    group.bench_function(BenchmarkId::new("lanes tape", name), |b| {
        b.iter(|| Tape::new(black_box(&verified)).expect("the program is legalized"));
    });
    group.bench_function(BenchmarkId::new("machine code", name), |b| {
        b.iter(|| generator.compile(black_box(&verified), level).expect("this machine has a JIT"));
    });
}

/// The same shape with other numbers: an update, which compiles nothing.
fn edit(group: &mut BenchmarkGroup<'_, WallTime>, count: usize) {
    let [one, other] = [1, 3].map(|seed| varied(count, 1, seed));
    let mut evaluator = Compiler::new().evaluator(&one, Query::ALL).expect("the model compiles");
    let mut next = [&other, &one].into_iter().cycle();
    group.bench_function(BenchmarkId::new("edit", format!("{count} primitives, 1 shapes")), |b| {
        b.iter(|| {
            let tree = next.next().expect("it goes round");
            assert_eq!(evaluator.update(black_box(tree)).expect("the model compiles"), Update::Numbers);
        });
    });
}

criterion_group!(benches, compile);
criterion_main!(benches);
