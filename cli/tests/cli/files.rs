//! Files that scenes include: what is read, and what is refused at once, without a word of it.

use std::fs;
use std::time::{Duration, Instant};

use crate::folder::{Folder, Ran};

fn folder(name: &str) -> Folder {
    let text = format!("jbt 1\nunion {{\n  include \"{name}\"\n  point {{ radius 1 }}\n}}\n");
    Folder::new().with("scene.jbt", text)
}

/// Refused with a place, in no time.
#[track_caller]
fn refused(folder: &Folder, code: i32, words: &str) -> Ran {
    let start = Instant::now();
    let ran = folder.jbt(&["check", "scene.jbt"]).code(code).says("scene.jbt:3:11: ").says(words);
    // The process starts, and other tests run beside it.
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
    ran
}

#[test]
fn parts_of_the_folder_are_read() {
    let folder = folder("parts/pair.jbt");
    fs::create_dir(folder.path("parts")).unwrap();
    let folder = folder
        .with("parts/pair.jbt", "jbt 1\ninclude \"ball.jbt\"\nunion { ball(1) ball(2) }")
        .with("parts/ball.jbt", "jbt 1\ndef ball(x) { point { at (x 0 0) radius 1 } }");
    let ran = folder.jbt(&["check", "scene.jbt", "--json"]).code(0);
    assert_eq!(ran.json()["files"][0]["model"]["leaves"], 3);
    // From another folder the parts are still beside the scene.
    fs::create_dir(folder.path("elsewhere")).unwrap();
    folder.jbt(&["check", "elsewhere/../scene.jbt"]).code(0);
}

#[test]
fn what_is_outside_is_refused() {
    for name in ["/etc/passwd", "../../../../../../etc/passwd", "/dev/zero", "/proc/self/environ"] {
        let ran = refused(&folder(name), 1, "it is outside of the scene's folder");
        assert!(!ran.stderr().contains("root:"), "{}", ran.stderr());
    }
    refused(&folder("none.jbt"), 1, "there is no such file");
    refused(&folder("."), 1, "it is no regular file");
    refused(&folder(""), 1, "there is no such file");
    let scene = b"jbt 1 union { include \"a.jbt\" point { radius 1 } }";
    folder("x").jbt_with_input(&["check", "-"], scene).code(1).says("the standard input has no folder");
}

#[cfg(unix)]
#[test]
fn links_pipes_and_devices_are_refused() {
    use std::os::unix::fs::symlink;
    let outside = Folder::new().with("secret", "jbt 1 point { radius 1 } # secret");
    let scene = folder("link");
    symlink(outside.path("secret"), scene.path("link")).unwrap();
    let ran = refused(&scene, 1, "it is outside of the scene's folder");
    assert!(!ran.stderr().contains("secret"), "{}", ran.stderr());
    let scene = folder("link");
    symlink("/dev/zero", scene.path("link")).unwrap();
    refused(&scene, 1, "it is outside of the scene's folder");
    let scene = folder("pipe");
    let made = std::process::Command::new("mkfifo").arg(scene.path("pipe")).status().expect("mkfifo runs");
    assert!(made.success());
    refused(&scene, 1, "it is no regular file");
    // A link within the folder leads to what it leads to.
    let scene = folder("link").with("real.jbt", "jbt 1 point { radius 2 }");
    symlink("real.jbt", scene.path("link")).unwrap();
    scene.jbt(&["check", "scene.jbt"]).code(0);
}

#[test]
fn what_is_no_scene_is_not_quoted() {
    let folder = folder("notes").with("notes", "my secret notes\njbt 1\n");
    let ran = refused(&folder, 1, "`notes` is no scene");
    assert!(!ran.stderr().contains("secret"), "{}", ran.stderr());
    let ran = folder.jbt(&["check", "scene.jbt", "--json"]).code(1);
    assert!(!ran.stdout().contains("secret"), "{}", ran.stdout());
}

#[test]
fn large_files_and_circles_are_refused() {
    let scene = folder("huge.jbt");
    fs::File::create(scene.path("huge.jbt")).and_then(|file| file.set_len(1 << 40)).unwrap();
    refused(&scene, 3, "it has more than the");
    let scene = folder("scene.jbt");
    let ran = scene.jbt(&["check", "scene.jbt"]).code(1).says("`scene.jbt` includes itself");
    assert!(ran.stderr().contains("in `scene.jbt`, which is used at scene.jbt:3:3"), "{}", ran.stderr());
    let scene =
        folder("a.jbt").with("a.jbt", "jbt 1 include \"b.jbt\"").with("b.jbt", "jbt 1 include \"./a.jbt\"");
    scene.jbt(&["check", "scene.jbt"]).code(1).says("the circle is a.jbt, b.jbt, ./a.jbt");
}

#[test]
fn errors_of_other_files_have_their_places() {
    let folder = folder("part.jbt").with("part.jbt", "jbt 1\n\npoint { radius 0 }\n");
    let ran = folder.jbt(&["check", "scene.jbt"]).code(1).says("part.jbt:3:1: error: the radius is 0");
    assert!(ran.stderr().contains("in `part.jbt`, which is used at scene.jbt:3:3"), "{}", ran.stderr());
    let json = folder.jbt(&["check", "scene.jbt", "--json"]).code(1).json();
    let told = &json["diagnostics"][0];
    assert_eq!((told["file"].as_str(), told["line"].as_u64()), (Some("part.jbt"), Some(3)));
    assert_eq!(told["notes"][0], "in `part.jbt`, which is used at scene.jbt:3:3");
}

#[test]
fn programs_that_are_too_long_are_limits() {
    let scene = |body: &str| Folder::new().with("scene.jbt", format!("jbt 1\nunion {{\n  {body}\n}}"));
    let ran = scene("for i in 0 .. 1e9 { point { radius 1 } }").jbt(&["check", "scene.jbt"]).code(3);
    ran.says("scene.jbt:3:3: limit: 1000000000 turns of this loop");
    let ran = scene("for i in 0 .. n { point { radius 1 } }");
    let ran = ran
        .with("scene.jbt", "jbt 1\nparam n = 3\nunion { for i in 0 .. n { point { at (i 0 0) radius 1 } } }");
    let json = ran.jbt(&["check", "scene.jbt", "--json", "-D", "n=5"]).code(0).json();
    assert_eq!(json["files"][0]["model"]["leaves"], 5);
    assert_eq!(json["files"][0]["model"]["controls"]["n"]["fixed"], true);
}
