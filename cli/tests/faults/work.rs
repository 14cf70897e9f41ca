//! What all of these tests share: a folder with scenes, runs of a shell in it, what is left afterwards.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// The binary.
pub const JBT: &str = env!("CARGO_BIN_EXE_jbt");

/// What a command that was cut off may leave beside its target, until the next run.
pub const TEMPORARY: &str = ".jbt-";

/// Whether these tests are wanted. Says so where not.
pub fn wanted() -> bool {
    let wanted = jbt_testkit::skip::at_length();
    if !wanted {
        jbt_testkit::skip::skip("JBT_FAULTS=1 runs tests of faults, some minutes");
    }
    wanted
}

/// The examples of the project, by name without its ending.
pub fn examples() -> Vec<(String, PathBuf)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let entries = fs::read_dir(folder).expect("there are examples");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "jbt"));
    paths.sort();
    let named = paths.into_iter().map(|path| {
        let path = path.canonicalize().expect("it is there");
        (path.file_stem().expect("a name").to_string_lossy().into_owned(), path)
    });
    named.collect()
}

/// The path of an example.
pub fn example(name: &str) -> String {
    let found = examples().into_iter().find(|(own, _)| own == name);
    found.unwrap_or_else(|| panic!("there is no example {name}")).1.to_string_lossy().into_owned()
}

/// A folder to work in.
pub struct Room(TempDir);

impl Room {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The names of its files.
    pub fn names(&self) -> BTreeSet<String> {
        let entries = fs::read_dir(self.0.path()).expect("a folder");
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    }

    /// A command that runs here, and hears what nobody says.
    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.0.path()).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs a line of the shell here; `$JBT` is the binary.
    pub fn shell(&self, line: &str) -> Output {
        self.command("sh").args(["-c", line]).env("JBT", JBT).output().expect("a shell")
    }
}

/// The exit code of an output, or what killed the process.
pub fn code(output: &Output) -> i32 {
    use std::os::unix::process::ExitStatusExt as _;
    output.status.code().unwrap_or_else(|| -output.status.signal().unwrap_or(0))
}

/// What an output says to people.
pub fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
