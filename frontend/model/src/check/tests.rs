//! What the check refuses, what it lets through, and the box of a field.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::limits;

use super::*;
use crate::attribute::{AttributeGroup, Mixing, Precedence};
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::combine::{
    Clamp, Combinator, Complement, Difference, Intersection, Offset, RFunction, RFunctionOrder,
    RFunctionPower, Ricci, SetOperation, Shell, Sum, Union,
};
use crate::diagnostic::Severity;
use crate::diagnostic::Span;
use crate::falloff::Falloff;
use crate::kind::Primitive;
use crate::skeleton::{Cuboid, Disc, Point, Skeleton};
use crate::tree::Tree;
use crate::warp::Twist;

fn leaf(skeleton: impl Into<Skeleton>, radius: f64, strength: f64) -> Tree {
    let primitive = Primitive { skeleton: skeleton.into(), falloff: Falloff::Soft, radius, strength };
    Tree::new(NodeKind::Primitive(primitive), vec![])
}

fn point(x: f64) -> Tree {
    leaf(Point { at: DVec3::new(x, 0.0, 0.0) }, 1.0, 1.0)
}

fn combine(combinator: impl Into<Combinator>, children: Vec<Tree>) -> Tree {
    Tree::new(NodeKind::Combine(combinator.into()), children)
}

fn affine(map: DAffine3, child: Tree) -> Tree {
    Tree::new(NodeKind::Affine(map), vec![child])
}

fn attribute(name: &str, values: &[f64], child: Tree) -> Tree {
    Tree::new(
        NodeKind::Attribute {
            name: name.into(),
            value: values.to_vec().into(),
            precedence: Precedence::Nearest,
        },
        vec![child],
    )
}

fn group(name: &str, width: usize) -> AttributeGroup {
    AttributeGroup {
        name: name.into(),
        default: vec![0.0; width],
        mixing: Mixing::Blend,
        ..AttributeGroup::color()
    }
}

/// The messages of a model over `root`.
fn messages(root: Tree) -> Vec<String> {
    match Model::new(root).check() {
        Ok(_) => vec![],
        Err(errors) => errors.into_iter().map(|error| error.message).collect(),
    }
}

#[test]
fn refuses_numbers_and_children_that_make_no_sense() {
    let scaled = |x: f64, y: f64, z: f64| affine(DAffine3::from_scale(DVec3::new(x, y, z)), point(0.0));
    let singular = DMat3::from_cols_array(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
    let disc = |normal, radius| leaf(Disc { center: DVec3::ZERO, normal, radius }, 1.0, 1.0);
    let half = DVec3::new(1.0, -1.0, 1.0);
    let cases: Vec<(Tree, &str)> = vec![
        (leaf(Point { at: DVec3::new(0.0, f64::NAN, 0.0) }, 1.0, 1.0), "the `at` of the point is (0 NaN 0)"),
        (point(1.1e15), "the `at` of the point is (1100000000000000 0 0)"),
        (leaf(Point { at: DVec3::ZERO }, 0.0, 1.0), "the radius is 0"),
        (leaf(Point { at: DVec3::ZERO }, -2.0, 1.0), "the radius is -2"),
        (leaf(Point { at: DVec3::ZERO }, 1.0, f64::INFINITY), "the strength is inf"),
        (disc(DVec3::ZERO, 1.0), "the `normal` of the disc is (0 0 0)"),
        (disc(DVec3::X, -1.0), "the `radius` of the disc is -1"),
        (leaf(Cuboid { center: DVec3::ZERO, half }, 1.0, 1.0), "the `half` of the box is (1 -1 1)"),
        (
            Tree::new(NodeKind::Warp(Twist { axis: Axis::Z, rate: f64::NAN }.into()), vec![point(0.0)]),
            "the `rate` of the twist is NaN",
        ),
        (combine(Sum {}, vec![]), "a node `sum` has 0 children"),
        (combine(Difference {}, vec![]), "a node `difference` has 0 children"),
        (combine(Ricci { exponent: 0.5 }, vec![point(0.0)]), "the exponent of the Ricci blend is 0.5"),
        (combine(Ricci { exponent: 0.0 }, vec![point(0.0)]), "the exponent of the Ricci blend is 0"),
        (combine(Ricci { exponent: -0.5 }, vec![point(0.0)]), "the exponent of the Ricci blend is -0.5"),
        (combine(Ricci { exponent: -1025.0 }, vec![point(0.0)]), "the exponent of the Ricci blend is -1025"),
        (combine(Complement {}, vec![]), "a node `complement` has 0 children"),
        (combine(Shell { thickness: 0.1 }, vec![point(0.0); 2]), "a node `shell` has 2 children"),
        (combine(Shell { thickness: 1.0 }, vec![point(0.0)]), "the thickness of the shell is 1"),
        (combine(Shell { thickness: 0.0 }, vec![point(0.0)]), "the `thickness` of the shell is 0"),
        (combine(Offset { by: 0.5 }, vec![point(0.0)]), "the offset is 0.5"),
        (combine(Clamp { low: 1.0, high: 0.0 }, vec![point(0.0)]), "the clamp is from 1 to 0"),
        (
            combine(Combinator::smooth(SetOperation::Union, -1.0), vec![point(0.0)]),
            "the `width` of the smooth_union is -1",
        ),
        (
            combine(RFunction { set: SetOperation::Union, alpha: -1.0 }, vec![point(0.0)]),
            "the `alpha` of the rfunction is -1",
        ),
        (
            combine(RFunctionPower { set: SetOperation::Union, power: 1.0 }, vec![point(0.0)]),
            "the `power` of the rfunction is 1",
        ),
        (
            combine(RFunctionOrder { set: SetOperation::Union, order: 5 }, vec![point(0.0)]),
            "the `order` of the rfunction is 5",
        ),
        (combine(Ricci { exponent: 1025.0 }, vec![point(0.0)]), "the exponent of the Ricci blend is 1025"),
        (combine(Ricci { exponent: f64::NAN }, vec![point(0.0)]), "the `exponent` of the ricci is NaN"),
        (Tree::new(NodeKind::Affine(DAffine3::IDENTITY), vec![]), "an affine map has 0 children"),
        (Tree::new(point(0.0).node().written().clone(), vec![point(1.0)]), "a point has 1 children"),
        (scaled(1.0, 0.0, 1.0), "the affine map is singular: its reciprocal condition is 0.0e0"),
        (scaled(0.0, 0.0, 0.0), "the affine map is singular: its reciprocal condition is 0.0e0"),
        (scaled(1e14, 1.0, 1.0), "the affine map is singular: its reciprocal condition is 1.0e-14"),
        (scaled(1e-16, 1e-16, 1e-16), "the affine map shrinks 1.0e16 times"),
        (attribute("roughness", &[1.0], point(0.0)), "there is no attribute `roughness`"),
        (attribute("color", &[1.0, 0.5], point(0.0)), "the attribute `color` has width 3, not 2"),
        (attribute("color", &[1.0, f64::NAN, 0.5], point(0.0)), "the attribute `color` is (1 NaN 0.5)"),
    ];
    for (tree, expected) in cases {
        assert_eq!(messages(tree), [expected]);
    }
    let message = &messages(affine(DAffine3::from_mat3(singular), point(0.0)))[0];
    assert!(message.starts_with("the affine map is singular: "), "{message}");
}

#[test]
fn lets_the_extremes_through() {
    for scale in
        [DVec3::splat(1e-15), DVec3::splat(1e15), DVec3::new(-1.0, 1.0, 1e-6), DVec3::new(1e11, 1.0, 1.0)]
    {
        assert_eq!(messages(affine(DAffine3::from_scale(scale), point(0.0))), [""; 0]);
    }
    assert_eq!(messages(point(1e15)), [""; 0]);
    assert_eq!(messages(leaf(Point { at: DVec3::ZERO }, 1e-15, -1e15)), [""; 0]);
    for n in [1.0, 1024.0, -1.0, -1024.0] {
        assert_eq!(messages(combine(Ricci { exponent: n }, vec![point(0.0)])), [""; 0]);
    }
}

#[test]
fn reports_everything_in_the_order_of_the_text() {
    let bad = |start, radius| {
        let leaf = leaf(Point { at: DVec3::ZERO }, radius, 1.0);
        Tree::at(Span::new(start, start + 1), leaf.node().written().clone(), vec![])
    };
    let shared = bad(9, -9.0);
    let sum = vec![shared.clone(), bad(5, -5.0), shared];
    let root = Tree::at(Span::new(2, 30), NodeKind::Combine(Ricci { exponent: 0.0 }.into()), sum);
    let errors = Model::new(root).check().unwrap_err();
    let starts: Vec<_> = errors.iter().map(|error| error.span.unwrap().start).collect();
    assert_eq!(starts, [2, 5, 9], "the parent first, the shared leaf once");

    let many = |count| (0..count).map(|i| bad(i, -1.0)).collect();
    let errors = Model::new(combine(Sum {}, many(limits::MAX_ERRORS))).check().unwrap_err();
    assert_eq!(errors.len(), limits::MAX_ERRORS);
    let errors = Model::new(combine(Sum {}, many(limits::MAX_ERRORS + 2))).check().unwrap_err();
    assert_eq!(errors.len(), limits::MAX_ERRORS + 1);
    assert_eq!(errors.last().unwrap().message, "and 2 more errors");
}

#[test]
fn judges_the_model_itself() {
    let with = |iso: f64, attributes: Vec<AttributeGroup>| {
        let errors =
            Model { iso: iso.into(), attributes, ..Model::new(point(0.0)) }.check().err().unwrap_or_default();
        errors.into_iter().map(|error| (error.severity, error.message)).collect::<Vec<_>>()
    };
    let color = AttributeGroup::color;
    let error = |message: &str| vec![(Severity::Error, message.to_owned())];
    let limit = |message: &str| vec![(Severity::Limit, message.to_owned())];
    assert_eq!(with(0.0, vec![color()]), error("the iso-value is 0.0"));
    assert_eq!(with(-1.0, vec![color()]), error("the iso-value is -1"));
    assert_eq!(with(f64::NAN, vec![color()]), error("the iso-value is NaN"));
    assert_eq!(with(0.5, vec![]), error("the first attribute is not `color` with 3 reals"));
    assert_eq!(with(0.5, vec![group("color", 4)]), error("the first attribute is not `color` with 3 reals"));
    assert_eq!(with(0.5, vec![color(), color()]), error("two attributes are called `color`"));
    assert_eq!(with(0.5, vec![color(), group("1st", 1)]), error("an attribute is called `1st`"));
    assert_eq!(with(0.5, vec![color(), group("", 1)]), error("an attribute is called ``"));
    let message = "an attribute is called `field`, like another answer at a point";
    assert_eq!(with(0.5, vec![color(), group("field", 1)]), error(message));
    assert_eq!(with(0.5, vec![color(), group("uv", 0)]), error("the attribute `uv` has no reals"));
    assert_eq!(with(0.5, vec![color(), group("uv", 64)]), vec![]);
    assert_eq!(
        with(0.5, vec![color(), group("uv", 65)]),
        limit("the attribute `uv` has 65 reals; it may have 64")
    );
    let groups = |count: usize| {
        std::iter::once(color()).chain((1..count).map(|i| group(&format!("a{i}"), 1))).collect::<Vec<_>>()
    };
    assert_eq!(with(0.5, groups(32)), vec![]);
    assert_eq!(with(0.5, groups(33)), limit("33 attributes; there may be 32"));
}

#[test]
fn shared_nodes_stand_once_and_the_root_last() {
    let shared = attribute("color", &[0.0, 0.5, 1.0], point(0.0));
    let moved = affine(DAffine3::from_translation(DVec3::X), shared.clone());
    let checked = Model::new(combine(Difference {}, vec![moved, shared])).check().unwrap();
    assert_eq!(checked.nodes().len(), 4);
    assert_eq!(checked.root(), NodeId(3));
    assert_eq!(checked.node(NodeId(3)).children.to_vec(), [NodeId(2), NodeId(1)]);
    assert_eq!(checked.node(NodeId(1)).children.to_vec(), [NodeId(0)]);
}

#[test]
fn limits_hold_at_their_value_and_not_one_past_it() {
    let chain = |n: usize| (1..n).fold(point(0.0), |tree, _| combine(Sum {}, vec![tree]));
    assert!(Model::new(chain(100)).check_within(100, 100).is_ok());
    let errors = Model::new(chain(101)).check_within(100, 1000).unwrap_err();
    assert_eq!((errors.len(), errors[0].severity), (1, Severity::Limit));

    let times = |n, tree: &Tree| combine(Union {}, vec![tree.clone(); n]);
    // A root over n uses of a node over m leaves: 1 + n + n m uses.
    let many = |n, m| Model::new(times(n, &times(m, &point(0.0))));
    assert!(many(10, 20).check_within(100, 211).is_ok());
    let errors = many(10, 20).check_within(100, 210).unwrap_err();
    assert_eq!(errors[0].message, "unfolded, the tree has 211 nodes; it may have 210");
    assert_eq!(errors[0].severity, Severity::Limit);
    assert!(many(1999, 1999).check().is_ok());
    assert!(many(2000, 2000).check().is_err());
    // Sharing a long chain of nodes with one child each is as much to go through, though it has few leaves.
    let chains = |link: &dyn Fn(Tree) -> Tree| times(3000, &(0..3000).fold(point(0.0), |tree, _| link(tree)));
    for link in [&(|tree| combine(Sum {}, vec![tree])) as &dyn Fn(Tree) -> Tree, &|tree| {
        affine(DAffine3::from_translation(DVec3::X), tree)
    }] {
        let errors = Model::new(chains(link)).check().unwrap_err();
        assert_eq!(errors[0].message, "unfolded, the tree has 9003001 nodes; it may have 4000000");
    }

    // 2^200 leaves: counted without overflow.
    let doubled = (0..200).fold(point(0.0), |tree, _| times(2, &tree));
    let errors = Model::new(doubled).check().unwrap_err();
    assert_eq!(errors[0].message, "unfolded, the tree has more than 10^19 nodes; it may have 4000000");
}

fn support(root: Tree) -> Bounds {
    Model::new(root).check().unwrap().support()
}

fn between(min: [f64; 3], max: [f64; 3]) -> Bounds {
    Bounds::new(min.into(), max.into())
}

#[test]
fn the_box_of_each_kind_of_node() {
    let ends = || vec![point(0.0), point(1.5)];
    let hull = between([-1.0, -1.0, -1.0], [2.5, 1.0, 1.0]);
    assert_eq!(support(combine(Sum {}, ends())), hull);
    assert_eq!(support(combine(Ricci { exponent: 3.0 }, ends())), hull);
    assert_eq!(support(combine(Union {}, ends())), hull);
    assert_eq!(support(combine(Intersection {}, ends())), between([0.5, -1.0, -1.0], [1.0, 1.0, 1.0]));
    assert_eq!(support(combine(Difference {}, ends())), between([-1.0; 3], [1.0; 3]));
    let apart = combine(Intersection {}, vec![point(0.0), point(9.0)]);
    assert!(support(apart.clone()).is_empty());
    assert_eq!(support(combine(Union {}, vec![apart, point(0.0)])), between([-1.0; 3], [1.0; 3]));
    // The minimum of a negative field and zero is negative: it reaches beyond the other operand, and no
    // farther.
    let hole = leaf(Point { at: DVec3::new(1.5, 0.0, 0.0) }, 1.0, -1.0);
    let of_hole = between([0.5, -1.0, -1.0], [2.5, 1.0, 1.0]);
    assert_eq!(support(combine(Intersection {}, vec![point(0.0), hole])), of_hole);

    let map = DAffine3::from_scale_rotation_translation(
        DVec3::new(-2.0, 1.0, 1.0),
        glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
        DVec3::new(0.0, 0.0, 5.0),
    );
    let turned = support(affine(map, point(3.0)));
    // x from 2 to 4 became y from -8 to -4.
    assert!(turned.min.abs_diff_eq(DVec3::new(-1.0, -8.0, 4.0), 1e-12), "{turned:?}");
    assert!(turned.max.abs_diff_eq(DVec3::new(1.0, -4.0, 6.0), 1e-12), "{turned:?}");
    let twisted = Tree::new(NodeKind::Warp(Twist { axis: Axis::Z, rate: 1.0 }.into()), vec![point(2.0)]);
    let reach = 10f64.sqrt();
    assert_eq!(support(twisted), between([-reach, -reach, -1.0], [reach, reach, 1.0]));
}

#[test]
fn an_unbounded_box_stays_a_box() {
    let slab = between([f64::NEG_INFINITY, -1.0, 0.0], [f64::INFINITY, 1.0, f64::INFINITY]);
    let turned = crate::affine::map_bounds(
        &DAffine3::from_mat3(DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::NEG_Z)),
        slab,
    );
    assert_eq!(turned, between([-1.0, f64::NEG_INFINITY, f64::NEG_INFINITY], [1.0, f64::INFINITY, 0.0]));
}

#[test]
fn a_node_has_the_name_of_its_group_and_no_copy() {
    let attribute = NodeKind::Attribute {
        name: "color".into(),
        value: vec![0.0; 3].into(),
        precedence: Precedence::Nearest,
    };
    let tree = Tree::new(attribute, vec![point(0.0)]);
    let checked = Model::new(tree).check().unwrap();
    let NodeKind::Attribute { name: kept, .. } = &checked.node(checked.root()).kind else {
        panic!("an attribute")
    };
    assert!(Arc::ptr_eq(kept, &checked.attributes()[0].name));
}
