//! Paraboloids and hyperboloids between flat ends, and cylinders over parabolas and hyperbolas.
//!
//! In their frames a base is at z = 0 and a top at z = 1; B of a cylinder is along z too, and its length
//! along x.

use glam::DVec3;
use jbt_model::bounds::Bounds;
use jbt_model::builder::{Term, x, y, z};

use super::make::{Flaw, LeafStyle, SolidLeaf, direction, frame, framed, least, length, positive};
use super::parts::{HalfField, Revolved, SolidParts};

/// How sharply the sides of a frame of these sizes bound a field: one half over the thickness, for each.
fn sharpness<const N: usize>(sizes: [f64; N]) -> [f64; N] {
    let thickness = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    sizes.map(|size| 0.5 * size / thickness)
}

/// A frame whose z is a vector, and whose x is along another one, made perpendicular.
fn axes(z: DVec3, along: DVec3, name: &str) -> Result<[DVec3; 2], Flaw> {
    let (unit, _) = direction("H", z)?;
    let (first, _) = direction(name, along - unit * along.dot(unit))?;
    Ok([first, unit.cross(first)])
}

/// From a base with half axes `r_1` (along A) and `r_2` to the apex: `x^2 + y^2 <= 1 - z`.
pub(super) fn paraboloid(v: DVec3, h: DVec3, a: DVec3, [r_1, r_2]: [f64; 2]) -> Result<SolidLeaf, Flaw> {
    let (r_1, r_2) = (positive("r_1", r_1)?, positive("r_2", r_2)?);
    let [first, second] = axes(h, a, "A")?;
    let frame = frame(v, [first * r_1, second * r_2, h])?;
    let [side, base] = sharpness([0.5 * r_1.min(r_2), 0.5 * h.length()]);
    let bowl = (0.5 + side) - side * (x().square() + y().square() + z());
    let inside = least([bowl, 0.5 + base * z()]);
    let (above, below) = (0.5 / side, 0.5 / base);
    Ok(bowl_leaf(inside, &frame, (1.0 + above + below).sqrt(), [below, above]))
}

/// The same with a hyperbola, whose asymptotes meet at the distance c above the apex:
/// `(1 + 2 c) (x^2 + y^2) <= (1 + c - z)^2 - c^2`, c as a fraction of the height.
pub(super) fn hyperboloid(
    v: DVec3,
    h: DVec3,
    a: DVec3,
    [r_1, r_2, c]: [f64; 3],
    style: LeafStyle,
) -> Result<SolidLeaf, Flaw> {
    let (r_1, r_2) = (positive("r_1", r_1)?, positive("r_2", r_2)?);
    let [first, second] = axes(h, a, "A")?;
    let frame = frame(v, [first * r_1, second * r_2, h])?;
    let [side, base] = sharpness([0.5 * r_1.min(r_2), 0.5 * h.length()]);
    let c = asymptotes(c, h.length())?;
    let round = Revolved {
        first: [side * (1.0 + 2.0 * c).sqrt(), 0.0, 0.0],
        second: [0.0, 0.0, side * c],
        height: [side, 0.5 + side * (1.0 + c)],
    };
    let planes = vec![HalfField { slope: [0.0, 0.0, -base], offset: 0.5 }];
    let inside = SolidParts { round: Some(round), planes, ..SolidParts::default() }.field(style);
    let (above, below) = (0.5 / side, 0.5 / base);
    Ok(bowl_leaf(inside, &frame, hyperbola_width(c, below + above), [below, above]))
}

/// The distance of the asymptotes as a fraction of the height.
fn asymptotes(c: f64, height: f64) -> Result<f64, Flaw> {
    if c >= 0.0 { Ok(c / height) } else { Err(format!("`c` is {c}")) }
}

/// Above 1/2 below the hyperbola that is 0 high at distance 1, and 1 high at distance 0.
fn hyperbola(c: f64, side: f64) -> Term {
    let surface = ((1.0 + 2.0 * c) * y().square() + c * c).sqrt();
    (0.5 + side * (1.0 + c)) - side * (z() + surface)
}

/// How wide the hyperbola is at a distance below its base.
fn hyperbola_width(c: f64, below: f64) -> f64 {
    (((1.0 + c + below).powi(2) - c * c) / (1.0 + 2.0 * c)).sqrt()
}

fn bowl_leaf(inside: Term, frame: &glam::DAffine3, wide: f64, [below, above]: [f64; 2]) -> SolidLeaf {
    let within = Bounds::new(DVec3::new(-wide, -wide, -below), DVec3::new(wide, wide, 1.0 + above));
    let bounds = Bounds::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 1.0));
    framed(inside, within, frame, bounds)
}

/// The parabola `y^2 <= 1 - z` over a base of half width r, z along B, drawn out along H.
pub(super) fn parabolic_cylinder(v: DVec3, h: DVec3, b: DVec3, r: f64) -> Result<SolidLeaf, Flaw> {
    let (frame, [side, base, ends]) = cylinder(v, h, b, r)?;
    let bow = (0.5 + side) - side * (y().square() + z());
    let inside = least([bow, 0.5 + base * z(), (0.5 + ends) - ends * x().abs()]);
    let (above, below) = (0.5 / side, 0.5 / base);
    Ok(bow_leaf(inside, &frame, 1.0 + 0.5 / ends, (1.0 + above + below).sqrt(), [below, above]))
}

/// The same with a hyperbola: `(1 + 2 c) y^2 <= (1 + c - z)^2 - c^2`.
pub(super) fn hyperbolic_cylinder(v: DVec3, h: DVec3, b: DVec3, r: f64, c: f64) -> Result<SolidLeaf, Flaw> {
    let (frame, [side, base, ends]) = cylinder(v, h, b, r)?;
    let c = asymptotes(c, b.length())?;
    let bow = hyperbola(c, side);
    let inside = least([bow, 0.5 + base * z(), (0.5 + ends) - ends * x().abs()]);
    let (above, below) = (0.5 / side, 0.5 / base);
    Ok(bow_leaf(inside, &frame, 1.0 + 0.5 / ends, hyperbola_width(c, below + above), [below, above]))
}

/// The frame of a cylinder over a curve: x from end to end, y across, z along B.
fn cylinder(v: DVec3, h: DVec3, b: DVec3, r: f64) -> Result<(glam::DAffine3, [f64; 3]), Flaw> {
    let ((along, _), (up, _), r) = (direction("H", h)?, direction("B", b)?, positive("r", r)?);
    let (across, _) = direction("B", along.cross(up))?;
    let frame = frame(v + 0.5 * h, [0.5 * h, across * r, b])?;
    Ok((frame, sharpness([0.5 * r, 0.5 * b.length(), 0.5 * h.length()])))
}

fn bow_leaf(
    inside: Term,
    frame: &glam::DAffine3,
    long: f64,
    wide: f64,
    [below, above]: [f64; 2],
) -> SolidLeaf {
    let within = Bounds::new(DVec3::new(-long, -wide, -below), DVec3::new(long, wide, 1.0 + above));
    let bounds = Bounds::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 1.0));
    framed(inside, within, frame, bounds)
}

/// A hyperboloid of one sheet: half axes A and b at both ends, and `bnr` times them in the middle of H.
pub(super) fn waist(v: DVec3, h: DVec3, a: DVec3, b: f64, bnr: f64) -> Result<SolidLeaf, Flaw> {
    let (b, bnr) = (positive("b", b)?, positive("bnr", bnr)?);
    let [first, second] = axes(h, a, "A")?;
    let wide = a.length();
    if bnr > 1.0 {
        return Err(format!("`bnr` is {bnr}"));
    }
    // x and y are 1 at the neck: there x^2 + y^2 <= 1 + k z^2, z from -1 to 1.
    let frame = frame(v + 0.5 * h, [first * (bnr * wide), second * (bnr * b), 0.5 * h])?;
    let k = (1.0 - bnr * bnr) / (bnr * bnr);
    let [side, ends] = sharpness([bnr * wide.min(b), 0.5 * h.length()]);
    let neck = (k * z().square() + 1.0).sqrt();
    let inside = least([0.5 + side * (neck - length(&x(), &y())), (0.5 + ends) - ends * z().abs()]);
    let beyond = 1.0 + 0.5 / ends;
    let out = (1.0 + k * beyond * beyond).sqrt() + 0.5 / side;
    let within = Bounds::new(DVec3::new(-out, -out, -beyond), DVec3::new(out, out, beyond));
    let mouth = 1.0 / bnr;
    let bounds = Bounds::new(DVec3::new(-mouth, -mouth, -1.0), DVec3::new(mouth, mouth, 1.0));
    Ok(framed(inside, within, &frame, bounds))
}
