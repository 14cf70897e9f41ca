//! A box cut by a plane: the linear field that fits a field best, and how much of the box is on its upper
//! side.
//!
//! The fit takes the field at Gauss's eight points of the box. The mean of a field of the third degree there
//! is its mean in the box; so what curvature moves the plane by cancels out over many boxes.
//!
//! With `m_i = |g_i| side_i`, the part of the box where `g . (p - corner) <= a`, from the corner where that
//! is least, is
//!
//! ```text
//! V(a) = (a^3 - sum (a - m_i)+^3 + sum (a - m_i - m_j)+^3 - (a - m_1 - m_2 - m_3)+^3) / (6 m_1 m_2 m_3)
//! ```
//!
//! of its volume (Scardovelli and Zaleski 2000, "Analytical relations connecting linear interfaces and volume
//! fractions in rectangular grids").

/// How far Gauss's points are from the middle of an edge of length 1: `1 / (2 sqrt(3))`.
const GAUSS: f64 = 0.288_675_134_594_812_9;

/// The lower and the upper coordinate of Gauss's points between two sides.
pub(super) fn gauss(low: f32, high: f32) -> [f32; 2] {
    let (middle, side) = (0.5 * (f64::from(low) + f64::from(high)), f64::from(high) - f64::from(low));
    [-GAUSS, GAUSS].map(|offset| ((middle + offset * side) as f32).clamp(low, high))
}

/// A linear field about the middle of a box.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct LinearField {
    /// Its value in the middle.
    pub(super) middle: f64,
    /// Its gradient.
    pub(super) gradient: [f64; 3],
    /// How far the values that it fits are from it at most.
    pub(super) residual: f64,
}

impl LinearField {
    /// Fits values at eight points: the corners of a box with these coordinates, bit 0 of their number is x,
    /// bit 1 y, bit 2 z.
    pub(super) fn fit(places: &[[f32; 2]; 3], values: &[f32]) -> Self {
        let middle = values.iter().map(|&value| f64::from(value)).sum::<f64>() / 8.0;
        let sign = |point: usize, axis: usize| if point >> axis & 1 == 1 { 1.0 } else { -1.0 };
        // Half of the rise from the lower to the upper points.
        let rises = [0, 1, 2]
            .map(|axis| (0..8).map(|point| sign(point, axis) * f64::from(values[point])).sum::<f64>() / 8.0);
        let residual = (0..8).fold(0.0, |most: f64, point| {
            let linear = middle + (0..3).map(|axis| sign(point, axis) * rises[axis]).sum::<f64>();
            most.max((f64::from(values[point]) - linear).abs())
        });
        let gradient = [0, 1, 2].map(|axis| {
            let [low, high] = places[axis].map(f64::from);
            if high > low { 2.0 * rises[axis] / (high - low) } else { 0.0 }
        });
        Self { middle, gradient, residual }
    }
}

/// Components of the gradient that are smaller than this part of the largest count as this much: the formula
/// divides by all of them.
const FLATTEST: f64 = 1e-4;

/// The part of a box with these sides, in [0, 1], where the linear field of this gradient is not negative;
/// `middle` is its value in the middle of the box.
///
/// A gradient of zero, or one that is no number, cuts nothing: the box is above if the middle is not
/// negative.
pub(super) fn fraction(sides: [f64; 3], middle: f64, gradient: [f64; 3]) -> f64 {
    let slopes: [f64; 3] = std::array::from_fn(|axis| gradient[axis].abs() * sides[axis]);
    let steepest = slopes.iter().fold(0.0, |most: f64, &slope| most.max(slope));
    let sum: f64 = slopes.iter().sum();
    if !(steepest > 0.0 && sum.is_finite() && middle.is_finite()) {
        return if middle >= 0.0 { 1.0 } else { 0.0 };
    }
    let m = slopes.map(|slope| (slope / steepest).max(FLATTEST));
    // From the highest corner down to the plane.
    let a = middle / steepest + 0.5 * m.iter().sum::<f64>();
    let whole: f64 = m.iter().sum();
    if a <= 0.0 || a >= whole {
        return if a > 0.0 { 1.0 } else { 0.0 };
    }
    let product: f64 = m.iter().product();
    let part = |offset: f64| (a - offset).max(0.0).powi(3);
    let pairs = part(m[0] + m[1]) + part(m[1] + m[2]) + part(m[2] + m[0]);
    let cut_off = part(0.0) - m.iter().map(|&m| part(m)).sum::<f64>() + pairs;
    (cut_off / (6.0 * product)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-4 * (1.0 + expected), "{found} is not {expected}");
    }

    #[test]
    fn planes_across_an_axis() {
        let fraction = |middle| fraction([1.0, 2.0, 4.0], middle, [0.0, 3.0, 0.0]);
        near(fraction(0.0), 0.5);
        near(fraction(1.5), 0.75);
        assert_eq!(fraction(3.1), 1.0);
        assert_eq!(fraction(-3.1), 0.0);
    }

    #[test]
    fn a_diagonal_plane_halves_a_cube_or_cuts_a_corner_off() {
        near(fraction([1.0; 3], 0.0, [-1.0, 1.0, 1.0]), 0.5);
        // A corner of edge 1/2 is left.
        near(fraction([1.0; 3], -1.0, [1.0, 1.0, 1.0]), 1.0 / 48.0);
        near(fraction([1.0; 3], 1.0, [1.0, -1.0, 1.0]), 47.0 / 48.0);
    }

    #[test]
    fn fits_are_exact_for_linear_fields_and_for_the_mean_of_others() {
        let places = [gauss(0.0, 1.0), gauss(-1.0, 1.0), gauss(2.0, 6.0)];
        let values = |field: &dyn Fn([f64; 3]) -> f64| -> Vec<f32> {
            let point = |point: usize| [0, 1, 2].map(|axis| f64::from(places[axis][point >> axis & 1]));
            (0..8).map(|index| field(point(index)) as f32).collect()
        };
        let linear = LinearField::fit(&places, &values(&|[x, y, z]| 1.0 + 2.0 * x - y + 0.5 * z));
        near(linear.middle, 4.0);
        (0..3).for_each(|axis| assert!((linear.gradient[axis] - [2.0, -1.0, 0.5][axis]).abs() < 1e-5));
        assert!(linear.residual < 1e-5);
        // The mean of z^3 from 2 to 6.
        near(LinearField::fit(&places, &values(&|[_, _, z]| z * z * z)).middle, 80.0);
        near(LinearField::fit(&places, &values(&|[x, y, _]| (x - 0.5) * y)).residual, 1.0 / 6.0);
    }

    #[test]
    fn what_has_no_slope_is_not_cut() {
        for gradient in [[0.0; 3], [f64::NAN, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
            assert_eq!(fraction([1.0; 3], 0.0, gradient), 1.0);
            assert_eq!(fraction([1.0; 3], -1.0, gradient), 0.0);
        }
        assert_eq!(fraction([1.0; 3], f64::NAN, [1.0; 3]), 0.0);
    }
}
