//! Signals, closed folders and full disks: an answer and an exit code, and nothing beside the target.
#![cfg(unix)]

use std::fs;
use std::io::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::folder::{Folder, SCENE};

fn names(folder: &Folder) -> Vec<String> {
    let entries = fs::read_dir(folder.path(".")).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// `jbt`, which hears all signals: what runs these tests in the background may have it ignore some.
fn hearing() -> Command {
    let by_default = ["--default-signal=INT,TERM,HUP"];
    let known = Command::new("env").args(by_default).arg("true").stderr(Stdio::null()).status();
    if !known.is_ok_and(|status| status.success()) {
        return Command::new(env!("CARGO_BIN_EXE_jbt"));
    }
    let mut command = Command::new("env");
    command.args(by_default).arg(env!("CARGO_BIN_EXE_jbt"));
    command
}

/// `jbt`, waiting for points that do not come.
fn waiting(folder: &Folder) -> Child {
    let mut child = hearing()
        .args(["eval", "scene.jbt", "--points", "-", "-o", "out.csv"])
        .current_dir(folder.path("."))
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    child.stdin.as_mut().expect("an input").write_all(b"x,y,z\n0,0,0\n").expect("it reads");
    child
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.expect("kill runs").success());
}

/// Sends a signal until the process ends: one that comes before the process has it by default, where what
/// runs these tests ignores it, is lost.
fn end(signal: &str, child: &mut Child) -> ExitStatus {
    /// How long the end of a process that has heard a signal may take, on a loaded machine.
    const PATIENCE: Duration = Duration::from_secs(2);
    loop {
        send(signal, child);
        let sent = Instant::now();
        while sent.elapsed() < PATIENCE {
            if let Some(status) = child.try_wait().expect("it is ours") {
                return status;
            }
            sleep(Duration::from_millis(1));
        }
    }
}

/// What becomes of work that a signal meets at any moment after its first one.
fn stopped(folder: &Folder, signal: &str, first: Duration) -> ExitStatus {
    let mut pause = first;
    loop {
        let mut child = waiting(folder);
        // Without this, waiting for its end would end its input.
        let _input = child.stdin.take();
        sleep(pause);
        let status = end(signal, &mut child);
        // On a loaded machine it may not have begun to listen: later, then.
        if status.signal().is_none() || signal == "-KILL" {
            return status;
        }
        pause = 2 * pause + Duration::from_millis(1);
    }
}

#[test]
fn a_signal_leaves_the_old_file_and_nothing_beside_it() {
    for old in [None, Some("old")] {
        let folder = Folder::new().with("scene.jbt", SCENE);
        let mut expected = vec!["scene.jbt"];
        if let Some(old) = old {
            fs::write(folder.path("out.csv"), old).expect("a file");
            expected.insert(0, "out.csv");
        }
        for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
            for pause in [0, 40] {
                let status = stopped(&folder, signal, Duration::from_millis(pause));
                assert_eq!(status.code(), Some(code), "{signal}");
                assert_eq!(names(&folder), expected, "{signal}");
            }
        }
        stopped(&folder, "-KILL", Duration::from_millis(60));
        assert_eq!(names(&folder), expected);
        if let Some(old) = old {
            assert_eq!(folder.read("out.csv"), old.as_bytes());
        }
    }
}

#[test]
fn long_work_stops_at_its_next_hook() {
    let folder = Folder::new().with("scene.jbt", SCENE);
    let mut pause = Duration::from_millis(30);
    loop {
        let mut child = hearing()
            .args(["mesh", "scene.jbt", "-o", "out.stl", "--resolution", "3000", "--engine", "scalar"])
            .current_dir(folder.path("."))
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        sleep(pause);
        let ended = end("-INT", &mut child);
        assert_eq!(names(&folder), ["scene.jbt"]);
        if ended.signal().is_none() {
            assert_eq!(ended.code(), Some(130));
            return;
        }
        pause *= 2;
    }
}

#[test]
fn what_a_killed_process_has_left_goes_with_the_next_run() {
    let folder = Folder::new().with("scene.jbt", SCENE).with("p.csv", "x,y,z\n0,0,0\n");
    let folder = folder.with("out.csv", "old").with(".jbt-0-out.csv", "half");
    folder.jbt(&["eval", "scene.jbt", "--points", "p.csv", "-o", "out.csv"]).code(0);
    if cfg!(target_os = "linux") {
        assert_eq!(names(&folder), ["out.csv", "p.csv", "scene.jbt"]);
    }
}

#[test]
fn a_file_beyond_the_limit_of_the_shell_is_code_4() {
    let folder = Folder::new().with("scene.jbt", SCENE).with("out.stl", "old");
    let run =
        format!("ulimit -f 8; exec {} mesh scene.jbt -o out.stl --resolution 64", env!("CARGO_BIN_EXE_jbt"));
    let output =
        Command::new("sh").args(["-c", &run]).current_dir(folder.path(".")).output().expect("a shell");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{told}");
    assert!(told.contains("cannot write out.stl: File too large"), "{told}");
    assert_eq!(folder.read("out.stl"), b"old");
    assert_eq!(names(&folder), ["out.stl", "scene.jbt"]);
}

#[test]
fn a_folder_that_takes_no_new_file_is_named() {
    let folder = Folder::new().with("scene.jbt", SCENE).with("p.csv", "x,y,z\n0,0,0\n");
    // Root may create files in any folder, but not where the kernel makes them.
    for (path, at) in [("/proc/self/comm", "/proc/"), ("/sys/kernel/a.csv", "/sys/kernel")] {
        if !fs::metadata(at).is_ok_and(|found| found.is_dir()) {
            continue;
        }
        let eval = ["eval", "scene.jbt", "--points", "p.csv", "--format", "csv", "-o", path];
        folder.jbt(&eval).code(4).says(&format!("cannot write {path}: "));
    }
    if fs::metadata("/sys/kernel").is_ok_and(|found| found.is_dir()) {
        let eval = ["eval", "scene.jbt", "--points", "p.csv", "-o", "/sys/kernel/a.csv"];
        folder.jbt(&eval).code(4).says("and /sys/kernel takes no new file");
    }
}

#[test]
fn help_that_cannot_be_written_is_code_4() {
    let Ok(full) = fs::File::options().write(true).open("/dev/full") else { return };
    for word in ["--help", "--version"] {
        let target = full.try_clone().expect("another handle");
        let run = Command::new(env!("CARGO_BIN_EXE_jbt")).arg(word).stdout(target).status();
        assert_eq!(run.expect("the binary runs").code(), Some(4), "{word}");
    }
}

#[test]
fn threads_beyond_all_sense_are_fewer_threads() {
    let folder = Folder::new().with("scene.jbt", SCENE);
    let mesh = ["mesh", "scene.jbt", "-o", "a.stl", "--resolution", "8"];
    folder
        .jbt(&[&mesh[..], &["--threads", "65535"]].concat())
        .code(0)
        .says("--threads asks for 65535 threads");
    let told = Command::new(env!("CARGO_BIN_EXE_jbt"))
        .args(mesh)
        .env("RAYON_NUM_THREADS", "99999999")
        .current_dir(folder.path("."))
        .output()
        .expect("the binary runs");
    let words = String::from_utf8_lossy(&told.stderr);
    assert_eq!(told.status.code(), Some(0), "{words}");
    assert!(words.contains("RAYON_NUM_THREADS asks for 99999999 threads; 256 do the work"), "{words}");
}
