//! Mistakes that other systems have made. Each test states one, holds the formula that makes it beside the
//! right one, sees that the two differ where it looks, and that every engine has the right one.
//!
//! Whoever adds a member that others got wrong adds its test at the end.

use jbt::build::{Axis, param, point, round_cone, segment};
use jbt::{Compiler, Engine, Model, Points, Query, Samples, SetOperation, Tree};
use jbt_testkit::vector::{length, minus};

use crate::falloffs::soft;

/// The answers of each engine.
fn answers(root: &Tree, points: &[[f32; 3]]) -> Vec<(Engine, Samples)> {
    let tree = Model::new(root.clone()).check().expect("a good model");
    let points: Points = points.iter().copied().collect();
    let of = |engine| {
        let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::ALL).expect("it compiles");
        (engine, crate::common::answers(&evaluator, &points))
    };
    Engine::ALL.map(of).into_iter().collect()
}

/// The gradients of each engine at one point.
fn gradients(root: &Tree, point: [f64; 3]) -> Vec<(Engine, [f64; 3])> {
    let of = |(engine, samples): (Engine, Samples)| {
        (engine, samples.gradient().expect("it was asked for").map(|plane| f64::from(plane[0])))
    };
    answers(root, &[point.map(|x| x as f32)]).into_iter().map(of).collect()
}

/// Every engine has the right gradient at a point, and a defective formula has another one.
fn judge(root: &Tree, point: [f64; 3], right: [f64; 3], defective: [f64; 3]) {
    judge_seen(root, point, right, defective, 0.1);
}

/// The same, where the other one is off by at least this part.
fn judge_seen(root: &Tree, point: [f64; 3], right: [f64; 3], defective: [f64; 3], seen: f64) {
    let size = length(right);
    assert!(length(minus(right, defective)) > seen * size, "{defective:?} is as good as {right:?}");
    for (engine, gradient) in gradients(root, point) {
        let off = length(minus(right, gradient));
        assert!(off < 1e-5 * size, "{}: expected {right:?}, got {gradient:?}", engine.name());
    }
}

/// Every engine has the right field at some points, and finite gradients; a defective formula has another
/// field at each, or none.
fn judge_fields(root: &Tree, places: &[([f64; 3], f64)], defective: impl Fn([f64; 3]) -> f64) {
    let points: Vec<[f32; 3]> = places.iter().map(|(at, _)| at.map(|x| x as f32)).collect();
    for (engine, samples) in answers(root, &points) {
        let gradient = samples.gradient().expect("it was asked for");
        for (index, &(at, right)) in places.iter().enumerate() {
            let (wrong, got) = (defective(at), f64::from(samples.field()[index]));
            assert!(
                wrong.is_nan() || (wrong - right).abs() > 0.05,
                "{wrong} is as good as {right} at {at:?}"
            );
            assert!((got - right).abs() < 1e-5, "{} at {at:?}: expected {right}, got {got}", engine.name());
            assert!(gradient.iter().all(|plane| plane[index].is_finite()), "{} at {at:?}", engine.name());
        }
    }
}

fn times(factor: f64, v: [f64; 3]) -> [f64; 3] {
    v.map(|x| factor * x)
}

/// The gradient of a soft ball: `dg/ds 2 (p - c) / R^2`, with `dg/ds = -(22 - 34 s + 12 s^2) / 9`.
fn ball_gradient(p: [f64; 3], center: [f64; 3], radius: f64) -> [f64; 3] {
    let v = minus(p, center);
    let s = (length(v) / radius).powi(2);
    times(-(22.0 - 34.0 * s + 12.0 * s * s) / 9.0 * 2.0 / (radius * radius), v)
}

/// In a SIMD evaluator all lanes of a packet had the colour of its first lane.
#[test]
fn lanes_do_not_share_the_first_lanes_colour() {
    let tree = point([-1.0, 0.0, 0.0], 2.0).color([1.0, 0.0, 0.0])
        + point([1.0, 0.0, 0.0], 2.0).color([0.0, 0.0, 1.0]);
    let points: Vec<[f32; 3]> = (0..67).map(|index| [index as f32 / 33.0 - 1.0, 0.25, 0.0]).collect();
    let red = |p: &[f32; 3]| {
        let [x, y, _] = p.map(f64::from);
        let [left, right] = [-1.0, 1.0].map(|at: f64| soft(((x - at).powi(2) + y * y) / 4.0));
        left / (left + right)
    };
    for (engine, samples) in answers(&tree, &points) {
        let colour = samples.attribute("color").expect("it was asked for");
        for (lane, point) in points.iter().enumerate() {
            let (expected, got) = (red(point), f64::from(colour[0][lane]));
            assert!(
                (got - expected).abs() < 1e-5,
                "{}, lane {lane}: expected {expected}, got {got}",
                engine.name()
            );
        }
        for width in [4, 8, 16] {
            let shared = |lane: usize| red(&points[lane / width * width]);
            let off =
                (0..points.len()).map(|lane| (shared(lane) - red(&points[lane])).abs()).fold(0.0, f64::max);
            assert!(off > 0.05, "packets of {width}: the defect would be seen");
        }
    }
}

/// The distance to a segment was that to its whole line: the foot was not clamped to the ends.
#[test]
fn segments_end() {
    let tree = segment([0.0; 3], [1.0, 0.0, 0.0], 1.0);
    let places = [[-3.0, 0.5, 0.0], [-0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [1.5, 0.25, 0.0], [4.0, 0.0, 0.0]];
    let field = |foot: fn(f64) -> f64| places.map(|[x, y, _]: [f64; 3]| soft((x - foot(x)).powi(2) + y * y));
    let (right, endless) = (field(|x| x.clamp(0.0, 1.0)), field(|x| x));
    assert_eq!(right.map(|f| f > 0.0), [false, true, true, true, false]);
    assert_eq!(endless.map(|f| f > 0.4), [true; 5]);
    for (engine, samples) in answers(&tree, &places.map(|place| place.map(|x| x as f32))) {
        for (index, expected) in right.into_iter().enumerate() {
            let got = f64::from(samples.field()[index]);
            assert!(
                (got - expected).abs() < 1e-6,
                "{} at {:?}: expected {expected}, got {got}",
                engine.name(),
                places[index]
            );
        }
    }
}

/// A difference (`a - b^n`, in three-js-blobtree) had the gradient `grad a - b^n grad b`. The factor of `grad
/// b` is the derivative by b: `n b^(n-1)` there, and here, where the cut `2 iso - b` decides, 1; `grad a` has
/// no part in it.
#[test]
fn the_gradient_of_a_difference_is_that_of_what_decides() {
    let (a, b) = ([0.0; 3], [1.0, 0.0, 0.0]);
    let tree = point(a, 2.0) - point(b, 2.0);
    let defective = |p: [f64; 3], n: f64| {
        let field = soft((length(minus(p, b)) / 2.0).powi(2));
        minus(ball_gradient(p, a, 2.0), times(field.powf(n), ball_gradient(p, b, 2.0)))
    };
    let cut = [0.75, 0.25, 0.5];
    for n in [1.0, 2.0] {
        judge(&tree, cut, times(-1.0, ball_gradient(cut, b, 2.0)), defective(cut, n));
    }
    let kept = [0.25, 1.0, 0.5];
    judge(&tree, kept, ball_gradient(kept, a, 2.0), defective(kept, 1.0));
    // The formula is wrong for its own field, too.
    let field = |x: f64| {
        let [a, b] = [a, b].map(|at| soft((length(minus([x, cut[1], cut[2]], at)) / 2.0).powi(2)));
        a - b * b
    };
    let difference = (field(0.25 + 1e-6) - field(0.25 - 1e-6)) / 2e-6;
    assert!((defective([0.25, cut[1], cut[2]], 2.0)[0] - difference).abs() > 0.1);
}

/// A twist handed its child's gradient on as it was, in the child's directions. It has to be turned back, and
/// the height takes part in the turning: `(c gx - s gy, s gx + c gy, gz + k (yl gx - xl gy))`, with the
/// child's gradient g at the child's point (xl, yl, zl).
#[test]
fn the_gradient_of_a_twist_is_turned_back() {
    let (rate, center) = (1.5, [0.5, 0.0, 0.25]);
    let tree = point(center, 1.5).twist(Axis::Z, rate);
    for p in [[0.25, -0.5, 0.75], [-0.25, 0.5, 1.0], [0.5, -0.25, -0.5]] {
        let (sin, cos) = f64::sin_cos(rate * p[2]);
        let child = [cos * p[0] + sin * p[1], cos * p[1] - sin * p[0], p[2]];
        let g = ball_gradient(child, center, 1.5);
        let across = rate * (child[1] * g[0] - child[0] * g[1]);
        let right = [cos * g[0] - sin * g[1], sin * g[0] + cos * g[1], g[2] + across];
        judge(&tree, p, right, g);
        // Turned, but without what the height does.
        judge(&tree, p, right, [right[0], right[1], g[2]]);
    }
}

/// A scale handed its child's gradient on as it was. Along each axis it has to be divided by the factor;
/// multiplied with it, as positions are, it is worse.
#[test]
fn the_gradient_of_a_scale_is_divided_by_it() {
    let (factors, center) = ([2.0, 0.5, 1.5], [0.25, 0.0, 0.0]);
    // One map is known when the code is made, the other one depends on a parameter.
    let ball = point(center, 1.0);
    let depends = ball.scale_axes((param("x", factors[0]), factors[1], factors[2]));
    for tree in [ball.scale_axes(factors), depends] {
        for p in [[1.0, 0.25, 0.5], [-0.25, -0.25, 0.25]] {
            let g = ball_gradient(std::array::from_fn(|axis| p[axis] / factors[axis]), center, 1.0);
            let right = std::array::from_fn(|axis| g[axis] / factors[axis]);
            judge(&tree, p, right, g);
            judge(&tree, p, right, std::array::from_fn(|axis| g[axis] * factors[axis]));
        }
    }
    let p = [0.75, 0.5, 0.5];
    let g = ball_gradient(p.map(|x| x / 2.0), center, 1.0);
    judge(&ball.scale(2.0), p, times(0.5, g), g);
}

/// Ricci's blend took powers of the fields as they are: with n = 512 they leave the range of f32, so that the
/// blend was 0 or infinite.
#[test]
fn large_exponents_do_not_overflow() {
    const N: i32 = 512;
    let plain = |fields: [f32; 2]| fields.map(|f| f.powi(N)).iter().sum::<f32>().powf(1.0 / N as f32);
    let naive_weight = |fields: [f32; 2]| fields[0].powi(N) / fields.map(|f| f.powi(N)).iter().sum::<f32>();
    for (strength, broken) in [(0.5, 0.0), (3.0, f32::INFINITY)] {
        assert_eq!(plain([strength; 2]), broken, "the defect would be seen");
        assert!(naive_weight([strength; 2]).is_nan());
        let ball = |x: f64| point([x, 0.0, 0.0], 2.0).strength(f64::from(strength));
        let tree = ball(-1.0).color([1.0, 0.0, 0.0]).ricci(f64::from(N), &ball(1.0).color([0.0, 0.0, 1.0]));
        for (engine, samples) in answers(&tree, &[[0.0; 3], [1.0, 0.0, 0.0]]) {
            let name = engine.name();
            // Two equal fields, and one alone.
            let equal = 0.5 * f64::from(strength) * 2.0f64.powf(1.0 / f64::from(N));
            for (index, expected) in [equal, f64::from(strength)].into_iter().enumerate() {
                let got = f64::from(samples.field()[index]);
                assert!((got - expected).abs() < 1e-5 * expected, "{name}: expected {expected}, got {got}");
            }
            let red = &samples.attribute("color").expect("it was asked for")[0];
            assert!(
                (red[0] - 0.5).abs() < 1e-4 && red[1].abs() < 1e-4,
                "{name}: expected 0.5 and 0, got {red:?}"
            );
            let gradient = samples.gradient().expect("it was asked for");
            assert!(gradient.iter().all(|plane| plane.iter().all(|g| g.is_finite())), "{name}: {gradient:?}");
        }
    }
}

/// Warps did nothing in a SIMD evaluator: the child was asked where the node was.
#[test]
fn warps_do_something_in_lanes() {
    let ball = point([0.5, 0.0, 0.0], 1.0);
    let twisted = ball.twist(Axis::Z, 2.0);
    let points: Vec<[f32; 3]> = (0..37).map(|index| [0.5, 0.25, index as f32 / 37.0]).collect();
    for ((engine, warped), (_, still)) in answers(&twisted, &points).into_iter().zip(answers(&ball, &points))
    {
        let mut differ = 0;
        for (index, p) in points.iter().enumerate() {
            let [x, y, z] = p.map(f64::from);
            let (sin, cos) = (2.0 * z).sin_cos();
            let child = [cos * x + sin * y - 0.5, cos * y - sin * x, z];
            let (expected, got) = (soft(length(child).powi(2)), f64::from(warped.field()[index]));
            assert!(
                (got - expected).abs() < 1e-5,
                "{} at {p:?}: expected {expected}, got {got}",
                engine.name()
            );
            differ += usize::from((got - f64::from(still.field()[index])).abs() > 1e-3);
        }
        assert!(differ > 30, "{}: the defect would be seen at {differ} points", engine.name());
    }
}

/// A round cone took the ball at `x - y (r1 - r2) / L` for the nearest one (in three-js-blobtree), where x is
/// along the axis and y beside it: the foot of the perpendicular, moved by the slope of the radius, `k =
/// (r2 - r1) / L`. The nearest one is at `x + y k / sqrt(1 - k^2)`.
#[test]
fn the_ball_of_a_round_cone_is_the_nearest_one() {
    let (length_of_axis, radius, p) = (5.0, 6.0, [1.5, 4.0, 0.0]);
    for (k, seen) in [(0.3, 0.01), (-0.3, 0.01), (0.6, 0.1)] {
        let [r1, r2] = [2.0, 2.0 + k * length_of_axis];
        let tree =
            round_cone([0.0; 3], [length_of_axis, 0.0, 0.0], r1, r2, radius).rotate([0.0, 0.0, 1.0], 30.0);
        let at = |tau: f64| {
            let from_ball = minus(p, [tau, 0.0, 0.0]);
            let distance = length(from_ball) - (r1 + k * tau);
            let s = (distance / radius).powi(2);
            let slope = -(22.0 - 34.0 * s + 12.0 * s * s) / 9.0 * 2.0 * distance / (radius * radius);
            (distance, turned(times(slope / length(from_ball), from_ball)))
        };
        let (right, defective) =
            (at(p[0] + p[1] * k / (1.0 - k * k).sqrt()), at(p[0] - p[1] * (r1 - r2) / length_of_axis));
        let best = (0..=5000).map(|i| at(1e-3 * f64::from(i)).0).fold(f64::INFINITY, f64::min);
        assert!(
            (right.0 - best).abs() < 1e-6 && defective.0 > best + 1e-4,
            "{best}, {right:?}, {defective:?}"
        );
        judge_seen(&tree, turned(p), right.1, defective.1, seen);
    }
}

/// A vector after a turn by 30 degrees about z.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = f64::to_radians(30.0).sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

// Below: the defects of members that others had and got wrong, one test each, added together with the member.

/// A blend with a negative exponent took powers of the fields as they are: with n = -512 they are infinite or
/// 0, and so it was 0 or infinite.
#[test]
fn large_negative_exponents_do_not_overflow() {
    const N: i32 = -512;
    let plain = |fields: [f32; 2]| fields.map(|f| f.powi(N)).iter().sum::<f32>().powf(1.0 / N as f32);
    for (strength, broken) in [(0.5, 0.0), (3.0, f32::INFINITY)] {
        assert_eq!(plain([strength; 2]), broken, "the defect would be seen");
        // The middle is half of either ball's field.
        let ball = |x: f64| point([x, 0.0, 0.0], 2.0).strength(2.0 * f64::from(strength));
        let tree = ball(-1.0).ricci(f64::from(N), &ball(1.0));
        let equal = f64::from(strength) * 2.0f64.powf(1.0 / f64::from(N));
        for (engine, samples) in answers(&tree, &[[0.0; 3], [1.0, 0.0, 0.0]]) {
            let [middle, alone] = [0, 1].map(|index| f64::from(samples.field()[index]));
            let name = engine.name();
            assert!((middle - equal).abs() < 1e-5 * equal, "{name}: expected {equal}, got {middle}");
            assert_eq!(alone, 0.0, "{name}: one field is 0");
            let gradient = samples.gradient().expect("it was asked for");
            assert!(gradient.iter().all(|plane| plane.iter().all(|g| g.is_finite())), "{name}: {gradient:?}");
        }
    }
}

/// R-functions were taken as they are: R_0 of two fields that are 0 is not 0, so the union had a field
/// everywhere and the intersection was -1.2 where there is nothing.
#[test]
fn rfunctions_have_no_background() {
    let r = |x: f64, y: f64| x + y + x.hypot(y);
    let union = |a: f64, b: f64| 0.5 + r(a - 0.5, b - 0.5);
    let intersection = |a: f64, b: f64| 0.5 - r(0.5 - a, 0.5 - b);
    assert!((union(0.0, 0.0) - 0.207_106_8).abs() < 1e-7);
    assert!((intersection(0.0, 0.0) + 1.207_106_8).abs() < 1e-7);
    let balls = || [-1.0, 1.0].map(|x| point([x, 0.0, 0.0], 2.0));
    let nothing = [([0.0, 0.0, 3.0], 0.0), ([3.0, 1.0, 0.0], 0.0)];
    judge_fields(&Tree::rfunction(SetOperation::Union, 0.0, balls()), &nothing, |_| union(0.0, 0.0));
    let tree = Tree::rfunction(SetOperation::Intersection, 0.0, balls());
    judge_fields(&tree, &nothing, |_| intersection(0.0, 0.0));
    // The surface is the same: where both fields are 1/2, all of them are.
    assert_eq!((union(0.5, 0.5), intersection(0.5, 0.5)), (0.5, 0.5));
    for (engine, samples) in answers(&tree, &[[0.0; 3]]) {
        assert_eq!(samples.field(), [0.5], "{}", engine.name());
    }
    for (_, samples) in answers(&tree, &[[0.0, 0.0, 3.0]]) {
        assert_eq!(samples.field()[0].to_bits(), 0);
    }
}

/// A taper divided by its scale, which is 0 at the tip and beyond it: the axis had no field there.
#[test]
fn a_taper_to_radius_zero_is_a_number() {
    let tree = segment([0.0; 3], [0.0, 0.0, 3.0], 1.0).taper(Axis::Z, 0.0, 1.0, 1.0, 0.0);
    let divided = |[x, y, z]: [f64; 3]| {
        let scale = 1.0 - f64::clamp(z, 0.0, 1.0);
        soft((x / scale).powi(2) + (y / scale).powi(2))
    };
    assert_eq!(divided([0.25, 0.0, 0.5]), 0.5);
    let places = [([0.0, 0.0, 1.0], 1.0), ([0.0, 0.0, 2.0], 1.0), ([0.0, 0.0, 3.5], 0.5)];
    for (at, _) in places {
        let across = 0.0 / (1.0 - f64::clamp(at[2], 0.0, 1.0));
        assert!(across.is_nan(), "the defect would be seen");
    }
    judge_fields(&tree, &places, |_| f64::NAN);
}

/// HyperFun's taper takes a scale near 0 as 1, so that at the tip, and beyond it, the child is seen in its
/// full width: a jump.
#[test]
fn a_taper_has_no_jump_at_its_tip() {
    let tree = segment([0.5, 0.0, 0.0], [0.5, 0.0, 3.0], 1.0).taper(Axis::Z, 0.0, 1.0, 1.0, 0.0);
    let jumps = |[x, y, z]: [f64; 3]| {
        let scale = 1.0 - f64::clamp(z, 0.0, 1.0);
        let scale = if scale.abs() < 1e-6 { 1.0 } else { scale };
        soft((x / scale - 0.5).powi(2) + (y / scale).powi(2))
    };
    // Just below the tip there is nothing beside the axis, in both.
    let below = [0.5, 0.0, 0.999];
    assert_eq!(jumps(below), 0.0);
    for (engine, samples) in answers(&tree, &[below.map(|x| x as f32)]) {
        assert_eq!(samples.field(), [0.0], "{}", engine.name());
    }
    judge_fields(&tree, &[([0.5, 0.0, 1.0], 0.0), ([0.75, 0.25, 1.0], 0.0), ([0.5, 0.0, 2.0], 0.0)], jumps);
}

/// Barr's bend in its usual form, about x towards z: the child's height is `1/k - root`, its place on the
/// spine `atan2 / k`.
fn printed_bend([_, y, z]: [f32; 3], k: f32, sign: f32) -> [f64; 2] {
    let (sense, up) = (k.signum(), z - 1.0 / k);
    let place = (sense * y).atan2(-sense * up) / k;
    [place, 1.0 / k + sign * sense * (y * y + up * up).sqrt()].map(f64::from)
}

/// A bend divided by its rate: of rate 0 it had no value, and of a small one no digits.
#[test]
fn a_bend_of_rate_zero_is_the_identity() {
    let ball = point([0.0; 3], 1.0);
    let at = [0.0, 0.25, 0.3];
    let right = soft(0.0625 + 0.09);
    for rate in [0.0, 1e-7] {
        let divided = |at: [f64; 3]| {
            let [y, z] = printed_bend(at.map(|x| x as f32), rate as f32, -1.0);
            soft(y * y + z * z)
        };
        assert_eq!(printed_bend(at.map(|x| x as f32), rate as f32, -1.0)[1].is_nan(), rate == 0.0);
        judge_fields(&ball.bend(Axis::X, rate, -1.0, 1.0, 0), &[(at, right)], divided);
    }
}

/// The bend is printed with the other one of two roots, `1/k + root`: the place that stays came to the height
/// 2/k.
#[test]
fn a_bend_takes_the_right_root() {
    for rate in [0.5f64, -0.5] {
        let tree = segment([0.0, -2.0, 0.0], [0.0, 2.0, 0.0], 1.0).bend(Axis::X, rate, -2.0, 2.0, 0);
        let field = |sign: f32| {
            move |at: [f64; 3]| {
                let [y, z] = printed_bend(at.map(|x| x as f32), rate as f32, sign);
                soft(z * z + (y.abs() - 2.0).max(0.0).powi(2))
            }
        };
        // On the arc, whose radius is 2, and half a unit outside of it.
        let (sin, cos) = 0.5f64.sin_cos();
        let places =
            [[0.0; 3], [0.0, 2.0 * sin, (1.0 - cos) / rate], [0.0, 2.5 * sin, (1.0 - 1.25 * cos) / rate]];
        let known = [1.0, 1.0, 0.5];
        for (at, right) in places.into_iter().zip(known) {
            assert!((field(-1.0)(at) - right).abs() < 1e-5, "the right root is right");
            judge_fields(&tree, &[(at, right)], field(1.0));
        }
    }
}

/// A twist kept the box of its child: a bar across the axis, which is turned out of it, was clipped, or left
/// out where somebody looked.
#[test]
fn a_twist_has_a_box_of_its_own() {
    let bar = segment([-2.0, 0.0, 1.0], [2.0, 0.0, 1.0], 0.5);
    let twisted = bar.twist(Axis::Z, std::f64::consts::FRAC_PI_2);
    let [child, own] =
        [bar, twisted.clone()].map(|tree| Model::new(tree).check().expect("a good model").support());
    let there = [0.0, 1.75, 1.0];
    let holds =
        |low: [f64; 3], high: [f64; 3]| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&there[axis]));
    assert!(!holds(child.low(), child.high()), "the defect would be seen");
    assert!(holds(own.low(), own.high()));
    judge_fields(&twisted, &[(there, 1.0)], |_| 0.0);
}
