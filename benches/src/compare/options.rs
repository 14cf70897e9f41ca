//! What applies to every case, and the samples.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::contest::Effort;

/// What applies to every case.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Less of everything: a minute for all cases.
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
            (Duration::from_secs(2), Duration::from_secs(2), Duration::MAX)
        };
        Effort { budget, patience, endurance }
    }
}

/// A file of the samples, if it is here: in the folder that `JBT_SAMPLES` names, or beside the repository.
///
/// # Errors
///
/// Whatever the system says of a file that cannot be read, in words for people.
pub fn sample(name: &str) -> Result<Vec<u8>, String> {
    let root = std::env::var_os("JBT_SAMPLES")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/samples"), PathBuf::from);
    std::fs::read(root.join(name))
        .map_err(|error| format!("no {name} in the folder that JBT_SAMPLES names: {error}"))
}
