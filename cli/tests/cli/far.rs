//! A model far from the origin of the world: commands speak of the world, and answer as at home.

use serde_json::{Value, json};

use crate::folder::Folder;

/// A ball of radius 1 at home, and the same far away.
fn folder() -> Folder {
    let ball = "point { surface_radius 1 }";
    Folder::new()
        .with("home.jbt", format!("jbt 1 {ball}"))
        .with("far.jbt", format!("jbt 1 translate (100000.25 -100000 33000) {{ {ball} }}"))
        .with("home.csv", "x,y,z\n0.7,0,0.001\n0.45,-0.2,1.1\n")
        .with("far.csv", "x,y,z\n100000.95,-100000,33000.001\n100000.7,-100000.2,33001.1\n")
}

/// The numbers of a CSV file, line by line, without the header.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect()
}

#[test]
fn eval_answers_far_away_as_at_home() {
    let folder = folder();
    let eval = |name: &str| {
        let (scene, points) = (format!("{name}.jbt"), format!("{name}.csv"));
        let ran = folder.jbt(&["eval", &scene, "--points", &points, "--query", "all", "-o", "-"]).code(0);
        numbers(&ran.stdout())
    };
    let (home, far) = (eval("home"), eval("far"));
    // As they were given, with all digits.
    assert_eq!(far[0][..3], [100_000.95, -100_000.0, 33_000.001]);
    assert_eq!(home[0][..3], [0.7, 0.0, 0.001]);
    for (home, far) in home.iter().zip(&far) {
        assert!(
            home[3..].iter().zip(&far[3..]).all(|(home, far)| (home - far).abs() < 1e-6),
            "{home:?} {far:?}"
        );
    }
}

#[test]
fn reports_are_about_the_world_and_name_the_origin() {
    let folder = folder();
    let region = "--region=99998,-100002,32998,100002,-99998,33002";
    let report = |arguments: &[&str]| folder.jbt(&[arguments, &["--json"]].concat()).code(0).json();
    let near = |value: &Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-2;
    for arguments in [
        &["mesh", "far.jbt", "-o", "a.glb", "--resolution", "16"][..],
        &["mesh", "far.jbt", "-o", "a.glb", "--resolution", "16", region],
        &["sample", "far.jbt", "-o", "a.npy", "--resolution", "16", region],
        &["stats", "far.jbt", "--depth", "5"],
        &["stats", "far.jbt", "--depth", "5", region],
    ] {
        let report = report(arguments);
        assert_eq!(report["origin"], json!([100_000.0, -100_000.0, 33_000.0]), "{arguments:?}");
        let middle = |axis: usize| {
            0.5 * (report["region"][axis].as_f64().unwrap() + report["region"][3 + axis].as_f64().unwrap())
        };
        assert!((middle(0) - 100_000.0).abs() < 1.0 && (middle(2) - 33_000.0).abs() < 1.0, "{arguments:?}");
    }
    let stats = report(&["stats", "far.jbt", "--depth", "6"]);
    assert!(near(&stats["center"][0], 100_000.25) && near(&stats["tight"]["outer"][0], 99_999.25));
    assert!((stats["volume"]["estimate"].as_f64().unwrap() - 4.18879).abs() < 0.05);
    for arguments in [
        &["contour", "far.jbt", "-o", "a.svg", "--plane", "z=33000.5"][..],
        &["render", "far.jbt", "-o", "a.png", "--size", "32x24"],
        &["render", "far.jbt", "-o", "a.png", "--size", "32x24", region],
        &["count", "far.jbt", "--resolution", "8"],
    ] {
        assert_eq!(report(arguments)["origin"], json!([100_000.0, -100_000.0, 33_000.0]), "{arguments:?}");
    }
    let picture = report(&["render", "far.jbt", "-o", "a.png", "--size", "32x24"]);
    assert!(picture["pixels_hit"].as_u64().unwrap() > 100);
    assert!((picture["camera"]["eye"][1].as_f64().unwrap() + 100_000.0).abs() < 100.0);
    let contour = report(&["contour", "far.jbt", "-o", "a.svg", "--plane", "z=33000.5"]);
    assert!((contour["area"].as_f64().unwrap() - 0.75 * std::f64::consts::PI).abs() < 0.01);
    let home = report(&["mesh", "home.jbt", "-o", "a.glb", "--resolution", "16"]);
    assert_eq!(home["origin"], json!([0.0, 0.0, 0.0]));

    let text = |arguments: &[&str]| folder.jbt(arguments).code(0).stdout();
    for command in ["stats", "check"] {
        assert!(text(&[command, "far.jbt"]).contains("origin       (100000 -100000 33000)"), "{command}");
        assert!(!text(&[command, "home.jbt"]).contains("origin"), "{command}");
    }
}

#[test]
fn a_file_without_the_digits_earns_a_warning() {
    let folder = folder();
    let warning = "a .stl file has not enough digits";
    let mesh = |scene: &str, name: &str| {
        folder.jbt(&["mesh", scene, "-o", name, "--resolution", "16", "--json"]).code(0).json()["warnings"]
            .to_string()
    };
    assert!(mesh("far.jbt", "a.stl").contains(warning));
    for name in ["a.glb", "a.ply", "a.obj"] {
        assert_eq!(mesh("far.jbt", name), "[]", "{name}");
    }
    assert_eq!(mesh("home.jbt", "a.stl"), "[]");
}
