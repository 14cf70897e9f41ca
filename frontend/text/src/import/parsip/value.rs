//! Values of keys: numbers, tuples, flags, lists of nodes.

use super::Importer;
use super::scan::{Key, Section, text};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;

impl Importer<'_> {
    /// The text of a value.
    pub(super) fn shown(&self, span: Span) -> String {
        text(self.bytes, span).into_owned()
    }

    /// A finite number. `None` if the key is missing, or after a message.
    pub(super) fn number(&mut self, section: &Section, key: Key) -> Option<f64> {
        let span = section.get(key)?;
        let shown = self.shown(span);
        let value = shown.parse::<f64>().ok().filter(|x| x.is_finite());
        if value.is_none() {
            self.bad(span, key, &shown, "a number");
        }
        value
    }

    /// A number that has to be there.
    pub(super) fn needed(&mut self, section: &Section, key: Key) -> Option<f64> {
        self.need(section, key)?;
        self.number(section, key)
    }

    /// A number of at least 0 that has to be there.
    pub(super) fn length(&mut self, section: &Section, key: Key) -> Option<f64> {
        let value = self.needed(section, key)?;
        if value < 0.0 {
            let span = section.get(key);
            self.errors.add(|| {
                Diagnostic::error(span, format!("`{}` is {value}", key.name()))
                    .expected("expected at least 0")
            });
            return None;
        }
        Some(value)
    }

    /// An integer. `None` if the key is missing, or after a message.
    pub(super) fn integer(&mut self, section: &Section, key: Key) -> Option<i64> {
        let span = section.get(key)?;
        let shown = self.shown(span);
        let value = shown.parse::<i64>().ok();
        if value.is_none() {
            self.bad(span, key, &shown, "an integer");
        }
        value
    }

    /// A flag, 0 if the key is missing.
    pub(super) fn flag(&mut self, section: &Section, key: Key) -> bool {
        match self.integer(section, key) {
            None | Some(0) => false,
            Some(1) => true,
            Some(_) => {
                let shown = section.get(key).map(|span| (span, self.shown(span)));
                if let Some((span, shown)) = shown {
                    self.bad(span, key, &shown, "0 or 1");
                }
                false
            }
        }
    }

    /// A tuple of `N` finite numbers; `extra` more may follow and are ignored. `None` if the key is missing,
    /// or after a message.
    pub(super) fn tuple<const N: usize>(
        &mut self,
        section: &Section,
        key: Key,
        extra: usize,
    ) -> Option<[f64; N]> {
        let span = section.get(key)?;
        let shown = self.shown(span);
        let numbers = parenthesised(&shown).and_then(|inner| {
            let mut numbers = [0.0; N];
            let mut count = 0;
            for part in inner.split(',') {
                let value = part.trim().parse::<f64>().ok().filter(|x| x.is_finite())?;
                if let Some(slot) = numbers.get_mut(count) {
                    *slot = value;
                }
                count += 1;
            }
            (N..=N + extra).contains(&count).then_some(numbers)
        });
        if numbers.is_none() {
            self.bad(span, key, &shown, &format!("{N} numbers: (a, b, ...)"));
        }
        numbers
    }

    /// A tuple that has to be there.
    pub(super) fn needed_tuple<const N: usize>(&mut self, section: &Section, key: Key) -> Option<[f64; N]> {
        self.need(section, key)?;
        self.tuple(section, key, 0)
    }

    /// The place of the value of a key; a message if the key is missing.
    pub(super) fn need(&mut self, section: &Section, key: Key) -> Option<Span> {
        let found = section.get(key);
        if found.is_none() {
            let (id, span) = (section.id, section.span);
            self.errors.add(|| Diagnostic::error(Some(span), format!("node {id} has no `{}`", key.name())));
        }
        found
    }

    /// A list of at most `most` integers. `None` after a message.
    pub(super) fn list(&mut self, span: Span, key: Key, most: usize) -> Option<Vec<i64>> {
        let shown = self.shown(span);
        let mut all = Vec::new();
        let read = parenthesised(&shown).is_some_and(|inner| {
            inner.trim().is_empty()
                || inner.split(',').take(most + 1).all(|part| {
                    let value = part.trim().parse::<i64>();
                    all.extend(value.iter());
                    value.is_ok()
                })
        });
        if !read {
            self.bad(span, key, &shown, "node numbers: (a, b, ...)");
            return None;
        }
        Some(all)
    }

    /// Reports an invalid value.
    pub(super) fn bad(&mut self, span: Span, key: Key, shown: &str, expected: &str) {
        self.errors.add(|| {
            Diagnostic::error(Some(span), format!("`{}` is {}", key.name(), clip(shown)))
                .expected(format!("expected {expected}"))
        });
    }
}

/// The text between parentheses.
fn parenthesised(text: &str) -> Option<&str> {
    text.strip_prefix('(')?.strip_suffix(')')
}
