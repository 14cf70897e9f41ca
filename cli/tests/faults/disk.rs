//! Disks that are full: code 4, the old file, nothing beside it.

use std::fs;
use std::process::Command;

use crate::work::{JBT, Room, code, example, told, wanted};

#[test]
fn a_file_that_may_not_grow_is_code_4_and_the_old_file_stays() {
    if !wanted() {
        return;
    }
    let scene = example("peanut");
    let room = Room::new();
    let runs = [
        ("mesh", "out.stl", "--resolution 48"),
        ("mesh", "out.glb", "--resolution 48"),
        ("mesh", "out.3mf", "--resolution 48"),
        ("render", "out.png", "--size 160x120 --quality draft"),
        ("sample", "out.npy", "--resolution 24"),
        ("contour", "out.svg", "--plane z=0"),
    ];
    for (command, file, more) in runs {
        let line = format!("exec $JBT {command} {scene} -o {file} {more} --quiet");
        assert_eq!(code(&room.shell(&line)), 0, "{line}");
        let new = fs::read(room.path(file)).expect("a file");
        // `ulimit -f` counts blocks of 512 bytes, in sh.
        let blocks = new.len() / 512;
        for limit in [0, 1, blocks / 3, blocks / 2, blocks.saturating_sub(1), blocks + 2] {
            fs::write(room.path(file), "old").expect("a file");
            let output = room.shell(&format!("ulimit -f {limit}; {line}"));
            let found = fs::read(room.path(file)).expect("a file");
            let fits = limit * 512 >= new.len();
            let expected: (i32, &[u8]) = if fits { (0, &new) } else { (4, b"old") };
            assert_eq!(
                (code(&output), found.as_slice() == expected.1),
                (expected.0, true),
                "{limit}: {}",
                told(&output)
            );
            assert_eq!(room.names().into_iter().collect::<Vec<_>>(), [file], "{limit} blocks");
        }
        fs::remove_file(room.path(file)).expect("it was there");
    }
}

#[test]
fn a_full_disk_is_code_4_and_the_old_file_stays() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let disk = room.path("disk");
    fs::create_dir(&disk).expect("a folder");
    let disk = disk.to_str().expect("text");
    let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", "size=64k", "jbt", disk]).output();
    if !mounted.is_ok_and(|output| output.status.success()) {
        jbt_testkit::skip::skip("no right to mount a small file system");
        return;
    }
    fs::write(room.path("disk/out.stl"), "old").expect("a file");
    let line = format!("$JBT mesh {} -o disk/out.stl --resolution 64 --quiet", example("peanut"));
    let output = room.shell(&line);
    let names: Vec<_> =
        fs::read_dir(disk).expect("a folder").map(|entry| entry.expect("an entry").file_name()).collect();
    let found = fs::read(room.path("disk/out.stl")).expect("a file");
    let unmounted = Command::new("umount").arg(disk).status();
    assert!(unmounted.is_ok_and(|status| status.success()));
    assert_eq!((code(&output), found.as_slice()), (4, b"old".as_slice()), "{}", told(&output));
    assert_eq!(names, ["out.stl"]);
}

#[test]
fn every_command_says_that_dev_full_is_full() {
    if !wanted() {
        return;
    }
    let scene = example("peanut");
    let room = Room::new();
    fs::write(room.path("p.csv"), "x,y,z\n0,0,0\n").expect("a file");
    let mut commands = vec![
        format!("eval {scene} --points p.csv -o -"),
        format!("count {scene} --resolution 8"),
        format!("stats {scene} --depth 2"),
        format!("show {scene} --stage ir"),
        format!("check {scene} --json"),
        format!("convert {scene} -o -"),
        "completions bash".to_owned(),
        "--help".to_owned(),
        "mesh --help".to_owned(),
        format!("render {scene} -o - --format png --size 32x32 --quality draft"),
        format!("contour {scene} -o - --format svg"),
        format!("sample {scene} -o - --format npy --resolution 8"),
    ];
    for format in ["glb", "ply", "obj", "stl", "3mf", "usda"] {
        commands.push(format!("mesh {scene} -o - --format {format} --resolution 16"));
    }
    for command in commands {
        let full = fs::File::options().write(true).open("/dev/full").expect("Linux has it");
        let output = room.command(JBT).args(command.split(' ')).stdout(full).output().expect("it runs");
        assert_eq!(code(&output), 4, "{command}\n{}", told(&output));
    }
}
