//! How far a picture is, told stage by stage.

use std::sync::{Mutex, PoisonError};

use super::error::RenderError;
use crate::job::Hook;
use crate::progress::Pulse;

/// A hook that hears ascending parts of the work, of one stage after the other.
pub struct Telling<'h> {
    hook: Hook<'h>,
    /// The part that was told last.
    last: f32,
    /// Where the present stage begins and ends.
    span: [f32; 2],
    alive: bool,
    pulse: Pulse,
}

impl<'h> Telling<'h> {
    /// Tells the hook that the work begins.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`].
    pub fn new(hook: Hook<'h>) -> Result<Self, RenderError> {
        let alive = hook(0.0);
        let telling = Self { hook, last: 0.0, span: [0.0, 1.0], alive, pulse: Pulse::new() };
        if alive { Ok(telling) } else { Err(RenderError::Cancelled) }
    }

    /// Begins a stage that ends at this part of the work.
    pub fn begin(&mut self, end: f32) {
        self.span = [self.last, end];
    }

    /// What threads take between tiles.
    pub fn breath(&mut self) -> Breath<'_, 'h> {
        Breath { telling: Mutex::new(self), pulse: Pulse::new() }
    }

    /// Tells how far the stage is, from 0 to 1. Whether to go on.
    pub fn tell(&mut self, part: f32) -> bool {
        let [begin, end] = self.span;
        let part = begin + (end - begin) * part.clamp(0.0, 1.0);
        // Also where nothing is done that counts, the hook is asked.
        if self.alive && (part > self.last || self.pulse.is_due()) {
            self.last = self.last.max(part);
            self.alive = (self.hook)(self.last);
        }
        self.alive
    }
}

/// Asks the hook, on behalf of threads that work on a stage.
pub struct Breath<'t, 'h> {
    telling: Mutex<&'t mut Telling<'h>>,
    pulse: Pulse,
}

impl Breath<'_, '_> {
    /// Asks whether to go on, if nobody has done so for a while.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`].
    pub fn take(&self) -> Result<(), RenderError> {
        let is_due = self.pulse.is_due();
        let mut telling = self.telling.lock().unwrap_or_else(PoisonError::into_inner);
        if is_due && telling.alive {
            let last = telling.last;
            telling.alive = (telling.hook)(last);
        }
        if telling.alive { Ok(()) } else { Err(RenderError::Cancelled) }
    }
}
