//! Building trees in Rust: constructors for primitives, operators for combinators, postfix methods for everything that has one child.
//!
//! The peanut: two balls that grow together, each with its colour.
//!
//! ```
//! use jbt_frontend::builder::point;
//! use jbt_frontend::model::Model;
//! use jbt_frontend::walk::walk;
//!
//! let red = point([0.0, 0.4, 0.0], 1.0).color([1.0, 0.0, 0.0]);
//! let blue = point([0.0, -0.4, 0.0], 1.0).color([0.0, 0.0, 1.0]);
//! let peanut = Model::new(red + blue).check().unwrap();
//!
//! let sample = walk(&peanut, [0.0, 0.1, 0.0]);
//! assert!((sample.field - 1.294976).abs() < 1e-12);
//! assert!((sample.attributes[0][0] - 0.613892).abs() < 1e-6, "mostly red up here");
//! ```
//!
//! | Rust | node |
//! |---|---|
//! | `a + b` | sum: the plain blend |
//! | `a.ricci(n, &b)`, `Tree::blend(n, [a, b, c])` | Ricci's blend |
//! | `a \| b` | union |
//! | `a & b` | intersection |
//! | `a - b` | difference |
//!
//! Trees are shared, not copied: `&a + &a` has one leaf under two edges. Anything can be built; [`Model::check`](crate::model::Model::check)
//! says whether it makes sense.

use std::ops::{Add, BitAnd, BitOr, Sub};

use glam::{DAffine3, DMat3, DVec3};

use crate::affine;
use crate::combine::Combinator;
use crate::falloff::Falloff;
use crate::skeleton::{Box, Cylinder, Disc, Point, Ring, Segment, Skeleton, Triangle};
use crate::tree::{NodeKind, Primitive, Tree};
use crate::warp::Twist;

/// A primitive of strength 1 with the soft object's falloff; `radius` is where its field reaches zero.
#[must_use]
pub fn primitive(skeleton: impl Into<Skeleton>, radius: f64) -> Tree {
    let leaf = Primitive { skeleton: skeleton.into(), falloff: Falloff::Soft, radius, strength: 1.0 };
    Tree::new(NodeKind::Primitive(leaf), Vec::new())
}

/// A ball around a point.
#[must_use]
pub fn point(at: [f64; 3], radius: f64) -> Tree {
    primitive(Point { at: at.into() }, radius)
}

/// A capsule around the line between two points.
#[must_use]
pub fn segment(from: [f64; 3], to: [f64; 3], radius: f64) -> Tree {
    primitive(Segment { from: from.into(), to: to.into() }, radius)
}

/// A field around a filled circle of radius `disc_radius` that faces along `normal`.
#[must_use]
pub fn disc(center: [f64; 3], normal: [f64; 3], disc_radius: f64, radius: f64) -> Tree {
    primitive(Disc { center: center.into(), normal: normal.into(), radius: disc_radius }, radius)
}

/// A torus: a field around a circle of radius `ring_radius` about the axis `normal`.
#[must_use]
pub fn ring(center: [f64; 3], normal: [f64; 3], ring_radius: f64, radius: f64) -> Tree {
    primitive(Ring { center: center.into(), normal: normal.into(), radius: ring_radius }, radius)
}

/// A field around a solid cylinder between two end points of its axis.
#[must_use]
pub fn cylinder(from: [f64; 3], to: [f64; 3], cylinder_radius: f64, radius: f64) -> Tree {
    primitive(Cylinder { from: from.into(), to: to.into(), radius: cylinder_radius }, radius)
}

/// A field around a solid box along the axes; `half` are half its sides.
#[must_use]
pub fn cuboid(center: [f64; 3], half: [f64; 3], radius: f64) -> Tree {
    primitive(Box { center: center.into(), half: half.into() }, radius)
}

/// A field around a filled triangle.
#[must_use]
pub fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3], radius: f64) -> Tree {
    primitive(Triangle { a: a.into(), b: b.into(), c: c.into() }, radius)
}

impl Tree {
    /// A combinator over children, in order.
    #[must_use]
    pub fn combine(combinator: Combinator, children: impl IntoIterator<Item = Self>) -> Self {
        Self::new(NodeKind::Combine(combinator), children.into_iter().collect())
    }

    /// Ricci's blend with exponent `n` in [1, 1024]: 1 is the sum, large ones near the union.
    #[must_use]
    pub fn blend(n: f64, children: impl IntoIterator<Item = Self>) -> Self {
        Self::combine(Combinator::Ricci(n), children)
    }

    /// [`Tree::blend`] of two.
    #[must_use]
    pub fn ricci(&self, n: f64, other: &Self) -> Self {
        Self::blend(n, [self.clone(), other.clone()])
    }

    /// The same with this falloff in every primitive.
    #[must_use]
    pub fn falloff(&self, falloff: Falloff) -> Self {
        self.map_primitives(|leaf| leaf.falloff = falloff)
    }

    /// The same with this strength in every primitive; negative ones push surfaces away.
    #[must_use]
    pub fn strength(&self, strength: f64) -> Self {
        self.map_primitives(|leaf| leaf.strength = strength)
    }

    /// The same with every primitive changed.
    #[must_use]
    pub fn map_primitives(&self, mut change: impl FnMut(&mut Primitive)) -> Self {
        self.rewrite(|tree| match tree.node().kind() {
            NodeKind::Primitive(leaf) => {
                let mut leaf = leaf.clone();
                change(&mut leaf);
                Some(tree.with(NodeKind::Primitive(leaf), Vec::new()))
            }
            NodeKind::Combine(_) | NodeKind::Affine(_) | NodeKind::Warp(_) | NodeKind::Attribute { .. } => {
                None
            }
        })
    }

    /// Shifted.
    #[must_use]
    pub fn translate(&self, by: [f64; 3]) -> Self {
        self.mapped(DAffine3::from_translation(by.into()))
    }

    /// Turned about an axis through the origin, right-handed. Quarter turns are exact.
    #[must_use]
    pub fn rotate(&self, axis: [f64; 3], degrees: f64) -> Self {
        let axis = DVec3::from(axis).normalize();
        self.mapped(DAffine3::from_mat3(affine::rotation(axis, affine::sin_cos_degrees(degrees))))
    }

    /// Scaled about the origin.
    #[must_use]
    pub fn scale(&self, by: f64) -> Self {
        self.scale_axes([by; 3])
    }

    /// Scaled about the origin, by another factor along each axis; a negative one mirrors.
    #[must_use]
    pub fn scale_axes(&self, by: [f64; 3]) -> Self {
        self.mapped(DAffine3::from_scale(by.into()))
    }

    /// Mapped by a 3x4 matrix, given by rows, that takes this tree's space to its parent's: the last column is the shift.
    #[must_use]
    pub fn affine(&self, rows: [[f64; 4]; 3]) -> Self {
        let [x, y, z, shift] = [0, 1, 2, 3].map(|column| DVec3::from_array(rows.map(|row| row[column])));
        self.mapped(DAffine3::from_mat3_translation(DMat3::from_cols(x, y, z), shift))
    }

    fn mapped(&self, map: DAffine3) -> Self {
        Self::new(NodeKind::Affine(map), vec![self.clone()])
    }

    /// Twisted about a coordinate axis through the origin, by `rate` radians for each unit of length, right-handed.
    #[must_use]
    pub fn twist(&self, axis: Axis, rate: f64) -> Self {
        Self::new(NodeKind::Warp(Twist { axis: axis as u8, rate }.into()), vec![self.clone()])
    }

    /// Coloured: linear red, green and blue for every leaf below that has no nearer colour.
    #[must_use]
    pub fn color(&self, rgb: [f64; 3]) -> Self {
        self.attribute("color", &rgb)
    }

    /// With an attribute for every leaf below that has no nearer one of this name.
    #[must_use]
    pub fn attribute(&self, name: &str, values: &[f64]) -> Self {
        Self::new(NodeKind::Attribute { name: name.into(), values: values.to_vec() }, vec![self.clone()])
    }
}

/// A coordinate axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

macro_rules! operators {
    ($($trait:ident $method:ident $combinator:ident),+ $(,)?) => { $(
        operators! { @ Tree, Tree, $trait $method $combinator }
        operators! { @ Tree, &Tree, $trait $method $combinator }
        operators! { @ &Tree, Tree, $trait $method $combinator }
        operators! { @ &Tree, &Tree, $trait $method $combinator }
    )+ };
    (@ $left:ty, $right:ty, $trait:ident $method:ident $combinator:ident) => {
        impl $trait<$right> for $left {
            type Output = Tree;

            fn $method(self, other: $right) -> Tree {
                Tree::combine(Combinator::$combinator, [self.clone(), other.clone()])
            }
        }
    };
}

operators! {
    Add add Sum,
    BitOr bitor Union,
    BitAnd bitand Intersection,
    Sub sub Difference,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::walk::walk;

    fn field(tree: &Tree, p: [f64; 3]) -> f64 {
        walk(&Model::new(tree.clone()).check().unwrap(), p).field
    }

    #[test]
    fn operators_take_trees_and_references() {
        let (a, b) = (point([0.0; 3], 1.0), point([0.5, 0.0, 0.0], 1.0));
        let expected = Tree::combine(Combinator::Union, [a.clone(), b.clone()]);
        for tree in [&a | &b, a.clone() | &b, &a | b.clone(), a.clone() | b.clone()] {
            assert_eq!(tree, expected);
        }
        let kinds = [
            (&a + &b, Combinator::Sum),
            (&a & &b, Combinator::Intersection),
            (&a - &b, Combinator::Difference),
        ];
        for (tree, combinator) in kinds {
            assert_eq!(tree, Tree::combine(combinator, [a.clone(), b.clone()]));
            assert_eq!(tree.node().children()[0].identity(), a.identity(), "shared, not copied");
        }
        assert_eq!(a.ricci(3.0, &b), Tree::blend(3.0, [a.clone(), b.clone()]));
    }

    #[test]
    fn postfix_methods_move_the_solid() {
        // The field is 1 at a point skeleton, and only there: this is where the maps take (1, 2, 3).
        let start = point([1.0, 2.0, 3.0], 1.0);
        let rows = [[0.0, 0.0, 1.0, 10.0], [0.0, 2.0, 0.0, 20.0], [1.0, 0.0, 0.0, 30.0]];
        for (tree, there) in [
            (start.translate([1.0, 1.0, 1.0]), [2.0, 3.0, 4.0]),
            (start.rotate([0.0, 0.0, 5.0], 90.0), [-2.0, 1.0, 3.0]),
            (start.rotate([-1.0, 0.0, 0.0], 90.0), [1.0, 3.0, -2.0]),
            (start.scale(2.0), [2.0, 4.0, 6.0]),
            (start.scale_axes([-1.0, 0.5, 1.0]), [-1.0, 1.0, 3.0]),
            (start.affine(rows), [13.0, 24.0, 31.0]),
            (start.twist(Axis::Z, std::f64::consts::FRAC_PI_6), [-2.0, 1.0, 3.0]),
            (start.translate([1.0, 0.0, 0.0]).scale(3.0), [6.0, 6.0, 9.0]),
        ] {
            assert!((field(&tree, there) - 1.0).abs() < 1e-15, "{:?}", tree.node().kind());
        }
    }

    #[test]
    fn falloff_and_strength_reach_every_primitive() {
        let ball = point([0.0; 3], 1.0);
        let both = (&ball + &ball).falloff(Falloff::Wyvill).strength(-2.0);
        assert_eq!(
            both.node().children()[0].identity(),
            both.node().children()[1].identity(),
            "still shared"
        );
        assert_eq!(field(&both, [0.5, 0.0, 0.0]), -4.0 * 0.75f64.powi(3));
    }

    #[test]
    fn every_constructor_makes_its_skeleton() {
        let (o, x, y) = ([0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
        // Each at half its radius from a known point of the skeleton, where the soft object's field is 1/2.
        for (tree, p) in [
            (segment(o, x, 2.0), [3.0, 1.0, 0.0]),
            (disc(o, [0.0, 0.0, 3.0], 1.0, 2.0), [2.0, 0.0, 0.0]),
            (ring(o, [0.0, 0.0, 3.0], 3.0, 2.0), [0.0, 2.0, 0.0]),
            (cylinder(o, x, 1.0, 2.0), [2.0, 0.0, 2.0]),
            (cuboid(x, [1.0, 2.0, 3.0], 2.0), [4.0, 3.0, -2.0]),
            (triangle(o, x, y, 2.0), [1.0, 1.0, -1.0]),
        ] {
            assert!((field(&tree, p) - 0.5).abs() < 1e-15, "{:?}", tree.node().kind());
        }
    }
}
