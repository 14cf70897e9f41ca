//! Cones and cylinders between two ellipses, which may stand obliquely.

use glam::{DAffine3, DMat3, DVec3};
use jbt_model::bounds::Bounds;
use jbt_model::builder::{Term, x, y, z};

use super::make::{Flaw, LeafStyle, SolidLeaf, direction, formula, length};
use super::parts::{Revolved, SolidParts};

/// How thin a cone is at its tip, for its size: a formula that divides by the width needs one.
const TIP: f64 = 1e-6;

/// All between an ellipse with half axes A and B at V, and one with half axes of the lengths of C and D at
/// V + H, in the same directions.
///
/// With `t = N . q / N . H`, `N = A x B` and `w = q - t H`, a point is inside for t in [0, 1] and
/// `(w . A / |A| a)^2 + (w . B / |B| b)^2 <= 1`, where a and b go evenly from the lengths of A and B to those
/// of C and D.
pub(super) fn cone(
    v: DVec3,
    h: DVec3,
    [base, top]: [[DVec3; 2]; 2],
    style: LeafStyle,
) -> Result<SolidLeaf, Flaw> {
    let lengths = |pair: [DVec3; 2]| pair.map(DVec3::length);
    let ([a, b], [c, d]) = (lengths(base), lengths(top));
    // A tip has no direction, and the other end has.
    let first = direction("A", if a > 0.0 { base[0] } else { top[0] })?.0;
    let second = direction("B", if b > 0.0 { base[1] } else { top[1] })?.0;
    let (wide_a, wide_b) = (a.max(c), b.max(d));
    let normal = first.cross(second);
    let rise = normal.dot(h);
    if normal.length() < 1e-6 || rise.abs() < 1e-9 * h.length() || rise == 0.0 {
        return Err("its vectors are in one plane".to_owned());
    }
    // From the point to the frame: x and y are 1 where the wider ellipse ends, z is -1 and 1 at the ends.
    let middle = v + 0.5 * h;
    let along = normal / rise;
    let across = |unit: DVec3, wide: f64| (unit - along * h.dot(unit)) / wide;
    let rows = DMat3::from_cols(across(first, wide_a), across(second, wide_b), 2.0 * along).transpose();
    if rows.determinant() == 0.0 || !rows.is_finite() {
        return Err("it has no width".to_owned());
    }
    let linear = rows.inverse();
    let frame = DAffine3 { matrix3: linear, translation: middle };
    let half_height = 0.5 * rise.abs() / normal.length();
    // As thick as the narrower way, at the wider end.
    let thickness = wide_a.min(wide_b).min(half_height);
    let (sharp, flat) = (0.5 * wide_a.min(wide_b) / thickness, 0.5 * half_height / thickness);
    let (along_a, along_b) = ([a / wide_a, c / wide_a], [b / wide_b, d / wide_b]);
    let mut parts = SolidParts { slabs: vec![(2, flat)], ..SolidParts::default() };
    let is_even = (along_a[0] - along_b[0]).abs() + (along_a[1] - along_b[1]).abs() < 1e-12;
    let inside = if is_even {
        parts.round = Some(even(along_a, sharp));
        parts.field(style)
    } else {
        parts.field(LeafStyle::Plain).min(uneven(along_a, along_b, sharp))
    };
    let beyond = 1.0 + 0.5 / flat;
    let steepest = (1.0 - a.min(c) / wide_a).max(1.0 - b.min(d) / wide_b);
    let out = 1.0 + 0.5 / sharp + steepest * 0.25 / flat;
    let within = Bounds::new(DVec3::new(-out, -out, -beyond), DVec3::new(out, out, beyond));
    let tree = formula(inside, within, &frame);
    let bounds = ellipse(v, first * a, second * b).hull(ellipse(v + h, first * c, second * d));
    Ok(SolidLeaf { tree, bounds, nodes: 2, has_radius: false })
}

/// The side of a cone whose ellipses are alike. Half axes at both ends are fractions of the wider end.
fn even([a, c]: [f64; 2], sharp: f64) -> Revolved {
    let (middle, slope) = (0.5 * (a + c), if (a - c).abs() < 1e-12 { 0.0 } else { 0.5 * (c - a) });
    Revolved { first: [sharp, 0.0, 0.0], second: [0.0; 3], height: [-slope * sharp, 0.5 + middle * sharp] }
}

/// Above 1/2 where a point is within the ellipse of its height.
fn uneven([a, c]: [f64; 2], [b, d]: [f64; 2], sharp: f64) -> Term {
    let wide = |from: f64, to: f64| (0.5 * (from + to) + 0.5 * (to - from) * z()).max(TIP);
    let (wide_x, wide_y) = (wide(a, c), wide(b, d));
    let from_axis = length(&x(), &(y() * (&wide_x / wide_y)));
    0.5 + sharp * (wide_x - from_axis)
}

/// The box around an ellipse.
fn ellipse(center: DVec3, a: DVec3, b: DVec3) -> Bounds {
    let half = (a * a + b * b).map(f64::sqrt);
    Bounds::new(center - half, center + half)
}
