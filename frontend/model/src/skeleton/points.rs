//! Lists of points and radii, shared by skeletons of any number of points, and their faults.

use glam::{DAffine3, DVec3};

use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;

/// Points in order, and a path along them: thin, or a tube of all balls with middles on the path.
#[derive(Clone, Copy)]
pub(super) struct Path<'a> {
    /// The points, at least two.
    pub(super) points: &'a [DVec3],
    /// Radii of at least 0: none if it is thin, one for all points, or one for each.
    pub(super) radii: &'a [f64],
    /// Whether it leads on from the last point to the first.
    pub(super) closed: bool,
}

impl Path<'_> {
    /// The radius at a point.
    pub(super) fn radius_at(&self, index: usize) -> f64 {
        match *self.radii {
            [] => 0.0,
            [only] => only,
            ref each => each.get(index).copied().unwrap_or(0.0),
        }
    }

    /// The indices of the first and the last point of each step.
    pub(super) fn steps(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let count = self.points.len();
        let steps = if self.closed { count } else { count.saturating_sub(1) };
        (0..steps).map(move |first| [first, (first + 1) % count])
    }

    /// The fault of the path, if it has one; it needs at least `least` points.
    pub(super) fn fault(&self, owner: &str, least: usize) -> Option<Diagnostic> {
        fault(owner, self.points, self.radii, least)
    }
}

/// The translation to the middle of the points, the origin of their pose.
pub(super) fn middle(points: &[DVec3]) -> DAffine3 {
    let bounds = Bounds::around(points.iter().copied());
    DAffine3::from_translation(if bounds.is_empty() { DVec3::ZERO } else { bounds.min.midpoint(bounds.max) })
}

/// The fault of the numbers of points and radii, or of points that are all equal.
pub(super) fn fault(owner: &str, points: &[DVec3], radii: &[f64], least: usize) -> Option<Diagnostic> {
    let count = points.len();
    if count < least {
        let plural = if count == 1 { "" } else { "s" };
        let error = Diagnostic::error(None, format!("the {owner} has {count} point{plural}"));
        return Some(error.expected(format!("expected at least {least}")));
    }
    if ![0, 1, count].contains(&radii.len()) {
        let message = format!("the {owner} has {count} points and {} radii", radii.len());
        let help = format!("expected no radii, one for all points, or {count}");
        return Some(Diagnostic::error(None, message).expected(help));
    }
    if points.iter().all(|point| *point == points[0]) {
        let error = Diagnostic::error(None, format!("the {owner} has no length: all its points are equal"));
        return Some(error.expected("expected two that differ, or a `point`"));
    }
    None
}

/// A nearest place of a part of a skeleton.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearestPlace {
    /// The distance from it, below zero inside.
    pub(super) distance: f64,
    /// The point of the skeleton that the direction leads to.
    pub(super) foot: DVec3,
    /// Below about 1/2, the foot moves much faster than the point: the gradient turns quickly.
    pub(super) firmness: f64,
}

/// The smallest distance, squared: zero inside.
pub(super) fn distance_squared(places: impl IntoIterator<Item = NearestPlace>) -> f64 {
    let nearest = places.into_iter().map(|place| place.distance).fold(f64::INFINITY, f64::min);
    nearest.max(0.0).powi(2)
}

/// How much nearer the nearest place is than the next one in another direction.
pub(super) fn kink_distance(places: &[NearestPlace]) -> f64 {
    let Some(best) = places.iter().min_by(|a, b| a.distance.total_cmp(&b.distance)) else {
        return f64::INFINITY;
    };
    if best.distance <= 0.0 {
        return f64::INFINITY;
    }
    if best.firmness < 0.5 {
        return 0.0;
    }
    // Where the distance is flat, the search finds the distance to all digits but the place to half of them.
    let other =
        |place: &&NearestPlace| place.foot.distance(best.foot) > 1e-5 * (best.distance + best.foot.length());
    places.iter().filter(other).map(|place| place.distance - best.distance).fold(f64::INFINITY, f64::min)
}
