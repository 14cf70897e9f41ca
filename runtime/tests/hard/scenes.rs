//! Random scenes that are hard to mesh: walls where the field jumps, places far from the origin, parts that
//! are thinner than a cell.

use fastrand::Rng;
use jbt_testkit::points::between;

use crate::planted::{Made, Planted, Thin, planted};

/// Cells along the longest side that a scene is made for.
pub const RESOLUTION: usize = 96;

/// Half of the longest side of the region of a scene.
pub const HALF: f64 = 1.4;

/// A scene as text, and what was built into it.
pub struct Scene {
    pub text: String,
    /// The middle of its region. Everything is within [`HALF`] of it along each axis.
    pub center: [f64; 3],
    /// Whether some of its surface is a wall.
    pub has_walls: bool,
    /// A part that is thinner than a cell, in a corner of the region; its place is from the middle of it.
    pub part: Option<Planted>,
}

/// How far from the middle of the region a planted part is along each axis.
const CORNER: f64 = 1.02;

/// A scene from a seed.
pub fn scene(seed: u64) -> Scene {
    let mut rng = Rng::with_seed(seed);
    let has_walls = rng.u8(0..3) > 0;
    let solid = if has_walls { walled(&mut rng) } else { smooth(&mut rng) };
    let center = if rng.u8(0..3) == 0 { far(&mut rng) } else { [0.0; 3] };
    let [x, y, z] = center;
    // From a seed of its own, so that the rest of a scene does not depend on it.
    let part = corner_part(&mut Rng::with_seed(!seed));
    let solid = part.iter().fold(solid, |solid, part| format!("union {{ {solid} {} }}", part.text));
    let text = format!("jbt 1\ntranslate ({x} {y} {z}) {{ {solid} }}\n");
    Scene { text, center, has_walls, part }
}

/// A part that is thinner than a cell, in every other scene.
fn corner_part(rng: &mut Rng) -> Option<Planted> {
    if rng.bool() {
        return None;
    }
    let kind = (Thin::ALL[rng.usize(0..Thin::ALL.len())], Made::ALL[rng.usize(0..Made::ALL.len())]);
    let center = [0; 3].map(|_| if rng.bool() { CORNER } else { -CORNER });
    Some(planted(rng, kind, center, 2.0 * HALF / RESOLUTION as f64))
}

fn vector(rng: &mut Rng, size: f64) -> String {
    let [x, y, z]: [f64; 3] = std::array::from_fn(|_| between(rng, -size, size));
    format!("({x} {y} {z})")
}

fn turned(rng: &mut Rng, inner: &str) -> String {
    let axis = vector(rng, 1.0);
    let degrees = between(rng, 0.0, 360.0);
    format!("rotate axis {axis} degrees {degrees} {{ {inner} }}")
}

/// A solid without walls, within 0.9 of the origin.
fn smooth(rng: &mut Rng) -> String {
    let leaf = match rng.u8(0..4) {
        0 => format!("point {{ surface_radius {} }}", between(rng, 0.4, 0.8)),
        1 => format!("segment {{ from (-0.4 0 0) to (0.4 0 0) surface_radius {} }}", between(rng, 0.28, 0.4)),
        2 => format!("ring {{ ring_radius 0.5 surface_radius {} }}", between(rng, 0.15, 0.3)),
        _ => {
            let points: Vec<String> = (0..4)
                .map(|_| {
                    format!("point {{ at {} surface_radius {} }}", vector(rng, 0.3), between(rng, 0.2, 0.35))
                })
                .collect();
            format!("blend ricci 2 {{ {} }}", points.join(" "))
        }
    };
    turned(rng, &leaf)
}

/// A solid whose surface is at least partly a wall, within 1.4 of the origin.
fn walled(rng: &mut Rng) -> String {
    let [x, y, z]: [f64; 3] = std::array::from_fn(|_| between(rng, 0.55, 0.8));
    let inner = match rng.u8(0..4) {
        // Near the iso-value everywhere.
        0 => "expression { 0.5 + x * y * z }".to_owned(),
        1 => "expression { 0.5 + 0.1 * (sin(3 * x) * cos(3 * y) + sin(3 * y) * cos(3 * z) + sin(3 * z) * cos(3 * x)) }"
            .to_owned(),
        2 => format!("expression {{ {} }}", between(rng, 0.6, 5.0)),
        _ => format!("point {{ at {} surface_radius {} }}", vector(rng, 0.2), between(rng, 0.8, 1.1)),
    };
    let walled = format!("within ({} {} {}) to ({x} {y} {z}) {{ {inner} }}", -x, -y, -z);
    if rng.bool() { turned(rng, &walled) } else { walled }
}

/// A place so far away that f32 has no digits left for the cells there.
fn far(rng: &mut Rng) -> [f64; 3] {
    std::array::from_fn(|_| (if rng.bool() { 1.0 } else { -1.0 }) * between(rng, 1e4, 1e6))
}
