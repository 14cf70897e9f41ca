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

#[test]
fn the_way_to_the_owner_is_a_column() {
    let scene = "jbt 1 attribute rough 1
let pin = point { radius 1 }
part \"left\" { translate (-4 0 0) { use pin } }
part \"rest\" {
    rim: union { translate (4 0 0) { use pin } rough 1 { point { at (8 0 0) radius 1 } } }
    deform by (0 0 1) weighted { point { at (0 8 0) radius 1 } use pin }
}";
    let folder =
        Folder::new().with("a.jbt", scene).with("p.csv", "x,y,z\n-4,0,0\n4,0,0\n8,0,0\n20,0,0\n0,8,0\n");
    let table = |query: &str, more: &[&str]| {
        let all = [&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", query], more].concat();
        folder.jbt(&all).code(0).stdout()
    };
    // The pin has several places, of which the first one is told.
    let first = "left/pin";
    let expected = format!(
        "x,y,z,field,owner,owner.path
-4,0,0,1,0,{first}
4,0,0,1,0,{first}
8,0,0,1,5,rest/rim/1.rough/0.point
20,0,0,0,-1,
0,8,0,1,9,rest/1.deform/0.point
"
    );
    let found = table("owner.path", &[]);
    assert_eq!(found.lines().next(), expected.lines().next());
    for (found, expected) in found.lines().zip(expected.lines()).skip(1) {
        // Which numbers nodes have is not of interest here.
        let without = |line: &str| {
            let fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            [&fields[..4], &fields[5..]].concat()
        };
        assert_eq!(without(found), without(expected));
    }
    assert_eq!(table("owner.path", &["--engine", "scalar", "--threads", "1"]), found);
    let all = table("all,owner.path", &[]);
    assert!(
        all.starts_with("x,y,z,field,gx,gy,gz,color.r,color.g,color.b,rough,owner,owner.path\n"),
        "{all}"
    );
    assert!(table("field,rough,owner", &[]).starts_with("x,y,z,field,rough,owner\n"));
    for command in [&["sample", "a.jbt", "-o", "a.npy"][..], &["show", "a.jbt", "--stage", "ir"]] {
        folder
            .jbt(&[command, &["--query", "owner.path"]].concat())
            .code(2)
            .says("is text, which only `jbt eval`");
    }
    let own =
        Folder::new().with("a.jbt", "jbt 1 attribute owner 1 point { radius 1 }").with("p.csv", "x,y,z\n");
    let ran = own.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", "owner.path"]);
    ran.code(2).says("has an attribute `owner` of its own");
}

/// Weights of leaves, of names and of nobody are columns of their own, in the order of the tree.
#[test]
fn weights_are_columns() {
    let scene = "jbt 1 attribute rough 1
body: sum {
    left: color (1 0 0) { point { radius 2 } }
    right: translate (1 0 0) { point { radius 2 } }
}";
    let folder = Folder::new().with("a.jbt", scene).with("p.csv", "x,y,z\n0.5,0,0\n-1.5,0,0\n9,0,0\n");
    let table = |query: &str| {
        folder.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", query]).code(0).stdout()
    };
    let all = table("weights,color.defined,owner.path");
    let lines: Vec<&str> = all.lines().collect();
    assert_eq!(
        lines[0],
        "x,y,z,field,owner,weights.body/left/0.point,weights.body/right/0.point,weights.default,color.defined,owner.path"
    );
    assert!(lines[1].ends_with(",0.5,0.5,0,0.5,body/left/0.point"), "{}", lines[1]);
    assert!(lines[2].ends_with(",1,0,0,1,body/left/0.point"), "{}", lines[2]);
    assert!(lines[3].ends_with(",-1,0,0,1,0,"), "{}", lines[3]);
    let named = table("left.weight,body/right.weight,weights.default");
    let lines: Vec<&str> = named.lines().collect();
    assert_eq!(lines[0], "x,y,z,field,left.weight,body/right.weight,weights.default");
    assert!(lines[1].ends_with(",0.5,0.5,0") && lines[3] == "9,0,0,0,0,0,1", "{named}");
    let refused = |query: &str, words: &str| {
        folder.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", query]).code(2).says(words);
    };
    refused("leg.weight", "nothing in the model is called `leg`");
    refused("left.0.weight.weight", "is no path");
    // A model may have a group of that name.
    let own = Folder::new()
        .with("a.jbt", "jbt 1 attribute weights 1 default 7 point { radius 1 }")
        .with("p.csv", "x,y,z\n0,0,0\n");
    let ran = own.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", "weights"]).code(0);
    assert_eq!(ran.stdout(), "x,y,z,field,weights\n0,0,0,1,7\n");
}

/// Of more parts than a process may have files open, each has its file.
#[cfg(target_os = "linux")]
#[test]
fn many_parts_have_files_though_few_are_open() {
    let part = |index: usize| {
        format!("part \"p{index}\" {{ point {{ at ({} 0 0) surface_radius 0.4 }} }}\n", 2 * index)
    };
    let folder = Folder::new().with("many.jbt", format!("jbt 1\n{}", (0..60).map(part).collect::<String>()));
    let binary = env!("CARGO_BIN_EXE_jbt");
    let line = format!("ulimit -n 40; exec {binary} mesh many.jbt --parts -o 'many_{{}}.stl' --cell 0.4");
    let ran =
        std::process::Command::new("sh").args(["-c", &line]).current_dir(folder.path("")).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let files: Vec<String> = std::fs::read_dir(folder.path(""))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".stl") || name.starts_with('.'))
        .collect();
    assert!(files.len() == 60 && files.iter().all(|name| name.starts_with("many_p")), "{files:?}");
}

/// A letter with its mark as two characters is the letter as one, on the command line too.
#[test]
fn names_are_normalized_on_the_command_line() {
    let scene = "jbt 1 attribute gr\u{f6}\u{df}e 1 gr\u{f6}\u{df}e 0.5 { point { surface_radius 1 } }";
    let folder = Folder::new().with("a.jbt", scene).with("p.csv", "x,y,z\n0,0,0\n");
    let two = "gro\u{308}\u{df}e";
    let eval = |query: &str| {
        folder.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", query]).code(0).stdout()
    };
    assert_eq!(eval(two), "x,y,z,field,gr\u{f6}\u{df}e\n0,0,0,1,0.5\n");
    let defined = eval(&format!("{two}.defined"));
    assert_eq!(defined.lines().nth(1), Some("0,0,0,1,1"));
    folder.jbt(&["mesh", "a.jbt", "-o", "a.glb", "--cell", "0.5", "--color-by", two]).code(0);
    folder.jbt(&["render", "a.jbt", "-o", "a.png", "--size", "32x32", "--mode", "attribute", two]).code(0);
    let slice =
        ["contour", "a.jbt", "-o", "b.png", "--cell", "0.1", "--mode", "attribute", "--attribute", two];
    folder.jbt(&slice).code(0);
}

/// What the paths of owners say, `--only` selects; a use with a name has weights.
#[test]
fn told_paths_select() {
    let scene = "jbt 1 let arm = point { radius 1 }
        union { left: use arm translate (3 0 0) { use arm } ring { center (0 0 4) ring_radius 1 radius 0.5 } }";
    let folder = Folder::new().with("a.jbt", scene).with("p.csv", "x,y,z\n0,0,0\n1,0,4\n");
    let eval = |query: &str| {
        folder.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", query]).code(0).stdout()
    };
    assert_eq!(eval("left.weight"), "x,y,z,field,left.weight\n0,0,0,1,1\n1,0,4,1,0\n");
    let last = |line: &str| line.rsplit(',').next().unwrap().to_owned();
    let paths: Vec<String> = eval("owner.path").lines().skip(1).map(last).collect();
    assert_eq!(paths, ["left/arm", "0.union/2.ring"]);
    for (path, kind) in paths.iter().zip(["point", "ring"]) {
        let alone = folder.jbt(&["convert", "a.jbt", "-o", "-", "--only", path]).code(0).stdout();
        let [kept, gone] = if kind == "ring" { ["ring {", "point {"] } else { ["point {", "ring {"] };
        assert!(alone.contains(kept) && !alone.contains(gone), "{path}: {alone}");
    }
    let printed = folder.jbt(&["convert", "a.jbt", "-o", "-"]).code(0).stdout();
    assert!(printed.contains("    left: use arm\n"), "{printed}");
    // The name costs nothing.
    let code = |text: &str| {
        let folder = Folder::new().with("a.jbt", text);
        folder.jbt(&["show", "a.jbt", "--stage", "ir"]).code(0).stdout()
    };
    assert_eq!(code(scene), code(&scene.replace("left: use arm", "use arm")));
}

/// A chain of many nodes has a way that is longer than anybody reads.
#[test]
fn long_ways_keep_their_ends() {
    let deep = 2000;
    let scene =
        format!("jbt 1 {} point {{ radius 1 }} {}", "color (1 0 0) { ".repeat(deep), "}".repeat(deep));
    let folder = Folder::new().with("a.jbt", scene).with("p.csv", "x,y,z\n0,0,0\n");
    let ran = folder.jbt(&["eval", "a.jbt", "--points", "p.csv", "-o", "-", "--query", "owner.path"]).code(0);
    let line = ran.stdout().lines().nth(1).unwrap().to_owned();
    assert!(
        line.contains(",…/0.color/") && line.ends_with("/0.color/0.point") && line.len() < 1100,
        "{line}"
    );
}

const SET: &str = "jbt 1
part \"hub\" { sphere { sphere_radius 1 surface_radius 0.1 } }
part \"left_arm\" { constant material \"oak\" { box { center (4 0 0) half (1 1 1) surface_radius 0.1 } } }
part \"LEFT_ARM\" { point { at (8 0 0) surface_radius 1 } }
";

#[test]
fn parts_go_to_files_of_their_own() {
    let folder = Folder::new().with("set.jbt", SET);
    let json = folder
        .jbt(&["mesh", "set.jbt", "--parts", "-o", "set_{}.obj", "--cell", "0.25", "--json"])
        .code(0)
        .json();
    let names = ["hub", "left_arm", "LEFT_ARM"];
    let whole = folder.jbt(&["mesh", "set.jbt", "-o", "all.obj", "--cell", "0.25", "--json"]).code(0).json();
    assert!(whole["parts"].is_null());
    let mut triangles = 0;
    for (place, file) in ["set_hub.obj", "set_left_arm.obj", "set_LEFT_ARM-2.obj"].into_iter().enumerate() {
        let part = &json["parts"][place];
        assert_eq!((part["name"].as_str(), part["file"].as_str()), (Some(names[place]), Some(file)));
        let text = String::from_utf8(folder.read(file)).unwrap();
        assert_eq!(text.matches("\no ").count(), 1, "{file}");
        assert_eq!(text.contains("oak"), place == 1, "{file}");
        let count = text.lines().filter(|line| line.starts_with("f ")).count();
        assert_eq!(part["triangles"].as_u64(), Some(count as u64), "{file}");
        triangles += count as u64;
    }
    assert_eq!(Some(triangles), whole["triangles"].as_u64());
    let ran = folder.jbt(&["mesh", "set.jbt", "--parts", "-o", "set_{}.stl", "--cell", "0.25"]).code(0);
    assert!(ran.stdout().contains("set_left_arm.stl"), "{}", ran.stdout());
    // What stands on a table stays in parts.
    let flat = [
        "mesh",
        "set.jbt",
        "--parts",
        "-o",
        "flat_{}.stl",
        "--cell",
        "0.25",
        "--flat-bottom",
        "0.3",
        "--json",
    ];
    assert_eq!(folder.jbt(&flat).code(0).json()["parts"][2]["name"], "LEFT_ARM");
}

#[test]
fn parts_without_a_place_are_refused() {
    let folder = Folder::new().with("set.jbt", SET).with("one.jbt", "jbt 1 point { surface_radius 1 }");
    for (arguments, words) in [
        (&["set.jbt", "--parts"][..], "--parts needs {} in the name of -o"),
        (&["set.jbt", "--parts", "-o", "a.stl"], "--parts needs {} in the name of -o"),
        (&["set.jbt", "--parts", "-o", "{}/a.stl"], "--parts needs {} in the name of -o"),
        (&["one.jbt", "--parts", "-o", "a_{}.stl"], "--parts needs a scene of parts"),
        (&["set_{}.jbt", "--parts", "-o", "a_{}.stl"], "a sequence has its number there"),
        (&["set.jbt", "--parts", "-o", "a_{}.xyz"], "does not end with"),
    ] {
        folder.jbt(&[&["mesh"], arguments].concat()).code(2).says(words);
    }
    // One that cannot be written leaves the others as they were.
    std::fs::create_dir(folder.path("set_LEFT_ARM-2.stl")).unwrap();
    folder.jbt(&["mesh", "set.jbt", "--parts", "-o", "set_{}.stl", "--cell", "0.25"]).code(4);
    assert!(!folder.path("set_hub.stl").exists());
}
