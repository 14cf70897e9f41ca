//! How much memory there is for the work, and what happens when there is no more.
//!
//! Whoever asks for memory that is not there gets no answer: the process removes the files that it has begun,
//! says so and leaves with code 3, without asking for memory on the way. Rust's own answer is to abort, which
//! leaves files and a core.
//!
//! Threads count what they ask for by themselves, and tell the others in steps of [`STEP`] bytes: small
//! requests touch nothing that threads share.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::{Cursor, Write as _};
use std::sync::atomic::{AtomicBool, AtomicIsize, Ordering};
use std::time::Duration;

use crate::signals;

/// The allocator of the process.
#[global_allocator]
static ALLOCATOR: Budgeted = Budgeted;

/// Bytes that may be in use at once.
static LIMIT: AtomicIsize = AtomicIsize::new(isize::MAX);
/// Bytes in use, as far as threads have told.
static USED: AtomicIsize = AtomicIsize::new(0);

/// Bytes that a thread keeps to itself.
const STEP: isize = 1 << 16;
/// The part of the available memory that the work may take unless people say otherwise: a half and a quarter.
const SHARE: u64 = 4;
/// The stack that the first thread has from the beginning where addresses are few: it could not be had later.
const STACK: usize = 1 << 20;
/// From so many bytes on, what is asked for has pages of its own, and the system has them again once it is
/// freed. By itself glibc raises this number with each such part that is freed, up to 32 MiB: what passes
/// leave behind then stays with the process.
const OWN_PAGES: i32 = 4 << 20;
/// The exit code of a limit.
const CODE: u8 = 3;

thread_local! {
    /// What this thread has asked for and not told yet. It needs no memory itself.
    static UNTOLD: Cell<isize> = const { Cell::new(0) };
}

/// Sets how many bytes may be in use: so many, or a share of what is available now.
pub fn limit(bytes: Option<u64>) {
    let bytes = bytes.or_else(|| available().map(|bytes| bytes / SHARE * (SHARE - 1)));
    if let Some(bytes) = bytes {
        LIMIT.store(isize::try_from(bytes).unwrap_or(isize::MAX), Ordering::Relaxed);
    }
}

/// Takes what cannot be asked for later. Comes first.
pub fn prepare() {
    give_back();
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let addresses = limits.lines().find(|line| line.starts_with("Max address space"));
    if addresses.is_some_and(|line| !line.contains("unlimited  ")) {
        take_stack();
        share_heap();
    }
}

/// Sets a parameter of the system's allocator.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn set(parameter: i32, value: i32) {
    unsafe extern "C" {
        fn mallopt(parameter: i32, value: i32) -> i32;
    }
    // SAFETY: it is glibc's, with this signature, and there is one thread. A refusal changes nothing.
    unsafe { mallopt(parameter, value) };
}

/// Other allocators have rules of their own.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
const fn set(_: i32, _: i32) {}

/// Large parts go back to the system.
fn give_back() {
    const M_MMAP_THRESHOLD: i32 = -3;
    set(M_MMAP_THRESHOLD, OWN_PAGES);
}

/// All threads take from one heap. By itself glibc reserves 64 MiB of addresses for each thread; where it
/// does not get them, each request of such a thread becomes a mapping of its own, after four tries: seconds
/// in place of a fifth of one.
fn share_heap() {
    const M_ARENA_MAX: i32 = -8;
    set(M_ARENA_MAX, 1);
}

/// Lets the system find pages for the stack.
#[inline(never)]
fn take_stack() {
    let mut pages = [0_u8; STACK];
    std::hint::black_box(&mut pages);
}

/// Reads a number of bytes: 2000000000, 512M, 1.5G.
pub fn bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(char, u32); 4] = [('K', 10), ('M', 20), ('G', 30), ('T', 40)];
    let unit = UNITS.iter().find(|(letter, _)| text.to_ascii_uppercase().ends_with(*letter));
    let (number, shift) = unit.map_or((text, 0), |(_, shift)| (&text[..text.len() - 1], *shift));
    let number: f64 = number.parse().map_err(|_| "expected bytes, as 2000000000, 512M or 1.5G".to_owned())?;
    let bytes = number * (1_u64 << shift) as f64;
    let fits = bytes.is_finite() && (1.0..9e18).contains(&bytes);
    if fits { Ok(bytes as u64) } else { Err("expected at least one byte".to_owned()) }
}

/// Bytes that the system and its groups of processes leave to this one.
fn available() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let machine = || {
        let text = read("/proc/meminfo")?;
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
        line.trim().trim_end_matches(" kB").parse::<u64>().ok()?.checked_mul(1 << 10)
    };
    let group = |limit: &str, used: &str| Some(number(limit)?.saturating_sub(number(used)?));
    let groups = [
        group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        group("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ];
    groups.into_iter().flatten().chain(machine()).min()
}

/// The system's memory, as far as the limit goes.
struct Budgeted;

/// Counts bytes more or less. Leaves if there are too many.
#[inline]
fn count(bytes: isize) {
    let sum = UNTOLD.try_with(|untold| {
        let sum = untold.get() + bytes;
        untold.set(if sum.abs() < STEP { sum } else { 0 });
        sum
    });
    let sum = sum.unwrap_or(bytes);
    if sum.abs() >= STEP {
        tell(sum);
    }
}

#[cold]
fn tell(bytes: isize) {
    let used = USED.fetch_add(bytes, Ordering::Relaxed) + bytes;
    if bytes > 0 && used > LIMIT.load(Ordering::Relaxed) {
        leave();
    }
}

/// Refuses to answer null.
#[inline]
fn found(memory: *mut u8) -> *mut u8 {
    if memory.is_null() {
        leave();
    }
    memory
}

// SAFETY: memory comes from `System`, which keeps the contract for the same layouts; counting touches none.
// Nobody is answered null, which the contract allows: `leave` does not return.
unsafe impl GlobalAlloc for Budgeted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract.
        found(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract.
        found(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        // SAFETY: the caller keeps the contract.
        found(unsafe { System.realloc(memory, layout, size) })
    }
}

/// Ends the process: there is no more memory.
#[cold]
#[inline(never)]
fn leave() -> ! {
    static LEAVING: AtomicBool = AtomicBool::new(false);
    while LEAVING.swap(true, Ordering::AcqRel) {
        // Another thread ends the process.
        std::thread::sleep(Duration::from_secs(1));
    }
    signals::remove_begun();
    let mut message = [0; 160];
    let mut line = Cursor::new(&mut message[..]);
    let limit = LIMIT.load(Ordering::Relaxed);
    let _ = match USED.load(Ordering::Relaxed) > limit {
        true => writeln!(line, "jbt: limit: the work needs more than {limit} bytes of memory; see --memory"),
        false => writeln!(line, "jbt: limit: the system has no more memory for the work"),
    };
    let written = line.position() as usize;
    end(&message[..written])
}

/// Says a last word, and ends the process without asking for memory or waiting for a lock.
#[cfg(unix)]
fn end(message: &[u8]) -> ! {
    use std::os::fd::BorrowedFd;
    // SAFETY: nobody closes the standard error of this process.
    let error = unsafe { BorrowedFd::borrow_raw(2) };
    let _ = rustix::io::write(error, message);
    signal_hook::low_level::exit(i32::from(CODE))
}

/// Says a last word, and ends the process.
#[cfg(not(unix))]
fn end(message: &[u8]) -> ! {
    let _ = std::io::stderr().write_all(message);
    std::process::exit(i32::from(CODE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_for_people() {
        assert_eq!(bytes("2000000000"), Ok(2_000_000_000));
        assert_eq!(bytes("512M"), Ok(512 << 20));
        assert_eq!(bytes("1.5g"), Ok(3 << 29));
        for bad in ["", "M", "-1", "0", "nan", "inf", "1e99", "1 G x", "é"] {
            assert!(bytes(bad).is_err(), "{bad}");
        }
    }
}
