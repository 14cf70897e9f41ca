//! Questions about solids, against closed forms and against plain walks.

use jbt::solid::{
    BoundsError, Measure, MeasureError, Measures, Membership, MembershipError, RegionError, Solid,
};
use jbt::walk::walk;
use jbt::{Box3, CancelToken, CheckedTree, Compiler, Engine, Fineness, Points, Polygonize};
use jbt_model::check::NodeId;
use jbt_model::kind::NodeKind;
use jbt_testkit::scene::tree;

const BALL: &str = "jbt 1 point { surface_radius 1 }";
const TORUS: &str = "jbt 1 translate (1 2 3) { ring { ring_radius 1 surface_radius 0.25 } }";
const ROUND_BOX: &str = "jbt 1 box { half (0.5 0.3 0.2) surface_radius 0.1 }";
const LENS: &str = "jbt 1 intersection {
    point { at (0 0 0.8) surface_radius 1 }
    point { at (0 0 -0.8) surface_radius 1 }
}";
const BOWL: &str = "jbt 1 difference { point { surface_radius 1 } point { at (0 0 1) surface_radius 1 } }";
/// Two balls whose centre is pushed apart by a negative one.
const APART: &str = "jbt 1 sum {
    point { at (-0.5 0 0) radius 1 }
    point { at (0.5 0 0) radius 1 }
    point { radius 0.5 strength -1 }
}";
/// Operators under an intersection and a difference: in most boxes one side decides, and the others are left
/// out.
const NESTED: &str = "jbt 1 intersection {
    sum { point { at (-0.5 0 0) radius 1 } point { at (0.5 0 0) radius 1 } }
    difference {
        union { point { at (0 0.5 0) radius 1.5 } point { at (0 -0.5 0) radius 1.5 strength 0.9 } }
        sum { point { at (0 0 1) radius 1 } point { at (0.3 0 1) radius 1 } }
    }
}";
const SCENE: &str = "jbt 1
    let arm = segment { from (0 0 0) to (1 0 0) radius 0.6 }
    blend ricci 3 {
        use arm
        rotate axis z degrees 90 { color (0.1 0.4 1) { use arm } }
        twist axis z rate 0.5 { translate (0 0 0.5) { point { radius 0.7 } } }
        difference { point { at (-1 0 0) radius 0.9 } box { center (-1 0 0.4) half (0.1 0.1 0.3) radius 0.2 } }
        sum { point { at (0 -1 0) radius 0.8 } point { at (0.3 -1 0) radius 0.5 strength -0.5 } }
        union { ring { center (0 0 -0.5) ring_radius 0.5 radius 0.4 } point { at (0 0 -0.8) radius 0.5 } }
    }";

fn solid(text: &str) -> Solid {
    Solid::new(&Compiler::for_engine(Engine::Lanes), &tree(text)).unwrap()
}

fn measured(text: &str, resolution: usize) -> Measures {
    let settings = Measure { fineness: Fineness::Resolution(resolution), ..Measure::default() };
    solid(text).measure(&settings).run().unwrap()
}

#[track_caller]
fn near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
}

const PI: f64 = std::f64::consts::PI;

/// Volume and area of each model.
fn closed_forms() -> [(&'static str, f64, f64); 5] {
    // A box rounded by r: the box, a slab on each face, a quarter of a cylinder at each edge, an eighth of a
    // ball at each corner.
    let ([a, b, c], r) = ([1.0, 0.6, 0.4], 0.1);
    let faces = 2.0 * (a * b + b * c + c * a);
    let round = a * b * c + faces * r + PI * r * r * (a + b + c) + 4.0 / 3.0 * PI * r * r * r;
    let skin = faces + 2.0 * PI * r * (a + b + c) + 4.0 * PI * r * r;
    // A cap of a unit ball of this height.
    let cap = |h: f64| (PI * h * h * (3.0 - h) / 3.0, 2.0 * PI * h);
    let (lens, half_ball) = (cap(0.2), cap(0.5));
    [
        (BALL, 4.0 / 3.0 * PI, 4.0 * PI),
        (TORUS, 2.0 * PI * PI * 0.25 * 0.25, 4.0 * PI * PI * 0.25),
        (ROUND_BOX, round, skin),
        (LENS, 2.0 * lens.0, 2.0 * lens.1),
        // What is cut off is twice a cap; its walls are a cap of each ball.
        (BOWL, 4.0 / 3.0 * PI - 2.0 * half_ball.0, 4.0 * PI),
    ]
}

#[test]
fn volumes_and_areas_of_closed_forms() {
    for (text, volume, area) in closed_forms() {
        let found = measured(text, 48);
        assert!(found.volume.low <= volume && volume <= found.volume.high, "{text}: {:?}", found.volume);
        near(found.volume.estimate, volume, 0.004);
        near(found.area, area, 0.01);
        near(found.volume.low + found.air + found.surface, found.total(), 1e-9);
        assert_eq!(found.volume.high, found.volume.low + found.surface);
    }
}

#[test]
fn estimates_converge() {
    let errors = [16, 32, 64].map(|resolution| {
        let found = measured(BALL, resolution);
        let (volume, area) = (4.0 / 3.0 * PI, 4.0 * PI);
        assert!(found.volume.low < volume && volume < found.volume.high);
        ((found.volume.estimate / volume - 1.0).abs(), (found.area / area - 1.0).abs())
    });
    assert!(errors[2].0 < 2e-5 && errors[2].1 < 3e-3, "{errors:?}");
    assert!(errors[2].0 < errors[0].0 && errors[2].1 < errors[0].1, "{errors:?}");
}

/// A solid in the cube from -2 to 2, its area, and whether it has edges.
fn areas() -> [(&'static str, f64, bool); 10] {
    let [.., (_, _, round_skin), (_, _, lens), (_, _, bowl)] = closed_forms();
    // A ball of radius 1/2, stretched to twice that along z: a prolate spheroid.
    let eccentricity = 0.75_f64.sqrt();
    let spheroid = 2.0 * PI * 0.25 * (1.0 + 2.0 / eccentricity * eccentricity.asin());
    [
        (r"point { surface_radius 1 }", 4.0 * PI, false),
        (r"ring { ring_radius 1 surface_radius 0.25 }", 4.0 * PI * PI * 0.25, false),
        (r"box { half (0.5 0.3 0.2) surface_radius 0.1 }", round_skin, false),
        (
            r"segment { from (-0.5 0 0) to (0.5 0 0) surface_radius 0.4 }",
            2.0 * PI * 0.4 * 1.0 + 4.0 * PI * 0.16,
            false,
        ),
        (r"scale (1 1 2) { point { surface_radius 0.5 } }", spheroid, false),
        (
            r"intersection { point { at (0 0 0.8) surface_radius 1 } point { at (0 0 -0.8) surface_radius 1 } }",
            lens,
            true,
        ),
        (r"difference { point { surface_radius 1 } point { at (0 0 1) surface_radius 1 } }", bowl, true),
        // A cube and a capped cylinder, whose flat faces are walls.
        (r"within (-1 -1 -1) to (1 1 1) { expression { 0.5 + 0.01 * (x + 2) } }", 24.0, true),
        (
            r"within (-2 -2 -0.5) to (2 2 0.5) { segment { from (0 0 -2) to (0 0 2) surface_radius 0.6 } }",
            2.0 * PI * 0.6 * 1.0 + 2.0 * PI * 0.36,
            true,
        ),
        // Half a ball, whose flat face is a field of its own.
        (
            r"intersection {
                sphere { sphere_radius 0.5 surface_radius 0.2 }
                difference { sphere { sphere_radius 0.9 radius 1 } expression { 0.5 + z } }
            }",
            3.0 * PI * 0.49,
            true,
        ),
    ]
}

/// The errors of an area, as a part of it, with so many boxes along the cube.
fn area_error(text: &str, area: f64, boxes: usize) -> f64 {
    let region = Some(Box3::new([-2.0; 3], [2.0; 3]));
    let settings = Measure { region, fineness: Fineness::Resolution(boxes) };
    solid(text).measure(&settings).run().unwrap().area / area - 1.0
}

/// Aligned: the flat faces lie in the planes between boxes. Shifted and turned: nothing does.
#[test]
fn areas_converge_aligned_shifted_and_turned() {
    let (mut smooth, mut edged) = ([0.0_f64; 3], [0.0_f64; 3]);
    for (text, area, has_edges) in areas() {
        let placed = [
            format!("jbt 1 {text}"),
            format!("jbt 1 translate (0.0137 -0.0291 0.0433) {{ {text} }}"),
            format!("jbt 1 rotate axis (1 2 3) degrees 37 {{ {text} }}"),
        ];
        for (place, scene) in ["aligned", "shifted", "turned"].into_iter().zip(&placed) {
            // The radii of the smooth ones are of a few boxes at least.
            let boxes = if has_edges { [16, 32, 64] } else { [24, 48, 96] };
            let errors = boxes.map(|boxes| area_error(scene, area, boxes));
            let bound = if has_edges { 0.02 } else { 0.004 };
            assert!(errors[2].abs() < bound, "{text} {place}: {errors:?}");
            let sums = if has_edges { &mut edged } else { &mut smooth };
            sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error / 15.0);
        }
    }
    let [smooth, edged] = [smooth, edged].map(|sums| sums.map(f64::sqrt));
    // With a quarter of the box: by 16 where there are only smooth surfaces, by 4 where there are edges.
    assert!(smooth[2] < smooth[0] / 10.0, "{smooth:?}");
    assert!(edged[2] < edged[0] / 4.0, "{edged:?}");
    assert!(smooth[2] < 2e-3 && edged[2] < 8e-3, "{smooth:?} {edged:?}");
}

/// A face in the plane between two boxes counts once, whichever of its sides is inside.
#[test]
fn flat_faces_between_boxes_count_once() {
    let cases = [
        // Four of the eight octants are inside.
        ("(-1 -1 -1) to (1 1 1)", "0.5 + x * y * z", 24.0),
        ("(0 0 0) to (1 1 1)", "0.5 + x * y * z", 6.0),
        ("(-1 -0.5 0) to (0 0.5 1)", "0.6 + 0.05 * x * y", 6.0),
        ("(-1 -0.5 0) to (0 0.5 1.5)", "5 - x", 8.0),
    ];
    for (corners, field, area) in cases {
        let scene = format!("jbt 1 within {corners} {{ expression {{ {field} }} }}");
        for boxes in [16, 32] {
            let error = area_error(&scene, area, boxes);
            assert!(error.abs() < 1e-6, "{scene} {boxes}: {error}");
        }
    }
}

#[test]
fn volumes_without_closed_forms_are_those_of_meshes() {
    for text in [APART, NESTED, SCENE] {
        let tree = tree(text);
        let settings = Polygonize { fineness: Fineness::Resolution(64), ..Polygonize::default() };
        let made = settings.mesh(&Compiler::for_engine(Engine::Lanes), &tree).run().unwrap();
        assert!(made.report.closed);
        let (mut volume, mut area) = (0.0, 0.0);
        for corners in &made.mesh.triangles {
            let [a, b, c] = corners.map(|v| glam::Vec3::from(made.mesh.positions[v as usize]).as_dvec3());
            volume += a.dot(b.cross(c)) / 6.0;
            area += (b - a).cross(c - a).length() / 2.0;
        }
        let found = measured(text, 64);
        assert!(found.volume.low < volume && volume < found.volume.high);
        assert!(
            found.volume.low > 0.5 * volume && found.volume.high < 1.8 * volume,
            "ranges decide most of it"
        );
        near(found.volume.estimate, volume, 0.01);
        near(found.area, area, 0.02);
    }
}

#[test]
fn centers_and_regions() {
    let torus = measured(TORUS, 32).center.unwrap();
    (0..3).for_each(|axis| near(torus[axis], [1.0, 2.0, 3.0][axis], 1e-3));
    // An eighth of a ball: 3/8 of the radius away from each wall. The cut does not count as surface.
    let settings =
        Measure { region: Some(Box3::new([0.0; 3], [2.0, 1.5, 1.0])), fineness: Fineness::Cell(1.0 / 32.0) };
    let eighth = solid(BALL).measure(&settings).run().unwrap();
    near(eighth.volume.estimate, PI / 6.0, 0.002);
    near(eighth.area, PI / 2.0, 0.005);
    eighth.center.unwrap().iter().for_each(|&x| near(x, 0.375, 0.01));
    assert_eq!(eighth.total(), 3.0);
    // Nothing is there.
    let settings = Measure { region: Some(Box3::new([2.0; 3], [3.0; 3])), ..settings };
    let nothing = solid(BALL).measure(&settings).run().unwrap();
    assert_eq!((nothing.volume.high, nothing.center, nothing.air), (0.0, None, 1.0));
    assert_eq!(nothing.levels.len(), 1);
}

#[test]
fn reports_of_divisions_add_up() {
    let found = measured(SCENE, 40);
    let boxes = found.boxes();
    assert!(boxes.solid > 0 && boxes.air > 0 && boxes.surface > 0);
    assert_eq!(found.levels[0].splits, 1);
    assert_eq!(found.levels.last().unwrap().splits, 0);
    // All boxes but the first are parts of split ones: two or eight of each.
    let parts = boxes.splits + boxes.solid + boxes.air + boxes.surface - 1;
    assert!((2 * boxes.splits..=8 * boxes.splits).contains(&parts), "{boxes:?}");
    assert!(found.contents.mean >= 1.0 && found.contents.mean <= found.contents.most as f64);
    assert!(found.contents.most <= 9, "{:?}", found.contents);
}

#[test]
fn any_number_of_threads_measures_alike() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| measured(SCENE, 24))
    };
    let one = run(1);
    assert_eq!(one, run(3));
}

#[test]
fn measuring_can_be_cancelled() {
    let token = CancelToken::new();
    let watch = |part: f32| {
        if part >= 0.2 {
            token.cancel();
        }
    };
    let cancelled = solid(BALL).measure(&Measure::default()).on_progress(watch).cancel(&token).run();
    assert!(matches!(cancelled, Err(MeasureError::Cancelled)));
    let mut last = 0.0;
    let settings = Measure { fineness: Fineness::Resolution(16), ..Measure::default() };
    let watch = |part: f32| {
        assert!(part >= last && part <= 1.0);
        last = part;
    };
    solid(BALL).measure(&settings).on_progress(watch).run().unwrap();
    assert!(last > 0.9, "{last}");
}

#[test]
fn tight_bounds_of_closed_forms() {
    let r = (1.0_f64 - 0.64).sqrt();
    let cases: [(&str, [f64; 3], [f64; 3]); 5] = [
        (BALL, [-1.0; 3], [1.0; 3]),
        (TORUS, [-0.25, 0.75, 2.75], [2.25, 3.25, 3.25]),
        (ROUND_BOX, [-0.6, -0.4, -0.3], [0.6, 0.4, 0.3]),
        (LENS, [-r, -r, -0.2], [r, r, 0.2]),
        (BOWL, [-1.0; 3], [1.0, 1.0, 0.5]),
    ];
    for (text, low, high) in cases {
        for tolerance in [0.1_f32, 0.001] {
            let solid = solid(text);
            let bounds = solid.tight_bounds(None, tolerance).unwrap();
            let (outer, inner) = (bounds.outer.unwrap(), bounds.inner.unwrap());
            assert!(bounds.converged);
            for axis in 0..3 {
                // What f32 is off by.
                let slack = 1e-5;
                let sides = [
                    (-f64::from(outer.low[axis]), -low[axis], -f64::from(inner.low[axis])),
                    (f64::from(outer.high[axis]), high[axis], f64::from(inner.high[axis])),
                ];
                for (outer, true_one, inner) in sides {
                    assert!(
                        outer >= true_one - slack && inner <= true_one + slack,
                        "{outer} {true_one} {inner}"
                    );
                    assert!(outer <= inner + f64::from(tolerance) + slack, "{outer} {inner}");
                }
            }
        }
    }
}

#[test]
fn tight_bounds_of_what_is_empty_or_partly_there() {
    let apart = solid("jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }");
    let bounds = apart.tight_bounds(None, 0.01).unwrap();
    assert_eq!((bounds.outer, bounds.inner, bounds.converged), (None, None, true));
    // There is a field, and nowhere enough of it.
    let weak = solid("jbt 1 point { radius 1 strength 0.4 }");
    assert_eq!(weak.tight_bounds(None, 0.01).unwrap().outer, None);
    let region = Box3::new([0.0, -2.0, 0.5], [2.0; 3]);
    let part = solid(BALL).tight_bounds(Some(region), 0.001).unwrap();
    let (low, high) = (part.outer.unwrap().low, part.outer.unwrap().high);
    let r = 0.75_f32.sqrt();
    for (found, expected) in low.iter().zip([0.0, -r, 0.5]).chain(high.iter().zip([r, r, 1.0])) {
        assert!((found - expected).abs() <= 0.0011, "{found} {expected}");
    }
    let far = solid(BALL).tight_bounds(Some(Box3::new([2.0; 3], [3.0; 3])), 0.001).unwrap();
    assert_eq!(far.outer, None);
}

#[test]
fn bounds_hold_every_inside_point() {
    for text in [APART, NESTED, SCENE] {
        let tree = tree(text);
        let bounds = solid(text).tight_bounds(None, 0.002).unwrap();
        assert!(bounds.converged);
        let outer = bounds.outer.unwrap();
        let mut rng = fastrand::Rng::with_seed(5);
        for _ in 0..20_000 {
            let point: [f32; 3] = std::array::from_fn(|_| 4.0 * rng.f32() - 2.0);
            if walk(&tree, point.map(f64::from)).field > tree.iso() + 1e-5 {
                assert!(outer.contains(point), "{point:?}");
            }
        }
    }
}

#[test]
fn members_are_those_of_a_plain_walk() {
    let mut rng = fastrand::Rng::with_seed(7);
    for text in [BALL, TORUS, LENS, BOWL, APART, NESTED, SCENE] {
        let (tree, solid) = (tree(text), solid(text));
        let points: Points = (0..3000)
            .map(|_| {
                std::array::from_fn(|axis| {
                    4.0 * rng.f32() - 2.0 + if text == TORUS { axis as f32 + 1.0 } else { 0.0 }
                })
            })
            .collect();
        let answers = [0.0, 0.03].map(|eps| solid.memberships(&points, eps).unwrap());
        let mut counts = [0; 3];
        for index in 0..points.len() {
            let point = points.planes().map(|plane| plane[index]);
            let field = walk(&tree, point.map(f64::from)).field;
            counts[answers[1][index] as usize] += 1;
            assert_ne!(answers[0][index], Membership::Surface);
            if (field - tree.iso()).abs() < 1e-5 {
                continue;
            }
            let side = if field >= tree.iso() { Membership::Inside } else { Membership::Outside };
            assert_eq!(answers[0][index], side, "{text} {point:?}");
            if answers[1][index] != Membership::Surface {
                assert_eq!(answers[1][index], side, "{text} {point:?}");
                // And so is the whole cube.
                let near = point.map(|x| f64::from(x + 0.03 * (2.0 * rng.f32() - 1.0)));
                let field = walk(&tree, near).field;
                let other = side == Membership::Inside && field < tree.iso() - 1e-5
                    || side == Membership::Outside && field > tree.iso() + 1e-5;
                assert!(!other, "{text} {point:?} {near:?} {field}");
            }
        }
        assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
    }
}

/// About a ball, where the surface is near is known: the nearest and the farthest point of the cube.
#[test]
fn the_surface_is_where_the_cube_meets_it() {
    let solid = solid(BALL);
    let mut rng = fastrand::Rng::with_seed(11);
    let eps = 0.05_f32;
    let mut unproven = 0;
    for _ in 0..2000 {
        let point: [f32; 3] = std::array::from_fn(|_| 2.6 * rng.f32() - 1.3);
        let length =
            |x: f32| point.iter().map(|c| f64::from((c.abs() + x).max(0.0)).powi(2)).sum::<f64>().sqrt();
        let (nearest, farthest) = (length(-eps), length(eps));
        let expected = if farthest < 1.0 - 1e-4 {
            Membership::Inside
        } else if nearest > 1.0 + 1e-4 {
            Membership::Outside
        } else {
            Membership::Surface
        };
        let found = solid.membership(point, eps).unwrap();
        if found != expected {
            assert_eq!(found, Membership::Surface, "{point:?}");
            unproven += usize::from(nearest > 1.001 || farthest < 0.999);
        }
    }
    assert_eq!(unproven, 0);
}

/// The owner by plain recursion: the leaf, and its share.
fn owner_of(tree: &CheckedTree, id: NodeId, p: glam::DVec3) -> (f64, Option<(NodeId, f64)>) {
    let node = tree.node(id);
    match &node.kind {
        NodeKind::Primitive(leaf) => {
            let field =
                leaf.strength * leaf.falloff.value(leaf.skeleton.distance_squared(p) / leaf.radius.powi(2));
            (field, (field != 0.0).then_some((id, 1.0)))
        }
        NodeKind::Affine(map) => owner_of(tree, node.children[0], map.inverse().transform_point3(p)),
        NodeKind::Warp(warp) => owner_of(tree, node.children[0], warp.inverse(p)),
        NodeKind::Attribute { .. } | NodeKind::Constant { .. } => owner_of(tree, node.children[0], p),
        NodeKind::Expression(_) | NodeKind::Particles(_) => {
            unreachable!("no scene of these tests has formulas or particles")
        }
        NodeKind::Select(_) => owner_of(tree, node.kind.asked(&node.children)[0], p),
        NodeKind::Combine(combinator) => {
            let children: Vec<_> = node.children.iter().map(|&child| owner_of(tree, child, p)).collect();
            let fields: Vec<f64> = children.iter().map(|child| child.0).collect();
            let weights = combinator.weights(&fields, tree.iso());
            let total: f64 = weights.iter().sum();
            let mut best: Option<(NodeId, f64)> = None;
            for ((_, owner), weight) in children.iter().zip(weights) {
                if let Some((leaf, share)) = owner
                    && weight > 0.0
                    && best.is_none_or(|best| share * weight / total > best.1)
                {
                    best = Some((*leaf, share * weight / total));
                }
            }
            (combinator.field(&fields, tree.iso()), best)
        }
    }
}

#[test]
fn owners_are_those_of_a_plain_recursion() {
    let mut rng = fastrand::Rng::with_seed(13);
    for text in [LENS, BOWL, APART, SCENE] {
        let solid = solid(text);
        let tree = solid.tree();
        let mut seen = std::collections::BTreeSet::new();
        for _ in 0..3000 {
            let point: [f64; 3] = std::array::from_fn(|_| 3.0 * rng.f64() - 1.5);
            let (field, expected) = owner_of(tree, tree.root(), point.into());
            let found = solid.owner(point);
            assert_eq!(field, walk(tree, point).field);
            assert_eq!(
                found.as_ref().map(|owner| owner.node),
                expected.map(|(node, _)| node),
                "{text} {point:?}"
            );
            let Some(owner) = found else { continue };
            assert!((owner.share - expected.unwrap().1).abs() < 1e-12);
            assert!(owner.span.is_some());
            // The way down leads to the leaf.
            let mut at = tree.root();
            for &(node, child) in &owner.above {
                assert_eq!(node, at);
                at = tree.node(node).children[child as usize];
            }
            assert_eq!(at, owner.node);
            seen.insert(owner.path(tree));
            // It is among those that matter around it.
            let at = point.map(|x| x as f32);
            let around = Box3::new(at.map(|x| x - 0.01), at.map(|x| x + 0.01));
            assert!(solid.owners_in(around).unwrap().contains(&owner.node), "{text} {point:?}");
        }
        assert!(seen.len() >= 2);
    }
}

#[test]
fn owners_in_a_box_are_those_that_reach_it() {
    let row: String = (0..20).map(|i| format!("point {{ at ({i} 0 0) radius 0.75 }} ")).collect();
    let solid = solid(&format!("jbt 1 sum {{ {row} }}"));
    let found = solid.owners_in(Box3::new([4.9, -0.1, -0.1], [5.1, 0.1, 0.1])).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!(solid.owner([5.0, 0.0, 0.0]).unwrap().node, found[0]);
    assert_eq!(solid.owners_in(Box3::new([4.4; 3], [4.6; 3])).unwrap().len(), 0);
    assert_eq!(solid.owners_in(Box3::new([4.4, 0.0, 0.0], [4.6, 0.0, 0.0])).unwrap().len(), 2);
    assert!(solid.owners_in(Box3::new([f32::NAN; 3], [0.0; 3])).is_err());
}

#[test]
fn a_long_chain_has_an_owner() {
    let depth = 100_000;
    let text = format!("jbt 1 {}point {{ radius 1 }}{}", "color (1 0 0) { ".repeat(depth), "}".repeat(depth));
    let tree = tree(&text);
    let owner = jbt_model::owner::owner(&tree, [0.0; 3]).unwrap();
    assert_eq!(owner.above.len(), depth);
    assert_eq!(owner.path(&tree).len(), depth * "0.color/".len() + "0.point".len());
}

#[test]
fn questions_that_make_no_sense_are_named() {
    let ball = solid(BALL);
    for eps in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(ball.membership([0.0; 3], eps), Err(MembershipError::Distance { .. })));
    }
    let bad: Points = [[0.0; 3], [0.0, f32::NAN, 0.0]].into_iter().collect();
    assert!(matches!(ball.memberships(&bad, 0.0), Err(MembershipError::Point { index: 1, .. })));
    assert_eq!(ball.memberships(&Points::default(), 0.1), Ok(vec![]));
    assert_eq!(ball.membership([f32::MAX; 3], f32::MAX), Ok(Membership::Surface));
    assert_eq!(ball.membership([f32::MAX; 3], 1.0), Ok(Membership::Outside));

    for tolerance in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(ball.tight_bounds(None, tolerance), Err(BoundsError::Tolerance { .. })));
    }
    let flat = Box3::new([0.0; 3], [1.0, 1.0, 0.0]);
    let huge = Box3::new([f32::MIN; 3], [f32::MAX; 3]);
    for bounds in [flat, huge, Box3::new([f32::NAN; 3], [1.0; 3]), Box3::new([0.0; 3], [f32::INFINITY; 3])] {
        let error = ball.tight_bounds(Some(bounds), 0.1).unwrap_err();
        assert!(matches!(error, BoundsError::Region(RegionError::Bounds { .. })), "{error}");
        let settings = Measure { region: Some(bounds), ..Measure::default() };
        let error = ball.measure(&settings).run().unwrap_err();
        assert!(matches!(error, MeasureError::Region(RegionError::Bounds { .. })), "{error}");
    }
    let measure = |fineness| ball.measure(&Measure { region: None, fineness }).run().unwrap_err();
    for cell in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(measure(Fineness::Cell(cell)), MeasureError::Cell { .. }));
    }
    for fineness in [Fineness::Cell(1e-9), Fineness::Resolution(0), Fineness::Resolution(usize::MAX)] {
        assert!(matches!(measure(fineness), MeasureError::Resolution { .. }));
    }
    let empty = solid("jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }");
    let error = empty.measure(&Measure::default()).run().unwrap_err();
    assert!(matches!(error, MeasureError::Region(RegionError::Empty)));
}
