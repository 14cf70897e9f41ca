//! Thin parts in pictures of the default size: sheets, rods and specks, against closed forms of what the
//! central rays of pixels meet.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

use jbt::render::{Render, RenderMode, Stance, View};
use jbt::{CheckedTree, Compiler};
use jbt_testkit::scene::tree;
use jbt_testkit::vector::{Vector3, dot};

/// What a picture shows.
#[derive(Default, Debug)]
struct Seen {
    /// Pixels whose central ray is inside for longer than nothing, and those of them that show something.
    met: u64,
    shown: u64,
    /// Pixels that show nothing though their ray is inside for longer than the tolerance.
    lost: u64,
    /// Pixels that show something and whose ray meets nothing.
    wrong: u64,
    tolerance: f64,
}

/// A picture without perspective, of the default size and quality, from the direction of `eye`: what the rays
/// through the middles of pixels meet, and what is shown. `chord` is how long a ray, from a point into a unit
/// direction, is inside.
fn look(model: &CheckedTree, eye: Vector3, chord: impl Fn(Vector3, Vector3) -> f64) -> Seen {
    let stance = Stance::At { eye, target: [0.0; 3] };
    let lens = 2.0 * (1.2 / dot(eye, eye).sqrt()).atan().to_degrees();
    let view = View { stance, lens, orthographic: true, ..View::default() };
    let render = Render { mode: RenderMode::Depth, view, antialias: 1, ..Render::default() };
    let made = render.picture(&Compiler::new(), model).run().expect("the model is seen");
    let camera = made.report.camera.expect("there is a model");
    let mut seen = Seen { tolerance: made.report.tolerance, ..Seen::default() };
    let [width, height] = render.size;
    for y in 0..height {
        for x in 0..width {
            let at = |pixel: u32, of: u32| 2.0 * (f64::from(pixel) + 0.5) / f64::from(of) - 1.0;
            let [across, up] = [camera.half[0] * at(x, width), -camera.half[1] * at(y, height)];
            let origin =
                [0, 1, 2].map(|axis| camera.eye[axis] + across * camera.right[axis] + up * camera.up[axis]);
            let long = chord(origin, camera.back.map(|x| -x));
            let shown = made.picture.pixel(x, y)[3] > 0;
            // f32 does not know what is shorter.
            let meets = long > 1e-5;
            seen.met += u64::from(meets);
            seen.shown += u64::from(meets && shown);
            seen.lost += u64::from(!shown && long > seen.tolerance + 1e-5);
            seen.wrong += u64::from(shown && long < 0.0);
        }
    }
    println!("{seen:?}");
    assert_eq!((seen.wrong, seen.lost), (0, 0), "{seen:?}");
    seen
}

/// How long a ray is in a box about the origin.
fn in_box(half: Vector3, origin: Vector3, direction: Vector3) -> f64 {
    let mut span = [f64::NEG_INFINITY, f64::INFINITY];
    for axis in 0..3 {
        let ends = [-half[axis], half[axis]].map(|side| (side - origin[axis]) / direction[axis]);
        if direction[axis] == 0.0 {
            if origin[axis].abs() > half[axis] {
                return -1.0;
            }
            continue;
        }
        span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
    }
    span[1] - span[0]
}

/// How long a ray is in a ball.
fn in_ball(center: Vector3, radius: f64, origin: Vector3, direction: Vector3) -> f64 {
    let to = [0, 1, 2].map(|axis| center[axis] - origin[axis]);
    let along = dot(to, direction);
    let square = radius * radius - (dot(to, to) - along * along);
    if square < 0.0 { -1.0 } else { 2.0 * square.sqrt() }
}

/// How long a ray is in a round rod along the z axis, of so much length on each side, without its round ends.
fn in_rod(radius: f64, half: f64, origin: Vector3, direction: Vector3) -> f64 {
    let [a, b, c] = [
        direction[0].powi(2) + direction[1].powi(2),
        direction[0] * origin[0] + direction[1] * origin[1],
        origin[0].powi(2) + origin[1].powi(2) - radius * radius,
    ];
    let square = b * b - a * c;
    if square < 0.0 {
        return -1.0;
    }
    let ends = [-1.0, 1.0].map(|sign| (-b + sign * square.sqrt()) / a);
    let within = ends.iter().all(|t| (origin[2] + t * direction[2]).abs() < half);
    if within { ends[1] - ends[0] } else { 0.0 }
}

/// From straight on to nearly along a sheet across z.
const EYES: [Vector3; 4] = [[0.0, 0.01, 4.0], [1.0, 2.0, 3.0], [-3.0, 1.0, 1.0], [0.5, -4.0, 0.1]];

#[test]
fn a_sheet_of_half_a_pixel_loses_no_pixel() {
    let half = [0.8, 0.7, 0.001];
    // The soft falloff is 1/2 at half of the radius.
    let sheets = [
        "expression within (-0.8 -0.7 -1) to (0.8 0.7 1) { 0.501 - abs(z) }",
        "expression within (-0.8 -0.7 -0.001) to (0.8 0.7 0.001) { 0.75 }",
        "within (-0.8 -0.7 -1) to (0.8 0.7 1) { intersection {
            half_space { at (0 0 -0.499) normal (0 0 1) radius 1 }
            half_space { at (0 0 0.499) normal (0 0 -1) radius 1 } } }",
        "within (-0.8 -0.7 -1) to (0.8 0.7 1) { rectangle { half_length 2 half_width 2 radius 0.002 } }",
    ];
    for sheet in sheets {
        let model = tree(&format!("jbt 1 {sheet}"));
        for eye in EYES {
            let seen = look(&model, eye, |origin, direction| in_box(half, origin, direction));
            assert!(seen.met > 2000, "{sheet} from {eye:?}: {seen:?}");
            // At the rim a ray may cut a corner off.
            assert!(seen.met - seen.shown <= seen.met / 1000, "{sheet} from {eye:?}: {seen:?}");
        }
    }
}

#[test]
fn rods_and_specks_of_a_pixel_are_seen() {
    let feet: Vec<[f64; 2]> = (-5..=5)
        .map(|index| {
            let at = f64::from(index);
            [0.13 * at + 0.001 * at * at, 0.017 * at * at]
        })
        .collect();
    let forms: [&dyn Fn(f64, f64) -> String; 2] = [
        &|x, y| format!("segment {{ from ({x} {y} -0.9) to ({x} {y} 0.9) surface_radius 0.002 }}"),
        &|x, y| {
            format!(
                "expression within (-1 -1 -0.9) to (1 1 0.9) {{ 0.502 - sqrt((x - {x})^2 + (y - {y})^2) }}"
            )
        },
    ];
    for form in forms {
        let rods: String = feet.iter().map(|&[x, y]| form(x, y)).collect();
        let model = tree(&format!("jbt 1 union {{ {rods} }}"));
        for eye in [[0.3, -4.0, 0.2], [2.0, -3.0, 2.0]] {
            let seen = look(&model, eye, |origin, direction| {
                let chord = |&[x, y]: &[f64; 2]| {
                    in_rod(0.002, 0.89, [origin[0] - x, origin[1] - y, origin[2]], direction)
                };
                feet.iter().map(chord).fold(-1.0, f64::max)
            });
            assert!(seen.met > 3000 && 100 * seen.shown >= 99 * seen.met, "from {eye:?}: {seen:?}");
        }
    }
    // Specks of two pixels on a spiral, nowhere in front of each other.
    let places: Vec<Vector3> = (1..1500)
        .map(|index| {
            let (turn, far) = (2.399_963 * f64::from(index), (f64::from(index) / 1500.0).sqrt());
            [far * turn.cos(), far * turn.sin(), 0.3 * (far * 9.0).sin()]
        })
        .collect();
    let specks: String = places
        .iter()
        .map(|[x, y, z]| format!("point {{ at ({x} {y} {z}) surface_radius 0.004 }} "))
        .collect();
    let model = tree(&format!("jbt 1 union {{ {specks} }}"));
    let seen = look(&model, [0.01, 0.02, 4.0], |origin, direction| {
        let chords = places.iter().map(|&place| in_ball(place, 0.004, origin, direction));
        chords.fold(-1.0, f64::max)
    });
    assert!(seen.met > 1000 && 100 * seen.shown >= 99 * seen.met, "{seen:?}");
}
