//! The hand-written loops against the f64 oracle.

use jbt::walk::{walk, walk_gradient};

use crate::model::{blobs, cube, tree};

use super::Blobs;
use super::dense::{Dense, Full};
use super::vector::run_plain;

/// Asserts that two answers agree to a part in a thousand of the larger of `scale` and the expected one.
fn assert_near(what: &str, value: f32, expected: f64, scale: f64) {
    let error = (f64::from(value) - expected).abs();
    assert!(error <= 1e-3 * expected.abs().max(scale), "{what} is {value}, the oracle has {expected}");
}

#[test]
fn dense_answers_agree_with_the_oracle_at_any_length() {
    let model = blobs(200, 3);
    let (tree, rows) = (tree(&model), Blobs::new(&model));
    for count in [0, 1, 7, 8, 15, 16, 17, 31, 33, 64, 65, 200] {
        let points = cube(count, 5);
        let mut field = vec![f32::NAN; count];
        rows.field(points.planes(), &mut field);
        let mut gradient: [Vec<f32>; 4] = std::array::from_fn(|_| vec![f32::NAN; count]);
        rows.gradient(points.planes(), gradient.each_mut().map(Vec::as_mut_slice));
        let mut full: [Vec<f32>; 7] = std::array::from_fn(|_| vec![f32::NAN; count]);
        rows.full(points.planes(), full.each_mut().map(Vec::as_mut_slice));
        for index in 0..count {
            let p = points.get(index).map(f64::from);
            let expected = walk(&tree, p);
            for value in [field[index], gradient[0][index], full[0][index]] {
                let error = (f64::from(value) - expected.field).abs();
                assert!(error < 1e-5, "the field at {p:?} is {value}, the oracle has {}", expected.field);
            }
            let slope = walk_gradient(&tree, p, 1e-5);
            for axis in 0..3 {
                assert_near("the slope", gradient[1 + axis][index], slope[axis], 1.0);
                assert_near("the slope", full[1 + axis][index], slope[axis], 1.0);
                if expected.kink_distance > 1e-5 {
                    assert_near("the colour", full[4 + axis][index], expected.attributes[0][axis], 0.1);
                }
            }
        }
    }
}

#[test]
fn without_a_field_the_colour_is_the_default() {
    let model = blobs(3, 1);
    let far = [100.0];
    let mut full = [[f32::NAN]; 7];
    Blobs::new(&model).full([&far; 3], full.each_mut().map(|plane| &mut plane[..]));
    assert_eq!(full.map(|[value]| value), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(walk(&tree(&model), [100.0; 3]).attributes[0], [1.0; 3]);
}

#[test]
fn other_cpus_have_the_same_answers_but_for_rounding() {
    plain_agrees::<8>();
    plain_agrees::<16>();
}

fn plain_agrees<const N: usize>() {
    let (rows, points) = (Blobs::new(&blobs(200, 3)), cube(99, 5));
    let mut here = [[f32::NAN; 99]; 7];
    rows.full(points.planes(), here.each_mut().map(|plane| &mut plane[..]));
    let mut plain = [[f32::NAN; 99]; 7];
    let answers = plain.each_mut().map(|plane| &mut plane[..]);
    run_plain::<N, _>(Dense { rows: &rows.rows, points: points.planes(), answers, which: Full });
    for (here, plain) in here.iter().flatten().zip(plain.iter().flatten()) {
        assert!((here - plain).abs() <= 1e-4 * here.abs().max(1.0), "{here} and {plain}, {N} lanes");
    }
}
