//! The first hour with the library: errors that show their places, scenes by their endings, and the traits
//! that people expect.

use std::error::Error;
use std::path::Path;

use jbt::build::{Axis, param, point, segment, x};
use jbt::contour::{Detail, ImageDetail, Plane, SliceError, Slicer};
use jbt::diagnostic::Severity;
use jbt::render::RenderError;
use jbt::sample::{SampleError, Sampler, Wanted};
use jbt::solid::{Measure, MeasureError};
use jbt::statistics::{Statistics, SupportsError};
use jbt::text::{Options, parse};
use jbt::tree::SetOperation;
use jbt::tree::operators::{Difference, Intersection, Sum, SymmetricDifference, Union};
use jbt::{
    CancelToken, CheckedTree, Combinator, CompileError, Compiler, Diagnostics, Engine, Evaluator, Fineness,
    Model, Points, Polygonize, PolygonizeError, Query, Render, Scene, SceneFormat, Solid, Tree,
};
use jbt_testkit::bits::bits;

const WRONG: &[u8] = b"jbt 1\nsum {\n  point { radius -2 }\n  sphere { sphere_radius 1 radius 0 }\n}\n";

#[test]
fn one_error_shows_every_place_with_a_caret() {
    fn checked() -> Result<(), Box<dyn Error + Send + Sync + 'static>> {
        Scene::from_bytes("wrong.jbt", WRONG)?.check()?;
        Ok(())
    }
    let error = checked().unwrap_err();
    let shown = "wrong.jbt:3:3: error: the radius is -2\n\
                 \x20 3 |   point { radius -2 }\n\
                 \x20   |   ^^^^^^^^^^^^^^^^^^^ expected a number of at least 1e-15\n\
                 wrong.jbt:4:3: error: the radius is 0\n\
                 \x20 4 |   sphere { sphere_radius 1 radius 0 }\n\
                 \x20   |   ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ expected a number of at least 1e-15";
    assert_eq!(error.to_string(), shown);
    // What a `main` prints that returns it.
    assert_eq!(format!("{error:?}"), shown);
    let list = error.downcast_ref::<Diagnostics>().expect("it is this type");
    assert_eq!(list.len(), 2);
    assert!(list.iter().all(|one| one.severity == Severity::Error && one.span.is_some()));
}

#[test]
fn reading_checking_and_setting_have_the_same_error() {
    let named = |error: Diagnostics| error.to_string().lines().next().unwrap_or_default().to_owned();
    let read = parse(b"jbt 1 point {", &Options::default()).unwrap_err();
    assert!(named(read).starts_with("<text>:1:"));
    let model = jbt::text::model("jbt 1\nparam r = 1\npoint { radius r }").unwrap();
    let set = model.check().unwrap().with_parameters(&[("r", -1.0)]).unwrap_err();
    assert!(named(set).starts_with("<text>:3:1: error: the radius is -1"));
    let built = Model::new(point([0; 3], -1)).check().unwrap_err();
    assert_eq!(named(built), "error: the radius is -1");
    let compile = CompileError::from(Diagnostics::default());
    assert!(matches!(compile, CompileError::Model(_)));
}

#[test]
fn scenes_are_read_by_their_endings() {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let scene = Scene::load(samples.join("mood.jbt")).unwrap();
    assert_eq!(scene.format, SceneFormat::Jbt);
    assert!(scene.check().is_ok() && scene.text.name().ends_with("mood.jbt"));
    let program = Scene::from_bytes("ball.VM", b"_0 var-x\n").unwrap();
    assert_eq!(program.format, SceneFormat::Vm);
    let parsip = b"[global]\nrootids=(1)\n[blobnode 1]\nprimitivetype=POINT\nposition=(0, 0, 0)\nradius=1\nisoperator=0\n";
    assert_eq!(Scene::from_bytes("no_ending", parsip).map(|scene| scene.format), Ok(SceneFormat::Parsip));

    let unknown = Scene::load(Path::new("ball.stl")).unwrap_err();
    // All endings of the table of formats follow.
    let begins = "error: ball.stl is no scene by its ending `.stl`\n  scenes end in .jbt, .vm, ";
    assert!(unknown.to_string().starts_with(begins), "{unknown}");
    assert!(unknown.to_string().contains(", .pov, "), "{unknown}");
    let missing = Scene::load("missing.jbt").unwrap_err();
    assert_eq!(missing.io().map(std::io::Error::kind), Some(std::io::ErrorKind::NotFound));
    assert!(missing.to_string().starts_with("error: cannot read missing.jbt: "), "{missing}");
    assert!(Error::source(&missing).is_some());
}

#[test]
fn models_print_and_parse() {
    let text = "jbt 1 color (1 0.5 0) { point { surface_radius 1 } }";
    let model = jbt::text::model(text).unwrap();
    assert_eq!(jbt::text::model(&jbt::text::print(&model)), Ok(model));
}

#[test]
fn numbers_are_of_any_kind() {
    assert_eq!(point([0, 1, 0], 1), point([0.0, 1.0, 0.0], 1.0));
    assert_eq!(point((0, 0.5f32, 2u8), 1u16), point([0.0, 0.5, 2.0], 1.0));
    assert_eq!(point([0; 3], 1).color([1, 0, 0]), point([0.0; 3], 1.0).color([1.0, 0.0, 0.0]));
    assert_eq!(point([0; 3], 0.1f32), point([0.0; 3], f64::from(0.1f32)));
    let bulge = param("bulge", 0.5);
    assert_eq!((2 * &bulge + 1).to_string(), "2 * bulge + 1");
    assert_eq!(format!("{:?}", 2 * x() - 1), format!("{:?}", 2.0 * x() - 1.0));
}

#[test]
fn trees_add_up() {
    let ball = |x: i32| point([x, 0, 0], 1);
    let balls: Vec<Tree> = (0..5).map(ball).collect();
    let all = Tree::sum(balls.clone());
    assert_eq!(all, balls.iter().sum());
    assert_eq!(all, balls.iter().cloned().sum());
    assert_eq!(Tree::product(balls.clone()), balls.iter().product());
    type Grow = fn(&mut Tree, Tree);
    let cases: [(Combinator, Tree, Grow); 5] = [
        (Sum {}.into(), Tree::sum(balls.clone()), |tree, other| *tree += other),
        (Union {}.into(), Tree::union(balls.clone()), |tree, other| *tree |= other),
        (Intersection {}.into(), Tree::intersection(balls.clone()), |tree, other| *tree &= other),
        (Difference {}.into(), Tree::difference(balls.clone()), |tree, other| *tree -= other),
        (SymmetricDifference {}.into(), Tree::symmetric_difference(balls.clone()), |tree, other| {
            *tree ^= other;
        }),
    ];
    for (combinator, all, grow) in cases {
        assert_eq!(*all.node().written(), combinator.into());
        assert_eq!(all.node().children(), balls);
        let mut grown = balls[0].clone();
        let mut kept = Vec::new();
        for other in &balls[1..] {
            kept.push(grown.clone());
            grow(&mut grown, other.clone());
        }
        // One node, also while others hold what it was, which stays.
        assert_eq!(grown, all);
        assert_eq!(kept[3].node().children().len(), 4);
        let mut alone = balls[0].clone();
        balls[1..].iter().for_each(|other| grow(&mut alone, other.clone()));
        assert_eq!(alone, all);
    }
    let smooth = Tree::smooth(SetOperation::Union, 0.1, balls.clone());
    assert_eq!(smooth.node().children().len(), 5);
    // What depends on a parameter is seen from a root that grew.
    let mut grown = ball(0) + ball(1);
    grown += point([2, 0, 0], param("r", 1.0));
    assert!(grown.node().depends_on_parameters());
    assert!(Model::new(grown).check().unwrap().with_parameters(&[("r", 2.0)]).is_ok());
}

#[test]
fn points_are_collections() {
    let array = [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]];
    let mut points = Points::from(&array[..]);
    assert_eq!(points, Points::from(array.to_vec()));
    assert_eq!(points, array.into_iter().collect());
    assert_eq!(points, Points::from(&array));
    points.extend(&array);
    points.extend([[6.0, 7.0, 8.0]]);
    assert_eq!((points.len(), points.iter().len()), (5, 5));
    assert_eq!(points.iter().next_back(), Some([6.0, 7.0, 8.0]));
    assert_eq!((&points).into_iter().map(|[x, _, _]| x).sum::<f32>(), 12.0);
    assert_eq!(Vec::from(points.clone())[..2], array);
    points.clear();
    assert!(points.is_empty() && points.planes().iter().all(|plane| plane.is_empty()));
}

fn model() -> CheckedTree {
    let balls: Tree = (0..20).map(|i| point([i % 5, i / 5, 0], 1.5).color([i, 1, 0])).sum();
    let cut = balls.twist(Axis::Z, 0.3) - segment([0, 0, 0], [3, 3, 0], 0.4);
    Model::new(cut).check().unwrap()
}

/// Points of the model, and one that is no place.
fn places(count: usize) -> Vec<[f32; 3]> {
    let mut rng = fastrand::Rng::with_seed(16);
    let mut places: Vec<_> = (0..count).map(|_| [0; 3].map(|_: i32| 6.0 * rng.f32() - 1.0)).collect();
    if let Some(last) = places.last_mut() {
        last[1] = f32::NAN;
    }
    places
}

#[test]
fn points_are_evaluated_as_they_are() {
    for engine in Engine::ALL {
        let evaluator = Compiler::for_engine(engine).evaluator(&model(), Query::ALL).unwrap();
        let (mut planes, mut rows) = (evaluator.samples(), evaluator.samples());
        for count in [0, 1, 15, 511, 512, 513, 1300] {
            let places = places(count);
            evaluator.eval(&Points::from(&places), &mut planes).unwrap();
            let before = evaluator.counters().points;
            evaluator.eval(&places[..], &mut rows).unwrap();
            assert_eq!(evaluator.counters().points, before + count as u64);
            assert_eq!(bits(planes.planes()), bits(rows.planes()), "{engine}, {count} points");
        }
    }
}

#[test]
fn threads_give_the_same_bits() {
    for engine in Engine::ALL {
        let evaluator = Compiler::for_engine(engine).evaluator(&model(), Query::ALL).unwrap();
        let (mut serial, mut parallel) = (evaluator.samples(), evaluator.samples());
        for count in [0, 1, 4095, 4096, 4097, 13_001] {
            let rows = places(count);
            let planes = Points::from(&rows);
            evaluator.eval(&rows, &mut serial).unwrap();
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| evaluator.par_eval(&rows, &mut parallel)).unwrap();
                assert_eq!(
                    bits(serial.planes()),
                    bits(parallel.planes()),
                    "{engine}, {count} points, {threads} threads"
                );
                pool.install(|| evaluator.par_eval(&planes, &mut parallel)).unwrap();
                assert_eq!(
                    bits(serial.planes()),
                    bits(parallel.planes()),
                    "{engine}, {count} planes, {threads} threads"
                );
            }
        }
        let other = Compiler::for_engine(engine).evaluator(&model(), Query::FIELD).unwrap();
        assert!(evaluator.par_eval(&places(3), &mut other.samples()).is_err());
    }
}

#[test]
fn attributes_have_names_and_colours() {
    let tree = Model::new(point([0; 3], 1).color([0.25, 0.5, 0.75])).check().unwrap();
    let settings = Polygonize { fineness: Fineness::Resolution(12), ..Polygonize::default() };
    let mesh = settings.mesh(&Compiler::new(), &tree).run().unwrap().mesh;
    let colors = mesh.colors().expect("every model has colours");
    assert_eq!(colors.len(), mesh.positions.len());
    assert!(colors.iter().all(|&color| color == [0.25, 0.5, 0.75]));
    let attribute = mesh.attribute("color").expect("as an attribute, too");
    assert_eq!((attribute.width, attribute.at(3)), (3, &colors[3][..]));
    assert!(mesh.attribute("colour").is_none());

    let evaluator = Evaluator::compile(&tree, Query::ALL).unwrap();
    let mut samples = evaluator.samples();
    evaluator.eval(&[[0.0; 3]], &mut samples).unwrap();
    assert_eq!(samples.colors(), Some([&[0.25][..], &[0.5], &[0.75]]));
    assert_eq!(Evaluator::compile(&tree, Query::FIELD).unwrap().samples().colors(), None);
}

#[test]
fn engines_have_words() {
    for engine in Engine::ALL {
        assert_eq!(engine.to_string().parse(), Ok(engine));
    }
    let error = "cuda".parse::<Engine>().unwrap_err();
    assert_eq!(error.to_string(), "\"cuda\" is none of: scalar, lanes, jit");
}

#[test]
fn debug_is_short() {
    let tree = Model::new((0..500).map(|i| point([i, 0, 0], 1)).sum()).check().unwrap();
    let compiler = Compiler::for_engine(Engine::Lanes);
    let evaluator = compiler.evaluator(&tree, Query::ALL).unwrap();
    let solid = Solid::new(&compiler, &tree).unwrap();
    let slicer = Slicer::new(&compiler, &tree, &Plane::default(), Query::FIELD).unwrap();
    for shown in [
        format!("{compiler:?}"),
        format!("{evaluator:?}"),
        format!("{solid:?}"),
        format!("{slicer:?}"),
        format!("{:?}", evaluator.probe([0.0; 3])),
        format!("{:?}", solid.measure(&Measure::default())),
    ] {
        assert!(shown.len() < 500, "{shown}");
    }
}

#[test]
fn one_token_stops_all_long_work() {
    let tree = model();
    let compiler = Compiler::for_engine(Engine::Lanes);
    let token = CancelToken::new();
    token.clone().cancel();
    let settings = Polygonize { fineness: Fineness::Resolution(16), ..Polygonize::default() };
    let lattice = settings.lattice(&tree).unwrap();
    let made = settings.mesh(&compiler, &tree).cancel(&token).run();
    assert!(matches!(made, Err(PolygonizeError::Mesh(jbt::mesh::MeshError::Cancelled))));
    let render = Render { size: [16, 16], ..Render::default() };
    assert!(matches!(render.picture(&compiler, &tree).cancel(&token).run(), Err(RenderError::Cancelled)));
    let slicer = Slicer::new(&compiler, &tree, &Plane::default(), Query::FIELD).unwrap();
    let rectangle = slicer.rectangle().unwrap();
    let contour = slicer.contour(&rectangle, &Detail::default()).cancel(&token).run();
    assert!(matches!(contour, Err(SliceError::Cancelled)));
    let detail = ImageDetail { fineness: Fineness::Resolution(16), samples: 1 };
    assert!(matches!(slicer.inside(&rectangle, &detail).cancel(&token).run(), Err(SliceError::Cancelled)));
    let sampler = Sampler::new(&compiler, &tree, Query::FIELD).unwrap();
    let blocks = sampler.blocks(&lattice, Wanted::Support).cancel(&token).run();
    assert!(matches!(blocks, Err(SampleError::Cancelled)));
    let solid = Solid::new(&compiler, &tree).unwrap();
    let measured = solid.measure(&Measure::default()).cancel(&token).run();
    assert!(matches!(measured, Err(MeasureError::Cancelled)));
    let statistics = Statistics::new(&tree);
    let supports = statistics.supports(&compiler, &lattice).cancel(&token).run();
    assert!(matches!(supports, Err(SupportsError::Cancelled)));
}

#[cfg(feature = "glam")]
#[test]
fn glam_points_are_points() {
    let places = places(700);
    let theirs: Vec<glam::Vec3> = places.iter().map(|&place| place.into()).collect();
    let evaluator = Evaluator::compile(&model(), Query::FIELD).unwrap();
    let (mut ours, mut samples) = (evaluator.samples(), evaluator.samples());
    evaluator.eval(&places, &mut ours).unwrap();
    evaluator.eval(&theirs, &mut samples).unwrap();
    assert_eq!(bits(ours.planes()), bits(samples.planes()));
    evaluator.par_eval(&Points::from(&theirs), &mut samples).unwrap();
    assert_eq!(bits(ours.planes()), bits(samples.planes()));
    assert_eq!(point(glam::Vec3::X, 1), point([1, 0, 0], 1));
}

#[cfg(feature = "mint")]
#[test]
fn mint_points_are_points() {
    let theirs = [mint::Point3 { x: 1.0, y: 2.0, z: 3.0 }];
    assert_eq!(Points::from(&theirs), Points::from(&[[1.0, 2.0, 3.0]]));
    assert_eq!(point(mint::Vector3::from([1.0, 0.0, 0.0]), 1), point([1, 0, 0], 1));
}

#[cfg(feature = "serde")]
#[test]
fn meshes_settings_and_reports_are_data() {
    fn again<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
        serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
    }
    let tree = model();
    let settings = Polygonize { fineness: Fineness::Resolution(12), ..Polygonize::default() };
    assert_eq!(again(&settings), settings);
    let made = settings.mesh(&Compiler::new(), &tree).run().unwrap();
    assert_eq!(again(&made.mesh), made.mesh);
    assert_eq!(again(&made.report), made.report);
    assert_eq!(serde_json::to_value(Engine::Lanes).unwrap(), "lanes");
    let points = Points::from(&[[0.0, 0.5, 1.0]]);
    assert_eq!(serde_json::to_string(&points).unwrap(), "[[0.0,0.5,1.0]]");
    assert_eq!(again(&points), points);
    let evaluator = Evaluator::compile(&tree, Query::ALL).unwrap();
    let mut samples = evaluator.samples();
    evaluator.eval(&points, &mut samples).unwrap();
    let written = serde_json::to_value(&samples).unwrap();
    assert_eq!(written["field"][0].as_f64().unwrap() as f32, samples.field()[0]);
    assert_eq!(written["color.r"].as_array().unwrap().len(), 1);
}
