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

/// What takes long: all commands, on each engine where one may be chosen. A scene of a hundred thousand nodes
/// is long read, checked and lowered.
const LONG: [&str; 11] = [
    "check large.jbt",
    "convert large.jbt -o out.jbt",
    "diff large.jbt other.jbt",
    "count large.jbt",
    "stats large.jbt",
    "show large.jbt --stage schedule",
    "mesh HERO -o out.stl --resolution 2000 --engine ENGINE",
    "render HERO -o out.png --size 3000x3000 --quality best --engine ENGINE",
    "sample HERO -o out.npy --resolution 1000 --engine ENGINE",
    "contour HERO -o out.svg --resolution 20000 --engine ENGINE",
    "mesh large.jbt -o out.stl --resolution 1000 --engine ENGINE",
];

/// A time in which a process has ended on any machine: figures are printed.
const ENDED: Duration = Duration::from_secs(2);

#[test]
fn signals_stop_all_commands_on_all_engines() {
    if !wanted() {
        return;
    }
    let room = Room::new();
    let mut rng = fastrand::Rng::with_seed(3);
    let mut leaf = |_| {
        let [x, y, z, radius] = std::array::from_fn(|_| rng.f64());
        format!("point {{ at ({x} {y} {z}) radius {} }}\n", 0.01 + 0.05 * radius)
    };
    let leaves: String = (0..100_000).map(&mut leaf).collect();
    for (name, more) in [("large.jbt", ""), ("other.jbt", "ring { ring_radius 1 radius 1 }")] {
        fs::write(room.path(name), format!("jbt 1 sum {{ {leaves} {more} }}")).expect("a file");
    }
    let mut worst = Vec::new();
    let mut rng = fastrand::Rng::with_seed(4);
    for line in LONG {
        let engines: &[&str] = if line.contains("ENGINE") { &["scalar", "lanes", "jit"] } else { &[""] };
        for engine in engines {
            let line = line.replace("HERO", &example("hero")).replace("ENGINE", engine);
            let (mut longest, mut stopped) = (Duration::ZERO, 0);
            for _ in 0..6 {
                let before = room.names();
                let mut work = room.command("env");
                work.args(["--default-signal=INT", JBT, "--quiet"]).args(line.split(' '));
                work.stdout(Stdio::null()).stderr(Stdio::null());
                let mut child = work.spawn().expect("it runs");
                sleep(Duration::from_millis(rng.u64(15..400)));
                let sent = Instant::now();
                // What has ended already is not there any more, and that is fine.
                Command::new("kill").args(["-INT", &child.id().to_string()]).output().expect("kill runs");
                let status = child.wait().expect("it ends");
                if status.code() == Some(130) {
                    longest = longest.max(sent.elapsed());
                    stopped += 1;
                    assert_eq!(room.names(), before, "{line}");
                }
                for name in room.names().into_iter().filter(|name| name.starts_with("out")) {
                    fs::remove_file(room.path(&name)).expect("it is ours");
                }
            }
            worst.push((longest, line.split(' ').next().expect("a command").to_owned(), *engine, stopped));
            assert!(longest < ENDED, "{line}: {longest:?}");
        }
    }
    worst.sort();
    let stopped: u32 = worst.iter().map(|it| it.3).sum();
    println!("{stopped} signals, of {} works; the slowest: {:?}", worst.len(), &worst[worst.len() - 4..]);
    assert!(stopped > 60, "most signals come in time");
}
