//! Places at which the fields of two models differ: every one is found, however small it is, and outside of
//! them the fields are equal.

use jbt::differing::{DifferingPlace, differing_places};
use jbt::{Box3, Compiler, Evaluator, Points, Query};
use jbt_model::check::CheckedTree;
use jbt_testkit::scene::tree;

fn found(first: &CheckedTree, second: &CheckedTree) -> Vec<DifferingPlace> {
    differing_places(&Compiler::new(), [first, second], None).unwrap()
}

/// Checks that each place is in one of these boxes, and that it holds a point that differs by so much.
fn expect(first: &str, second: &str, boxes: &[([f64; 3], [f64; 3], f32)]) {
    let [a, b] = [first, second].map(tree);
    for (a, b) in [(&a, &b), (&b, &a)] {
        let places = found(a, b);
        assert_eq!(places.len(), boxes.len(), "{first} and {second}: {places:?}");
        for (low, high, most) in boxes {
            let is_there = |place: &&DifferingPlace| {
                let near = |x: f64, side: f64, room: f64| (x - side).abs() <= room;
                (0..3).all(|axis| {
                    let room = 0.1 * (high[axis] - low[axis]);
                    near(place.bounds.low[axis], low[axis], room)
                        && near(place.bounds.high[axis], high[axis], room)
                })
            };
            let place = places.iter().find(is_there);
            let place =
                place.unwrap_or_else(|| panic!("{first} and {second}: {low:?} {high:?} in {places:?}"));
            assert!((place.most - most).abs() <= 0.15 * most, "{first} and {second}: {place:?}");
            assert!(place.bounds.contains(place.at), "{place:?}");
        }
    }
}

#[test]
fn small_changes_are_found_far_away() {
    let [big, far, added] =
        ["point { radius 10 }", "point { at (30 0 0) radius 0.3 }", "point { at (0 20.3 0.2) radius 0.3 }"];
    let place = ([-0.3, 20.0, -0.1], [0.3, 20.6, 0.5], 1.0);
    expect(&format!("union {{ {big} {far} {added} }}"), &format!("union {{ {big} {far} }}"), &[place]);
    // A millionth of the size of the scene.
    let tiny = "point { at (1000 0 0) radius 0.002 }";
    let place = ([999.998, -0.002, -0.002], [1000.002, 0.002, 0.002], 1.0);
    expect(&format!("sum {{ {big} {far} {tiny} }}"), &format!("sum {{ {big} {far} }}"), &[place]);
}

#[test]
fn each_place_has_its_box() {
    let scene = |low: f64, high: f64| {
        format!(
            "union {{ point {{ radius {low} }} point {{ at (0 0 5) radius {high} }} point {{ at (20 0 0) radius 3 }} }}"
        )
    };
    let most = |small: f64, large: f64| {
        let field = |r: f64, d: f64| (1.0 - (d / r).powi(2)).max(0.0).powi(3);
        (0..1000)
            .map(|i| f64::from(i) * large / 1000.0)
            .fold(0.0, |most: f64, d| most.max(field(large, d) - field(small, d)))
    };
    let box_of = |z: f64, r: f64, most: f64| ([-r, -r, z - r], [r, r, z + r], most as f32);
    expect(
        &scene(1.0, 1.0),
        &scene(1.2, 0.8),
        &[box_of(0.0, 1.2, most(1.0, 1.2)), box_of(5.0, 1.0, most(0.8, 1.0))],
    );
    expect(&scene(1.0, 1.0), &scene(1.0, 1.0), &[]);
    // The same operands in another order are the same field.
    let [a, b] = ["point { radius 1 }", "ring { ring_radius 2 radius 0.5 }"];
    expect(&format!("union {{ {a} {b} }}"), &format!("union {{ {b} {a} }}"), &[]);
    // Under maps and warps, the place is where they take it.
    let moved = |inner: &str| format!("translate (5 0 0) {{ scale 2 {{ union {{ {inner} {b} }} }} }}");
    expect(&moved(""), &moved(a), &[([3.0, -2.0, -2.0], [7.0, 2.0, 2.0], 1.0)]);
}

#[test]
fn what_is_hidden_differs_nowhere() {
    let hidden = |radius: f64| {
        format!(
            "union {{ box {{ half (3 3 3) radius 1 }} point {{ at (1 0 0) radius {radius} strength 0.5 }} }}"
        )
    };
    expect(&hidden(0.5), &hidden(0.7), &[]);
}

#[test]
fn unbounded_fields_take_a_region() {
    let ground = |z: f64| {
        tree(&format!("union {{ half_space {{ at (0 0 {z}) radius 1 }} point {{ at (0 0 9) radius 1 }} }}"))
    };
    let [a, b] = [ground(0.0), ground(0.5)];
    assert!(differing_places(&Compiler::new(), [&a, &b], None).is_err());
    let region = Box3::new([-4.0; 3], [4.0; 3]);
    let places = differing_places(&Compiler::new(), [&a, &b], Some(region)).unwrap();
    let [place] = &places[..] else { panic!("{places:?}") };
    assert!(place.most > 0.3 && place.bounds.high[2] < 1.7 && place.bounds.low[2] > -0.3, "{place:?}");
    // One that is all over in both is compared no farther than it differs.
    let bump =
        tree("union { half_space { radius 1 } point { at (0 0 9) radius 1 } point { at (0 0 5) radius 1 } }");
    let [place] = &found(&ground(0.0), &bump)[..] else { panic!() };
    assert!(place.most > 0.9 && place.bounds.low[2] > 3.9 && place.bounds.high[2] < 6.1, "{place:?}");
}

/// The fields of a model at points of the world.
fn fields(tree: &CheckedTree, at: &[[f64; 3]]) -> Vec<f32> {
    let evaluator = Evaluator::compile(tree, Query::FIELD).unwrap();
    let mut points: Points = evaluator.points();
    at.iter().for_each(|&point| points.push_world(point));
    let mut samples = evaluator.samples();
    evaluator.eval(&points, &mut samples).unwrap();
    samples.field().to_vec()
}

#[test]
fn fields_are_equal_outside_of_the_places() {
    let mut random = fastrand::Rng::with_seed(23);
    let mut differing = 0;
    for case in 0..60 {
        let mut nodes: Vec<String> = (0..6)
            .map(|_| {
                let at = [0; 3].map(|_| 6.0 * random.f64() - 3.0);
                let [r, strength] = [0.4 + random.f64(), if random.u8(..4) == 0 { -0.5 } else { 1.0 }];
                format!("point {{ at ({} {} {}) radius {r} strength {strength} }}", at[0], at[1], at[2])
            })
            .collect();
        let operators = ["sum", "union", "intersection", "difference", "smooth_union 0.2", "blend ricci 3"];
        let [outer, inner] = [0; 2].map(|_| operators[random.usize(..operators.len())]);
        let scene = |nodes: &[String]| {
            let (below, beside) = nodes.split_at(3);
            format!(
                "{outer} {{ translate (0.5 0 0) {{ {inner} {{ {} }} }} {} }}",
                below.join(" "),
                beside.join(" ")
            )
        };
        let first = tree(&scene(&nodes));
        match case % 3 {
            0 => drop(nodes.remove(random.usize(..3))),
            1 => nodes.swap(0, 4),
            _ => nodes[2] = "ring { ring_radius 1 radius 0.3 }".to_owned(),
        }
        let second = tree(&scene(&nodes));
        let places = found(&first, &second);
        differing += i32::from(places.iter().any(|place| place.most > 0.1));
        let points: Vec<[f64; 3]> = (0..20_000).map(|_| [0; 3].map(|_| 10.0 * random.f64() - 5.0)).collect();
        let outside: Vec<[f64; 3]> = points
            .into_iter()
            .filter(|&point| !places.iter().any(|place| place.bounds.contains(point)))
            .collect();
        for ((point, a), b) in outside.iter().zip(fields(&first, &outside)).zip(fields(&second, &outside)) {
            assert!((a - b).abs() <= 2e-6, "{case}: {a} and {b} at {point:?}\n{}", scene(&nodes));
        }
    }
    assert!(differing > 20, "{differing}");
}
