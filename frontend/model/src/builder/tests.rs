//! Builders make the trees that they say.

use super::*;
use crate::combine::{Combinator, Difference, Intersection, Sum, Union};
use crate::falloff::Falloff;
use crate::model::Model;
use crate::walk::walk;

fn field(tree: &Tree, p: [f64; 3]) -> f64 {
    walk(&Model::new(tree.clone()).check().unwrap(), p).field
}

#[test]
fn operators_take_trees_and_references() {
    let (a, b) = (point([0.0; 3], 1.0), point([0.5, 0.0, 0.0], 1.0));
    let expected = Tree::combine(Combinator::Union(Union {}), [a.clone(), b.clone()]);
    for tree in [&a | &b, a.clone() | &b, &a | b.clone(), a.clone() | b.clone()] {
        assert_eq!(tree, expected);
    }
    let kinds = [
        (&a + &b, Combinator::Sum(Sum {})),
        (&a & &b, Combinator::Intersection(Intersection {})),
        (&a - &b, Combinator::Difference(Difference {})),
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
        (start.reflect([0.0, 0.0, -5.0]), [1.0, 2.0, -3.0]),
        (start.reflect([1.0, -1.0, 0.0]), [2.0, 1.0, 3.0]),
        (start.stretch([0.0, 2.0, 0.0], -1.5), [1.0, -3.0, 3.0]),
        (start.stretch([1.0, 1.0, 0.0], 3.0), [4.0, 5.0, 3.0]),
        (start.shear([0.0, 0.0, 9.0], [0.5, -1.0, 0.0]), [2.5, -1.0, 3.0]),
        (start.twist(Axis::Z, std::f64::consts::FRAC_PI_6), [-2.0, 1.0, 3.0]),
        (start.taper(Axis::Z, 1.0, 5.0, 1.0, 0.0), [0.5, 1.0, 3.0]),
        // The spine ends at 2 here, so the point turns about the centre of curvature by 2 * 0.25.
        (start.bend(Axis::X, 0.25, -9.0, 9.0, 0), [1.0, 0.5f64.sin(), 4.0 - 0.5f64.cos()]),
        (start.bend(Axis::X, 0.25, -9.0, 9.0, 2.0), [1.0, 2.0, 3.0]),
        (start.mirror(Axis::Y), [1.0, -2.0, 3.0]),
        (start.repeat(Axis::X, 8.0, 3.0), [17.0, 2.0, 3.0]),
        (start.repeat(Axis::Z, 8.0, 0.0), [1.0, 2.0, -21.0]),
        (start.repeat_around(Axis::Z, 2.0), [-1.0, -2.0, 3.0]),
        (start.space_map([1.0, 2.0, 3.0], [1.5, 2.0, 3.0], 4.0), [1.5, 2.0, 3.0]),
        (start.translate([1.0, 0.0, 0.0]).scale(3.0), [6.0, 6.0, 9.0]),
    ] {
        assert!((field(&tree, there) - 1.0).abs() < 1e-15, "{:?}", tree.node().written());
    }
}

#[test]
fn falloff_and_strength_reach_every_primitive() {
    let ball = point([0.0; 3], 1.0);
    let both = (&ball + &ball).falloff(Falloff::Wyvill).strength(-2.0);
    assert_eq!(both.node().children()[0].identity(), both.node().children()[1].identity(), "still shared");
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
        (polyline([o, x, y], 2.0), [2.0, 2.0, 1.0]),
        (polyline([o, x, y], 2.0).closed(), [0.0, 2.0, -1.0]),
        (polyline([o, x, y], 2.0).radii([0.5]), [2.0, -1.5, 0.0]),
        (polygon([o, x, y], 2.0), [1.0, 1.0, -1.0]),
        (bezier([o, x, x, x], 2.0), [2.0, 0.0, 1.0]),
        (catmull_rom([o, x], 2.0).radii([1.0, 1.0]), [2.0, 0.0, 2.0]),
        (sphere(x, 1.0, 2.0), [4.0, -2.0, 0.0]),
        (torus(o, [0.0, 0.0, 3.0], 3.0, 1.0, 2.0), [3.0, 0.0, 2.0]),
        (cone(o, x, 3.0, 0.0, 2.0), [-1.0, 2.0, 0.0]),
        (round_cone(o, x, 3.0, 1.0, 2.0), [-4.0, 0.0, 0.0]),
        (rectangle(o, [0.0, 0.0, 3.0], y, 3.0, 1.0, 2.0), [0.0, 4.0, 0.0]),
        (arc(o, [0.0, 0.0, 3.0], x, 90.0, 3.0, 2.0), [0.0, 4.0, 0.0]),
        (helix(o, [0.0, 0.0, 3.0], x, 3.0, 4.0, 2.0, 2.0), [0.0, 4.0, 1.0]),
        (half_space(x, y, 2.0), [-9.0, 1.0, 5.0]),
        (ellipsoid(x, [2.0, 1.0, 1.0], 2.0), [6.0, 0.0, 0.0]),
        (lmetric(o, 1.0, [1.0, 2.0, 1.0], 2.0), [0.5, 0.5, 0.25]),
        (superquadric(o, 2.0, 1.0, [1.0; 3], 4.0), [0.6, 0.8, 1.0]),
    ] {
        assert!((field(&tree, p) - 0.5).abs() < 1e-15, "{:?}", tree.node().written());
    }
}
