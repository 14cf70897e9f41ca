//! The first hour with the library: errors that show their places, scenes by their endings, and the traits that people expect.

use std::error::Error;
use std::path::Path;

use jbt::diagnostic::Severity;
use jbt::text::{Options, parse};
use jbt::{CompileError, Diagnostics, Model, Scene, SceneFormat};

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
    let model: Model = "jbt 1\nparam r = 1\npoint { radius r }".parse().unwrap();
    let set = model.check().unwrap().with_parameters(&[("r", -1.0)]).unwrap_err();
    assert!(named(set).starts_with("<text>:3:1: error: the radius is -1"));
    let built = Model::new(jbt::build::point([0.0; 3], -1.0)).check().unwrap_err();
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
    assert_eq!(
        unknown.to_string(),
        "error: ball.stl is no scene by its ending `.stl`\n  scenes end in .jbt, .blob, .scene, .vm"
    );
    let missing = Scene::load("missing.jbt").unwrap_err();
    assert_eq!(missing.io().map(std::io::Error::kind), Some(std::io::ErrorKind::NotFound));
    assert!(missing.to_string().starts_with("error: cannot read missing.jbt: "), "{missing}");
    assert!(Error::source(&missing).is_some());
}

#[test]
fn models_print_and_parse() {
    let text = "jbt 1 color (1 0.5 0) { point { surface_radius 1 } }";
    let model: Model = text.parse().unwrap();
    assert_eq!(model.to_string().parse::<Model>().unwrap(), model);
}
