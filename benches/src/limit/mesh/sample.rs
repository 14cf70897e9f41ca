//! The field at the corners of a brick.
//!
//! Corners with the same x and y share most of a blob: with `column = a - k (dx^2 + dy^2)` and `height = k
//! dz^2`, what is left for each of the nine corners of a column is
//!
//! ```text
//!     v = max(column - height, 0)     F += v^2 (v + b)           5 instructions, two of which multiply
//! ```

use crate::limit::dense::{Constants, Row};
use crate::limit::vector::{Job, Vector};

use super::scene::BRICK;

/// Corners along the edge of a brick.
pub(super) const CORNERS: usize = BRICK + 1;
/// Corners in a layer of a brick.
const LAYER: usize = CORNERS * CORNERS;
/// Those, filled up to a multiple of the widest register.
const PADDED_LAYER: usize = LAYER.next_multiple_of(16);

/// The field in a brick.
pub(super) struct Samples {
    /// For each z: the field at `x + 9 y`.
    pub(super) values: [[f32; PADDED_LAYER]; CORNERS],
    /// For each z: whether the corner `x + 9 y` is inside, a bit each.
    pub(super) inside: [u128; CORNERS],
    /// For each row: its height at each z.
    heights: Vec<[f32; 16]>,
}

impl Samples {
    pub(super) fn new() -> Self {
        Self { values: [[0.0; PADDED_LAYER]; CORNERS], inside: [0; CORNERS], heights: Vec::new() }
    }

    /// Whether some corners are inside and some are not.
    pub(super) fn is_crossed(&self) -> bool {
        const ALL: u128 = (1 << LAYER) - 1;
        let any = self.inside.iter().fold(0, |any, layer| any | layer) & ALL;
        let all = self.inside.iter().fold(ALL, |all, layer| all & layer);
        any != 0 && all != ALL
    }
}

/// Samples a brick.
pub(super) struct Sample<'a> {
    pub(super) rows: &'a [Row],
    /// The coordinates of the corners along each axis. Where the lattice ends, the last is repeated.
    pub(super) axes: [[f32; CORNERS]; 3],
    pub(super) iso: f32,
    pub(super) samples: &'a mut Samples,
}

impl Job for Sample<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self { rows, axes: [xs, ys, zs], iso, samples } = self;
        let (mut x, mut y, mut z) = ([0.0; PADDED_LAYER], [0.0; PADDED_LAYER], [0.0; 16]);
        for row in 0..CORNERS {
            x[row * CORNERS..][..CORNERS].copy_from_slice(&xs);
            y[row * CORNERS..][..CORNERS].fill(ys[row]);
        }
        z[..CORNERS].copy_from_slice(&zs);
        samples.heights.clear();
        for row in rows {
            let mut heights = [0.0; 16];
            for start in (0..16).step_by(V::LANES) {
                let offset = V::splat(row.center[2]).sub(V::load(&z[start..]));
                Constants::height(offset, V::splat(row.curvature)).store(&mut heights[start..]);
            }
            samples.heights.push(heights);
        }
        samples.inside = [0; CORNERS];
        let (constants, zero, iso) = (Constants::<V>::new(), V::splat(0.0), V::splat(iso));
        for start in (0..LAYER).step_by(V::LANES) {
            let (x, y) = (V::load(&x[start..]), V::load(&y[start..]));
            let mut sums = [zero; CORNERS];
            for (row, heights) in rows.iter().zip(&samples.heights) {
                let (dx, dy) = (V::splat(row.center[0]).sub(x), V::splat(row.center[1]).sub(y));
                let column = constants.column(dx, dy, V::splat(row.curvature));
                for n in 0..CORNERS {
                    let v = column.sub(V::splat(heights[n])).max(zero);
                    sums[n] = constants.add_field(v, sums[n]);
                }
            }
            for (n, sum) in sums.into_iter().enumerate() {
                sum.store(&mut samples.values[n][start..]);
                samples.inside[n] |= u128::from(sum.at_least(iso)) << start;
            }
        }
    }
}
