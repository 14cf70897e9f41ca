//! Models far from the origin of the world: they are asked about from an origin near them, and keep the
//! digits that they have at home.
//!
//! * Moved by multiples of a power of two, with the origin moved alike, everything has the bits that it has
//!   at home.
//! * Moved anywhere, fields agree with the f64 oracle, which knows the world alone, as well as at home;
//!   vertices are on the surface.
//! * Edits, parameters and boxes leave the origin.
//!
//! `JBT_ORIGIN_SHAPES` sets the number of random shapes.

mod common;

use common::answers;
use fastrand::Rng;
use jbt::boxes::Divisible as _;
use jbt::contour::{Detail, Slicer};
use jbt::divide::Edit;
use jbt::export::Format;
use jbt::mesh::check_manifold;
use jbt::render::Render;
use jbt::sample::Sampler;
use jbt::solid::{Measure, Solid};
use jbt::text::{Options, parse, print};
use jbt::{
    Box3, CheckedTree, Compiler, Engine, Evaluator, Fineness, Model, ModelOrigin, Points, Polygonize,
    Polygonized, Pruner, Query, Ray, Samples, Tracer, Tree,
};
use jbt_model::walk::{walk, walk_gradient};
use jbt_testkit::bits::bits;
use jbt_testkit::random::Random;
use jbt_testkit::scene::{count, model, tree};
use rayon::prelude::*;

/// A place where f32 has steps of 0.008.
const FAR: [f64; 3] = [1e5, -1e5, 3.3e4];

/// The node of a text somewhere else.
fn moved(node: &str, [x, y, z]: [f64; 3]) -> String {
    format!("translate ({x} {y} {z}) {{ {node} }}")
}

fn mesh(tree: &CheckedTree, fineness: Fineness) -> Polygonized {
    let polygonize = Polygonize { fineness, verify: true, ..Polygonize::default() };
    polygonize.mesh(&Compiler::new(), tree).run().expect("it has a surface")
}

/// Models of which each shows something else that has a place.
const MODELS: [(&str, &str); 14] = [
    ("point", "point { surface_radius 1 }"),
    ("box", "box { half (1 0.6 0.4) radius 0.5 }"),
    ("segment", "segment { from (-1 0 0.2) to (1 0.5 0) radius 1 }"),
    ("ellipsoid", "rotate axis (1 2 3) degrees 40 { ellipsoid { stretch (1 0.5 0.7) radius 1.5 } }"),
    ("torus", "torus { normal (1 1 3) ring_radius 1 tube_radius 0.2 radius 0.5 }"),
    ("curve", "catmull_rom { points ((-1 0 0) (0 1 0) (1 0 0) (2 1 1)) radius 0.5 }"),
    ("tube", "polyline { points ((-1 0 0) (1 1 0) (2 0 1)) radii (0.3 0.2 0.1) radius 0.4 }"),
    (
        "blend",
        "blend ricci 3 { point { radius 1.5 } rotate axis x degrees 30 {
            cylinder { from (0 0 0) to (0 2 0) cylinder_radius 0.2 radius 0.6 } } }",
    ),
    ("twist", "twist axis z rate 1 { box { half (0.8 0.3 1) radius 0.5 } }"),
    ("bend", "bend axis z rate 0.5 from -1 to 1 { segment { from (0 0 -1) to (0 0 1) radius 0.8 } }"),
    (
        "formula",
        "expression within (-1.2 -1.2 -1.2) to (1.2 1.2 1.2) { 1.2 - length(x, y, z) + 0.05 * sin(6 * x) }",
    ),
    (
        "warp",
        "warp (x + 0.1 * sin(3 * y), y, z) within (-2 -2 -2) to (2 2 2) {
            sphere { sphere_radius 0.7 radius 0.6 } }",
    ),
    ("texture", "color checker { a (1 1 1) b (0 0 0) size 0.4 } { point { surface_radius 1 } }"),
    ("uv", "color expression { t = length(x, y), (t, sin(3 * t), 0.2) } { point { surface_radius 1 } }"),
];

#[test]
fn moved_by_a_multiple_of_a_power_of_two_everything_has_the_bits_of_home() {
    let by = [65536.0, -131_072.0, 32_768.0];
    for (name, node) in MODELS {
        let home = tree(&format!("jbt 1 {node}"));
        let far = tree(&format!("jbt 1 origin ({} {} {}) {}", by[0], by[1], by[2], moved(node, by)));
        assert_eq!((home.origin(), far.origin()), (ModelOrigin::WORLD, ModelOrigin::new(by)));
        for engine in Engine::ALL {
            let points = |evaluator: &Evaluator| {
                let mut rng = Rng::with_seed(1);
                let mut points = evaluator.points();
                (0..500).for_each(|_| points.push(std::array::from_fn(|_| 4.0 * rng.f32() - 2.0)));
                points
            };
            let answers = [&home, &far].map(|tree| {
                let evaluator =
                    Compiler::for_engine(engine).evaluator(tree, Query::ALL).expect("it compiles");
                let samples = answers(&evaluator, &points(&evaluator));
                bits(samples.planes())
            });
            assert_eq!(answers[0], answers[1], "{name} on {}", engine.name());
        }
        // A region, so that no rounding of the support's sides is in it.
        let region = |by: [f64; 3]| Some(Box3::new(by.map(|x| x - 2.0), by.map(|x| x + 2.0)));
        let mesh = |tree: &CheckedTree, by| {
            let settings = Polygonize {
                region: region(by),
                fineness: Fineness::Resolution(40),
                verify: true,
                ..Polygonize::default()
            };
            settings.mesh(&Compiler::new(), tree).run().expect("it has a surface").mesh
        };
        let (mut at_home, there) = (mesh(&home, [0.0; 3]), mesh(&far, by));
        assert_eq!(there.origin, by);
        at_home.origin = by;
        assert!(at_home == there && !there.triangles.is_empty(), "{name}: the meshes are one");
    }
}

/// Without maps: the places are numbers of the leaves themselves.
#[test]
fn leaves_that_say_where_they_are_have_the_bits_of_home() {
    let node = |[x, y, z]: [f64; 3]| {
        format!(
            "sum {{ point {{ at ({x} {y} {z}) radius 1.5 }} point {{ at ({} {y} {}) radius 1.25 }}
             box {{ center ({x} {} {z}) half (0.5 0.25 0.125) radius 1 }}
             torus {{ center ({x} {y} {}) normal (0 0 1) ring_radius 1 tube_radius 0.25 radius 0.5 }} }}",
            x + 0.5,
            z - 0.75,
            y + 1.0,
            z + 0.5
        )
    };
    let by = [4096.0, 8192.0, -2048.0];
    let home = tree(&format!("jbt 1 {}", node([0.0; 3])));
    let far = tree(&format!("jbt 1 origin ({} {} {}) {}", by[0], by[1], by[2], node(by)));
    let home = mesh(&home, Fineness::Cell(0.0625)).mesh;
    let far = mesh(&far, Fineness::Cell(0.0625)).mesh;
    assert!(
        far.positions == home.positions && far.normals == home.normals && far.triangles == home.triangles
    );
    assert_eq!(far.world(0), [0, 1, 2].map(|axis| by[axis] + f64::from(home.positions[0][axis])));
}

#[test]
fn vertices_far_away_are_on_the_surface() {
    for (name, node) in MODELS {
        let far = tree(&format!("jbt 1 {}", moved(node, FAR)));
        assert!(!far.origin().is_world(), "{name}");
        let made = mesh(&far, Fineness::Resolution(48));
        assert!(
            made.report.closed && check_manifold(made.mesh.positions.len(), &made.mesh.triangles).is_ok()
        );
        assert_eq!(made.mesh.origin, far.origin().point());
        let at_home = mesh(&tree(&format!("jbt 1 {node}")), Fineness::Resolution(48));
        let away = |made: &Polygonized, tree: &CheckedTree| {
            let of = |vertex: usize| {
                let p = made.mesh.world(vertex);
                let gradient = walk_gradient(tree, p, 1e-4);
                let steep = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
                (walk(tree, p).field - tree.iso()).abs() / steep / made.lattice.spacing()
            };
            // Where it is cut, and at creases, a vertex is where the rule for those puts it.
            let mut all: Vec<f64> = (0..made.mesh.positions.len()).into_par_iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let (far_away, home) = (away(&made, &far), away(&at_home, &tree(&format!("jbt 1 {node}"))));
        let most = |all: &[f64]| all[all.len() - 1];
        assert!(most(&far_away) < 1e-3_f64.max(1.5 * most(&home)), "{name}: {} cells", most(&far_away));
        assert!(far_away[far_away.len() * 9 / 10] < 1e-3, "{name}");
        let flipped = |made: &Polygonized| {
            let mesh = &made.mesh;
            let against = |triangle: &&[u32; 3]| {
                let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].map(f64::from));
                let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
                let n = [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
                let mean = triangle.map(|vertex| mesh.normals[vertex as usize]);
                (0..3).map(|k| n[k] * mean.iter().map(|m| f64::from(m[k])).sum::<f64>()).sum::<f64>() < 0.0
            };
            mesh.triangles.iter().filter(against).count()
        };
        assert!(flipped(&made) <= flipped(&at_home), "{name}: {} triangles are flipped", flipped(&made));
    }
}

/// Random points around a far model: places in the world that f32 has about its origin.
fn around(tree: &CheckedTree, rng: &mut Rng, count: usize) -> Points {
    let support = tree.local_support();
    let mut points = Points::about(tree.origin());
    for _ in 0..count {
        let at = |axis: usize, part: f64| {
            support.low()[axis] + part * (support.high()[axis] - support.low()[axis])
        };
        points.push([0, 1, 2].map(|axis| at(axis, rng.f64()) as f32));
    }
    points
}

#[test]
fn fields_far_away_are_those_of_the_oracle() {
    for (name, node) in MODELS {
        let far = tree(&format!("jbt 1 {}", moved(node, FAR)));
        let evaluator = Evaluator::compile(&far, Query::FIELD).expect("it compiles");
        let points = around(&far, &mut Rng::with_seed(3), 2000);
        let samples = answers(&evaluator, &points);
        for (index, field) in samples.field().iter().enumerate() {
            let p = points.world(index);
            let oracle = walk(&far, p);
            let steep = walk_gradient(&far, p, 1e-5).iter().fold(1.0, |most: f64, g| most.max(g.abs()));
            if oracle.kink_distance < 1e-4 * steep {
                continue;
            }
            let off = (f64::from(*field) - oracle.field).abs();
            assert!(off < 1e-6 * steep, "{name}: {field} is off by {off:e} at {p:?}");
        }
    }
}

#[test]
fn random_models_far_away_agree_with_the_oracle_as_well_as_at_home() {
    let shapes = count("JBT_ORIGIN_SHAPES", 200);
    let compared: usize = (0..shapes).into_par_iter().map(try_shape).sum();
    assert!(compared > 20 * shapes as usize, "{compared} points of {shapes} shapes were compared");
}

/// The points of a random shape at which the field was compared.
fn try_shape(shape: u64) -> usize {
    let model = Random::new(shape, shape ^ 1 << 40).model(1 + (shape % 9) as usize);
    let mut rng = Rng::with_seed(shape);
    // Neither the place nor the origin is a round number, nor are they one.
    let at = FAR.map(|x| x * (0.3 + rng.f64()));
    let origin = at.map(|x| x + 2.0 * rng.f64() - 1.0);
    let root = model.root.translate(at);
    let far =
        Model { root, ..model.clone() }.with_origin(origin).check().expect("a random model is a good model");
    let home = model.check().expect("a random model is a good model");
    let field = |tree: &CheckedTree, points: &Points| {
        let evaluator = Compiler::for_engine(Engine::Lanes).evaluator(tree, Query::ALL).expect("it compiles");
        answers(&evaluator, points)
    };
    // The same place of the model, but for a rounding of the coordinates.
    let mut near = Points::new();
    let mut away = Points::about(far.origin());
    for _ in 0..60 {
        let p: [f64; 3] = std::array::from_fn(|_| 3.2 * rng.f64() - 1.6);
        near.push_world(p);
        away.push_world([0, 1, 2].map(|axis| p[axis] + at[axis]));
    }
    let (here, there) = (field(&home, &near), field(&far, &away));
    let mut compared = 0;
    for index in 0..near.len() {
        let off = |tree: &CheckedTree, points: &Points, samples: &Samples| {
            let oracle = walk(tree, points.world(index));
            let gradient = samples.gradient().expect("asked for").map(|plane| f64::from(plane[index]));
            let steep = gradient.iter().fold(oracle.field.abs().max(1.0), |steep: f64, g| steep.max(g.abs()));
            let off = (f64::from(samples.field()[index]) - oracle.field).abs() / steep;
            (off, oracle.kink_distance < 1e-3 * steep)
        };
        let ((off_here, decided), (off_there, decided_there)) =
            (off(&home, &near, &here), off(&far, &away, &there));
        if decided || decided_there {
            continue;
        }
        compared += 1;
        assert!(
            off_there <= 4e-6 + 4.0 * off_here,
            "shape {shape}: off by {off_there:e}, at home by {off_here:e}, at {:?}\n{}",
            away.world(index),
            print(&model)
        );
    }
    compared
}

/// A box of the world is cut as exactly as one at home: its walls are where they are said to be.
#[test]
fn boxes_far_away_are_where_they_are_said_to_be() {
    let at = FAR.map(|x| x + 0.3);
    let corner = |by: f64| at.map(|x| (x + by).to_string()).join(" ");
    let text = format!(
        "jbt 1 param grow = 0 within ({}) to ({}) {{ {} }}",
        corner(-0.4),
        corner(0.4).replacen(' ', " + grow ", 1),
        moved("point { radius 9 }", at)
    );
    let far = tree(&text);
    for far in [far.clone(), far.with_parameters(&[("grow", 0.25)]).expect("it is well")] {
        let evaluator = Evaluator::compile(&far, Query::FIELD).expect("it compiles");
        let mut points = evaluator.points();
        let mut expected = Vec::new();
        let grow = far.parameters()[0].value();
        for axis in 0..3 {
            for (side, way) in [(-0.4, -1.0), (0.4 + if axis == 0 { grow } else { 0.0 }, 1.0)] {
                for beyond in [-1e-5, 1e-5] {
                    let mut p = at;
                    p[axis] += side + way * beyond;
                    points.push_world(p);
                    expected.push(beyond < 0.0);
                }
            }
        }
        let samples = answers(&evaluator, &points);
        let inside: Vec<bool> = samples.field().iter().map(|&field| field > 0.0).collect();
        assert_eq!(inside, expected);
        // The rows that matter around each point give its bits.
        let pruner = Pruner::new(&Compiler::new(), &far).expect("it compiles");
        for (index, field) in samples.field().iter().enumerate() {
            let p = points.get(index);
            let around = Box3::new(p.map(|x| x - 1e-4), p.map(|x| x + 1e-4));
            let region = pruner.region(around).expect("it is a box");
            let (planes, mut pruned) = (p.each_ref().map(std::slice::from_ref), [0.0]);
            evaluator.eval_region(&region, planes, &mut [&mut pruned]).expect("the buffers fit");
            assert_eq!(pruned[0].to_bits(), field.to_bits());
        }
    }
}

#[test]
fn edits_leave_the_origin() {
    let text = |x: f64| {
        let balls = [x, 1e5].map(|x| moved("point { radius r }", [x, -1e5, 3.3e4]));
        format!("jbt 1 param r = 1 sum {{ {} }}", balls.join(" "))
    };
    let (first, second) = (tree(&text(1e5 + 3.0)), tree(&text(2e5)));
    assert_eq!(first.origin().point(), [100_000.0, -100_000.0, 33_000.0]);
    assert!(second.origin().is_world(), "it is as large as it is far away");
    let fat = first.with_parameters(&[("r", 900.0)]).expect("it is well");
    assert_eq!(fat.origin(), first.origin());

    let mut evaluator = Evaluator::compile(&first, Query::ALL).expect("it compiles");
    evaluator.update(&second).expect("it compiles");
    assert_eq!(evaluator.origin(), first.origin());
    let mut points = evaluator.points();
    points.push_world([2e5 + 0.5, -1e5, 3.3e4]);
    let samples = answers(&evaluator, &points);
    assert_eq!(samples.field()[0], 0.5);

    let compiler = Compiler::new();
    let pruner = Pruner::new(&compiler, &first).expect("it compiles");
    let edited = pruner.updated(&second).expect("it compiles");
    assert_eq!(edited.origin(), first.origin());
    let Edit::Boxes(boxes) = edited.edit(&pruner) else { panic!("it ends") };
    // Where the ball was and where it is, about the origin that both have.
    assert!(boxes.iter().any(|bounds| bounds.contains([3.0, 0.0, 0.0])));
    assert!(boxes.iter().any(|bounds| bounds.contains([1e5, 0.0, 0.0])));
    // With an origin of its own it is another model.
    let other = Pruner::new(&compiler, &second).expect("it compiles");
    assert_eq!(other.edit(&pruner), Edit::Everywhere);

    let (solid, tracer) = (Solid::new(&compiler, &first), Tracer::new(&compiler, &first, Query::FIELD));
    let solid = solid.expect("it compiles").updated(&second).expect("it compiles");
    let tracer = tracer.expect("it compiles").updated(&second).expect("it compiles");
    assert_eq!((solid.tree().origin(), tracer.tree().origin()), (first.origin(), first.origin()));
    let ray = Ray { origin: [2e5, -1e5, 0.0], direction: [0.0, 0.0, 1.0], span: [0.0, 1e5] };
    assert_eq!(tracer.all(&ray, 0.1).expect("it is a ray").len(), 2);
}

/// What is told in f64 is about the world, what is told in f32 about the origin.
#[test]
fn questions_are_about_the_world_and_boxes_about_the_origin() {
    let (home, far) = (
        tree("jbt 1 point { surface_radius 1 }"),
        tree(&format!("jbt 1 {}", moved("point { surface_radius 1 }", FAR))),
    );
    let compiler = Compiler::new();
    let origin = far.origin().point();

    let [at_home, there] =
        [&home, &far].map(|tree| Tracer::new(&compiler, tree, Query::ALL).expect("it compiles"));
    let ray = |from: [f64; 3]| Ray {
        origin: [from[0], from[1], from[2] + 5.0],
        direction: [0.0, 0.0, -1.0],
        span: [0.0, 10.0],
    };
    let (hit, far_hit) = (
        at_home.first(&ray([0.0; 3]), 0.01).unwrap().unwrap(),
        there.first(&ray(FAR), 0.01).unwrap().unwrap(),
    );
    assert!((hit.t - far_hit.t).abs() < 1e-5 && (far_hit.t - 4.0).abs() < 1e-4);
    let height = f64::from(far_hit.position[2]) + origin[2];
    assert!((height - FAR[2] - 1.0).abs() < 1e-5);
    assert!(there.owner(far_hit.position).is_some() && there.leaf(far_hit.position).unwrap().is_some());

    let solid = Solid::new(&compiler, &far).expect("it compiles");
    let measured =
        solid.measure(&Measure { fineness: Fineness::Resolution(64), ..Measure::default() }).run().unwrap();
    assert!((measured.volume.estimate - 4.0 / 3.0 * std::f64::consts::PI).abs() < 0.01);
    let center = measured.center.expect("there is something");
    assert!((0..3).all(|axis| (center[axis] - FAR[axis]).abs() < 1e-4), "{center:?}");
    let bounds = solid.tight_bounds(None, 1e-3).unwrap().outer.expect("there is something");
    assert!((0..3).all(|axis| (f64::from(bounds.high[axis]) + origin[axis] - FAR[axis] - 1.0).abs() < 2e-3));
    assert!(solid.owner(FAR).is_some());
    assert!(!solid.owners_in(Box3::new([-1.0; 3], [1.0; 3])).unwrap().is_empty());

    let slice = |tree: &CheckedTree, plane: &str| {
        let slicer =
            Slicer::new(&compiler, tree, &plane.parse().unwrap(), Query::FIELD).expect("it compiles");
        let rectangle = slicer.rectangle().expect("it ends");
        slicer.contour(&rectangle, &Detail::default()).run().expect("it has a contour")
    };
    for plane in
        [format!("z={}", FAR[2] + 0.5), format!("{},{},{},1,1,0,0,0,1", FAR[0], FAR[1] + 0.5, FAR[2])]
    {
        let contour = slice(&far, &plane);
        assert_eq!(contour.loops.len(), 1, "{plane}");
        let expected = if plane.starts_with('z') { 0.75 } else { 1.0 - 0.125 } * std::f64::consts::PI;
        assert!((contour.area() - expected).abs() < 1e-2, "{plane}: {}", contour.area());
        let middle = contour.rectangle.low();
        let side = contour.rectangle.high()[0] - middle[0];
        assert!((contour.origin[0] + f64::from(contour.positions[0][0]) - middle[0]).abs() < side);
    }

    let sampler = Sampler::new(&compiler, &far, Query::FIELD).expect("it compiles");
    let lattice =
        Polygonize { fineness: Fineness::Resolution(16), ..Polygonize::default() }.lattice(&far).unwrap();
    let dense = sampler.dense(&lattice).run().expect("it is small");
    assert!(dense[0].iter().any(|&field| field > 0.9));

    let picture = |tree: &CheckedTree| {
        let render = Render { size: [64, 48], ..Render::default() };
        render.picture(&compiler, tree).run().expect("it can be seen")
    };
    let dyadic = [65536.0, 131_072.0, -32_768.0];
    let far = tree(&format!("jbt 1 origin (65536 131072 -32768) {}", moved("point { radius 2 }", dyadic)));
    let home = tree("jbt 1 point { radius 2 }");
    let (at_home, there) = (picture(&home), picture(&far));
    assert_eq!(at_home.picture.pixels(), there.picture.pixels());
    let eyes = [at_home, there].map(|made| made.report.camera.expect("it can be seen").eye);
    assert!((0..3).all(|axis| (eyes[1][axis] - eyes[0][axis] - dyadic[axis]).abs() < 1e-6));
}

#[test]
fn the_origin_is_read_printed_and_kept() {
    let far = model(&format!("jbt 1 origin (1 2.5 -1e6) {}", moved("point { radius 1 }", FAR)));
    assert_eq!(far.origin, Some([1.0, 2.5, -1e6]));
    assert_eq!(model(&print(&far)), far);
    assert_eq!(far.check().unwrap().origin().point(), [1.0, 2.5, -1e6]);
    let free = Model { origin: None, ..far };
    assert!(!print(&free).contains("origin"));
    // The diameter is 2, and so is the power of two.
    assert_eq!(free.check().unwrap().origin().point(), [1e5, -1e5, 3.3e4]);
    // It may be given by parameters, and stays as it was read.
    let by_name = "jbt 1 param far = 1e5 origin (far 0 0) translate (far 0 0) { point { radius 1 } }";
    assert_eq!(tree(by_name).origin().point(), [1e5, 0.0, 0.0]);
    assert!(tree(by_name).with_parameters(&[("far", 0.0)]).is_err());
    let errors = |text: &str| {
        let read = parse(text.as_bytes(), &Options::default()).and_then(|model| model.check());
        format!("{:?}", read.expect_err(text)[0])
    };
    assert!(errors("jbt 1 origin (1 2 3) origin (1 2 3) point { radius 1 }").contains("a second `origin`"));
    assert!(errors("jbt 1 origin (1 2) point { radius 1 }").contains("3"));
    assert!(errors("jbt 1 origin (1e300 0 0) point { radius 1 }").contains("the origin"));
    let nowhere = Model::new(Tree::clone(&free.root)).with_origin([f64::NAN, 0.0, 0.0]);
    assert!(nowhere.check().is_err());
}

#[test]
fn files_say_where_a_far_mesh_is() {
    let far = tree(&format!("jbt 1 {}", moved("point { surface_radius 1 }", FAR.map(|x| x + 0.25))));
    let mesh = mesh(&far, Fineness::Resolution(16)).mesh;
    let file = |format: Format| {
        let mut file = Vec::new();
        jbt::export::write(&mesh, format, &mut file).expect("it can be written");
        file
    };
    let near = |found: [f64; 3], vertex: usize, within: f64| {
        let expected = mesh.world(vertex);
        assert!(
            (0..3).all(|axis| (found[axis] - expected[axis]).abs() <= within),
            "{found:?} is not {expected:?}"
        );
    };
    let obj = String::from_utf8(file(Format::Obj)).unwrap();
    let lines = obj.lines().filter_map(|line| line.strip_prefix("v "));
    for (vertex, line) in lines.enumerate() {
        let words: Vec<f64> = line.split(' ').take(3).map(|word| word.parse().unwrap()).collect();
        near([words[0], -words[2], words[1]], vertex, 0.0);
    }
    let ply = file(Format::Ply);
    let end = b"end_header\n";
    let start = ply.windows(end.len()).position(|window| window == end).unwrap() + end.len();
    let header = std::str::from_utf8(&ply[..start]).unwrap();
    assert!(header.contains("property double x\nproperty double y\nproperty double z\nproperty float nx"));
    let double = |at: usize| f64::from_le_bytes(ply[at..at + 8].try_into().unwrap());
    near([0, 8, 16].map(|offset| double(start + offset)), 0, 0.0);

    let glb = file(Format::Glb);
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let number = |axis: usize| json["nodes"][0]["translation"][axis].as_f64().unwrap();
    let real = |at: usize| f64::from(f32::from_le_bytes(glb[at..at + 4].try_into().unwrap()));
    let [x, y, z] = [0, 4, 8].map(|offset| real(28 + length + offset));
    // The node turns z upwards to y, then moves.
    assert!(json["nodes"][0]["rotation"].is_array());
    near([x + number(0), y - number(2), z + number(1)], 0, 1e-9);

    let stl = file(Format::Stl);
    let corner =
        [0, 4, 8].map(|offset| f32::from_le_bytes(stl[96 + offset..100 + offset].try_into().unwrap()));
    near(corner.map(f64::from), mesh.triangles[0][0] as usize, 0.005);
}
