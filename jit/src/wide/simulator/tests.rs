//! Wide code of every level against the scalar reference and, where the CPU has the level, against itself.

use std::sync::Arc;

use jbt_ir::domain::scalar::Scalar;
use jbt_ir::engine::BoundProgram;
use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{
    Entity, FunctionBuilder, Level, Op, Selection, Table, Tables, Value, Verified, interpret, verify,
};
use jbt_testkit::bits::assert_same;
use jbt_testkit::ops::{operand, reals};

use super::machine::MachineFault;
use super::memory::Call;
use super::run;
use crate::blob::{CodeBlob, Emitted};
use crate::options::{Check, Pieces, VectorCount};
use crate::wide::Wide;
use crate::wide::encode::{Encoder, Shape};
use crate::wide::inst::{Base, Condition, Gpr, Inst, Integer, Label, Memory};

#[path = "../../../../ir/tests/common/random.rs"]
#[allow(dead_code, reason = "tests of other crates use more of it")]
mod random;

/// Functions that are run.
const FUNCTIONS: u64 = 40;
/// Points of a function: one block of the largest kind, and a smaller one behind it.
const POINTS: usize = 80;

/// A function with rows, points, and what the reference gives.
struct Case {
    function: Verified,
    tables: Tables,
    selection: Selection,
    inputs: Vec<Vec<f32>>,
    expected: Vec<Vec<f32>>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let function = random::function(seed, 20 + seed as usize * 3);
        let tables = random::tables(&function, seed);
        let function = verify(run_pipeline(function, PIPELINE, &mut |_, _| {})).expect("it obeys the rules");
        let selection = Selection::new(function.function(), &tables);
        let mut random = fastrand::Rng::with_seed(!seed);
        let inputs: Vec<Vec<f32>> = random::INPUTS
            .iter()
            .map(|_| (0..POINTS).map(|_| random::number(&mut random)).collect())
            .collect();
        let mut expected = vec![Vec::new(); function.function().outputs.len()];
        for point in 0..POINTS {
            let at: Vec<f32> = inputs.iter().map(|plane| plane[point]).collect();
            let answers = interpret::run_selected(&function, &tables, &selection, &mut Scalar, &at);
            expected
                .iter_mut()
                .zip(answers)
                .for_each(|(plane, answer): (&mut Vec<f32>, f32)| plane.push(answer));
        }
        Self { function, tables, selection, inputs, expected }
    }

    /// What the simulator makes of code for these points.
    fn simulate(
        &self,
        blob: &CodeBlob,
        points: std::ops::Range<usize>,
    ) -> Result<Vec<Vec<f32>>, MachineFault> {
        let tables: Vec<_> = (0..self.tables.tables.len())
            .map(|index| {
                let table = Table::new(index);
                let (active, starts) = (self.selection.active(table), self.selection.starts(table));
                (&self.tables.tables[table].numbers[..], active, starts)
            })
            .collect();
        let inputs = cut(&self.inputs, points);
        run(blob, &Call { inputs: &inputs, outputs: self.expected.len(), tables: &tables })
    }

    /// What this CPU makes of the same code.
    fn execute(&self, (wide, level): (&Wide, Level), points: usize) -> Vec<Vec<f32>> {
        let kernel = wide.kernel(&self.function, level).expect("the CPU has the level");
        let bound = BoundProgram::new(Arc::new(kernel), Arc::new(self.tables.clone())).expect("the rows fit");
        let inputs = cut(&self.inputs, 0..points);
        let inputs: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
        let mut planes = vec![vec![0.0; points]; self.expected.len()];
        let mut outputs: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        bound.run(&inputs, &mut outputs).expect("the planes fit");
        planes
    }
}

fn cut(planes: &[Vec<f32>], points: std::ops::Range<usize>) -> Vec<Vec<f32>> {
    planes.iter().map(|plane| plane[points.clone()].to_vec()).collect()
}

/// The settings that a function is emitted with: different ones for each function, all for all together.
fn settings(seed: u64) -> impl Iterator<Item = (Wide, Level)> {
    let vectors = [None, Some(VectorCount::One), Some(VectorCount::Two), Some(VectorCount::Four)];
    let pieces = [None, Some(Pieces::One), Some(Pieces::Of(7))][seed as usize % 3];
    let check = [Check::Registers, Check::FewRegisters][seed as usize / 3 % 2];
    [Level::Avx2, Level::Avx512Vl, Level::Avx512]
        .into_iter()
        .flat_map(move |level| vectors.map(|vectors| (Wide { vectors, pieces, check }, level)))
}

#[test]
#[expect(clippy::print_stdout, reason = "it says which levels ran on this CPU")]
fn simulated_code_has_the_bits_of_the_reference_and_of_the_cpu() {
    let mut ran = [0; Level::ALL.len()];
    for seed in 0..FUNCTIONS {
        let case = Case::new(seed);
        for (wide, level) in settings(seed) {
            let Emitted { blocks, rest } = wide.emit(&case.function, level).expect("it is short");
            let whole = POINTS / blocks.lanes * blocks.lanes;
            let mut simulated = case.simulate(&blocks, 0..whole).unwrap_or_else(|fault| panic!("{fault}"));
            if let Some(rest) = rest {
                let left = case.simulate(&rest, whole..POINTS).unwrap_or_else(|fault| panic!("{fault}"));
                simulated.iter_mut().zip(left).for_each(|(plane, left)| plane.extend(left));
            }
            let points = simulated[0].len();
            let what = format!("function {seed}, {level}, {wide:?}");
            assert_same(&cut(&case.expected, 0..points), &simulated, &what);
            if level.is_available() {
                assert_same(&simulated, &case.execute((&wide, level), points), &what);
                ran[level as usize] += 1;
            }
        }
    }
    println!("runs of the CPU itself, by level: {ran:?}");
    for level in Level::ALL.into_iter().filter(|&level| level > Level::Baseline) {
        assert_eq!(ran[level as usize] > 0, level.is_available(), "{level}");
    }
}

/// All ops of one operand, each with an output or two of reals.
fn ops_of_one_operand() -> Verified {
    let mut b = FunctionBuilder::new("ops", &["x"]);
    let mut outputs: Vec<(String, Value)> = Vec::new();
    for &op in Op::ALL.iter().filter(|op| op.operands().len() == 1 && !op.is_slope()) {
        let operand = operand(&mut b, 0, op.operands()[0]);
        let value = b.op(op, &[operand]);
        let reals = reals(&mut b, value, op.result());
        outputs.extend(reals.into_iter().enumerate().map(|(n, real)| (format!("{}{n}", op.name()), real)));
    }
    verify(run_pipeline(b.finish(&outputs), PIPELINE, &mut |_, _| {})).expect("it obeys the rules")
}

/// Inputs of each op, evenly over all 2^32 bit patterns.
const INPUTS: u32 = 1 << 20;
/// Inputs of one run: the machine ends code that takes too many steps.
const AT_ONCE: usize = 1 << 12;

#[test]
fn simulated_ops_of_one_operand_have_the_bits_of_the_reference() {
    let function = ops_of_one_operand();
    let (tables, names) = (Tables::default(), &function.function().outputs);
    let selection = Selection::new(function.function(), &tables);
    let wide = Wide { vectors: None, pieces: None, check: Check::Registers };
    let blobs = [Level::Avx2, Level::Avx512Vl, Level::Avx512]
        .map(|level| (level, wide.emit(&function, level).expect("it is short").blocks));
    for first in (0..INPUTS).step_by(AT_ONCE) {
        // Each upper part once, and lower parts that are not round.
        let input = |n: u32| f32::from_bits(n << 12 | n.wrapping_mul(0x9e37_79b1) >> 20);
        let inputs: Vec<f32> = (first..first + AT_ONCE as u32).map(input).collect();
        let mut expected = vec![Vec::with_capacity(AT_ONCE); names.len()];
        for &x in &inputs {
            let answers = interpret::run_selected(&function, &tables, &selection, &mut Scalar, &[x]);
            expected.iter_mut().zip(answers).for_each(|(plane, answer): (&mut Vec<f32>, f32)| {
                plane.push(answer);
            });
        }
        let inputs = [inputs];
        let call = Call { inputs: &inputs, outputs: names.len(), tables: &[] };
        for (level, blob) in &blobs {
            let simulated = run(blob, &call).unwrap_or_else(|fault| panic!("{fault}"));
            assert_same(&expected, &simulated, &format!("{level}, inputs from {first}"));
        }
    }
}

/// What the simulator says of a few instructions, as a function of one input and one output plane.
fn fault_of(insts: &[Inst]) -> String {
    let mut encoder = Encoder::new(Shape { bytes: 32, has_masks: false }, 1);
    insts.iter().for_each(|inst| encoder.inst(inst));
    encoder.bytes.push(0xC3);
    let code_bytes = encoder.bytes.len();
    let bytes = encoder.finish(&[0; 32]);
    let blob = CodeBlob { bytes, code_bytes, constants: 32, frame_bytes: 64, lanes: 8 };
    let call = Call { inputs: &[vec![1.0; 8]], outputs: 1, tables: &[] };
    run(&blob, &call).err().map_or(String::new(), |fault| fault.to_string())
}

#[test]
fn what_code_may_not_do_is_a_fault() {
    let plane = |plane: i32| Integer::LoadPointer { to: Gpr::Rax, from: Memory::at(Gpr::Rdi, 8 * plane) };
    let at = |base, displacement| Memory::at(base, displacement);
    let load = |from| Inst::Load { to: 0, from };
    let store = |to| Inst::Store { to, from: 0 };
    let constant = |displacement| Memory { base: Base::Constants, displacement, is_one: false };
    let clear = |to| Inst::from(Integer::ClearRegister { to });
    let cases: [(&[Inst], &str); 11] = [
        (&[plane(0).into(), load(at(Gpr::Rax, 0))], "not cleared"),
        (&[plane(0).into(), load(at(Gpr::Rax, 4))], "there are no 32 bytes"),
        (&[plane(0).into(), load(at(Gpr::Rax, -4))], "there are no 32 bytes"),
        (&[plane(0).into(), store(at(Gpr::Rax, 0))], "nobody may write"),
        (&[plane(1).into(), store(at(Gpr::Rax, 4))], "there are no 32 bytes"),
        (&[plane(2).into()], "there are no 8 bytes"),
        (&[load(constant(4))], "there are no 32 bytes"),
        (&[load(at(Gpr::Rsp, 0))], "there are no 32 bytes"),
        (&[clear(Gpr::Rbx)], "registers are not as they were"),
        (&[Integer::AddConstant { to: Gpr::Rsp, number: -8 }.into()], "where no instruction begins"),
        (
            &[
                Inst::Here(Label(0)),
                Integer::Compare64 { a: Gpr::Rax, b: Gpr::Rax }.into(),
                Inst::Jump { condition: Condition::Equal, to: Label(0) },
            ],
            "does not end",
        ),
    ];
    for (insts, expected) in cases {
        let fault = fault_of(insts);
        assert!(fault.contains(expected), "{insts:?}: {fault}");
    }
    assert_eq!(fault_of(&[plane(0).into(), clear(Gpr::Rax)]), "");
}
