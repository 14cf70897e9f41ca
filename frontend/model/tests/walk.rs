//! The oracle against closed forms and published numbers, and every traversal on very deep trees.

use jbt_model::attribute::{AttributeGroup, Mixing};
use jbt_model::builder::{Axis, Term, checker, cuboid, point, ring, segment, x, y, z};
use jbt_model::combine::{Combinator, Difference, Intersection, Union};
use jbt_model::falloff::Falloff;
use jbt_model::model::Model;
use jbt_model::traverse::Visit;
use jbt_model::tree::Tree;
use jbt_model::walk::{Sample, walk, walk_gradient};
use jbt_testkit::vector::near;

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const GREEN: [f64; 3] = [0.0, 1.0, 0.0];
const BLUE: [f64; 3] = [0.0, 0.0, 1.0];
const WHITE: [f64; 3] = [1.0; 3];
const HERE: [f64; 3] = [0.0; 3];

fn at(tree: &Tree, p: [f64; 3]) -> Sample {
    walk(&Model::new(tree.clone()).check().unwrap(), p)
}

/// A ball that has exactly this field at the origin.
fn level(field: f64) -> Tree {
    point(HERE, 1.0).strength(field)
}

fn color(tree: &Tree, p: [f64; 3]) -> [f64; 3] {
    at(tree, p).attributes[0].clone().try_into().unwrap()
}

#[test]
fn the_peanut() {
    // Two soft objects of radius 1 at y = 0.4 and -0.4, asked at y = 0.1: published weights.
    let peanut = point([0.0, 0.4, 0.0], 1.0).color(RED) + point([0.0, -0.4, 0.0], 1.0).color(BLUE);
    let sample = at(&peanut, [0.0, 0.1, 0.0]);
    assert!((sample.field - (0.794_976 + 0.5)).abs() < 1e-12);
    assert!(near(color(&peanut, [0.0, 0.1, 0.0]), [0.613_892, 0.0, 0.386_108], 5e-7));
    assert_eq!(sample.kink_distance, 0.75, "of all, the rim of the farther ball is nearest: 1 - s = 0.75");
}

#[test]
fn ricci_by_its_closed_form() {
    let pair = |n: f64| Tree::blend(n, [level(3.0).color(RED), level(4.0).color(BLUE)]);
    assert_eq!(at(&pair(1.0), HERE).field, 7.0);
    assert!((at(&pair(2.0), HERE).field - 5.0).abs() < 1e-15);
    assert!(near(color(&pair(2.0), HERE), [0.36, 0.0, 0.64], 1e-15), "weights f^2");
    assert!((at(&pair(3.0), HERE).field - 91f64.cbrt()).abs() < 1e-14);
    // Far below any f64 without scaling, and far above.
    for size in [1e-12, 1e12] {
        let equal = Tree::blend(1024.0, [level(size), level(size)]);
        let expected = size * (std::f64::consts::LN_2 / 1024.0).exp();
        assert!((at(&equal, HERE).field / expected - 1.0).abs() < 1e-15);
    }
    assert_eq!(at(&pair(1024.0), HERE).field, 4.0);
    assert_eq!(
        at(&Tree::blend(2.0, [level(-3.0), level(4.0)]), HERE).field,
        4.0,
        "negative operands count as zero"
    );
    assert_eq!(at(&Tree::blend(1.0, [level(-3.0), level(4.0)]), HERE).field, 1.0, "except in a plain sum");
}

#[test]
fn union_intersection_and_difference() {
    let (a, b) = (level(0.3).color(RED), level(0.6).color(BLUE));
    assert_eq!((at(&(&a | &b), HERE).field, color(&(&a | &b), HERE)), (0.6, BLUE));
    assert_eq!((at(&(&a & &b), HERE).field, color(&(&a & &b), HERE)), (0.3, RED));
    assert!((at(&(&a | &b), HERE).kink_distance - 0.3).abs() < 1e-15);
    // With iso 1/2, a - b is min(a, max(0, 1 - b)).
    let cut = &b - &a;
    assert_eq!(
        (at(&cut, HERE).field, color(&cut, HERE)),
        (0.6, BLUE),
        "0.7 is left: the first child decides"
    );
    let cut = &b - level(0.8).color(RED);
    assert!((at(&cut, HERE).field - 0.2).abs() < 1e-15);
    assert_eq!(color(&cut, HERE), RED, "the subtracted child decides: its colour is that of the cut");
    assert_eq!(at(&(&b - level(1.7)), HERE).field, 0.0, "clamped: never negative");
    let many = Tree::difference([b.clone(), a.clone(), level(0.9).color(GREEN), a]);
    assert_eq!(color(&many, HERE), GREEN);
    // Ties go to the first; in a difference to the left.
    let tie = [level(0.5).color(RED), level(0.5).color(BLUE)];
    for combinator in [Combinator::from(Union {}), Intersection {}.into(), Difference {}.into()] {
        let tree = Tree::combine(combinator, tie.clone());
        assert_eq!((color(&tree, HERE), at(&tree, HERE).kink_distance), (RED, 0.0));
    }
}

#[test]
fn the_nearest_attribute_counts_and_defaults_fill_in() {
    let ball = point(HERE, 1.0);
    assert_eq!(color(&ball.color(RED).color(BLUE), HERE), RED);
    assert_eq!(color(&ball.color(RED).translate([1.0, 0.0, 0.0]).color(BLUE), [1.0, 0.0, 0.0]), RED);
    assert_eq!(color(&(ball.color(RED) + &ball).color(BLUE), HERE), [0.5, 0.0, 0.5]);
    assert_eq!(color(&(ball.color(BLUE) + &ball), HERE), [0.5, 0.5, 1.0], "the default is white");
    // A lone leaf has its own value everywhere; a blend has the default where it has no field.
    let far = [9.0, 0.0, 0.0];
    assert_eq!(color(&ball.color(RED), far), RED);
    assert_eq!(color(&(ball.color(RED) + ball.color(RED)), far), WHITE);
    assert_eq!(color(&(level(-1.0).color(RED) + level(-2.0)), HERE), WHITE);
    assert_eq!(color(&(level(-1.0).color(RED) + level(2.0).color(BLUE)), HERE), BLUE, "no weight below zero");
}

#[test]
fn weights_are_normalised_at_each_node() {
    // The inner blend is red and blue as 1 to 1, the outer one mixes it with green as 2 to 2, not as 1 to 1
    // to 2.
    let inner = Tree::blend(2.0, [level(1.0).color(RED), level(1.0).color(BLUE)]);
    let tree = inner + level(2f64.sqrt()).color(GREEN);
    assert!(near(color(&tree, HERE), [0.25, 0.5, 0.25], 1e-15));
}

#[test]
fn dominance() {
    let group = |name: &str, mixing| AttributeGroup {
        name: name.into(),
        default: vec![-1.0],
        mixing,
        ..AttributeGroup::color()
    };
    let model = |root: Tree| {
        let attributes =
            vec![AttributeGroup::color(), group("part", Mixing::Dominant), group("heat", Mixing::Blend)];
        Model { attributes, ..Model::new(root) }.check().unwrap()
    };
    let part =
        |field: f64, number: f64| level(field).attribute("part", &[number]).attribute("heat", &[number]);
    let sample = walk(&model(part(1.0, 1.0) + part(2.0, 2.0) + level(1.0)), HERE);
    // Heat: 1 to 2 to 1 of 1, 2 and the default.
    assert_eq!(sample.attributes, [WHITE.to_vec(), vec![2.0], vec![0.25 * 1.0 + 0.5 * 2.0 - 0.25]]);
    // 3 : 2 at the outer node, but the 3 are three leaves of 1.
    let three = part(1.0, 1.0) + part(1.0, 2.0) + part(1.0, 3.0);
    assert_eq!(walk(&model(Tree::sum([three.clone(), part(2.0, 4.0)])), HERE).attributes[1], [4.0]);
    let tie = walk(&model(three), HERE);
    assert_eq!(
        (tie.attributes[1].as_slice(), tie.kink_distance),
        ([1.0].as_slice(), 0.0),
        "the first of equals"
    );
    let none = walk(&model(part(1.0, 1.0) + part(1.0, 2.0)), [5.0, 0.0, 0.0]);
    assert_eq!(none.attributes[1], [-1.0]);
}

#[test]
fn textures_lie_in_the_space_of_their_node() {
    let ball = point(HERE, 1.0);
    let checked = |tree: &Tree| tree.textured("color", checker(0.5), &RED, &BLUE);
    // The cell from 0 to 0.5 along each axis is red.
    let inside = checked(&ball).translate([10.0, 0.0, 0.0]);
    assert_eq!(color(&inside, [10.1, 0.1, 0.1]), RED);
    assert_eq!(color(&inside, [9.9, 0.1, 0.1]), BLUE);
    let outside = checked(&ball.translate([10.25, 0.0, 0.0]));
    assert_eq!(color(&outside, [10.1, 0.1, 0.1]), RED, "maps below do not move it");
    let twisted = checked(&ball).twist(Axis::Z, std::f64::consts::PI);
    // A quarter turn at z = 1/2: (-0.1, 0.1) comes from (0.1, 0.1).
    let q = [-0.1, 0.1, 0.5 - 1e-9];
    assert_eq!(color(&twisted, q), color(&checked(&ball), [0.1, 0.1, 0.5 - 1e-9]));
    assert!(
        (at(&checked(&ball), [0.1, 0.2, 0.3]).kink_distance - 0.1).abs() < 1e-15,
        "0.1 from the plane x = 0"
    );
    // A nearer node wins, and weights mix as always.
    assert_eq!(color(&checked(&ball.color(GREEN)), [0.1; 3]), GREEN);
    let mixed = checked(&ball) + ball.color(GREEN);
    assert_eq!(color(&mixed, [0.1; 3]), [0.5, 0.5, 0.0]);
    // Without field, the default.
    assert_eq!(color(&mixed, [5.0; 3]), WHITE);
}

#[test]
fn formulas_lie_in_the_space_of_their_node() {
    let ball = point(HERE, 2.0);
    let colored = |tree: &Tree| tree.expressed("color", [x(), (y() * z()).abs(), Term::from(0.25)]);
    assert_eq!(color(&colored(&ball), [0.5, -1.0, 0.75]), [0.5, 0.75, 0.25]);
    assert_eq!(color(&colored(&ball).translate([1.0, 0.0, 0.0]), [0.5, -1.0, 0.75]), [-0.5, 0.75, 0.25]);
    assert_eq!(color(&colored(&ball.translate([1.0, 0.0, 0.0])), [0.5, -1.0, 0.75]), [0.5, 0.75, 0.25]);
    assert_eq!(color(&colored(&ball.color(GREEN)), [0.5; 3]), GREEN, "a nearer node wins");
    assert_eq!(color(&(colored(&ball) + ball.color(GREEN)), [0.5, 0.0, 0.0]), [0.25, 0.5, 0.125]);
    // What has no value: a pole, and what overflows.
    let odd = ball.expressed("color", [x() / y(), (1000.0 * x()).exp(), (1000.0 * x()).exp() * y()]);
    let most = f64::from(jbt_model::expression::LARGEST_FIELD);
    assert_eq!(color(&odd, [1.0, 0.0, 0.0]), [0.0, most, 0.0]);
}

#[test]
fn formulas_of_attributes_are_checked() {
    let ball = point(HERE, 1.0);
    let message = |tree: Tree| format!("{:?}", Model::new(tree).check().expect_err("it is wrong"));
    let two = message(ball.expressed("color", [x(), y()]));
    assert!(two.contains("2 values") && two.contains("3 values"), "{two}");
    let none = message(ball.expressed("color", Vec::<Term>::new()));
    assert!(none.contains("0 values"), "{none}");
    let field = message(ball.expressed("color", [x(), y(), ball.field()]));
    assert!(field.contains("asks for a field"), "{field}");
    assert!(message(ball.expressed("color", [x() / 0.0, y(), z()])).contains("division by zero"));
    assert!(message(ball.expressed("colour", [x(), y(), z()])).contains("no attribute `colour`"));
}

#[test]
fn uv_is_that_of_the_leaf_where_it_stands() {
    let uv = AttributeGroup {
        name: "uv".into(),
        default: vec![9.0; 2],
        mixing: Mixing::Blend,
        ..AttributeGroup::color()
    };
    let at = |tree: Tree, p| {
        let attributes = vec![AttributeGroup::color(), uv.clone()];
        walk(&Model { attributes, ..Model::new(tree) }.check().unwrap(), p).attributes[1].clone()
    };
    let close = |a: Vec<f64>, b: [f64; 2]| {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?}, not {b:?}");
    };
    let ball = point(HERE, 2.0).uv("uv");
    close(at(ball.clone(), [0.0, 0.5, 0.0]), [0.25, 0.5]);
    // A rotation that the ball's field does not feel turns its uv.
    close(at(ball.rotate([0.0, 0.0, 1.0], 90.0), [0.0, 0.5, 0.0]), [0.0, 0.5]);
    close(at(ball.scale(-2.0), [0.0, 1.0, 0.0]), [0.75, 0.5]);
    let line = segment(HERE, [0.0, 0.0, 2.0], 1.0).uv_mapped("uv", [4.0, 2.0], 0.0, [1.0, 0.0]);
    close(at(line.clone(), [0.0, -0.1, 0.5]), [4.0, 0.5]);
    let flipped = line.rotate([1.0, 0.0, 0.0], 180.0);
    close(at(flipped, [0.0, 0.1, -0.5]), [4.0, 0.5]);
    close(at(&ball + &ball, [0.0, 0.5, 0.0]), [0.25, 0.5]);
    close(at(&ball + &ball, [9.0; 3]), [9.0, 9.0]);
}

#[test]
fn maps_move_the_question() {
    let ball = point([1.0, 0.0, 0.0], 1.0);
    let squashed = ball.scale_axes([2.0, 1.0, 0.5]).rotate([0.0, 0.0, 1.0], 90.0).translate([0.0, 0.0, 3.0]);
    // Local (1, 0, 0) + (0, 0, 0.5) is (2, 0, 0.25), then (0, 2, 0.25), then (0, 2, 3.25).
    assert!((at(&squashed, [0.0, 2.0, 3.25]).field - 0.5).abs() < 1e-15);
    let twisted = point([1.0, 0.0, 1.0], 1.0).twist(Axis::Z, std::f64::consts::PI);
    assert!((at(&twisted, [-1.0, 0.0, 1.0]).field - 1.0).abs() < 1e-15);
}

#[test]
fn gradients_by_differences() {
    // (1 - d^2)^3 has the gradient -6 (1 - d^2)^2 p.
    let model = Model::new(point(HERE, 1.0).falloff(Falloff::Wyvill)).check().unwrap();
    let p = [0.3, -0.2, 0.4];
    let u: f64 = 1.0 - 0.29;
    assert!(near(walk_gradient(&model, p, 1e-5), p.map(|x| -6.0 * u * u * x), 1e-8));
}

#[test]
fn only_decisions_that_matter_count() {
    let (ball, far) = (point(HERE, 1.0), point([9.0, 0.0, 0.0], 1.0));
    // Inside the ball, a union that is out of reach decides nothing; its ties are of zeros.
    let tie = &far | &far.color(RED);
    assert!(at(&(&ball + &tie), [0.1, 0.0, 0.0]).kink_distance > 0.9);
    assert!(at(&(&ball - &tie), [0.1, 0.0, 0.0]).kink_distance > 0.01);
    assert!(at(&(&ball & &far & &tie), [0.1, 0.0, 0.0]).kink_distance > 0.9);
    assert!(at(&tie, [0.1, 0.0, 0.0]).kink_distance > 1.0);
    // The axis of a ring matters where the ring has a field that is used.
    let torus = ring(HERE, [0.0, 0.0, 1.0], 0.5, 1.0);
    assert_eq!(at(&(&torus + &ball), HERE).kink_distance, 0.0);
    assert!(at(&(&torus | &ball), HERE).kink_distance > 0.01, "here the ball wins");
    // Ties, clamps and rims do matter.
    assert_eq!(at(&(&ball | &ball), [0.1, 0.0, 0.0]).kink_distance, 0.0);
    assert!(at(&ball, [1.0 - 1e-9, 0.0, 0.0]).kink_distance < 1e-8);
    assert_eq!(at(&(&ball - &ball), [0.5, 0.0, 0.0]).kink_distance, 0.0);
}

#[test]
fn fields_vanish_outside_of_the_support_box() {
    let mut rng = fastrand::Rng::with_seed(5);
    let mut inside = 0;
    for _ in 0..60 {
        let tree = random_tree(&mut rng);
        let model = Model::new(tree).check().unwrap();
        let bounds = model.support();
        for _ in 0..100 {
            let p: [f64; 3] = std::array::from_fn(|_| 12.0 * rng.f64() - 6.0);
            let held = (0..3).all(|k| bounds.low()[k] <= p[k] && p[k] <= bounds.high()[k]);
            let field = walk(&model, p).field;
            assert!(held || field == 0.0, "{field} at {p:?} outside of {bounds:?}");
            inside += usize::from(field != 0.0);
        }
    }
    assert!(inside > 100, "only {inside} samples have a field");
}

/// A tree of all kinds of nodes, about 10 across, some strengths negative.
fn random_tree(rng: &mut fastrand::Rng) -> Tree {
    let spot = |rng: &mut fastrand::Rng| std::array::from_fn(|_| 4.0 * rng.f64() - 2.0);
    let mut trees: Vec<Tree> = (0..6)
        .map(|i| {
            let radius = 0.5 + 2.0 * rng.f64();
            let leaf = match i % 3 {
                0 => point(spot(rng), radius),
                1 => segment(spot(rng), spot(rng), radius),
                _ => cuboid(spot(rng), spot(rng).map(f64::abs), radius),
            };
            leaf.strength(if rng.u8(..4) == 0 { -1.0 } else { 1.0 })
        })
        .collect();
    while trees.len() > 1 {
        let (a, b) = (trees.remove(rng.usize(..trees.len())), trees.remove(rng.usize(..trees.len())));
        let both = match rng.u8(..5) {
            0 => a + b,
            1 => a | b,
            2 => a & b,
            3 => a - b,
            _ => a.ricci(1.0 + f64::from(rng.u8(..3)), &b),
        };
        trees.push(match rng.u8(..4) {
            0 => both.twist(Axis::Y, 0.7),
            1 => both.rotate(spot(rng), 360.0 * rng.f64()),
            2 => both.scale_axes([-1.2, 0.8, 1.0]),
            _ => both.translate(spot(rng)),
        });
    }
    trees.remove(0)
}

/// Runs `work` with far too little stack for any recursion over a million nodes.
fn with_a_small_stack(work: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(256 << 10).spawn(work).unwrap().join().unwrap();
}

const DEEP: usize = 1_000_000;

#[test]
fn a_chain_of_a_million_maps() {
    with_a_small_stack(|| {
        let build = || (1..DEEP).fold(point(HERE, 1.0), |tree, _| tree.translate([1.0, 0.0, 0.0]));
        let (tree, same) = (build(), build());
        assert!(tree == same);
        assert_eq!(tree.postfix(Visit::Nodes).count(), DEEP);
        assert_eq!(tree.prefix(Visit::Paths).count(), DEEP);
        assert_eq!(tree.rewrite(|_| None).identity(), tree.identity());
        drop(same);
        assert!(format!("{tree:?}").len() > DEEP);
        let checked = Model::new(tree).check().unwrap();
        let center = (DEEP - 1) as f64;
        assert_eq!(walk(&checked, [center + 0.5, 0.0, 0.0]).field, 0.5);
        assert_eq!(checked.support().high(), [center + 1.0, 1.0, 1.0]);
    });
}

#[test]
fn a_chain_of_half_a_million_alternating_operators() {
    with_a_small_stack(|| {
        let ball = point(HERE, 1.0);
        let pairs = (DEEP / 4) as u32;
        // Each pair of levels adds one ball.
        let build = || (0..pairs).fold(ball.clone(), |tree, _| (tree + &ball) | &ball);
        let (tree, same) = (build(), build());
        assert!(tree == same);
        let softer = tree.strength(0.5);
        assert_eq!(softer.prefix(Visit::Nodes).count(), 2 * pairs as usize + 1);
        let sample = at(&softer, HERE);
        assert_eq!((sample.field, sample.attributes), (0.5 * f64::from(pairs + 1), vec![WHITE.to_vec()]));
        let checked = Model::new(tree).check().unwrap();
        assert_eq!(checked.support().low(), [-1.0; 3]);
    });
}
