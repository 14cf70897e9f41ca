//! Which blobs reach a box, and between which bounds the field is in it.

use crate::limit::dense::{Constants, Row};
use crate::limit::vector::{Job, Vector};

/// Blobs that may reach a box, in planes so that a register holds many. In ascending order.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    /// Which rows they are.
    pub(super) indices: Vec<u32>,
    /// Their centres and curvatures, filled up to a multiple of [`PADDING`].
    planes: [Vec<f32>; 4],
}

/// Lanes of the widest register.
const PADDING: usize = 16;
/// A blob that reaches nothing.
const NOWHERE: [f32; 4] = [1e18, 1e18, 1e18, 1e18];

impl Candidates {
    /// All blobs.
    pub(super) fn all(rows: &[Row]) -> Self {
        let mut candidates = Self::default();
        for (index, row) in (0..).zip(rows) {
            let [x, y, z] = row.center;
            candidates.push(index, [x, y, z, row.curvature]);
        }
        candidates.pad();
        candidates
    }

    fn clear(&mut self) {
        self.indices.clear();
        self.planes.iter_mut().for_each(Vec::clear);
    }

    fn push(&mut self, index: u32, numbers: [f32; 4]) {
        self.indices.push(index);
        for (plane, number) in self.planes.iter_mut().zip(numbers) {
            plane.push(number);
        }
    }

    fn pad(&mut self) {
        let length = self.indices.len().next_multiple_of(PADDING);
        for (plane, number) in self.planes.iter_mut().zip(NOWHERE) {
            plane.resize(length, number);
        }
    }
}

/// Finds those of `from` that reach the closed box, into `to`.
pub(super) struct Cull<'a> {
    pub(super) from: &'a Candidates,
    pub(super) to: &'a mut Candidates,
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
}

/// Bounds of the field.
pub(super) struct Bounds {
    pub(super) lower: f32,
    pub(super) upper: f32,
}

/// By how much, relatively, a bound may be off because its terms are added in another order than those of the
/// field.
const ORDER: f32 = 1e-4;

impl Job for Cull<'_> {
    type Output = Bounds;

    #[inline(always)]
    fn run<V: Vector>(self) -> Bounds {
        let Self { from, to, low, high } = self;
        let constants = Constants::<V>::new();
        let (zero, least) = (V::splat(0.0), V::splat(f32::MIN_POSITIVE));
        let low = [V::splat(low[0]), V::splat(low[1]), V::splat(low[2])];
        let high = [V::splat(high[0]), V::splat(high[1]), V::splat(high[2])];
        let (mut lower, mut upper) = (zero, zero);
        to.clear();
        let [x, y, z, curvatures] = &from.planes;
        for start in (0..from.indices.len()).step_by(V::LANES) {
            let center = [V::load(&x[start..]), V::load(&y[start..]), V::load(&z[start..])];
            let curvature = V::load(&curvatures[start..]);
            let (mut near, mut far) = ([zero; 3], [zero; 3]);
            for axis in 0..3 {
                let (below, above) = (low[axis].sub(center[axis]), center[axis].sub(high[axis]));
                near[axis] = below.max(above).max(zero);
                far[axis] = center[axis].sub(low[axis]).max(high[axis].sub(center[axis]));
            }
            let near =
                constants.column(near[0], near[1], curvature).sub(Constants::height(near[2], curvature));
            let far = constants.column(far[0], far[1], curvature).sub(Constants::height(far[2], curvature));
            let (near, far) = (near.max(zero), far.max(zero));
            upper = constants.add_field(near, upper);
            lower = constants.add_field(far, lower);
            let mut reach = near.at_least(least);
            while reach != 0 {
                let n = start + reach.trailing_zeros() as usize;
                to.push(from.indices[n], [x[n], y[n], z[n], curvatures[n]]);
                reach &= reach - 1;
            }
        }
        to.pad();
        Bounds { lower: sum(lower) * (1.0 - ORDER), upper: sum(upper) * (1.0 + ORDER) }
    }
}

#[inline(always)]
fn sum<V: Vector>(register: V) -> f32 {
    let mut lanes = [0.0; PADDING];
    register.store(&mut lanes);
    lanes.iter().sum()
}
