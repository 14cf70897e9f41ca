//! Folds against the scalar reference, bit for bit, with every setting of the compiler.

// Elsewhere there is no machine code, and generators say so.
#![cfg(target_arch = "x86_64")]

mod common;

use common::{SPICE, check, finish, rows, spicy_plane, table, tables, tame_plane};
use jbt_ir::pass::gates;
use jbt_ir::{Domain, FoldKind, FunctionBuilder, Rule, Tables, Value, Verified};

/// Points that tell rows apart, and points that break things.
fn points() -> Vec<Vec<f32>> {
    (0..3).map(|axis| [tame_plane(axis, 32), spicy_plane(axis + 10, 64)].concat()).collect()
}

/// The sum over rows of `c0 * x + c1`.
fn sum() -> Verified {
    let mut b = FunctionBuilder::new("sum", &["x", "y", "z"]);
    let t = table(&mut b, None, 2);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let (c0, c1) = (b.column(t, 0), b.column(t, 1));
    let term = b.fma(c0, x, c1);
    let next = b.add(acc[0], term);
    let out = b.end_fold(&[next]);
    finish(b, &out)
}

/// A number that depends on both, with signs, and spice now and then.
fn number(row: usize, column: usize) -> f32 {
    if row % 7 == 6 { SPICE[(row + column) % SPICE.len()] } else { (row as f32 - 3.5) * 0.37 + column as f32 }
}

#[test]
fn a_sum_runs_over_the_active_rows_in_order() {
    for active in [&[0_u32, 1, 2, 3, 4][..], &[1, 4], &[3], &[0, 6, 9, 11]] {
        let rows = rows(2, 12, active, &[0, active.len() as u32], number);
        check(&sum(), &tables([rows]), points());
    }
}

#[test]
fn no_active_rows_leave_the_initial_accumulators() {
    check(&sum(), &tables([rows(2, 12, &[], &[0, 0], number)]), points());
    check(&sum(), &tables([rows(2, 0, &[], &[0, 0], number)]), points());
}

#[test]
fn accumulators_may_swap_places() {
    let mut b = FunctionBuilder::new("swap", &["x", "y", "z"]);
    let t = table(&mut b, None, 1);
    let initial = [b.input(0), b.input(1), b.input(2)];
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &initial);
    let c = b.column(t, 0);
    let changed = b.mul(acc[2], c);
    let out = b.end_fold(&[acc[1], acc[0], changed]);
    let difference = b.sub(out[0], out[1]);
    let function = finish(b, &[out[0], out[1], out[2], difference]);
    for count in 0..4_u32 {
        let active: Vec<u32> = (0..count).collect();
        check(&function, &tables([rows(1, 5, &active, &[0, count], number)]), points());
    }
}

#[test]
fn accumulators_may_be_masks_and_bits() {
    let mut b = FunctionBuilder::new("types", &["x", "y", "z"]);
    let t = table(&mut b, None, 2);
    let (x, y, zero) = (b.input(0), b.input(1), b.constant(0.0));
    let never = b.lt(zero, zero);
    let seed = b.bits_constant(0x9E37_79B9);
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[never, seed, zero]);
    let (c0, c1) = (b.column(t, 0), b.column(t, 1));
    let inside = b.lt(x, c0);
    let any = b.either(acc[0], inside);
    let (seven, encoding) = (b.bits_constant(7), b.to_bits(c1));
    let shifted = b.shl(acc[1], seven);
    let hash = b.bit_xor(shifted, encoding);
    let kept = b.select(acc[0], acc[2], c1);
    let out = b.end_fold(&[any, hash, kept]);
    let (mantissa, one) = (b.bits_constant(0x007F_FFFF), b.bits_constant(0x3F80_0000));
    let low = b.bit_and(out[1], mantissa);
    let low = b.bit_or(low, one);
    let outputs = [b.select(out[0], x, y), b.from_bits(low), out[2]];
    let function = finish(b, &outputs);
    check(&function, &tables([rows(2, 9, &[0, 2, 3, 8], &[0, 4], number)]), points());
}

#[test]
fn values_from_outside_are_seen_inside() {
    let mut b = FunctionBuilder::new("captured", &["x", "y", "z"]);
    let t = table(&mut b, None, 2);
    let (x, y, z) = (b.input(0), b.input(1), b.input(2));
    let outside = b.fma(x, y, z);
    let mask = b.lt(x, y);
    let initial = b.constant(-0.0);
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[initial, initial]);
    let (c0, c1) = (b.column(t, 0), b.column(t, 1));
    let both = b.mul(c0, c1); // Of the row alone: the same in all lanes.
    let term = b.select(mask, outside, both);
    let scaled = b.mul(term, c0);
    let next = [b.add(acc[0], scaled), b.max(acc[1], both)];
    let out = b.end_fold(&next);
    let last = b.add(out[0], outside);
    let function = finish(b, &[last, out[1]]);
    check(&function, &tables([rows(2, 6, &[0, 1, 2, 4, 5], &[0, 5], number)]), points());
}

#[test]
fn folds_follow_one_another() {
    let mut b = FunctionBuilder::new("sequence", &["x", "y", "z"]);
    let t = [table(&mut b, None, 1), table(&mut b, None, 3), table(&mut b, None, 2)];
    let mut carried = b.input(0);
    let constant = b.constant(1.25);
    for (index, &t) in t.iter().enumerate() {
        let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[carried, constant]);
        let c = b.column(t, index % 2);
        let scaled = b.fma(acc[0], constant, c);
        let next = [b.min(scaled, acc[1]), b.add(acc[1], c)];
        let out = b.end_fold(&next);
        carried = b.add(out[0], out[1]);
    }
    let function = finish(b, &[carried]);
    let rows = [
        rows(1, 3, &[0, 2], &[0, 2], number),
        rows(3, 4, &[], &[0, 0], number),
        rows(2, 8, &[1, 6, 7], &[0, 3], number),
    ];
    check(&function, &tables(rows), points());
}

/// Three levels: each row of t0 owns rows of t1, each of these rows of t2. Columns of all levels are used
/// inside.
fn nested() -> Verified {
    let mut b = FunctionBuilder::new("nested", &["x", "y", "z"]);
    let t0 = table(&mut b, None, 2);
    let t1 = table(&mut b, Some(t0), 1);
    let t2 = table(&mut b, Some(t1), 2);
    let (x, y, zero) = (b.input(0), b.input(1), b.constant(0.0));
    let outer = b.begin_fold(t0, (FoldKind::Rows, Rule::Neutral), &[zero, x]);
    let a0 = b.column(t0, 0);
    let shifted = b.sub(x, a0);
    let middle = b.begin_fold(t1, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let b0 = b.column(t1, 0);
    let scale = b.mul(b0, a0);
    let inner = b.begin_fold(t2, (FoldKind::Rows, Rule::Neutral), &[middle[0]]);
    let (c0, c1) = (b.column(t2, 0), b.column(t2, 1));
    let term = b.fma(shifted, c0, c1);
    let term = b.mul(term, scale);
    let next = b.add(inner[0], term);
    let inner = b.end_fold(&[next]);
    let after = b.fma(b0, y, inner[0]); // A column of this level after the loop inside it.
    let middle = b.end_fold(&[after]);
    let a1 = b.column(t0, 1);
    let value = b.mul(middle[0], a1);
    let next = [b.max(outer[0], value), b.add(outer[1], value)];
    let out = b.end_fold(&next);
    finish(b, &out)
}

#[test]
fn nested_folds_run_over_the_rows_that_the_parent_owns() {
    // Inactive rows at every level, and parents that own nothing.
    let all = [
        rows(2, 4, &[0, 1, 3], &[0, 3], number),
        rows(1, 6, &[0, 2, 3, 5], &[0, 2, 2, 3, 4], number),
        rows(2, 9, &[1, 2, 4, 5, 8], &[0, 2, 2, 2, 3, 3, 5], number),
    ];
    check(&nested(), &tables(all), points());
    let none = [
        rows(2, 4, &[], &[0, 0], number),
        rows(1, 6, &[0], &[0, 1, 1, 1, 1], number),
        rows(2, 9, &[1], &[0, 1, 1, 1, 1, 1, 1], number),
    ];
    check(&nested(), &tables(none), points());
}

/// A loop over all rows of a table inside a loop over another, which does not own them; masks, bits and one
/// value twice go round in it.
#[test]
fn folds_may_stand_in_folds_that_own_nothing() {
    let mut b = FunctionBuilder::new("types", &["x", "y", "z"]);
    let (t0, t1) = (table(&mut b, None, 1), table(&mut b, None, 2));
    let (x, y, zero) = (b.input(0), b.input(1), b.constant(0.0));
    let never = b.lt(zero, zero);
    let seed = b.bits_constant(0x9E37_79B9);
    let root = b.sqrt(x);
    let outer = b.begin_fold(t0, (FoldKind::Rows, Rule::Neutral), &[root, root, never, seed]);
    let c = b.column(t0, 0);
    let scaled = b.mul(outer[0], c);
    let inner = b.begin_fold(t1, (FoldKind::Rows, Rule::Neutral), &[scaled, scaled, outer[2], outer[3]]);
    let (c0, c1) = (b.column(t1, 0), b.column(t1, 1));
    let inside = b.lt(inner[1], c0);
    let any = b.either(inner[2], inside);
    let (five, encoding) = (b.bits_constant(5), b.to_bits(inner[0]));
    let shifted = b.shl(inner[3], five);
    let hash = b.bit_xor(shifted, encoding);
    let next = b.fma(inner[1], c1, y);
    let inner = b.end_fold(&[next, inner[0], any, hash]);
    let next = b.add(inner[1], outer[1]);
    let outer = b.end_fold(&[inner[0], next, inner[2], inner[3]]);
    let chosen = b.select(outer[2], outer[0], outer[1]);
    let hash = b.from_bits(outer[3]);
    let function = finish(b, &[chosen, hash, outer[1]]);
    let all = [rows(1, 4, &[0, 1, 3], &[0, 3], number), rows(2, 6, &[1, 2, 5], &[0, 3], number)];
    check(&function, &tables(all), points());
}

#[test]
fn a_table_without_columns_counts() {
    let mut b = FunctionBuilder::new("count", &["x", "y", "z"]);
    let t = table(&mut b, None, 0);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let next = b.add(acc[0], x);
    let out = b.end_fold(&[next]);
    let function = finish(b, &out);
    check(&function, &tables([rows(0, 4, &[0, 1, 3], &[0, 3], number)]), points());
}

/// `count` values that are all alive at the same time.
fn crowded(count: usize) -> Verified {
    let mut b = FunctionBuilder::new("crowded", &["x", "y", "z"]);
    let (x, y, z) = (b.input(0), b.input(1), b.input(2));
    let mut values: Vec<Value> = vec![x];
    for _ in 0..count {
        let next = b.fma(values[values.len() - 1], y, z);
        values.push(next);
    }
    let mut sum = x;
    for &value in &values {
        sum = b.fma(sum, z, value);
    }
    finish(b, &[sum])
}

#[test]
fn many_values_may_be_alive() {
    for count in [20, 250] {
        check(&crowded(count), &Tables::default(), points());
    }
}

#[test]
fn many_accumulators_go_round() {
    let mut b = FunctionBuilder::new("accumulators", &["x", "y", "z"]);
    let count = 60;
    let t = table(&mut b, None, count);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let initial = vec![zero; count];
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &initial);
    let next: Vec<Value> = (0..count)
        .map(|index| {
            let c = b.column(t, index);
            b.fma(c, x, acc[(index + 1) % count])
        })
        .collect();
    let out = b.end_fold(&next);
    let function = finish(b, &out);
    check(&function, &tables([rows(count, 3, &[0, 1, 2], &[0, 3], number)]), points());
}

/// Random programs over random tables: every op that has an instruction, folds in folds, values from
/// everywhere.
#[test]
fn random_programs_have_the_bits_of_the_reference() {
    for seed in 0..40 {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut b = FunctionBuilder::new("random", &["x", "y", "z"]);
        let outer = table(&mut b, None, 3);
        let inner = table(&mut b, Some(outer), 2);
        let mut known: Vec<Value> = (0..3).map(|plane| b.input(plane)).collect();
        known.push(b.constant(SPICE[random.usize(0..SPICE.len())]));
        grow(&mut b, &mut random, &mut known, 12);
        let initial = [pick(&mut random, &known), pick(&mut random, &known), pick(&mut random, &known)];
        let outside = known.len();
        let acc = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &initial);
        known.extend(acc);
        known.extend((0..3).map(|column| b.column(outer, column)));
        grow(&mut b, &mut random, &mut known, 8);
        let start = [pick(&mut random, &known), pick(&mut random, &known)];
        let between = known.len();
        let acc = b.begin_fold(inner, (FoldKind::Rows, Rule::Neutral), &start);
        known.extend(acc);
        known.extend((0..2).map(|column| b.column(inner, column)));
        grow(&mut b, &mut random, &mut known, 10);
        let next = [pick(&mut random, &known), pick(&mut random, &known)];
        known.truncate(between);
        known.extend(b.end_fold(&next));
        grow(&mut b, &mut random, &mut known, 5);
        let next = [pick(&mut random, &known), pick(&mut random, &known), pick(&mut random, &known)];
        known.truncate(outside);
        known.extend(b.end_fold(&next));
        grow(&mut b, &mut random, &mut known, 5);
        let outputs = &known[known.len() - 6..];
        let function = finish(b, outputs);
        let rows = [
            rows(3, 5, &[0, 2, 3], &[0, 3], number),
            rows(2, 10, &[0, 4, 5, 6, 9], &[0, 2, 2, 3, 5, 5], number),
        ];
        check(&function, &tables(rows), points());
    }
}

/// A value, more often a late one.
fn pick(random: &mut fastrand::Rng, known: &[Value]) -> Value {
    let from = if random.bool() { known.len().saturating_sub(6) } else { 0 };
    known[random.usize(from..known.len())]
}

/// Adds results of random ops on known reals.
fn grow(b: &mut FunctionBuilder, random: &mut fastrand::Rng, known: &mut Vec<Value>, count: usize) {
    for _ in 0..count {
        let [x, y, z] = [(); 3].map(|()| pick(random, known));
        let value = match random.u32(0..14) {
            0 => b.add(x, y),
            1 => b.sub(x, y),
            2 => b.mul(x, y),
            3 => b.div(x, y),
            4 => b.fma(x, y, z),
            5 => b.neg(x),
            6 => b.abs(x),
            7 => b.sqrt(x),
            8 => b.min(x, y),
            9 => b.max(x, y),
            10 => b.stop_gradient(x),
            11 => {
                let mask = b.le(x, y);
                b.select(mask, y, z)
            }
            12 => {
                let (less, same) = (b.lt(x, y), b.eq(y, z));
                let not = b.not(same);
                let mask = b.both(less, not);
                b.select(mask, z, x)
            }
            _ => {
                let (sign, bits) = (b.bits_constant(0x8000_0000), b.to_bits(x));
                let bits = b.bit_xor(bits, sign);
                b.from_bits(bits)
            }
        };
        known.push(value);
    }
}

/// The union over rows of blends of the rows that hang under them: most rows are out of reach of most points,
/// and end early in machine code.
fn blends() -> Verified {
    let mut b = FunctionBuilder::new("blends", &["x", "y", "z"]);
    let outer = table(&mut b, None, 1);
    let inner = table(&mut b, Some(outer), 4);
    let (x, y, z) = (b.input(0), b.input(1), b.input(2));
    let (zero, one, least) = (b.constant(0.0), b.constant(1.0), b.constant(1e-30));
    let union = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &[zero]);
    let scale = b.column(outer, 0);
    let acc = b.begin_fold(inner, (FoldKind::Rows, Rule::Neutral), &[least, zero]);
    let c: Vec<Value> = (0..4).map(|column| b.column(inner, column)).collect();
    let offsets = [b.sub(x, c[0]), b.sub(y, c[1]), b.sub(z, c[2])];
    let square = offsets.iter().fold(zero, |sum, &offset| b.fma(offset, offset, sum));
    let reach = b.fma(square, c[3], one);
    let near = b.max(reach, zero);
    let near2 = b.mul(near, near);
    let value = b.mul(near2, near);
    let (small, large) = (b.min(acc[0], value), b.max(value, acc[0]));
    let ratio = b.div(small, large);
    let ratio2 = b.mul(ratio, ratio);
    let power = b.mul(ratio2, ratio);
    let (grown, more) = (b.fma(acc[1], power, one), b.add(acc[1], power));
    let is_largest = b.lt(acc[0], value);
    let sum = b.select(is_largest, grown, more);
    let blend = b.end_fold(&[large, sum]);
    let root = (0..4).fold(blend[1], |value, _| b.sqrt(value));
    let blended = b.mul(blend[0], root);
    let is_doubled = b.lt(zero, scale);
    let double = b.add(blended, blended);
    let weighted = b.select(is_doubled, double, blended);
    let next = b.max(weighted, union[0]);
    let out = b.end_fold(&[next]);
    finish(b, &out)
}

#[test]
fn rows_that_change_nothing_may_end_early() {
    let function = blends();
    let found = gates(function.function());
    assert_eq!(found.values().flatten().count(), 2, "of the rows inside and of those around them");
    // Four rows of two each, a unit apart, that reach half a unit far.
    let number = |row: usize, column: usize| [row as f32, 0.1, 0.2, -4.0][column];
    let around = rows(1, 4, &[0, 1, 2, 3], &[0, 4], |row, _| row as f32 - 1.0);
    let inside = rows(4, 8, &[0, 1, 2, 3, 4, 5, 6, 7], &[0, 2, 4, 6, 8], number);
    let tables = tables([around, inside]);
    let mut random = fastrand::Rng::with_seed(7);
    for spread in [0.0, 0.3, 3.0] {
        // Blocks of neighbours: near no row, near one, near several; and among them numbers that break
        // things.
        let mut planes = vec![Vec::new(); 3];
        for middle in [-9.0, 0.0, 1.4, 3.0, 20.0, 6.5, 7.0, f32::NAN] {
            for point in 0..64 {
                let is_odd = point % 16 == 5 && middle == 3.0;
                planes[0].push(if is_odd { f32::INFINITY } else { middle + spread * (random.f32() - 0.5) });
                planes[1].push(spread * random.f32());
                planes[2].push(0.2);
            }
        }
        check(&function, &tables, planes);
    }
}
