//! Numbers and points that hurt.

use fastrand::Rng;

/// Zeros of both signs, subnormals, huge numbers, infinities, NaN.
pub const SPICE: [f32; 12] =
    [0.0, -0.0, 1.0, -0.5, 1e-45, -1e-39, 1e30, -1e30, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];

/// Finite coordinates at which squares, cubes and products of lengths overflow or underflow.
pub const HOSTILE: [f32; 24] = [
    0.0,
    -0.0,
    1e-45,
    -1e-39,
    1e-20,
    0.25,
    -1.0,
    5.0,
    -1e4,
    1_048_576.0,
    1e9,
    -1e12,
    1e15,
    1e19,
    -1e19,
    2e19,
    -2e19,
    4e25,
    -1e30,
    1e30,
    2e38,
    -3e38,
    f32::MIN,
    f32::MAX,
];

/// Numbers at which ops decide, round, overflow or give NaN. Zeros and ones of both signs come first.
pub const OPERANDS: [f32; 29] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    -4.0,
    0.1,
    -3.7,
    -2.75,
    100.25,
    1e-45,
    -1e-45,
    1e-39,
    1.1e-38,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE * 0.5,
    f32::EPSILON,
    1.0 + f32::EPSILON,
    0.333_333_34,
    16_777_216.0,
    1e30,
    -1e30,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    std::f32::consts::PI,
];

/// A number from `low` to `high`.
pub fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}

/// Ordinary points within `size` of the origin, with spicy ones among them.
pub fn spicy(rng: &mut Rng, count: usize, size: f32) -> impl Iterator<Item = [f32; 3]> {
    (0..count).map(move |_| {
        let mut point = std::array::from_fn(|_| (2.0 * rng.f32() - 1.0) * size);
        if rng.u8(0..4) == 0 {
            for _ in 0..rng.usize(1..4) {
                point[rng.usize(0..3)] = SPICE[rng.usize(0..SPICE.len())];
            }
        }
        point
    })
}
