//! All blobs at all points, without culling: the inner loops.
//!
//! The falloff `u^2 (5 + 4 u) / 9` of `u = max(1 - s, 0)` is written in `v = (4/9)^(1/3) u`, which makes it
//! `v^2 (v + b)`: a plain addition where the polynomial in `u` takes a fused one. For the field that leaves,
//! per blob and register of points,
//!
//! ```text
//!     dx = cx - x   dy = cy - y   dz = cz - z                   3 subtractions
//!     q  = dx dx + dy dy + dz dz                                1 product, 2 fused
//!     v  = max(a - k q, 0)          a = (4/9)^(1/3), k = a/R^2  1 fused, 1 maximum
//!     F += v^2 (v + b)              b = (5/9) / a^2             1 product, 1 addition, 1 fused
//! ```
//!
//! eleven instructions, of which six multiply. CPUs that add and multiply on different ports (AMD's since
//! Zen) are limited by the six. Scaling the offsets by 1/R in fused instructions takes one instruction less
//! and three multiplications more. `a - k q` expanded into a polynomial of the point takes three instructions
//! less and cancels: its error grows with `|p|^2 / R^2`.

use super::vector::{Job, Vector};

/// `(4/9)^(1/3)`, so that the cube of `v` stands in the falloff with factor 1.
const A: f64 = 0.763_142_828_368_887_9;
/// `(5/9) / A^2`
const B: f64 = 0.953_928_535_461_109_7;

/// What the loops know of a blob.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) center: [f32; 3],
    /// `A / R^2`
    pub(super) curvature: f32,
    pub(super) color: [f32; 3],
}

impl Row {
    pub(super) fn new(blob: &crate::model::Blob) -> Self {
        let curvature = (A / f64::from(blob.radius).powi(2)) as f32;
        Self { center: blob.center, curvature, color: blob.color }
    }
}

/// Constants of the loops, in registers.
#[derive(Clone, Copy)]
pub(super) struct Constants<V> {
    zero: V,
    a: V,
    b: V,
    /// `(2/3) b`: the derivative of the falloff is `3 v (v + (2/3) b)`.
    slope: V,
}

impl<V: Vector> Constants<V> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            zero: V::splat(0.0),
            a: V::splat(A as f32),
            b: V::splat(B as f32),
            slope: V::splat((2.0 / 3.0 * B) as f32),
        }
    }

    /// From the blob's centre less the point, in one register for each axis, to `v`.
    #[inline(always)]
    fn depth(&self, [dx, dy, dz]: [V; 3], curvature: V) -> V {
        let q = dz.mul_add(dz, dy.mul_add(dy, dx.mul(dx)));
        q.mul_sub_from(curvature, self.a).max(self.zero)
    }

    /// The part of `v`, before the maximum, that is shared by points with the same x and y.
    #[inline(always)]
    pub(super) fn column(&self, dx: V, dy: V, curvature: V) -> V {
        dy.mul_add(dy, dx.mul(dx)).mul_sub_from(curvature, self.a)
    }

    /// What has to be taken from [`Constants::column`].
    #[inline(always)]
    pub(super) fn height(dz: V, curvature: V) -> V {
        dz.mul(dz).mul(curvature)
    }

    /// A sum of fields, and another one.
    #[inline(always)]
    pub(super) fn add_field(&self, v: V, sum: V) -> V {
        v.mul(v).mul_add(v.add(self.b), sum)
    }
}

/// From the points to the centre of a blob.
#[inline(always)]
fn offsets<V: Vector>(row: &Row, point: [V; 3]) -> [V; 3] {
    let [x, y, z] = row.center;
    [V::splat(x).sub(point[0]), V::splat(y).sub(point[1]), V::splat(z).sub(point[2])]
}

/// The field at several registers of points; `rows` are the broadcast once for all of them.
#[inline(always)]
pub(super) fn field_at<'a, V: Vector, const N: usize>(
    rows: impl Iterator<Item = &'a Row>,
    points: [[V; 3]; N],
) -> [V; N] {
    let constants = Constants::<V>::new();
    let mut sums = [constants.zero; N];
    for row in rows {
        let curvature = V::splat(row.curvature);
        for n in 0..N {
            let v = constants.depth(offsets(row, points[n]), curvature);
            sums[n] = constants.add_field(v, sums[n]);
        }
    }
    sums
}

/// Field and gradient at a register of points.
#[inline(always)]
pub(super) fn gradient_at<'a, V: Vector>(rows: impl Iterator<Item = &'a Row>, point: [V; 3]) -> [V; 4] {
    let constants = Constants::<V>::new();
    let [mut field, mut gx, mut gy, mut gz] = [constants.zero; 4];
    for row in rows {
        let (curvature, offset) = (V::splat(row.curvature), offsets(row, point));
        let v = constants.depth(offset, curvature);
        field = constants.add_field(v, field);
        let weight = v.mul(curvature).mul(v.add(constants.slope));
        gx = weight.mul_add(offset[0], gx);
        gy = weight.mul_add(offset[1], gy);
        gz = weight.mul_add(offset[2], gz);
    }
    // df/dp = 3 v (v + slope) * 2 curvature (c - p)
    let six = V::splat(6.0);
    [field, gx.mul(six), gy.mul(six), gz.mul(six)]
}

/// Field, gradient and colour at a register of points.
#[inline(always)]
pub(super) fn full_at<'a, V: Vector>(rows: impl Iterator<Item = &'a Row>, point: [V; 3]) -> [V; 7] {
    let constants = Constants::<V>::new();
    let mut field = constants.zero;
    let (mut gradient, mut color) = ([constants.zero; 3], [constants.zero; 3]);
    for row in rows {
        let (curvature, offset) = (V::splat(row.curvature), offsets(row, point));
        let v = constants.depth(offset, curvature);
        let blob = v.mul(v).mul(v.add(constants.b));
        field = field.add(blob);
        let weight = v.mul(curvature).mul(v.add(constants.slope));
        for axis in 0..3 {
            gradient[axis] = weight.mul_add(offset[axis], gradient[axis]);
            color[axis] = blob.mul_add(V::splat(row.color[axis]), color[axis]);
        }
    }
    let six = V::splat(6.0);
    // Without any field this is the default colour, white. A field that is not zero is larger by more than
    // f32 can tell.
    let tiny = V::splat(f32::MIN_POSITIVE);
    let share = field.add(tiny);
    for axis in 0..3 {
        gradient[axis] = gradient[axis].mul(six);
        color[axis] = color[axis].add(tiny).div(share);
    }
    let ([gx, gy, gz], [r, g, b]) = (gradient, color);
    [field, gx, gy, gz, r, g, b]
}

/// Which answers to give: `N` reals for each point.
///
/// (A trait and not a closure: only a function can be told to become part of its caller, and so use the
/// caller's instructions.)
pub(super) trait Answers<const N: usize> {
    /// Registers of points that are kept at once.
    const REGISTERS: usize;

    /// Answers for the first `REGISTERS` registers of points. Has to be `#[inline(always)]`.
    fn answer<V: Vector>(&self, rows: &[Row], points: [&[f32]; 3], answers: [&mut [f32]; N]);
}

/// A register of points, the `n`th.
#[inline(always)]
fn load<V: Vector>([x, y, z]: [&[f32]; 3], n: usize) -> [V; 3] {
    let start = n * V::LANES;
    [V::load(&x[start..]), V::load(&y[start..]), V::load(&z[start..])]
}

/// The field.
pub(super) struct Field;

impl Answers<1> for Field {
    /// The broadcasts of a row are shared by all registers. As many as measure best.
    const REGISTERS: usize = 6;

    #[inline(always)]
    fn answer<V: Vector>(&self, rows: &[Row], points: [&[f32]; 3], [field]: [&mut [f32]; 1]) {
        let mut registers = [[V::splat(0.0); 3]; Self::REGISTERS];
        for (n, register) in registers.iter_mut().enumerate() {
            *register = load(points, n);
        }
        let sums = field_at(rows.iter(), registers);
        for (n, sum) in sums.into_iter().enumerate() {
            sum.store(&mut field[n * V::LANES..]);
        }
    }
}

/// Field and gradient.
pub(super) struct Gradient;

impl Answers<4> for Gradient {
    const REGISTERS: usize = 1;

    #[inline(always)]
    fn answer<V: Vector>(&self, rows: &[Row], points: [&[f32]; 3], answers: [&mut [f32]; 4]) {
        let values: [V; 4] = gradient_at(rows.iter(), load(points, 0));
        for (value, plane) in values.into_iter().zip(answers) {
            value.store(plane);
        }
    }
}

/// Field, gradient and colour.
pub(super) struct Full;

impl Answers<7> for Full {
    const REGISTERS: usize = 1;

    #[inline(always)]
    fn answer<V: Vector>(&self, rows: &[Row], points: [&[f32]; 3], answers: [&mut [f32]; 7]) {
        let values: [V; 7] = full_at(rows.iter(), load(points, 0));
        for (value, plane) in values.into_iter().zip(answers) {
            value.store(plane);
        }
    }
}

/// Answers at all points.
pub(super) struct Dense<'a, A, const N: usize> {
    pub(super) rows: &'a [Row],
    pub(super) points: [&'a [f32]; 3],
    pub(super) answers: [&'a mut [f32]; N],
    pub(super) which: A,
}

/// The longest block: six registers of sixteen.
const MAX_BLOCK: usize = 6 * 16;

impl<A: Answers<N>, const N: usize> Job for Dense<'_, A, N> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self { rows, points, mut answers, which } = self;
        let size = A::REGISTERS * V::LANES;
        let count = points[0].len();
        // The last block, if it is shorter than the others, is filled up with the origin, and its answers are
        // copied.
        let mut inputs = [[0.0; MAX_BLOCK]; 3];
        let mut outputs = [[0.0; MAX_BLOCK]; N];
        for start in (0..count).step_by(size) {
            let rest = count - start;
            let mut from = points.map(|plane| &plane[start..]);
            let mut to = answers.each_mut().map(|plane| &mut plane[start..]);
            if rest < size {
                for (input, plane) in inputs.iter_mut().zip(from) {
                    input[..rest].copy_from_slice(plane);
                }
                from = inputs.each_ref().map(|plane| &plane[..]);
                to = outputs.each_mut().map(|plane| &mut plane[..]);
            }
            which.answer::<V>(rows, from, to);
            if rest < size {
                for (output, plane) in outputs.iter().zip(&mut answers) {
                    plane[start..].copy_from_slice(&output[..rest]);
                }
            }
        }
    }
}
