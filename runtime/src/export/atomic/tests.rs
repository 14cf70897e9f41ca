//! Files of meshes appear whole or not at all, with the rights that they had, and errors say why.

use std::fs;

use super::super::tests::{bytes, tetrahedron};
use super::super::*;

/// What a folder holds.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn saving_replaces_whole_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    save(&path, &tetrahedron()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes(&tetrahedron(), Format::Ply));
    save(&path, &Mesh::default()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes(&Mesh::default(), Format::Ply));
    save_as(&path, &Mesh::default(), Format::Stl).unwrap();
    assert_eq!(fs::read(&path).unwrap().len(), 84);
    assert_eq!(names(folder.path()), ["a.ply"]);
}

#[test]
fn a_failure_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    fs::write(&path, "old").unwrap();
    let mut broken = tetrahedron();
    broken.normals.clear();
    assert!(matches!(save(&path, &broken), Err(ExportError::Malformed(_))));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert!(matches!(save(&folder.path().join("no/a.glb"), &tetrahedron()), Err(ExportError::File { .. })));
    // A folder of that name is in the way.
    let taken = folder.path().join("b.glb");
    fs::create_dir(&taken).unwrap();
    assert!(matches!(save(&taken, &tetrahedron()), Err(ExportError::File { .. })));
    assert_eq!(names(folder.path()), ["a.glb", "b.glb"]);
}

#[test]
fn an_error_of_the_writer_is_handed_on() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    for format in Format::ALL {
        let error = write(&tetrahedron(), format, &mut Full).unwrap_err();
        assert!(matches!(error, ExportError::Write(error) if error.kind() == io::ErrorKind::StorageFull));
    }
}

#[cfg(unix)]
#[test]
fn permissions_links_and_devices() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;

    // A new file gets what any new file gets.
    let (path, other) = (folder.path().join("a.stl"), folder.path().join("other"));
    fs::write(&other, "").unwrap();
    save(&path, &tetrahedron()).unwrap();
    assert_eq!(mode(&path), mode(&other));

    // A replaced one keeps its own.
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    save(&path, &Mesh::default()).unwrap();
    assert_eq!(mode(&path), 0o640);

    // A link stays a link.
    let link = folder.path().join("link.stl");
    symlink(&path, &link).unwrap();
    save(&link, &tetrahedron()).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&path).unwrap(), bytes(&tetrahedron(), Format::Stl));

    // A device stays a device.
    save_as(Path::new("/dev/null"), &tetrahedron(), Format::Stl).unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
    assert_eq!(names(folder.path()), ["a.stl", "link.stl", "other"]);
}

/// The kernel lets nobody make files there.
#[cfg(target_os = "linux")]
#[test]
fn what_the_system_refuses_is_told_without_the_temporary_name() {
    let ExportError::File { path, source } = save(Path::new("/proc/a.stl"), &tetrahedron()).unwrap_err()
    else {
        panic!("a file");
    };
    assert_eq!(path, Path::new("/proc/a.stl"));
    assert!(!source.to_string().contains(".jbt-"), "{source}");
}
