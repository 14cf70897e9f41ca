//! Checks for the tests of all warps: every warp is compared with its own statements.

use std::fmt::Debug;

use glam::{DMat3, DVec3, Vec3};
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::{Domain, Function, FunctionBuilder, Tables, interpret, pass, verify};

use super::{Warp, WarpMember};
use crate::bounds::Bounds;

/// A number in [-1.5, 1.5].
pub fn real(rng: &mut fastrand::Rng) -> f64 {
    3.0 * rng.f64() - 1.5
}

fn vector(rng: &mut fastrand::Rng, size: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| size * (2.0 * rng.f64() - 1.0)))
}

/// Whether a box holds a point.
pub fn holds(bounds: Bounds, p: DVec3) -> bool {
    p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()
}

/// The numbers of a row, rounded once.
fn row(warp: &Warp) -> Vec<f32> {
    let mut row = Vec::new();
    warp.columns(&mut row);
    assert_eq!(row.len(), warp.code().columns().len(), "one number for each column");
    row.into_iter().map(|number| number as f32).collect()
}

/// The compiler's form in f32.
pub fn emitted(warp: &(impl WarpMember + Clone + Into<Warp>), p: Vec3) -> Vec3 {
    emitted_of(&warp.clone().into(), p)
}

fn emitted_of(warp: &Warp, p: Vec3) -> Vec3 {
    Vec3::from_array(warp.code().emit(&mut Scalar, p.to_array(), &row(warp)))
}

/// Both forms give a known point.
pub fn same(warp: &Warp, p: DVec3, expected: DVec3) {
    let plain = warp.inverse(p);
    assert!(plain.abs_diff_eq(expected, 1e-12), "{warp:?} at {p}: {plain}, not {expected}");
    let got = emitted_of(warp, p.as_vec3()).as_dvec3();
    assert!(got.abs_diff_eq(expected, 1e-5), "{warp:?} at {p}: {got} in f32, not {expected}");
}

/// The inverse map of a warp with its gradient, as the gradient pass makes it.
fn program(warp: &Warp, axis: usize) -> Function {
    let mut builder = FunctionBuilder::new("warp", &["x", "y", "z"]);
    let p = std::array::from_fn(|axis| builder.input(axis));
    let row: Vec<_> = row(warp).into_iter().map(|number| builder.constant(number)).collect();
    let q = warp.code().emit(&mut builder, p, &row);
    pass::gradient(&builder.finish(&[("field".to_owned(), q[axis])]))
}

/// The Jacobian of the inverse map by the gradient pass, in f32.
pub fn jacobian(warp: &Warp, p: DVec3) -> DMat3 {
    let rows = [0, 1, 2].map(|axis| {
        let verified = verify(program(warp, axis)).expect("the pass makes a good function");
        let answers = interpret::run(&verified, &Tables::default(), &mut Scalar, &p.as_vec3().to_array());
        DVec3::new(answers[1].into(), answers[2].into(), answers[3].into())
    });
    DMat3::from_cols(rows[0], rows[1], rows[2]).transpose()
}

/// The map and its derivatives are finite at a point.
pub fn finite(warp: &Warp, p: DVec3) {
    assert!(warp.inverse(p).is_finite(), "{warp:?} at {p}");
    assert!(emitted_of(warp, p.as_vec3()).is_finite(), "{warp:?} at {p} in f32");
    let jacobian = jacobian(warp, p);
    assert!(jacobian.is_finite(), "{warp:?} at {p}: {jacobian}");
}

/// Judges random warps by their own statements.
pub fn judge<W>(mut make: impl FnMut(&mut fastrand::Rng) -> W)
where
    W: WarpMember + PartialEq + Debug + Clone + Into<Warp>,
{
    let mut rng = fastrand::Rng::with_seed(7);
    let mut compared = 0;
    for _ in 0..150 {
        let member = make(&mut rng);
        assert_eq!(W::from_fields(&member.to_fields()), member);
        let warp: Warp = member.into();
        assert_eq!(warp.fault(), None, "{warp:?}");
        boxes_hold(&warp, &mut rng);
        growth_bounds(&warp, &mut rng);
        far_is_far(&warp, &mut rng);
        for _ in 0..34 {
            compared += usize::from(forms_agree(&warp, vector(&mut rng, 2.0).as_vec3()));
        }
    }
    assert!(compared > 2500, "{compared} of 5,100 points are away from decisions");
}

/// The checks of [`judge`] that suit a formula warp, which is no member. Returns how many points were
/// compared.
pub fn judge_formulas(warp: &Warp, rng: &mut fastrand::Rng) -> usize {
    assert_eq!(warp.fault(), None, "{warp:?}");
    boxes_hold(warp, rng);
    growth_bounds(warp, rng);
    far_is_far(warp, rng);
    (0..34).filter(|_| forms_agree(warp, vector(rng, 2.0).as_vec3())).count()
}

/// The two forms agree, and finite differences of the one agree with the derivative of the other. Returns
/// whether the point was compared.
fn forms_agree(warp: &Warp, p: Vec3) -> bool {
    let step = 1e-6;
    let at = p.as_dvec3();
    if warp.kink_distance(at) < 1e-3 {
        return false;
    }
    let central = |step: f64| {
        let columns = DVec3::AXES.map(|axis| {
            let [before, behind] = [at - step * axis, at + step * axis].map(|p| warp.inverse(p));
            (behind - before) / (2.0 * step)
        });
        DMat3::from_cols(columns[0], columns[1], columns[2])
    };
    let expected = central(step);
    let size = expected.to_cols_array().iter().fold(1.0, |size: f64, x| size.max(x.abs()));
    let found = emitted_of(warp, p).as_dvec3();
    let plain = warp.inverse(at);
    let allowed = 2e-6 * size * (2.0 + plain.length());
    assert!(found.abs_diff_eq(plain, allowed), "{warp:?} at {p}: {found} in f32, {plain} in f64");
    let curved = (central(2.0 * step) - expected).to_cols_array().iter().any(|x| x.abs() > 1e-4 * size);
    if curved || size > 1e3 {
        return false;
    }
    let found = jacobian(warp, at);
    assert!(found.abs_diff_eq(expected, 3e-4 * size), "{warp:?} at {p}: {found}, differences {expected}");
    true
}

/// Neither form takes a point outside of the boxes into the child's box.
fn boxes_hold(warp: &Warp, rng: &mut fastrand::Rng) {
    for size in [1.0, 0.1, 100.0] {
        let (a, b) = (vector(rng, size), vector(rng, size));
        let child = Bounds::new(a.min(b), a.max(b));
        let (plain, reach) = (warp.forward_bounds(child), warp.reach(child));
        let widest = if plain.is_empty() { 1.0 } else { plain.min.abs().max(plain.max.abs()).max_element() };
        let far = if widest.is_finite() { 1.2 * widest } else { 3.0 * size };
        for index in 0..400 {
            let p = if index % 2 == 0 { vector(rng, far) } else { vector(rng, 1.5 * size) }.as_vec3();
            if holds(child, warp.inverse(p.as_dvec3())) {
                assert!(
                    holds(plain.grown(1e-9 * size), p.as_dvec3()),
                    "{warp:?} brings {p} into {child:?}: {plain:?}"
                );
            }
            if holds(child, emitted_of(warp, p).as_dvec3()) {
                assert!(holds(reach, p.as_dvec3()), "{warp:?} brings {p} into {child:?}: {reach:?}");
            }
        }
    }
}

/// Coordinates whose squares overflow, mixed with small ones, are taken to numbers, and only into boxes that
/// reach that far.
fn far_is_far(warp: &Warp, rng: &mut fastrand::Rng) {
    const COORDINATES: [f32; 12] =
        [0.0, -0.0, 1e-45, 1.0, -7.0, 1e6, -1e10, 1e19, -2e19, 1e30, -3e38, f32::MAX];
    let (a, b) = (vector(rng, 1.0), vector(rng, 1.0));
    let child = Bounds::new(a.min(b), a.max(b));
    let reach = warp.reach(child);
    for x in COORDINATES {
        for y in COORDINATES {
            for z in COORDINATES {
                let p = Vec3::new(x, y, z);
                let q = emitted_of(warp, p);
                assert!(!q.is_nan(), "{warp:?} takes {p} to {q}");
                assert!(
                    !holds(child, q.as_dvec3()) || holds(reach, p.as_dvec3()),
                    "{warp:?} brings {p} into {child:?}: {reach:?}"
                );
            }
        }
    }
}

/// Coordinates and derivatives are within the stated growth.
fn growth_bounds(warp: &Warp, rng: &mut fastrand::Rng) {
    for size in [0.5, 3.0, 1e6] {
        let growth = warp.growth(size);
        for _ in 0..10 {
            let p = vector(rng, size);
            let q = emitted_of(warp, p.as_vec3());
            let largest = f64::from(q.abs().max_element());
            assert!(largest <= growth.coordinates, "{warp:?} at {p}: {q}, not within {growth:?}");
        }
        let p = vector(rng, size);
        let rows = jacobian(warp, p).transpose();
        for row in [rows.x_axis, rows.y_axis, rows.z_axis] {
            let sum = row.abs().element_sum();
            assert!(sum <= growth.derivatives, "{warp:?} at {p}: {row}, not within {growth:?}");
        }
    }
}
