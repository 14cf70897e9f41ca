//! Skeletons of any number of points: limits, and one shape for any number of them.

use jbt_ir::limits;
use jbt_lower::lower;
use jbt_model::builder::{bezier, catmull_rom, param, polyline};
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_testkit::scene::{assert_reads_back, checked};
use jbt_text::{Options, parse};

#[test]
fn any_number_of_points_is_the_same_code() {
    let line = |count: u32| polyline((0..count).map(|x| [f64::from(x), 0.0, 0.0]), 1.0);
    for query in Query::EVERY {
        let lowered = |tree: Tree| lower(&checked(tree), query).expect("it lowers");
        let one = lowered(line(5));
        assert_eq!(one.function.tables.len(), 2, "the scene, which is the row of the line, and pieces");
        assert_eq!(one.function, lowered(line(700)).function);
        let rows =
            |tree: Tree| lowered(tree).tables.tables.values().map(jbt_ir::Rows::len).collect::<Vec<_>>();
        assert_eq!(rows(line(700)), [1, 699]);
        let sum = (2..1002).map(line).reduce(|sum, line| sum + line).expect("there are lines");
        assert_eq!(rows(sum), [1, 1000, (1..1001).sum::<usize>()]);
        let few = lowered(line(2) + line(3)).function;
        assert_eq!(few, lowered((2..90).map(line).reduce(|sum, line| sum + line).expect("lines")).function);
    }
}

#[test]
fn points_follow_parameters() {
    let end = param("end", 1.0);
    let tube =
        catmull_rom([(0.0.into(), 0.0, 0.0), (end.clone(), 1.0, 0.0)], 0.5).radii([end * 0.1, 0.2.into()]);
    let model = Model::new(tube);
    let tree = model.check().expect("a good model");
    assert_reads_back(&model);
    let far = tree.with_parameters(&[("end", 3.0)]).expect("a good value");
    assert_eq!(far.support().high(), [3.7, 1.7, 0.8]);
    let [before, now] = [&tree, &far].map(|tree| lower(tree, Query::ALL).expect("it lowers"));
    assert_eq!(before.function, now.function);
    let refused = tree.with_parameters(&[("end", -1.0)]).unwrap_err();
    assert_eq!(refused[0].message, "number 1 of the `radii` of the catmull_rom is (-0.1)");
}

#[test]
fn lists_have_a_limit() {
    let text = |count: usize| {
        let points = "(1 2 3)".to_owned() + &"(0 0 0)".repeat(count - 1);
        format!("jbt 1 polyline {{ points ({points}) radius 1 }}")
    };
    let read = |count| parse(text(count).as_bytes(), &Options::default());
    assert!(read(limits::MAX_SKELETON_POINTS).expect("it reads").check().is_ok());
    let errors = read(limits::MAX_SKELETON_POINTS + 1).unwrap_err();
    assert_eq!(errors[0].message, "a list of 65537 elements");
    let points = vec![[1.0, 2.0, 3.0]; limits::MAX_SKELETON_POINTS + 1];
    let errors = Model::new(polyline(points, 1.0).radii([1.0])).check().unwrap_err();
    assert_eq!(errors[0].message, "a list of 65537 elements");
}

#[test]
fn curves_have_a_limit_of_pieces() {
    let arc = || bezier([[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]], 1e-14);
    let lowered = lower(&checked(arc()), Query::FIELD).expect("it lowers");
    let pieces = lowered.tables.tables.values().last().expect("there are tables").len();
    assert_eq!(pieces, 1 << limits::MAX_CURVE_HALVINGS);
    // Each is a row: 977 of them are more than there may be.
    let many = |count: usize| Model::new(Tree::sum((0..count).map(|_| arc())));
    assert!(many(970).check().is_ok());
    let errors = many(980).check().unwrap_err();
    assert!(errors[0].message.contains("nodes and pieces; it may have 4000000"), "{}", errors[0].message);
}
