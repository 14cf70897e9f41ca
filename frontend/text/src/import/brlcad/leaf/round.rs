//! Solids that are round all over: ellipsoids, tori, hulls of two balls.

use glam::DVec3;
use jbt_model::bounds::Bounds;
use jbt_model::builder::{x, y, z};
use jbt_model::skeleton::{Point, Ring, Segment, Superquadric};
use jbt_model::tree::Tree;

use super::make::{
    Flaw, LeafStyle, SolidLeaf, centered, direction, formula, frame, framed, grown, length, positive, upright,
};
use super::parts::{Revolved, SolidParts};

/// How nearly equal what counts as equal is.
const NEAR: f64 = 1e-12;

/// All points `p` with `sum (q . A / A . A)^2 <= 1`, where `q = p - V`.
pub(super) fn ellipsoid(center: DVec3, axes: [DVec3; 3], style: LeafStyle) -> Result<SolidLeaf, Flaw> {
    let lengths = lengths(axes)?;
    let bounds = around(center, axes);
    let [a, b, c] = lengths;
    if style == LeafStyle::Alike {
        let ball = Revolved { first: [0.5, 0.0, 0.0], second: [0.0, 0.5, 0.0], height: [0.0, 1.0] };
        let inside = SolidParts { round: Some(ball), ..SolidParts::default() }.field(style);
        let leaf = framed(inside, centered([2.0; 3]), &frame(center, axes)?, Bounds::EMPTY);
        return Ok(SolidLeaf { bounds, has_radius: false, ..leaf });
    }
    if (a - b).abs() <= NEAR * a && (a - c).abs() <= NEAR * a {
        let tree = grown(Point { at: center }, a);
        return Ok(SolidLeaf { tree, bounds, nodes: 1, has_radius: false });
    }
    let frame = frame(center, axes)?;
    let tree = Tree::new(frame, vec![grown(Point { at: DVec3::ZERO }, 1.0)]);
    Ok(SolidLeaf { tree, bounds, nodes: 2, has_radius: false })
}

fn lengths(axes: [DVec3; 3]) -> Result<[f64; 3], Flaw> {
    Ok([direction("A", axes[0])?.1, direction("B", axes[1])?.1, direction("C", axes[2])?.1])
}

/// The box around an ellipsoid.
fn around(center: DVec3, axes: [DVec3; 3]) -> Bounds {
    let [a, b, c] = axes.map(|axis| axis * axis);
    let half = (a + b + c).map(f64::sqrt);
    Bounds::new(center - half, center + half)
}

/// Barr's superquadric with `(|x|^(2/e) + |y|^(2/e))^(e/n) + |z|^(2/n) <= 1`, along the axes.
pub(super) fn superellipsoid(center: DVec3, axes: [DVec3; 3], [n, e]: [f64; 2]) -> Result<SolidLeaf, Flaw> {
    lengths(axes)?;
    let (n, e) = (positive("n", n)?, positive("e", e)?);
    let frame = frame(center, axes)?;
    let is_norm = |exponent: f64| (1.0 / 512.0..=2.0).contains(&exponent);
    if is_norm(n) && is_norm(e) {
        let skeleton = Superquadric { center: DVec3::ZERO, e1: n, e2: e, stretch: DVec3::ONE };
        let tree = Tree::new(frame, vec![grown(skeleton, 1.0)]);
        let bounds = Bounds::around(corners(&axes).map(|corner| center + corner));
        return Ok(SolidLeaf { tree, bounds, nodes: 2, has_radius: false });
    }
    let side = x().abs().powf(2.0 / e) + y().abs().powf(2.0 / e);
    let value = side.powf(e / n) + z().abs().powf(2.0 / n);
    let leaf = framed(1.0 - 0.5 * value, centered([2.0; 3]), &frame, centered([1.0; 3]));
    Ok(SolidLeaf { has_radius: false, ..leaf })
}

/// The corners of a box with these half sides.
fn corners(half: &[DVec3; 3]) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        half[0] * sign(0) + half[1] * sign(1) + half[2] * sign(2)
    })
}

/// All points within `r_h` of the circle of radius `r_a` about H.
pub(super) fn torus(
    center: DVec3,
    normal: DVec3,
    [r_a, r_h]: [f64; 2],
    style: LeafStyle,
) -> Result<SolidLeaf, Flaw> {
    let (normal, _) = direction("H", normal)?;
    let (r_a, r_h) = (positive("r_a", r_a)?, positive("r_h", r_h)?);
    let half = normal.map(|n| (1.0 - n * n).max(0.0).sqrt() * r_a + r_h);
    let bounds = Bounds::new(center - half, center + half);
    if style == LeafStyle::Alike {
        let thin = 0.5 / r_h;
        let tube = Revolved { first: [thin, 0.0, -thin * r_a], second: [0.0, thin, 0.0], height: [0.0, 1.0] };
        let inside = SolidParts { round: Some(tube), ..SolidParts::default() }.field(style);
        let out = r_a + 2.0 * r_h;
        let within = centered([out, out, 2.0 * r_h]);
        let leaf = framed(inside, within, &frame(center, upright(normal))?, Bounds::EMPTY);
        return Ok(SolidLeaf { bounds, ..leaf });
    }
    let tree = grown(Ring { center, normal, radius: r_a }, r_h);
    Ok(SolidLeaf { tree, bounds, nodes: 1, has_radius: true })
}

/// An ellipse that goes round an axis at the distance r. C is its longer half axis, as it stands where it
/// begins, `r_d` the length of the other one.
pub(super) fn elliptical_torus(
    v: DVec3,
    n: DVec3,
    c: DVec3,
    [r, r_d]: [f64; 2],
    style: LeafStyle,
) -> Result<SolidLeaf, Flaw> {
    let (n, _) = direction("N", n)?;
    let (c, long) = direction("C", c)?;
    let (r, short) = (positive("r", r)?, positive("r_d", r_d)?);
    // The direction of the long axis, outwards and along the axis of the torus.
    let along = c.dot(n).clamp(-1.0, 1.0);
    let out = (1.0 - along * along).sqrt();
    let from_ring = |a: f64, b: f64, size: f64| [0.5 * a / size, 0.5 * b / size, -0.5 * a * r / size];
    let tube = Revolved {
        first: from_ring(out, along, long),
        second: from_ring(-along, out, short),
        height: [0.0, 1.0],
    };
    let inside = SolidParts { round: Some(tube), ..SolidParts::default() }.field(style);
    let reach = [(out * long).hypot(along * short), (along * long).hypot(out * short)];
    let frame = frame(v, upright(n))?;
    let around = |scale: f64| centered([r + scale * reach[0], r + scale * reach[0], scale * reach[1]]);
    Ok(framed(inside, around(2.0), &frame, around(1.0)))
}

/// The hull of two balls: of radius `r_v` at V, and `r_h` at V + H.
pub(super) fn particle(v: DVec3, h: DVec3, r_v: f64, r_h: f64) -> Result<SolidLeaf, Flaw> {
    if r_v < 0.0 || r_h < 0.0 {
        return Err(format!("its radii are {r_v} and {r_h}"));
    }
    let (height, radius) = (h.length(), positive("r_v", r_v.max(r_h))?);
    let ball = |center: DVec3, radius: f64| Bounds::new(center - radius, center + radius);
    let bounds = ball(v, r_v).hull(ball(v + h, r_h));
    let plain = |tree| SolidLeaf { tree, bounds, nodes: 1, has_radius: true };
    if (r_v - r_h).abs() >= height {
        let at = if r_v >= r_h { v } else { v + h };
        return Ok(plain(grown(Point { at }, radius)));
    }
    if (r_v - r_h).abs() <= NEAR * radius {
        return Ok(plain(grown(Segment { from: v, to: v + h }, radius)));
    }
    // The nearest ball is where the line to the point leaves the axis at the slope of the cone.
    let slope = (r_h - r_v) / height;
    let beside = length(&x(), &y());
    let along = (z() + (slope / (1.0 - slope * slope).sqrt()) * &beside).clamp(0.0, height);
    let from = (beside.square() + (z() - &along).square()).sqrt();
    let inside = (0.5 + r_v / (2.0 * radius)) + (slope / (2.0 * radius)) * along - (0.5 / radius) * from;
    let frame = frame(v, upright(h / height))?;
    let within = Bounds::new(
        DVec3::new(-2.0 * radius, -2.0 * radius, -r_v - radius),
        DVec3::new(2.0 * radius, 2.0 * radius, height + r_h + radius),
    );
    Ok(plain(formula(inside, within, &frame)))
}
