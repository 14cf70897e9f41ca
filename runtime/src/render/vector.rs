//! Vectors of three f64, as plain arrays.

use std::ops::Range;

/// A point or a direction.
pub type Vector = [f64; 3];

pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn scale(a: Vector, by: f64) -> Vector {
    a.map(|x| x * by)
}

/// `a + by * b`.
pub fn along(a: Vector, by: f64, b: Vector) -> Vector {
    add(a, scale(b, by))
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Squares of lengths between these have all of their digits.
const SAFE_SQUARES: Range<f64> = 1e-200..1e200;

/// The length, also for vectors whose squares overflow f64.
pub fn length(a: Vector) -> f64 {
    let square = dot(a, a);
    if SAFE_SQUARES.contains(&square) {
        return square.sqrt();
    }
    let largest = a.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let part = a.map(|x| x / largest);
    largest * dot(part, part).sqrt()
}

/// The direction of a vector; `None` if it has none.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = length(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}

pub fn is_finite(a: Vector) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// Two unit vectors that are at right angles to a unit vector and to each other.
///
/// After Duff et al., Building an Orthonormal Basis, Revisited (2017).
pub fn tangents(n: Vector) -> [Vector; 2] {
    let sign = 1.0_f64.copysign(n[2]);
    let a = -1.0 / (sign + n[2]);
    let b = n[0] * n[1] * a;
    [[1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]], [b, sign + n[1] * n[1] * a, -n[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_are_a_basis() {
        for direction in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, -2.0, 0.5], [-3.0, 0.1, -0.2]] {
            let n = unit(direction).unwrap();
            let [s, t] = tangents(n);
            for (a, b, expected) in [(s, s, 1.0), (t, t, 1.0), (s, t, 0.0), (s, n, 0.0), (t, n, 0.0)] {
                assert!((dot(a, b) - expected).abs() < 1e-12, "{direction:?}");
            }
        }
    }

    #[test]
    fn units_of_anything_that_has_a_direction() {
        assert_eq!(unit([0.0; 3]), None);
        assert_eq!(unit([f64::NAN, 0.0, 0.0]), None);
        assert_eq!(unit([f64::INFINITY, 0.0, 0.0]), None);
        for size in [1e-300, 1.0, 1e300] {
            let found = unit([0.0, -3.0 * size, 4.0 * size]).unwrap();
            assert!(length(sub(found, [0.0, -0.6, 0.8])) < 1e-15, "{found:?}");
        }
    }
}
