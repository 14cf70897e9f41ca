//! Want of memory ends in an exit code: never in an abort, never in a file that is left.
#![cfg(target_os = "linux")]

use std::fs;
use std::process::{Command, Output};

use crate::folder::Folder;

const HERO: &str = include_str!("../../../examples/hero.jbt");

/// What became of a command line in an address space of so many kilobytes.
fn within(kilobytes: u32, folder: &Folder, arguments: &[&str]) -> Output {
    let script = format!("ulimit -c 0; ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, env!("CARGO_BIN_EXE_jbt")]).args(arguments).current_dir(folder.path("."));
    shell.output().expect("a shell")
}

/// Fifty limits of the address space, from the smallest in which the program starts to 150 MB more; the small
/// ones, in which a mesh ends in the middle, are close to each other.
#[test]
fn without_memory_there_is_code_3() {
    let folder = Folder::new().with("hero.jbt", HERO);
    let starts = |kilobytes: &u32| within(*kilobytes, &folder, &["--version"]).status.success();
    let least = (10_000..1_000_000).step_by(1000).find(starts).expect("a limit in which the program starts");
    let mut seen = [0; 2];
    for step in 0..50 {
        let kilobytes = least + 64 * step * step;
        let ran =
            within(kilobytes, &folder, &["-q", "mesh", "hero.jbt", "--resolution", "32", "-o", "hero.stl"]);
        let told = String::from_utf8_lossy(&ran.stderr);
        match ran.status.code() {
            Some(0) => seen[0] += 1,
            Some(3) => {
                assert!(told.contains("jbt: limit: the system has no more memory"), "{kilobytes}: {told}");
                seen[1] += 1;
            }
            _ => panic!("{kilobytes} KB: {}, {told}", ran.status),
        }
        let left = fs::read_dir(folder.path(".")).unwrap();
        let left =
            left.filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().starts_with('.'));
        assert_eq!(left.count(), 0, "{kilobytes} KB");
    }
    assert!(
        seen.iter().all(|&seen| seen > 0),
        "limits at which it works, and at which it does not: {seen:?}"
    );
}

/// A lattice that would take all the memory of the machine is bounded by what people allow.
#[test]
fn people_say_how_much_memory_there_is() {
    let folder = Folder::new().with("hero.jbt", HERO).with("hero.stl", "old");
    let mesh = |memory: &str| {
        folder.jbt(&["-q", "mesh", "hero.jbt", "--cell", "1e-4", "--memory", memory, "-o", "hero.stl"])
    };
    mesh("60M").code(3).says("jbt: limit: the work needs more than 62914560 bytes of memory; see --memory");
    assert_eq!(folder.read("hero.stl"), b"old");
    mesh("much").code(2).says("expected bytes, as 2000000000, 512M or 1.5G");
}
