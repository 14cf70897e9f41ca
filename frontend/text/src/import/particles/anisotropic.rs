//! Kernels that follow the shape of a fluid: each point becomes an ellipsoid, flat where its neighbours lie
//! in a plane (Yu and Turk 2013, "Reconstructing surfaces of particle-based fluids using anisotropic
//! kernels").
//!
//! ```text
//! neighbours   w_j = 1 - (d_j / R)^3 within R, of the points in the order of the file
//! centre       0.1 x + 0.9 m, m = sum w_j x_j / sum w_j          points of a surface calm down
//! covariance   C = sum w_j (x_j - m)(x_j - m)^T / sum w_j = Q diag(s) Q^T
//! axes         a_k = max(s_k, s_1 / 4) / (0.15 R^2), Q diag(a) Q^T takes the ball to the ellipsoid
//!              fewer than 25 neighbours: 0.5 along each axis
//! strength     1 / (a_1 a_2 a_3), so that each holds as much as before
//! ```
//!
//! The paper's constant 1400 is for its units; 0.15 R^2 is the variance of a full neighbourhood, whose
//! point stays a ball of its size. Axes go with the eigenvalues, as in the paper, and not with their roots.
//! Sums are in f64 and in a fixed order, so the same file gives the same bits.

use std::collections::BTreeMap;

use jbt_model::diagnostic::Diagnostic;
use jbt_model::eigen::eigen;
use jbt_model::particles::NumberArray;

/// How far a centre goes towards the mean of its neighbours.
const CALM: f64 = 0.9;
/// The most that an axis is longer than another one.
const STRETCH: f64 = 4.0;
/// The variance of a full neighbourhood, in squares of its radius.
const FULL: f64 = 0.15;
/// A point with fewer neighbours is a ball of half its size.
const FEWEST: usize = 25;
/// The axes of such a ball.
const LONELY: f64 = 0.5;
/// The most pairs of points that are looked at.
const MAX_PAIRS: u64 = 1 << 31;

/// What becomes of a point: an affine map of its ball, and the factor of its strength.
pub(super) struct FluidKernel {
    /// Three rows of the map about the world's origin; the last column is the shift.
    pub(super) rows: [[f64; 4]; 3],
    pub(super) strength: f64,
}

/// The kernels of points with neighbourhoods of this radius.
pub(super) fn kernels(positions: &NumberArray, radius: f64) -> Result<Vec<FluidKernel>, Vec<Diagnostic>> {
    let points: Vec<[f64; 3]> = (0..positions.len() / 3).map(|n| positions.triple(n)).collect();
    let cell = |point: [f64; 3]| point.map(|x| (x / radius).floor() as i64);
    let mut cells = BTreeMap::<[i64; 3], Vec<u32>>::new();
    for (number, &point) in (0..).zip(&points) {
        cells.entry(cell(point)).or_default().push(number);
    }
    let (mut left, mut made, mut near) = (MAX_PAIRS, Vec::with_capacity(points.len()), Vec::new());
    for &point in &points {
        near.clear();
        let home = cell(point);
        for step in 0..27 {
            let other = [0, 1, 2].map(|k| home[k].saturating_add([step % 3, step / 3 % 3, step / 9][k] - 1));
            near.extend(cells.get(&other).into_iter().flatten().copied());
        }
        left = left.checked_sub(near.len() as u64).ok_or_else(|| {
            let message =
                format!("neighbourhoods of radius {radius} hold more than {MAX_PAIRS} pairs of points");
            vec![Diagnostic::limit(None, message)]
        })?;
        near.sort_unstable();
        made.push(kernel(point, near.iter().map(|&n| points[n as usize]), radius));
    }
    Ok(made)
}

/// The kernel of a point among others, itself among them.
fn kernel(point: [f64; 3], near: impl Iterator<Item = [f64; 3]> + Clone, radius: f64) -> FluidKernel {
    let weighted = near.filter_map(|other| {
        let way: [f64; 3] = std::array::from_fn(|k| other[k] - point[k]);
        let square = way.iter().map(|x| x * x).sum::<f64>() / (radius * radius);
        (square < 1.0).then(|| (1.0 - square * square.sqrt(), way))
    });
    let (mut count, mut total, mut mean) = (0, 0.0, [0.0; 3]);
    for (weight, way) in weighted.clone() {
        count += 1;
        total += weight;
        mean.iter_mut().zip(way).for_each(|(sum, x)| *sum += weight * x);
    }
    let mean = mean.map(|sum| sum / total);
    let centre: [f64; 3] = std::array::from_fn(|k| point[k] + CALM * mean[k]);
    let (mut axes, mut vectors) = ([LONELY; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // The point itself is none of its neighbours.
    if count > FEWEST {
        let mut covariance = [[0.0; 3]; 3];
        for (weight, way) in weighted {
            let off: [f64; 3] = std::array::from_fn(|k| way[k] - mean[k]);
            for (row, a) in covariance.iter_mut().zip(off) {
                row.iter_mut().zip(off).for_each(|(sum, b)| *sum += weight * a * b / total);
            }
        }
        let (values, found) = eigen(covariance);
        let largest = values.iter().fold(0.0_f64, |most, &value| most.max(value));
        if largest > 0.0 {
            axes = values.map(|value| value.max(largest / STRETCH) / (FULL * radius * radius));
            vectors = found;
        }
    }
    let matrix: [[f64; 3]; 3] = std::array::from_fn(|row| {
        std::array::from_fn(|column| (0..3).map(|k| axes[k] * vectors[k][row] * vectors[k][column]).sum())
    });
    let rows = std::array::from_fn(|row| {
        let moved: f64 = (0..3).map(|k| matrix[row][k] * point[k]).sum();
        [matrix[row][0], matrix[row][1], matrix[row][2], centre[row] - moved]
    });
    FluidKernel { rows, strength: 1.0 / (axes[0] * axes[1] * axes[2]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The image of a direction.
    fn image(kernel: &FluidKernel, way: [f64; 3]) -> f64 {
        let image = kernel.rows.map(|row| (0..3).map(|k| row[k] * way[k]).sum::<f64>());
        image.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    fn lattice(high: f64) -> Vec<f64> {
        let steps: Vec<f64> = (-10..=10).map(|n| 0.1 * f64::from(n)).collect();
        let all = steps.iter().flat_map(|&x| steps.iter().map(move |&y| (x, y)));
        let all = all.flat_map(|(x, y)| steps.iter().map(move |&z| [x, y, z]));
        all.filter(|p| p[2] <= high).flatten().collect()
    }

    #[test]
    fn a_point_inside_keeps_its_size_and_one_at_a_surface_is_flat() {
        let numbers = lattice(0.0);
        let places: NumberArray = numbers.clone().into();
        let made = kernels(&places, 0.45).unwrap();
        let at = |p: [f64; 3]| {
            let is_there = |q: &[f64]| (0..3).all(|k| (q[k] - p[k]).abs() < 1e-9);
            numbers.chunks_exact(3).position(is_there).unwrap()
        };
        let inside = &made[at([0.0, 0.0, -0.5])];
        for way in [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]] {
            assert!((image(inside, way) - 1.0).abs() < 0.1, "{}", image(inside, way));
        }
        assert!((inside.strength - 1.0).abs() < 0.3);
        let top = &made[at([0.0; 3])];
        let [across, along] = [image(top, [0.0, 0.0, 1.0]), image(top, [1.0, 0.0, 0.0])];
        assert!(across < 0.5 * along, "{across} {along}");
        // Towards the others.
        assert!(top.rows[2][3] < -0.05);
        let again = kernels(&places, 0.45).unwrap();
        assert!(made.iter().zip(&again).all(|(a, b)| a.rows == b.rows));
    }

    #[test]
    fn lonely_points_are_small_balls() {
        let alone = kernels(&vec![1.0, 2.0, 3.0].into(), 0.5).unwrap();
        assert_eq!(alone[0].strength, 8.0);
        assert_eq!(alone[0].rows, [[0.5, 0.0, 0.0, 0.5], [0.0, 0.5, 0.0, 1.0], [0.0, 0.0, 0.5, 1.5]]);
    }
}
