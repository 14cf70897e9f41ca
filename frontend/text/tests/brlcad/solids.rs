//! Every kind of solid against its inequality, at random points about it.

use glam::DVec3;
use jbt_model::walk::walk;
use jbt_text::Options;
use jbt_text::import::Imported;

use super::write::{combination, file, list, solid};
use super::{of, read};

/// A solid under test: its numbers, and the function that is at most 0 in it.
struct Case {
    bytes: Vec<u8>,
    about: DVec3,
    reach: f64,
    value: Box<dyn Fn(DVec3) -> f64>,
}

/// The largest of several bounds.
fn all(bounds: &[f64]) -> f64 {
    bounds.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn numbers(vectors: &[DVec3], rest: &[f64]) -> Vec<f64> {
    vectors.iter().flat_map(DVec3::to_array).chain(rest.iter().copied()).collect()
}

/// Two directions across a third.
fn turned() -> [DVec3; 3] {
    let z = DVec3::new(0.3, -0.5, 0.8).normalize();
    let (x, y) = z.any_orthonormal_pair();
    [x, y, z]
}

/// Above 0 and within 1 along a vector.
fn slab(q: DVec3, h: DVec3) -> (f64, f64) {
    let t = q.dot(h) / h.dot(h);
    (t, all(&[-t, t - 1.0]))
}

/// By the formulas of a small model, and by those of a large one.
fn check(name: &str, case: &Case) {
    let many = combination("many", &[], &vec![("gone", None); 300], &[]);
    check_scene(name, case, &read(&file([case.bytes.clone()]), &Options::default()));
    let top = if case.bytes.windows(2).any(|name| name == b"c\0") { "c" } else { "a" };
    check_scene(name, case, &read(&file([case.bytes.clone(), many]), &of(top)));
}

fn check_scene(name: &str, case: &Case, scene: &Imported) {
    assert_eq!(scene.warnings.to_string(), "", "{name}");
    let tree = scene.model.check().unwrap_or_else(|errors| panic!("{name}: {errors}"));
    let mut random = fastrand::Rng::with_seed(7);
    let mut sides = [0, 0];
    for _ in 0..20_000 {
        let offset = DVec3::from_array([0; 3].map(|_: i32| random.f64() * 2.0 - 1.0)) * case.reach;
        let p = case.about + offset;
        let value = (case.value)(p);
        // Nearer to the surface, rounding decides.
        if value.abs() < 1e-9 {
            continue;
        }
        let found = walk(&tree, p.to_array()).field;
        assert_eq!(found >= 0.5, value <= 0.0, "{name} at {p}: field {found}, value {value}");
        sides[usize::from(value <= 0.0)] += 1;
    }
    assert!(sides.iter().all(|&count| count > 100), "{name}: {sides:?}");
}

fn case(bytes: Vec<u8>, about: DVec3, reach: f64, value: impl Fn(DVec3) -> f64 + 'static) -> Case {
    Case { bytes, about, reach, value: Box::new(value) }
}

#[test]
fn round_solids() {
    let ([x, y, z], v) = (turned(), DVec3::new(1.0, 2.0, -3.0));
    let axes = [x * 2.0, y * 1.0, z * 0.5];
    check(
        "ell",
        &case(solid("a", 3, &numbers(&[v, axes[0], axes[1], axes[2]], &[])), v, 2.0, move |p| {
            axes.iter().map(|a| ((p - v).dot(*a) / a.dot(*a)).powi(2)).sum::<f64>() - 1.0
        }),
    );
    for [n, e] in [[0.4, 1.3], [2.5, 0.7], [1.0, 3.0]] {
        check(
            "superell",
            &case(solid("a", 35, &numbers(&[v, axes[0], axes[1], axes[2]], &[n, e])), v, 1.5, move |p| {
                let [a, b, c] = axes.map(|a| ((p - v).dot(a) / a.dot(a)).abs());
                (a.powf(2.0 / e) + b.powf(2.0 / e)).powf(e / n) + c.powf(2.0 / n) - 1.0
            }),
        );
    }
    for [r_a, r_h] in [[2.0, 0.5], [1.0, 1.5]] {
        check(
            "tor",
            &case(solid("a", 1, &numbers(&[v, z], &[r_a, r_h])), v, 2.5, move |p| {
                let h = (p - v).dot(z);
                let rho = ((p - v).length_squared() - h * h).max(0.0).sqrt();
                (rho - r_a).powi(2) + h * h - r_h * r_h
            }),
        );
    }
    let c = z * 0.8 + x * 0.4;
    check(
        "eto",
        &case(solid("a", 21, &numbers(&[v, z * 3.0, c], &[1.5, 0.3])), v, 2.5, move |p| {
            let h = (p - v).dot(z);
            let rho = ((p - v).length_squared() - h * h).max(0.0).sqrt() - 1.5;
            let ev = c.normalize().dot(z);
            let eu = (1.0 - ev * ev).sqrt();
            ((eu * rho + ev * h) / c.length()).powi(2) + ((eu * h - ev * rho) / 0.3).powi(2) - 1.0
        }),
    );
    for [r_v, r_h] in [[0.9, 0.3], [0.2, 0.8], [0.5, 0.5], [2.5, 0.1], [0.6, 0.0]] {
        let h = z * 2.0;
        check(
            "part",
            &case(solid("a", 16, &numbers(&[v, h], &[r_v, r_h])), v + h * 0.5, 2.2, move |p| {
                // The nearest of very many balls.
                let ball = |t: f64| (p - v - h * t).length() - (r_v + (r_h - r_v) * t);
                let (mut from, mut to) = (0.0, 1.0);
                for _ in 0..200 {
                    let (a, b) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
                    if ball(a) < ball(b) { to = b } else { from = a }
                }
                ball(from)
            }),
        );
    }
}

#[test]
fn cones() {
    let ([x, y, z], v) = (turned(), DVec3::new(1.0, 2.0, -3.0));
    // Right and oblique, round and elliptical, tips at either end, an edge.
    let lean = z * 2.0 + x * 0.7 - y * 0.3;
    for (h, [a, b, c, d]) in [
        (z * 2.0, [1.0, 1.0, 1.0, 1.0]),
        (z * 2.0, [1.0, 1.0, 0.5, 0.5]),
        (lean, [1.0, 0.5, 0.5, 0.25]),
        (lean, [1.0, 0.6, 0.3, 0.9]),
        (lean, [1.0, 0.6, 0.0, 0.0]),
        (z * 2.0, [0.0, 0.0, 0.7, 0.7]),
        (lean, [0.8, 0.6, 0.8, 0.0]),
    ] {
        let all_vectors = [v, h, x * a, y * b, x * c, y * d];
        check(
            "tgc",
            &case(solid("a", 2, &numbers(&all_vectors, &[])), v + h * 0.5, 1.5, move |p| {
                let q = p - v;
                let n = x.cross(y);
                let t = n.dot(q) / n.dot(h);
                let w = q - h * t;
                let wide = |from: f64, to: f64| from + (to - from) * t;
                let side = (w.dot(x) / wide(a, c)).powi(2) + (w.dot(y) / wide(b, d)).powi(2) - 1.0;
                all(&[-t, t - 1.0, if (0.0..=1.0).contains(&t) { side } else { 0.0 }])
            }),
        );
    }
}

#[test]
fn quadrics() {
    let ([x, y, z], v) = (turned(), DVec3::new(1.0, 2.0, -3.0));
    let h = z * 2.0;
    let across = move |q: DVec3| [q.dot(x), q.dot(y)];
    let bowl = move |p: DVec3| {
        let [a, b] = across(p - v);
        ((a / 1.2).powi(2) + (b / 0.7).powi(2), slab(p - v, h))
    };
    check(
        "epa",
        &case(solid("a", 19, &numbers(&[v, h, x], &[1.2, 0.7])), v + h * 0.5, 1.5, move |p| {
            let (e, (t, ends)) = bowl(p);
            all(&[ends, e - 1.0 + t])
        }),
    );
    for c in [0.0, 0.5, 3.0] {
        check(
            "ehy",
            &case(solid("a", 20, &numbers(&[v, h, x], &[1.2, 0.7, c])), v + h * 0.5, 1.5, move |p| {
                let (e, (t, ends)) = bowl(p);
                let c = c / 2.0;
                all(&[ends, (1.0 + 2.0 * c) * e + c * c - (1.0 + c - t).powi(2)])
            }),
        );
        let b = y * 0.8;
        let bow = move |p: DVec3| {
            let (t, base) = slab(p - v, b);
            let (_, ends) = slab(p - v, h);
            (((p - v).dot(h.cross(b).normalize()) / 0.9).powi(2), t, all(&[base, ends]))
        };
        check(
            "rpc",
            &case(solid("a", 17, &numbers(&[v, h, b], &[0.9])), v + h * 0.5, 1.3, move |p| {
                let (e, t, ends) = bow(p);
                all(&[ends, e - 1.0 + t])
            }),
        );
        check(
            "rhc",
            &case(solid("a", 18, &numbers(&[v, h, b], &[0.9, c])), v + h * 0.5, 1.3, move |p| {
                let (e, t, ends) = bow(p);
                let c = c / 0.8;
                all(&[ends, (1.0 + 2.0 * c) * e + c * c - (1.0 + c - t).powi(2)])
            }),
        );
    }
    check(
        "hyp",
        &case(solid("a", 38, &numbers(&[v, h, x * 1.2], &[0.8, 0.6, 0.0])), v + h * 0.5, 1.5, move |p| {
            let q = p - v - h * 0.5;
            let [a, b] = across(q);
            let (r1, r2, far) = (0.6 * 1.2, 0.6 * 0.8, q.dot(z));
            let c = (4.0 * 1.44 / 4.0 * (1.0 - 0.36f64)).sqrt();
            all(&[far.abs() - 1.0, (a / r1).powi(2) + (b / r2).powi(2) - (c * far / r1).powi(2) - 1.0])
        }),
    );
}

#[test]
fn solids_between_planes() {
    let ([x, y, z], v) = (turned(), DVec3::new(1.0, 2.0, -3.0));
    let corner = |a: f64, b: f64, c: f64| v + x * a + y * b + z * c;
    let (p, q, r, s) =
        (corner(0.0, 0.0, 0.0), corner(2.0, 0.0, 0.0), corner(2.0, 1.5, 0.0), corner(0.0, 1.5, 0.0));
    let (tip, ridge) = (corner(1.0, 0.5, 1.5), corner(1.0, 1.2, 1.5));
    let lifted = [p, q, r, s].map(|p| p + z * 1.2 + x * 0.3);
    let narrow = |at: usize| lifted[at] + (corner(1.2, 0.7, 1.2) - lifted[at]) * 0.4;
    let blocks = [
        [p, q, r, s, lifted[0], lifted[1], lifted[2], lifted[3]],
        [p, q, r, s, narrow(0), narrow(1), narrow(2), narrow(3)],
        [p, q, r, s, tip, tip, tip, tip],
        [p, q, r, r, tip, tip, tip, tip],
        [
            p,
            q,
            r,
            s,
            corner(1.0, 0.0, 1.5),
            corner(1.0, 0.0, 1.5),
            corner(1.0, 1.5, 1.5),
            corner(1.0, 1.5, 1.5),
        ],
    ];
    let _ = ridge;
    for points in blocks {
        check(
            "arb",
            &case(solid("a", 4, &numbers(&points, &[])), corner(1.0, 0.7, 0.7), 1.4, move |p| {
                hull(&points, p)
            }),
        );
    }
    check(
        "half and arb",
        &case(
            [
                solid("h", 6, &numbers(&[z * 2.0], &[2.0 * z.dot(v) + 0.5])),
                solid("b", 3, &numbers(&[v, x, y, z], &[])),
                combination("c", &[], &[("b", None), ("h", None)], &[1, 1, 3]),
            ]
            .concat(),
            v,
            1.2,
            move |p| all(&[(p - v).length() - 1.0, z.dot(p - v) - 0.25]),
        ),
    );
    // An octahedron, by its planes.
    let mut planes = Vec::new();
    for corner in 0..8 {
        let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let n = x * sign(0) + y * sign(1) + z * sign(2);
        planes.extend([n.x, n.y, n.z, n.dot(v) + 1.5]);
    }
    check(
        "arbn",
        &case(list("a", 14, &[8], &planes), v, 1.3, move |p| {
            [x, y, z].iter().map(|axis| axis.dot(p - v).abs()).sum::<f64>() - 1.5
        }),
    );
}

/// Above 0 outside of the hull of points: by all planes through three of them that have all on one side.
fn hull(points: &[DVec3], p: DVec3) -> f64 {
    let mut value = f64::NEG_INFINITY;
    for a in 0..points.len() {
        for b in 0..points.len() {
            for c in 0..points.len() {
                let n = (points[b] - points[a]).cross(points[c] - points[a]);
                if n.length() < 1e-9 {
                    continue;
                }
                let n = n.normalize();
                if points.iter().all(|q| n.dot(*q - points[a]) < 1e-9) {
                    value = value.max(n.dot(p - points[a]));
                }
            }
        }
    }
    value
}

#[test]
fn metaballs() {
    let points = [[0.0, 0.0, 0.0, 1.0, 1.5], [1.5, 0.3, 0.0, 0.8, 2.0], [0.5, 1.5, 0.2, -0.5, 1.0]];
    for (method, threshold) in [(1, 1.0), (2, 1.0), (1, 3.0), (2, 0.4)] {
        let body: Vec<f64> = [threshold].into_iter().chain(points.into_iter().flatten()).collect();
        check(
            "metaball",
            &case(list("a", 36, &[3, method], &body), DVec3::new(0.7, 0.5, 0.0), 2.2, move |p| {
                let term = |&[x, y, z, f, b]: &[f64; 5]| {
                    let square = p.distance_squared(DVec3::new(x, y, z));
                    if method == 1 { f * f.abs() / square } else { (b - b * square / (f * f)).exp() }
                };
                threshold - points.iter().map(term).sum::<f64>()
            }),
        );
    }
}

#[test]
fn pipes() {
    // Straight on with another width, a bend, and a hole that ends.
    let points: [[f64; 6]; 5] = [
        [0.0, 0.0, 0.0, 0.4, 1.0, 0.0],
        [2.0, 0.0, 0.0, 0.4, 1.0, 0.0],
        [4.0, 0.0, 0.0, 0.2, 0.8, 1.2],
        [4.0, 4.0, 0.0, 0.2, 0.8, 0.0],
        [7.0, 4.0, 1.0, 0.0, 0.8, 0.0],
    ];
    let body: Vec<f64> = points.into_iter().flatten().collect();
    let within = move |p: DVec3, column: usize| -> f64 {
        let at = |i: usize| DVec3::from_slice(&points[i][..3]);
        let r = |i: usize| points[i][column] / 2.0;
        let straight = |from: DVec3, to: DVec3, a: f64, b: f64| {
            let (t, ends) = slab(p - from, to - from);
            let beside = (p - from - (to - from) * t).length();
            all(&[ends * (to - from).length(), beside - (a + (b - a) * t)])
        };
        let bend = 1.2;
        let (first, second) = (at(2) - DVec3::X * bend, at(2) + DVec3::Y * bend);
        let center = DVec3::new(4.0 - bend, bend, 0.0);
        let q = p - center;
        let tube = (q.truncate().length() - bend).hypot(q.z) - r(2);
        let arc = all(&[tube, -q.x, q.y]);
        [
            straight(at(0), at(1), r(0), r(1)),
            straight(at(1), first, r(1), r(2)),
            arc,
            straight(second, at(3), r(2), r(3)),
            straight(at(3), at(4), r(3), r(4)),
        ]
        .into_iter()
        .fold(f64::INFINITY, f64::min)
    };
    check(
        "pipe",
        &case(list("a", 15, &[5], &body), DVec3::new(3.5, 2.0, 0.5), 4.0, move |p| {
            let (outer, inner) = (within(p, 4), within(p, 3));
            if inner.abs() < 1e-9 { 0.0 } else { all(&[outer, -inner]) }
        }),
    );
}
