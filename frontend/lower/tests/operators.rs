//! Operators by their closed forms, and what is often wrong with them: the oracle, and the compiled program
//! in f32 beside it.

use jbt_lower::lower;
use jbt_model::builder::{param, point, segment};
use jbt_model::check::CheckedTree;
use jbt_model::combine::{
    Combinator, CombinatorKind, RFunction, RFunctionOrder, RFunctionPower, Ricci, SetOperation,
    SymmetricDifference,
};
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_model::walk::{walk, walk_gradient};
use jbt_model::written::Written;
use jbt_testkit::scene::{self, assert_reads_back, checked};
use jbt_testkit::vector::near;

const RED: [f64; 3] = [1.0, 0.0, 0.0];
const BLUE: [f64; 3] = [0.0, 0.0, 1.0];
const WHITE: [f64; 3] = [1.0; 3];
const HERE: [f64; 3] = [0.0; 3];

/// A ball that has exactly this field at the origin.
fn level(field: f64) -> Tree {
    point(HERE, 1.0).strength(field)
}

/// Field, gradient and colour of the program at a point.
fn compiled(tree: &CheckedTree, p: [f64; 3]) -> Vec<f64> {
    scene::run(&scene::compiled(tree, Query::ALL), p)
}

/// The field at the origin, by the oracle; the program has to agree.
fn field(tree: &Tree) -> f64 {
    let tree = checked(tree);
    let field = walk(&tree, HERE).field;
    let found = compiled(&tree, HERE)[0];
    assert!((found - field).abs() <= 2e-6 * field.abs().max(1.0), "{found} is not {field}");
    field
}

/// The colour at the origin, by the oracle and by the program.
fn color(tree: &Tree) -> [f64; 3] {
    let tree = checked(tree);
    let color: [f64; 3] = walk(&tree, HERE).attributes[0].clone().try_into().unwrap();
    let found = compiled(&tree, HERE);
    assert!(near(found[4..].try_into().unwrap(), color, 1e-5), "{found:?} is not {color:?}");
    color
}

const ALL_SETS: [SetOperation; 3] = SetOperation::ALL;

/// One of each operator of several children.
fn of_two() -> Vec<Combinator> {
    let plain = CombinatorKind::ALL.iter().filter(|kind| !kind.takes_one() && kind.fields().is_empty());
    let mut all: Vec<Combinator> = plain.map(|kind| kind.from_fields(&[])).collect();
    all.extend([3.0, -2.0, -2.5].map(|exponent| Combinator::from(Ricci { exponent })));
    for set in ALL_SETS {
        all.push(Combinator::smooth(set, 0.2));
        for alpha in [-0.9, 0.0, 0.7, 1.0] {
            all.push(RFunction { set, alpha }.into());
        }
        all.extend([1, 2, 4].map(|order| Combinator::from(RFunctionOrder { set, order })));
        all.extend([1.1, 2.0, 3.5, 64.0].map(|power| Combinator::from(RFunctionPower { set, power })));
    }
    all
}

#[test]
fn products_and_negative_exponents() {
    let product = |a: f64, b: f64| field(&Tree::product([level(a), level(b)]));
    assert_eq!((product(0.5, 0.5), product(1.0, 0.25), product(0.5, 0.3)), (0.5, 0.5, 0.3));
    assert_eq!(product(0.0, 7.0), 0.0);
    let ricci = |n: f64, a: f64, b: f64| field(&Tree::blend(n, [level(a), level(b)]));
    assert!((ricci(-1.0, 0.5, 0.5) - 0.25).abs() < 1e-15, "harmonic");
    assert!((ricci(-2.0, 0.3, 0.4) - 0.24).abs() < 1e-15);
    assert_eq!((ricci(-3.0, 0.0, 0.4), ricci(-3.0, -0.5, 0.4), ricci(-2.5, 0.0, 0.0)), (0.0, 0.0, 0.0));
}

#[test]
fn ricci_with_512_neither_overflows_nor_vanishes() {
    for (a, b) in [(0.5, 0.5), (1.7, 0.2), (1e-3, 2e-3), (900.0, 1000.0)] {
        let pair = |n: f64| field(&Tree::blend(n, [level(a), level(b)]));
        let equal = if a == b { 2f64.powf(1.0 / 512.0) } else { 1.0 };
        assert!((pair(512.0) / (a.max(b) * equal) - 1.0).abs() < 1e-6);
        assert!((pair(-512.0) / (a.min(b) / equal) - 1.0).abs() < 1e-6);
        let moved = Tree::blend(-512.0, [level(a), point([0.3, 0.0, 0.0], 1.0).strength(b)]);
        assert!(compiled(&checked(&moved), [0.1, 0.2, 0.0]).iter().all(|x| x.is_finite()));
    }
}

#[test]
fn nothing_of_nothing_is_nothing() {
    // R_0 alone has 0.2071 here (iso 1/2), and the union that is smooth by distances width / 4.
    for combinator in of_two() {
        for count in [2, 4] {
            let nowhere = point([9.0, 0.0, 0.0], 1.0);
            let children = vec![nowhere.clone(); count];
            let children: Vec<Tree> = children.iter().map(|child| child.translate(RED)).collect();
            let tree = checked(Tree::combine(combinator, children));
            assert_eq!(walk(&tree, HERE).field, 0.0, "{combinator:?}");
            let found = compiled(&tree, HERE);
            assert!(
                found[0].to_bits() == 0 && found[..4].iter().all(|x| *x == 0.0),
                "{combinator:?}: {found:?}"
            );
            assert!(tree.support().is_finite(), "{combinator:?}");
        }
    }
}

#[test]
fn surfaces_are_those_of_the_set_operations() {
    let mut rng = fastrand::Rng::with_seed(3);
    for combinator in of_two() {
        let (set, exact) = match combinator {
            Combinator::RFunction(RFunction { set, .. })
            | Combinator::RFunctionPower(RFunctionPower { set, .. })
            | Combinator::RFunctionOrder(RFunctionOrder { set, .. }) => (set, true),
            Combinator::SmoothUnion(_) => (SetOperation::Union, false),
            Combinator::SmoothIntersection(_) => (SetOperation::Intersection, false),
            Combinator::SmoothDifference(_) => (SetOperation::Difference, false),
            _ => continue,
        };
        for _ in 0..200 {
            let (a, b) = (1.2 * rng.f64(), 1.2 * rng.f64());
            let plain = match set {
                SetOperation::Union => a.max(b),
                SetOperation::Intersection => a.min(b),
                SetOperation::Difference => a.min(1.0 - b),
            };
            let field = combinator.field(&[a, b], 0.5);
            if exact && (plain - 0.5).abs() > 1e-9 {
                assert_eq!(field > 0.5, plain > 0.5, "{combinator:?} of {a}, {b}: {field}");
            }
            let others = if set == SetOperation::Difference { (a - 1.0 + b).abs() } else { (a - b).abs() };
            if !exact && others >= 0.2 {
                assert_eq!(field, plain.max(0.0), "outside of the width");
            }
            assert!(exact || (field - plain.max(0.0)).abs() <= 0.05 + 1e-12);
        }
    }
}

#[test]
fn smooth_operations_with_a_zero_are_exact() {
    for x in [1e-6_f64, 0.05, 0.13, 0.4, 0.77, 3.0] {
        for (set, expected) in ALL_SETS.into_iter().zip([x, 0.0, x.min(1.0)]) {
            for width in [1e-3, 0.2, 0.31, 5.0] {
                let tree = Tree::smooth(set, width, [level(x), point([9.0, 0.0, 0.0], 1.0)]);
                let found = compiled(&checked(&tree), HERE)[0];
                assert_eq!(found, f64::from(expected as f32), "{set:?} {width}");
            }
        }
    }
}

#[test]
fn r_functions_by_their_closed_forms() {
    let r = |set: SetOperation, a: f64, b: f64| field(&Tree::rfunction(set, 0.0, [level(a), level(b)]));
    // R_0 in units of iso 1/2, less its background -2 + sqrt(2).
    let (x, y): (f64, f64) = (0.6, -0.4);
    let expected = 0.5 * (1.0 + (x + y + x.hypot(y)) / (2.0 - 2f64.sqrt()));
    assert!((r(SetOperation::Union, 0.8, 0.3) - expected).abs() < 1e-14);
    let lone = 0.5 * (1.0 - (2.0 - 1.0) / (2.0 + 2f64.sqrt()));
    assert!(
        (r(SetOperation::Intersection, 1.0, 0.0) - 0.5 * (1.0 - 2f64.sqrt() / (2.0 + 2f64.sqrt()))).abs()
            < 1e-14
    );
    assert!(lone > 0.3);
    // Alpha 1 is the plain operation, clamped at 0; power 2 is R_0.
    for set in ALL_SETS {
        for (a, b) in [(0.2, 0.9), (0.9, 0.2), (0.3, 0.3), (0.6, 0.7)] {
            let by = |operator: Combinator| operator.field(&[a, b], 0.5);
            let by_alpha = |alpha| by(RFunction { set, alpha }.into());
            let plain = match set {
                SetOperation::Union => a.max(b),
                SetOperation::Intersection => a.min(b),
                SetOperation::Difference => a.min(1.0 - b),
            };
            assert!((by_alpha(1.0) - plain).abs() < 1e-12, "{set:?} of {a}, {b}");
            assert!((by(RFunctionPower { set, power: 2.0 }.into()) - by_alpha(0.0)).abs() < 1e-12);
        }
    }
}

#[test]
fn gradients_are_finite_in_the_corner_of_r_functions() {
    // Both fields are iso at the origin, so that x = y = 0 there.
    let (a, b) = (point([0.5, 0.0, 0.0], 1.0), point([-0.5, 0.0, 0.0], 1.0));
    for combinator in of_two() {
        let tree = checked(Tree::combine(combinator, [a.clone(), b.clone()]));
        let found = compiled(&tree, HERE);
        assert!(found.iter().all(|x| x.is_finite()), "{combinator:?}: {found:?}");
    }
}

#[test]
fn the_gradient_of_a_difference_is_that_of_the_side_that_decides() {
    let (a, b) = (point(HERE, 2.0), point([1.0, 0.0, 0.0], 1.0));
    for tree in [&a - &b, &a ^ &b, a.smooth_difference(0.1, &b), !&a & &b] {
        let tree = checked(&tree);
        for p in [[0.5, 0.1, 0.0], [-0.5, 0.3, 0.2], [0.9, 0.3, 0.1], [1.5, 0.2, 0.0]] {
            let (found, expected) = (compiled(&tree, p), walk_gradient(&tree, p, 1e-6));
            assert!(near([found[1], found[2], found[3]], expected, 1e-4), "{found:?} {expected:?} at {p:?}");
        }
    }
}

#[test]
fn gradients_agree_with_differences() {
    let mut rng = fastrand::Rng::with_seed(8);
    let mut tried = 0;
    for combinator in of_two() {
        let parts = [
            point([0.4, 0.0, 0.0], 1.2).color(RED),
            segment([-0.5, -0.2, 0.0], [0.1, 0.6, 0.3], 1.1).color(BLUE),
            point([0.0, 0.5, -0.2], 0.9),
        ];
        let tree = checked(Tree::combine(combinator, parts));
        for _ in 0..60 {
            let p: [f64; 3] = std::array::from_fn(|_| f64::from(1.6 * rng.f32() - 0.8));
            let oracle = walk(&tree, p);
            let found = compiled(&tree, p);
            let large = oracle.field.abs().max(1.0);
            assert!((found[0] - oracle.field).abs() < 2e-5 * large, "{combinator:?} at {p:?}: {found:?}");
            if oracle.kink_distance < 1e-3 || oracle.field < 1e-3 {
                continue;
            }
            tried += 1;
            let expected = walk_gradient(&tree, p, 1e-6);
            let size = expected.iter().fold(1.0, |size: f64, g| size.max(g.abs()));
            assert!(
                near([found[1], found[2], found[3]], expected, 2e-3 * size),
                "{combinator:?} at {p:?}: {found:?} is not {expected:?}"
            );
            let colors: [f64; 3] = oracle.attributes[0].clone().try_into().unwrap();
            assert!(
                near([found[4], found[5], found[6]], colors, 1e-3),
                "{combinator:?} at {p:?}: {found:?} {colors:?}"
            );
        }
    }
    assert!(tried > 800, "{tried}");
}

#[test]
fn weights_are_fields_times_partial_derivatives() {
    let mut rng = fastrand::Rng::with_seed(5);
    for combinator in of_two() {
        let subtracts = match combinator {
            Combinator::Difference(_) | Combinator::SymmetricDifference(_) => true,
            Combinator::SmoothDifference(_) => true,
            Combinator::RFunction(RFunction { set, .. })
            | Combinator::RFunctionPower(RFunctionPower { set, .. })
            | Combinator::RFunctionOrder(RFunctionOrder { set, .. }) => set == SetOperation::Difference,
            _ => false,
        };
        if subtracts {
            // What is subtracted counts by its complement.
            continue;
        }
        for _ in 0..100 {
            let f = [0.1 + rng.f64(), 0.1 + rng.f64()];
            if combinator.kink_distance(&f, 0.5) < 1e-2 || combinator.field(&f, 0.5) < 1e-3 {
                continue;
            }
            let partial = |i: usize| {
                let at = |step: f64| {
                    let mut g = f;
                    g[i] += step;
                    combinator.field(&g, 0.5)
                };
                (f[i] * (at(1e-6) - at(-1e-6)) / 2e-6).max(0.0)
            };
            let (expected, found) = ([partial(0), partial(1)], combinator.weights(&f, 0.5));
            let part = |w: &[f64]| w[0] / (w[0] + w[1]);
            assert!(
                (part(&expected) - part(&found)).abs() < 1e-5,
                "{combinator:?} of {f:?}: {found:?} is not {expected:?}"
            );
        }
    }
}

#[test]
fn colours_of_each_operator() {
    let (a, b) = (level(0.3).color(RED), level(0.6).color(BLUE));
    let both = [a.clone(), b.clone()];
    assert!(near(color(&Tree::product(both.clone())), [0.5, 0.0, 0.5], 1e-12), "equal weights");
    // f^-2: 1/0.09 to 1/0.36.
    assert!(near(color(&Tree::blend(-2.0, both.clone())), [0.8, 0.0, 0.2], 1e-12));
    assert_eq!(color(&(&a ^ &b)), BLUE, "0.6 is below 1 - 0.3");
    assert_eq!(color(&(&level(0.8).color(RED) ^ &b)), BLUE, "cut by the smaller one, which is there");
    assert_eq!(
        color(&(&level(1.4).color(RED) ^ &level(0.0).color(BLUE))),
        RED,
        "limited by what is not there"
    );
    assert_eq!(color(&a.smooth_union(0.1, &b)), BLUE, "too far apart to round");
    let smooth = color(&a.smooth_union(0.1, &level(0.3).color(BLUE)));
    assert!(near(smooth, [0.5, 0.0, 0.5], 1e-12), "{smooth:?}");
    assert_eq!(color(&!&a), RED);
    assert_eq!(color(&!&level(0.0).color(RED)), WHITE, "nothing gives no colour");
    assert_eq!(color(&a.shell(0.2)), RED);
    assert_eq!(color(&a.clamp(0.1, 0.2).offset(0.1)), RED);
    assert_eq!(color(&level(-0.5).color(RED).clamp(0.1, 0.2)), WHITE);
    assert_eq!(color(&(&b & &!&a)), BLUE, "0.6 against 1 - 0.3");
}

#[test]
fn maps_of_one_field() {
    assert_eq!((field(&!level(0.3)), field(&!level(1.5))), (0.7, -0.5));
    let clamp = |f: f64| field(&level(f).clamp(-0.25, 0.75));
    assert_eq!((clamp(-1.0), clamp(0.5), clamp(9.0)), (-0.25, 0.5, 0.75));
    let shell = |f: f64| field(&level(f).shell(0.2));
    for edge in [0.4, 0.6] {
        assert!((shell(edge) - 0.5).abs() < 1e-12);
    }
    assert_eq!((shell(0.0), shell(1.0), shell(1.7)), (0.0, 0.0, 0.0));
    assert!((shell(0.5) - 0.625).abs() < 1e-12);
    assert!((field(&level(0.4).offset(0.1)) - 0.5).abs() < 1e-12);
    assert!((field(&level(0.7).offset(-0.2)) - 0.5).abs() < 1e-12);
    assert_eq!(field(&level(0.0).offset(0.1)), 0.0);
}

#[test]
fn symmetric_difference_is_inside_of_an_odd_number() {
    let inside = |fields: &[f64]| Combinator::from(SymmetricDifference {}).field(fields, 0.5) > 0.5;
    for bits in 0..8u32 {
        let fields = [0, 1, 2].map(|i| if bits >> i & 1 == 1 { 0.8 } else { 0.2 });
        assert_eq!(inside(&fields), bits.count_ones() % 2 == 1, "{fields:?}");
        assert_eq!(inside(&fields[..2]), (bits & 3).count_ones() == 1);
    }
}

#[test]
fn supports_end_where_they_can() {
    let (a, b) = (point(HERE, 1.0), point([1.5, 0.0, 0.0], 1.0));
    let bounds = |tree: &Tree| checked(tree).support();
    let of_a = bounds(&a);
    assert_eq!(bounds(&Tree::product([a.clone(), b.clone()])), bounds(&(&a & &b)));
    assert_eq!(bounds(&Tree::blend(-2.0, [a.clone(), b.clone()])), bounds(&(&a & &b)));
    assert_eq!(bounds(&a.smooth_intersection(0.1, &b)), bounds(&(&a & &b)));
    assert_eq!(bounds(&a.smooth_difference(0.1, &b)), of_a);
    assert_eq!(bounds(&(&a ^ &b)), bounds(&(&a | &b)));
    assert_eq!([bounds(&a.shell(0.1)), bounds(&a.offset(0.1)), bounds(&a.clamp(0.0, 0.3))], [of_a; 3]);
    assert!(!bounds(&!&a).is_finite() && !bounds(&a.clamp(0.1, 0.3)).is_finite());
    // A complement is negative where what it is of is: there the intersection is too.
    assert_eq!(bounds(&(&a & &!&b)), bounds(&(&a | &b)));
    assert_eq!(bounds(&(&a - &!&b)), of_a);
    assert!(!bounds(&(!&a).rotate([0.3, 0.4, 0.5], 33.0)).is_finite());
}

#[test]
fn numbers_of_operators_follow_parameters() {
    let (a, b) = (level(0.5), level(0.5));
    let tree = a.smooth_union(param("k", 0.1), &b).offset(param("by", 0.0));
    let tree = checked(&tree);
    assert!((walk(&tree, HERE).field - 0.525).abs() < 1e-12);
    let set = tree.with_parameters(&[("k", 0.2), ("by", 0.25)]).unwrap();
    assert!((walk(&set, HERE).field - 1.1).abs() < 1e-12);
    assert_eq!(lower(&tree, Query::ALL).unwrap().function, lower(&set, Query::ALL).unwrap().function);
    let error = tree.with_parameters(&[("by", 0.5)]).unwrap_err();
    assert_eq!(error[0].message, "the offset is 0.5");
    // The iso-value is a limit of plain numbers too.
    let shell = scene::tree("jbt 1 param level = 0.5 iso level shell 0.6 { point { radius 1 } }");
    assert_eq!(
        shell.with_parameters(&[("level", 0.3)]).unwrap_err()[0].message,
        "the thickness of the shell is 0.6"
    );
    assert!(shell.with_parameters(&[("level", 0.4)]).is_ok());
}

#[test]
fn many_operands_of_a_step_are_rows() {
    let operator = |count: usize| {
        let children = (0..count).map(|i| point([0.1 * i as f64, 0.0, 0.0], 0.3));
        checked(Tree::smooth(SetOperation::Union, 0.1, children))
    };
    let values = |count: usize| lower(&operator(count), Query::ALL).unwrap().function.values.len();
    assert_eq!(values(4), values(400));
    for x in [0.0, 1.23, 20.0] {
        let tree = operator(400);
        let (found, expected) = (compiled(&tree, [x, 0.1, 0.0])[0], walk(&tree, [x, 0.1, 0.0]).field);
        assert!((found - expected).abs() < 1e-5);
    }
}

#[test]
fn every_operator_prints_and_reads_back() {
    let leaf = || point(HERE, 1.0);
    let mut trees: Vec<Tree> =
        of_two().into_iter().map(|combinator| Tree::combine(combinator, [leaf(), leaf()])).collect();
    trees.extend([!leaf(), leaf().clamp(-0.5, 1.0), leaf().shell(0.1), leaf().offset(-0.1)]);
    let k = param("k", 0.2);
    trees.push(leaf().smooth_union(&k, &leaf()).shell(&k * 2.0).clamp(-&k, 3.0 * &k));
    for tree in trees {
        let model = Model::new(tree);
        let model = Model { parameters: model.all_parameters(), ..model };
        assert_reads_back(&model);
        assert!(matches!(model.root.node().written(), Written::Combine { .. }));
    }
}
