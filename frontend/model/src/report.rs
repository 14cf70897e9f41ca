//! A list of diagnostics that cannot grow without bound: the first ones are kept, the rest are counted.

use std::sync::Arc;

use jbt_ir::limits::MAX_ERRORS;

use crate::diagnostic::{Diagnostic, Note, Span};
use crate::label::NodeLabel;

/// Diagnostics of one reader.
#[derive(Debug, Default)]
pub struct Report {
    kept: Vec<Diagnostic>,
    counted: usize,
}

impl Report {
    /// Adds what `make` returns; past the limit `make` is not called, so that a file of mistakes costs no
    /// more than its length.
    pub fn add(&mut self, make: impl FnOnce() -> Diagnostic) {
        if self.is_full() {
            self.counted += 1;
        } else {
            self.kept.push(make());
        }
    }

    /// Says of all messages that were added since there were so many in which calls their node stands. What
    /// is told already about the same place in other calls is not told again.
    pub(crate) fn expanded_in(&mut self, since: usize, label: Option<&Arc<NodeLabel>>) {
        let Some(calls) = label.and_then(|label| label.calls.as_ref()) else { return };
        let new = self.kept.split_off(since.min(self.kept.len()));
        for diagnostic in new {
            let same = |other: &Diagnostic| {
                other.span == diagnostic.span
                    && other.message == diagnostic.message
                    && !other.notes.is_empty()
            };
            if !self.kept.iter().any(same) {
                self.kept.push(Diagnostic { notes: calls.notes(), ..diagnostic });
            }
        }
    }

    /// Says of all messages without a place that were added since there were so many where their node stands.
    pub(crate) fn stands_at(&mut self, since: usize, way: impl FnOnce() -> String) {
        let new = self.kept.get_mut(since..).unwrap_or_default();
        if new.is_empty() {
            return;
        }
        let message = format!("at {}", way());
        for diagnostic in new.iter_mut().filter(|one| one.span.is_none()) {
            diagnostic.notes.push(Note { span: None, message: message.clone() });
        }
    }

    /// Adds all of these.
    pub(crate) fn extend(&mut self, diagnostics: Vec<Diagnostic>) {
        for diagnostic in diagnostics {
            self.add(|| diagnostic);
        }
    }

    /// Whether further ones are only counted.
    pub fn is_full(&self) -> bool {
        self.kept.len() >= MAX_ERRORS
    }

    /// Adds one that must not be lost among the counted ones: the reason why reading stopped.
    pub fn add_last(&mut self, diagnostic: Diagnostic) {
        self.kept.push(diagnostic);
    }

    /// Puts what was kept in the order of its places in the text.
    pub fn sort(&mut self) {
        self.kept.sort_by_key(|diagnostic| diagnostic.span);
    }

    /// How many were added.
    pub fn count(&self) -> usize {
        self.kept.len() + self.counted
    }

    /// Whether nothing was added.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// What was kept, and a final count of what was not.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        if self.counted > 0 {
            let plural = if self.counted == 1 { "" } else { "s" };
            self.kept.push(Diagnostic::error(None, format!("and {} more error{plural}", self.counted)));
        }
        self.kept
    }
}

/// The start of a word of a stranger's file, short enough for a message.
pub fn clip(word: &str) -> String {
    const LONGEST: usize = 40;
    match word.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &word[..end]),
        None => word.to_owned(),
    }
}

/// The known word that `word` was perhaps meant to be: the nearest by edit distance, if it is near.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 64;
    if word.len() > LONGEST {
        return None;
    }
    let allowed = (word.len() / 3).max(1);
    known
        .into_iter()
        .filter(|other| other.len().abs_diff(word.len()) <= allowed)
        .map(|other| (edit_distance(word.as_bytes(), other.as_bytes()), other))
        .filter(|&(distance, _)| distance <= allowed)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, other)| other)
}

/// Insertions, deletions, substitutions and exchanges of neighbours that turn `a` into `b` (optimal string
/// alignment).
fn edit_distance(a: &[u8], b: &[u8]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut next = vec![i + 1];
        for j in 0..b.len() {
            let substituted = row[j] + usize::from(!a[i].eq_ignore_ascii_case(&b[j]));
            let mut best = substituted.min(row[j + 1] + 1).min(next[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                best = best.min(before[j - 1] + 1);
            }
            next.push(best);
        }
        before = std::mem::replace(&mut row, next);
    }
    row[b.len()]
}

/// Why numbers give no node: a message that has no place yet.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Fault {
    pub(crate) message: String,
    pub(crate) help: Option<&'static str>,
}

impl Fault {
    /// The message about it, at a place.
    pub(crate) fn at(self, span: Option<Span>) -> Diagnostic {
        let error = Diagnostic::error(span, self.message);
        match self.help {
            Some(help) => error.expected(help),
            None => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_distances() {
        assert_eq!(edit_distance(b"kitten", b"sitting"), 3);
        assert_eq!(edit_distance(b"", b"abc"), 3);
        assert_eq!(edit_distance(b"amr", b"arm"), 1);
        assert_eq!(edit_distance(b"Union", b"union"), 0);
        assert_eq!(nearest("sgement", ["sum", "segment", "scale"]), Some("segment"));
        assert_eq!(nearest("elephant", ["sum", "segment"]), None);
    }

    #[test]
    fn errors_past_the_limit_are_counted() {
        let mut report = Report::default();
        for i in 0..MAX_ERRORS + 2 {
            report.add(|| Diagnostic::error(None, i.to_string()));
        }
        let all = report.finish();
        assert_eq!(all.len(), MAX_ERRORS + 1);
        assert_eq!(all[MAX_ERRORS].message, "and 2 more errors");
    }
}
