//! Attributes of any width and kind, from the text to files: what is evaluated, meshed and written is what the oracle says.

use jbt::export::{Format, write};
use jbt::text::{Options, parse};
use jbt::walk::walk;
use jbt::{CheckedTree, Compiler, Engine, Fineness, Points, Polygonize, Polygonized, Query};

fn tree(text: &str) -> CheckedTree {
    parse(text.as_bytes(), &Options::default()).expect("it reads").check().expect("it is a good model")
}

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
            let mut samples = evaluator.samples();
            evaluator.eval(&points, &mut samples).expect("the buffers fit");
            let reference = reference.get_or_insert_with(|| samples.clone());
            assert!(reference.planes() == samples.planes(), "{width} reals by {}", engine.name());
        }
        let samples = reference.expect("there are engines");
        let found = samples.attribute("many").expect("it is there");
        assert_eq!(found.len(), width);
        for index in 0..points.len() {
            let sample = walk(&tree, points.get(index).map(f64::from));
            if sample.decision > 1e-5 {
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
                Format::Obj | Format::Stl => {}
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
