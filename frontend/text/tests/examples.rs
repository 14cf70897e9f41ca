//! The example scenes: they are read, make sense, print as themselves, and fit into the box from -2 to 2.

use std::path::Path;

use jbt_model::diagnostic::{Diagnostics, Source};
use jbt_text::{Options, parse, print};

#[test]
fn every_example_is_a_model() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "jbt") {
            continue;
        }
        count += 1;
        let name = path.display().to_string();
        let text = std::fs::read(&path).unwrap();
        assert!(text.starts_with(b"# "), "{name} opens with a comment that says what it shows");
        let source = Source { name: &name, text: &text };
        let shown = |errors: Diagnostics| -> String {
            errors.iter().map(|error| source.render(error) + "\n").collect()
        };
        let model = parse(&text, &Options::default()).unwrap_or_else(|errors| panic!("{}", shown(errors)));
        let checked = model.check().unwrap_or_else(|errors| panic!("{}", shown(errors)));
        assert_eq!(parse(print(&model).as_bytes(), &Options::default()).unwrap(), model, "{name}");
        let support = checked.support();
        assert!(
            support.low().iter().all(|&x| x >= -2.0) && support.high().iter().all(|&x| x <= 2.0),
            "{name}: {support:?}"
        );
    }
    assert!(count >= 24);
}
