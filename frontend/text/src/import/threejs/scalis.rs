//! SCALIS primitives as formulas (Zanni et al. 2013): distances in units of a thickness that varies, and
//! convolutions along segments and over triangles.
//!
//! ```text
//! dist     K(q)              q: the smallest |p - x|^2 / t(x)^2 of all x of the skeleton
//! convol   N int k dx / t    k = max(0, 1 - |p - x|^2 / (4 t^2))^3, over a line; dx / t^2 over a triangle
//! ```
//!
//! `K(q) = (64/27) max(0, 1 - q/4)^3`. Integrals are sums over nodes in the part of the skeleton that reaches
//! the point: over a line an interval between the roots of a quadratic.

use glam::DVec3;
use jbt_model::term::{Term, x, y, z};

use super::quadrature::gauss;

/// The peak of every kernel: it is 1 at the distance of the thickness.
pub(super) const PEAK: f64 = 64.0 / 27.0;

/// Nodes along a line whose thickness varies, and along one of constant thickness, where the integrand is a
/// polynomial of degree 6.
const LINE_NODES: usize = 16;
const EVEN_NODES: usize = 4;
/// Nodes across and along the lines of a triangle.
const ACROSS: usize = 32;
const ALONG: usize = 8;

/// A vertex of a skeleton.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Vertex {
    pub(super) at: DVec3,
    pub(super) thickness: f64,
}

/// The point less a place.
pub(super) fn from(place: DVec3) -> [Term; 3] {
    [x() - place.x, y() - place.y, z() - place.z]
}

/// The product of a vector of the formula and a constant one.
pub(super) fn dot(a: &[Term; 3], b: DVec3) -> Term {
    &a[0] * b.x + &a[1] * b.y + &a[2] * b.z
}

/// The square of a vector's length.
pub(super) fn square(a: &[Term; 3]) -> Term {
    a[0].square() + a[1].square() + a[2].square()
}

/// 1 where a term is above 0, else 0.
fn positive(term: &Term) -> Term {
    term.step_at(f64::from(f32::MIN_POSITIVE))
}

/// `a` where `part` is 0, `b` where it is 1.
fn choose(a: &Term, b: &Term, part: &Term) -> Term {
    a + part * (b - a)
}

/// `K(q)`, times a density.
pub(super) fn kernel(q: &Term, density: f64) -> Term {
    (1.0 - q * 0.25).max(0.0).powf(3.0) * (PEAK * density)
}

/// The nearest place of a segment in units of its thickness: its parameter, and q there.
pub(super) fn segment([a, b]: [Vertex; 2]) -> (Term, Term) {
    let along = b.at - a.at;
    let change = b.thickness - a.thickness;
    let w = from(a.at);
    let (s, square_w, length) = (dot(&w, along), square(&w), along.length_squared());
    if length == 0.0 {
        let thickness = a.thickness.max(b.thickness);
        let end = if change > 0.0 { 1.0 } else { 0.0 };
        return (Term::from(end), square_w / (thickness * thickness));
    }
    let denominator = length * a.thickness + &s * change;
    let parameter = ((s * a.thickness + square_w * change) / &denominator).clamp(0.0, 1.0);
    // Behind the tip of the cone that the thickness makes, the larger end is nearest.
    let end = if change < 0.0 { 0.0 } else { 1.0 };
    let parameter =
        if change == 0.0 { parameter } else { choose(&end.into(), &parameter, &positive(&denominator)) };
    let off: [Term; 3] = [0, 1, 2].map(|axis| &w[axis] - &parameter * along[axis]);
    let thickness = a.thickness + &parameter * change;
    (parameter, square(&off) / thickness.square())
}

/// The nearest place of a triangle in units of its thickness: its barycentric coordinates, and q there.
pub(super) fn triangle(vertices: [Vertex; 3]) -> ([Term; 3], Term) {
    let [a, b, c] = vertices;
    let (u, v) = (b.at - a.at, c.at - a.at);
    let normal = u.cross(v);
    let area = normal.length_squared();
    // Gradients of the barycentric coordinates of b and c in the plane.
    let (to_b, to_c) = (v.cross(normal) / area, normal.cross(u) / area);
    let slope = to_b * (b.thickness - a.thickness) + to_c * (c.thickness - a.thickness);
    let w = from(a.at);
    let height = dot(&w, normal / area.sqrt()).square();
    let foot = a.thickness + dot(&w, slope);
    // The smallest place in the plane is aside from the foot, along the slope of the thickness.
    let aside = &height / &foot;
    let at_b = dot(&w, to_b) + &aside * slope.dot(to_b);
    let at_c = dot(&w, to_c) + &aside * slope.dot(to_c);
    let at_a = 1.0 - &at_b - &at_c;
    let inside = positive(&at_a) * positive(&at_b) * positive(&at_c) * positive(&foot);
    let in_plane = &height / (foot.square() + &height * slope.length_squared());

    // The nearest of the edges: each begins at a vertex and ends at the next one.
    let edges =
        [[0, 1], [1, 2], [2, 0]].map(|[from, to]| (from, to, segment([vertices[from], vertices[to]])));
    let zero = || Term::from(0.0);
    let (mut nearest, mut places) = (None::<Term>, [zero(), zero(), zero()]);
    for (from, to, (parameter, q)) in edges {
        let mut here = [zero(), zero(), zero()];
        here[from] = 1.0 - &parameter;
        here[to] = parameter;
        (nearest, places) = match nearest {
            None => (Some(q), here),
            Some(so_far) => {
                let nearer = positive(&(&so_far - &q));
                (Some(so_far.min(q)), [0, 1, 2].map(|at| choose(&places[at], &here[at], &nearer)))
            }
        };
    }
    let on_edge = nearest.unwrap_or_else(zero);
    let all = [at_a, at_b, at_c].map(|place| place.clamp(0.0, 1.0));
    let places = [0, 1, 2].map(|at| choose(&places[at], &all[at], &inside));
    (places, choose(&on_edge, &in_plane, &inside))
}

/// The roots of `a t^2 - 2 b t + c` for a constant a above 0; both at the lowest point where there are none.
fn roots(a: f64, b: &Term, c: &Term) -> [Term; 2] {
    let half = (b.square() - c * a).max(0.0).sqrt();
    [(b - &half) / a, (b + half) / a]
}

/// The convolution along a segment: 1 at the distance of the thickness from a long one. `None` where the
/// thickness changes by half the length or more.
pub(super) fn line([a, b]: [Vertex; 2]) -> Option<Term> {
    let along = b.at - a.at;
    let change = b.thickness - a.thickness;
    let curvature = along.length_squared() - 4.0 * change * change;
    if curvature <= 1e-9 * along.length_squared() {
        return None;
    }
    let w = from(a.at);
    let (s, square_w) = (dot(&w, along), square(&w));
    let steep = &s + 4.0 * a.thickness * change;
    let rest = &square_w - 4.0 * a.thickness * a.thickness;
    let [low, high] = roots(curvature, &steep, &rest).map(|root| root.clamp(0.0, 1.0));
    let (middle, half) = ((&low + &high) * 0.5, (high - low) * 0.5);
    let nodes = gauss(if change == 0.0 { EVEN_NODES } else { LINE_NODES });
    let sum = nodes.into_iter().map(|(node, weight)| {
        let parameter = &middle + &half * node;
        let thickness = a.thickness + &parameter * change;
        let distance = &square_w + &parameter * (&parameter * along.length_squared() - &s * 2.0);
        (1.0 - distance / (thickness.square() * 4.0)).max(0.0).powf(3.0) / thickness * weight
    });
    let scale = along.length() / (4.0 * 0.75_f64.sqrt() * 0.5 * 0.6 * (9.0 / 14.0));
    Some(sum.reduce(|a, b| a + b)? * half * scale)
}

/// The convolution over a triangle: 1 at the distance of the thickness from a large one. `None` where the
/// thickness changes by half the length or more.
pub(super) fn surface(vertices: [Vertex; 3]) -> Option<Term> {
    // Lines are parallel to the edge along which the thickness changes least.
    let change = |from: usize| {
        let (a, b) = (vertices[from], vertices[(from + 1) % 3]);
        (b.thickness - a.thickness).abs() / a.at.distance(b.at)
    };
    let first = (0..3).min_by(|&a, &b| change(a).total_cmp(&change(b)))?;
    let [a, b, c] = [0, 1, 2].map(|next| vertices[(first + next) % 3]);
    let (u, v) = (b.at - a.at, c.at - a.at);
    let (du, dv) = (b.thickness - a.thickness, c.thickness - a.thickness);
    let (uu, uv, vv) = (u.length_squared(), u.dot(v), v.length_squared());
    let along = uu - 4.0 * du * du;
    let across = (vv - 4.0 * dv * dv) * along - (uv - 4.0 * du * dv).powi(2);
    if along <= 1e-9 * uu || across <= 1e-9 * uu * vv {
        return None;
    }
    let w = from(a.at);
    let (wu, wv, square_w) = (dot(&w, u), dot(&w, v), square(&w));
    let t = a.thickness;
    // Places are a + alpha u + beta v. Lines with a part within reach lie between two beta.
    let (steep_u, steep_v) = (&wu + 4.0 * t * du, &wv + 4.0 * t * dv);
    let rest = &square_w - 4.0 * t * t;
    let mixed = uv - 4.0 * du * dv;
    let [low, high] =
        roots(across, &(&steep_v * along - &steep_u * mixed), &(&rest * along - steep_u.square()))
            .map(|root| root.clamp(0.0, 1.0));
    let (middle, half) = ((&low + &high) * 0.5, (high - low) * 0.5);
    let nodes = gauss(ALONG);
    let lines = gauss(ACROSS).into_iter().map(|(node, weight)| {
        let beta = &middle + &half * node;
        let thickness = t + &beta * dv;
        let steep = &steep_u - &beta * mixed;
        let far = &rest + &beta * (&beta * (vv - 4.0 * dv * dv) - &steep_v * 2.0);
        let [low, high] = roots(along, &steep, &far).map(|root| root.max(0.0).min(1.0 - &beta));
        let (middle, half) = ((&low + &high) * 0.5, (high - low) * 0.5);
        let (linear, constant) = (&wu - &beta * uv, &square_w + &beta * (&beta * vv - &wv * 2.0));
        let sum = nodes.iter().map(|&(node, weight)| {
            let alpha = &middle + &half * node;
            let inverse = 1.0 / (&thickness + &alpha * du).square();
            let distance = &constant + &alpha * (&alpha * uu - &linear * 2.0);
            (1.0 - distance * &inverse * 0.25).max(0.0).powf(3.0) * inverse * weight
        });
        sum.reduce(|a, b| a + b).unwrap_or_else(|| 0.0.into()) * half * weight
    });
    let scale = u.cross(v).length() / (std::f64::consts::PI * 0.75_f64.powi(4));
    Some(lines.reduce(|a, b| a + b)? * half * scale)
}
