//! Words of the command line, and what is said of one that is none.

use std::fmt;

use thiserror::Error;

/// A word that stands for no member of a list.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{word:?} is none of: {known}")]
#[non_exhaustive]
pub struct UnknownWord {
    /// The word.
    pub word: String,
    /// All members, with commas between them.
    pub known: String,
}

/// The member of a list that prints as a word.
pub(crate) fn find<T: Copy + fmt::Display>(all: &[T], word: &str) -> Result<T, UnknownWord> {
    let words: Vec<String> = all.iter().map(T::to_string).collect();
    let found = words.iter().position(|known| known == word).map(|index| all[index]);
    found.ok_or_else(|| UnknownWord { word: word.to_owned(), known: words.join(", ") })
}
