//! Directions: attributes that turn with maps and warps, by every engine, against closed forms and the
//! oracle.

mod common;

use common::answers;
use jbt::walk::walk;
use jbt::{CheckedTree, Compiler, Engine, Points, Query, Samples};
use jbt_testkit::scene::tree;

/// A model with directions, from what stands behind their declaration.
fn model(text: &str) -> CheckedTree {
    tree(&format!("jbt 1 attribute grain direction default (0 0 0) {text}"))
}

/// The directions at some points, the same to the bit by every engine and beside every other answer.
fn grains(tree: &CheckedTree, points: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let points: Points = points.iter().copied().collect();
    let grain = |samples: &Samples| -> Vec<Vec<u32>> {
        let planes = samples.attribute("grain").expect("it is there");
        planes.iter().map(|plane| plane[..points.len()].iter().map(|x| x.to_bits()).collect()).collect()
    };
    let mut found: Option<Vec<Vec<u32>>> = None;
    for engine in Engine::ALL {
        for query in [Query::ATTRIBUTES, Query::ALL] {
            let evaluator = Compiler::for_engine(engine).evaluator(tree, query).expect("it compiles");
            let bits = grain(&answers(&evaluator, &points));
            assert_eq!(*found.get_or_insert_with(|| bits.clone()), bits, "{}", engine.name());
        }
    }
    let found = found.expect("there are engines");
    let at = |index: usize| [0, 1, 2].map(|axis: usize| f64::from(f32::from_bits(found[axis][index])));
    (0..points.len()).map(at).collect()
}

/// Asserts what the directions of a model are at points of a box, by a closed form and by the oracle.
fn assert_directions(text: &str, tolerance: f64, expected: impl Fn([f64; 3]) -> Option<[f64; 3]>) {
    let tree = model(text);
    let mut rng = fastrand::Rng::with_seed(5);
    let points: Vec<[f32; 3]> = (0..65).map(|_| std::array::from_fn(|_| 1.2 * rng.f32() - 0.6)).collect();
    let mut checked = 0;
    for (point, found) in points.iter().zip(grains(&tree, &points)) {
        let point = point.map(f64::from);
        let sample = walk(&tree, point);
        if sample.field == 0.0 || sample.kink_distance < 1e-3 {
            continue;
        }
        checked += 1;
        let oracle: [f64; 3] = sample.attributes[1][..].try_into().expect("three reals");
        let closed = expected(point).unwrap_or(oracle);
        for axis in 0..3 {
            let wrong = |other: f64| (found[axis] - other).abs() > tolerance;
            let words = || format!("{text} at {point:?}: {found:?}, oracle {oracle:?}, closed {closed:?}");
            assert!(!wrong(oracle[axis]) && !wrong(closed[axis]), "{}", words());
        }
    }
    assert!(checked > 20, "{text}: {checked} points");
}

const BALL: &str = "point { radius 2 }";

#[test]
fn affine_maps_turn_by_their_linear_part() {
    let given = |grain: &str| format!("grain {grain} {{ {BALL} }}");
    let same = |x: f64, y: f64, z: f64| move |_| Some([x, y, z]);
    assert_directions(&given("(1 2 3)"), 1e-6, same(1.0, 2.0, 3.0));
    assert_directions(&format!("translate (0.1 0 0) {{ {} }}", given("(1 2 3)")), 1e-6, same(1.0, 2.0, 3.0));
    let turned = format!("rotate axis z degrees 90 {{ {} }}", given("(1 2 3)"));
    assert_directions(&turned, 1e-6, same(-2.0, 1.0, 3.0));
    let stretched = format!("affine (2 0 0 0.1 0 3 0 0 0 0 4 0) {{ {} }}", given("(1 1 1)"));
    assert_directions(&stretched, 1e-6, same(2.0, 3.0, 4.0));
    let sheared = format!("affine (1 0.5 0 0 0 1 0 0 0 0 1 0) {{ {} }}", given("(0 1 0)"));
    assert_directions(&sheared, 1e-6, same(0.5, 1.0, 0.0));
    // What stands below the node that gives it does not turn it.
    let below = format!("grain (1 2 3) {{ rotate axis z degrees 90 {{ {BALL} }} }}");
    assert_directions(&below, 1e-6, same(1.0, 2.0, 3.0));
    let both = format!("rotate axis x degrees 90 {{ rotate axis z degrees 90 {{ {} }} }}", given("(1 0 0)"));
    assert_directions(&both, 1e-6, same(0.0, 0.0, 1.0));
    // A pattern and a formula lie in the space of the node, and their values turn.
    let pattern = "checker { a (1 0 0) b (1 0 0) size 0.3 }";
    assert_directions(
        &format!("rotate axis z degrees 90 {{ {} }}", given(pattern)),
        1e-6,
        same(0.0, 1.0, 0.0),
    );
    let around = "expression { (-y, x, 0) }";
    let stretched = format!("affine (2 0 0 0 0 1 0 0 0 0 1 0) {{ {} }}", given(around));
    assert_directions(&stretched, 1e-5, |[x, y, _]| Some([-2.0 * y, 0.5 * x, 0.0]));
}

#[test]
fn warps_turn_by_their_derivative() {
    let twisted = format!("twist axis z rate 0.7 {{ grain (0 0 1) {{ {BALL} }} }}");
    assert_directions(&twisted, 1e-5, |[x, y, _]| Some([-0.7 * y, 0.7 * x, 1.0]));
    let sideways =
        format!("twist axis z rate 0.7 {{ rotate axis z degrees 90 {{ grain (1 0 0) {{ {BALL} }} }} }}");
    assert_directions(&sideways, 1e-5, |[_, _, z]| Some([-(0.7 * z).sin(), (0.7 * z).cos(), 0.0]));
    // Above the warp nothing but maps turn it.
    let above = format!("grain (0 0 1) {{ twist axis z rate 0.7 {{ {BALL} }} }}");
    assert_directions(&above, 1e-6, |_| Some([0.0, 0.0, 1.0]));
    let outside = format!("affine (2 0 0 0 0 1 0 0 0 0 1 0) {{ {twisted} }}");
    assert_directions(&outside, 1e-5, |[x, y, _]| Some([-1.4 * y, 0.35 * x, 1.0]));
    let formula = format!("warp (x, y - 0.3 * x * x, z) {{ grain (1 0 0) {{ {BALL} }} }}");
    assert_directions(&formula, 1e-5, |[x, _, _]| Some([1.0, 0.6 * x, 0.0]));
    let formula = format!("warp (2 * x, y, z) {{ grain expression {{ (x, 0, 1) }} {{ {BALL} }} }}");
    assert_directions(&formula, 1e-5, |[x, _, _]| Some([x, 0.0, 1.0]));
    let nested = format!("twist axis x rate 0.4 {{ {twisted} }}");
    assert_directions(&nested, 1e-4, |_| None);
    let bent = format!("bend axis x rate 0.5 from -1 to 1 {{ grain (0 1 0) {{ {BALL} }} }}");
    assert_directions(&bent, 1e-5, |[_, y, z]| Some([0.0, 1.0 - 0.5 * z, 0.5 * y]));
    let weighted = format!(
        "twist axis z rate 0.7 weighted {{ grain (0 0 1) {{ {BALL} }} blend ricci 2 {{ point {{ radius 3 }} point {{ at (1 0 0) radius 3 }} }} }}"
    );
    assert_directions(&weighted, 1e-4, |_| None);
    let several = format!(
        "sum {{ {twisted} grain (1 0 0) {{ point {{ at (0.5 0 0) radius 1.5 }} }} bend axis x rate 0.3 from -1 to 1 {{
            grain checker {{ a (0 1 0) b (0 0 1) size 0.4 }} {{ {BALL} }} }} }}"
    );
    assert_directions(&several, 1e-4, |_| None);
}

/// Leaves that are given one direction inside of a warp, turned or not, share what is computed of it.
#[test]
fn leaves_of_a_warp_share_a_direction() {
    let two = "sum { point { radius 2 } segment { from (0 0 0) to (0 0.2 0.1) radius 2 } }";
    let around = |grain: &str| format!("twist axis z rate 2 {{ {grain} }}");
    let twisted = |[a, b, c]: [f64; 3]| {
        move |[x, y, z]: [f64; 3]| {
            let (sin, cos) = (2.0 * z).sin_cos();
            // The twist turns by its rate times z, so what has a part along z leans on the way.
            let (a, b) = (cos * a - sin * b, sin * a + cos * b);
            Some([a - 2.0 * c * y, b + 2.0 * c * x, c])
        }
    };
    assert_directions(&around(&format!("grain (1 2 3) {{ {two} }}")), 1e-4, twisted([1.0, 2.0, 3.0]));
    let turned = format!("rotate axis z degrees 90 {{ grain (1 2 3) {{ {two} }} }}");
    assert_directions(&around(&turned), 1e-4, twisted([-2.0, 1.0, 3.0]));
}

#[test]
fn particles_have_directions_of_their_own() {
    let cloud = "particles { at ((0 0 0) (0.3 0 0)) radius (1.5 1) grain ((0 0 1) (0 0 1)) }";
    assert_directions(&format!("affine (1 0 0 0 0 1 0 0 0 0 2 0) {{ {cloud} }}"), 1e-6, |_| {
        Some([0.0, 0.0, 2.0])
    });
    assert_directions(&format!("twist axis z rate 0.7 {{ {cloud} }}"), 1e-5, |[x, y, _]| {
        Some([-0.7 * y, 0.7 * x, 1.0])
    });
}

/// Where a warp folds space into a plane no direction comes out of it: it is 0 and no NaN.
#[test]
fn what_has_no_inverse_is_finite() {
    let tree = model(&format!("warp (x, 0 * y, z) {{ grain (0 1 0) {{ {BALL} }} }}"));
    for found in grains(&tree, &[[0.1, 0.2, 0.3], [0.0; 3]]) {
        assert!(found.iter().all(|x| x.is_finite()), "{found:?}");
    }
}

/// Who asks for no directions has the program of a model without them.
#[test]
fn what_is_not_asked_for_costs_nothing() {
    let scene = |kind: &str| {
        tree(&format!("jbt 1 attribute grain {kind} twist axis z rate 0.7 {{ grain (0 0 1) {{ {BALL} }} }}"))
    };
    let program = |tree: &CheckedTree, query: Query| {
        let tree = tree.of_attributes(&["color"]).expect("there is one");
        jbt_lower::lower(&tree, query).expect("it lowers").function.to_string()
    };
    for query in [Query::FIELD, Query::GRADIENT, Query::ATTRIBUTES, Query::ALL] {
        assert_eq!(program(&scene("direction"), query), program(&scene("3"), query));
    }
}
