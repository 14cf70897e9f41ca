//! Warps in models: their gradients, their rows, their parameters, and what others get wrong about them.

use glam::DVec3;
use jbt_ir::{Tables, Verified};
use jbt_lower::{Lowered, lower};
use jbt_model::builder::{Axis, param, point, segment};
use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_model::walk::{walk, walk_gradient};
use jbt_model::warp::WarpKind;
use jbt_testkit::random::Random;
use jbt_testkit::scene::{self, assert_reads_back, checked, run};
use jbt_text::print;

/// The program of the field and its gradient.
fn compiled(tree: &CheckedTree) -> (Verified, Tables) {
    scene::compiled(tree, Query::GRADIENT)
}

fn gradient(program: &(Verified, Tables), p: DVec3) -> DVec3 {
    DVec3::from_slice(&run(program, p.into())[1..])
}

fn blob(random: &mut Random) -> Tree {
    let [a, b, c, d] = [(); 4].map(|()| random.vector(0.8));
    point(a, 1.2) + segment(b, c, 0.8) + point(d, 0.9)
}

#[test]
fn gradients_are_differences_of_the_oracle() {
    let mut random = Random::new(1, 1);
    for &kind in WarpKind::ALL {
        let mut compared = 0;
        for _ in 0..2000 {
            if compared >= 1500 {
                break;
            }
            let warp = NodeKind::Warp(kind.from_fields(&random.fields(kind.fields())));
            let blob = Tree::new(NodeKind::Affine(random.affine()), vec![blob(&mut random)]);
            let warped = Tree::new(warp, vec![blob]).rotate(random.vector(1.0), 50.0);
            let tree = checked(warped);
            let program = compiled(&tree);
            for _ in 0..40 {
                let p = DVec3::from(random.vector(1.5)).as_vec3().as_dvec3();
                let sample = walk(&tree, p.into());
                if sample.kink_distance < 2e-3 || sample.field < 1e-3 {
                    continue;
                }
                let expected = DVec3::from(walk_gradient(&tree, p.into(), 1e-6));
                let coarse = DVec3::from(walk_gradient(&tree, p.into(), 4e-6));
                let size = 1.0 + expected.length();
                if size > 100.0 || expected.distance(coarse) > 1e-5 * size {
                    continue;
                }
                let found = gradient(&program, p);
                assert!(
                    found.distance(expected) < 1e-3 * size,
                    "{found} at {p}, differences {expected}\n{}",
                    print(&Model::new(Tree::new(tree.node(tree.root()).kind.clone(), Vec::new())))
                );
                compared += 1;
            }
        }
        assert!(compared >= 1500, "{}: {compared} points", kind.name());
    }
}

/// Any warp under the weight of another subtree, which has several leaves, and operators, of its own.
#[test]
fn gradients_of_weighted_warps_are_differences_of_the_oracle() {
    let mut random = Random::new(2, 2);
    let mut compared = 0;
    for index in 0..300 {
        let kind = WarpKind::ALL[index % WarpKind::ALL.len()];
        let warp = NodeKind::Warp(kind.from_fields(&random.fields(kind.fields())));
        let weight = Tree::new(NodeKind::Affine(random.affine()), vec![blob(&mut random)]);
        let warped = Tree::new(warp, vec![blob(&mut random), weight]).rotate(random.vector(1.0), 50.0);
        let tree = checked(warped);
        let program = compiled(&tree);
        for _ in 0..40 {
            let p = DVec3::from(random.vector(1.2)).as_vec3().as_dvec3();
            let sample = walk(&tree, p.into());
            let expected = DVec3::from(walk_gradient(&tree, p.into(), 1e-6));
            let coarse = DVec3::from(walk_gradient(&tree, p.into(), 4e-6));
            let size = 1.0 + expected.length();
            if sample.kink_distance < 2e-3 || size > 100.0 || expected.distance(coarse) > 1e-5 * size {
                continue;
            }
            let found = gradient(&program, p);
            assert!(
                found.distance(expected) < 1e-3 * size,
                "{} at {p}: {found}, differences {expected}",
                kind.name()
            );
            compared += 1;
        }
    }
    assert!(compared > 2000, "{compared} points");
}

/// A weight that several warps and the model itself use is computed once, in front of them.
#[test]
fn a_shared_weight_is_computed_once() {
    let weight = point([0.0; 3], 1.0) + point([0.5, 0.0, 0.0], 1.0);
    let bar = segment([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.5);
    let twisted = bar.twist(Axis::X, 1.0).weighted(&weight);
    let both = twisted.color([1.0, 0.0, 0.0])
        + bar.mirror(Axis::Z).weighted(&weight)
        + twisted.color([0.0, 0.0, 1.0]);
    let tree = checked(both | weight);
    let Lowered { function, tables } = lower(&tree, Query::ALL).unwrap();
    let points =
        function.tables.values().zip(tables.tables.values()).filter(|(schema, _)| schema.name == "point");
    assert_eq!(points.map(|(_, rows)| rows.len()).sum::<usize>(), 2, "{function}");
    assert_eq!(function.to_string().matches("= sin").count(), 1, "one twist\n{function}");
    for p in [[0.2, 0.1, 0.3], [0.9, -0.2, 0.1], [1.2, 0.1, 0.0]] {
        let (found, expected) = (gradient(&compiled(&tree), p.into()), walk_gradient(&tree, p, 1e-6));
        assert!(found.abs_diff_eq(expected.into(), 1e-3), "{found} at {p:?}, differences {expected:?}");
    }
}

#[test]
fn a_weighted_warp_is_still_where_its_weight_is_zero() {
    let bar = segment([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], 0.5);
    let tree = checked(bar.bend(Axis::Y, 0.7, -2.0, 2.0, 0).weighted(&point([0.0; 3], 1.0)));
    let (weighted, plain) = (compiled(&tree), compiled(&checked(bar)));
    for p in [[1.5, 0.1, 0.2], [-1.9, -0.3, 0.1], [0.0, 1.1, 0.0]] {
        assert_eq!(gradient(&weighted, p.into()), gradient(&plain, p.into()), "at {p:?}");
    }
    let Lowered { function, .. } = lower(&tree, Query::FIELD).unwrap();
    assert_eq!(function.tables.len(), 1, "nothing but the scene: it needs no fold");
    let moved = point([0.0; 3], 1.0).translate([1.0; 3]).weighted(&point([0.0; 3], 1.0));
    let errors = Model::new(moved).check().expect_err("a map has one child");
    assert_eq!(errors[0].message, "an affine map has 2 children");
}

/// three-js-blobtree forgets to divide the gradient of a scaled child by the scale.
#[test]
fn the_gradient_of_a_scale_is_divided_by_it() {
    let ball = point([0.0; 3], 1.0);
    let at = DVec3::new(0.3, 0.1, -0.2);
    let plain = gradient(&compiled(&checked(ball.clone())), at);
    let scaled = gradient(&compiled(&checked(ball.scale(4.0))), 4.0 * at);
    assert!(scaled.abs_diff_eq(plain / 4.0, 1e-6), "{scaled}");
    let stretched =
        gradient(&compiled(&checked(ball.stretch([0.0, 1.0, 0.0], 4.0))), at * DVec3::new(1.0, 4.0, 1.0));
    assert!(stretched.abs_diff_eq(plain / DVec3::new(1.0, 4.0, 1.0), 1e-6), "{stretched}");
}

#[test]
fn gradients_are_finite_where_warps_are_singular() {
    let ball = point([0.0; 3], 1.0) + segment([0.0; 3], [0.0, 0.0, 2.0], 0.8);
    for (tree, places) in [
        (ball.twist(Axis::Z, 2.0), [[0.0; 3], [0.0, 0.0, 1.0]]),
        (ball.taper(Axis::Z, 0.0, 1.0, 1.0, 0.0), [[0.0, 0.0, 1.0], [0.0, 0.0, 1.5]]),
        (ball.bend(Axis::X, 1.0, -1.0, 1.0, 0), [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0 + 1e-7]]),
        (ball.mirror(Axis::X), [[0.0; 3], [0.0, 0.1, 0.1]]),
        (ball.repeat(Axis::X, 1.0, 0.0), [[0.5, 0.0, 0.0], [-1.5, 0.1, 0.0]]),
        (ball.repeat_around(Axis::Z, 5.0), [[0.0; 3], [-0.5, 0.0, 0.0]]),
        (ball.space_map([0.0; 3], [0.0, 0.2, 0.0], 1.0), [[0.0, 0.2, 0.0], [0.0, 1.2, 0.0]]),
    ] {
        let program = compiled(&checked(tree));
        for p in places {
            let found = gradient(&program, p.into());
            assert!(found.is_finite(), "{found} at {p:?}");
        }
    }
}

#[test]
fn warps_of_a_kind_are_rows_of_a_table() {
    let ball = |x: f64| point([x, 0.0, 0.0], 1.0);
    let bends = (1..6).map(|i| ball(f64::from(i)).bend(Axis::Y, 0.1 * f64::from(i), -1.0, 1.0, 0));
    let other = ball(3.0).bend(Axis::Z, 0.5, -1.0, 1.0, 0);
    let sum = bends.fold(other, |all, bend| all + bend);
    let Lowered { function, tables } = lower(&checked(sum), Query::FIELD).unwrap();
    let rows: Vec<(&str, usize)> = function
        .tables
        .values()
        .zip(tables.tables.values())
        .map(|(schema, rows)| (&*schema.name, rows.len()))
        .collect();
    assert_eq!(rows, [("scene", 1), ("bend", 1), ("bend", 5)]);
}

/// A warp that several lead into, with different colours, has its point computed once.
#[test]
fn a_shared_warp_is_computed_once() {
    let bent = point([0.0; 3], 1.0).bend(Axis::X, 0.5, -1.0, 1.0, 0);
    let both = bent.color([1.0, 0.0, 0.0]) + bent.color([0.0, 1.0, 0.0]);
    let Lowered { function, .. } = lower(&checked(both), Query::ATTRIBUTES).unwrap();
    let roots = function.to_string().matches("sqrt").count();
    assert_eq!(roots, 1, "the distance from the centre of curvature");
}

#[test]
fn numbers_of_warps_follow_parameters() {
    let text = "jbt 1 param p = 0.5
        union {
            taper axis x from -p to p + 1 start p end 0 { point { radius p } }
            bend rate p from -1 to p { point { radius 1 } }
            repeat spacing p count 2 * p { point { radius 1 } }
            space_map from (0 p 0) to (p 0 0) radius 4 * p { point { radius 1 } }
            reflect axis (p 1 0) { stretch axis (1 p 0) by p { shear axis z by (p 0 0) { point { radius 1 } } } }
        }";
    let model = scene::model(text);
    assert_reads_back(&model);
    let tree = model.check().expect("a good model");
    let set = tree.with_parameters(&[("p", 1.5)]).expect("a good value");
    let [before, after] = [&tree, &set].map(|tree| lower(tree, Query::GRADIENT).expect("it can be lowered"));
    assert_eq!(before.function.to_string(), after.function.to_string(), "nothing is compiled again");
    assert_ne!(before.tables, after.tables);
    let errors = tree.with_parameters(&[("p", 0.7)]).expect_err("1.4 copies");
    assert!(errors[0].message.contains("the `count` of the repeat is 1.4"), "{}", errors[0].message);
    let same = Tree::clone(&point([0.0; 3], 1.0)).taper(Axis::X, param("a", 0.0), param("b", 1.0), 1.0, 0.0);
    assert!(checked(same).with_parameters(&[("b", 0.0)]).is_err());
}

#[test]
fn errors_stand_where_the_warp_does() {
    for (text, expected) in [
        ("taper from 1 to 1 end 0 { point { radius 1 } }", "the taper goes from 1 to 1"),
        ("taper from 1 to 2 end -1 { point { radius 1 } }", "the `end` of the taper is -1"),
        ("bend rate 1 from 0 to 0 { point { radius 1 } }", "the bend goes from 0 to 0"),
        ("bend rate 1e7 from 0 to 1 { point { radius 1 } }", "the rate of the bend is 10000000"),
        ("repeat spacing 0 { point { radius 1 } }", "the `spacing` of the repeat is 0"),
        ("repeat spacing 1 count 1.5 { point { radius 1 } }", "the `count` of the repeat is 1.5"),
        ("repeat_around count 0 { point { radius 1 } }", "there are 0 copies around the axis"),
        (
            "space_map from (0 0 0) to (1 0 0) radius 0 { point { radius 1 } }",
            "the `radius` of the space_map is 0",
        ),
        ("stretch axis x by 0 { point { radius 1 } }", "the affine map is singular"),
        ("shear axis x by (-1 0 0) { point { radius 1 } }", "the affine map is singular"),
    ] {
        let text = format!("jbt 1 {text}");
        let errors = scene::model(&text).check().expect_err(&text);
        assert!(errors[0].message.contains(expected), "{}", errors[0].message);
        assert_eq!(errors[0].span.map(|span| span.start), Some(6));
    }
    let broken = point([0.0; 3], 1.0).bend(Axis::X, f64::NAN, 0.0, 1.0, 0);
    assert!(Model::new(broken).check().is_err());
}

#[test]
fn copies_without_end_have_no_bounds() {
    let tree = checked(point([0.0; 3], 0.4).repeat(Axis::X, 1.0, 0.0));
    let support = tree.support();
    assert!(!support.is_finite() && support.high()[1] == 0.4);
    assert_eq!(walk(&tree, [1000.0, 0.0, 0.0]).field, 1.0);
}
