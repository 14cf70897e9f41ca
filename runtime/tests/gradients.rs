//! Gradients are finite at all points with finite coordinates: they are 0 where a field stands still,
//! saturate at 2^100, and have the bits that they had where nothing overflows, with the ops that they took.

mod common;

use fastrand::Rng;
use jbt::boxes::Divisible;
use jbt::{Box3, CheckedTree, Compiler, Engine, Points, Pruner, Query, Samples};
use jbt_testkit::bits::bits;
use jbt_testkit::points::HOSTILE;
use jbt_testkit::scene::tree;

/// Beyond this gradients saturate: 2^100.
const LARGEST: f32 = (1u128 << 100) as f32;

/// Field and gradient, on which all engines agree.
fn answers(tree: &CheckedTree, points: &Points) -> Samples {
    let answers = Engine::ALL.map(|engine| {
        let evaluator = Compiler::for_engine(engine).evaluator(tree, Query::GRADIENT).expect("it compiles");
        common::answers(&evaluator, points)
    });
    let [scalar, others @ ..] = answers;
    for other in &others {
        assert_eq!(bits(scalar.planes()), bits(other.planes()));
    }
    scalar
}

/// Field and gradient at a point.
fn at(root: &str, point: [f32; 3]) -> (f32, [f32; 3]) {
    let samples = answers(&tree(root), &[point].into_iter().collect());
    (samples.field()[0], samples.gradient().expect("asked for").map(|plane| plane[0]))
}

#[test]
fn a_field_at_its_bound_stands_still() {
    let (field, gradient) = at("expression { 2 - pow(x, 64) - pow(y, 64) }", [5.0, 0.1, 0.1]);
    assert_eq!((field, gradient), (-LARGEST, [0.0; 3]));
    let (field, gradient) = at("expression { exp(x * x) + y }", [40.0, 0.1, 0.1]);
    assert_eq!((field, gradient), (LARGEST, [0.0; 3]));
}

#[test]
fn powers_with_tiny_exponents_and_bases_have_a_slope() {
    for (x, power, slope) in
        [(1e-45, "-0", 0.0), (1e-45, "1e-45", 1.0), (1e-39, "1e-30", 1e9), (1e-45, "1.5", 0.0)]
    {
        let (field, [gx, gy, gz]) =
            at(&format!("param p = {power} expression {{ pow(x, p) }}"), [x, 0.5, 0.0]);
        assert!(field.is_finite());
        assert_eq!([gy, gz], [0.0; 2]);
        assert!((gx - slope).abs() <= 1e-3 * slope, "pow({x:e}, {power}): {gx:e} instead of {slope:e}");
    }
}

#[test]
fn far_from_a_skeleton_there_is_no_slope() {
    for root in [
        "point { radius 1 }",
        "segment { from (0 0 0) to (1 1 0) radius 1 }",
        "rotate axis (1 2 3) degrees 40 { cylinder { from (0 0 0) to (0 0 1) cylinder_radius 0.5 radius 1 } }",
        "twist axis z rate 2 { torus { ring_radius 1 tube_radius 0.2 radius 1 } }",
        "bend axis x rate 1 from -1 to 1 { disc { center (0 0 0) normal (1 0 0) disc_radius 1 radius 1 } }",
    ] {
        for far in [2e19, -2e19, 1e30, f32::MAX, f32::MIN] {
            for axis in 0..3 {
                let mut point = [0.25, -0.5, 0.125];
                point[axis] = far;
                assert_eq!(at(root, point), (0.0, [0.0; 3]), "{root} at {point:?}");
            }
        }
    }
}

/// What is far off takes nothing from what is near: only its own part of the slope is left out.
#[test]
fn what_overflows_beside_what_does_not() {
    let near = "expression { 0.5 + x - y / 4 }";
    let point = [0.125, 0.0, 2e19];
    assert_eq!(at(near, point), (0.625, [1.0, -0.25, 0.0]));
    let twisted = "twist axis x rate 1 { torus { ring_radius 1 tube_radius 0.2 radius 1 } }";
    assert_eq!(at(&format!("sum {{ {near} point {{ radius 1 }} {twisted} }}"), point), at(near, point));
}

#[test]
fn slopes_saturate() {
    for (root, point, sign) in [
        ("expression { 1e-30 * pow(x, 40) }", [9.0, 0.0, 0.0], 1.0),
        ("expression { -1 / x }", [1e-25, 0.0, 0.0], 1.0),
        ("expression { 1 / x }", [-1e-25, 0.0, 0.0], -1.0),
        ("expression { x * 1e14 * 1e14 * 1e14 }", [1e-20, 0.0, 0.0], 1.0),
    ] {
        let (field, [gx, gy, gz]) = at(root, point);
        assert!(field.is_finite() && [gy, gz] == [0.0; 2], "{root}: {field}, {gy}, {gz}");
        assert!(gx * sign > 0.0 && gx.abs() <= LARGEST, "{root}: {gx:e}");
    }
}

/// A point's answer depends neither on the points beside it nor on rows that are left out.
#[test]
fn pruned_or_not_hostile_points_have_the_same_bits() {
    let tree = tree(
        "union { sum { point { radius 2 } point { at (1 0 0) radius 2 } torus { ring_radius 1 tube_radius 0.2 radius 1 } \
         repeat axis x spacing 3 { point { radius 0.8 } } } expression { pow(x, 40) * y - 1e10 } expression { 1 - z / x } }",
    );
    let compiler = Compiler::for_engine(Engine::Lanes);
    let evaluator = compiler.evaluator(&tree, Query::ALL).expect("it compiles");
    let pruner = Pruner::new(&compiler, &tree).expect("it compiles");
    let mut rng = Rng::with_seed(1);
    for _ in 0..300 {
        let [a, b]: [[f32; 3]; 2] = [0; 2].map(|_| [0; 3].map(|_: i32| HOSTILE[rng.usize(0..HOSTILE.len())]));
        let low: [f32; 3] = std::array::from_fn(|axis| a[axis].min(b[axis]));
        let high: [f32; 3] = std::array::from_fn(|axis| a[axis].max(b[axis]));
        let region = pruner.region(Box3::new(low, high)).expect("the box is proper");
        let points: Points = (0..40)
            .map(|_| {
                std::array::from_fn(|axis| match rng.u8(0..3) {
                    0 => low[axis],
                    1 => high[axis],
                    _ => (low[axis] + rng.f32() * (high[axis] * 0.5 - low[axis] * 0.5))
                        .clamp(low[axis], high[axis]),
                })
            })
            .collect();
        let samples = common::answers(&evaluator, &points);
        assert!(samples.planes().iter().flatten().all(|x| x.is_finite()));
        let mut planes = vec![vec![f32::NAN; points.len()]; samples.planes().len()];
        let mut buffers: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        evaluator.eval_region(&region, points.planes(), &mut buffers).expect("the buffers fit");
        let found: Vec<Vec<u32>> =
            planes.iter().map(|plane| plane.iter().map(|x| x.to_bits()).collect()).collect();
        assert_eq!(found, bits(samples.planes()), "{:?}", region.bounds());
        let one = rng.usize(0..points.len());
        let probe = evaluator.probe(points.get(one));
        assert_eq!(probe.gradient(), samples.gradient().map(|planes| planes.map(|plane| plane[one])));
    }
}

/// The price of all this at ordinary points: no op. A sum of points takes for each what it took before there
/// were guards.
#[test]
fn ordinary_gradients_gain_no_op() {
    let tree = tree("sum { point { radius 1 } point { at (1 2 3) radius 2 strength 0.5 } }");
    let ops = |query| {
        let compiler = Compiler::for_engine(Engine::Lanes);
        let evaluator = compiler.evaluator(&tree, query).expect("it compiles");
        let everywhere = Pruner::new(&compiler, &tree).expect("it compiles").everywhere();
        evaluator.ops_in(&everywhere)
    };
    assert_eq!([Query::FIELD, Query::GRADIENT].map(ops), [26, 41]);
}

#[test]
fn slopes_of_angles_keep_their_digits_far_from_the_axis() {
    for x in [1e-3_f32, 0.5, 1.0, 30.0, 1e3, 1e6, 1e12] {
        for sign in [1.0, -1.0] {
            let x = sign * x;
            let wide = f64::from(x);
            for (root, slope) in [
                ("expression { atan(x) }", 1.0 / (1.0 + wide * wide)),
                ("expression { atan2(x, 1) }", 1.0 / (1.0 + wide * wide)),
                ("expression { atan2(1, x) }", -1.0 / (1.0 + wide * wide)),
                ("expression { atan2(x, -1) }", -1.0 / (1.0 + wide * wide)),
            ] {
                let (_, [gx, gy, gz]) = at(root, [x, 0.5, 0.0]);
                assert_eq!([gy, gz], [0.0; 2]);
                let error = (f64::from(gx) - slope).abs() / slope.abs();
                assert!(error < 3e-6, "{root} at {x:e}: {gx:e} instead of {slope:e}, off by {error:e}");
            }
        }
    }
}
