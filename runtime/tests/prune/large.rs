//! Small parts of large models: after many questions there is a tree over the rows, and it changes nothing.

use super::*;

/// Operators of many blobs; the first ones that come are a little different.
fn large(operator: &str, count: usize, moved: f32) -> Model {
    let mut rng = Rng::with_seed(17);
    let mut operands: String = (0..count)
        .map(|index| {
            let [x, y, z] = [(); 3].map(|()| 8.0 * rng.f32() - 4.0);
            let z = if index < 5 { z + moved } else { z };
            format!("point {{ at ({x} {y} {z}) radius {} }} ", 0.05 + 0.2 * rng.f32())
        })
        .collect();
    operands += "segment { from (-4 0 0) to (4 1 0) radius 0.1 } ";
    model(&format!("jbt 1 {operator} {{ {operands} }}"))
}

/// A small box: of some size, flat, or a point.
fn small_box(rng: &mut Rng) -> Box3 {
    let size = [0.0, 1e-3, 0.1, 0.3][rng.usize(0..4)];
    let low: [f32; 3] = std::array::from_fn(|_| 8.0 * rng.f32() - 4.0);
    Box3::new(low, low.map(|side| side + size * rng.f32()))
}

#[test]
fn small_parts_of_large_models_have_the_rows_that_a_pass_finds() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let whole = Box3::new([-5.0; 3], [5.0; 3]);
    for operator in ["sum", "union", "difference", "intersection", "ricci 2", "smooth_union width 0.1"] {
        let check = |moved: f32| large(operator, 6000, moved).check().expect("a good model");
        let (tree, edited) = (check(0.0), check(0.5));
        let pruner = Pruner::new(&compiler, &tree).expect("it compiles");
        let mut rng = Rng::with_seed(4);
        let boxes: Vec<Box3> = (0..112).map(|_| small_box(&mut rng)).collect();
        let region = |pruner: &Pruner, bounds: &Box3| pruner.region(*bounds).expect("a region");
        let before: Vec<Region> = boxes.iter().map(|bounds| region(&pruner, bounds)).collect();
        let evaluator = compiler.evaluator(&tree, Query::ALL).expect("it compiles");
        let model = large(operator, 6000, 0.0);
        let (mut rows, mut asked) = (0, 0);
        // The first 64 questions are answered by passes, as all are of a fresh pruner: some of them are enough.
        for (bounds, found) in boxes.iter().zip(&before).skip(short_or_long([56, 0])) {
            let fresh = Pruner::new(&compiler, &tree).expect("it compiles");
            assert_eq!(found.selection(), region(&fresh, bounds).selection(), "{operator} {bounds:?}");
            let points = points_in(&mut rng, bounds, 4);
            compare(operator, &model, &evaluator, found, &points);
            rows += found.rows();
            asked += 1;
        }
        println!("{operator}: {} rows of {} in a box", rows / asked, pruner.everywhere().rows());
        assert!(rows / asked < 40, "few rows reach a small box");
        let all = region(&pruner, &whole);
        assert!(operator != "sum" || all.rows() > 6000, "in all of the model all rows matter");
        // The tree follows an edit.
        let later = pruner.updated(&edited).expect("it compiles");
        let fresh = Pruner::new(&compiler, &edited).expect("it compiles");
        let at = Box3::new([-4.0; 3], [4.0; 3]);
        for bounds in boxes.iter().chain([&at]) {
            let [found, expected] = [&later, &fresh].map(|pruner| region(pruner, bounds));
            assert_eq!(found.selection(), expected.selection(), "{operator} {bounds:?}, edited");
        }
    }
}

#[test]
fn rows_that_reach_far_are_found_by_a_tree_too() {
    for (operator, rows) in [("union", "primitives"), ("union", "formulas"), ("intersection", "formulas")] {
        let mut rng = Rng::with_seed(11);
        let sign = if operator == "union" { '-' } else { '+' };
        let operands: String = (0..6000)
            .map(|_| {
                let [x, y, z] = [(); 3].map(|()| 8.0 * rng.f32() - 4.0);
                match rows {
                    "primitives" => format!("point {{ at ({x} {y} {z}) radius 20 }} "),
                    _ => {
                        format!("expression {{ 0.6 {sign} sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2) }} ")
                    }
                }
            })
            .collect();
        let model = model(&format!("jbt 1 {operator} {{ {operands} }}"));
        let tree = model.check().expect("a good model");
        let compiler = Compiler::for_engine(Engine::Lanes);
        let pruner = Pruner::new(&compiler, &tree).expect("it compiles");
        let evaluator = compiler.evaluator(&tree, Query::ALL).expect("it compiles");
        let boxes: Vec<Box3> = (0..100).map(|_| small_box(&mut rng)).collect();
        let (mut taken, rows_are_formulas) = (Vec::new(), rows == "formulas");
        let (mut found, mut rows) = (0, 0);
        for bounds in &boxes {
            let before = pruner.counters().interval_evaluations;
            let region = pruner.region(*bounds).expect("a region");
            taken.push(pruner.counters().interval_evaluations - before);
            compare(operator, &model, &evaluator, &region, &points_in(&mut rng, bounds, 4));
            rows += region.rows();
            found += usize::from(region.rows() < 400);
        }
        println!("{operator}: {} rows in a box; ranges {:?} .. {:?}", rows / 100, taken[0], taken[99]);
        assert!(found > 90, "most boxes have few rows: {found}");
        // Formulas have no distances to count.
        assert!(rows_are_formulas || taken[99] < taken[0] / 4, "{taken:?}");
    }
}
