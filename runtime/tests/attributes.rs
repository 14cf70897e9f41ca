//! Attributes of any width and kind, from the text to files: what is evaluated, meshed and written is what
//! the oracle says.

mod common;

use common::answers;
use jbt::export::{Format, write};
use jbt::walk::walk;
use jbt::{CheckedTree, Compiler, Engine, Fineness, Points, Polygonize, Polygonized, Query};
use jbt_testkit::scene::tree;

fn meshed(tree: &CheckedTree, resolution: usize) -> Polygonized {
    let polygonize = Polygonize { fineness: Fineness::Resolution(resolution), ..Polygonize::default() };
    polygonize.mesh(&Compiler::new(), tree).run().expect("it has a surface")
}

/// Two balls with a group of `width` reals each, mixed.
fn wide(width: usize) -> CheckedTree {
    let list = |from: usize| {
        let numbers: Vec<String> = (0..width).map(|i| format!("{}", (from + i) as f64 / 16.0)).collect();
        format!("({})", numbers.join(" "))
    };
    tree(&format!(
        "jbt 1 attribute many {width} default {} sum {{
            many {} {{ point {{ radius 1 }} }}
            many stripes {{ a {} b {} width 0.25 }} {{ point {{ at (0.6 0 0) radius 1 }} }}
        }}",
        list(0),
        list(7),
        list(3),
        list(90)
    ))
}

#[test]
fn groups_of_any_width_go_all_the_way() {
    let mut rng = fastrand::Rng::with_seed(11);
    let points: Points = (0..33).map(|_| std::array::from_fn(|_| 1.6 * rng.f32() - 0.5)).collect();
    for width in [1, 2, 3, 4, 5, 13, 64] {
        let tree = wide(width);
        let mut reference: Option<jbt::Samples> = None;
        for engine in Engine::ALL {
            let evaluator =
                Compiler::for_engine(engine).evaluator(&tree, Query::ATTRIBUTES).expect("it compiles");
            let samples = answers(&evaluator, &points);
            let reference = reference.get_or_insert_with(|| samples.clone());
            assert!(reference.planes() == samples.planes(), "{width} reals by {}", engine.name());
        }
        let samples = reference.expect("there are engines");
        let found = samples.attribute("many").expect("it is there");
        assert_eq!(found.len(), width);
        for index in 0..points.len() {
            let sample = walk(&tree, points.get(index).map(f64::from));
            if sample.kink_distance > 1e-5 {
                for (plane, expected) in found.iter().zip(&sample.attributes[1]) {
                    assert!((f64::from(plane[index]) - expected).abs() < 1e-5, "{width} reals");
                }
            }
        }
        let mesh = meshed(&tree, 12).mesh;
        assert_eq!(mesh.attributes[1].values.len(), width * mesh.positions.len());
        for format in Format::ALL {
            let mut bytes = Vec::new();
            write(&mesh, format, &mut bytes).expect("every format writes it");
            let names = String::from_utf8_lossy(&bytes);
            match format {
                Format::Glb => assert_eq!(names.matches("_MANY").count(), width.div_ceil(4), "{width} reals"),
                Format::Ply => assert_eq!(names.matches("property float many").count(), width),
                Format::Usda => assert_eq!(
                    names.matches(&format!("elementSize = {width}")).count(),
                    usize::from(width > 1)
                ),
                Format::Obj | Format::Stl | Format::ThreeMf => {}
            }
        }
    }
}

#[test]
fn a_checker_is_where_it_should_be_on_a_mesh() {
    let tree = tree(
        "jbt 1 attribute uv 2 translate (1 2 3) { rotate axis z degrees 90 {
            uv { color checker { a (1 1 1) b (0 0 0) size 0.4 } { point { surface_radius 1 } } } } }",
    );
    let mesh = meshed(&tree, 40).mesh;
    let [colors, uv] = &mesh.attributes[..] else { panic!("two groups") };
    let (mut black, mut near) = (0, 0);
    for (vertex, position) in mesh.positions.iter().enumerate() {
        // Turned back by a quarter: (x, y) comes from (y, -x).
        let [x, y, z] = position.map(f64::from);
        let local = [y - 2.0, 1.0 - x, z - 3.0];
        if local.iter().any(|c| (c / 0.4 - (c / 0.4).round()).abs() < 1e-4) {
            near += 1;
            continue;
        }
        let odd = local.iter().map(|c| (c / 0.4).floor()).sum::<f64>().rem_euclid(2.0);
        let expected = 1.0 - odd as f32;
        assert_eq!(colors.values[3 * vertex..3 * vertex + 3], [expected; 3], "at {local:?}");
        black += usize::from(expected == 0.0);
        let longitude = local[1].atan2(local[0]).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        let latitude = 0.5 + local[2].atan2(local[0].hypot(local[1])) / std::f64::consts::PI;
        for (found, expected) in uv.values[2 * vertex..].iter().zip([longitude, latitude]) {
            assert!((f64::from(*found) - expected).abs() < 1e-4, "{found}, not {expected}, at {local:?}");
        }
    }
    let count = mesh.positions.len();
    assert!(
        near * 10 < count && black * 3 > count && black * 3 < 2 * count,
        "{black} black and {near} of {count}"
    );
}

/// What answers where no field is: a leaf has its own values everywhere, operators give the default where
/// nothing has weight.
#[test]
fn where_nothing_has_weight() {
    const RED: &str = "color (1 0 0) { point { radius 1 } }";
    const BLUE: &str = "color (0 0 1) { point { at (0.5 0 0) radius 1 } }";
    let (own, default) = ([1.0, 0.0, 0.0], [1.0, 1.0, 1.0]);
    let far = [5.0, 5.0, 5.0];
    for (root, expected) in [
        (RED.to_owned(), own),
        (format!("translate (1 0 0) {{ twist axis z rate 1 {{ {RED} }} }}"), own),
        ("color (1 0 0) { expression { x - 9 } }".to_owned(), own),
        (format!("select 0 {{ {RED} {BLUE} }}"), own),
        (format!("union {{ {RED} }}"), own),
        (format!("intersection {{ {RED} }}"), own),
        (format!("product {{ {RED} }}"), own),
        (format!("difference {{ {RED} }}"), own),
        (format!("smooth_union width 0.2 {{ {RED} }}"), own),
        (format!("rfunction union {{ {RED} }}"), own),
        (format!("sum {{ {RED} }}"), default),
        (format!("ricci 3 {{ {RED} }}"), default),
        (format!("clamp low 0 high 0.8 {{ {RED} }}"), default),
        (format!("complement {{ {RED} }}"), default),
        (format!("within (-1 -1 -1) to (1 1 1) {{ {RED} }}"), default),
        (format!("sum {{ {RED} {BLUE} }}"), default),
        (format!("ricci 3 {{ {RED} {BLUE} }}"), default),
        (format!("product {{ {RED} {BLUE} }}"), default),
        (format!("union {{ {RED} {BLUE} }}"), default),
        (format!("intersection {{ {RED} {BLUE} }}"), default),
        (format!("difference {{ {RED} {BLUE} }}"), default),
        (format!("symmetric_difference {{ {RED} {BLUE} }}"), default),
        (format!("smooth_union width 0.2 {{ {RED} {BLUE} }}"), default),
        (format!("smooth_intersection width 0.2 {{ {RED} {BLUE} }}"), default),
        (format!("smooth_difference width 0.2 {{ {RED} {BLUE} }}"), default),
        (format!("rfunction union {{ {RED} {BLUE} }}"), default),
        (format!("rfunction intersection power 3 {{ {RED} {BLUE} }}"), default),
        (format!("rfunction difference order 2 {{ {RED} {BLUE} }}"), default),
    ] {
        let tree = tree(&format!("jbt 1 {root}"));
        assert_eq!(walk(&tree, far).attributes[0], expected, "the oracle on {root}");
        for engine in Engine::ALL {
            let evaluator =
                Compiler::for_engine(engine).evaluator(&tree, Query::ATTRIBUTES).expect("it compiles");
            let color = evaluator.probe(far.map(|x| x as f32)).color().expect("it is there");
            assert_eq!(color.map(f64::from), expected, "{} on {root}", engine.name());
        }
    }
}

/// Steps of more than two children mix as they fold: the formulas of the page on attributes, with derivatives
/// by differences.
#[test]
fn steps_weigh_two_sides_at_a_time() {
    let at = [0.1, 0.2, -0.15];
    let children = [[0.0, 0.3, 0.1], [0.4, -0.1, 0.0], [-0.2, 0.2, -0.5]];
    let leaf = |[x, y, z]: [f64; 3], color: &str| {
        format!("color {color} {{ point {{ at ({x} {y} {z}) radius 1 }} }}")
    };
    let leaves = [leaf(children[0], "(1 0 0)"), leaf(children[1], "(0 1 0)"), leaf(children[2], "(0 0 1)")];
    let fields = children.map(|center| {
        let square: f64 = (0..3).map(|axis| (at[axis] - center[axis]).powi(2)).sum();
        // The soft falloff of radius 1.
        let sample = walk(&tree(&format!("jbt 1 {}", leaf(center, "(1 1 1)"))), at);
        assert!(square < 1.0 && sample.field > 0.0);
        sample.field
    });
    for operator in [
        "smooth_union width 0.4",
        "smooth_intersection width 0.4",
        "rfunction union",
        "rfunction union power 64",
        "rfunction intersection power 3",
        "rfunction union order 2",
    ] {
        let field = |[a, b]: [f64; 2]| {
            let constant = |f: f64| format!("expression {{ {f:?} }}");
            walk(&tree(&format!("jbt 1 {operator} {{ {} {} }}", constant(a), constant(b))), at).field
        };
        // `max(0, f dF/df)` of both sides, normalised.
        let shares = |sides: [f64; 2]| {
            let slope = |side: usize| {
                let step = 1e-6;
                let by = |offset: f64| {
                    let mut moved = sides;
                    moved[side] += offset;
                    field(moved)
                };
                (by(step) - by(-step)) / (2.0 * step)
            };
            let weights = [0, 1].map(|side| (sides[side] * slope(side)).max(0.0));
            weights.map(|weight| weight / (weights[0] + weights[1]))
        };
        let [a, b] = shares([fields[0], fields[1]]);
        let [before, last] = shares([field([fields[0], fields[1]]), fields[2]]);
        let expected = [a * before, b * before, last];
        let tree = tree(&format!("jbt 1 {operator} {{ {} }}", leaves.join(" ")));
        let oracle = &walk(&tree, at).attributes[0];
        let evaluator = Compiler::new().evaluator(&tree, Query::ATTRIBUTES).expect("it compiles");
        let color = evaluator.probe(at.map(|x| x as f32)).color().expect("it is there");
        for channel in 0..3 {
            assert!(
                (oracle[channel] - expected[channel]).abs() < 1e-6,
                "{operator}: {oracle:?}, not {expected:?}"
            );
            assert!(
                (f64::from(color[channel]) - expected[channel]).abs() < 1e-5,
                "{operator}: {color:?}, not {expected:?}"
            );
        }
    }
}

/// A formula may have a field where nothing that it is made of has: there the default is all of its answer,
/// and dominates with all of its field.
#[test]
fn a_default_dominates_with_all_of_its_field() {
    let far = "union { point { at (9 0 0) radius 1 } point { at (9 1 0) radius 1 } }";
    for far in [far, "point { at (9 0 0) radius 1 }", &format!("complement {{ complement {{ {far} }} }}")] {
        let text = format!(
            "jbt 1 attribute tag 1 default 5 dominant let far = {far}
            sum {{ expression {{ 0.3 + field(far) }} with tag 1 {{ point {{ radius 1 strength 0.2 }} }} }}"
        );
        let tree = jbt::text::model(&text).expect("it reads").check().expect("a good model");
        for engine in Engine::ALL {
            let evaluator =
                Compiler::for_engine(engine).evaluator(&tree, Query::ATTRIBUTES).expect("it compiles");
            let samples = answers(&evaluator, &[[0.0f32; 3]]);
            assert_eq!(samples.attribute("tag").expect("asked for")[0][0], 5.0, "{engine}: {far}");
        }
    }
}
