//! Files that a text names: whoever reads the text says how they are opened, and the default is not at all.
//!
//! ```text
//! include "parts/arm.jbt"    ──►  FileReader: how much may still be read  ──►  Resolver: where it is, its bytes
//! ```
//!
//! This crate opens nothing itself. A [`Resolver`] of the caller does, for a name as it is written, and for
//! the file that has named it. One [`FileReader`] for each scene counts what all of its files have together.

use std::collections::HashMap;
use std::error::Error;
use std::fmt;
use std::io;
use std::sync::Arc;

use jbt_ir::limits::{MAX_NAMED_BYTES, MAX_NAMED_FILES};

/// A request for a file that a text names.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct FileRequest<'a> {
    /// The name as it is written: relative to the folder of the file that has it.
    pub name: &'a str,
    /// The file that has it: the [`path`](NamedFile::path) that a resolver has given it, or nothing if it is
    /// the scene itself.
    pub from: Option<&'a str>,
    /// The most bytes that the file may have. A longer one need not be read.
    pub most: usize,
}

impl<'a> FileRequest<'a> {
    /// A request of the scene itself for a file of at most so many bytes.
    #[must_use]
    pub fn new(name: &'a str, most: usize) -> Self {
        Self { name, from: None, most }
    }

    /// The same, in a file that a resolver has opened.
    #[must_use]
    pub fn from(self, path: &'a str) -> Self {
        Self { from: Some(path), ..self }
    }

    /// The name, behind the folder of the file that has it: relative to the folder of the scene.
    #[must_use]
    pub fn joined(&self) -> String {
        let folder = self.from.and_then(|from| Some(from.rsplit_once('/')?.0));
        match folder {
            Some(folder) if !self.name.starts_with('/') => format!("{folder}/{}", self.name),
            Some(_) | None => self.name.to_owned(),
        }
    }
}

/// A file that a text has named.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NamedFile {
    /// Its path for messages, and for what it names itself: with `/` between folders, relative to the folder
    /// of the scene.
    pub path: String,
    /// What is equal for the same file under any of its names, and for no other file.
    pub identity: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Opens the files that a text names.
///
/// ```
/// use std::sync::Arc;
/// use jbt_text::files::{FileRequest, Files, NamedFile, ResolveError, Resolver};
/// use jbt_text::{Options, parse};
///
/// /// Files in memory.
/// struct Parts;
///
/// impl Resolver for Parts {
///     fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
///         let path = request.joined();
///         match &*path {
///             "ball.jbt" => Ok(NamedFile {
///                 identity: path.clone(),
///                 path,
///                 bytes: b"jbt 1 let ball = point { radius 2 }".to_vec(),
///             }),
///             _ => Err(ResolveError::Missing),
///         }
///     }
/// }
///
/// let options = Options { files: Files::new(Arc::new(Parts)), ..Options::default() };
/// let mut reader = options.files.reader();
/// assert_eq!(reader.read("ball.jbt", None)?.bytes.len(), 35);
/// assert!(matches!(reader.read("cube.jbt", None), Err(ResolveError::Missing)));
/// # Ok::<(), ResolveError>(())
/// ```
pub trait Resolver: Send + Sync {
    /// The file that is asked for. It may be asked for again.
    ///
    /// # Errors
    /// Why there is none. Nothing that a file holds stands in an error.
    fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError>;
}

/// Why a file that a text names was not read.
#[derive(Debug)]
#[non_exhaustive]
pub enum ResolveError {
    /// Whoever reads the text has given no way to open files.
    Refused,
    /// The text came from no folder: it was given on the standard input.
    NoFolder,
    /// There is no file of this name.
    Missing,
    /// The name, or a link behind it, leads out of the folder of the scene.
    Outside,
    /// A folder, a pipe, a device, or anything else that is no regular file.
    NotRegular,
    /// It has more bytes than may still be read.
    TooLarge {
        /// How many may be read.
        most: usize,
    },
    /// More files than one scene may name.
    TooMany,
    /// The system does not let it be read.
    Unreadable(io::Error),
}

impl ResolveError {
    /// Whether a limit has been reached, and not a mistake been made.
    #[must_use]
    pub fn is_limit(&self) -> bool {
        matches!(self, Self::TooLarge { .. } | Self::TooMany)
    }

    /// What to do about it, if that is not plain.
    #[must_use]
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::Refused => Some("a program that reads scenes says how files are opened: `Options::files`"),
            Self::NoFolder => Some("expected a scene in a file, beside the files that it names"),
            Self::Outside => Some("expected a file in the folder of the scene or below it"),
            Self::NotRegular => Some("expected a regular file: no folder, no pipe, no device"),
            Self::Missing | Self::TooLarge { .. } | Self::TooMany | Self::Unreadable(_) => None,
        }
    }
}

impl fmt::Display for ResolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused => f.write_str("a text may name no files here"),
            Self::NoFolder => f.write_str("the standard input has no folder"),
            Self::Missing => f.write_str("there is no such file"),
            Self::Outside => f.write_str("it is outside of the scene's folder"),
            Self::NotRegular => f.write_str("it is no regular file"),
            Self::TooLarge { most } => write!(f, "it has more than the {most} bytes that may still be read"),
            Self::TooMany => write!(f, "a scene may name {MAX_NAMED_FILES} files"),
            Self::Unreadable(error) => error.fmt(f),
        }
    }
}

impl Error for ResolveError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Unreadable(error) => Some(error),
            Self::Refused
            | Self::NoFolder
            | Self::Missing
            | Self::Outside
            | Self::NotRegular
            | Self::TooLarge { .. }
            | Self::TooMany => None,
        }
    }
}

impl From<io::Error> for ResolveError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Self::Missing,
            _ => Self::Unreadable(error),
        }
    }
}

/// How files are opened that a text names. The default refuses all.
#[derive(Clone)]
pub struct Files(Arc<dyn Resolver>);

impl Files {
    /// As this resolver does it.
    #[must_use]
    pub fn new(resolver: Arc<dyn Resolver>) -> Self {
        Self(resolver)
    }

    /// None, since the text came from the standard input.
    #[must_use]
    pub fn of_standard_input() -> Self {
        Self(Arc::new(NoFolder))
    }

    /// What reads the files of one scene, and counts them.
    #[must_use]
    pub fn reader(&self) -> FileReader {
        FileReader { files: self.clone(), left: MAX_NAMED_BYTES, known: HashMap::new(), count: 0 }
    }
}

impl Default for Files {
    fn default() -> Self {
        Self(Arc::new(Refusing))
    }
}

impl PartialEq for Files {
    /// The same resolver.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl fmt::Debug for Files {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Files")
    }
}

/// Refuses whatever is asked for.
struct Refusing;

impl Resolver for Refusing {
    fn resolve(&self, _: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        Err(ResolveError::Refused)
    }
}

/// Refuses, as there is no folder.
struct NoFolder;

impl Resolver for NoFolder {
    fn resolve(&self, _: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        Err(ResolveError::NoFolder)
    }
}

/// Reads the files that one scene names, directly or not, within [`MAX_NAMED_FILES`] and [`MAX_NAMED_BYTES`]
/// for all of them together. A file is counted, and kept, once under each of its names.
#[derive(Debug)]
pub struct FileReader {
    files: Files,
    left: usize,
    count: usize,
    /// By its joined name.
    known: HashMap<String, Arc<NamedFile>>,
}

impl FileReader {
    /// The file of a name, as it stands in the file `from`, or in the scene itself.
    ///
    /// # Errors
    /// Those of the resolver, and a file too many, or too large for what is left.
    pub fn read(&mut self, name: &str, from: Option<&str>) -> Result<Arc<NamedFile>, ResolveError> {
        self.read_at_most(name, from, usize::MAX)
    }

    /// The same, if it has at most so many bytes.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_at_most(
        &mut self,
        name: &str,
        from: Option<&str>,
        most: usize,
    ) -> Result<Arc<NamedFile>, ResolveError> {
        let request = FileRequest { name, from, most: most.min(self.left) };
        let key = request.joined();
        if let Some(file) = self.known.get(&key) {
            return if file.bytes.len() > most {
                Err(ResolveError::TooLarge { most })
            } else {
                Ok(Arc::clone(file))
            };
        }
        if self.count == MAX_NAMED_FILES {
            return Err(ResolveError::TooMany);
        }
        self.count += 1;
        let file = self.files.0.resolve(&request)?;
        if file.bytes.len() > request.most {
            return Err(ResolveError::TooLarge { most: request.most });
        }
        self.left -= file.bytes.len();
        let file = Arc::new(file);
        self.known.insert(key, Arc::clone(&file));
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of as many bytes as its name says, which is asked for once.
    struct Sized;

    impl Resolver for Sized {
        fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
            let path = request.joined();
            let bytes =
                vec![b' '; path.rsplit('/').next().unwrap().parse().map_err(|_| ResolveError::Missing)?];
            Ok(NamedFile { identity: path.clone(), path, bytes })
        }
    }

    #[test]
    fn names_are_relative_to_the_file_that_has_them() {
        let joined = |name, from: Option<&'static str>| FileRequest { name, from, most: 1 }.joined();
        assert_eq!(joined("a.jbt", None), "a.jbt");
        assert_eq!(joined("a.jbt", Some("b.jbt")), "a.jbt");
        assert_eq!(joined("../a.jbt", Some("parts/b.jbt")), "parts/../a.jbt");
        // A resolver has to see that this is no name below its folder.
        assert_eq!(joined("/etc/passwd", Some("parts/b.jbt")), "/etc/passwd");
    }

    #[test]
    fn bytes_and_files_are_counted() {
        let mut reader = Files::new(Arc::new(Sized)).reader();
        assert_eq!(reader.read("5", Some("a/b")).unwrap().path, "a/5");
        assert!(matches!(reader.read_at_most("5", Some("a/b"), 4), Err(ResolveError::TooLarge { most: 4 })));
        assert_eq!(reader.left, MAX_NAMED_BYTES - 5);
        for _ in 0..3 {
            reader.read("7", None).unwrap();
        }
        assert_eq!(reader.left, MAX_NAMED_BYTES - 12);
        let left = reader.left;
        reader.left = 3;
        assert!(reader.read("4", None).unwrap_err().is_limit());
        reader.left = left;
        for _ in 3..MAX_NAMED_FILES {
            assert!(!reader.read("none", None).unwrap_err().is_limit());
        }
        assert!(matches!(reader.read("8", None), Err(ResolveError::TooMany)));
        assert_eq!(reader.read("7", None).unwrap().bytes.len(), 7);
    }

    #[test]
    fn the_default_refuses() {
        assert!(matches!(Files::default().reader().read("a", None), Err(ResolveError::Refused)));
        let standard = Files::of_standard_input();
        assert!(matches!(standard.reader().read("a", None), Err(ResolveError::NoFolder)));
    }
}
