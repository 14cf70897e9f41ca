//! How far a picture is, told stage by stage.

use super::error::RenderError;
use crate::job::Hook;

/// A hook that hears ascending parts of the work, of one stage after the other.
pub struct Telling<'h> {
    hook: Hook<'h>,
    /// The part that was told last.
    last: f32,
    /// Where the present stage begins and ends.
    span: [f32; 2],
    alive: bool,
}

impl<'h> Telling<'h> {
    /// Tells the hook that the work begins.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`].
    pub fn new(hook: Hook<'h>) -> Result<Self, RenderError> {
        let alive = hook(0.0);
        let telling = Self { hook, last: 0.0, span: [0.0, 1.0], alive };
        if alive { Ok(telling) } else { Err(RenderError::Cancelled) }
    }

    /// Begins a stage that ends at this part of the work.
    pub fn begin(&mut self, end: f32) {
        self.span = [self.last, end];
    }

    /// Tells how far the stage is, from 0 to 1. Whether to go on.
    pub fn tell(&mut self, part: f32) -> bool {
        let [begin, end] = self.span;
        let part = begin + (end - begin) * part.clamp(0.0, 1.0);
        if self.alive && part > self.last {
            self.last = part;
            self.alive = (self.hook)(part);
        }
        self.alive
    }
}
