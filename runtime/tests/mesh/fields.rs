//! Fields in closed form, for the mesher's tests. None of them shares code with the library.

use std::convert::Infallible;

use jbt::Box3;
use jbt::boxes::Divisible;
use jbt::mesh::{Field, FieldWork};

/// A field and its gradient at one point.
pub type Sample = (f32, [f32; 3]);

/// A field from a function of a point. It knows nothing of boxes. Its attributes are `color` (the point
/// itself) and `height` (z).
pub struct Closed<F>(pub F);

/// Says nothing about some boxes.
pub fn no_ranges(ranges: &mut [[f32; 2]]) {
    ranges.fill([f32::NEG_INFINITY, f32::INFINITY]);
}

impl<F: Fn([f32; 3]) -> Sample + Sync> Divisible for Closed<F> {
    type Error = Infallible;
    type Region = ();

    fn region(&self, _: Box3) -> Result<(), Infallible> {
        Ok(())
    }

    fn ranges(&self, (): &(), _: &[Box3], ranges: &mut [[f32; 2]]) -> Result<(), Infallible> {
        no_ranges(ranges);
        Ok(())
    }

    fn narrow(&self, (): &(), boxes: &[Box3], parts: &mut Vec<()>) -> Result<(), Infallible> {
        parts.extend(boxes.iter().map(|_| ()));
        Ok(())
    }
}

impl<F: Fn([f32; 3]) -> Sample + Sync> Field for Closed<F> {
    fn attributes(&self) -> Vec<(String, usize)> {
        vec![("color".to_owned(), 3), ("height".to_owned(), 1)]
    }

    fn work(&self, (): &()) -> FieldWork {
        FieldWork::default()
    }

    fn field(&self, (): &(), x: &[f32], y: &[f32], z: &[f32], field: &mut [f32]) -> Result<(), Infallible> {
        for (i, field) in field.iter_mut().enumerate() {
            *field = self.0([x[i], y[i], z[i]]).0;
        }
        Ok(())
    }

    fn gradient(
        &self,
        (): &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), Infallible> {
        for i in 0..x.len() {
            let (value, slope) = self.0([x[i], y[i], z[i]]);
            field[i] = value;
            for axis in 0..3 {
                gradient[axis][i] = slope[axis];
            }
        }
        Ok(())
    }

    fn all(
        &self,
        (): &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), Infallible> {
        attributes[0].copy_from_slice(x);
        attributes[1].copy_from_slice(y);
        attributes[2].copy_from_slice(z);
        attributes[3].copy_from_slice(z);
        self.gradient(&(), x, y, z, field, gradient)
    }
}

/// 0.5 on the sphere, falling with slope 1 along the radius.
pub fn sphere(center: [f32; 3], radius: f32) -> impl Fn([f32; 3]) -> Sample + Sync {
    move |p| {
        let d = [p[0] - center[0], p[1] - center[1], p[2] - center[2]];
        let length = d.iter().map(|c| c * c).sum::<f32>().sqrt();
        let slope = if length > 0.0 { d.map(|c| -c / length) } else { [0.0; 3] };
        (0.5 + radius - length, slope)
    }
}

/// (1 - d^2 / r^2)^3 within the support radius r, a Wyvill cubic around the origin. It is 0.5 at d = r
/// sqrt(1 - 0.5^(1/3)).
pub fn cubic(support: f32) -> impl Fn([f32; 3]) -> Sample + Sync {
    move |p| {
        let square = p.iter().map(|c| c * c).sum::<f32>() / (support * support);
        let u = (1.0 - square).max(0.0);
        (u * u * u, p.map(|c| -6.0 * u * u * c / (support * support)))
    }
}

/// 0.5 on a torus around the z axis.
pub fn torus(major: f32, minor: f32) -> impl Fn([f32; 3]) -> Sample + Sync {
    move |p| {
        let ring = p[0].hypot(p[1]);
        let (u, v) = (ring - major, p[2]);
        let length = u.hypot(v);
        let along = -u / (length * ring);
        (0.5 + minor - length, [along * p[0], along * p[1], -v / length])
    }
}

/// The larger of two fields.
pub fn union(
    a: impl Fn([f32; 3]) -> Sample + Sync,
    b: impl Fn([f32; 3]) -> Sample + Sync,
) -> impl Fn([f32; 3]) -> Sample + Sync {
    move |p| {
        let (a, b) = (a(p), b(p));
        if a.0 >= b.0 { a } else { b }
    }
}

/// 1 inside and 0 outside, decided anew at every point with integer coordinates; the gradient vanishes.
pub fn signs(inside: impl Fn([i64; 3]) -> bool + Sync) -> impl Fn([f32; 3]) -> Sample + Sync {
    move |p| (if inside(p.map(|c| c.round() as i64)) { 1.0 } else { 0.0 }, [0.0; 3])
}

/// A number that looks random, from a seed and a point (splitmix64).
pub fn hash(seed: u64, p: [i64; 3]) -> u64 {
    let mix = |mut h: u64| {
        h = (h ^ h >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ h >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        h ^ h >> 31
    };
    p.iter().fold(mix(seed ^ 0x9e37_79b9_7f4a_7c15), |h, &c| mix(h.wrapping_mul(31).wrapping_add(c as u64)))
}
