//! Normals point away from the inside. Where the field is smooth they are opposite to its gradient. At a jump
//! the gradient is the inner field's, which does not depend on the wall, so the normal comes from the
//! crossings of the surface with the cell's edges.

use std::ops::RangeInclusive;

use super::super::area::unit;
use super::super::pull::{LANES, VertexLanes, all, squares};

/// Unit vectors away from the inside, or zero where the gradient vanishes or is NaN.
#[inline(always)]
pub(super) fn normals_of(gradient: &[VertexLanes; 3]) -> [VertexLanes; 3] {
    /// Squared lengths whose terms neither overflow nor lose digits.
    const TAME: RangeInclusive<f32> = 1e-24..=1e30;
    let square = squares(gradient);
    let (mut normals, mut is_tame) = (*gradient, [0_u32; LANES]);
    for i in 0..LANES {
        let scale = -1.0 / square[i].sqrt();
        normals.iter_mut().for_each(|plane| plane[i] *= scale);
        is_tame[i] = u32::from(square[i] >= *TAME.start()) & u32::from(square[i] <= *TAME.end());
    }
    if !all(&is_tame) {
        for i in (0..LANES).filter(|&i| is_tame[i] == 0) {
            let slope = gradient.map(|plane| -f64::from(plane[i]));
            let normal = unit(slope).unwrap_or([0.0; 3]);
            normals.iter_mut().zip(normal).for_each(|(plane, component)| plane[i] = component);
        }
    }
    normals
}

/// The normal of a sheet without a usable gradient. `crossings` are its crossings with the edges of the cell,
/// in order, counter-clockwise as seen from outside, each known within `error`; `outward` is the sum of the
/// unit vectors along these edges from inside to outside.
///
/// It is the normal of the polygon of crossings (Newell's sum), which is exact for a plane. Where the polygon
/// is about as narrow as the error of the crossings, for example where an edge of the solid lies along an
/// edge of the lattice, it is along `outward`. `None` if that is zero.
pub(super) fn sheet_normal(crossings: &[[f32; 3]], outward: [f32; 3], error: f32) -> Option<[f32; 3]> {
    /// The least ratio of the area vector's length to its error.
    const CERTAINTY: f64 = 8.0;
    let from = |point: [f32; 3]| [0, 1, 2].map(|axis| f64::from(point[axis]) - f64::from(crossings[0][axis]));
    let (mut area, mut around) = ([0.0; 3], 0.0);
    for (n, &point) in crossings.iter().enumerate() {
        let [p, q] = [point, crossings[(n + 1) % crossings.len()]].map(from);
        for (axis, area) in area.iter_mut().enumerate() {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            *area += p[b] * q[c] - p[c] * q[b];
        }
        around += (0..3).map(|axis| (q[axis] - p[axis]).powi(2)).sum::<f64>().sqrt();
    }
    let length = area.iter().map(|c| c * c).sum::<f64>().sqrt();
    let is_certain = length > CERTAINTY * f64::from(error) * around;
    if is_certain { unit(area) } else { unit(outward.map(f64::from)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_of_a_plane_is_exact_and_outward() {
        // Inside below z = 0.25: the crossings on the four edges along z, counter-clockwise from above.
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.25]);
        assert_eq!(sheet_normal(&square, [0.0, 0.0, 4.0], 1e-4), Some([0.0, 0.0, 1.0]));
        // A corner that is cut off.
        let corner = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
        let [x, y, z] = sheet_normal(&corner, [1.0; 3], 1e-4).unwrap();
        assert!(x == y && y == z && (x - 3.0_f32.sqrt().recip()).abs() < 1e-6);
    }

    #[test]
    fn crossings_on_a_line_leave_their_directions() {
        let line = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1e-5, 0.0, 1.0], [1e-5, 0.0, 0.0]];
        let half = 0.5_f32.sqrt();
        assert_eq!(sheet_normal(&line, [2.0, 2.0, 0.0], 1e-4), Some([half, half, 0.0]));
        assert_eq!(sheet_normal(&line, [0.0; 3], 1e-4), None);
    }
}
