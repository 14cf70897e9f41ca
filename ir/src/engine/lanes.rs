//! The SIMD interpreter as an engine: a tape, and memory of runs that is used again.

use std::sync::{Arc, Mutex};

use crate::domain::lanes::{Scratch, Tape, WIDTH};
use crate::level::Level;
use crate::verify::Verified;
use crate::watch;

use super::backend::{Backend, Declined, Form};
use super::program::{Interface, Program, Run};

/// What making a tape takes for a value: 143 bytes were seen.
const TAPE_BYTES: usize = 200;

/// The SIMD interpreter: see [`crate::domain::lanes`].
#[derive(Clone, Copy, Debug)]
pub struct Interpreter;

impl Backend for Interpreter {
    fn name(&self) -> &'static str {
        "lanes"
    }

    fn covers(&self, _: Level) -> bool {
        true
    }

    fn supports(&self, level: Level) -> Result<(), Declined> {
        Ok(level.require()?)
    }

    fn compile(&self, function: &Arc<Verified>, level: Level) -> Result<Arc<dyn Program>, Declined> {
        self.supports(level)?;
        watch::take(function.function().values.len() * TAPE_BYTES);
        let tape = Tape::new(function).map_err(|error| Declined { reason: error.to_string() })?;
        let interface = Arc::new(Interface::new(function.function()));
        Ok(Arc::new(LanesProgram { tape, level, interface, scratch: Mutex::default() }))
    }

    fn forms(&self) -> &'static [Form] {
        &[]
    }
}

/// A tape at a level.
#[derive(Debug)]
struct LanesProgram {
    tape: Tape,
    level: Level,
    interface: Arc<Interface>,
    /// Memory of runs that have ended, one for each thread that ran at once.
    scratch: Mutex<Vec<Scratch>>,
}

impl Program for LanesProgram {
    fn interface(&self) -> &Arc<Interface> {
        &self.interface
    }

    fn block(&self) -> usize {
        WIDTH
    }

    fn run(&self, run: Run<'_, '_>) {
        let planes = run.planes(&self.interface);
        let scratch = self.scratch.lock().ok().and_then(|mut pool| pool.pop());
        let mut scratch = scratch.unwrap_or_default();
        self.tape.run_checked(self.level, planes, &mut scratch);
        if let Ok(mut pool) = self.scratch.lock() {
            pool.push(scratch);
        }
    }
}
