//! Nodes and weights of the quadrature of Gauss and Legendre on [-1, 1].

use std::f64::consts::PI;

/// The nodes and their weights, found by Newton's method on Legendre's polynomial from Tricomi's guess: exact
/// to rounding for polynomials of degree `2 count - 1`.
pub(super) fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let node = |place: usize| {
        let mut x = (PI * (place as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        // Doubles the digits each time, from two of them.
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for degree in 2..=count {
                let k = degree as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::gauss;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [2, 4, 8, 16, 32] {
            for degree in 0..2 * count as i32 {
                let sum: f64 = gauss(count).iter().map(|(x, weight)| weight * x.powi(degree)).sum();
                let expected = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
                assert!((sum - expected).abs() < 1e-14, "{count} {degree}: {sum}");
            }
        }
    }
}
