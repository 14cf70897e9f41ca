//! What applies to every case.

use std::time::Duration;

use super::contest::Effort;

/// What applies to every case.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Less of everything: two minutes for all cases.
    pub quick: bool,
    /// Threads of meshing cases; the others run on one.
    pub threads: usize,
}

impl Options {
    /// How long to measure.
    pub(super) fn effort(self) -> Effort {
        let (budget, patience, endurance) = if self.quick {
            (Duration::from_millis(200), Duration::from_millis(40), Duration::from_secs(5))
        } else {
            (Duration::from_secs(4), Duration::from_secs(2), Duration::MAX)
        };
        Effort { budget, patience, endurance }
    }
}
