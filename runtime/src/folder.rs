//! The folder of a scene, as what opens the files that the scene names: regular files beneath it, and nothing
//! else.
//!
//! ```text
//! name ──► where it leads, links followed, not above the folder
//!      ──► a regular file? ──► opened, still the same? ──► bytes
//! ```
//!
//! Nothing is opened for reading before it is known to be a regular file: opening a device may do something,
//! and opening a pipe may wait. Linux is asked to keep beneath the folder itself (`openat2`), whatever others
//! do to its links meanwhile. Elsewhere the canonical path tells, and is asked again once the file is open.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use jbt_text::files::{FileRequest, NamedFile, ResolveError, Resolver};

/// Opens regular files in the folder of a scene and below it, symbolic links followed.
///
/// ```no_run
/// use std::sync::Arc;
/// use jbt::text::{Options, files::Files};
///
/// let files = Files::new(Arc::new(jbt::SceneFolder::of("scenes/castle.jbt")));
/// let scene = jbt::Scene::load_with("scenes/castle.jbt", &Options { files, ..Options::default() })?;
/// # Ok::<(), jbt::Diagnostics>(())
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SceneFolder {
    folder: PathBuf,
}

impl SceneFolder {
    /// The folder in which the file of a scene is.
    #[must_use]
    pub fn of(scene: impl AsRef<Path>) -> Self {
        let folder = scene.as_ref().parent().filter(|folder| !folder.as_os_str().is_empty());
        Self { folder: folder.unwrap_or(Path::new(".")).to_owned() }
    }
}

impl Resolver for SceneFolder {
    fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        let path = request.joined();
        let (file, identity) = open_below(&self.folder, &path)?;
        if file.metadata()?.len() > request.most as u64 {
            return Err(ResolveError::TooLarge { most: request.most });
        }
        // One that grows meanwhile is not read to its end.
        let mut bytes = Vec::new();
        file.take(request.most as u64 + 1).read_to_end(&mut bytes)?;
        if bytes.len() > request.most {
            return Err(ResolveError::TooLarge { most: request.most });
        }
        Ok(NamedFile { path, identity, bytes })
    }
}

/// What tells a file from all others.
#[cfg(unix)]
fn identity(metadata: &std::fs::Metadata) -> String {
    use std::os::unix::fs::MetadataExt as _;
    format!("{}:{}", metadata.dev(), metadata.ino())
}

/// The file of a name that leads out of the folder nowhere, and what tells it from others.
#[cfg(target_os = "linux")]
fn open_below(folder: &Path, name: &str) -> Result<(File, String), ResolveError> {
    use rustix::fs::{CWD, Mode, OFlags, ResolveFlags, openat, openat2};
    use rustix::io::Errno;

    let flags = OFlags::PATH | OFlags::DIRECTORY | OFlags::CLOEXEC;
    let folder_file = openat(CWD, folder, flags, Mode::empty()).map_err(std::io::Error::from)?;
    let open = |flags| {
        let below = ResolveFlags::BENEATH | ResolveFlags::NO_MAGICLINKS;
        // The system gives up when folders are renamed while it looks.
        let tries =
            (0..16).map(|_| openat2(&folder_file, name, flags | OFlags::CLOEXEC, Mode::empty(), below));
        let mut tries = tries.skip_while(|tried| tried.as_ref().is_err_and(|error| *error == Errno::AGAIN));
        tries.next().unwrap_or(Err(Errno::AGAIN))
    };
    let found = match open(OFlags::PATH) {
        Ok(found) => File::from(found),
        Err(Errno::XDEV) => return Err(ResolveError::Outside),
        // An old kernel, or one that is told to know no new calls.
        Err(Errno::NOSYS | Errno::PERM) => return open_canonical(folder, name),
        Err(error) => return Err(std::io::Error::from(error).into()),
    };
    let metadata = found.metadata()?;
    if !metadata.is_file() {
        return Err(ResolveError::NotRegular);
    }
    // Somebody may have put a pipe in its place, for which nobody waits.
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY;
    let file = File::from(open(flags).map_err(std::io::Error::from)?);
    if identity(&file.metadata()?) != identity(&metadata) {
        return Err(ResolveError::NotRegular);
    }
    Ok((file, identity(&metadata)))
}

/// The same, without a call of the system that does it.
#[cfg(not(target_os = "linux"))]
fn open_below(folder: &Path, name: &str) -> Result<(File, String), ResolveError> {
    open_canonical(folder, name)
}

/// The same by canonical paths.
fn open_canonical(folder: &Path, name: &str) -> Result<(File, String), ResolveError> {
    let folder = folder.canonicalize()?;
    let below = || {
        let path = folder.join(name).canonicalize()?;
        if path.starts_with(&folder) { Ok(path) } else { Err(ResolveError::Outside) }
    };
    let path = below()?;
    let before = std::fs::symlink_metadata(&path)?;
    if !before.is_file() {
        return Err(ResolveError::NotRegular);
    }
    let file = open_at_once(&path)?;
    let metadata = file.metadata()?;
    let again = below()?;
    #[cfg(unix)]
    {
        let all = [&before, &std::fs::symlink_metadata(&again)?].map(identity);
        let open = identity(&metadata);
        if all.iter().all(|other| *other == open) && metadata.is_file() {
            return Ok((file, open));
        }
    }
    #[cfg(not(unix))]
    if again == path && metadata.is_file() {
        return Ok((file, path.to_string_lossy().into_owned()));
    }
    Err(ResolveError::NotRegular)
}

/// Opens a file without waiting for whoever may write to it.
#[cfg(unix)]
fn open_at_once(path: &Path) -> std::io::Result<File> {
    use rustix::fs::{Mode, OFlags};
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    Ok(File::from(rustix::fs::open(path, flags, Mode::empty())?))
}

/// The same.
#[cfg(not(unix))]
fn open_at_once(path: &Path) -> std::io::Result<File> {
    File::open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Open = fn(&Path, &str) -> Result<(File, String), ResolveError>;

    /// Both ways to keep beneath a folder.
    const WAYS: [Open; 2] = [open_below, open_canonical];

    #[test]
    fn files_of_the_folder_are_read_within_their_budget() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("parts")).unwrap();
        std::fs::write(folder.path().join("parts/a.jbt"), "12345").unwrap();
        let resolver = SceneFolder::of(folder.path().join("scene.jbt"));
        let read = |request: FileRequest<'_>| resolver.resolve(&request);
        let file = read(FileRequest::new("parts/a.jbt", 5)).unwrap();
        assert_eq!((file.path.as_str(), file.bytes.as_slice()), ("parts/a.jbt", b"12345".as_slice()));
        let again = read(FileRequest::new("../parts/./a.jbt", 5).from("parts/b.jbt")).unwrap();
        assert_eq!(again.identity, file.identity);
        assert!(matches!(read(FileRequest::new("parts/a.jbt", 4)), Err(ResolveError::TooLarge { most: 4 })));
        assert!(matches!(read(FileRequest::new("parts/b.jbt", 4)), Err(ResolveError::Missing)));
        assert!(matches!(read(FileRequest::new("parts/a.jbt/c", 4)), Err(ResolveError::Missing)));
        assert!(read(FileRequest::new("parts/\0", 4)).is_err());
        for open in WAYS {
            assert!(matches!(open(folder.path(), "parts"), Err(ResolveError::NotRegular)));
            assert_eq!(open(folder.path(), "parts/../parts/a.jbt").unwrap().1, file.identity);
        }
    }

    #[cfg(unix)]
    #[test]
    fn nothing_outside_of_the_folder_is_read() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let scenes = folder.path().join("scenes");
        std::fs::create_dir(&scenes).unwrap();
        std::fs::write(folder.path().join("secret"), "secret").unwrap();
        std::fs::write(scenes.join("open"), "open").unwrap();
        symlink("../secret", scenes.join("up")).unwrap();
        symlink("/etc", scenes.join("etc")).unwrap();
        symlink("open", scenes.join("same")).unwrap();
        symlink("loop", scenes.join("loop")).unwrap();
        for open in WAYS {
            for name in ["../secret", "/etc/passwd", "up", "etc/passwd", "same/../../secret"] {
                let found = open(&scenes, name);
                let refused = matches!(found, Err(ResolveError::Outside | ResolveError::Missing));
                assert!(refused, "{name}: {found:?}");
            }
            assert!(matches!(open(&scenes, "loop"), Err(ResolveError::Unreadable(_))));
            assert_eq!(open(&scenes, "same").unwrap().1, open(&scenes, "open").unwrap().1);
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn pipes_and_devices_are_not_opened() {
        use rustix::fs::{CWD, FileType, Mode, mknodat};
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        mknodat(CWD, &pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        for open in WAYS {
            assert!(matches!(open(folder.path(), "pipe"), Err(ResolveError::NotRegular)));
            assert!(matches!(open(Path::new("/dev"), "null"), Err(ResolveError::NotRegular)));
            assert!(matches!(open(Path::new("/dev"), "tty"), Err(ResolveError::NotRegular)));
        }
    }
}
