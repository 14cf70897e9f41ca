//! What makes programs.

use std::fmt;
use std::sync::Arc;

use crate::level::{Level, MissingLevel};
use crate::verify::Verified;

use super::program::Program;

/// A way to run functions. All give the same bits.
pub trait Backend: fmt::Debug + Send + Sync {
    /// One word, for messages and tests.
    fn name(&self) -> &'static str;

    /// Whether it makes programs for a level, be it for another CPU.
    fn covers(&self, level: Level) -> bool;

    /// Whether this CPU runs its programs for a level.
    ///
    /// # Errors
    /// What is missing.
    fn supports(&self, level: Level) -> Result<(), Declined>;

    /// Compiles a function for a level that it [`covers`](Self::covers).
    ///
    /// # Errors
    /// What [`supports`](Self::supports) says; a function that is beyond a limit of this backend.
    fn compile(&self, function: &Arc<Verified>, level: Level) -> Result<Arc<dyn Program>, Declined>;

    /// The texts that it makes of functions, in the order of its stages.
    fn forms(&self) -> &'static [Form];
}

/// A stage of a backend as text.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The word for it.
    pub name: &'static str,
    /// What it shows, in a sentence.
    pub what: &'static str,
    /// The text of a function at a level, which this CPU need not have.
    pub text: fn(&Verified, Level) -> Result<String, Declined>,
}

/// Why a backend has no program, or no text, for a function.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{reason}")]
pub struct Declined {
    /// The reason, for people.
    pub reason: String,
}

impl From<MissingLevel> for Declined {
    fn from(missing: MissingLevel) -> Self {
        Self { reason: missing.to_string() }
    }
}

/// The backend of a list that is used for a level: the last one that covers it, for lists go from the general
/// to the special.
#[must_use]
pub fn choose(list: &[&'static dyn Backend], level: Level) -> Option<&'static dyn Backend> {
    list.iter().rev().copied().find(|backend| backend.covers(level))
}
