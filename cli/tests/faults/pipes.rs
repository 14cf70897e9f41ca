//! Pipes that are closed, terminals and homes that are not there.

use std::fs;

use crate::work::{Room, code, example, told, wanted};

#[test]
fn closed_pipes_are_no_crash() {
    if !wanted() {
        return;
    }
    let scene = example("peanut");
    let room = Room::new();
    fs::write(room.path("p.csv"), "x,y,z\n0,0,0\n").expect("a file");
    let outputs = [
        format!("mesh {scene} -o - --format obj --resolution 64"),
        format!("convert {scene} -o -"),
        format!("eval {scene} --points p.csv -o -"),
        format!("show {scene} --stage asm"),
        "completions zsh".to_owned(),
        "--help".to_owned(),
    ];
    for command in outputs {
        // A reader that goes away at once, or after a byte.
        for reader in ["true", "head -c 1"] {
            let line = format!("{{ $JBT {command} 2>told; echo $? >code; }} | {reader} >/dev/null");
            room.shell(&line);
            let told = fs::read_to_string(room.path("told")).expect("messages");
            assert_eq!(
                fs::read_to_string(room.path("code")).expect("a code"),
                "0\n",
                "{command} | {reader}: {told}"
            );
        }
        // No standard output at all: Rust puts /dev/null there.
        assert!([0, 4].contains(&code(&room.shell(&format!("$JBT {command} >&-")))), "{command}");
    }
    for (line, expected) in [
        (format!("$JBT check {scene} 2>&-"), 0),
        (format!("$JBT mesh {scene} -o out.stl --resolution 8 >&- 2>&- <&-"), 0),
        ("$JBT check - <&-".to_owned(), 1),
        (format!("$JBT eval {scene} --points - -o - <&-"), 1),
        ("$JBT nothing 2>&-".to_owned(), 2),
    ] {
        let output = room.shell(&line);
        assert_eq!(code(&output), expected, "{line}: {}", told(&output));
    }
}

#[test]
fn neither_a_terminal_nor_a_home_is_needed() {
    if !wanted() {
        return;
    }
    let scene = example("hero");
    let room = Room::new();
    let lines = [
        format!("setsid $JBT mesh {scene} -o a.stl --resolution 32 </dev/null"),
        format!("env -i $JBT mesh {scene} -o b.stl --resolution 32"),
        format!("env -u HOME -u TERM -u LANG TMPDIR=/nowhere $JBT mesh {scene} -o c.stl --resolution 32"),
    ];
    for line in lines {
        let output = room.shell(&line);
        assert_eq!(code(&output), 0, "{line}: {}", told(&output));
        assert!(!output.stderr.contains(&0x1b), "{line} speaks to a terminal: {}", told(&output));
    }
    let [a, b, c] = ["a.stl", "b.stl", "c.stl"].map(|name| fs::read(room.path(name)).expect("a mesh"));
    assert!(a == b && b == c);
}
