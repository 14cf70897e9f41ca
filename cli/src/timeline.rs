//! Timelines: what each thread did from when to when, as a file of trace events.
//!
//! The stages of the library are spans of the crate `tracing`. The file has the format of Chrome's trace
//! viewer, which Perfetto reads as well: an array of events, of which `B` begins and `E` ends a span.

use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use tracing_chrome::ChromeLayerBuilder;
use tracing_subscriber::layer::SubscriberExt as _;

use crate::failure::Failure;
use crate::output::{Destination, Output, check_place};
use crate::standard::is_standard;

/// The events, as long as the work goes on.
#[derive(Clone, Default)]
struct Events(Arc<Mutex<Vec<u8>>>);

impl Write for Events {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Does some work, and writes its timeline; also if the work fails, for as far as it came.
pub fn record(path: &Path, work: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    if is_standard(path) {
        return Err(Failure::Usage("a timeline goes to a file: --trace FILE.json".to_owned()));
    }
    check_place(path)?;
    let events = Events::default();
    let (layer, guard) = ChromeLayerBuilder::new().writer(events.clone()).build();
    // The spans of other threads count as well, so the subscriber is that of the whole process.
    let subscriber = tracing_subscriber::registry().with(layer);
    tracing::subscriber::set_global_default(subscriber)
        .map_err(|error| Failure::Defect(format!("there is another timeline: {error}")))?;
    let done = work();
    // Ends the thread that writes events.
    drop(guard);
    let written = write(path, &events.0.lock().unwrap_or_else(PoisonError::into_inner));
    done.and(written)
}

fn write(path: &Path, events: &[u8]) -> Result<(), Failure> {
    let mut output = Output::open(&Destination { path: path.to_owned(), kind: (), replace: true })?;
    output.write_all(events).map_err(|error| output.failure(error))?;
    output.finish()
}
