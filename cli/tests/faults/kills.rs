//! Kills at random moments: the old file or the new one, and nothing else.

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::work::{JBT, Room, TEMPORARY, example, wanted};

/// Kills with an old file, and without one.
const KILLS: u32 = 100;

#[test]
fn a_kill_at_any_moment_leaves_the_old_file_or_the_new_one() {
    if !wanted() {
        return;
    }
    let scene = example("peanut");
    let room = Room::new();
    let arguments = ["mesh", &scene, "-o", "out.stl", "--resolution", "160", "--quiet"];
    let run = |_| {
        let begin = Instant::now();
        assert!(room.command(JBT).args(arguments).status().expect("it runs").success());
        begin.elapsed()
    };
    // The first one reads the binary from the disk, and others may be disturbed.
    let whole = (0..5).map(run).min().expect("five runs");
    let new = fs::read(room.path("out.stl")).expect("a mesh");
    let mut rng = fastrand::Rng::with_seed(7);
    let (mut finished, mut temporaries) = (0, 0);
    for old in [None, Some(b"old".as_slice())] {
        for kill in 0..KILLS {
            fs::remove_file(room.path("out.stl")).ok();
            if let Some(old) = old {
                fs::write(room.path("out.stl"), old).expect("a file");
            }
            let mut child = room.command(JBT).args(arguments).stderr(Stdio::null()).spawn().expect("it runs");
            sleep(whole.mul_f64(1.3 * rng.f64()) + Duration::from_micros(rng.u64(0..500)));
            child.kill().expect("it takes a signal");
            finished += u32::from(child.wait().expect("it ends").success());
            let found = fs::read(room.path("out.stl")).ok();
            let is_whole = found.as_deref() == old || found.as_deref() == Some(new.as_slice());
            let length = found.map(|bytes| bytes.len());
            assert!(is_whole, "kill {kill} of {whole:?}: the target has {length:?} bytes");
            let mut beside = room.names();
            beside.remove("out.stl");
            assert!(beside.len() <= usize::from(old.is_some()), "kill {kill}: {beside:?}");
            assert!(beside.iter().all(|name| name.starts_with(TEMPORARY)), "kill {kill}: {beside:?}");
            temporaries += beside.len();
        }
    }
    assert!(room.command(JBT).args(arguments).status().expect("it runs").success());
    assert_eq!(
        room.names().into_iter().collect::<Vec<_>>(),
        ["out.stl"],
        "the next run removes what is left"
    );
    println!("{} kills of {whole:?}: {finished} too late, {temporaries} temporaries", 2 * KILLS);
    assert!(finished < KILLS, "most kills come in time");
}

/// Parts of a scene: more than a process may have open by default on some systems, if each had a file.
const PARTS: usize = 300;

/// All parts are written before the first one has its name, so that a kill before that leaves nothing.
#[test]
fn a_kill_while_parts_are_written_leaves_whole_files_and_nothing_else() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let part = |n: usize| format!("part \"p{n}\" {{ point {{ at ({} 0 0) radius 1 }} }}\n", 3 * n);
    let scene: String = (0..PARTS).map(part).collect();
    fs::write(room.path("scene.jbt"), format!("jbt 1\n{scene}")).expect("a file");
    let arguments =
        ["mesh", "scene.jbt", "--parts", "-o", "out_{}.stl", "--cell", "0.2", "--quiet", "--force"];
    let begin = Instant::now();
    let done = room.command(JBT).args(arguments).output().expect("it runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let whole = begin.elapsed();
    let made = |room: &Room| -> Vec<(String, Vec<u8>)> {
        let names = room.names().into_iter().filter(|name| name != "scene.jbt");
        names.map(|name| (name.clone(), fs::read(room.path(&name)).expect("a file"))).collect()
    };
    let new = made(&room);
    assert_eq!(new.len(), PARTS);
    let mut rng = fastrand::Rng::with_seed(8);
    let (mut finished, mut none) = (0, 0);
    for kill in 0..KILLS {
        new.iter().for_each(|(name, _)| drop(fs::remove_file(room.path(name))));
        let mut child = room.command(JBT).args(arguments).stderr(Stdio::null()).spawn().expect("it runs");
        sleep(whole.mul_f64(1.1 * rng.f64()));
        child.kill().expect("it takes a signal");
        finished += u32::from(child.wait().expect("it ends").success());
        let found = made(&room);
        assert!(found.iter().all(|file| new.contains(file)), "kill {kill}: {:?}", room.names());
        none += u32::from(found.is_empty());
    }
    println!("{KILLS} kills of {whole:?}: {finished} too late, {none} before the first file");
    assert!(finished < KILLS / 2, "most kills come in time");
}
