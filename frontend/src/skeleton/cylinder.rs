//! The cylinder: a solid one, with flat ends.

use glam::DVec3;
use jbt_ir::Domain;

use super::SkeletonMember;
use crate::affine::Similarity;
use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue, Member};

/// A solid cylinder: the points within `radius` of its axis and between the planes of its ends.
///
/// With radius 0 it is a segment. Equal ends give no direction for the planes: then it is the ball of this radius.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Cylinder {
    /// One end of the axis.
    pub from: DVec3,
    /// The other end of the axis.
    pub to: DVec3,
    /// How far it reaches from the axis.
    pub radius: f64,
}

impl Cylinder {
    /// The middle of the axis, its direction (zero if the ends are equal) and half its length.
    fn axis(&self) -> (DVec3, DVec3, f64) {
        let along = self.to - self.from;
        (self.from.midpoint(self.to), super::unit(along), 0.5 * along.length())
    }
}

impl Member for Cylinder {
    const NAME: &'static str = "cylinder";
    const FIELDS: &'static [Field] = &[
        Field { name: "from", kind: FieldKind::Position, default: None },
        Field { name: "to", kind: FieldKind::Position, default: None },
        Field { name: "radius", kind: FieldKind::NonNegative, default: None },
    ];

    fn from_fields(values: &[FieldValue]) -> Self {
        Self { from: values[0].vector().into(), to: values[1].vector().into(), radius: values[2].real() }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        vec![FieldValue::Vector(self.from.into()), FieldValue::Vector(self.to.into()), FieldValue::Real(self.radius)]
    }
}

impl SkeletonMember for Cylinder {
    // Measured from the middle, both ends are one comparison.
    const COLUMNS: &'static [&'static str] = &["x", "y", "z", "ux", "uy", "uz", "half", "radius"];

    fn bounds(&self) -> Bounds {
        let direction = self.axis().1;
        let reach = super::circle_reach(direction, self.radius);
        let reach = if direction == DVec3::ZERO { DVec3::splat(self.radius) } else { reach };
        let ends = Bounds::around([self.from, self.to]);
        Bounds::new(ends.min - reach, ends.max + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let along = self.to - self.from;
        let length = along.length();
        let (h, rho) = super::cylindrical(p - self.from, super::unit(along));
        let a = h - h.clamp(0.0, length);
        a * a + (rho - self.radius).max(0.0).powi(2)
    }

    fn decision(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn moved(&self, similarity: &Similarity) -> Option<Self> {
        Some(Self {
            from: similarity.point(self.from),
            to: similarity.point(self.to),
            radius: similarity.scale() * self.radius,
        })
    }

    fn columns(&self, row: &mut Vec<f64>) {
        let (middle, direction, half) = self.axis();
        row.extend(middle.to_array());
        row.extend(direction.to_array());
        row.extend([half, self.radius]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let v = super::difference(d, p, [row[0], row[1], row[2]]);
        let (h, rho) = super::emit_cylindrical(d, v, [row[3], row[4], row[5]]);
        let past_ends = super::beyond(d, h, row[6]);
        let off = d.sub(rho, row[7]);
        let past_side = super::positive_part(d, off);
        super::sum_of_squares(d, past_side, past_ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let cylinder = Cylinder { from: DVec3::ZERO, to: DVec3::new(0.0, 4.0, 0.0), radius: 1.0 };
        for (p, expected) in [
            ([0.5, 2.0, 0.5], 0.0),
            ([3.0, 2.0, 0.0], 4.0),
            ([0.5, 7.0, 0.0], 9.0),
            ([0.0, -2.0, 0.5], 4.0),
            ([4.0, 8.0, 0.0], 25.0),
            ([0.0, -4.0, -4.0], 25.0),
        ] {
            testing::same_everywhere(&cylinder, p.into(), expected);
        }
    }

    #[test]
    fn the_degenerate_ones() {
        let axis = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 3.0)];
        let thin = Cylinder { from: axis[0], to: axis[1], radius: 0.0 };
        testing::same_everywhere(&thin, DVec3::new(3.0, 0.0, 7.0), 25.0);
        let ball = Cylinder { from: axis[0], to: axis[0], radius: 2.0 };
        testing::same_everywhere(&ball, DVec3::new(0.0, 6.0, 1.0), 16.0);
        assert_eq!(ball.bounds(), Bounds::new(DVec3::new(-2.0, -2.0, -1.0), DVec3::new(2.0, 2.0, 3.0)));
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let (from, to) = (testing::position(rng), testing::position(rng));
            let cylinder = Cylinder { from, to, radius: 2.0 * rng.f64() };
            let (e1, e2) = (to - from).normalize().any_orthonormal_pair();
            let samples = testing::polar(8, 48)
                .flat_map(|(r, turn)| {
                    let off = cylinder.radius * r * (turn.cos() * e1 + turn.sin() * e2);
                    (0..=40).map(move |i| from.lerp(to, f64::from(i) / 40.0) + off)
                })
                .collect();
            (cylinder, samples)
        });
    }
}
