//! Vectors of three reals.

/// A point or a direction.
pub type Vector3 = [f64; 3];

/// The difference of two points.
#[must_use]
pub fn minus(a: Vector3, b: Vector3) -> Vector3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The scalar product.
#[must_use]
pub fn dot(a: Vector3, b: Vector3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[must_use]
pub fn cross(a: Vector3, b: Vector3) -> Vector3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length.
#[must_use]
pub fn length(a: Vector3) -> f64 {
    dot(a, a).sqrt()
}

/// Whether no component is farther away than that.
#[must_use]
pub fn near(a: Vector3, b: Vector3, within: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
}
