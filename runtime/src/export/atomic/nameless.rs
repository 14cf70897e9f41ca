//! Files without a name, which get one once they are whole (Linux): whoever is killed before leaves nothing.
//!
//! ```text
//! open(folder, O_TMPFILE) ── write ── sync ─┬─ link to the path                          nothing was there
//!                                           └─ link to .jbt-0-NAME, rename to the path   a file was there
//! ```
//!
//! A link cannot replace a file, so between the two steps of the second line there is a temporary name. Its
//! file is locked, and the lock ends with its process: whoever finds such a name unlocked removes it.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat};

/// Bytes of the target's name that a temporary name repeats: names of files have 255 at most.
const LONGEST: usize = 200;
/// Temporary names of one target that may be in use at the same time.
const SLOTS: usize = 64;

/// A new file without a name in a folder, with the permissions that the process gives to any new file; `None`
/// where the system or the file system has none.
pub(super) fn create(folder: &Path) -> Option<File> {
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(0o666)).ok()?);
    // Without this path there is no name for it later.
    fs::symlink_metadata(descriptor(&file)).is_ok().then_some(file)
}

/// A new file with the temporary name of a path, where files need one: locked, as long as it is open. `None`
/// where no such name can be had.
pub(super) fn create_with_name(path: &Path) -> Option<(File, PathBuf)> {
    for name in temporary_names(path) {
        let create = || File::options().read(true).write(true).create_new(true).open(&name);
        let file = match create() {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && remove_if_left(&name) => create().ok(),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => None,
            created => Some(created.ok()?),
        };
        // Before the lock somebody may take it for one that is left over. Where files cannot be locked,
        // nobody does.
        let is_ours =
            |file: &File| !matches!(file.try_lock(), Err(TryLockError::WouldBlock)) && is_at(file, &name);
        if let Some(file) = file.filter(is_ours) {
            return Some((file, name));
        }
    }
    None
}

/// Gives the file its name.
///
/// # Errors
/// Whatever the system refuses, and a file that is there already unless it may be replaced.
pub(super) fn put(file: &File, path: &Path, replace: bool) -> io::Result<()> {
    match link(file, path) {
        Err(error) if replace && error.kind() == ErrorKind::AlreadyExists => {}
        done => return done,
    }
    // Where files cannot be locked, nobody takes the temporary name for one that is left over.
    let _ = file.try_lock();
    for name in temporary_names(path) {
        let taken = |error: &io::Error| error.kind() == ErrorKind::AlreadyExists;
        let linked = match link(file, &name) {
            Err(error) if taken(&error) && remove_if_left(&name) => link(file, &name),
            linked => linked,
        };
        match linked {
            Err(error) if taken(&error) => continue,
            linked => linked?,
        }
        if !is_at(file, &name) {
            continue;
        }
        return fs::rename(&name, path).inspect_err(|_| drop(fs::remove_file(&name)));
    }
    Err(io::Error::new(ErrorKind::ResourceBusy, "too many programs replace it at the same time"))
}

/// Removes the temporary names of a path that killed processes have left.
pub(super) fn remove_left(path: &Path) {
    for name in temporary_names(path).take_while(|name| fs::symlink_metadata(name).is_ok()) {
        remove_if_left(&name);
    }
}

/// `.jbt-0-NAME`, `.jbt-1-NAME` and so on beside a path.
fn temporary_names(path: &Path) -> impl Iterator<Item = PathBuf> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let end = (0..=LONGEST.min(name.len())).rev().find(|&end| name.is_char_boundary(end)).unwrap_or(0);
    let name = name[..end].to_owned();
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    (0..SLOTS).map(move |slot| folder.join(format!(".jbt-{slot}-{name}")))
}

/// Removes a temporary name whose process is gone; whether it did.
fn remove_if_left(name: &Path) -> bool {
    let is_file = fs::symlink_metadata(name).is_ok_and(|found| found.is_file());
    let Some(file) = is_file.then(|| File::open(name).ok()).flatten() else { return false };
    match file.try_lock() {
        // Only who holds the lock removes the name, and by now it may be that of another file.
        Ok(()) => is_at(&file, name) && fs::remove_file(name).is_ok(),
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => false,
    }
}

/// Whether a path leads to this file.
fn is_at(file: &File, path: &Path) -> bool {
    let place = |found: fs::Metadata| (found.dev(), found.ino());
    let (file, path) = (file.metadata().map(place), fs::symlink_metadata(path).map(place));
    matches!((file, path), (Ok(file), Ok(path)) if file == path)
}

fn link(file: &File, path: &Path) -> io::Result<()> {
    Ok(linkat(CWD, descriptor(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

/// The path under which the system shows an open file.
fn descriptor(file: &File) -> PathBuf {
    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_left_name_goes_and_one_in_use_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.glb");
        fs::write(&path, "old").unwrap();
        fs::write(folder.path().join(".jbt-0-a.glb"), "of somebody who works").unwrap();
        fs::write(folder.path().join(".jbt-1-a.glb"), "of somebody who was killed").unwrap();
        let theirs = File::open(folder.path().join(".jbt-0-a.glb")).unwrap();
        theirs.try_lock().unwrap();
        remove_left(&path);
        assert_eq!(names(folder.path()), [".jbt-0-a.glb", "a.glb"]);
        let Some(mut file) = create(folder.path()) else { return };
        file.write_all(b"new").unwrap();
        put(&file, &path, true).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), [".jbt-0-a.glb", "a.glb"]);
        drop(theirs);
        remove_left(&path);
        assert_eq!(names(folder.path()), ["a.glb"]);
    }

    #[test]
    fn a_name_that_is_needed_is_one_that_the_next_run_knows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.glb");
        let (file, name) = create_with_name(&path).unwrap();
        let (other, another) = create_with_name(&path).unwrap();
        remove_left(&path);
        assert_eq!(names(folder.path()), [".jbt-0-a.glb", ".jbt-1-a.glb"], "both are in use");
        // Whoever is killed leaves the name and no lock.
        drop(file);
        let (_again, taken) = create_with_name(&path).unwrap();
        assert_eq!(taken, name);
        drop(other);
        remove_left(&path);
        assert!(name.exists() && !another.exists());
    }

    #[test]
    fn temporary_names_fit_whatever_the_path_is_called() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("\u{e9}".repeat(127));
        fs::write(&path, "old").unwrap();
        let Some(file) = create(folder.path()) else { return };
        put(&file, &path, true).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"");
        assert_eq!(names(folder.path()).len(), 1);
    }

    #[test]
    fn what_has_no_name_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let Some(mut file) = create(folder.path()) else { return };
        file.write_all(b"half").unwrap();
        assert!(names(folder.path()).is_empty());
    }
}
