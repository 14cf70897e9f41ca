//! Weights of leaves and of names: against closed forms, the oracle and the colours that they mix, by every
//! engine, in regions and at points.

mod common;

use common::answers;
use jbt::mesh::Lattice;
use jbt::sample::Sampler;
use jbt::tree::{DEFAULT_WEIGHT, WEIGHTS, WeightOf};
use jbt::walk::walk;
use jbt::{CheckedTree, Compiler, Engine, Fineness, Points, Polygonize, Query, Samples};
use jbt_testkit::random::Random;
use jbt_testkit::scene::{OPERATORS, tree};
use jbt_testkit::skip::short_or_long;

/// The tree with the weights of its leaves, and that of nobody behind them.
fn weighted(tree: &CheckedTree) -> CheckedTree {
    let all = tree.with_weights(WeightOf::Leaves).and_then(|tree| tree.with_weights(WeightOf::Default));
    all.unwrap_or_else(|errors| panic!("{errors}"))
}

/// The planes of some groups.
fn planes(samples: &Samples, groups: &[&str]) -> Vec<Vec<f32>> {
    let of = |group: &&str| samples.attribute(group).expect("it is asked for").to_vec();
    groups.iter().flat_map(of).collect()
}

fn bits(planes: &[Vec<f32>]) -> Vec<Vec<u32>> {
    planes.iter().map(|plane| plane.iter().map(|x| x.to_bits()).collect()).collect()
}

/// The planes of some groups at some points, the same to the bit by every engine and beside other answers.
fn asked(tree: &CheckedTree, points: &Points, groups: &[&str]) -> Vec<Vec<f32>> {
    let mut found: Option<Vec<Vec<f32>>> = None;
    for engine in Engine::ALL {
        for query in [Query::ATTRIBUTES, Query::ALL] {
            let evaluator = Compiler::for_engine(engine).evaluator(tree, query).expect("it compiles");
            let planes = planes(&answers(&evaluator, points), groups);
            let same = found.get_or_insert_with(|| planes.clone());
            assert_eq!(bits(same), bits(&planes), "{} {query}", engine.name());
        }
    }
    found.expect("there are engines")
}

/// The numbers of planes, point by point.
fn rows(planes: &[Vec<f32>]) -> Vec<Vec<f64>> {
    let row = |index: usize| planes.iter().map(|plane| f64::from(plane[index])).collect();
    (0..planes[0].len()).map(row).collect()
}

/// Points about the origin.
fn points(count: usize) -> Points {
    let mut rng = fastrand::Rng::with_seed(19);
    (0..count).map(|_| std::array::from_fn(|_| 3.0 * rng.f32() - 1.5)).collect()
}

/// A point of the world.
fn place(points: &Points, index: usize) -> [f64; 3] {
    points.get(index).map(f64::from)
}

const A: &str = "point { at (-0.4 0 0) radius 1.5 }";
const B: &str = "point { at (0.5 0.2 0) radius 1.2 }";

/// Asserts the weights of the points A and B below something, by a formula of their fields; nothing says
/// that they are not of interest there.
fn assert_weights(text: &str, expected: impl Fn(f64, f64) -> Option<[f64; 2]>) {
    let [a, b] = [A, B].map(tree);
    let points = points(1500);
    let found = asked(&weighted(&tree(text)), &points, &[WEIGHTS, DEFAULT_WEIGHT]);
    assert_eq!(found.len(), 3, "two leaves and nobody");
    let mut seen = 0;
    for index in 0..points.len() {
        let [f, g] = [&a, &b].map(|leaf| walk(leaf, place(&points, index)).field);
        let Some([of_a, of_b]) = expected(f, g) else { continue };
        let answer: Vec<f64> = found.iter().map(|plane| f64::from(plane[index])).collect();
        for (found, expected) in answer.iter().zip([of_a, of_b, 1.0 - of_a - of_b]) {
            assert!((found - expected).abs() < 2e-5, "{text}: {answer:?} for {of_a} {of_b} at {f} {g}");
        }
        seen += usize::from(of_a * of_b > 0.0 || of_a != of_b);
    }
    assert!(seen > 100, "{text}: {seen} points");
}

#[test]
fn two_points_have_the_weights_of_closed_forms() {
    let nobody = Some([0.0; 2]);
    let part = |f: f64, g: f64| if f + g > 0.0 { Some([f / (f + g), g / (f + g)]) } else { nobody };
    assert_weights(&format!("sum {{ {A} {B} }}"), part);
    assert_weights(&format!("blend ricci 3 {{ {A} {B} }}"), |f, g| part(f.powi(3), g.powi(3)));
    assert_weights(&format!("union {{ {A} {B} }}"), |f, g| match f.max(g) {
        0.0 => nobody,
        _ if f == g => None,
        _ => Some(if f > g { [1.0, 0.0] } else { [0.0, 1.0] }),
    });
    assert_weights(&format!("intersection {{ {A} {B} }}"), |f, g| match f.min(g) {
        0.0 => nobody,
        _ => Some(if f < g { [1.0, 0.0] } else { [0.0, 1.0] }),
    });
    // What cuts shows where it cuts: min(f, 2 iso - g).
    assert_weights(&format!("iso 0.5 difference {{ {A} {B} }}"), |f, g| match f.min(1.0 - g) {
        field if field <= 0.0 => nobody,
        _ if (f - (1.0 - g)).abs() < 1e-4 => None,
        _ => Some(if g > 0.0 && 1.0 - g < f { [0.0, 1.0] } else { [1.0, 0.0] }),
    });
    // Of the derivatives of max + (K - |f - g|)^2 / (4 K), where K is the width.
    let width = 0.3;
    assert_weights(&format!("smooth_union width {width} {{ {A} {B} }}"), |f, g| {
        if f + g < 2.0 * width {
            return None;
        }
        let q = (1.0 - (f - g).abs() / width).max(0.0);
        let [lower, upper] = [f.min(g) * q / 2.0, f.max(g) * (1.0 - q / 2.0)];
        if f < g { part(lower, upper) } else { part(upper, lower) }
    });
    // Somewhere below other nodes, and used twice: both uses count.
    let turned = format!("rotate axis z degrees 90 {{ rotate axis z degrees -90 {{ sum {{ {A} {B} }} }} }}");
    assert_weights(&turned, part);
    assert_weights(&format!("let a = {A} sum {{ use a {B} use a }}"), |f, g| part(2.0 * f, g));
    assert_weights(&format!("let a = {A} sum {{ scale 1 {{ use a }} sum {{ {B} use a }} }}"), |f, g| {
        part(2.0 * f, g)
    });
}

/// Three leaves, each with a colour of its own, under every operator: what the weights make of the colours is
/// the colour.
#[test]
fn weights_mix_colours() {
    const COLORS: [[f64; 3]; 4] = [[0.9, 0.1, 0.3], [0.2, 0.8, 0.1], [0.05, 0.25, 0.95], [0.5, 0.6, 0.7]];
    let leaf = |color: [f64; 3], leaf: &str| {
        let [r, g, b] = color;
        format!("color ({r} {g} {b}) {{ {leaf} }} ")
    };
    let [a, b, c] = [
        leaf(COLORS[0], "point { radius 1.4 }"),
        leaf(COLORS[1], "translate (0.6 0 0) { segment { from (0 0 0) to (0.5 0 0) radius 1.1 } }"),
        leaf(COLORS[2], "box { center (0 0.7 0) half (0.7 0.1 0.2) radius 0.8 }"),
    ];
    let mut texts: Vec<String> = OPERATORS.iter().map(|one| format!("{one} {{ {a}{b}{c} }}")).collect();
    for (outer, inner) in OPERATORS.iter().zip(OPERATORS.iter().cycle().skip(1)) {
        texts.push(format!("{outer} {{ twist axis z rate 0.4 {{ {inner} {{ {a}{b} }} }} {c} }}"));
    }
    texts.push(format!("sum {{ complement {{ {a} }} {b}{c} }}"));
    texts.push(format!("union {{ shell 0.1 {{ {a} }} offset 0.05 {{ {b} }} {c} }}"));
    texts.push(format!("sum {{ select 1 {{ {a} {b} }} {c} {a} }}"));
    texts.push(format!("deform by (0.1 0 0) weighted {{ sum {{ {a} {b} }} {c} }}"));
    let points = points(200);
    for text in texts {
        let tree = tree(&format!("jbt 1 attribute color 3 default (0.5 0.6 0.7) {text}"));
        let leaves = tree.answering_leaves();
        let all = weighted(&tree);
        let found = asked(&all, &points, &[WEIGHTS, DEFAULT_WEIGHT, "color"]);
        let colors: Vec<[f64; 3]> =
            leaves.iter().map(|leaf| color_of(&tree, *leaf)).chain([COLORS[3]]).collect();
        let count = colors.len();
        assert_eq!(found.len(), count + 3, "{text}");
        let (mut shared, mut nobody) = (0, 0);
        for (index, row) in rows(&found).iter().enumerate() {
            let (weights, color) = row.split_at(count);
            let sum: f64 = weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "{text} {index}: {sum}");
            for (channel, found) in color.iter().enumerate() {
                let mixed: f64 =
                    weights.iter().zip(&colors).map(|(weight, color)| weight * color[channel]).sum();
                assert!((mixed - found).abs() < 1e-5, "{text} {index}: {mixed} {found}");
            }
            shared += usize::from(weights.iter().any(|&weight| weight > 0.0 && weight < 1.0));
            nobody += usize::from(weights[count - 1] == 1.0);
        }
        assert!(nobody < points.len(), "{text}: nobody is heard");
        assert!(shared > 20 || !["sum", "blend ricci 3"].contains(&text.split(" {").next().unwrap()));
    }
}

/// The colour that a leaf was given: the nearest above it.
fn color_of(tree: &CheckedTree, leaf: jbt::NodeId) -> [f64; 3] {
    use jbt::tree::NodeKind;
    use jbt_model::attribute::AttributeValue;
    let mut at = leaf;
    loop {
        let above = tree.nodes().iter().position(|node| node.children.contains(&at)).expect("a colour above");
        let kind = &tree.nodes()[above].kind;
        if let NodeKind::Attribute { name, value: AttributeValue::Numbers(numbers), .. } = kind
            && &**name == "color"
        {
            return numbers[..].try_into().expect("three reals");
        }
        at = jbt::NodeId(above as u32);
    }
}

/// Of random models, weights of all leaves and of nobody are parts of 1, in the oracle and by every engine.
#[test]
fn weights_of_random_models_are_parts_of_one() {
    let points = points(40);
    let (mut models, mut asked_points, mut refused) = (0, 0, 0);
    let seeds = short_or_long([60, 150]);
    for seed in 0..seeds {
        let model = Random::new(seed, seed + 1000).model(9);
        let Ok(tree) = model.check() else { continue };
        let Ok(all) = tree.with_weights(WeightOf::Leaves) else {
            refused += 1;
            continue;
        };
        let all = all.with_weights(WeightOf::Default).unwrap();
        let found = asked(&all, &points, &[WEIGHTS, DEFAULT_WEIGHT]);
        let first = tree.attributes().len();
        for index in 0..points.len() {
            let sample = walk(&all, place(&points, index));
            let exact = sample.attributes[first..].concat();
            assert_eq!(exact.len(), found.len());
            let sum: f64 = exact.iter().sum();
            assert!((sum - 1.0).abs() < 1e-9, "seed {seed}: {exact:?}");
            assert!(exact.iter().all(|&weight| (-1e-12..1.0 + 1e-12).contains(&weight)), "{exact:?}");
            let sum: f64 = found.iter().map(|plane| f64::from(plane[index])).sum();
            assert!((sum - 1.0).abs() < 1e-4, "seed {seed} {index}: {sum}");
            asked_points += 1;
        }
        models += 1;
    }
    assert!(
        5 * models > 4 * seeds && 3 * asked_points > 80 * seeds && 10 * refused < seeds,
        "{models} {asked_points} {refused}"
    );
}

const LIMBS: &str = "jbt 1
let pin = point { radius 1.6 }
body: sum {
    left: translate (-0.5 0 0) { sum { use pin hand: point { at (-0.6 0 0) radius 1.4 } } }
    right: translate (0.5 0 0) { use pin }
    particles { at ((0 0.5 0) (0 0.9 0)) radius 1 }
}";

#[test]
fn names_have_weights() {
    let tree = tree(LIMBS);
    let named = |path: &str| tree.with_weights(WeightOf::Named(path));
    let of = |path: &str| {
        let points = points(100);
        let group = format!("{path}.weight");
        asked(&named(path).unwrap(), &points, &[&group]).remove(0)
    };
    let [left, right, hand, pin, body] = ["left", "right", "body/left/hand", "pin", "body"].map(of);
    let leaves = asked(&weighted(&tree), &points(100), &[WEIGHTS, DEFAULT_WEIGHT]);
    // The leaves are the pin, the hand and the particles, in the order of the text.
    assert_eq!(leaves.len(), 4);
    let near = |a: f32, b: f32| (a - b).abs() < 1e-5;
    let mut both = 0;
    for index in 0..left.len() {
        let [of_pin, of_hand, particles, nobody] = [0, 1, 2, 3].map(|leaf| leaves[leaf][index]);
        assert!(near(hand[index], of_hand) && near(pin[index], of_pin));
        assert!(near(left[index] + right[index], of_pin + of_hand));
        assert!(near(body[index] + nobody, 1.0) && near(body[index], of_pin + of_hand + particles));
        both += usize::from(left[index] > 0.0 && right[index] > 0.0);
    }
    assert!(both > 20, "{both}");
    for (path, words) in [
        ("leg", "nothing in the model is called `leg`"),
        ("a b", "is no path"),
        ("left/pin", "`left/pin` leads to 1 of the 2 places of one shared node"),
    ] {
        let error = named(path).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let twice = named("left").unwrap().with_weights(WeightOf::Named("left")).unwrap_err().to_string();
    assert!(twice.contains("an attribute `left.weight` of its own"), "{twice}");
}

#[test]
fn columns_are_called_by_the_ways_to_leaves() {
    let tree = tree(LIMBS).with_owners().unwrap().with_coverage("color").unwrap();
    let evaluator = Compiler::new().evaluator(&weighted(&tree), Query::ATTRIBUTES).unwrap();
    let names: Vec<&str> = evaluator.layout().names().iter().map(String::as_str).collect();
    let expected = [
        "owner",
        "color.defined",
        "weights.body/left/pin",
        "weights.body/left/hand",
        "weights.body/2.particles",
        "weights.default",
    ];
    assert_eq!(names[4..], expected);
}

/// Samples of a lattice and vertices of a mesh, for which rows are left out, have the weights of points.
#[test]
fn regions_have_the_bits_of_points() {
    let text = format!("union {{ blend ricci 2 {{ {A} {B} point {{ at (0 -1 0) radius 0.8 }} }} {A} }}");
    let all = weighted(&tree(&text));
    let groups = [WEIGHTS, DEFAULT_WEIGHT];
    let settings = Polygonize { fineness: Fineness::Resolution(24), sharp: false, ..Polygonize::default() };
    let mesh = settings.mesh(&Compiler::new(), &all).run().unwrap().mesh;
    let vertices: Points = mesh.positions.iter().copied().collect();
    let there = asked(&all, &vertices, &groups);
    let mut plane = 0;
    for group in groups {
        let attribute = mesh.attributes.iter().find(|one| one.name == group).unwrap();
        for channel in 0..attribute.width {
            let of_mesh: Vec<u32> =
                attribute.values.iter().skip(channel).step_by(attribute.width).map(|x| x.to_bits()).collect();
            assert_eq!(of_mesh, bits(&there)[plane], "{group} {channel}");
            plane += 1;
        }
    }
    let lattice = Lattice::new([-2.0; 3], 0.125, [32; 3]).unwrap();
    let sampler = Sampler::new(&Compiler::new(), &all, Query::ATTRIBUTES).unwrap();
    let dense = sampler.dense(&lattice).run().unwrap();
    let along = |index: usize, axis: u32| index / 33_usize.pow(axis) % 33;
    let at = |index| [0, 1, 2].map(|axis| lattice.coordinate(axis, along(index, axis as u32)));
    let every: Points = (0..33_usize.pow(3)).map(at).collect();
    let there = asked(&all, &every, &groups);
    let first = dense.len() - there.len();
    assert_eq!(bits(&dense[first..]), bits(&there));
}

/// Who asks for no weights has the program of a model without them.
#[test]
fn what_is_not_asked_for_costs_nothing() {
    let tree = tree(LIMBS);
    let program = |tree: &CheckedTree, query: Query| {
        let tree = tree.of_attributes(&["color"]).expect("there is one");
        jbt_lower::lower(&tree, query).expect("it lowers").function.to_string()
    };
    let all = weighted(&tree).with_weights(WeightOf::Named("left")).unwrap();
    for query in Query::EVERY {
        assert_eq!(program(&all, query), program(&tree, query));
    }
}

/// A thousand leaves have weights of their own; beyond the limit an error says how else to ask.
#[test]
fn many_leaves() {
    let model = |leaves: usize| {
        let leaf = |index: usize| format!("point {{ at ({} {} 0) radius 2.5 }}\n", index % 32, index / 32);
        tree(&format!("jbt 1 sum {{ {} }}", (0..leaves).map(leaf).collect::<String>()))
    };
    let tree = model(1024);
    let all = weighted(&tree);
    let points: Points = [[4.25, 7.5, 0.1], [31.0, 30.6, 0.0], [90.0, 0.0, 0.0]].into_iter().collect();
    let found = asked(&all, &points, &[WEIGHTS, DEFAULT_WEIGHT]);
    assert_eq!(found.len(), 1025);
    for index in 0..3 {
        let exact = walk(&all, place(&points, index)).attributes[1..].concat();
        for (plane, exact) in found.iter().zip(&exact) {
            assert!((f64::from(plane[index]) - exact).abs() < 1e-5);
        }
        let heard = found[..1024].iter().filter(|plane| plane[index] > 0.0).count();
        assert!(if index == 2 { heard == 0 } else { heard > 5 }, "{heard}");
    }
    let error = model(3000).with_weights(WeightOf::Leaves).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("weights of 3000 leaves take 9000000 numbers; they may take 4194304"), "{text}");
    let cloud = format!("particles {{ at ({}) radius 1 }}", "(0 0 0)".repeat(5000));
    let many = format!("sum {{ {cloud} {} }}", "point { radius 1 } ".repeat(1000));
    assert!(jbt_testkit::scene::tree(&many).with_weights(WeightOf::Leaves).is_err());
}

/// Leaves that cannot answer have no column: those of selectors' other children, and weights of warps.
#[test]
fn what_cannot_answer_has_no_column() {
    for (text, leaves) in [
        (format!("select 1 {{ {A} {B} }}"), 1),
        (format!("deform by (0 0 1) weighted {{ {A} {B} }}"), 1),
        (format!("sum {{ {A} empty {B} }}"), 2),
        ("expression { 1 - length(x, y, z) }".to_owned(), 1),
    ] {
        let tree = tree(&text);
        assert_eq!(tree.answering_leaves().len(), leaves, "{text}");
        assert_eq!(weighted(&tree).attributes()[1].width(), leaves);
    }
    let nothing = tree("empty").with_weights(WeightOf::Leaves).unwrap_err().to_string();
    assert!(nothing.contains("no leaf that could have a weight"), "{nothing}");
}
