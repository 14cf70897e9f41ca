//! Closed folders, memory that never becomes executable, and pages that are never writable and executable.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::process::Stdio;

use crate::work::{JBT, Room, code, example, examples, told, wanted};

/// Runs a program whose memory the system never makes executable once it was not, nor writable and
/// executable.
const DENY: &str = "import ctypes, os, sys
if ctypes.CDLL(None, use_errno=True).prctl(65, 1, 0, 0, 0): sys.exit(77)
os.execv(sys.argv[1], sys.argv[1:])";

#[test]
fn a_folder_that_takes_no_files_keeps_what_it_has() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    // Nobody may run what is in a home of root, so the binary comes along.
    let open = |path: &std::path::Path, mode| {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("they are ours");
    };
    open(&room.path("."), 0o755);
    fs::copy(JBT, room.path("jbt")).expect("a copy");
    open(&room.path("jbt"), 0o755);
    fs::copy(example("peanut"), room.path("scene.jbt")).expect("a copy");
    open(&room.path("scene.jbt"), 0o644);
    fs::create_dir(room.path("closed")).expect("a folder");
    for (name, mode) in [("kept.stl", 0o444), ("open.stl", 0o666)] {
        fs::write(room.path("closed").join(name), "old").expect("a file");
        open(&room.path("closed").join(name), mode);
    }
    open(&room.path("closed"), 0o555);
    let nobody = "setpriv --reuid 65534 --regid 65534 --clear-groups --no-new-privs";
    if code(&room.shell(&format!("{nobody} ./jbt check scene.jbt"))) != 0 {
        jbt_testkit::skip::skip("setpriv does not make this process nobody's, so folders are never closed");
        return;
    }
    let run = |target: &str| room.shell(&format!("{nobody} ./jbt mesh scene.jbt -o {target} --resolution 8"));
    for target in ["closed/new.stl", "closed/kept.stl"] {
        let output = run(target);
        assert_eq!(code(&output), 4, "{target}: {}", told(&output));
        assert!(told(&output).contains("cannot write"), "{}", told(&output));
    }
    // It may be written in place, after a warning, or refused.
    let output = run("closed/open.stl");
    let found = fs::read(room.path("closed/open.stl")).expect("a file");
    match code(&output) {
        0 => assert!(found.len() > 84 && told(&output).contains("warning"), "{}", told(&output)),
        4 => assert_eq!(found, b"old"),
        other => panic!("code {other}: {}", told(&output)),
    }
    assert_eq!(fs::read(room.path("closed/kept.stl")).expect("a file"), b"old");
    let names: BTreeSet<_> = fs::read_dir(room.path("closed"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    assert_eq!(names.into_iter().collect::<Vec<_>>(), ["kept.stl", "open.stl"]);
    open(&room.path("closed"), 0o755);
}

#[test]
fn without_executable_memory_the_bytes_are_the_same() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let mut count = 0;
    for (name, path) in examples() {
        let scene = path.to_string_lossy();
        let arguments = |file: &str| {
            [
                "mesh",
                &scene,
                "-o",
                file,
                "--resolution",
                "20",
                "--quiet",
                "--force",
                "--region",
                "-2,-2,-2,2,2,2",
            ]
            .map(str::to_owned)
        };
        let plain = room.command(JBT).args(arguments("a.stl")).output().expect("it runs");
        let denied = room.command("python3").args(["-c", DENY, JBT]).args(arguments("b.stl")).output();
        let denied = denied.expect("python3 runs");
        if code(&denied) == 77 {
            jbt_testkit::skip::skip("this kernel knows no PR_SET_MDWE");
            return;
        }
        assert_eq!(code(&denied), code(&plain), "{name}: {}", told(&denied));
        let [a, b] = ["a.stl", "b.stl"].map(|file| fs::read(room.path(file)).ok());
        assert!(a == b, "{name} has another mesh without executable memory");
        count += 1;
    }
    println!("{count} scenes, the same bytes without executable memory");
}

#[test]
fn no_page_is_writable_and_executable_at_any_time() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let (mut looks, mut with_code) = (0, 0);
    for (_, path) in examples().into_iter().step_by(4) {
        let scene = path.to_string_lossy();
        let mut child = room
            .command(JBT)
            .args(["render", &scene, "-o", "a.png", "--size", "96x96", "--quiet", "--force"])
            .stderr(Stdio::null())
            .spawn()
            .expect("it runs");
        let maps = format!("/proc/{}/maps", child.id());
        while child.try_wait().expect("it is ours").is_none() {
            let Ok(text) = fs::read_to_string(&maps) else { continue };
            let rights = text.lines().filter_map(|line| line.split(' ').nth(1));
            let both = rights.filter(|rights| rights.contains('w') && rights.contains('x')).count();
            assert_eq!(both, 0, "{text}");
            looks += 1;
            let is_code = |line: &str| line.contains("r-xp 00000000 00:00 0") && !line.contains('[');
            with_code += usize::from(text.lines().any(is_code));
        }
    }
    println!("{looks} looks at all pages, {with_code} of them with machine code");
    assert!(looks > 100 && with_code > 10, "{looks} looks, {with_code} with machine code");
}
