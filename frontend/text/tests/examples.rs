//! The example scenes: they are read, make sense, print as themselves, and fit into the box from -2 to 2.

use jbt_model::diagnostic::{Diagnostics, Source};
use jbt_testkit::scene::{assert_reads_back, examples, options};
use jbt_text::parse;

#[test]
fn every_example_is_a_model() {
    for (name, text) in examples() {
        assert!(text.starts_with("# "), "{name} opens with a comment that says what it shows");
        let source = Source { name: &name, text: text.as_bytes() };
        let shown = |errors: Diagnostics| -> String {
            errors.iter().map(|error| source.render(error) + "\n").collect()
        };
        let model = parse(text.as_bytes(), &options()).unwrap_or_else(|errors| panic!("{}", shown(errors)));
        let checked = model.check().unwrap_or_else(|errors| panic!("{}", shown(errors)));
        assert_reads_back(&model);
        let support = checked.support();
        assert!(
            support.low().iter().all(|&x| x >= -2.0) && support.high().iter().all(|&x| x <= 2.0),
            "{name}: {support:?}"
        );
    }
}
