//! Every op of the lanes domain against the scalar one: all kinds of operands, all ways in which registers
//! can coincide.

use jbt_testkit::points::OPERANDS;

use super::ops::{Chunk, Handle, Lanes, WIDTH};
use crate::domain::scalar::Scalar;
use crate::op::{Any, Op, Type, apply};

/// What a spicy number is as an operand of this type: the bits in a lane, and the operand of the scalar
/// domain.
fn operand(type_: Type, number: f32) -> (u32, Any<Scalar>) {
    match type_ {
        Type::Real => (number.to_bits(), Any::Real(number)),
        Type::Mask => (if number > 0.0 { !0 } else { 0 }, Any::Mask(number > 0.0)),
        Type::Bits => (number.to_bits(), Any::Bits(number.to_bits())),
    }
}

/// The bits that a lane has for a result of the scalar domain.
fn lane(result: Any<Scalar>) -> u32 {
    match result {
        Any::Real(number) => number.to_bits(),
        Any::Mask(truth) => {
            if truth {
                !0
            } else {
                0
            }
        }
        Any::Bits(bits) => bits,
    }
}

fn wrap<'a>(type_: Type, handle: Handle) -> Any<Lanes<'a>> {
    match type_ {
        Type::Real => Any::Real(handle),
        Type::Mask => Any::Mask(handle),
        Type::Bits => Any::Bits(handle),
    }
}

fn unwrap(result: Any<Lanes<'_>>) -> Handle {
    match result {
        Any::Real(handle) | Any::Mask(handle) | Any::Bits(handle) => handle,
    }
}

fn same(type_: Type, a: u32, b: u32) -> bool {
    a == b || type_ == Type::Real && f32::from_bits(a).is_nan() && f32::from_bits(b).is_nan()
}

/// Numbers of the operands in lane `lane` of row `row`: together the lanes go through all pairs, and through
/// many triples.
fn numbers(row: usize, lane: usize) -> [f32; 3] {
    let n = row * WIDTH + lane;
    [n, n / OPERANDS.len(), n / 7 + 3 * n].map(|n| OPERANDS[n % OPERANDS.len()])
}

/// Runs an op once. `registers[i]` is where operand i stands, or `None` for a splat; equal registers hold the
/// last one's numbers.
fn check(op: Op, registers: [Option<usize>; 3], result: usize) {
    const ROWS: usize = 14;
    const STRIDE: usize = 5;
    let types = op.operands();
    let mut file = vec![Chunk::ZERO; ROWS * STRIDE];
    for (splat, _) in OPERANDS.iter().enumerate() {
        // What operand i is in a lane, after later operands may have taken its register.
        let number = |operand: usize, row: usize, lane: usize| match registers[operand] {
            None => OPERANDS[(splat + 3 * operand) % OPERANDS.len()],
            Some(register) => {
                let last = (0..types.len()).rfind(|&other| registers[other] == Some(register)).unwrap();
                numbers(row, lane)[last]
            }
        };
        for (index, &type_) in types.iter().enumerate() {
            if let Some(register) = registers[index] {
                for row in 0..ROWS {
                    for at in 0..WIDTH {
                        file[row * STRIDE + register].0[at] = operand(type_, number(index, row, at)).0;
                    }
                }
            }
        }
        let args: Vec<Any<Lanes<'_>>> = (types.iter().enumerate())
            .map(|(index, &type_)| {
                let splat = Handle::Splat(operand(type_, number(index, 0, 0)).0);
                wrap(type_, registers[index].map_or(splat, Handle::Block))
            })
            .collect();
        let mut lanes = Lanes { file: &mut file, stride: STRIDE, result };
        let given = unwrap(apply(&mut lanes, op, &args));
        for row in 0..ROWS {
            for at in 0..WIDTH {
                let operands: Vec<(u32, Any<Scalar>)> = (types.iter().enumerate())
                    .map(|(index, &type_)| operand(type_, number(index, row, at)))
                    .collect();
                let scalars: Vec<Any<Scalar>> = operands.iter().map(|&(_, scalar)| scalar).collect();
                let expected = lane(apply(&mut Scalar, op, &scalars));
                let given = match given {
                    Handle::Block(register) => file[row * STRIDE + register].0[at],
                    Handle::Splat(bits) => bits,
                };
                let bits: Vec<u32> = operands.iter().map(|&(bits, _)| bits).collect();
                assert!(
                    same(op.result(), given, expected),
                    "{} {bits:x?} in {registers:?} to {result}: {given:x}, not {expected:x}",
                    op.name()
                );
            }
        }
    }
}

/// All ways to take `count` operands from registers 0 to 2 or from splats. Operands in one register have one
/// type.
fn shapes(op: Op) -> Vec<[Option<usize>; 3]> {
    let types = op.operands();
    let choices = [None, Some(0), Some(1), Some(2)];
    let mut shapes = Vec::new();
    for n in 0..4_usize.pow(u32::try_from(types.len()).unwrap()) {
        let shape = [n % 4, n / 4 % 4, n / 16].map(|choice| choices[choice]);
        let fits = (0..types.len()).all(|a| {
            (0..types.len()).all(|b| shape[a].is_none() || shape[a] != shape[b] || types[a] == types[b])
        });
        if fits {
            shapes.push(shape);
        }
    }
    shapes
}

#[test]
fn every_op_gives_the_bits_of_the_scalar_domain_for_blocks_and_splats_in_place_and_not() {
    for &op in Op::ALL {
        for shape in shapes(op) {
            for result in 0..4 {
                check(op, shape, result);
            }
        }
    }
}

#[test]
fn ops_on_splats_stay_splats() {
    for &op in Op::ALL {
        let mut lanes = Lanes { file: &mut [], stride: 1, result: 0 };
        let args: Vec<Any<Lanes<'_>>> =
            op.operands().iter().map(|&type_| wrap(type_, Handle::Splat(0))).collect();
        assert!(matches!(unwrap(apply(&mut lanes, op, &args)), Handle::Splat(_)), "{}", op.name());
    }
}
