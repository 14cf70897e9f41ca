//! Directions: how their groups are declared and printed.

use jbt_model::attribute::GroupKind;
use jbt_model::model::Model;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::{compare, hash, model, print};

fn read(text: &str) -> Model {
    model(&format!("jbt 1 {text} point {{ radius 1 }}")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_direction_stands_where_the_width_would() {
    for (text, printed) in [
        ("attribute grain direction", "attribute grain direction default (0 0 0) blend\n"),
        (
            "attribute grain direction default (0 0 1) dominant",
            "attribute grain direction default (0 0 1) dominant\n",
        ),
    ] {
        let model = read(text);
        assert_eq!((model.attributes[1].kind, model.attributes[1].width()), (GroupKind::Direction, 3));
        assert!(print(&model).contains(printed), "{}", print(&model));
        assert_reads_back(&model);
    }
    let (turned, still) = (read("attribute grain direction"), read("attribute grain 3"));
    assert_ne!(hash(&turned), hash(&still));
    assert!(!compare(&turned, &still).is_empty());
}

/// What is called like the word is what it was.
#[test]
fn a_number_of_this_name_is_a_width() {
    let model = read("let direction = 2 attribute grain direction");
    assert_eq!((model.attributes[1].kind, model.attributes[1].width()), (GroupKind::Numbers, 2));
    let model = read("attribute direction 1 attribute grain direction");
    assert_eq!(model.attributes[2].kind, GroupKind::Direction);
    assert_reads_back(&model);
}

#[test]
fn a_direction_has_three_reals() {
    for text in ["attribute grain direction default (0 1)", "attribute grain direction grain (1 2) { empty }"]
    {
        let text = format!("jbt 1 {text} point {{ radius 1 }}");
        assert!(model(&text).and_then(|model| model.check()).is_err(), "{text}");
    }
    let mut built = read("attribute grain direction");
    built.attributes[1].default = vec![0.0; 2];
    let found = built.check().unwrap_err().to_string();
    assert!(found.contains("the direction `grain` has 2 reals"), "{found}");
}
