//! The box: a solid one, along the axes of its own space.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::affine::map_bounds;
use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue, Member};

/// A solid box along the axes. Half sizes of 0 make it a rectangle, a segment or a point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Box {
    /// Its middle.
    pub center: DVec3,
    /// How far it reaches from the middle along each axis: half its sides.
    pub half: DVec3,
}

impl Member for Box {
    const NAME: &'static str = "box";
    const FIELDS: &'static [Field] = &[
        Field { name: "center", kind: FieldKind::Position, default: Some(FieldValue::Vector([0.0; 3])) },
        Field { name: "half", kind: FieldKind::Extents, default: None },
    ];

    fn from_fields(values: &[FieldValue]) -> Self {
        Self { center: values[0].vector().into(), half: values[1].vector().into() }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        vec![FieldValue::Vector(self.center.into()), FieldValue::Vector(self.half.into())]
    }
}

impl SkeletonMember for Box {
    const COLUMNS: &'static [&'static str] = &["half_x", "half_y", "half_z"];
    const SYMMETRY: Symmetry = Symmetry::None;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        map_bounds(map, Bounds::new(self.center - self.half, self.center + self.half))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        ((p - self.center).abs() - self.half).max(DVec3::ZERO).length_squared()
    }

    fn decision(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.extend((scale * self.half).to_array());
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let outside = [0, 1, 2].map(|k| super::beyond(d, p[k], row[k]));
        super::length_squared(d, outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let cuboid = Box { center: DVec3::new(1.0, 0.0, 0.0), half: DVec3::new(1.0, 2.0, 3.0) };
        for (p, expected) in
            [([0.5, -1.5, 2.5], 0.0), ([5.0, 0.0, 0.0], 9.0), ([-2.0, 4.0, -9.0], 44.0), ([1.0, 2.0, 3.0], 0.0)]
        {
            testing::same_everywhere(&cuboid, p.into(), expected);
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let half = DVec3::new(rng.f64(), 2.0 * rng.f64(), 3.0 * rng.f64());
            let cuboid = Box { center: testing::position(rng), half };
            let tick = |i: i32| f64::from(i % 21) / 10.0 - 1.0;
            let samples = (0..21 * 21 * 21)
                .map(|i| cuboid.center + half * DVec3::new(tick(i), tick(i / 21), tick(i / 441)))
                .collect();
            (cuboid, samples)
        });
    }
}
