//! What the check says of attribute nodes that compute.

use jbt_model::builder::{checker, point};
use jbt_model::model::Model;
use jbt_testkit::scene;

#[test]
fn judges_what_attribute_nodes_compute() {
    let model = |text: &str| scene::model(&format!("attribute uv 2 param size = 0 {text}"));
    let messages = |text: &str| {
        let errors = model(text).check().unwrap_err();
        errors
            .into_iter()
            .map(|error| {
                assert!(error.span.is_some(), "{} has a place", error.message);
                error.message
            })
            .collect::<Vec<_>>()
    };
    let ball = "{ point { radius 1 } }";
    for (head, expected) in [
        ("color checker { a (1 1 1) b (0 0 0) size 0 }", "the `size` of the checker is 0"),
        ("color checker { a (1 1 1) b (0 0 0) size size }", "the `size` of the checker is 0"),
        ("color stripes { a (1 1 1) b (0 0 0) along (0 0 0) }", "the `along` of the stripes is (0 0 0)"),
        ("color noise { a (1 1 1) b (0 0 0) octaves 9 }", "the `octaves` of the noise are 9"),
        ("color noise { a (1 1 1e16) b (0 0 0) }", "the attribute `color` is (1 1 10000000000000000)"),
        (
            "uv scale 1e20",
            "the map of the uv (scale, degrees, shift) is (100000000000000000000 100000000000000000000 0 0 0)",
        ),
    ] {
        assert_eq!(messages(&format!("{head} {ball}")), [expected]);
    }
    // Trees that no text gives.
    let leaf = || point([0, 0, 0], 1);
    for (tree, expected) in [
        (
            leaf().textured("color", checker(1.0), &[1.0], &[0.0; 3]),
            "the attribute `color` has width 3, not 1",
        ),
        (leaf().uv("color"), "the attribute `color` has width 3, and a uv has 2"),
    ] {
        let errors = Model::new(tree).check().unwrap_err();
        assert_eq!(errors[0].message, expected);
    }
}
