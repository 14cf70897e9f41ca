//! The twist: slices across an axis turn in proportion to their height (Barr 1984).
//!
//! At height h along the axis the child appears turned by `rate * h` radians, right-handed about the axis. Volumes stay.

use glam::DVec3;
use jbt_ir::Domain;

use super::{Growth, WarpMember};
use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue, Member};

/// A twist about an axis through the origin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Twist {
    /// The axis: 0 is x, 1 is y, 2 is z.
    pub axis: u8,
    /// Radians for each unit of length along the axis.
    pub rate: f64,
}

impl Twist {
    /// The axis and the two coordinates that turn, in right-handed order.
    const fn order(axis: u8) -> [usize; 3] {
        let a = axis as usize;
        [a, (a + 1) % 3, (a + 2) % 3]
    }

    /// A box, turned by every angle, and `stretch` times as far from the axis.
    fn turned(&self, child: Bounds, stretch: f64) -> Bounds {
        let [_, u, v] = Self::order(self.axis);
        let reach = |axis: usize| child.min[axis].abs().max(child.max[axis].abs());
        let radius = reach(u).hypot(reach(v)) * stretch;
        let mut turned = child;
        for axis in [u, v] {
            turned.min[axis] = -radius;
            turned.max[axis] = radius;
        }
        turned
    }
}

impl Member for Twist {
    const NAME: &'static str = "twist";
    const FIELDS: &'static [Field] = &[
        Field { name: "axis", kind: FieldKind::Axis, default: Some(FieldValue::Vector([0.0, 0.0, 1.0])) },
        Field { name: "rate", kind: FieldKind::Real, default: None },
    ];

    fn from_fields(values: &[FieldValue]) -> Self {
        let axis = values[0].vector();
        let axis = if axis[0] != 0.0 { 0 } else if axis[1] != 0.0 { 1 } else { 2 };
        Self { axis, rate: values[1].real() }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        let axis = DVec3::AXES[self.axis as usize];
        vec![FieldValue::Vector(axis.into()), FieldValue::Real(self.rate)]
    }
}

impl WarpMember for Twist {
    const COLUMNS: &'static [&'static str] = &["rate"];

    fn inverse(&self, p: DVec3) -> DVec3 {
        let [h, u, v] = Self::order(self.axis);
        let (sin, cos) = (self.rate * p[h]).sin_cos();
        let mut q = p;
        q[u] = cos * p[u] + sin * p[v];
        q[v] = cos * p[v] - sin * p[u];
        q
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        if child.is_empty() || self.rate == 0.0 {
            return child;
        }
        // Whatever the angle, a point keeps its height and its distance to the axis.
        self.turned(child, 1.0)
    }

    /// Whatever the angle, and whatever rounding made of it, the computed sine and cosine are those of one angle, each off by less than
    /// 2 units of 2^-24; a product, and a fused step over it, add a unit each. So the distance to the axis is off by less than 2^-20
    /// of itself (and the underflow of a product, below 2^-140), while the height is kept to the bit. A twist whose rate is zero
    /// in f32 keeps everything.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() || self.rate == 0.0 {
            return child;
        }
        self.turned(child, 1.0 + 2f64.powi(-20))
    }

    fn growth(&self, largest: f64) -> Growth {
        // A coordinate is at most sqrt(2) times as large; it moves with the two that turn, and with the height.
        let coordinates = 1.5 * largest;
        Growth { coordinates, derivatives: 2.0 + 2.0 * self.rate.abs() * coordinates }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.push(self.rate);
    }

    fn variant(&self) -> u8 {
        self.axis
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [h, u, v] = Self::order(variant);
        let angle = d.mul(row[0], p[h]);
        let (sin, cos) = (d.sin(angle), d.cos(angle));
        let mut q = p;
        let sv = d.mul(sin, p[v]);
        q[u] = d.fma(cos, p[u], sv);
        let su = d.mul(sin, p[u]);
        let minus = d.neg(su);
        q[v] = d.fma(cos, p[v], minus);
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_after_one_unit() {
        let twist = Twist { axis: 2, rate: std::f64::consts::FRAC_PI_2 };
        // What appears at +y at height 1 is what the child has at +x.
        assert!(twist.inverse(DVec3::new(0.0, 1.0, 1.0)).abs_diff_eq(DVec3::new(1.0, 0.0, 1.0), 1e-15));
    }

    #[test]
    fn the_box_holds_every_turned_point() {
        let child = Bounds::new(DVec3::new(1.0, -0.5, -2.0), DVec3::new(2.0, 0.25, 3.0));
        for axis in 0..3 {
            let bounds = Twist { axis, rate: 1.3 }.forward_bounds(child);
            let back = Twist { axis, rate: -1.3 };
            for corner in child.corners() {
                let p = back.inverse(corner);
                assert!(p.cmpge(bounds.min - 1e-12).all() && p.cmple(bounds.max + 1e-12).all());
            }
        }
    }
}
