//! Two ends with radii: the parameters of cones and round cones.

use glam::{DAffine3, DVec3};

use crate::bounds::Bounds;

/// The box around the images of two ends, each a place and a radius; `reach` gives the half sizes of the
/// image of a radius.
pub(super) fn bounds_under(map: &DAffine3, ends: [(DVec3, f64); 2], reach: impl Fn(f64) -> DVec3) -> Bounds {
    let [from, to] = ends.map(|(end, radius)| {
        let (at, reach) = (map.transform_point3(end), reach(radius));
        Bounds::new(at - reach, at + reach)
    });
    from.hull(to)
}
