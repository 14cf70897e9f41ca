//! Where results go: files that are replaced as a whole, the standard output, and what people read on a
//! terminal.

use std::io::{self, BufWriter, IsTerminal as _, Stdout, Write};
use std::path::{Path, PathBuf};

use clap::builder::styling::{AnsiColor, Style};
use jbt::diagnostic::{Severity, escape};
use jbt::export::{AtomicFile, WrittenFile};

use crate::failure::Failure;
use crate::signals;
use crate::standard::is_standard;

/// Where a result goes, once that is decided.
#[derive(Debug)]
pub struct Destination<K> {
    /// The path; `-` is the standard output.
    pub path: PathBuf,
    /// What is written there.
    pub kind: K,
    /// Whether it may take the place of a file.
    pub replace: bool,
}

/// A place for results. A file keeps its old contents until [`Output::finish`].
pub struct Output {
    writer: BufWriter<OutputTarget>,
    name: String,
}

enum OutputTarget {
    Standard(Stdout),
    File(AtomicFile),
}

impl Write for OutputTarget {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Standard(stdout) => stdout.write(bytes),
            Self::File(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Standard(stdout) => stdout.flush(),
            Self::File(file) => file.flush(),
        }
    }
}

impl Output {
    /// Opens a place of the command line; `-` is the standard output.
    pub fn open<K>(destination: &Destination<K>) -> Result<Self, Failure> {
        Self::create(destination, AtomicFile::create)
    }

    /// The same as one of many, which are not all open at once: see [`close`](Self::close).
    pub fn open_one_of_many<K>(destination: &Destination<K>) -> Result<Self, Failure> {
        Self::create(destination, AtomicFile::create_with_name)
    }

    fn create<K>(
        destination: &Destination<K>,
        create: fn(&Path, bool) -> io::Result<AtomicFile>,
    ) -> Result<Self, Failure> {
        let path = &destination.path;
        let name = path.display().to_string();
        let target = if is_standard(path) {
            OutputTarget::Standard(io::stdout())
        } else {
            let file = create(path, destination.replace);
            let file = file.map_err(|error| Failure::io("write", &name, error))?;
            file.temporary().into_iter().for_each(signals::begin);
            if file.is_in_place() {
                warn(&format!(
                    "the folder of {name} takes no new file: {name} is written in place, and half a file is left \
                     if that ends early"
                ));
            }
            OutputTarget::File(file)
        };
        Ok(Self { writer: BufWriter::with_capacity(1 << 16, target), name })
    }

    /// Says which file could not be written. A reader that went away is no error.
    pub fn failure(&self, error: io::Error) -> Failure {
        match self.writer.get_ref() {
            OutputTarget::Standard(_) => Failure::stdout(error),
            OutputTarget::File(_) => Failure::io("write", &self.name, error),
        }
    }

    /// Writes what is left, and puts a file in the place of its old one.
    pub fn finish(self) -> Result<(), Failure> {
        finish_all(vec![self.close()?])
    }

    /// Writes what is left. A file is on the disk then, and not in its place yet.
    pub fn close(mut self) -> Result<WrittenOutput, Failure> {
        self.writer.flush().map_err(|error| self.failure(error))?;
        let Self { writer, name } = self;
        // Everything has been flushed.
        let (target, _) = writer.into_parts();
        let file = match target {
            OutputTarget::Standard(_) => None,
            OutputTarget::File(file) => {
                Some(file.close().map_err(|error| Failure::io("write", &name, error))?)
            }
        };
        Ok(WrittenOutput { file, name })
    }
}

/// A result that is whole, and not in its place yet.
pub struct WrittenOutput {
    /// Nothing on the standard output.
    file: Option<WrittenFile>,
    name: String,
}

/// Puts files in their places, one after the other; no signal comes between. Where one cannot be put there,
/// those behind it stay as they were, and so do those before it that were not there; of those that were, the
/// old contents are gone, and a warning names them.
pub fn finish_all(outputs: Vec<WrittenOutput>) -> Result<(), Failure> {
    signals::unstopped(|| {
        let mut done: Vec<(String, Option<PathBuf>)> = Vec::new();
        for WrittenOutput { file, name } in outputs {
            let Some(file) = file else { continue };
            let new = file.path().filter(|path| path.symlink_metadata().is_err()).map(Path::to_owned);
            let put = if done.is_empty() { signals::check() } else { Ok(()) };
            if let Err(error) = put.and_then(|()| file.finish()) {
                take_back(done);
                return Err(Failure::io("write", name, error));
            }
            done.push((name, new));
        }
        Ok(())
    })
}

/// Removes files that were not there before, and tells of the others.
fn take_back(done: Vec<(String, Option<PathBuf>)>) {
    let stays = |new: Option<PathBuf>| new.is_none_or(|path| std::fs::remove_file(path).is_err());
    let left: Vec<String> = done.into_iter().filter_map(|(name, new)| stays(new).then_some(name)).collect();
    if !left.is_empty() {
        warn(&format!(
            "{} written already, and new: {}",
            plural(left.len() as u64, "file is", "files are"),
            left.join(", ")
        ));
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        signals::check()?;
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        signals::check()?;
        self.writer.flush()
    }
}

/// Refuses a path of the command line that cannot be written to. Nothing is left there.
pub fn check_place(path: &Path) -> Result<(), Failure> {
    if is_standard(path) {
        return Ok(());
    }
    AtomicFile::check(path).map_err(|error| Failure::io("write", path.display(), error))
}

/// Writes to the standard output what is no line of text.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(Failure::stdout)
}

/// Prints a report to the standard output.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{text}").and_then(|()| stdout.flush()).map_err(Failure::stdout)
}

/// How a command that writes a file tells what it has done.
#[derive(Clone, Copy)]
pub enum Told {
    /// To machines.
    Json,
    /// To people, unless they want quiet.
    Text { quiet: bool },
}

impl Told {
    /// Tells about a result that was written to a path of the command line; people read of it beside the
    /// result if that is the standard output.
    pub fn report(
        self,
        path: &Path,
        json: impl FnOnce() -> String,
        text: impl FnOnce(&str) -> String,
    ) -> Result<(), Failure> {
        match self {
            Self::Json => print(&json()),
            Self::Text { quiet: true } => Ok(()),
            Self::Text { quiet: false } if is_standard(path) => {
                tell(&text("<stdout>"));
                Ok(())
            }
            Self::Text { quiet: false } => print(&text(&path.display().to_string())),
        }
    }
}

/// Tells people something. Where nobody listens there is nothing to do about it.
pub fn tell(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Warns people about something; the text may come from a stranger's file.
pub fn warn(text: &str) {
    tell(&format!("{}: {}", paint("jbt: warning", Severity::Warning), escape(text)));
}

/// Tells why a command has ended.
pub fn report(failure: &Failure) {
    let label = match failure {
        Failure::BrokenPipe | Failure::Told { .. } => return,
        Failure::Input { messages } => {
            for message in messages {
                tell(&highlight(&message.rendered, message.severity));
            }
            return;
        }
        Failure::Usage(_) | Failure::Io { .. } => "jbt: error",
        Failure::Signal(_) => "jbt: stopped",
        Failure::Limit(_) => "jbt: limit",
        Failure::Defect(_) => "jbt: defect",
    };
    tell(&format!("{}: {failure}", paint(label, Severity::Error)));
}

/// A rendered message with its severity in colour.
pub fn highlight(message: &str, severity: Severity) -> String {
    let word = match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Limit => "limit",
    };
    match message.split_once(&format!(": {word}: ")) {
        Some((place, rest)) => format!("{place}: {}: {rest}", paint(word, severity)),
        None => message.to_owned(),
    }
}

fn paint(word: &str, severity: Severity) -> String {
    if !colours() {
        return word.to_owned();
    }
    let colour = match severity {
        Severity::Error | Severity::Limit => AnsiColor::Red,
        Severity::Warning => AnsiColor::Yellow,
    };
    let style = Style::new().bold().fg_color(Some(colour.into()));
    format!("{style}{word}{style:#}")
}

/// Whether messages are coloured: on a terminal, unless NO_COLOR says otherwise (<https://no-color.org>).
fn colours() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// A count as people read it: `1,670,000`.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// `1 triangle`, `2,000 triangles`.
pub fn plural(count: u64, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn counts_for_people() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1000), "1,000");
        assert_eq!(grouped(u64::MAX), "18,446,744,073,709,551,615");
        assert_eq!(plural(1, "leaf", "leaves"), "1 leaf");
        assert_eq!(plural(0, "leaf", "leaves"), "0 leaves");
    }

    #[test]
    fn a_file_keeps_its_contents_until_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        let destination = |replace| Destination { path: path.clone(), kind: (), replace };
        let mut output = Output::open(&destination(true)).unwrap();
        output.write_all(b"half").unwrap();
        output.flush().unwrap();
        drop(output);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
        let mut output = Output::open(&destination(true)).unwrap();
        output.write_all(b"new").unwrap();
        output.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        let mut output = Output::open(&destination(false)).unwrap();
        output.write_all(b"newer").unwrap();
        assert!(output.finish().is_err(), "it came to be there in the meantime");
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn of_several_files_all_or_none_are_new() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let written = |name: &str, replace: bool| {
            let mut output =
                Output::open_one_of_many(&Destination { path: place(name), kind: (), replace }).unwrap();
            output.write_all(b"new").unwrap();
            output.close().unwrap()
        };
        let names = || {
            let entries = fs::read_dir(folder.path()).unwrap();
            let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
            names.sort();
            names
        };
        fs::write(place("b"), "old").unwrap();
        let outputs = vec![written("a", false), written("b", true), written("c", false), written("d", true)];
        assert_eq!(fs::read(place("b")).unwrap(), b"old");
        // Somebody else is faster.
        fs::write(place("c"), "theirs").unwrap();
        assert!(finish_all(outputs).is_err());
        assert_eq!(names(), ["b", "c"], "what was not there is not there");
        assert_eq!(fs::read(place("b")).unwrap(), b"new", "what was replaced is");
        assert_eq!(fs::read(place("c")).unwrap(), b"theirs");
        finish_all(vec![written("a", false), written("d", true)]).unwrap();
        assert_eq!(names(), ["a", "b", "c", "d"]);
        drop(written("e", false));
        assert_eq!(names().len(), 4);
    }
}
