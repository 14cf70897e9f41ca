//! Little memory and small stacks: an answer, or code 3.

use std::fs;

use crate::work::{Room, code, example, told, wanted};

/// Whether the binary answers for its memory.
fn knows_memory(room: &Room) -> bool {
    String::from_utf8_lossy(&room.shell("$JBT mesh --help").stdout).contains("--memory")
}

#[test]
fn any_limit_of_memory_is_an_answer_or_code_3() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    if !knows_memory(&room) {
        jbt_testkit::skip::skip("this binary has no --memory, so want of memory ends it");
        return;
    }
    let runs = [
        format!("mesh {} -o out.stl --resolution 160", example("hero")),
        format!("render {} -o out.png --size 320x240", example("hero")),
    ];
    for run in runs {
        let mut codes = Vec::new();
        for step in 0..50_u32 {
            let megabytes = f64::from(40 + 160 * step / 49);
            let kilobytes = (megabytes * 1000.0) as u32;
            let output = room.shell(&format!("ulimit -v {kilobytes}; exec $JBT {run} --force --quiet"));
            let found = code(&output);
            assert!([0, 3].contains(&found), "{megabytes} MB: code {found} of {run}\n{}", told(&output));
            let left = room.names().into_iter().filter(|name| !name.starts_with("out.")).count();
            assert_eq!(left, 0, "{megabytes} MB: {:?}", room.names());
            codes.push(found);
        }
        println!(
            "{run}: {} of {} answers, the others code 3",
            codes.iter().filter(|code| **code == 0).count(),
            codes.len()
        );
        room.names().iter().for_each(|name| fs::remove_file(room.path(name)).expect("it was there"));
    }
}

#[test]
fn small_stacks_are_enough() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let reference = room.shell(&format!("$JBT mesh {} -o a.stl --resolution 24 --force", example("bonsai")));
    assert_eq!(code(&reference), 0, "{}", told(&reference));
    let expected = fs::read(room.path("a.stl")).expect("a mesh");
    for kilobytes in [1024, 512, 256] {
        for name in ["bonsai", "hero", "succulent"] {
            let scene = example(name);
            for run in [
                format!("check {scene}"),
                format!("mesh {scene} -o b.stl --resolution 24 --force"),
                format!("render {scene} -o b.png --size 48x48 --quality draft --force"),
            ] {
                let line = format!("ulimit -s {kilobytes}; exec $JBT {run}");
                let output = room.shell(&line);
                assert_eq!(code(&output), 0, "{line}\n{}", told(&output));
            }
            let is_same = name != "bonsai" || fs::read(room.path("b.stl")).expect("a mesh") == expected;
            assert!(is_same, "{kilobytes} KiB of stack change a mesh");
        }
    }
}
