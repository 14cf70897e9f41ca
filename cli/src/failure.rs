//! Why a command ends without having done its work, and the exit code that says so to scripts.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | the work is done |
//! | 1 | the scene has errors, or the points have |
//! | 2 | the command line makes no sense |
//! | 3 | a limit was hit |
//! | 4 | a file could not be read or written |
//! | 128 + n | signal n has stopped the work: 130 is an interrupt of the keyboard |

use std::fmt;
use std::io;

use jbt::diagnostic::{Diagnostic, Diagnostics, Severity, SourceText, escape};
use jbt::{Classified, ErrorKind};

use crate::message::Message;
use crate::signals;

/// Why a command did not do its work.
#[derive(Debug)]
pub enum Failure {
    /// Located messages about a file.
    Input {
        /// In the order of their places.
        messages: Vec<Message>,
    },
    /// The options contradict each other or the scene.
    Usage(String),
    /// Something is larger than a limit allows.
    Limit(String),
    /// A file could not be read or written.
    Io {
        /// The file, and what was tried.
        what: String,
        /// What the system said.
        error: io::Error,
    },
    /// A defect of jbt itself.
    Defect(String),
    /// Something that has been told already.
    Told {
        /// Its exit code.
        code: u8,
    },
    /// A signal has stopped the work: its number.
    Signal(i32),
    /// Whoever read our output has had enough of it: no error.
    BrokenPipe,
}

impl Failure {
    /// A failure to read or write a file. Names may be any text of the command line: printing escapes them.
    pub fn io(verb: &str, name: impl fmt::Display, error: io::Error) -> Self {
        Self::Io { what: format!("cannot {verb} {name}"), error }
    }

    /// A failure to write to the standard output. A reader that went away is not one.
    pub fn stdout(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::BrokenPipe
        } else {
            Self::io("write to", "the standard output", error)
        }
    }

    /// Messages about a file.
    pub fn diagnostics(text: &SourceText, diagnostics: &[Diagnostic]) -> Self {
        Self::Input { messages: diagnostics.iter().map(|one| Message::in_text(text, one)).collect() }
    }

    /// A scene that could not be read.
    pub fn scene(name: &impl fmt::Display, error: &Diagnostics) -> Self {
        if let Some(cause) = error.io() {
            return Self::io("read", name, io::Error::new(cause.kind(), cause.to_string()));
        }
        if let Some(text) = error.source_text() {
            return Self::diagnostics(text, error);
        }
        // Without a text it is about the file as a whole: its length, its ending, what was defined.
        let message = |one: &Diagnostic| {
            let help = one.help.as_ref().map_or_else(String::new, |help| format!("; {help}"));
            one.message.clone() + &help
        };
        let messages: Vec<String> = error.iter().map(message).collect();
        let is_limit = error.iter().any(|one| one.severity == Severity::Limit);
        let message = messages.join("\n");
        if is_limit { Self::Limit(message) } else { Self::Usage(message) }
    }

    /// A task that was not done for a scene.
    pub fn task(text: &SourceText, error: &impl Classified) -> Self {
        if let Some(diagnostics) = error.diagnostics() {
            return Self::diagnostics(text, diagnostics);
        }
        let message = error.to_string();
        match error.kind() {
            ErrorKind::Model => Self::diagnostics(text, &[Diagnostic::error(None, message)]),
            ErrorKind::Argument => Self::Usage(message),
            ErrorKind::Unbounded => Self::Usage(format!("{message}; --region gives it one")),
            ErrorKind::Limit => Self::Limit(message),
            // Signals alone cancel work. Files are opened and written elsewhere.
            ErrorKind::Cancelled => signals::caught().map_or(Self::Defect(message), Self::Signal),
            ErrorKind::System | ErrorKind::Internal => Self::Defect(message),
        }
    }

    /// What is wrong with a file as a whole, as a message about it.
    pub fn about_file(&self, file: &str) -> Message {
        let severity = if self.code() == 3 { Severity::Limit } else { Severity::Error };
        Message::rendered(severity, file, self.to_string())
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::BrokenPipe => 0,
            // A file with both is wrong first and large second.
            Self::Input { messages } if messages.iter().any(|one| one.severity == Severity::Error) => 1,
            Self::Input { messages } if messages.iter().any(|one| one.severity == Severity::Limit) => 3,
            Self::Input { .. } | Self::Defect(_) => 1,
            Self::Usage(_) => 2,
            Self::Limit(_) => 3,
            Self::Io { .. } => 4,
            Self::Signal(signal) => signals::code(*signal),
            Self::Told { code } => *code,
        }
    }
}

impl fmt::Display for Failure {
    /// What to tell people, without a severity in front; rendered messages have their own.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input { messages } => {
                let all: Vec<&str> = messages.iter().map(|message| message.rendered.as_str()).collect();
                f.write_str(&all.join("\n"))
            }
            Self::Usage(message) | Self::Limit(message) | Self::Defect(message) => {
                let lines: Vec<String> = message.lines().map(escape).collect();
                f.write_str(&lines.join("\n"))
            }
            Self::Io { what, error } => write!(f, "{}: {error}", escape(what)),
            Self::Signal(signal) => write!(f, "{}: nothing was written", signals::name(*signal)),
            Self::Told { .. } => f.write_str("something is wrong, as has been told"),
            Self::BrokenPipe => f.write_str("the reader of the output went away"),
        }
    }
}
