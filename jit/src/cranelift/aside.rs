//! Work that looks at no watch, on a thread that nobody waits for once the caller is stopped.
//!
//! Cranelift compiles a function as a whole and asks nobody on the way: a second for a long one. Its thread
//! ends with its work, and what it has made is dropped.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use jbt_ir::watch::{Watches, look_now};

/// Between two looks of the caller.
const LOOKS: Duration = Duration::from_millis(5);

/// Does work aside, if somebody may stop the caller; else, and where no thread can be had, here.
pub(super) fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    if !Watches::present().may_stop() {
        return work();
    }
    // A thread that cannot be started would take the work with it.
    let kept = Arc::new(Mutex::new(Some(work)));
    let take = |kept: &Mutex<Option<_>>| kept.lock().unwrap_or_else(PoisonError::into_inner).take();
    let (tell, told) = sync_channel(1);
    let given = Arc::clone(&kept);
    let run = move || {
        if let Some(work) = take(&given) {
            // The caller may have gone.
            let _ = tell.send(work());
        }
    };
    if thread::Builder::new().name("cranelift".to_owned()).spawn(run).is_err() {
        let work = take(&kept).expect("no thread has it");
        return work();
    }
    loop {
        match told.recv_timeout(LOOKS) {
            Ok(answer) => return answer,
            Err(RecvTimeoutError::Timeout) => look_now(),
            Err(RecvTimeoutError::Disconnected) => panic!("the work panicked on its thread"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Instant;

    use jbt_ir::watch::{Ended, offer, stoppable};

    use super::*;

    #[test]
    fn nobody_waits_for_work_that_is_not_wanted() {
        assert_eq!(aside(|| 1), 1, "nobody can stop it");
        let wanted = Arc::new(AtomicBool::new(true));
        let asked = Arc::clone(&wanted);
        let is_wanted = move || asked.load(Ordering::Relaxed);
        offer(Arc::new(is_wanted), || {
            assert_eq!(stoppable(|| aside(|| 2)), Ok(2));
            let (go_on, wait) = sync_channel::<()>(1);
            let start = Instant::now();
            let stopped = stoppable(|| {
                aside(move || {
                    wanted.store(false, Ordering::Relaxed);
                    // As long as the test runs.
                    let _ = wait.recv();
                });
            });
            assert_eq!(stopped, Err(Ended::Stopped), "after {:?}", start.elapsed());
            drop(go_on);
        });
    }
}
