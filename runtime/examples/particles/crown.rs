//! What is liquid: a pool with ripples, a wall that opens like a crown, its jets with beads at their ends and
//! drops above them, and the column that rises in the middle.

use std::f64::consts::TAU;

/// The smallest corner of a box around all of it.
pub const LOW: [f64; 3] = [-1.5, -1.5, -0.12];
/// The largest corner.
pub const HIGH: [f64; 3] = [1.5, 1.5, 1.0];

/// How many jets the crown has.
const JETS: usize = 15;
/// How high the wall is between two jets and at a jet.
const WALL: [f64; 2] = [0.31, 0.49];
/// The height at which a jet leaves the wall.
const ROOT: f64 = 0.4;
/// The way of a jet: outwards and up, of length 1.
const WAY: [f64; 2] = [0.62, 0.784_601_809_837_321];
/// How far the pool reaches, and half its thickness, which rounds its rim.
const POOL: [f64; 2] = [1.45, 0.05];

/// Whether a place is in the liquid.
pub fn inside(place: [f64; 3]) -> bool {
    let [x, y, height] = place;
    let (across, angle) = (x.hypot(y), y.atan2(x));
    pool(across, height)
        || wall(across, angle, height)
        || column(across, height)
        || (0..JETS).any(|jet| jets(jet, place))
}

fn pool(across: f64, height: f64) -> bool {
    let from_crown = across - 0.62;
    let level = 0.035 * (8.0 * from_crown).cos() * (-2.4 * from_crown * from_crown).exp();
    let [end, half] = POOL;
    let beyond = (across - end + half).max(0.0);
    // Before the rim all between the bottom and the level, there a half circle.
    let rim = beyond == 0.0 || beyond.hypot(height + half) < half;
    rim && (-2.0 * half..level).contains(&height)
}

/// The radius of the wall's middle at a height: it opens.
fn opening(height: f64) -> f64 {
    0.6 + 0.5 * height.max(0.0).powf(1.7)
}

fn wall(across: f64, angle: f64, height: f64) -> bool {
    let wave = 0.5 + 0.5 * (JETS as f64 * angle).cos();
    let top = WALL[0] + (WALL[1] - WALL[0]) * wave;
    let foot = (1.0 - height / 0.25).clamp(0.0, 1.0);
    (-0.02..top).contains(&height) && (across - opening(height)).abs() < 0.03 + 0.05 * foot * foot
}

/// The column in the middle, a bead that leaves it and a drop above.
fn column(across: f64, height: f64) -> bool {
    let foot = (1.0 - height / 0.3).clamp(0.0, 1.0);
    let shaft = (0.0..0.42).contains(&height) && across < 0.05 + 0.16 * foot * foot;
    shaft || across.hypot(height - 0.44) < 0.075 || across.hypot(height - 0.85) < 0.11
}

/// A number from 0 to 1 for each jet, that is unlike those of its neighbours.
fn varied(jet: usize, kind: usize) -> f64 {
    ((jet + 1) as f64 * [0.618_034, 0.414_214, 0.732_051][kind]).fract()
}

fn jets(jet: usize, [x, y, height]: [f64; 3]) -> bool {
    let (sin, cos) = (TAU * jet as f64 / JETS as f64).sin_cos();
    // In the upright plane of the jet: how far out from its root, how far up, and how far beside that plane.
    let (out, up, beside) = (x * cos + y * sin - opening(ROOT), height - ROOT, y * cos - x * sin);
    let [size, long, drop] = [0, 1, 2].map(|kind| varied(jet, kind));
    let length = 0.1 + 0.14 * long;
    let distance =
        |along: f64, above: f64| (out - along * WAY[0]).hypot(up - along * WAY[1] - above).hypot(beside);
    let nearest = (out * WAY[0] + up * WAY[1]).clamp(0.0, length);
    distance(nearest, 0.0) < 0.045 - 0.012 * nearest / length
        || distance(length, 0.0) < 0.05 + 0.015 * size
        || drop > 0.3 && distance(length + 0.14 + 0.12 * drop, 0.02) < 0.032 + 0.022 * size
}
