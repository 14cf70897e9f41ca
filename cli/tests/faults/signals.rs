//! Signals at random moments: the old file or the new one, nothing beside it, and the code of the signal.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::work::{JBT, Room, code, example, told, wanted};

/// Signals of each kind, with an old file and without one.
const SIGNALS: u32 = 50;

#[test]
fn a_signal_at_any_moment_leaves_whole_files_and_nothing_else() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let scene = example("peanut");
    // What runs these tests in the background may have its children ignore signals.
    let hearing = ["--default-signal=INT,TERM", JBT];
    let arguments = ["mesh", &scene, "-o", "out.stl", "--resolution", "160", "--quiet"];
    let run = |_| {
        let begin = Instant::now();
        let done = room.command("env").args(hearing).args(arguments).output().expect("it runs");
        assert!(done.status.success(), "{}", told(&done));
        begin.elapsed()
    };
    let whole = (0..5).map(run).min().expect("five runs");
    let new = fs::read(room.path("out.stl")).expect("a mesh");
    let mut rng = fastrand::Rng::with_seed(11);
    let (mut stopped, mut finished, mut early) = (0, 0, 0);
    for (signal, stop) in [("-INT", 130), ("-TERM", 143)] {
        for old in [None, Some(b"old".as_slice())] {
            for round in 0..SIGNALS {
                fs::remove_file(room.path("out.stl")).ok();
                if let Some(old) = old {
                    fs::write(room.path("out.stl"), old).expect("a file");
                }
                let mut work = room.command("env");
                let child =
                    work.args(hearing).args(arguments).stderr(Stdio::piped()).spawn().expect("it runs");
                sleep(whole.mul_f64(1.2 * rng.f64()) + Duration::from_micros(rng.u64(0..500)));
                let sent = Command::new("kill").args([signal, &child.id().to_string()]).output();
                sent.expect("kill runs");
                let output = child.wait_with_output().expect("it ends");
                let ended = code(&output);
                // Before the process listens, the signal ends it as it does by default.
                let number = if stop == 130 { -2 } else { -15 };
                match ended {
                    0 => finished += 1,
                    ended if ended == stop => stopped += 1,
                    ended if ended == number => early += 1,
                    ended => panic!("{signal} {round}: code {ended}, {}", told(&output)),
                }
                let found = fs::read(room.path("out.stl")).ok();
                let length = found.as_ref().map(Vec::len);
                if ended == 0 {
                    assert!(found.as_ref() == Some(&new), "{signal} {round}: {length:?} bytes are no mesh");
                } else {
                    let is_whole = found.as_deref() == old || found.as_deref() == Some(new.as_slice());
                    assert!(is_whole, "{signal} {round}: the target has {length:?} bytes");
                }
                let mut beside = room.names();
                beside.remove("out.stl");
                assert!(beside.is_empty(), "{signal} {round}: {beside:?}");
            }
        }
    }
    println!(
        "{} signals in {whole:?}: {stopped} stopped, {finished} too late, {early} too early",
        4 * SIGNALS
    );
    assert!(stopped > SIGNALS, "most signals come in time");
}
