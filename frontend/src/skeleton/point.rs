//! The point: the skeleton of a ball.

use glam::DVec3;
use jbt_ir::Domain;

use super::SkeletonMember;
use crate::affine::Similarity;
use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue, Member};

/// A point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Point {
    /// Where it is.
    pub at: DVec3,
}

impl Member for Point {
    const NAME: &'static str = "point";
    const FIELDS: &'static [Field] =
        &[Field { name: "at", kind: FieldKind::Position, default: Some(FieldValue::Vector([0.0; 3])) }];

    fn from_fields(values: &[FieldValue]) -> Self {
        Self { at: values[0].vector().into() }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        vec![FieldValue::Vector(self.at.into())]
    }
}

impl SkeletonMember for Point {
    const COLUMNS: &'static [&'static str] = &["x", "y", "z"];

    fn bounds(&self) -> Bounds {
        Bounds::new(self.at, self.at)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        (p - self.at).length_squared()
    }

    fn decision(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn moved(&self, similarity: &Similarity) -> Option<Self> {
        Some(Self { at: similarity.point(self.at) })
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.extend(self.at.to_array());
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let v = super::difference(d, p, [row[0], row[1], row[2]]);
        super::length_squared(d, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn agrees_with_the_set() {
        testing::judge(1e-9, |rng| {
            let at = testing::position(rng);
            (Point { at }, vec![at])
        });
    }
}
