//! Where results go: endings of names, names that nobody gave, files that are there, folders that are not.

use std::fs;

use crate::folder::{Folder, SCENE};

/// The commands that write a file, with the ending of the file that they write where nothing says which, and
/// what makes them quick.
const WRITERS: [(&str, &str, &[&str]); 5] = [
    ("mesh", "glb", &["--resolution", "8"]),
    ("render", "png", &["--size", "8", "--quality", "draft"]),
    ("contour", "svg", &["--resolution", "8"]),
    ("sample", "npy", &["--resolution", "8"]),
    ("eval", "csv", &["--points", "p.csv"]),
];

fn folder() -> Folder {
    let folder = Folder::new().with("scene.jbt", SCENE).with("p.csv", "x,y,z\n0,0,0\n");
    fs::create_dir(folder.path("scenes")).unwrap();
    folder.with("scenes/blob.jbt", SCENE)
}

#[test]
fn an_unknown_ending_is_a_usage_error_that_lists_the_known_ones() {
    let folder = folder();
    for (command, ending, quick) in WRITERS {
        let known = match command {
            "mesh" => ".glb, .ply, .obj, .stl, .3mf or .usda",
            "sample" => ".npy or .vdb",
            "contour" => ".svg or .png",
            _ => &format!(".{ending}"),
        };
        for name in ["x.jpg", "x.txt", "x", ending, "x.png.gz", "x\u{1b}[2J.jpg"] {
            let ran = folder.jbt(&[&[command, "scene.jbt", "-o", name], quick].concat()).code(2);
            ran.says(&format!("does not end with {known}; --format says what to write"));
            assert!(!folder.path(name).exists());
        }
        folder.jbt(&[&[command, "scene.jbt", "-o", "x.jpg", "--format", "jpg"], quick].concat()).code(2);
        let help = folder.jbt(&[command, "--help"]).code(0).stdout();
        assert!(help.contains(&format!("The {known} file to write")), "{help}");
        assert!(help.contains(&format!("the scene's name with .{ending}")), "{help}");
        // A name that says nothing is fine where an option says it, and so are capitals.
        let upper = format!("y.{}", ending.to_uppercase());
        folder.jbt(&[&[command, "scene.jbt", "-o", &upper], quick].concat()).code(0);
        folder.jbt(&[&[command, "scene.jbt", "-o", "z.jpg", "--format", ending], quick].concat()).code(0);
        assert_eq!(folder.read(&upper), folder.read("z.jpg"), "{command}");
    }
}

#[test]
fn the_standard_output_is_still_an_output() {
    let folder = folder();
    for (command, ending, quick) in WRITERS {
        let several = ["mesh", "contour", "sample"].contains(&command);
        let format: &[&str] = if several { &["--format", ending] } else { &[] };
        let arguments = [&[command, "scene.jbt", "-o", "-"], quick, format].concat();
        let piped = folder.jbt(&arguments).code(0).stdout_bytes().to_vec();
        let name = format!("a.{ending}");
        folder.jbt(&[&[command, "scene.jbt", "-o", &name], quick].concat()).code(0);
        assert_eq!(piped, folder.read(&name), "{command}");
        if several {
            let ran = folder.jbt(&[&[command, "scene.jbt", "-o", "-"], quick].concat()).code(2);
            ran.says(" on the standard output needs --format ");
        }
    }
}

#[test]
fn without_a_name_the_scene_gives_it() {
    let folder = folder();
    for (command, ending, quick) in WRITERS {
        let name = format!("blob.{ending}");
        let plain = [&[command, "scenes/blob.jbt"], quick].concat();
        let ran = folder.jbt(&plain).code(0);
        assert!(command == "eval" || ran.stdout().starts_with(&format!("{name}: ")), "{}", ran.stdout());
        let made = folder.read(&name);
        // What is there stays, but for those who say otherwise.
        fs::write(folder.path(&name), "old").unwrap();
        let refused = folder.jbt(&plain).code(2);
        refused.says(&format!("{name} is there already; -o {name} or --force replaces it"));
        assert_eq!(folder.read(&name), b"old");
        folder.jbt(&[&plain[..], &["--force"]].concat()).code(0);
        assert_eq!(folder.read(&name), made, "{command}");
        fs::write(folder.path(&name), "old").unwrap();
        folder.jbt(&[&plain[..], &["-o", &name]].concat()).code(0);
        assert_eq!(folder.read(&name), made, "{command}");
        let piped = [&[command, "-"], quick].concat();
        folder.jbt_with_input(&piped, SCENE.as_bytes()).code(2).says("without a name needs -o");
    }
    folder.jbt(&["mesh", "scenes/blob.jbt", "--format", "obj", "--resolution", "8"]).code(0);
    assert!(folder.path("blob.obj").exists());
}

/// A scene that takes hours would be refused at once: this one has an error, which is found later.
#[test]
fn a_place_that_cannot_be_written_to_is_refused_before_the_work() {
    let folder = folder().with("bad.jbt", "jbt 1\npoint { radius 0 }").with("file", "");
    fs::create_dir(folder.path("folder.glb")).unwrap();
    for (command, ending, quick) in WRITERS {
        let refused = |name: &str, words: &str| {
            let ran = folder.jbt(&[&[command, "bad.jbt", "-o", name], quick].concat()).code(4);
            let told = ran.says(&format!("jbt: error: cannot write {name}: ")).says(words).stderr();
            assert!(!told.contains(".jbt-") && told.lines().count() == 1, "{told}");
        };
        refused(&format!("no/such/a.{ending}"), "there is no folder no/such");
        refused(&format!("file/a.{ending}"), "ot a directory");
        refused(&format!("{}.{ending}", "n".repeat(300)), "too long");
    }
    folder
        .jbt(&["mesh", "bad.jbt", "-o", "folder.glb"])
        .code(4)
        .says("cannot write folder.glb: is a directory");
    let count = fs::read_dir(folder.path(".")).unwrap().count();
    assert_eq!(count, 6, "nothing is left behind");
}

#[test]
fn no_result_takes_the_place_of_its_scene() {
    let folder = folder();
    for (command, ending, quick) in WRITERS {
        for name in ["scene.jbt", "./scene.jbt"] {
            let arguments = [&[command, "scene.jbt", "--format", ending, "-o", name], quick].concat();
            folder.jbt(&arguments).code(2).says(&format!("{name} is the scene itself, and "));
        }
        folder.jbt(&[&[command, "scenes"], quick].concat()).code(4).says("cannot read scenes: ");
        folder.jbt(&[&[command, "."], quick].concat()).code(4).says("cannot read .: ");
    }
    assert_eq!(folder.read("scene.jbt"), SCENE.as_bytes());
}

#[cfg(unix)]
#[test]
fn messages_name_the_path_of_the_command_line() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder().with("kept.csv", "old");
    fs::set_permissions(folder.path("kept.csv"), fs::Permissions::from_mode(0o444)).unwrap();
    let eval = |out: &str| folder.jbt(&["eval", "scene.jbt", "--points", "p.csv", "-o", out]);
    eval("kept.csv").code(4).says("cannot write kept.csv: the file is read-only");
    assert_eq!(folder.read("kept.csv"), b"old");
    fs::create_dir(folder.path("closed")).unwrap();
    fs::set_permissions(folder.path("closed"), fs::Permissions::from_mode(0o555)).unwrap();
    // Root may write anywhere.
    if fs::write(folder.path("closed/probe"), "").is_err() {
        let told = eval("closed/a.csv").code(4).says("cannot write closed/a.csv: Permission denied").stderr();
        assert!(!told.contains(".jbt-"), "{told}");
    }
    let full = ["eval", "scene.jbt", "--points", "p.csv", "--format", "csv", "-o", "/dev/full"];
    folder.jbt(&full).code(4).says("cannot write /dev/full: No space left on device");
    // The kernel lets nobody make files here, root neither.
    let told = eval("/proc/a.csv").code(4).says("cannot write /proc/a.csv: ").stderr();
    assert!(!told.contains(".jbt-"), "{told}");
}

#[test]
fn numbers_of_regions_that_are_none_are_named() {
    let folder = folder();
    for command in ["mesh", "sample", "render", "count", "stats"] {
        let region = |region: &str| {
            let out: &[&str] = match command {
                "mesh" => &["-o", "a.glb"],
                "sample" => &["-o", "a.npy"],
                "render" => &["-o", "a.png"],
                _ => &[],
            };
            folder.jbt(&[&[command, "scene.jbt", "--region", region], out].concat()).code(2)
        };
        region("0,0,nan,1,1,1").says("Z0 is `nan`, and a region has finite corners");
        region("0,-inf,0,1,1,1").says("Y0 is `-inf`, and a region has finite corners");
        region("0,0,0,1e400,1,1").says("X1 is `1e400`, and a region has finite corners");
        region("0,0,0,1,-1,1").says("Y1 must be greater than Y0, and the region goes from 0 to -1");
        region("0,0,0,1,x,1").says("Y1 is `x`, and that is no number");
    }
    let contour =
        |region: &str| folder.jbt(&["contour", "scene.jbt", "-o", "a.svg", "--region", region]).code(2);
    contour("0,nan,1,1").says("V0 is `nan`, and a region has finite corners");
    contour("0,0,inf,1").says("U1 is `inf`, and a region has finite corners");
    contour("0,2,1,1").says("V1 must be greater than V0, and the region goes from 2 to 1");
}

/// A file that may be written to in a folder that takes no new file: its contents are replaced all the same.
#[cfg(unix)]
#[test]
fn in_a_closed_folder_a_file_is_written_in_place() {
    use std::os::unix::fs::PermissionsExt as _;
    use std::os::unix::process::CommandExt as _;
    use std::process::Command;

    let folder = folder();
    fs::create_dir(folder.path("closed")).unwrap();
    let (jbt, file) = (folder.path("jbt"), folder.path("closed/mesh.stl"));
    fs::copy(env!("CARGO_BIN_EXE_jbt"), &jbt).unwrap();
    fs::write(&file, vec![b'x'; 1 << 20]).unwrap();
    let rights = |name: &str, mode| fs::set_permissions(folder.path(name), fs::Permissions::from_mode(mode));
    rights(".", 0o755).unwrap();
    rights("closed/mesh.stl", 0o666).unwrap();
    rights("closed", 0o555).unwrap();
    let mesh = |output: &str| {
        let mut command = Command::new(&jbt);
        command.args(["mesh", "scene.jbt", "--resolution", "8", "-o", output]).current_dir(folder.path("."));
        // To the superuser all folders are open.
        if fs::metadata("/proc/self").is_ok_and(|own| std::os::unix::fs::MetadataExt::uid(&own) == 0) {
            command.uid(65534).gid(65534);
        }
        command.output().expect("it runs")
    };
    let made = mesh("closed/mesh.stl");
    let told = String::from_utf8_lossy(&made.stderr);
    assert!(made.status.success(), "{told}");
    assert!(told.contains("takes no new file: closed/mesh.stl is written in place"), "{told}");
    let triangles = u32::from_le_bytes(fs::read(&file).unwrap()[80..84].try_into().unwrap()) as usize;
    assert_eq!(fs::metadata(&file).unwrap().len() as usize, 84 + 50 * triangles);
    let refused = mesh("closed/other.stl");
    assert_eq!(refused.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("closed takes no new file"));
    rights("closed", 0o755).unwrap();
}
