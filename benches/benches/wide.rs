//! Is the crate `wide` at least as fast as plain loops for vector code on the host?
//!
//! Loops like three of the library, whose bits do not depend on fused products, each in three ways: as a
//! plain loop, as the same loop compiled for AVX2 beside the baseline (`multiversion`), and with
//! `wide::f32x8`, which takes what the build enables: two vectors of SSE2. All three answer alike, which is
//! checked.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fastrand::Rng;
use multiversion::multiversion;
use wide::f32x8;

/// Rows that are compared with eight boxes.
const ROWS: usize = 1024;
/// Samples that are told apart.
const SAMPLES: usize = 9 * 9 * 9;
/// Pixels of a row that is smoothed.
const PIXELS: usize = 800;

/// The core of a support and the square of its radius.
struct Support {
    low: [f32; 3],
    high: [f32; 3],
    radius_squared: f32,
}

/// Eight boxes, by coordinates.
struct Boxes {
    low: [[f32; 8]; 3],
    high: [[f32; 8]; 3],
}

// Rows against boxes, as in `prune/cull.rs`: a bit for each box that is reached.

#[inline(always)]
fn reach_loop(rows: &[Support], boxes: &Boxes, bits: &mut [u8]) {
    for (row, bits) in rows.iter().zip(bits) {
        let mut square = [0.0_f32; 8];
        for axis in 0..3 {
            let sides = boxes.low[axis].iter().zip(&boxes.high[axis]);
            for (square, (low, high)) in square.iter_mut().zip(sides) {
                let (before, behind) = (row.low[axis] - high, low - row.high[axis]);
                let gap = if before > behind { before } else { behind };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *square += gap * gap;
            }
        }
        let misses = square.map(|square| square > row.radius_squared);
        *bits = !misses.iter().enumerate().fold(0_u8, |bits, (lane, &miss)| bits | u8::from(miss) << lane);
    }
}

fn reach_plain(rows: &[Support], boxes: &Boxes, bits: &mut [u8]) {
    reach_loop(rows, boxes, bits);
}

#[multiversion(targets("x86_64+avx2"))]
fn reach_levels(rows: &[Support], boxes: &Boxes, bits: &mut [u8]) {
    reach_loop(rows, boxes, bits);
}

fn reach_wide(rows: &[Support], boxes: &Boxes, bits: &mut [u8]) {
    let (low, high) = (boxes.low.map(f32x8::new), boxes.high.map(f32x8::new));
    for (row, bits) in rows.iter().zip(bits) {
        let mut square = f32x8::ZERO;
        for axis in 0..3 {
            let (before, behind) =
                (f32x8::splat(row.low[axis]) - high[axis], low[axis] - f32x8::splat(row.high[axis]));
            let gap = before.fast_max(behind).fast_max(f32x8::ZERO);
            square += gap * gap;
        }
        *bits = !(square.simd_gt(f32x8::splat(row.radius_squared)).to_bitmask() as u8);
    }
}

// The side of samples, as the mesher asks of the corners of its cells: a bit for each sample.

#[inline(always)]
fn sides_loop(samples: &[f32], iso: f32, bits: &mut [u8]) {
    for (eight, bits) in samples.chunks(8).zip(bits) {
        *bits =
            eight.iter().enumerate().fold(0, |bits, (lane, &value)| bits | u8::from(value >= iso) << lane);
    }
}

fn sides_plain(samples: &[f32], iso: f32, bits: &mut [u8]) {
    sides_loop(samples, iso, bits);
}

#[multiversion(targets("x86_64+avx2"))]
fn sides_levels(samples: &[f32], iso: f32, bits: &mut [u8]) {
    sides_loop(samples, iso, bits);
}

fn sides_wide(samples: &[f32], iso: f32, bits: &mut [u8]) {
    let (eights, rest) = samples.as_chunks::<8>();
    for (eight, bits) in eights.iter().zip(&mut *bits) {
        *bits = f32x8::new(*eight).simd_ge(f32x8::splat(iso)).to_bitmask() as u8;
    }
    sides_loop(rest, iso, &mut bits[eights.len()..]);
}

// A row of a picture's filter: the mean of three rows, weighted by how alike depths are.

type Rows<'a> = [&'a [f32]; 3];

#[inline(always)]
fn smooth_loop([depths, lights]: [Rows<'_>; 2], row: &mut [f32]) {
    for (x, mean) in row.iter_mut().enumerate() {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (depth, light) in depths.iter().zip(&lights) {
            let away = depth[x] - depths[1][x];
            let weight = 1.0 / (1.0 + away * away);
            sum += weight * light[x];
            weights += weight;
        }
        *mean = sum / weights;
    }
}

fn smooth_plain(rows: [Rows<'_>; 2], row: &mut [f32]) {
    smooth_loop(rows, row);
}

#[multiversion(targets("x86_64+avx2"))]
fn smooth_levels(rows: [Rows<'_>; 2], row: &mut [f32]) {
    smooth_loop(rows, row);
}

fn smooth_wide([depths, lights]: [Rows<'_>; 2], row: &mut [f32]) {
    let at = |row: &[f32], x: usize| f32x8::from(&row[x..x + 8]);
    for (eight, means) in row.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        let x = 8 * eight;
        let middle = at(depths[1], x);
        let (mut sum, mut weights) = (f32x8::ZERO, f32x8::ZERO);
        for (depth, light) in depths.iter().zip(&lights) {
            let away = at(depth, x) - middle;
            let weight = f32x8::ONE / (f32x8::ONE + away * away);
            sum += weight * at(light, x);
            weights += weight;
        }
        *means = (sum / weights).to_array();
    }
}

/// Three ways to do the same, by name.
type Ways<'a, T> = [(&'static str, &'a dyn Fn(&mut [T])); 3];

fn numbers(rng: &mut Rng, count: usize) -> Vec<f32> {
    (0..count).map(|_| rng.f32()).collect()
}

/// Checks that all ways answer alike, and times them.
fn contest<T: Clone + PartialEq>(
    c: &mut Criterion,
    name: &str,
    (elements, empty): (usize, Vec<T>),
    ways: Ways<'_, T>,
) {
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(elements as u64));
    let mut first = empty.clone();
    ways[0].1(&mut first);
    for (way, run) in ways {
        let mut answers = empty.clone();
        run(&mut answers);
        assert!(answers == first, "{name} by {way} answers otherwise");
        group.bench_function(way, |b| b.iter(|| run(black_box(&mut answers))));
    }
    group.finish();
}

fn host(c: &mut Criterion) {
    let mut rng = Rng::with_seed(1);
    let mut sides = |size: f32| {
        let low = [(); 3].map(|()| rng.f32());
        (low, low.map(|side| side + size))
    };
    let rows: Vec<Support> = (0..ROWS)
        .map(|_| sides(0.1))
        .map(|(low, high)| Support { low, high, radius_squared: 0.01 })
        .collect();
    let eight: [_; 8] = std::array::from_fn(|_| sides(0.2));
    let boxes = Boxes {
        low: [0, 1, 2].map(|axis| eight.map(|(low, _)| low[axis])),
        high: [0, 1, 2].map(|axis| eight.map(|(_, high)| high[axis])),
    };
    let ways: Ways<'_, u8> = [
        ("plain", &|bits| reach_plain(black_box(&rows), &boxes, bits)),
        ("levels", &|bits| reach_levels(black_box(&rows), &boxes, bits)),
        ("wide", &|bits| reach_wide(black_box(&rows), &boxes, bits)),
    ];
    contest(c, "wide/rows against boxes", (ROWS, vec![0; ROWS]), ways);

    let samples = numbers(&mut rng, SAMPLES);
    let ways: Ways<'_, u8> = [
        ("plain", &|bits| sides_plain(black_box(&samples), 0.5, bits)),
        ("levels", &|bits| sides_levels(black_box(&samples), 0.5, bits)),
        ("wide", &|bits| sides_wide(black_box(&samples), 0.5, bits)),
    ];
    contest(c, "wide/sides of samples", (SAMPLES, vec![0; SAMPLES.div_ceil(8)]), ways);

    let planes = [(); 6].map(|()| numbers(&mut rng, PIXELS));
    let [a, b, c_, d, e, f] = planes.each_ref().map(Vec::as_slice);
    let picture = [[a, b, c_], [d, e, f]];
    let ways: Ways<'_, f32> = [
        ("plain", &|row| smooth_plain(black_box(picture), row)),
        ("levels", &|row| smooth_levels(black_box(picture), row)),
        ("wide", &|row| smooth_wide(black_box(picture), row)),
    ];
    contest(c, "wide/filter of a picture", (PIXELS, vec![0.0; PIXELS]), ways);
}

criterion_group!(benches, host);
criterion_main!(benches);
