//! Every op against the scalar reference, bit for bit, on the numbers where engines differ.

// Elsewhere there is no machine code, and generators say so.
#![cfg(target_arch = "x86_64")]

mod common;

use common::{SPICE, check, finish, spicy_plane};
use jbt_ir::{Domain, FunctionBuilder, Op, Tables};
use jbt_jit::{CompileError, Cranelift};
use jbt_testkit::ops::{operand, reals};

/// All triples of spicy numbers, then random ones, as three planes.
fn triples() -> Vec<Vec<f32>> {
    let mut planes = vec![Vec::new(); 3];
    for a in SPICE {
        for b in SPICE {
            for c in SPICE {
                for (plane, number) in planes.iter_mut().zip([a, b, c]) {
                    plane.push(number);
                }
            }
        }
    }
    for (seed, plane) in (1..).zip(&mut planes) {
        plane.extend(spicy_plane(seed, 4096));
    }
    planes
}

#[test]
fn every_op_has_the_bits_of_the_reference() {
    for &op in Op::ALL {
        if op.is_expanded() {
            continue;
        }
        let amounts: &[u32] =
            if matches!(op, Op::Shl | Op::Shr) { &[0, 1, 9, 23, 31, 32, 47, u32::MAX] } else { &[0] };
        for &amount in amounts {
            let mut b = FunctionBuilder::new(op.name(), &["a", "b", "c"]);
            let mut args: Vec<_> = op
                .operands()
                .iter()
                .enumerate()
                .map(|(plane, &type_)| operand(&mut b, plane, type_))
                .collect();
            if matches!(op, Op::Shl | Op::Shr) {
                args[1] = b.bits_constant(amount);
            }
            let result = b.op(op, &args);
            let outputs = reals(&mut b, result, op.result());
            check(&finish(b, &outputs), &Tables::default(), triples());
        }
    }
}

#[test]
fn constant_operands_are_operands() {
    for &number in &SPICE {
        let mut b = FunctionBuilder::new("constants", &["a", "b", "c"]);
        let (a, other) = (b.input(0), b.input(1));
        let c = b.constant(number);
        let outputs = [
            b.add(a, c),
            b.sub(c, a),
            b.mul(c, a),
            b.div(c, a),
            b.fma(c, a, other),
            b.fma(a, other, c),
            b.min(a, c),
            b.min(c, a),
            b.max(a, c),
            b.max(c, a),
            b.neg(c),
            b.abs(c),
            b.sqrt(c),
            b.mul(c, c),
            b.max(c, c),
        ];
        check(&finish(b, &outputs), &Tables::default(), triples());
    }
}

/// Sequences that an optimiser knows how to make shorter, and may only where no bit changes.
#[test]
fn nothing_is_fused_folded_or_reordered() {
    let mut b = FunctionBuilder::new("tempting", &["a", "b", "c"]);
    let (x, y, z) = (b.input(0), b.input(1), b.input(2));
    let (zero, one) = (b.constant(0.0), b.constant(1.0));
    let product = b.mul(x, y);
    let negative = b.neg(x);
    let less = b.lt(x, y);
    let more = b.lt(y, x);
    let not_less = b.not(less);
    let outputs = [
        b.add(product, z),
        b.sub(product, z),
        b.add(x, zero),
        b.sub(x, zero),
        b.mul(x, zero),
        b.mul(x, one),
        b.div(x, one),
        b.sub(x, x),
        b.div(x, x),
        b.neg(negative),
        b.fma(negative, y, z),
        b.abs(negative),
        b.select(less, x, y),
        b.select(more, x, y),
        b.select(less, y, x),
        b.select(not_less, x, z),
    ];
    check(&finish(b, &outputs), &Tables::default(), triples());
}

#[test]
fn an_op_that_is_not_expanded_is_an_error_that_names_it() {
    for op in Op::ALL.iter().copied().filter(|op| op.is_expanded()) {
        let mut b = FunctionBuilder::new("raw", &["a", "b"]);
        let args = [b.input(0), b.input(1)];
        let result = b.op(op, &args[..op.operands().len()]);
        let error = Cranelift::STANDARD.kernel(&finish(b, &[result])).expect_err("it has no instruction");
        assert!(matches!(error, CompileError::Op { op: named, .. } if named == op));
        assert!(error.to_string().contains(op.name()));
    }
}
