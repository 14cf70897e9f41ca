//! A straight piece of a tube: all balls with centres on a line and radii that change evenly along it.
//!
//! ```text
//!        ___---~~~~\         The point at height x along the line and y beside it is nearest to the ball at
//!   .--~~           \
//!  (  a - - - - - b  )            tau = clamp(x + y k / sqrt(1 - k^2), 0, L),      k = (r_b - r_a) / L
//!   '--__           /
//!        ~~~---____/         at the distance |p - a - tau u| - (r_a + k tau).
//! ```
//!
//! Where `|k| >= 1`, one end's ball holds all the others. The distance has its minimum at tau, so its
//! gradient is the gradient for a constant tau: the direction from the ball's centre.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::points::NearestPlace;
use super::tube::TubePart;
use crate::bounds::Bounds;

/// The balls between two end balls, with the end balls.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Cone {
    pub(super) centers: [DVec3; 2],
    pub(super) radii: [f64; 2],
}

impl Cone {
    /// The slope k of the radius along the line, and the shift of the nearest ball for each unit of distance
    /// from the line. If one end's ball holds all others: the index of that end.
    pub(super) fn taper(&self) -> Result<(f64, f64), usize> {
        let k = (self.radii[1] - self.radii[0]) / self.centers[0].distance(self.centers[1]);
        let square = 1.0 - k * k;
        // Equal centres give a NaN or an infinity. Below 1e-12, the other balls stick out by less than 1e-12
        // of the length.
        if square > 1e-12 {
            Ok((k, k / square.sqrt()))
        } else {
            Err(usize::from(self.radii[1] > self.radii[0]))
        }
    }

    /// The place of the ball that is nearest to `p`, from 0 at the first end to 1 at the other.
    pub(super) fn nearest(&self, p: DVec3) -> f64 {
        let [a, b] = self.centers;
        match self.taper() {
            Err(end) => end as f64,
            Ok((_, lean)) => {
                let length = a.distance(b);
                let along = (b - a) / length;
                let x = (p - a).dot(along);
                let y = (p - a - x * along).length();
                ((x + y * lean) / length).clamp(0.0, 1.0)
            }
        }
    }

    /// The ball at a place.
    pub(super) fn at(&self, t: f64) -> (DVec3, f64) {
        (self.centers[0].lerp(self.centers[1], t), self.radii[0] + t * (self.radii[1] - self.radii[0]))
    }
}

impl TubePart for Cone {
    const COLUMNS: &'static [&'static str] =
        &["ax", "ay", "az", "ux", "uy", "uz", "length", "radius", "taper", "lean"];

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let ball = |end: usize| {
            let rows = DVec3::from_array([0, 1, 2].map(|axis| map.matrix3.row(axis).length()));
            let (center, reach) = (map.transform_point3(self.centers[end]), self.radii[end] * rows);
            Bounds::new(center - reach, center + reach)
        };
        ball(0).hull(ball(1))
    }

    fn columns(&self, to_pose: &DAffine3, scale: f64, row: &mut Vec<f64>) {
        let [a, b] = self.centers.map(|center| scale * to_pose.transform_point3(center));
        let (from, along, length, radius, taper, lean) = match self.taper() {
            Ok((taper, lean)) => (a, super::unit(b - a), a.distance(b), self.radii[0], taper, lean),
            Err(end) => ([a, b][end], DVec3::ZERO, 0.0, self.radii[end], 0.0, 0.0),
        };
        row.extend(from.to_array());
        row.extend(along.to_array());
        row.extend([length, scale * radius, taper, lean]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], piece: &[D::Real]) -> D::Real {
        let from_a: [D::Real; 3] = std::array::from_fn(|axis| d.sub(p[axis], piece[axis]));
        let along = [piece[3], piece[4], piece[5]];
        let [length, radius, taper, lean] = [piece[6], piece[7], piece[8], piece[9]];
        let x = super::dot(d, from_a, along);
        let beside = super::minus_multiple(d, from_a, x, along);
        let y = super::length(d, beside);
        let tau = d.fma(y, lean, x);
        let tau = super::positive_part(d, tau);
        let tau = d.min(tau, length);
        let tau = d.stop_gradient(tau);
        let from_center = super::minus_multiple(d, from_a, tau, along);
        let distance = super::length(d, from_center);
        let ball = d.fma(tau, taper, radius);
        d.sub(distance, ball)
    }

    fn places(parts: impl Iterator<Item = Self>, p: DVec3) -> Vec<NearestPlace> {
        let place = |cone: Self| {
            let (foot, radius) = cone.at(cone.nearest(p));
            NearestPlace { distance: p.distance(foot) - radius, foot, firmness: 1.0 }
        };
        parts.map(place).collect()
    }

    fn divided(parts: impl Iterator<Item = Self>, _reach: f64) -> impl Iterator<Item = Self> {
        parts
    }
}
