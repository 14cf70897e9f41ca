//! Sequences: `jbt mesh frame_{}.vtk -o frame_{}.glb` meshes every file whose name has a number in place of
//! the braces.
//!
//! Each frame is a process of its own, with the same options and the number in every `{}`. So a frame takes
//! the memory of a frame, a bad one stops no other, and a result is there whole or not at all. Frames whose
//! results are newer than they are have been done, and are passed over: a sequence that was stopped goes on.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::Builder;

use jbt::diagnostic::escape;

use crate::arguments::MeshArguments;
use crate::failure::Failure;
use crate::output::{plural, warn};
use crate::threads::clipped;

/// What stands for the number of a frame, or the name of a part.
pub const BRACES: &str = "{}";

/// A file of a sequence.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
struct SequenceFrame {
    number: u64,
    /// The number as it is written, with its zeros.
    digits: String,
}

/// Whether the scene is a sequence.
pub fn is_sequence(scene: &Path) -> bool {
    scene.file_name().and_then(OsStr::to_str).is_some_and(|name| name.contains(BRACES))
}

/// Meshes all frames.
pub fn run(arguments: &MeshArguments, quiet: bool) -> Result<(), Failure> {
    let scene = &arguments.scene.path;
    if arguments.parts {
        let message =
            format!("--parts puts the name of a part where {BRACES} is, and a sequence has its number there");
        return Err(Failure::Usage(message));
    }
    let out = arguments.output.output.as_deref().filter(|out| out.to_string_lossy().contains(BRACES));
    let Some(out) = out else {
        let name = scene.display();
        return Err(Failure::Usage(format!("{name} is a sequence: its results need {BRACES} in -o, too")));
    };
    let frames = frames(scene)?;
    let (done, left): (Vec<&SequenceFrame>, Vec<&SequenceFrame>) =
        frames.iter().partition(|frame| !arguments.output.force && is_done(scene, out, frame));
    if !done.is_empty() && !quiet {
        let count = plural(done.len() as u64, "frame is", "frames are");
        warn(&format!("{count} newer than the scene, and passed over; --force makes all of them"));
    }
    let program = std::env::current_exe().map_err(|error| Failure::io("find", "this program", error))?;
    let (next, told) = (AtomicUsize::new(0), Mutex::new(FramesTold::default()));
    let work = || {
        while let Some(frame) = left.get(next.fetch_add(1, Ordering::Relaxed)) {
            let result = command(&program, frame).output();
            if let Ok(mut told) = told.lock() {
                told.tell(&numbered(scene, frame), result);
            }
        }
    };
    let jobs = clipped(arguments.jobs.into(), "--jobs", "processes").min(left.len());
    std::thread::scope(|scope| {
        // Where a thread cannot be had, those that are there do its work, and so does this one.
        (1..jobs).take_while(|_| Builder::new().spawn_scoped(scope, work).is_ok()).for_each(drop);
        work();
    });
    let told = told.into_inner().unwrap_or_default();
    match told.code {
        Some(code) => Err(Failure::Told { code }),
        None => Ok(()),
    }
}

/// What frames have told so far.
#[derive(Default)]
struct FramesTold {
    /// The exit code of the first one that failed.
    code: Option<u8>,
}

impl FramesTold {
    fn tell(&mut self, frame: &Path, result: io::Result<Output>) {
        let code = match result {
            Ok(Output { status, stdout, stderr }) => {
                // A reader that has gone away hears nothing.
                let _ = io::stdout().write_all(&stdout);
                let _ = io::stderr().write_all(&stderr);
                if status.success() {
                    return;
                }
                status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(4)
            }
            Err(error) => {
                warn(&format!("{}: {error}", escape(&frame.display().to_string())));
                4
            }
        };
        self.code.get_or_insert(code);
    }
}

/// The command line of this process, for one frame.
fn command(program: &Path, frame: &SequenceFrame) -> Command {
    let mut command = Command::new(program);
    let mut arguments = std::env::args_os().skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--jobs" {
            arguments.next();
        } else if !argument.to_string_lossy().starts_with("--jobs=") {
            command.arg(with_number(&argument, frame));
        }
    }
    command
}

/// A text with the number of a frame in place of braces.
fn with_number(text: &OsStr, frame: &SequenceFrame) -> OsString {
    match text.to_str() {
        Some(text) => text.replace(BRACES, &frame.digits).into(),
        None => text.to_owned(),
    }
}

fn numbered(path: &Path, frame: &SequenceFrame) -> PathBuf {
    with_number(path.as_os_str(), frame).into()
}

/// The files of a sequence, by their numbers.
fn frames(scene: &Path) -> Result<Vec<SequenceFrame>, Failure> {
    let name = scene.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let (before, after) = name.split_once(BRACES).unwrap_or((name, ""));
    if after.contains(BRACES) {
        let name = scene.display();
        return Err(Failure::Usage(format!("{name} has more than one place for the number of a frame")));
    }
    let folder = scene.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let failed = |error| Failure::io("read", folder.display(), error);
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name();
        let digits = name.to_str().and_then(|name| name.strip_prefix(before)?.strip_suffix(after));
        let Some(digits) = digits.filter(|digits| digits.bytes().all(|byte| byte.is_ascii_digit())) else {
            continue;
        };
        if let Ok(number) = digits.parse() {
            frames.push(SequenceFrame { number, digits: digits.to_owned() });
        }
    }
    frames.sort();
    if frames.is_empty() {
        let name = scene.display();
        return Err(Failure::io("find", format!("any file like {name}"), io::ErrorKind::NotFound.into()));
    }
    Ok(frames)
}

/// Whether the result of a frame is there, and newer than its scene.
fn is_done(scene: &Path, out: &Path, frame: &SequenceFrame) -> bool {
    let changed = |path: &Path| fs::metadata(numbered(path, frame)).and_then(|file| file.modified());
    matches!((changed(scene), changed(out)), (Ok(scene), Ok(out)) if out >= scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_in_the_order_of_their_numbers() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a_10.csv", "a_9.csv", "a_002.csv", "a_x.csv", "a_.csv", "b_1.csv", "a_1.csv.bak"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let found = frames(&folder.path().join("a_{}.csv")).unwrap();
        let digits: Vec<&str> = found.iter().map(|frame| frame.digits.as_str()).collect();
        assert_eq!(digits, ["002", "9", "10"]);
        assert_eq!(numbered(Path::new("out/{}-{}.glb"), &found[0]), Path::new("out/002-002.glb"));
        assert!(frames(&folder.path().join("c_{}.csv")).is_err());
        assert!(frames(&folder.path().join("{}_{}.csv")).is_err());
        assert!(is_sequence(Path::new("x/a_{}.csv")) && !is_sequence(Path::new("{}/a.csv")));
    }
}
