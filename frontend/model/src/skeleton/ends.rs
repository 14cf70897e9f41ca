//! Two ends with radii: what cones and round cones are given by.

use glam::{DAffine3, DVec3};

use crate::bounds::Bounds;

/// The box around the images of what is at two ends, each a place and a radius; `reach` says how far that of
/// a radius reaches along each axis.
pub(super) fn bounds_under(map: &DAffine3, ends: [(DVec3, f64); 2], reach: impl Fn(f64) -> DVec3) -> Bounds {
    let [from, to] = ends.map(|(end, radius)| {
        let (at, reach) = (map.transform_point3(end), reach(radius));
        Bounds::new(at - reach, at + reach)
    });
    from.hull(to)
}
