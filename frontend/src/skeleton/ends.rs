//! Two ends with radii: what cones and round cones are given by.

use glam::{DAffine3, DVec3};

use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue};

/// An axis from one point to another, and a radius at either.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ends {
    /// One end of the axis.
    pub from: DVec3,
    /// The other end of the axis.
    pub to: DVec3,
    /// The radius at `from`, at least 0.
    pub from_radius: f64,
    /// The radius at `to`, at least 0.
    pub to_radius: f64,
}

impl Ends {
    /// The parameters, with what the radius at `to` is if it is not written.
    pub(super) const fn fields(to_radius: Option<FieldValue>) -> [Field; 4] {
        [
            Field { name: "from", kind: FieldKind::Position, default: None },
            Field { name: "to", kind: FieldKind::Position, default: None },
            Field { name: "from_radius", kind: FieldKind::NonNegative, default: None },
            Field { name: "to_radius", kind: FieldKind::NonNegative, default: to_radius },
        ]
    }

    pub(super) fn from_fields(values: &[FieldValue]) -> Self {
        let ([from, to], [from_radius, to_radius]) =
            ([0, 1].map(|i: usize| values[i].vector().into()), [2, 3].map(|i: usize| values[i].real()));
        Self { from, to, from_radius, to_radius }
    }

    pub(super) fn to_fields(self) -> Vec<FieldValue> {
        let places = [self.from, self.to].map(|end| FieldValue::Vector(end.into()));
        places.into_iter().chain([self.from_radius, self.to_radius].map(FieldValue::Real)).collect()
    }

    /// How long the axis is.
    pub(super) fn length(&self) -> f64 {
        self.from.distance(self.to)
    }

    /// The box around the images of what is at the ends; `reach` says how far that of a radius reaches along each axis.
    pub(super) fn bounds_under(&self, map: &DAffine3, reach: impl Fn(f64) -> DVec3) -> Bounds {
        let around = |end: DVec3, radius: f64| {
            let (at, reach) = (map.transform_point3(end), reach(radius));
            Bounds::new(at - reach, at + reach)
        };
        around(self.from, self.from_radius).hull(around(self.to, self.to_radius))
    }
}
