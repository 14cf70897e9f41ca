//! Files that are replaced as a whole.

#[cfg(target_os = "linux")]
mod nameless;

use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use jbt_model::diagnostic::escape;
use tempfile::TempPath;

/// The new contents of a file, which appear whole or not at all.
///
/// On Linux they have no name before [`finish`](Self::finish), so that a process that is killed leaves
/// nothing where nothing was. While a file is replaced they have one for an instant, `.jbt-0-NAME` beside it,
/// which the next one that writes `NAME` removes. Where files need a name, they have that one all the time;
/// dropping this removes it, too. On other systems it has random letters, and stays after a kill. Whoever
/// drops this before `finish` leaves the file as it was.
///
/// A file that is there already keeps its permissions, a new one gets those that files usually get. A link is
/// followed. What is not a file but can be written to (a pipe, a device) is written to as the bytes come. So
/// is a file that may be written to in a folder that takes no new file: [`is_in_place`](Self::is_in_place)
/// says so, for whoever has to be warned.
#[derive(Debug)]
pub struct AtomicFile {
    file: File,
    /// Where the contents go; `None` if they are there already.
    target: Option<PendingFile>,
    in_place: bool,
}

#[derive(Debug)]
struct PendingFile {
    /// The temporary name, if the file has one.
    temporary: Option<TempPath>,
    path: PathBuf,
    replace: bool,
    /// Whether the file is open until it is in its place: a temporary name that can be told from one that a
    /// kill has left is locked as long.
    stays_open: bool,
}

/// A new file, and its temporary name if it has one.
type BegunFile = (File, Option<TempPath>);

/// What stands at a path, and so how it is written to.
enum PathKind {
    /// A pipe or a device.
    Direct(PathBuf),
    /// A file, or nothing as yet: its path, its folder, and the permissions that it has.
    File { path: PathBuf, folder: PathBuf, old: Option<Permissions> },
}

impl AtomicFile {
    /// Begins to write what stands at a path. Without `replace`, a file that has appeared there by the end is
    /// an error.
    ///
    /// # Errors
    ///
    /// Whatever the system refuses; a folder, a file that is read-only, a path whose folder is not there, and
    /// a new file, or one that is not to be replaced, in a folder that takes no new file.
    pub fn create(path: &Path, replace: bool) -> io::Result<Self> {
        Self::begin(path, replace, begin, true)
    }

    /// The same with a temporary name of random letters from the beginning: then [`close`](Self::close)
    /// closes it. For whoever writes more files at once than a process may have open. A kill leaves that
    /// name.
    ///
    /// # Errors
    ///
    /// As [`create`](Self::create).
    pub fn create_with_name(path: &Path, replace: bool) -> io::Result<Self> {
        Self::begin(path, replace, |_, folder| begin_with_name(folder), false)
    }

    fn begin(
        path: &Path,
        replace: bool,
        begin: fn(&Path, &Path) -> io::Result<BegunFile>,
        stays_open: bool,
    ) -> io::Result<Self> {
        match PathKind::at(path)? {
            PathKind::Direct(path) => {
                let file = File::options().write(true).open(path)?;
                Ok(Self { file, target: None, in_place: false })
            }
            PathKind::File { path, folder, old } => {
                #[cfg(target_os = "linux")]
                nameless::remove_left(&path);
                let (file, temporary) = match begin(&path, &folder) {
                    Ok(begun) => begun,
                    Err(error) if replace && old.is_some() && takes_no_file(&error) => {
                        let file = in_place(&path, error)?;
                        file.set_len(0)?;
                        return Ok(Self { file, target: None, in_place: true });
                    }
                    Err(error) => return Err(error),
                };
                if let Some(old) = old {
                    file.set_permissions(old)?;
                }
                let target = Some(PendingFile { temporary, path, replace, stays_open });
                Ok(Self { file, target, in_place: false })
            }
        }
    }

    /// Tries whether a path can be written to. Nothing is left there.
    ///
    /// # Errors
    ///
    /// As [`create`](Self::create).
    pub fn check(path: &Path) -> io::Result<()> {
        match PathKind::at(path)? {
            // To open a pipe is to wait for its reader.
            PathKind::Direct(_) => Ok(()),
            PathKind::File { folder, path, old } => match begin(&path, &folder) {
                Err(error) if old.is_some() && takes_no_file(&error) => in_place(&path, error).map(drop),
                begun => begun.map(drop),
            },
        }
    }

    /// Whether the old contents are gone from the beginning: the folder of the file takes no new one.
    #[must_use]
    pub fn is_in_place(&self) -> bool {
        self.in_place
    }

    /// The temporary name of the contents, if they have one: for a program that ends without dropping this.
    #[must_use]
    pub fn temporary(&self) -> Option<&Path> {
        self.target.as_ref()?.temporary.as_deref()
    }

    /// Ends the contents and brings them to the disk. Those that were begun [with a
    /// name](Self::create_with_name) are open no longer.
    ///
    /// # Errors
    ///
    /// Whatever the system refuses; then the file is as it was.
    pub fn close(self) -> io::Result<WrittenFile> {
        let Self { file, target, .. } = self;
        if target.is_some() {
            file.sync_all()?;
        }
        let stays_open = target.as_ref().is_some_and(|pending| pending.stays_open);
        Ok(WrittenFile { file: stays_open.then_some(file), target })
    }

    /// Puts the contents in their place, once they are on the disk.
    ///
    /// # Errors
    ///
    /// Whatever the system refuses; then the file is as it was.
    pub fn finish(self) -> io::Result<()> {
        self.close()?.finish()
    }
}

/// The new contents of a file, all of them on the disk, that are not in its place yet: see [`AtomicFile`].
#[derive(Debug)]
pub struct WrittenFile {
    /// The contents, if they are open.
    file: Option<File>,
    target: Option<PendingFile>,
}

impl WrittenFile {
    /// The place, if the contents are not there already.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.target.as_ref().map(|pending| &*pending.path)
    }

    /// Puts the contents in their place.
    ///
    /// # Errors
    ///
    /// Whatever the system refuses; then the file is as it was.
    pub fn finish(self) -> io::Result<()> {
        let Some(PendingFile { temporary, path, replace, .. }) = self.target else { return Ok(()) };
        match (temporary, self.file) {
            (Some(temporary), _) => {
                let put = if replace { temporary.persist(path) } else { temporary.persist_noclobber(path) };
                put.map_err(|error| error.error)
            }
            (None, Some(file)) => put_nameless(&file, &path, replace),
            (None, None) => Ok(()),
        }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl PathKind {
    fn at(path: &Path) -> io::Result<Self> {
        // Through a link it is the file behind it that is replaced; the link stays.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let old = match fs::metadata(&path) {
            Ok(old) if old.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(old) if !old.is_file() => return Ok(Self::Direct(path)),
            Ok(old) if old.permissions().readonly() => {
                return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
            }
            Ok(old) => Some(old.permissions()),
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            Err(_) if !folder.is_dir() => {
                let message = format!("there is no folder {}", escape(&folder.display().to_string()));
                return Err(io::Error::new(io::ErrorKind::NotFound, message));
            }
            Err(_) => None,
        };
        Ok(Self::File { folder: folder.to_owned(), path, old })
    }
}

/// A new file in the folder of a path, with the permissions that the process gives to any new file, and its
/// temporary name if it needs one.
fn begin(path: &Path, folder: &Path) -> io::Result<BegunFile> {
    #[cfg(target_os = "linux")]
    {
        if let Some(file) = nameless::create(folder) {
            return Ok((file, None));
        }
        if let Some((file, name)) = nameless::create_with_name(path) {
            let temporary = TempPath::try_from_path(&name).inspect_err(|_| drop(fs::remove_file(&name)))?;
            return Ok((file, Some(temporary)));
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = path;
    begin_with_name(folder)
}

/// The same, always with a temporary name, of random letters.
fn begin_with_name(folder: &Path) -> io::Result<BegunFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".jbt-");
    // The system's own words about a file that cannot be made: the temporary name means nothing to anybody.
    let made =
        builder.make_in(folder, |path| File::options().read(true).write(true).create_new(true).open(path));
    let (file, temporary) = made.map_err(|error| about_folder(folder, error))?.into_parts();
    Ok((file, Some(temporary)))
}

/// Whether it is the folder that lets nobody create files: the file itself may be fine.
fn takes_no_file(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem)
}

/// Opens a file itself, where none can be written beside it; `error` says why not.
fn in_place(path: &Path, error: io::Error) -> io::Result<File> {
    File::options().write(true).open(path).map_err(|_| error)
}

/// Says so where it is the folder.
fn about_folder(folder: &Path, error: io::Error) -> io::Error {
    if !takes_no_file(&error) {
        return error;
    }
    let folder = escape(&folder.display().to_string());
    let message = format!("{error}: contents are written beside the file, and {folder} takes no new file");
    io::Error::new(error.kind(), message)
}

#[cfg(target_os = "linux")]
fn put_nameless(file: &File, path: &Path, replace: bool) -> io::Result<()> {
    nameless::put(file, path, replace)
}

/// Elsewhere every file has a name.
#[cfg(not(target_os = "linux"))]
fn put_nameless(_: &File, _: &Path, _: bool) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(test)]
mod tests;
