//! Whatever is wrong with files and options ends in a message and an exit code: never a panic, never a
//! terminal escape.

use std::fs;
use std::process::{Command, Stdio};

use crate::folder::{BLOB, Folder, SCENE};

fn folder() -> Folder {
    Folder::new().with("scene.jbt", SCENE).with("scene.blob", BLOB).with("p.csv", "x,y,z\n0,0,0\n")
}

/// Every command on a scene.
fn commands(scene: &str) -> [Vec<&str>; 8] {
    [
        vec!["mesh", scene, "-o", "out.glb"],
        vec!["render", scene, "-o", "out.png", "--size", "8"],
        vec!["contour", scene, "-o", "out.svg"],
        vec!["eval", scene, "--points", "p.csv", "-o", "out.csv"],
        vec!["show", scene, "--stage", "ir"],
        vec!["count", scene],
        vec!["stats", scene],
        vec!["check", scene],
    ]
}

#[test]
fn bad_scenes_are_located_errors_for_every_command() {
    let cases: [(&str, &[u8], &str); 9] = [
        ("empty.jbt", b"", "empty.jbt:1:1: error: the file is empty"),
        ("garbage.jbt", b"\x00\xff\xfe\x1b]0;x\x07 %%% \x9b", "garbage.jbt: byte 1: error: "),
        ("nan.jbt", b"jbt 1\npoint { radius 0 / 0 }", "nan.jbt:2:"),
        ("zero.jbt", b"jbt 1\npoint { radius 0 }", "zero.jbt:2:"),
        ("unknown.jbt", b"jbt 1\npiont { radius 1 }", "unknown.jbt:2:1: error: "),
        ("name.jbt", b"jbt 1\nuse \x1b[2J\xe2\x80\xae", "name.jbt:2:5: error: "),
        ("singular.jbt", b"jbt 1\nscale (1 0 1) { point { radius 1 } }", "singular.jbt:2:"),
        ("cycle.blob", b"[BLOBNODE 0]\nIsOperator=1\nOperatorType=UNION\nChildrenCount=1\nChildrenIDs=(0)\n[Global]\nRootIDs=(0)\n", "cycle.blob:"),
        ("garbage.scene", b"[\x1b[31m\n=\n[BLOBNODE -1]\n", "garbage.scene:"),
    ];
    for (name, text, place) in cases {
        let folder = folder().with(name, text);
        for arguments in commands(name) {
            let ran = folder.jbt(&arguments).code(1).says(place);
            assert_eq!(ran.stdout(), "", "{arguments:?}");
        }
        assert!(["out.glb", "out.png", "out.csv"].iter().all(|name| !folder.path(name).exists()));
    }
}

#[test]
fn every_error_is_reported_with_a_caret() {
    let folder = folder().with("two.jbt", "jbt 1\nsum {\n  point { radius 0 }\n  point { radius -1 }\n}\n");
    let ran = folder.jbt(&["check", "two.jbt"]).code(1).says("two.jbt:3:").says("two.jbt:4:");
    assert_eq!(ran.stderr().matches("error: ").count(), 2, "{}", ran.stderr());
    assert!(ran.stderr().contains('^'));
}

#[test]
fn braces_without_end() {
    let folder = folder().with("braces.jbt", [b"jbt 1\n".as_slice(), &b"sum{".repeat(300_000)].concat());
    folder.jbt(&["check", "braces.jbt"]).code(1).says("braces.jbt:");
    let folder = folder.with("closing.jbt", [b"jbt 1\n".as_slice(), &b"}".repeat(1_000_000)].concat());
    folder.jbt(&["check", "closing.jbt"]).code(1).says("closing.jbt:2:1");
}

#[test]
fn a_long_chain_is_a_scene_like_any_other() {
    let depth = 1_000;
    let text = format!(
        "jbt 1\n{}point {{ radius 1 }}{}",
        "translate (0.001 0 0) { ".repeat(depth),
        "}".repeat(depth)
    );
    let folder = folder().with("chain.jbt", text).with("q.csv", "x,y,z\n1,0,0\n");
    let ran = folder.jbt(&["eval", "chain.jbt", "--points", "q.csv", "-o", "-"]).code(0);
    let field: f32 =
        ran.stdout().lines().nth(1).and_then(|line| line.rsplit(',').next()).unwrap().parse().unwrap();
    assert!((field - 1.0).abs() < 1e-5, "the centre of a point: {field}");
}

#[test]
fn scenes_over_the_limit_are_refused_unread() {
    let folder = folder();
    let path = folder.path("huge.jbt");
    // A sparse file takes no room.
    fs::File::create(&path).and_then(|file| file.set_len((64 << 20) + 1)).unwrap();
    folder.jbt(&["check", "huge.jbt"]).code(3).says("jbt: limit: huge.jbt is larger than 64 MiB");
    let blanks = vec![b' '; (64 << 20) + 1];
    folder.jbt_with_input(&["check", "-"], &blanks).code(3).says("<stdin> is larger than 64 MiB");
}

#[test]
fn formulas_over_the_limit_have_one_exit_code_in_every_format() {
    let steps = jbt::limits::MAX_EXPRESSION_STEPS + 1;
    let mut program = "_0 var-x\n_1 var-y\n".to_owned();
    for line in 2..steps + 2 {
        program += &format!("_{line} add _{} _{}\n", line - 1, line - 2);
    }
    let text = format!("jbt 1 expression {{ x{} }}", " + y".repeat(steps));
    let folder = folder().with("long.vm", program).with("long.jbt", text);
    folder.jbt(&["check", "long.vm"]).code(3).says("the expression has").says(" operations");
    folder.jbt(&["check", "long.jbt"]).code(3).says("the expression has").says(" operations");
}

#[test]
fn programs_over_the_limit_are_refused_by_check_and_by_each_command() {
    let sines =
        |count: usize| format!("jbt 1\nexpression {{ {}x{} }}\n", "sin(".repeat(count), ")".repeat(count));
    let folder = folder().with("all.jbt", sines(100_000)).with("some.jbt", sines(12_000));
    let limit =
        "all.jbt:2:1: limit: after the pass legalize, the model's program has more than 1000000 values";
    folder.jbt(&["check", "all.jbt"]).code(3).says(limit);
    folder.jbt(&["eval", "all.jbt", "--points", "p.csv", "-o", "-"]).code(3).says(limit);
    // What some commands take, `check` says of the others, in a line.
    let ran = folder.jbt(&["check", "some.jbt"]).code(0);
    let told = ran.stdout();
    let line = told.lines().find(|line| line.contains("too large")).unwrap_or_default();
    assert!(line.contains("for mesh, ") && line.contains(": limit: after the pass "), "{told}");
    assert!(!line.contains("\\u{a}"), "{line}");
    let region = ["--region", "0,0,0,1,1,1", "--resolution", "2"];
    folder
        .jbt(&[&["mesh", "some.jbt", "-o", "a.glb"][..], &region].concat())
        .code(3)
        .says("some.jbt:2:1: limit: ");
    folder.jbt(&["eval", "some.jbt", "--points", "p.csv", "-o", "-"]).code(0);
}

#[test]
fn lattices_over_the_limit_are_refused() {
    let folder = folder();
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.glb", "--cell", "1e-5"]).code(3).says("jbt: limit: ");
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.glb", "--resolution", "100000"]).code(3).says("jbt: limit: ");
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.glb", "--cell", "1e-300"]).code(3).says("jbt: limit: ");
}

#[test]
fn usage_errors() {
    let folder = folder();
    let mesh = |extra: &[&str]| folder.jbt(&[&["mesh", "scene.jbt", "-o", "a.glb"], extra].concat());
    mesh(&["--region", "0,0,0,1,1"]).code(2).says("six numbers");
    mesh(&["--region", "1,0,0,0,1,1"]).code(2).says("must be greater than X0");
    mesh(&["--cell", "0"]).code(2).says("greater than zero");
    mesh(&["--cell", "-1"]).code(2).says("greater than zero");
    mesh(&["--cell", "nan"]).code(2).says("greater than zero");
    mesh(&["--resolution", "0"]).code(2).says("at least one cell");
    mesh(&["--cell", "1", "--resolution", "9"]).code(2).says("cannot be used with");
    mesh(&["--threads", "0"]).code(2).says("--threads");
    mesh(&["--engine", "gpu"]).code(2).says("scalar, lanes, jit");
    mesh(&["-D", "bulge"]).code(2).says("NAME=VALUE");
    mesh(&["--cell", "inf"]).code(2).says("a finite number greater than zero");
    mesh(&["--resolution", "1e3"]).code(2).says("expected a whole number of cells, as 128");
    mesh(&["--resolution", "-5"]).code(2).says("expected a whole number of cells, as 128");
    folder.jbt(&["scene.jbt"]).code(2).says("a command stands before the scene, as `jbt render scene.jbt`");
    folder.jbt(&["nothing"]).code(2).says("unrecognized subcommand");
    folder.jbt(&[]).code(2).says("Usage");
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.txt"]).code(2).says(".glb, .ply, .obj, .stl, .3mf or .usda");
    folder
        .jbt(&["mesh", "scene.jbt", "-o", "-"])
        .code(2)
        .says("needs --format glb, ply, obj, stl, 3mf or usda");
    mesh(&["--up", "x"]).code(2).says("y, z");
    mesh(&["--colors", "rgb"]).code(2).says("srgb, linear");
    folder.jbt(&["mesh", "scene.jbt", "-o", "a.stl", "--colors", "srgb"]).code(2).says("no colours");
    folder.jbt(&["mesh", "scene.jbt", "-o", "-", "--format", "glb", "--json"]).code(2).says("JSON");
    folder.jbt(&["eval", "-", "--points", "-", "-o", "-"]).code(2).says("both");
    folder.jbt(&["check", "scene.blob", "-D", "r=1"]).code(2).says("no parameter `r`");
    folder.jbt(&["show", "scene.jbt", "--stage", "\x1b[2J"]).code(2).says("\\u{1b}[2J");
    folder.jbt(&["frobnicate\x1b[2J"]).code(2).says("frobnicate");
}

#[test]
fn bad_points_are_located() {
    let folder = folder().with("out.csv", "old");
    let cases: [(&str, i32, &str); 8] = [
        ("", 1, "q.csv:1:1: error: there is no header"),
        ("x,y,z\n0,0,0\n0,nan,0\n", 1, "q.csv:3:3: error: `nan` is not a number, for y"),
        ("x,y,z\n0,0,1e400\n", 1, "q.csv:2:5: error: `1e400` is too large"),
        ("x,y,z\n-inf,0,0\n", 1, "q.csv:2:1: error: `-inf` is not finite"),
        ("x,y\n0,0\n", 1, "q.csv:1:1: error: there is no column `z`"),
        ("x,y,z\n0,0,0\n0,\x1b[31m,0\n", 1, "q.csv:3:3: error: `\\u{1b}[31m` is not a number"),
        ("x,y,z\n0,0\n", 1, "q.csv:2:4: error: the line ends before its column `z`"),
        ("x,y,z\n0,\"0\n\",0\n", 1, "q.csv:2:3: error: the quote is not closed"),
    ];
    for (text, code, message) in cases {
        fs::write(folder.path("q.csv"), text).unwrap();
        folder.jbt(&["eval", "scene.jbt", "--points", "q.csv", "-o", "out.csv"]).code(code).says(message);
        assert_eq!(folder.read("out.csv"), b"old", "a failure leaves the old file");
    }
    let left = fs::read_dir(folder.path(".")).unwrap().count();
    assert_eq!(left, 5, "nothing is left behind");
}

#[test]
fn files_that_cannot_be_read_or_written() {
    let folder = folder();
    for arguments in commands("missing.jbt") {
        folder.jbt(&arguments).code(4).says("cannot read missing.jbt");
    }
    fs::create_dir(folder.path("folder.jbt")).unwrap();
    folder.jbt(&["check", "folder.jbt"]).code(4).says("cannot read folder.jbt");
    folder.jbt(&["check", "\x1b[2J.jbt"]).code(4).says("cannot read \\u{1b}[2J.jbt");
    folder
        .jbt(&["mesh", "scene.jbt", "-o", "no/a.glb", "--resolution", "8"])
        .code(4)
        .says("cannot write no/a.glb");
    folder
        .jbt(&["eval", "scene.jbt", "--points", "none.csv", "-o", "a.csv"])
        .code(4)
        .says("cannot read none.csv");
    folder
        .jbt(&["eval", "scene.jbt", "--points", "p.csv", "-o", "no/a.csv"])
        .code(4)
        .says("cannot write no/a.csv");
}

#[cfg(unix)]
#[test]
fn files_keep_their_permissions_and_links_stay_links() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = folder().with("old.csv", "old");
    fs::set_permissions(folder.path("old.csv"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("old.csv", folder.path("link.csv")).unwrap();
    folder.jbt(&["eval", "scene.jbt", "--points", "p.csv", "-o", "link.csv"]).code(0);
    assert!(folder.read("old.csv").starts_with(b"x,y,z,field\n"));
    assert!(fs::symlink_metadata(folder.path("link.csv")).unwrap().is_symlink());
    assert_eq!(fs::metadata(folder.path("old.csv")).unwrap().permissions().mode() & 0o777, 0o640);
    // A device is written and not replaced.
    folder.jbt(&["mesh", "scene.jbt", "-o", "/dev/null", "--format", "stl", "--resolution", "8"]).code(0);
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_jbt"))
        .args(["mesh", "scene.jbt", "-o", "-", "--format", "obj", "--resolution", "64", "--quiet"])
        .current_dir(folder.path("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), b"".as_slice()));
}

#[test]
fn models_without_a_mesh_say_why() {
    let apart = "jbt 1\nintersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }";
    let folder = folder().with("apart.jbt", apart);
    folder.jbt(&["mesh", "apart.jbt", "-o", "a.glb"]).code(1).says("the model is empty");
    folder.jbt(&["check", "apart.jbt"]).code(0);
}

/// A budget of work is counted before anything is spent of it: pieces of a curve, times its uses.
#[test]
fn pieces_times_uses_are_refused_at_once() {
    let succulent = include_str!("../../../examples/succulent.jbt");
    assert!(succulent.contains("(0.12 0.24 0.42 0.015)"));
    let huge = succulent.replace("(0.12 0.24 0.42 0.015)", "(0.12 4294967296 0.42 0.015)");
    let folder = folder().with("huge.jbt", huge);
    for command in
        [vec!["check", "huge.jbt"], vec!["mesh", "huge.jbt", "--resolution", "32", "-o", "out.stl"]]
    {
        let start = std::time::Instant::now();
        folder.jbt(&command).code(3).says("huge.jbt:10:9: limit: unfolded, a point of the model would take");
        assert!(start.elapsed().as_secs() < 20, "{command:?} took {:?}", start.elapsed());
    }
    assert!(!folder.path("out.stl").exists());
}
