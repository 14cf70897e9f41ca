//! What the tests share: tables by hand, numbers that break things, and the comparison with the scalar
//! reference.
#![allow(dead_code)] // Each test binary uses a part of it.

use std::sync::Arc;

use jbt_ir::domain::scalar::Scalar;
use jbt_ir::engine::{Backend, BoundProgram, Program, choose};
use jbt_ir::{
    Function, FunctionBuilder, Level, Rows, Schema, Selection, Store, Table, Tables, Value, Verified,
    interpret, verify,
};
use jbt_jit::{Allocator, BACKENDS, Check, Cranelift, Kernel, OptLevel, Pieces, VectorCount, Wide};
use jbt_testkit::bits::assert_same;

/// Numbers on which engines have been seen to differ.
pub const SPICE: [f32; 22] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -1.5,
    3.0,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    1.1e-38,
    -5e-39,
    f32::MAX,
    f32::MIN,
    1e30,
    -1e30,
    1.000_000_1,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    -f32::NAN,
];

/// Spicy numbers and random encodings.
pub fn spicy_plane(seed: u64, length: usize) -> Vec<f32> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut number = || match random.u32(0..4) {
        0 => SPICE[random.usize(0..SPICE.len())],
        1 => f32::from_bits(random.u32(..)),
        _ => random.f32() * 4.0 - 2.0,
    };
    (0..length).map(|_| number()).collect()
}

/// Points in a box around the origin.
pub fn tame_plane(seed: u64, length: usize) -> Vec<f32> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..length).map(|_| random.f32() * 4.0 - 2.0).collect()
}

/// Declares a table with this many columns.
pub fn table(b: &mut FunctionBuilder, parent: Option<Table>, columns: usize) -> Table {
    let columns = (0..columns).map(|column| format!("c{column}")).collect();
    b.table(Schema { name: "rows".to_owned(), columns, parent, slots: Vec::new() })
}

/// Rows from a closure of row and column.
pub fn rows(
    stride: usize,
    count: usize,
    active: &[u32],
    starts: &[u32],
    number: impl Fn(usize, usize) -> f32,
) -> Rows {
    let numbers = (0..count).flat_map(|row| (0..stride).map(move |column| (row, column)));
    Rows {
        count,
        stride,
        numbers: numbers.map(|(row, column)| number(row, column)).collect(),
        active: active.to_vec(),
        starts: starts.to_vec(),
        nodes: Vec::new(),
    }
}

/// Tables of these rows, in order.
pub fn tables(rows: impl IntoIterator<Item = Rows>) -> Tables {
    let mut tables = Store::new();
    for rows in rows {
        tables.push(rows);
    }
    Tables { tables }
}

/// Ends and verifies a function with outputs `o0`, `o1`, ...
pub fn finish(b: FunctionBuilder, outputs: &[Value]) -> Verified {
    let outputs: Vec<_> = outputs.iter().enumerate().map(|(i, &value)| (format!("o{i}"), value)).collect();
    verified(b.finish(&outputs))
}

/// Verifies a function.
pub fn verified(function: Function) -> Verified {
    verify(function).expect("the test's function obeys the rules")
}

/// A selection without every third row.
pub fn thinned(function: &Verified, tables: &Tables) -> Selection {
    let all = Selection::new(function.function(), tables);
    let mut masks: Vec<u8> = (0..all.len()).map(|row| u8::from(row % 3 != 1)).collect();
    let mut parts = [Selection::default()];
    all.narrow(&mut masks, &mut parts);
    let [part] = parts;
    part
}

/// What the scalar reference gives, by output plane.
pub fn reference(function: &Verified, tables: &Tables, inputs: &[Vec<f32>]) -> Vec<Vec<f32>> {
    reference_selected(function, (tables, &Selection::new(function.function(), tables)), inputs)
}

/// What the scalar reference gives with the rows of a selection, by output plane.
pub fn reference_selected(
    function: &Verified,
    (tables, selection): (&Tables, &Selection),
    inputs: &[Vec<f32>],
) -> Vec<Vec<f32>> {
    let mut outputs = vec![Vec::new(); function.function().outputs.len()];
    for point in 0..inputs[0].len() {
        let inputs: Vec<f32> = inputs.iter().map(|plane| plane[point]).collect();
        let answers = interpret::run_selected(function, tables, selection, &mut Scalar, &inputs);
        for (plane, answer) in outputs.iter_mut().zip(answers) {
            plane.push(answer);
        }
    }
    outputs
}

/// Machine code of the standard generator here.
pub fn compile(function: &Verified) -> Arc<dyn Program> {
    let generator = choose(BACKENDS, Level::best()).expect("there is one for each level");
    generator.compile(&Arc::new(function.clone()), Level::best()).expect("the test's function compiles")
}

/// A program with tables that fit it.
pub fn bind(program: &Arc<dyn Program>, tables: &Arc<Tables>) -> BoundProgram {
    BoundProgram::new(Arc::clone(program), Arc::clone(tables)).expect("the test's tables fit")
}

/// What a program gives, by output plane.
pub fn run(
    program: &Arc<dyn Program>,
    tables: &Arc<Tables>,
    inputs: &[Vec<f32>],
    outputs: usize,
) -> Vec<Vec<f32>> {
    let bound = bind(program, tables);
    run_selected(&bound, bound.all(), inputs, outputs)
}

/// What a program gives with the rows of a selection, by output plane.
pub fn run_selected(
    bound: &BoundProgram,
    selection: &Selection,
    inputs: &[Vec<f32>],
    outputs: usize,
) -> Vec<Vec<f32>> {
    let mut planes = vec![vec![-7.0_f32; inputs[0].len()]; outputs];
    let inputs: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
    let mut views: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    bound.run_selected(selection, &inputs, &mut views).expect("the test's planes fit");
    planes
}

/// A generator, a level, and whether the vectors of a value are open.
type Setting = (Box<dyn Backend>, Level, bool);

/// All settings of all generators, with the function whole, cut at folds, in pieces of a few instructions,
/// and in the smallest there are.
pub fn all_settings() -> Vec<Setting> {
    let mut all: Vec<Setting> = vec![(Box::new(Cranelift::STANDARD), Level::Baseline, true)];
    let levels: Vec<Level> =
        Level::available().into_iter().filter(|&level| Wide::STANDARD.covers(level)).collect();
    for &level in &levels {
        all.push((Box::new(Wide { check: Check::Registers, ..Wide::STANDARD }), level, true));
        all.push((Box::new(Wide::STANDARD), level, true));
    }
    let pieces = [Pieces::One, Pieces::Of(usize::MAX), Pieces::Of(7), Pieces::Of(1)].map(Some);
    for level in levels {
        for vectors in VectorCount::ALL {
            if Wide::lanes(level) * vectors.count() > Kernel::MAX_LANES {
                continue;
            }
            for pieces in pieces {
                for check in [Check::Registers, Check::FewRegisters] {
                    all.push((Box::new(Wide { vectors: Some(vectors), pieces, check }), level, false));
                }
            }
        }
    }
    for vectors in VectorCount::ALL.map(Some) {
        for opt_level in OptLevel::ALL {
            for allocator in Allocator::ALL.map(Some) {
                for pieces in pieces {
                    let cranelift = Cranelift { vectors, opt_level, allocator, pieces };
                    all.push((Box::new(cranelift), Level::Baseline, false));
                }
            }
        }
    }
    all
}

/// Asserts the bits of the first few points: of fewer than a block, of smaller blocks alone, and of larger
/// blocks with some behind.
fn check_few(
    bound: &BoundProgram,
    selection: &Selection,
    (inputs, expected): (&[Vec<f32>], &[Vec<f32>]),
    what: &str,
) {
    let block = bound.program().block();
    for length in [1, block - 1, block, 2 * block, 3 * block, 5 * block, 9 * block + 1, 17 * block] {
        let cut = |planes: &[Vec<f32>]| -> Vec<Vec<f32>> {
            planes.iter().map(|plane| plane[..length].to_vec()).collect()
        };
        let given = run_selected(bound, selection, &cut(inputs), expected.len());
        assert_same(&cut(expected), &given, &format!("{what}, {length} points"));
    }
}

/// More points than two strips of any plan have.
const POINTS: usize = 2_100;

/// Whole copies of planes, until they are longer than two strips. They are whole blocks if the planes are.
fn repeated(planes: &[Vec<f32>]) -> Vec<Vec<f32>> {
    planes.iter().map(|plane| plane.repeat(POINTS.div_ceil(plane.len()))).collect()
}

/// Asserts that every setting of every generator gives the reference's bits.
pub fn check(function: &Verified, tables: &Tables, inputs: Vec<Vec<f32>>) {
    assert!(!inputs[0].is_empty(), "a test without points tests nothing");
    let selections = [Selection::new(function.function(), tables), thinned(function, tables)];
    let expected =
        selections.each_ref().map(|selection| reference_selected(function, (tables, selection), &inputs));
    let (inputs, expected) = (repeated(&inputs), expected.map(|planes| repeated(&planes)));
    let (function, tables) = (Arc::new(function.clone()), Arc::new(tables.clone()));
    for (generator, level, is_open) in all_settings() {
        let program = generator.compile(&function, level).expect("the test's function compiles");
        let bound = bind(&program, &tables);
        for (selection, expected) in selections.iter().zip(&expected) {
            let given = run_selected(&bound, selection, &inputs, expected.len());
            let what = format!("{level} {generator:?}, {} rows", selection.len());
            assert_same(expected, &given, &what);
            if is_open {
                check_few(&bound, selection, (&inputs, expected), &what);
            }
        }
    }
}
