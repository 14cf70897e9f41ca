//! Every form of every instruction, and every level, decoded by other people's decoder.

use iced_x86::{Decoder, DecoderOptions, Instruction, MemorySize, Mnemonic, OpKind, Register};

use jbt_ir::{Domain, FoldKind, FunctionBuilder, Level, Rule, Schema, Value, Verified, verify};

use crate::blob::Emitted;
use crate::options::{Check, Pieces, VectorCount};

use super::Wide;
use super::encode::{Encoder, Shape};
use super::inst::{Base, Binary, Condition, FmaForm, Gpr, Inst, Integer, Label, Memory, Operand, Predicate};

const AVX2: Shape = Shape { bytes: 32, has_masks: false };
const AVX512VL: Shape = Shape { bytes: 32, has_masks: true };
const AVX512: Shape = Shape { bytes: 64, has_masks: true };
const SHAPES: [Shape; 3] = [AVX2, AVX512VL, AVX512];

/// Registers at the edges of what the fields of a prefix hold.
const REGISTERS: [u8; 6] = [0, 7, 8, 15, 16, 31];

/// Displacements at the edges of one byte, scaled by what a displacement of one byte counts, or not.
const DISPLACEMENTS: [i32; 17] = [
    0,
    4,
    -4,
    32,
    64,
    127,
    128,
    -128,
    -129,
    508,
    512,
    127 * 32,
    128 * 32,
    127 * 64,
    128 * 64,
    -128 * 64,
    1 << 20,
];

const GPRS: [Gpr; 16] = [
    Gpr::Rax,
    Gpr::Rcx,
    Gpr::Rdx,
    Gpr::Rbx,
    Gpr::Rsp,
    Gpr::Rbp,
    Gpr::Rsi,
    Gpr::Rdi,
    Gpr::R8,
    Gpr::R9,
    Gpr::R10,
    Gpr::R11,
    Gpr::R12,
    Gpr::R13,
    Gpr::R14,
    Gpr::R15,
];

fn registers(shape: Shape) -> impl Iterator<Item = u8> + Clone {
    REGISTERS.into_iter().filter(move |&register| shape.has_masks || register < 16)
}

/// The decoded form of one instruction, which takes all its bytes.
fn decode(shape: Shape, inst: impl Into<Inst>) -> Instruction {
    let inst = inst.into();
    let mut encoder = Encoder::new(shape, 1);
    encoder.inst(&inst);
    let bytes = encoder.bytes;
    let mut decoder = Decoder::with_ip(64, &bytes, 0, DecoderOptions::NONE);
    let decoded = decoder.decode();
    assert!(!decoded.is_invalid(), "{inst:?} is {bytes:02x?}");
    assert_eq!(decoded.len(), bytes.len(), "{inst:?} is {bytes:02x?}, {decoded}");
    decoded
}

fn vector(shape: Shape, number: u8) -> Register {
    let first = if shape.bytes == 64 { Register::ZMM0 } else { Register::YMM0 };
    first + u32::from(number)
}

fn mask(number: u8) -> Register {
    Register::K0 + u32::from(number)
}

fn gpr(register: Gpr) -> Register {
    Register::RAX + register as u32
}

/// All operands in memory: each base, with and without an index, at each displacement.
fn memories(is_one: bool) -> Vec<Memory> {
    let mut bases: Vec<Base> = GPRS.iter().map(|&base| Base::Register(base)).collect();
    for base in [Gpr::Rax, Gpr::Rbp, Gpr::R9, Gpr::R13] {
        for index in [Gpr::Rcx, Gpr::R10, Gpr::Rbp] {
            bases.extend([1, 4].map(|scale| Base::Sum(base, index, scale)));
        }
    }
    let all = |base| DISPLACEMENTS.map(|displacement| Memory { base, displacement, is_one });
    bases.into_iter().flat_map(all).collect()
}

/// Asserts that an instruction's operand in memory is this one.
fn assert_memory(shape: Shape, decoded: &Instruction, memory: Memory, what: &str) {
    let (base, index, scale) = match memory.base {
        Base::Register(base) => (gpr(base), Register::None, 1),
        Base::Sum(base, index, scale) => (gpr(base), gpr(index), u32::from(scale)),
        Base::Constants => (Register::RIP, Register::None, 1),
    };
    assert_eq!(decoded.memory_base(), base, "{what}: {decoded}");
    assert_eq!(decoded.memory_index(), index, "{what}: {decoded}");
    assert_eq!(decoded.memory_index_scale(), scale, "{what}: {decoded}");
    assert_eq!(decoded.memory_displacement64() as i64, i64::from(memory.displacement), "{what}: {decoded}");
    let is_load_of_one = decoded.mnemonic() == Mnemonic::Vbroadcastss;
    assert_eq!(decoded.is_broadcast(), memory.is_one && !is_load_of_one, "{what}: {decoded}");
    if !memory.is_one && decoded.mnemonic() != Mnemonic::Kmovw {
        assert_eq!(decoded.memory_size().size(), shape.bytes, "{what}: {decoded}");
    }
}

/// Checks an instruction in all registers and with all operands in memory: `make` makes it of a target,
/// another register, and an operand; the decoder has to name it, and give the operands in this order.
fn check_vector(
    shape: Shape,
    mnemonic: Mnemonic,
    first: impl Fn(u8) -> Register,
    make: impl Fn(u8, u8, Operand) -> Inst,
    has_second: bool,
) {
    let last = if has_second { 2 } else { 1 };
    for (to, a) in registers(shape).flat_map(|to| registers(shape).map(move |a| (to, a))) {
        for b in registers(shape) {
            let inst = make(to, a, Operand::Register(b));
            let decoded = decode(shape, inst);
            assert_eq!(decoded.mnemonic(), mnemonic, "{inst:?}: {decoded}");
            assert_eq!(decoded.op_register(0), first(to), "{inst:?}: {decoded}");
            if has_second {
                assert_eq!(decoded.op_register(1), vector(shape, a), "{inst:?}: {decoded}");
            }
            assert_eq!(decoded.op_register(last), vector(shape, b), "{inst:?}: {decoded}");
        }
        let few = [memories(false), if shape.has_masks { memories(true) } else { Vec::new() }].concat();
        // All operands in memory for one pair of registers, and a few for the others.
        let step = if to == a { 1 } else { 41 };
        for memory in few.into_iter().step_by(step) {
            let inst = make(to, a, Operand::Memory(memory));
            let decoded = decode(shape, inst);
            assert_eq!(decoded.mnemonic(), mnemonic, "{inst:?}: {decoded}");
            assert_eq!(decoded.op_register(0), first(to), "{inst:?}: {decoded}");
            assert_eq!(decoded.op_kind(last), OpKind::Memory, "{inst:?}: {decoded}");
            assert_memory(shape, &decoded, memory, &format!("{inst:?}"));
        }
    }
}

fn mnemonic(op: Binary, is_evex: bool) -> Mnemonic {
    match op {
        Binary::Add => Mnemonic::Vaddps,
        Binary::Sub => Mnemonic::Vsubps,
        Binary::Mul => Mnemonic::Vmulps,
        Binary::Div => Mnemonic::Vdivps,
        Binary::Min => Mnemonic::Vminps,
        Binary::Max => Mnemonic::Vmaxps,
        Binary::And if is_evex => Mnemonic::Vpandd,
        Binary::Or if is_evex => Mnemonic::Vpord,
        Binary::Xor if is_evex => Mnemonic::Vpxord,
        Binary::And => Mnemonic::Vpand,
        Binary::Or => Mnemonic::Vpor,
        Binary::Xor => Mnemonic::Vpxor,
        Binary::IntAdd => Mnemonic::Vpaddd,
        Binary::IntSub => Mnemonic::Vpsubd,
    }
}

#[test]
fn arithmetic_is_encoded() {
    for shape in SHAPES {
        for op in Binary::ALL {
            let is_logic = matches!(op, Binary::And | Binary::Or | Binary::Xor);
            // With 256 bits, bitwise ops have two names; both are looked at below.
            if is_logic && shape == AVX512VL {
                continue;
            }
            let first = |number| vector(shape, number);
            let make = |to, a, b| Inst::Binary { op, to, a, b };
            check_vector(shape, mnemonic(op, shape.bytes == 64), first, make, true);
        }
        let first = |number| vector(shape, number);
        check_vector(shape, Mnemonic::Vsqrtps, first, |to, _, a| Inst::Sqrt { to, a }, false);
        for (form, mnemonic) in [
            (FmaForm::F132, Mnemonic::Vfmadd132ps),
            (FmaForm::F213, Mnemonic::Vfmadd213ps),
            (FmaForm::F231, Mnemonic::Vfmadd231ps),
        ] {
            check_vector(shape, mnemonic, first, |to, b, c| Inst::Fma { form, to, b, c }, true);
        }
    }
    for op in [Binary::And, Binary::Or, Binary::Xor] {
        for (register, is_evex) in [(0, false), (15, false), (16, true), (31, true)] {
            let inst = Inst::Binary { op, to: register, a: 0, b: Operand::Register(7) };
            assert_eq!(decode(AVX512VL, inst).mnemonic(), mnemonic(op, is_evex));
        }
    }
}

#[test]
fn comparisons_and_blends_are_encoded() {
    for shape in SHAPES {
        for predicate in Predicate::ALL {
            let make = |to: u8, a, b| {
                let to = if shape.has_masks { 1 + to % 7 } else { to };
                Inst::Compare { predicate, to, a, b }
            };
            let first = |to: u8| if shape.has_masks { mask(1 + to % 7) } else { vector(shape, to) };
            check_vector(shape, Mnemonic::Vcmpps, first, make, true);
            let inst = make(0, 0, Operand::Memory(Memory::at(Gpr::Rax, 4096)));
            let immediate = decode(shape, inst).immediate8();
            assert_eq!(immediate, predicate as u8);
        }
        let first = |number| vector(shape, number);
        if shape.has_masks {
            for number in 1..8 {
                let make = |to, no, yes| Inst::Blend { to, mask: number, no, yes };
                check_vector(shape, Mnemonic::Vblendmps, first, make, true);
                let inst = make(0, 0, Operand::Register(0));
                assert_eq!(decode(shape, inst).op_mask(), mask(number));
            }
        } else {
            for number in [0, 7, 8, 15] {
                let make = |to, no, yes| Inst::Blend { to, mask: number, no, yes };
                check_vector(shape, Mnemonic::Vblendvps, first, make, true);
                let decoded = decode(shape, make(0, 0, Operand::Register(0)));
                assert_eq!(decoded.op_register(3), vector(shape, number));
            }
        }
    }
}

#[test]
fn moves_and_shifts_are_encoded() {
    for shape in SHAPES {
        let first = |number| vector(shape, number);
        for (to, from) in registers(shape).flat_map(|to| registers(shape).map(move |from| (to, from))) {
            let decoded = decode(shape, Inst::Move { to, from });
            assert_eq!(decoded.mnemonic(), Mnemonic::Vmovaps);
            assert_eq!((decoded.op_register(0), decoded.op_register(1)), (first(to), first(from)));
            for (left, mnemonic) in [(true, Mnemonic::Vpslld), (false, Mnemonic::Vpsrld)] {
                for amount in [0, 1, 31] {
                    let decoded = decode(shape, Inst::Shift { left, to, a: from, amount });
                    assert_eq!(decoded.mnemonic(), mnemonic);
                    assert_eq!((decoded.op_register(0), decoded.op_register(1)), (first(to), first(from)));
                    assert_eq!(decoded.immediate8(), amount);
                }
            }
        }
        for register in registers(shape) {
            let decoded = decode(shape, Inst::Zero { to: register });
            assert!(matches!(decoded.mnemonic(), Mnemonic::Vpxor | Mnemonic::Vpxord));
            assert!((0..3).all(|op| decoded.op_register(op) == Register::XMM0 + u32::from(register)));
            for memory in memories(false).into_iter().chain(memories(true)) {
                let what = format!("{memory:?}");
                let load = decode(shape, Inst::Load { to: register, from: memory });
                let name = if memory.is_one { Mnemonic::Vbroadcastss } else { Mnemonic::Vmovups };
                assert_eq!((load.mnemonic(), load.op_register(0)), (name, first(register)));
                assert_memory(shape, &load, memory, &what);
                if memory.is_one {
                    assert_eq!(load.memory_size(), MemorySize::Float32);
                    continue;
                }
                let store = decode(shape, Inst::Store { to: memory, from: register });
                assert_eq!((store.mnemonic(), store.op_register(1)), (Mnemonic::Vmovups, first(register)));
                assert_memory(shape, &store, memory, &what);
            }
        }
    }
}

#[test]
fn masks_are_encoded() {
    for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
        for (inst, mnemonic) in [
            (Inst::MaskAnd { to: 7 - a, a, b }, Mnemonic::Kandw),
            (Inst::MaskOr { to: 7 - a, a, b }, Mnemonic::Korw),
        ] {
            let decoded = decode(AVX512, inst);
            assert_eq!(decoded.mnemonic(), mnemonic);
            let operands = [0, 1, 2].map(|index| decoded.op_register(index));
            assert_eq!(operands, [mask(7 - a), mask(a), mask(b)]);
        }
        for (inst, mnemonic) in [
            (Inst::MaskNot { to: a, a: b }, Mnemonic::Knotw),
            (Inst::MaskMove { to: a, from: b }, Mnemonic::Kmovw),
        ] {
            let decoded = decode(AVX512, inst);
            assert_eq!(decoded.mnemonic(), mnemonic);
            assert_eq!([0, 1].map(|index| decoded.op_register(index)), [mask(a), mask(b)]);
        }
    }
    for memory in memories(false) {
        let load = decode(AVX512, Inst::MaskLoad { to: 5, from: memory });
        assert_eq!((load.mnemonic(), load.op_register(0)), (Mnemonic::Kmovw, mask(5)));
        assert_memory(AVX512, &load, memory, "a mask");
        let store = decode(AVX512, Inst::MaskStore { to: memory, from: 3 });
        assert_eq!((store.mnemonic(), store.op_register(1)), (Mnemonic::Kmovw, mask(3)));
        assert_memory(AVX512, &store, memory, "a mask");
    }
}

#[test]
fn tests_for_zero_are_encoded() {
    for register in registers(AVX2) {
        let decoded = decode(AVX2, Inst::Test { a: register });
        assert_eq!(decoded.mnemonic(), Mnemonic::Vptest);
        assert_eq!([0, 1].map(|index| decoded.op_register(index)), [vector(AVX2, register); 2]);
    }
    for shape in [AVX512VL, AVX512] {
        for (to, a) in (0..8).flat_map(|to| registers(shape).map(move |a| (to, a))) {
            let decoded = decode(shape, Inst::TestToMask { to, a });
            assert_eq!(decoded.mnemonic(), Mnemonic::Vptestmd);
            let expected = [mask(to), vector(shape, a), vector(shape, a)];
            assert_eq!([0, 1, 2].map(|index| decoded.op_register(index)), expected);
        }
        for a in 0..8 {
            let decoded = decode(shape, Inst::TestMask { a });
            assert_eq!(decoded.mnemonic(), Mnemonic::Kortestw);
            assert_eq!([0, 1].map(|index| decoded.op_register(index)), [mask(a); 2]);
        }
    }
}

#[test]
fn integers_are_encoded() {
    for (to, memory) in GPRS.iter().flat_map(|&to| memories(false).into_iter().map(move |m| (to, m))) {
        for (inst, mnemonic, register) in [
            (Integer::LoadPointer { to, from: memory }, Mnemonic::Mov, 0),
            (Integer::StorePointer { to: memory, from: to }, Mnemonic::Mov, 1),
            (Integer::AddPointer { to, from: memory }, Mnemonic::Add, 0),
            (Integer::SubPointer { to, from: memory }, Mnemonic::Sub, 0),
            (Integer::Address { to, of: memory }, Mnemonic::Lea, 0),
            (Integer::TakeIfAbove { to, from: memory }, Mnemonic::Cmova, 0),
            (Integer::CompareMemory { a: to, b: memory }, Mnemonic::Cmp, 0),
        ] {
            let decoded = decode(AVX2, inst);
            assert_eq!(decoded.mnemonic(), mnemonic, "{inst:?}: {decoded}");
            assert_eq!(decoded.op_register(register), gpr(to), "{inst:?}: {decoded}");
            assert_eq!(decoded.memory_displacement64() as i64, i64::from(memory.displacement));
        }
        let word = decode(AVX2, Integer::LoadWord { to, from: memory });
        assert_eq!((word.mnemonic(), word.op_register(0)), (Mnemonic::Mov, Register::EAX + to as u32));
    }
    for (a, b) in GPRS.iter().flat_map(|&a| GPRS.map(|b| (a, b))) {
        for (inst, mnemonic) in [
            (Integer::AddRegister { to: a, from: b }, Mnemonic::Add),
            (Integer::Compare64 { a, b }, Mnemonic::Cmp),
        ] {
            let decoded = decode(AVX2, inst);
            assert_eq!(decoded.mnemonic(), mnemonic);
            assert_eq!((decoded.op_register(0), decoded.op_register(1)), (gpr(a), gpr(b)));
        }
    }
    for (to, number) in GPRS.iter().flat_map(|&to| [0, 1, -1, 127, 128, -128, -129, 1 << 30].map(|n| (to, n)))
    {
        let add = decode(AVX2, Integer::AddConstant { to, number });
        assert_eq!((add.mnemonic(), add.op_register(0)), (Mnemonic::Add, gpr(to)));
        assert_eq!(add.immediate(1) as i64, i64::from(number));
        let multiply = decode(AVX2, Integer::Multiply { to, number });
        assert_eq!((multiply.mnemonic(), multiply.op_register(0)), (Mnemonic::Imul, gpr(to)));
        assert_eq!(multiply.immediate(2) as i64, i64::from(number));
        let clear = decode(AVX2, Integer::ClearRegister { to });
        assert_eq!((clear.mnemonic(), clear.op_register(0)), (Mnemonic::Xor, Register::EAX + to as u32));
    }
}

/// Jumps in both directions, near and far, and constants before an immediate and without one.
#[test]
fn jumps_and_constants_find_their_targets() {
    for distance in [1, 20, 40, 2_000] {
        let mut encoder = Encoder::new(AVX2, 2);
        let (back, forth) = (Label(0), Label(1));
        encoder.inst(&Inst::Jump { condition: Condition::Equal, to: forth });
        encoder.inst(&Inst::Here(back));
        for _ in 0..distance {
            encoder.inst(&Inst::Move { to: 1, from: 2 });
        }
        for condition in [Condition::Below, Condition::NotEqual] {
            encoder.inst(&Inst::Jump { condition, to: back });
        }
        encoder.inst(&Inst::Here(forth));
        let memory = Memory { base: Base::Constants, displacement: 32, is_one: false };
        let b = Operand::Memory(memory);
        encoder.inst(&Inst::Binary { op: Binary::Add, to: 1, a: 2, b });
        encoder.inst(&Inst::Compare { predicate: Predicate::Less, to: 1, a: 2, b });
        let (back_at, code) = (6, encoder.bytes.len());
        let bytes = encoder.finish(&[7; 64]);
        assert_eq!(bytes.len(), code.next_multiple_of(32) + 64);
        let all: Vec<Instruction> =
            Decoder::with_ip(64, &bytes[..code], 0, DecoderOptions::NONE).into_iter().collect();
        let [first, .., below, not_equal, add, compare] = &all[..] else { panic!("there are as many") };
        assert_eq!((first.mnemonic(), first.near_branch_target()), (Mnemonic::Je, add.ip()));
        assert_eq!((below.mnemonic(), below.near_branch_target()), (Mnemonic::Jb, back_at));
        assert_eq!((not_equal.mnemonic(), not_equal.near_branch_target()), (Mnemonic::Jne, back_at));
        for inst in [add, compare] {
            assert_eq!(inst.ip_rel_memory_address(), code.next_multiple_of(32) as u64 + 32);
        }
    }
}

/// A sum over rows with every kind of value: masks, bits, a number that is the same in all lanes, one from
/// outside of the loop.
fn every_kind() -> Verified {
    let mut b = FunctionBuilder::new("kinds", &["x", "y", "z", "w"]);
    let columns = vec!["c".to_owned(), "d".to_owned()];
    let t = b.table(Schema { name: "t".to_owned(), columns, parent: None, slots: Vec::new() });
    let inputs = [0, 1, 2, 3].map(|index| b.input(index));
    let outside = inputs.into_iter().reduce(|a, other| b.fma(a, other, a)).expect("there are inputs");
    let below = b.lt(outside, inputs[3]);
    let zero = b.constant(0.0);
    let start = below_as_real(&mut b, below);
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero, start]);
    let (c, d) = (b.column(t, 0), b.column(t, 1));
    let uniform = b.div(c, d);
    let (less, same) = (b.le(acc[0], c), b.eq(outside, d));
    let either = b.either(less, same);
    let neither = b.not(either);
    let both = b.both(neither, below);
    let root = b.sqrt(outside);
    let chosen = b.select(both, root, uniform);
    let (bits, by) = (b.to_bits(chosen), b.bits_constant(3));
    let (left, right) = (b.shl(bits, by), b.shr(bits, by));
    let bits = b.int_add(left, right);
    let term = b.from_bits(bits);
    let next = [b.max(acc[1], term), b.min(acc[0], term)];
    let out = b.end_fold(&next);
    let outputs = [("a".to_owned(), out[0]), ("b".to_owned(), out[1])];
    verify(b.finish(&outputs)).expect("it obeys the rules")
}

fn below_as_real(b: &mut FunctionBuilder, mask: Value) -> Value {
    let (one, two) = (b.constant(1.0), b.constant(2.0));
    b.select(mask, one, two)
}

/// Asserts that a function is instructions from its first byte to its last, of at most so many bits.
fn assert_decoded(code: &[u8], may_be_wide: bool) {
    let mut last = None;
    for inst in Decoder::with_ip(64, code, 0, DecoderOptions::NONE) {
        assert!(!inst.is_invalid(), "at {}", inst.ip());
        let is_wide = (0..inst.op_count()).any(|op| inst.op_register(op).is_zmm());
        assert!(!is_wide || may_be_wide, "{inst}");
        last = Some(inst.mnemonic());
    }
    assert_eq!(last, Some(Mnemonic::Ret));
}

/// On any machine: each level is emitted, checked, and decoded from the first byte of the code to the last.
#[test]
fn every_level_is_emitted_and_decoded() {
    let function = every_kind();
    for level in Level::ALL {
        for vectors in [None, Some(VectorCount::One), Some(VectorCount::Two), Some(VectorCount::Four)] {
            for pieces in [Pieces::One, Pieces::Of(3)] {
                for check in [Check::Registers, Check::FewRegisters] {
                    let wide = Wide { vectors, pieces: Some(pieces), check };
                    let emitted = wide.emit(&function, level).expect("it is emitted, and right");
                    let Emitted { blocks, rest } = emitted;
                    let lanes = Wide::lanes(level.max(Level::Avx2));
                    assert_eq!(rest.is_some(), vectors.is_none() && blocks.lanes > lanes, "{level}");
                    assert!(rest.iter().all(|rest| rest.lanes == lanes), "{level}");
                    assert_decoded(&blocks.bytes[..blocks.code_bytes], level == Level::Avx512);
                    if let Some(rest) = &rest {
                        assert_decoded(&rest.bytes[..rest.code_bytes], level == Level::Avx512);
                    }
                }
            }
        }
    }
}
