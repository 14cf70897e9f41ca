//! What signals do: work stops at its next hook, what was begun is removed, and the exit code says which
//! signal it was, 128 and its number. Whatever asks no hook is stopped a moment later, and leaves no file.
//!
//! A closed pipe and a file beyond `ulimit -f` are answers of the system to those who write, and no reason to
//! be killed by it: Rust itself ignores SIGPIPE, and [`install`] does so with SIGXFSZ.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use jbt::CancelToken;

/// The number of the first signal that has come; 0 before.
static CAUGHT: AtomicI32 = AtomicI32::new(0);
/// What all work of this process is cancelled by: signals are sent to a process.
static TOKEN: LazyLock<CancelToken> = LazyLock::new(CancelToken::new);
/// Temporary names that have to go if the process ends. Whoever holds the lock is not stopped meanwhile.
static BEGUN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Milliseconds that a process without memory waits for the list of them.
const TRIES: usize = 300;
/// Files that a command begins: room for their names is there from the beginning.
const FILES: usize = 16;

/// Cancelled by the first signal.
pub fn token() -> &'static CancelToken {
    &TOKEN
}

/// The number of the signal that has stopped the work, if one has.
pub fn caught() -> Option<i32> {
    Some(CAUGHT.load(Ordering::Acquire)).filter(|&signal| signal != 0)
}

/// Refuses to go on once a signal has come.
pub fn check() -> io::Result<()> {
    match caught() {
        // Not `Interrupted`, after which writers would try again.
        Some(signal) => Err(io::Error::other(format!("stopped by {}", name(signal)))),
        None => Ok(()),
    }
}

/// Notes a temporary name.
pub fn begin(temporary: &Path) {
    let temporary = temporary.to_owned();
    let mut begun = begun();
    begun.push(temporary);
}

/// Removes what has been begun, for a process that has no more memory. None is asked for.
pub fn remove_begun() {
    for _ in 0..TRIES {
        match BEGUN.try_lock() {
            Ok(files) => {
                for temporary in files.iter() {
                    let _ = std::fs::remove_file(temporary);
                }
                // Held to the end: no file gets its name any more.
                std::mem::forget(files);
                return;
            }
            // This thread may hold it: then its file has a name already, or gets none.
            Err(_) => std::thread::sleep(Duration::from_millis(1)),
        }
    }
}

/// Puts files in their places; no signal ends the process on the way.
pub fn unstopped<T>(act: impl FnOnce() -> T) -> T {
    let _guard = begun();
    act()
}

/// The exit code that shells give to a program that a signal has stopped.
pub fn code(signal: i32) -> u8 {
    u8::try_from(128 + signal).unwrap_or(u8::MAX)
}

fn begun() -> MutexGuard<'static, Vec<PathBuf>> {
    BEGUN.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(unix)]
pub use on_unix::{install, name};

#[cfg(unix)]
mod on_unix {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::{exit, signal_name};

    use super::*;

    /// How long the work has to come to a hook. Nothing is lost if it does not.
    const PATIENCE: Duration = Duration::from_millis(40);

    /// Listens to signals from now on. Where that cannot be had they do what they do to any program.
    pub fn install() {
        begun().reserve(FILES);
        let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
        // `nohup` and shells without job control have programs ignore a signal that is not meant for them.
        let ignored = ignored();
        let is_heard = |signal: &i32| ignored >> (signal - 1) & 1 == 0;
        let heard: Vec<i32> = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(is_heard).collect();
        let Ok(mut signals) = Signals::new(heard) else { return };
        let listen = move || {
            let Some(signal) = signals.forever().next() else { return };
            CAUGHT.store(signal, Ordering::Release);
            TOKEN.cancel();
            std::thread::sleep(PATIENCE);
            // Held to the end: no file gets its name any more.
            let files = begun();
            for temporary in files.iter() {
                let _ = std::fs::remove_file(temporary);
            }
            exit(i32::from(code(signal)));
        };
        // Without a thread signals are caught and nobody listens: that is told before it can happen.
        if std::thread::Builder::new().name("signals".to_owned()).spawn(listen).is_err() {
            for signal in [SIGINT, SIGTERM, SIGHUP] {
                let at_once = Arc::new(AtomicBool::new(true));
                let _ =
                    signal_hook::flag::register_conditional_shutdown(signal, code(signal).into(), at_once);
            }
        }
    }

    /// The signals that the process was started with ignored: the lowest bit is that of signal 1.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
    }

    /// What people call a signal.
    pub fn name(signal: i32) -> String {
        signal_name(signal).map_or_else(|| format!("signal {signal}"), str::to_owned)
    }
}

/// Signals are a matter of Unix: elsewhere the system ends the process.
#[cfg(not(unix))]
pub fn install() {}

/// What people call a signal.
#[cfg(not(unix))]
pub fn name(signal: i32) -> String {
    format!("signal {signal}")
}
