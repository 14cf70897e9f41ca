//! The longest time between two looks at whether work is still wanted.
//!
//! ```text
//! work     |--------- look ------ look ------------------- look ----|
//!                                      `- the longest gap -'
//! ```
//!
//! A look is a question to the watch that is offered around the work, or a call of a job's hook of progress,
//! behind which tokens are asked. Times are those of the processor that the one thread that works took, so
//! that other work on the machine does not count. Linux alone tells them, in steps of some milliseconds;
//! elsewhere there are none. `JBT_GAPS=1` prints where a look stands that ends a gap of more than 50 ms.

use std::backtrace::Backtrace;
use std::fs;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use jbt_ir::watch;

/// A gap that is told.
const LONG: Duration = Duration::from_millis(50);

/// The looks of one piece of work.
#[derive(Clone, Debug)]
pub struct WorkGaps(Arc<Mutex<SeenGaps>>);

#[derive(Debug)]
struct SeenGaps {
    /// The time of the last look.
    last: Duration,
    longest: Duration,
}

impl WorkGaps {
    /// The longest gap of work on this thread, which is given what hears of progress.
    pub fn longest(work: impl FnOnce(Self)) -> Duration {
        let gaps = Self(Arc::new(Mutex::new(SeenGaps { last: taken(), longest: Duration::ZERO })));
        let (told, asked) = (gaps.clone(), gaps.clone());
        let asked = move || {
            asked.look();
            true
        };
        watch::offer(Arc::new(asked), || work(told));
        gaps.look();
        gaps.0.lock().unwrap_or_else(PoisonError::into_inner).longest
    }

    /// A look.
    pub fn look(&self) {
        let now = taken();
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let gap = now.saturating_sub(seen.last);
        #[allow(clippy::print_stderr, reason = "it is asked for")]
        if gap > LONG && std::env::var_os("JBT_GAPS").is_some() {
            eprintln!("{gap:.1?} until\n{}", Backtrace::force_capture());
        }
        seen.longest = seen.longest.max(gap);
        seen.last = now;
    }
}

/// The time of a processor that this thread has taken.
fn taken() -> Duration {
    let told = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = told.split_whitespace().next().and_then(|number| number.parse().ok());
    Duration::from_nanos(nanoseconds.unwrap_or(0))
}
