//! Metrics: how the distance from a skeleton is measured, as far as supports need to know.
//!
//! A metric is a norm N of the vector from the nearest point of the skeleton. Supports need a box around its
//! unit ball `N(v) <= 1` and its steepness: with h the half sizes of the box,
//!
//! ```text
//! |v_k| <= h_k N(v)        N(v) <= steepness |v|
//! ```

use glam::{DMat3, DVec3};

/// How a distance is measured.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Metric {
    half: DVec3,
    steepness: f64,
    round: bool,
}

impl Metric {
    /// The Euclidean norm.
    pub const EUCLIDEAN: Self = Self { half: DVec3::ONE, steepness: 1.0, round: true };

    /// The norm whose unit ball is the ellipsoid with these half axes.
    pub(super) fn ellipsoid(half: DVec3) -> Self {
        Self { half, steepness: 1.0 / half.min_element(), round: true }
    }

    /// A norm whose unit ball lies in the box with these half sizes and touches its six sides in their
    /// middles.
    pub(super) fn touching(half: DVec3) -> Self {
        // The ball is convex, so it holds the hull of the six middles: N is at most |x / a| + |y / b| + |z /
        // c|.
        Self { half, steepness: 3f64.sqrt() / half.min_element(), round: false }
    }

    /// The half sizes of a box around the unit ball, in the pose.
    #[must_use]
    pub fn half(&self) -> DVec3 {
        self.half
    }

    /// The largest change of the distance for each unit of length.
    #[must_use]
    pub fn steepness(&self) -> f64 {
        self.steepness
    }

    /// How far the image of the unit ball reaches along each axis, at most.
    #[must_use]
    pub fn reach(&self, linear: DMat3) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|axis| {
            let row = linear.row(axis) * self.half;
            if self.round { row.length() } else { row.abs().element_sum() }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::affine::{rotation, sin_cos_degrees};

    #[test]
    fn the_reach_of_a_turned_ball() {
        let half = DVec3::new(3.0, 4.0, 0.5);
        let quarter = rotation(DVec3::Z, sin_cos_degrees(90.0));
        let eighth = rotation(DVec3::Z, sin_cos_degrees(45.0));
        for metric in [Metric::ellipsoid(half), Metric::touching(half)] {
            assert_eq!(metric.reach(DMat3::IDENTITY), half);
            assert_eq!(metric.reach(2.0 * quarter), DVec3::new(8.0, 6.0, 1.0));
        }
        // Along the diagonal an ellipsoid reaches sqrt((9 + 16) / 2), the box (3 + 4) / sqrt(2).
        let reach = |metric: Metric| metric.reach(eighth).x;
        assert!((reach(Metric::ellipsoid(half)) - 12.5f64.sqrt()).abs() < 1e-14);
        assert!((reach(Metric::touching(half)) - 24.5f64.sqrt()).abs() < 1e-14);
        assert!((Metric::EUCLIDEAN.reach(eighth) - 1.0).abs().max_element() < 1e-15);
    }
}
