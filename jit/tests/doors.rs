//! What a kernel refuses, and how a handle behaves.

// Elsewhere there is no machine code, and generators say so.
#![cfg(target_arch = "x86_64")]

mod common;

use std::sync::Arc;

use common::{bind, compile, finish, reference, rows, run, spicy_plane, table, tables};
use jbt_ir::engine::{Backend, BoundProgram, Program, RunError, choose};
use jbt_ir::limits::{MAX_JIT_FRAME_BYTES, MAX_JIT_LIVE_VALUES, MAX_JIT_VALUES};
use jbt_ir::{Domain, FoldKind, FunctionBuilder, Level, Rule, Tables, Value, Verified};
use jbt_jit::{Allocator, BACKENDS, CompileError, Cranelift, Kernel, Pieces, VectorCount, Wide, available};
use jbt_testkit::bits::assert_same;

/// The sum over rows of `c0 * x`, and `y`.
fn function() -> Verified {
    let mut b = FunctionBuilder::new("doors", &["x", "y"]);
    let t = table(&mut b, None, 1);
    let (x, y, zero) = (b.input(0), b.input(1), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let c = b.column(t, 0);
    let next = b.fma(c, x, acc[0]);
    let out = b.end_fold(&[next]);
    finish(b, &[out[0], y])
}

fn three_rows() -> Tables {
    tables([rows(1, 3, &[0, 1, 2], &[0, 3], |row, _| row as f32 + 0.5)])
}

/// The kernels of all generators and levels that this CPU runs, with each number of vectors.
fn kernels(function: &Verified) -> Vec<Arc<dyn Program>> {
    let compiled = |kernel: Result<Kernel, CompileError>| kernel.expect("it compiles");
    let mut all: Vec<Arc<dyn Program>> = Vec::new();
    for vectors in [None].into_iter().chain(VectorCount::ALL.map(Some)) {
        let cranelift = Cranelift { vectors, ..Cranelift::STANDARD };
        all.push(Arc::new(compiled(cranelift.kernel(function))));
        for level in Level::available().into_iter().filter(|&level| Wide::STANDARD.covers(level)) {
            let wide = Wide { vectors, ..Wide::STANDARD };
            all.push(Arc::new(compiled(wide.kernel(function, level))));
        }
    }
    all
}

/// Planes of wrong numbers and lengths, and foreign rows, are for the door of all engines
/// (`runtime/tests/engines.rs`): here, that nothing is written then.
#[test]
fn planes_that_do_not_fit_are_refused_and_nothing_is_written() {
    for program in kernels(&function()) {
        let bound = bind(&program, &Arc::new(three_rows()));
        let plane = [1.0_f32; 24];
        let (mut a, mut b) = ([7.0_f32; 24], [7.0_f32; 24]);
        let given = bound.run(&[&plane, &plane], &mut [&mut a, &mut b[..8]]);
        assert_eq!(given, Err(RunError::Length { plane: 3, expected: 24, given: 8 }));
        assert_eq!((a, b), ([7.0; 24], [7.0; 24]));
        assert_eq!(bound.run(&[&[], &[]], &mut [&mut [], &mut []]), Ok(()));
    }
}

#[test]
fn planes_may_begin_anywhere_and_nothing_beside_them_is_written() {
    let function = function();
    for program in kernels(&function) {
        let bound = bind(&program, &Arc::new(three_rows()));
        let block = program.block();
        // Fewer points than a block, whole blocks, and some with a last one that overlaps the one before it.
        for (start, length) in [
            (2, 1),
            (1, block - 1),
            (0, 3 * block),
            (1, 3 * block),
            (2, block),
            (3, 3 * block + 1),
            (0, 2 * block - 1),
        ] {
            let (x, y) = (spicy_plane(1, length + 8), spicy_plane(2, length + 8));
            let (mut a, mut b) = (vec![7.0; length + 8], vec![7.0; length + 8]);
            let inputs = [&x[start..start + length], &y[3 - start..3 - start + length]];
            bound
                .run(&inputs, &mut [&mut a[start + 1..start + 1 + length], &mut b[..length]])
                .expect("the planes fit");
            let expected = reference(&function, &three_rows(), &inputs.map(<[f32]>::to_vec));
            assert_same(
                &expected,
                &[a[start + 1..start + 1 + length].to_vec(), b[..length].to_vec()],
                "inside",
            );
            assert!(
                a[..=start].iter().chain(&a[start + 1 + length..]).chain(&b[length..]).all(|&n| n == 7.0)
            );
        }
    }
}

/// A run is checked for one program, and no other one takes it.
#[test]
#[should_panic(expected = "a run is checked for the program that runs it")]
fn a_run_of_another_program_is_refused() {
    #[derive(Debug)]
    struct Thief(Arc<dyn Program>, Arc<dyn Program>);
    impl Program for Thief {
        fn interface(&self) -> &Arc<jbt_ir::engine::Interface> {
            self.0.interface()
        }
        fn block(&self) -> usize {
            1
        }
        fn run(&self, run: jbt_ir::engine::Run<'_, '_>) {
            self.1.run(run);
        }
    }
    let mut b = FunctionBuilder::new("one", &["x"]);
    let x = b.input(0);
    let one = compile(&finish(b, &[x]));
    let thief: Arc<dyn Program> = Arc::new(Thief(one, compile(&function())));
    bind(&thief, &Arc::default()).run(&[&[1.0]], &mut [&mut [0.0]]).expect("the planes fit");
}

#[test]
fn tables_that_do_not_fit_are_refused() {
    let program = compile(&function());
    let bad = [
        Tables::default(),
        tables([rows(2, 3, &[0], &[0, 1], |_, _| 0.0)]),
        tables([rows(1, 3, &[3], &[0, 1], |_, _| 0.0)]),
        tables([rows(1, 3, &[0], &[0, 2], |_, _| 0.0)]),
        tables([rows(1, 3, &[0], &[1, 1], |_, _| 0.0)]),
        tables([rows(1, 3, &[0, 1], &[0, 2], |_, _| 0.0), rows(1, 3, &[0], &[0, 1], |_, _| 0.0)]),
    ];
    for tables in bad {
        assert!(BoundProgram::new(Arc::clone(&program), Arc::new(tables)).is_err());
    }
    assert!(BoundProgram::new(program, Arc::new(three_rows())).is_ok());
}

/// Other rows need no other code.
#[test]
fn one_kernel_runs_over_many_tables() {
    let function = function();
    let kernel = compile(&function);
    let inputs = [spicy_plane(3, 32), spicy_plane(4, 32)];
    for count in [0_u32, 1, 5, 40] {
        let active: Vec<u32> = (0..count).collect();
        let numbers = |row: usize, _| (row as f32).sin() * 3.0;
        let tables = tables([rows(1, count as usize, &active, &[0, count], numbers)]);
        let expected = reference(&function, &tables, &inputs);
        assert_same(&expected, &run(&kernel, &Arc::new(tables), &inputs, 2), "other rows");
    }
}

#[test]
fn a_program_runs_on_many_threads_and_outlives_its_first_handle() {
    let function = function();
    let bound = bind(&compile(&function), &Arc::new(three_rows()));
    std::thread::scope(|scope| {
        for seed in 0..8 {
            let (bound, function) = (bound.clone(), &function);
            scope.spawn(move || {
                let inputs = [spicy_plane(seed, 480), spicy_plane(seed + 100, 480)];
                let expected = reference(function, &three_rows(), &inputs);
                for _ in 0..20 {
                    let (mut a, mut b) = (vec![0.0; 480], vec![0.0; 480]);
                    bound.run(&[&inputs[0], &inputs[1]], &mut [&mut a, &mut b]).expect("the planes fit");
                    assert_same(&expected, &[a, b], "a thread");
                }
            });
        }
    });
}

#[test]
fn more_planes_than_the_stack_holds_are_fine() {
    let mut b = FunctionBuilder::new("planes", &["x"]);
    let x = b.input(0);
    let outputs: Vec<Value> = (0..100)
        .map(|index| {
            let c = b.constant(index as f32);
            b.mul(x, c)
        })
        .collect();
    let function = finish(b, &outputs);
    let kernel = compile(&function);
    let inputs = [spicy_plane(5, 32)];
    let expected = reference(&function, &Tables::default(), &inputs);
    assert_same(&expected, &run(&kernel, &Arc::default(), &inputs, 100), "100 planes");
}

/// A chain: as many values as it says, two of which are alive.
fn chain(values: usize) -> Verified {
    let mut b = FunctionBuilder::new("chain", &["x"]);
    let x = b.input(0);
    let mut last = x;
    for _ in 1..values {
        last = b.add(last, x);
    }
    finish(b, &[last])
}

/// As many values alive at once as it says.
fn crowd(live: usize) -> Verified {
    let mut b = FunctionBuilder::new("crowd", &["x"]);
    let x = b.input(0);
    let first = b.sqrt(x);
    let mut values = vec![first];
    for _ in 1..live {
        let next = b.sqrt(values[values.len() - 1]);
        values.push(next);
    }
    let last = values[live - 1];
    let sum = values.iter().skip(1).fold(first, |sum, &value| b.add(sum, value));
    let sum = b.add(sum, last);
    finish(b, &[sum])
}

#[test]
fn the_limit_of_values_compiles_and_one_more_does_not() {
    compile(&chain(MAX_JIT_VALUES));
    let too_long = chain(MAX_JIT_VALUES + 1);
    let error = CompileError::Values { values: MAX_JIT_VALUES + 1, limit: MAX_JIT_VALUES };
    assert_eq!(Cranelift::STANDARD.kernel(&too_long).err(), Some(error.clone()));
    assert_eq!(Cranelift::STANDARD.clif(&too_long), Err(error.clone()));
    if Level::Avx2.is_available() {
        assert_eq!(Wide::STANDARD.kernel(&too_long, Level::Avx2).err(), Some(error));
    }
}

#[test]
fn the_limit_of_live_values_compiles_and_one_more_does_not() {
    let kernel = Cranelift::STANDARD.kernel(&crowd(MAX_JIT_LIVE_VALUES)).expect("it is within the limit");
    assert!(kernel.frame_bytes() > 16 * MAX_JIT_LIVE_VALUES, "so many values need a frame");
    let inputs = [vec![0.5; 32]];
    let expected = reference(&crowd(MAX_JIT_LIVE_VALUES), &Tables::default(), &inputs);
    let kernel: Arc<dyn Program> = Arc::new(kernel);
    assert_same(&expected, &run(&kernel, &Arc::default(), &inputs, 1), "a crowd");
    let too_many = crowd(MAX_JIT_LIVE_VALUES + 1);
    let error = Cranelift::STANDARD.kernel(&too_many).expect_err("it is too crowded");
    assert_eq!(error, CompileError::LiveValues { live: MAX_JIT_LIVE_VALUES + 1, limit: MAX_JIT_LIVE_VALUES });
}

/// Accumulators that pass through many loops, each value with a place of its own where the allocator takes
/// one pass.
#[test]
fn a_frame_that_is_too_large_is_refused() {
    let mut b = FunctionBuilder::new("frame", &["x"]);
    let mut values = vec![b.input(0); 50];
    for _ in 0..100 {
        let t = table(&mut b, None, 1);
        let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &values);
        let c = b.column(t, 0);
        let next: Vec<Value> = acc.iter().map(|&value| b.add(value, c)).collect();
        values = b.end_fold(&next);
    }
    let function = finish(b, &values);
    let cranelift = Cranelift {
        vectors: Some(VectorCount::Four),
        allocator: Some(Allocator::SinglePass),
        pieces: Some(Pieces::One),
        ..Cranelift::STANDARD
    };
    let error = cranelift.kernel(&function).expect_err("the frame is too large");
    assert!(matches!(error, CompileError::Frame { bytes, limit } if bytes > limit), "{error}");
}

/// Code that this CPU cannot run is refused, and the error names what is missing.
#[test]
fn levels_that_the_cpu_lacks_are_refused() {
    for level in Level::ALL {
        match Wide::STANDARD.kernel(&function(), level) {
            // There is no wide code for the baseline: it is that for AVX2.
            Ok(_) => assert!(level.max(Level::Avx2).is_available()),
            Err(CompileError::Processor { missing }) => {
                assert!(!level.is_available() && missing == level.name());
            }
            Err(error) => panic!("{error}"),
        }
    }
}

/// Wide code has no limit of live values but that of its frame, and takes fewer vectors for a value before it
/// gives up.
#[test]
fn a_frame_of_wide_code_that_is_too_large_is_refused() {
    let whole = |vectors| Wide { vectors, pieces: Some(Pieces::One), ..Wide::STANDARD };
    for level in Level::available().into_iter().filter(|&level| Wide::STANDARD.covers(level)) {
        let bytes = 4 * Wide::lanes(level);
        let fits = crowd(MAX_JIT_FRAME_BYTES / bytes - 50);
        let kernel = whole(None).kernel(&fits, level).expect("the frame is as large as allowed");
        assert!(kernel.frame_bytes() > MAX_JIT_FRAME_BYTES * 9 / 10 && kernel.block() == Wide::lanes(level));
        let inputs = [spicy_plane(6, 32)];
        let expected = reference(&fits, &Tables::default(), &inputs);
        let kernel: Arc<dyn Program> = Arc::new(kernel);
        assert_same(&expected, &run(&kernel, &Arc::default(), &inputs, 1), "a large frame");
        let two = whole(Some(VectorCount::Two)).kernel(&fits, level);
        assert!(matches!(two, Err(CompileError::Frame { bytes, limit }) if bytes > limit));
        let crowd = crowd(MAX_JIT_FRAME_BYTES / bytes + 50);
        let error = whole(None).kernel(&crowd, level).expect_err("the frame is too large");
        assert!(matches!(error, CompileError::Frame { bytes, limit } if bytes > limit), "{error}");
    }
}

/// The largest frames do not need the stack of the thread: 64 KiB of it are enough for every kernel.
#[test]
fn large_frames_run_on_small_stacks() {
    let crowd = |bytes| crowd(MAX_JIT_FRAME_BYTES / bytes - 50);
    let whole = Wide { pieces: Some(Pieces::One), ..Wide::STANDARD };
    let inputs = [spicy_plane(6, 70)];
    for level in Level::available().into_iter().filter(|&level| Wide::STANDARD.covers(level)) {
        let crowd = crowd(4 * Wide::lanes(level));
        let kernel = whole.kernel(&crowd, level).expect("the frame is as large as allowed");
        assert!(kernel.frame_bytes() > 2 * (64 << 10), "{}", kernel.frame_bytes());
        let expected = reference(&crowd, &Tables::default(), &inputs);
        let kernel: Arc<dyn Program> = Arc::new(kernel);
        let on_small_stack = || {
            let work = || assert_same(&expected, &run(&kernel, &Arc::default(), &inputs, 1), "a small stack");
            std::thread::scope(|scope| {
                let two = [(); 2].map(|()| {
                    let small = std::thread::Builder::new().stack_size(64 << 10);
                    small.spawn_scoped(scope, work).expect("a thread")
                });
                two.into_iter().for_each(|thread| thread.join().expect("it ends"));
            });
        };
        (0..3).for_each(|_| on_small_stack());
    }
}

#[test]
fn the_text_shows_the_loop_over_rows() {
    let text = Cranelift::STANDARD.clif(&function()).expect("it is within the limits");
    for part in ["fma", "f32x4", "uload32", "brif", "splat"] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
}

#[test]
fn every_block_divides_the_largest() {
    for program in kernels(&function()) {
        let block = program.block();
        assert!(block > Kernel::MAX_LANES || Kernel::MAX_LANES.is_multiple_of(block), "{program:?}");
    }
}

/// Wide code where the level has it, Cranelift's elsewhere; and what is listed as available is.
#[test]
fn a_level_has_one_generator() {
    for level in Level::ALL {
        let generator = choose(BACKENDS, level).expect("there is one for each level");
        assert_eq!(generator.name(), if level == Level::Baseline { "cranelift" } else { "wide" });
    }
    let function = Arc::new(function());
    for (generator, level) in available() {
        assert!(level.is_available(), "{generator:?}");
        generator.compile(&function, level).unwrap_or_else(|error| panic!("{generator:?}: {error}"));
    }
}
