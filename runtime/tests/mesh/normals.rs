//! Normals point to where the triangles around their vertices point.

use jbt::Polygonized;
use jbt_testkit::scene::examples;
use jbt_testkit::skip::short_or_long;
use jbt_testkit::surface::{area_vector, corners};
use jbt_testkit::vector::dot;

use crate::models::mesh;

/// Checks that no normal is more than 90 degrees off the mean normal of its vertex's triangles, weighted by
/// area. Needles are excepted, which are counted: vertices between two surfaces that are closer than a cell,
/// or at an edge that they belong to by a sliver of a triangle. Such a normal is right for one of its
/// triangles, and others outweigh that.
fn needles(name: &str, made: &Polygonized) -> usize {
    let mesh = &made.mesh;
    let mut sums = vec![[0.0; 3]; mesh.positions.len()];
    let mut agrees = vec![false; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        let area = area_vector(corners(&mesh.positions, triangle));
        for vertex in triangle.map(|vertex| vertex as usize) {
            sums[vertex].iter_mut().zip(area).for_each(|(sum, area)| *sum += area);
            agrees[vertex] |= dot(mesh.normals[vertex].map(f64::from), area) > 0.0;
        }
    }
    let is_off = |&vertex: &usize| dot(mesh.normals[vertex].map(f64::from), sums[vertex]) < 0.0;
    let off: Vec<usize> = (0..sums.len()).filter(is_off).collect();
    for &vertex in &off {
        assert!(
            agrees[vertex],
            "{name}: the normal at {:?} is against all triangles",
            mesh.positions[vertex]
        );
    }
    off.len()
}

#[test]
fn normals_of_the_examples_point_outward() {
    for (name, text) in examples() {
        let made = mesh(&text, 64);
        let needles = needles(&name, &made);
        assert!(needles <= 1 + made.mesh.positions.len() / 1000, "{name}: {needles} needles");
    }
}

/// A random scene with walls: boxes and balls that end with a jump, whatever is inside of them, turned, moved
/// and combined.
fn scene(random: &mut fastrand::Rng) -> String {
    let number = |random: &mut fastrand::Rng, low: f64, high: f64| low + (high - low) * random.f64();
    let inner = |random: &mut fastrand::Rng| {
        let (a, b, c) = (number(random, 0.2, 1.0), number(random, 2.0, 7.0), number(random, -0.6, 0.6));
        match random.usize(0..5) {
            0 => format!("0.5 + {a:.3} * x * y * z"),
            1 => format!("0.7 + {a:.3} * sin({b:.3} * x) * cos({b:.3} * y + z)"),
            2 => format!("1 + {c:.3} * x - {a:.3} * y"),
            3 => format!("0.5 + {a:.3} * x + {c:.3} * z"),
            _ => format!(
                "0.6 + sin({b:.3} * x) * cos({b:.3} * y) + sin({b:.3} * y) * cos({b:.3} * z) + sin({b:.3} * z) * cos({b:.3} * x)"
            ),
        }
    };
    let part = |random: &mut fastrand::Rng| {
        let [x, y, z] = [0; 3].map(|_| number(random, 0.3, 1.0));
        let bounds = format!("within ({:.3} {:.3} {:.3}) to ({x:.3} {y:.3} {z:.3})", -x, -y, -z);
        let inner = inner(random);
        let piece = match random.usize(0..4) {
            0 | 1 => format!("{bounds} {{ expression {{ {inner} }} }}"),
            2 => format!(
                "{bounds} {{ expression {{ step(length(x, y, z), {:.3}) * ({inner}) }} }}",
                number(random, 0.4, 0.9)
            ),
            _ => format!(
                "{bounds} {{ expression {{ step(x + {:.3} * y, 0.2) * ({inner}) }} }}",
                number(random, -1.0, 1.0)
            ),
        };
        let axis = ["x", "y", "z"][random.usize(0..3)];
        let (degrees, shift) = (number(random, 0.0, 90.0), [0; 3].map(|_| number(random, -0.5, 0.5)));
        format!(
            "translate ({:.3} {:.3} {:.3}) {{ rotate axis {axis} degrees {degrees:.2} {{ {piece} }} }}",
            shift[0], shift[1], shift[2]
        )
    };
    let ball = format!(
        "point {{ at (0.3 0.2 {:.3}) surface_radius {:.3} }}",
        number(random, -0.4, 0.4),
        number(random, 0.3, 0.7)
    );
    let (a, b) = (part(random), part(random));
    match random.usize(0..5) {
        0 | 1 => a,
        2 => format!("union {{ {a} {b} }}"),
        3 => format!("difference {{ {a} {ball} }}"),
        _ => format!("union {{ {a} {ball} }}"),
    }
}

#[test]
fn normals_of_random_walls_point_outward() {
    let mut random = fastrand::Rng::with_seed(20);
    let (mut jumps, mut all) = (0, 0);
    let scenes = short_or_long([80, 200]);
    for number in 0..scenes {
        let text = scene(&mut random);
        let made = mesh(&text, random.usize(18..40));
        jumps += made.report.jump_vertices;
        all += made.mesh.positions.len();
        let needles = needles(&format!("scene {number}: {text}"), &made);
        assert!(needles <= 1 + made.mesh.positions.len() / 1000, "scene {number}: {needles} needles: {text}");
    }
    assert!(jumps > 500 * scenes, "{jumps} of {all}");
}
