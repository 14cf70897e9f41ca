//! Newton's step along the gradient, within the cell of a vertex.

use crate::boxes::Box3;

/// Vertices that are pulled together: two registers of 128 bits, or one of 256.
pub(super) const LANES: usize = 8;

/// A number for each of some vertices. Loops over lanes have no branches and compile to vector instructions.
pub(super) type VertexLanes = [f32; LANES];

/// A plane of numbers for each of three components.
pub(super) type VertexPlanes = [Vec<f32>; 3];

/// Sums of squares by lanes.
#[inline(always)]
pub(super) fn squares([x, y, z]: &[VertexLanes; 3]) -> VertexLanes {
    let mut sums = [0.0; LANES];
    for i in 0..LANES {
        sums[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    }
    sums
}

/// Whether a condition, 1 or 0, holds for all lanes.
#[inline(always)]
pub(super) fn all(conditions: &[u32; LANES]) -> bool {
    conditions.iter().fold(1, |all, condition| all & condition) == 1
}

/// Pulls vertices, each from its position with the field and the gradient there, within the boxes from `low`
/// to `high`.
///
/// All lanes take the plain step at once; vertices whose step would leave the box are then pulled one by one.
#[inline(always)]
pub(super) fn pull_lanes(
    iso: f32,
    points: &mut [VertexLanes; 3],
    values: &VertexLanes,
    gradient: &[VertexLanes; 3],
    low: &[VertexLanes; 3],
    high: &[VertexLanes; 3],
) {
    let mut step = squares(gradient);
    for i in 0..LANES {
        step[i] = (iso - values[i]) / step[i];
    }
    let (mut aims, mut stays) = ([[0.0; LANES]; 3], [1_u32; LANES]);
    for axis in 0..3 {
        for i in 0..LANES {
            let aim = points[axis][i] + step[i] * gradient[axis][i];
            aims[axis][i] = aim;
            stays[i] &= u32::from(low[axis][i] <= aim) & u32::from(aim <= high[axis][i]);
        }
    }
    if !all(&stays) {
        for i in (0..LANES).filter(|&i| stays[i] == 0) {
            let at = |planes: &[VertexLanes; 3]| [planes[0][i], planes[1][i], planes[2][i]];
            let pulled = pull(iso, at(points), values[i], at(gradient), Box3::new(at(low), at(high)));
            for (plane, coordinate) in aims.iter_mut().zip(pulled) {
                plane[i] = coordinate;
            }
        }
    }
    *points = aims;
}

/// Newton's step along the gradient of one vertex, within a box.
///
/// A step that would leave the box goes as far as its sides, and its rest goes along them, so that a surface
/// which leaves the box beside the vertex is still met. Where the gradient vanishes or is not finite, the
/// position stays.
pub(super) fn pull(
    iso: f32,
    position: [f32; 3],
    field: f32,
    gradient: [f32; 3],
    Box3 { low, high }: Box3,
) -> [f32; 3] {
    if gradient.iter().any(|g| !g.is_finite()) {
        return position;
    }
    let mut point = position;
    // By how much the field, were it linear, has still to rise.
    let mut rest = iso - field;
    // Every round but the last stops one more axis at a side.
    for _ in 0..3 {
        let along = [0, 1, 2].map(|axis| {
            let slope = gradient[axis];
            let limit = if rest * slope > 0.0 { high[axis] } else { low[axis] };
            if point[axis] == limit { 0.0 } else { slope }
        });
        let step = rest / (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
        if !step.is_finite() {
            break;
        }
        let aim = [0, 1, 2].map(|axis| point[axis] + step * along[axis]);
        let next = [0, 1, 2].map(|axis| aim[axis].clamp(low[axis], high[axis]));
        rest -= (0..3).map(|axis| along[axis] * (next[axis] - point[axis])).sum::<f32>();
        point = next;
        if next == aim {
            break;
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Box3 = Box3::new([-10.0; 3], [10.0; 3]);

    #[test]
    fn a_pull_solves_a_linear_field_at_once() {
        // f = 2 x - y + 1 is 0.5 on the plane that this ends on.
        let [x, y, z] = pull(0.5, [1.0, 1.0, 7.0], 2.0, [2.0, -1.0, 0.0], BOX);
        assert!((2.0 * x - y + 0.5).abs() < 1e-6);
        assert_eq!(z, 7.0);
    }

    #[test]
    fn a_pull_goes_on_along_the_sides_of_its_box() {
        // The plain step towards x + 2 y + 4 z = 6 would end at z = 8 / 7.
        let unit = Box3::new([0.0; 3], [1.0; 3]);
        let [x, y, z] = pull(6.0, [0.0; 3], 0.0, [1.0, 2.0, 4.0], unit);
        assert_eq!(z, 1.0);
        assert!((x + 2.0 * y + 4.0 * z - 6.0).abs() < 1e-6);
        // Out of reach: the nearest corner.
        assert_eq!(pull(9.0, [0.0; 3], 0.0, [1.0, 2.0, 4.0], unit), [1.0; 3]);
        assert_eq!(pull(-9.0, [0.5; 3], 0.0, [1.0, 2.0, -4.0], unit), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn pulls_by_lanes_are_pulls() {
        // A step that stays, one that leaves the box, one without a number.
        let mut points = [[0.25; LANES], [0.5; LANES], [0.75; LANES]];
        let mut gradient = [[1.0; LANES], [0.5; LANES], [-0.25; LANES]];
        gradient[0][1] = f32::NAN;
        let mut values = [0.5; LANES];
        (values[2], values[3]) = (9.0, 0.25);
        let bounds = Box3::new([0.0; 3], [1.0; 3]);
        let [low, high] = [bounds.low, bounds.high].map(|corner| corner.map(|c| [c; LANES]));
        let before = points;
        pull_lanes(0.5, &mut points, &values, &gradient, &low, &high);
        for lane in 0..LANES {
            let at = |planes: [VertexLanes; 3]| planes.map(|plane| plane[lane]);
            let pulled = pull(0.5, at(before), values[lane], at(gradient), bounds);
            assert_eq!(at(points), pulled, "lane {lane}");
        }
    }

    #[test]
    fn a_pull_goes_nowhere_without_a_gradient() {
        let pull = |field, gradient| pull(0.5, [0.25; 3], field, gradient, BOX);
        assert_eq!(pull(0.4, [0.0; 3]), [0.25; 3]);
        assert_eq!(pull(0.5, [0.0; 3]), [0.25; 3]);
        assert_eq!(pull(0.4, [1e-30, 0.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(0.4, [f32::NAN, 1.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(0.4, [f32::INFINITY, 1.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(0.4, [f32::MAX, 1.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(f32::NAN, [1.0, 0.0, 0.0]), [0.25; 3]);
        assert_eq!(pull(f32::INFINITY, [1.0, 0.0, 0.0]), [0.25; 3]);
    }
}
