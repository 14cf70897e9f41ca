//! Running the binary on files of a temporary folder.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A scene with blending, attributes, a warp and a shared subtree.
pub const SCENE: &str = "jbt 1
param bulge = 0.6
attribute rough 1 default 0.5 dominant
let arm = segment { from (0 0 0) to (1 0 0) radius bulge }
blend ricci 3 {
    color (1 0.3 0.1) { use arm }
    rotate axis z degrees 90 { color (0.1 0.4 1) { rough 0.25 { use arm } } }
    twist axis z rate 0.5 { translate (0 0 0.5) { point { radius 0.7 } } }
}
";

/// A ParsIP scene of two points.
pub const BLOB: &str = "
[BLOBNODE 0]
IsOperator=1
OperatorType=BLEND
ChildrenCount=2
ChildrenIDs=(1, 2)
[BLOBNODE 1]
IsOperator=0
PrimitiveType=POINT
position=(0.0, 0.0, 0.0)
direction=(0.0, 1.0, 0.0)
MtrlDiffused=(1.0, 0.0, 0.0, 1.0)
[BLOBNODE 2]
IsOperator=0
PrimitiveType=POINT
position=(0.5, 0.0, 0.0)
direction=(0.0, 1.0, 0.0)
MtrlDiffused=(0.0, 0.0, 1.0, 1.0)
[Global]
RootIDs=(0)
NumLayers=1
";

/// A folder that is removed with this value.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn with(self, name: &str, contents: impl AsRef<[u8]>) -> Self {
        std::fs::write(self.path(name), contents).expect("a file can be written");
        self
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("the file is there")
    }

    /// Runs `jbt` here.
    pub fn jbt(&self, arguments: &[&str]) -> Ran {
        self.jbt_with_input(arguments, b"")
    }

    /// Runs `jbt` here, with something to read on its standard input.
    pub fn jbt_with_input(&self, arguments: &[&str], input: &[u8]) -> Ran {
        let mut child = Command::new(env!("CARGO_BIN_EXE_jbt"))
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        let mut stdin = child.stdin.take().expect("it has an input");
        let input = input.to_vec();
        // A program that does not want all of its input closes it, which is no error here.
        let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
        let output = child.wait_with_output().expect("the binary ends");
        writer.join().expect("the input was written");
        Ran { arguments: arguments.join(" "), output }
    }
}

/// What a run gave.
pub struct Ran {
    arguments: String,
    output: Output,
}

impl Ran {
    /// Requires an exit code.
    #[track_caller]
    pub fn code(self, expected: i32) -> Self {
        let found = self.output.status.code();
        assert_eq!(found, Some(expected), "jbt {}\n{}", self.arguments, self.stderr());
        self
    }

    pub fn stdout(&self) -> String {
        String::from_utf8_lossy(&self.output.stdout).into_owned()
    }

    pub fn stdout_bytes(&self) -> &[u8] {
        &self.output.stdout
    }

    pub fn stderr(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }

    /// Requires words among the messages, and no character that a terminal would obey.
    #[track_caller]
    pub fn says(self, words: &str) -> Self {
        let stderr = self.stderr();
        assert!(stderr.contains(words), "jbt {}: expected {words:?} in:\n{stderr}", self.arguments);
        self.harmless()
    }

    /// Requires that no output has a character that a terminal would obey.
    #[track_caller]
    pub fn harmless(self) -> Self {
        let bad = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!self.stderr().contains(bad), "jbt {}: {:?}", self.arguments, self.stderr());
        assert!(!self.stdout().contains(bad), "jbt {}: {:?}", self.arguments, self.stdout());
        self
    }

    /// The JSON object on the standard output.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.output.stdout).expect("one JSON object")
    }
}
