//! Names of parts: what `--only` and `--without` leave, and what files call it.

use crate::folder::Folder;

const ROBOT: &str = "jbt 1
let hand = point { surface_radius 0.3 }
robot: union {
    point { surface_radius 0.5 }
    arm: translate (2 0 0) { use hand }
    arm: translate (-2 0 0) { use hand }
    колесо: translate (0 0 -1) { use hand }
}
";

fn folder() -> Folder {
    Folder::new().with("robot.jbt", ROBOT)
}

#[test]
fn parts_are_selected() {
    let folder = folder();
    let bounds = |arguments: &[&str]| {
        let all = [&["check", "robot.jbt", "--json"], arguments].concat();
        let json = folder.jbt(&all).code(0).json();
        let model = &json["files"][0]["model"];
        let bound = |index: usize| model["bounds"][index].as_f64().unwrap().signum();
        (model["instances"].as_u64().unwrap(), bound(0), bound(3))
    };
    assert_eq!(bounds(&[]), (4, -1.0, 1.0));
    assert_eq!(bounds(&["--only", "arm"]), (2, -1.0, 1.0));
    assert_eq!(bounds(&["--only", "arm.0"]), (1, 1.0, 1.0));
    assert_eq!(bounds(&["--only", "robot/arm.1/hand"]), (1, -1.0, -1.0));
    assert_eq!(bounds(&["--without", "arm.1", "--without", "колесо"]), (2, -1.0, 1.0));
    assert_eq!(bounds(&["--without", "hand"]), (1, -1.0, 1.0));
    for (path, words) in [
        ("leg", "nothing in the model is called `leg`"),
        ("arn", "perhaps `arm`"),
        ("arm.7", "there are arm, hand, robot"),
        ("a b", "is no path"),
        ("\u{1b}[2J", "is no path"),
    ] {
        folder.jbt(&["check", "robot.jbt", "--only", path]).code(2).says(words);
    }
    folder.jbt(&["check", "robot.jbt", "--without", "robot"]).code(2).says("nothing is left of the model");
}

#[test]
fn names_are_told() {
    let folder = folder();
    let ran = folder.jbt(&["check", "robot.jbt"]).code(0);
    assert!(ran.stdout().contains("\n  names        arm, hand, robot, колесо\n"), "{}", ran.stdout());
    let json = folder.jbt(&["check", "robot.jbt", "--json"]).code(0).json();
    assert_eq!(json["files"][0]["model"]["names"][3], "колесо");
    let tree = folder.jbt(&["show", "robot.jbt", "--stage", "tree"]).code(0).stdout();
    assert!(tree.contains("let hand = point") && tree.contains("колесо: translate"), "{tree}");
}

#[test]
fn files_have_names_of_parts() {
    let folder = folder();
    let names = |arguments: &[&str]| {
        let mesh = |file: &str| {
            folder
                .jbt(&[&["mesh", "robot.jbt", "-o", file, "--force", "--cell", "0.2"], arguments].concat())
                .code(0);
            folder.read(file)
        };
        let glb = mesh("a.glb");
        let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
        let obj = String::from_utf8(mesh("a.obj")).unwrap();
        let object = obj.lines().find_map(|line| line.strip_prefix("o ")).map(str::to_owned);
        (json["nodes"][0]["name"].as_str().map(str::to_owned), object)
    };
    let both = |name: &str| (Some(name.to_owned()), Some(name.to_owned()));
    assert_eq!(names(&[]), both("robot"));
    assert_eq!(names(&["--only", "колесо"]), both("колесо"));
    assert_eq!(names(&["--only", "robot/arm.1"]), both("robot/arm.1"));
    let plain = Folder::new().with("robot.jbt", "jbt 1 point { surface_radius 1 }");
    plain.jbt(&["mesh", "robot.jbt", "-o", "a.obj", "--cell", "0.2"]).code(0);
    assert!(!String::from_utf8(plain.read("a.obj")).unwrap().contains("\no "));
}
