//! What a reader leaves out: each kind of thing is one warning, at its first place, with a count.

use std::collections::HashMap;

use jbt_ir::limits::MAX_ERRORS;
use jbt_model::diagnostic::{Diagnostic, Span};

/// Things that were left out, by what is said about them.
#[derive(Default)]
pub(super) struct LeftOut {
    noted: Vec<(String, Span, usize)>,
    places: HashMap<String, usize>,
    /// How many had no room.
    others: usize,
}

impl LeftOut {
    /// Counts one more of the things about which this is said.
    pub(super) fn note(&mut self, span: Span, message: &str) {
        self.note_as(span, message, || message.to_owned());
    }

    /// Counts one more of the things of a name. What is said of them is made once, and not at all where there
    /// is no room.
    pub(super) fn note_as(&mut self, span: Span, name: &str, make: impl FnOnce() -> String) {
        if let Some(&place) = self.places.get(name) {
            self.noted[place].2 += 1;
        } else if self.noted.len() < MAX_ERRORS {
            self.places.insert(name.to_owned(), self.noted.len());
            self.noted.push((make(), span, 1));
        } else {
            self.others += 1;
        }
    }

    /// A warning for each kind of thing, in the order of their first places.
    pub(super) fn finish(self) -> Vec<Diagnostic> {
        let warning = |(message, span, count): (String, Span, usize)| {
            let message = if count == 1 { message } else { format!("{message} ({count} times)") };
            Diagnostic::warning(Some(span), message)
        };
        let mut warnings: Vec<Diagnostic> = self.noted.into_iter().map(warning).collect();
        if self.others > 0 {
            let message = format!("and {} more things that were left out", self.others);
            warnings.push(Diagnostic::warning(None, message));
        }
        warnings
    }
}
