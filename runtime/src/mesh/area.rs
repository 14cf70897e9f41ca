//! Areas and directions of triangles, in f64.

/// The area vector of a triangle, along its normal and as long as twice its area.
pub(crate) fn area_vector(corners: [[f32; 3]; 3]) -> [f64; 3] {
    let [p, q, r] = corners;
    let from = |end: [f32; 3], axis: usize| f64::from(end[axis]) - f64::from(p[axis]);
    let [u, v] = [[from(q, 0), from(q, 1), from(q, 2)], [from(r, 0), from(r, 1), from(r, 2)]];
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// A vector divided by its length; `None` if the length is 0 or not finite.
pub(crate) fn unit(vector: [f64; 3]) -> Option<[f32; 3]> {
    let length = vector.iter().map(|c| c * c).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| vector.map(|c| (c / length) as f32))
}
