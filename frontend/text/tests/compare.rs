//! Hashes of models, and what two models differ in.

use jbt_model::bounds::Bounds;
use jbt_model::model::Model;
use jbt_model::walk::walk;
use jbt_text::{compare, field_difference, hash, model, print};

fn read(text: &str) -> Model {
    model(&format!("jbt 1 {text}")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn hashes_are_of_what_a_model_means() {
    // Its value is that of version 2, computed by another program.
    let ball = read("point { radius 1 }");
    assert_eq!(hash(&ball).to_string(), "2-9083e2fe7d33c7f28fa414c386911c40");
    let shared = "let a = point { radius 1 } union { use a translate (1 0 0) { use a } }";
    for (first, second) in [
        ("point { radius 1 }", "name: point { radius 1.0 }"),
        (shared, "union { point { radius 1 } translate (1 0 0) { point { radius 1 } } }"),
        ("param r = 2 point { radius r }", "param r = 1 + 1 point { radius r }"),
    ] {
        assert_eq!(hash(&read(first)), hash(&read(second)), "{first}");
    }
    let all = [
        "point { radius 1 }",
        "point { radius 2 }",
        "iso 0.25 point { radius 1 }",
        "orientation up y point { radius 1 }",
        "sum { point { radius 1 } }",
        "union { point { radius 1 } }",
        "param r = 1 point { radius r }",
        "param s = 1 point { radius s }",
        "attribute heat 1 point { radius 1 }",
        "particles { at ((0 0 0)) radius 1 }",
        "empty",
        "part \"a\" { point { radius 1 } }",
        "part \"b\" { point { radius 1 } }",
        "union { union { point { radius 1 } } }",
        "part \"a\" { point { radius 1 } } part \"b\" { point { radius 2 } }",
        "part \"b\" { point { radius 2 } } part \"a\" { point { radius 1 } }",
        "union { union { point { radius 1 } } union { point { radius 2 } } }",
        "attribute heat 1 attribute cold 1 point { radius 1 }",
        "attribute cold 1 attribute heat 1 point { radius 1 }",
        "difference { point { radius 1 } point { radius 2 } }",
        "difference { point { radius 2 } point { radius 1 } }",
    ];
    for (place, a) in all.iter().enumerate() {
        for b in &all[..place] {
            assert_ne!(hash(&read(a)), hash(&read(b)), "{a} and {b}");
            assert!(!compare(&read(a), &read(b)).is_empty(), "{a} and {b}");
            assert!(!compare(&read(b), &read(a)).is_empty(), "{b} and {a}");
        }
        assert_eq!(hash(&model(&print(&read(a))).unwrap()), hash(&read(a)), "{a}");
    }
}

#[test]
fn items_that_differ_are_named() {
    let first = read(
        "iso 0.5 union { hub: color (1 0 0) { point { radius 1 } } arm: point { radius 2 } point { radius 3 } }",
    );
    let second = read(
        "iso 0.4 union { arm: point { radius 2 } hub: color (0 1 0) { point { radius 1 } } ring { ring_radius 1 radius 1 } }",
    );
    assert!(compare(&first, &first).is_empty());
    let found = compare(&first, &second);
    let words: Vec<(String, Option<String>, Option<String>)> =
        found.into_iter().map(|one| (one.path, one.first, one.second)).collect();
    let some = |text: &str| Some(text.to_owned());
    assert_eq!(words[0], (String::new(), some("iso 0.5"), None));
    assert_eq!(words[1], (String::new(), None, some("iso 0.4")));
    // It has moved behind the arm, and its colour is another one.
    assert_eq!(words[2], ("union.0/hub".to_owned(), some("color (1 0 0)"), some("color (0 1 0)")));
    assert_eq!(words[3], words[2]);
    assert_eq!(words[4], ("union.2/point".to_owned(), some("point { radius 3 }"), None));
    assert!(words[5].0.starts_with("union.3/ring") && words[5].1.is_none(), "{words:?}");
    assert_eq!(words.len(), 6);
    // Subtrees that are shared differ once, and so do long chains.
    let deep = |radius: i32| {
        let mut text = format!("let a0 = point {{ radius {radius} }} ");
        for level in 0..40 {
            text +=
                &format!("let a{} = sum {{ use a{level} translate (1 0 0) {{ use a{level} }} }} ", level + 1);
        }
        read(&(text + "use a40"))
    };
    assert_eq!(compare(&deep(1), &deep(2)).len(), 1);
}

/// What has moved, and from where to where.
fn moves(first: &str, second: &str) -> Vec<(String, [usize; 2])> {
    compare(&read(first), &read(second)).into_iter().filter_map(|one| Some((one.path, one.moved?))).collect()
}

#[test]
fn another_order_is_a_difference() {
    let [a, b] = ["point { at (-0.4 0 0) radius 1 }", "point { at (0.4 0 0) radius 1 }"];
    for operator in ["difference", "select 0", "union", "sum"] {
        let [first, second] = [[a, b], [b, a]].map(|[a, b]| format!("{operator} {{ {a} {b} }}"));
        let word = operator.split(' ').next().unwrap();
        assert_eq!(moves(&first, &second), [(format!("{word}.0/point"), [0, 1])], "{operator}");
        assert_eq!(compare(&read(&first), &read(&second)).len(), 1);
        assert!(moves(&first, &first).is_empty());
    }
    // What is put in front of others moves none of them.
    assert!(
        moves(&format!("sum {{ {a} {b} }}"), &format!("sum {{ ring {{ ring_radius 1 radius 1 }} {a} {b} }}"))
            .is_empty()
    );
    let part = |name: &str| format!("part \"{name}\" {{ point {{ radius 1 }} }} ");
    assert_eq!(
        moves(&(part("a") + &part("b")), &(part("b") + &part("a"))),
        [("union.0/a".to_owned(), [0, 1])]
    );
    assert_eq!(moves("attribute a 1 attribute b 1 empty", "attribute b 1 attribute a 1 empty").len(), 1);
}

#[test]
fn parts_and_nothing_are_told_by_their_words() {
    let ball = "point { radius 1 }";
    let told = |first: &str, second: &str| -> Vec<(Option<String>, Option<String>)> {
        compare(&read(first), &read(second)).into_iter().map(|one| (one.first, one.second)).collect()
    };
    let some = |text: &str| Some(text.to_owned());
    let part = |name: &str| format!("part \"{name}\" {{ {ball} }}");
    assert_eq!(told(&part("a"), &part("b")), [(some("part \"a\""), some("part \"b\""))]);
    assert_eq!(told(&part("a"), &format!("union {{ union {{ {ball} }} }}")).len(), 2);
    assert_eq!(
        told(&format!("sum {{ {ball} }}"), &format!("sum {{ {ball} empty }}")),
        [(None, some("empty"))]
    );
}

/// Where the model of the difference is 0, the fields are equal; `support`: the box that it is in.
fn differs_within(first: &str, second: &str, support: Option<[[f64; 3]; 2]>) {
    let [a, b] = [first, second].map(|text| read(text).check().unwrap());
    let difference = field_difference(&a, &b).unwrap().check().unwrap();
    match support {
        Some([low, high]) => {
            let found = difference.support();
            assert_eq!((found.low(), found.high()), (low, high), "{first} and {second}");
        }
        None => assert_eq!(difference.support(), Bounds::EMPTY, "{first} and {second}"),
    }
    let mut random = fastrand::Rng::with_seed(7);
    for _ in 0..4000 {
        let p = [0; 3].map(|_| 8.0 * random.f64() - 4.0);
        let (told, apart) = (walk(&difference, p).field, (walk(&a, p).field - walk(&b, p).field).abs());
        assert!(told >= 0.0 && (told > 0.0 || apart < 1e-12), "{first} and {second} at {p:?}: {apart}");
    }
}

#[test]
fn fields_are_equal_where_their_difference_is_nothing() {
    let big = "point { radius 2 }";
    let small = |x: f64| format!("point {{ at ({x} 0 0) radius 0.5 }}");
    let of = |operator: &str, nodes: &[&str]| format!("{operator} {{ {} }}", nodes.join(" "));
    let (two, three) = (small(2.0), small(3.0));
    let at = |x: f64| Some([[x - 0.5, -0.5, -0.5], [x + 0.5, 0.5, 0.5]]);
    for operator in ["sum", "union", "ricci 3"] {
        differs_within(&of(operator, &[big, &three]), &of(operator, &[big]), at(3.0));
        differs_within(&of(operator, &[big, &three]), &of(operator, &[&three, big]), None);
        differs_within(
            &of(operator, &[big, &three]),
            &of(operator, &[big, &two]),
            Some([[1.5, -0.5, -0.5], [3.5, 0.5, 0.5]]),
        );
    }
    // One node, and a union of it with another.
    differs_within(big, &of("union", &[big, &three]), at(3.0));
    differs_within(
        &format!("translate (1 0 0) {{ {} }}", of("sum", &[big, &two])),
        &format!("translate (1 0 0) {{ {big} }}"),
        at(3.0),
    );
    differs_within(&format!("color (1 0 0) {{ {big} }}"), &format!("select 1 {{ empty {big} }}"), None);
    let cut = |cuts: &[&str]| of("difference", &[&[big][..], cuts].concat());
    differs_within(&cut(&[&two]), &cut(&[&two, &three]), Some([[-2.0; 3], [3.5, 2.0, 2.0]]));
    differs_within(&cut(&[&two]), big, Some([[-2.0; 3], [2.5, 2.0, 2.0]]));
    differs_within(&of("union", &[&cut(&[&two]), &three]), &cut(&[&two]), at(3.0));
    // These are nothing beyond their first operand.
    for operator in ["intersection", "product"] {
        let (first, second) = (of(operator, &[big, big]), of(operator, &[big, big, &three]));
        differs_within(&first, &second, Some([[-2.0; 3], [2.0; 3]]));
    }
    for operator in ["smooth_union 0.3", "symmetric_difference"] {
        let whole = Some([[-2.0; 3], [3.5, 2.0, 2.0]]);
        differs_within(&of(operator, &[big, big]), &of(operator, &[big, big, &three]), whole);
    }
    // Beside a negative field a zero counts.
    let pit = "point { radius 2 strength -1 }";
    differs_within(
        &of("union", &[pit, pit]),
        &of("union", &[pit, pit, &three]),
        Some([[-2.0; 3], [3.5, 2.0, 2.0]]),
    );
    differs_within(&of("sum", &[pit, big]), &of("sum", &[pit, big, &three]), at(3.0));
    let iso = |iso: f64, node: &str| read(&format!("iso {iso} {node}")).check().unwrap();
    assert!(field_difference(&iso(0.5, &cut(&[&two])), &iso(0.4, &cut(&[&two]))).is_none());
    assert!(field_difference(&iso(0.5, big), &iso(0.4, &two)).is_some());
}
