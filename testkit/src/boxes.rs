//! Random boxes within others, and points of them.

use fastrand::Rng;

/// The low and the high corner.
pub type LowHigh = [[f32; 3]; 2];

/// A closed box within another one: ordinary, tiny, flat or a point.
pub fn random_box(rng: &mut Rng, [low, high]: LowHigh) -> LowHigh {
    let size = [1.0, 0.5, 0.1, 1e-3][rng.usize(0..4)];
    let mut inner = [low, high];
    for axis in 0..3 {
        let (low, high) = (low[axis], high[axis]);
        let length = (high - low) * size * rng.f32();
        let length = if rng.u8(0..20) == 0 { 0.0 } else { length };
        let at = low + (high - low - length) * rng.f32();
        inner[0][axis] = at.clamp(low, high);
        inner[1][axis] = (at + length).clamp(inner[0][axis], high);
    }
    inner
}

/// A point of a box, often on its sides.
pub fn point_in(rng: &mut Rng, [low, high]: LowHigh) -> [f32; 3] {
    std::array::from_fn(|axis| {
        let (low, high) = (low[axis], high[axis]);
        match rng.u8(0..8) {
            0 => low,
            1 => high,
            _ => (low + (high - low) * rng.f32()).clamp(low, high),
        }
    })
}
