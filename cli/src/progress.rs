//! A progress bar, for people who have waited for half a second.

use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use jbt::Job;

use crate::signals;

/// How long nobody needs a bar.
const PATIENCE: Duration = Duration::from_millis(500);
/// Steps of the bar.
const STEPS: f32 = 1000.0;

/// How far the work is. It is shown on the standard error if that is a terminal, and removed when this is
/// dropped.
pub struct ProgressLine {
    start: Instant,
    what: &'static str,
    shown: bool,
    bar: Option<ProgressBar>,
}

impl ProgressLine {
    /// The beginning of some work.
    pub fn new(what: &'static str, quiet: bool) -> Self {
        Self { start: Instant::now(), what, shown: !quiet && io::stderr().is_terminal(), bar: None }
    }

    /// Does the work, shows how far it is, and stops it where a signal comes.
    pub fn run<'a, T, E>(&'a mut self, job: Job<'a, T, E>) -> Result<T, E> {
        job.on_progress(|part| self.set(part)).cancel(signals::token()).run()
    }

    /// The part of the work that is done, from 0 to 1.
    pub fn set(&mut self, fraction: f32) {
        if !self.shown || self.start.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::new(STEPS as u64).with_elapsed(self.start.elapsed());
            if let Ok(style) = ProgressStyle::with_template("{msg} {bar:40} {percent:>3}%  {eta} left") {
                bar.set_style(style);
            }
            bar.set_message(self.what);
            bar
        });
        bar.set_position((fraction * STEPS) as u64);
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
