//! Want of memory ends in an exit code: never in an abort, never in a file that is left.
#![cfg(target_os = "linux")]

use std::fs;
use std::process::Command;

use crate::folder::Folder;

const HERO: &str = include_str!("../../../examples/hero.jbt");

/// Fifty limits of the address space, from 40 to 200 MB.
#[test]
fn without_memory_there_is_code_3() {
    let folder = Folder::new().with("hero.jbt", HERO);
    let mut seen = [0; 2];
    for step in 0..50 {
        let kilobytes = 40_000 + step * 160_000 / 49;
        let script = format!("ulimit -c 0; ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
        let ran = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_jbt")])
            .args(["-q", "mesh", "hero.jbt", "--resolution", "32", "-o", "hero.stl"])
            .current_dir(folder.path("."))
            .output()
            .expect("a shell");
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
