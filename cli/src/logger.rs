//! The log of the library: its warnings go to the standard error, like ours.

use log::{LevelFilter, Log, Metadata, Record};

use crate::output::warn;

struct Logger;

impl Log for Logger {
    fn enabled(&self, _metadata: &Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &Record<'_>) {
        // Dependencies log too, about matters of theirs.
        if record.target().starts_with("jbt") {
            warn(&record.args().to_string());
        }
    }

    fn flush(&self) {}
}

/// Listens to warnings from here on.
pub fn install(quiet: bool) {
    if log::set_logger(&Logger).is_ok() {
        log::set_max_level(if quiet { LevelFilter::Off } else { LevelFilter::Warn });
    }
}
