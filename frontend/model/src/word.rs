//! Words that the text format keeps for itself, and what may be a name beside them.

use std::borrow::Cow;

use unicode_normalization::{UnicodeNormalization as _, is_nfc};

/// The coordinates of a point.
pub const COORDINATES: [&str; 3] = ["x", "y", "z"];
/// The word for the field of a subtree.
pub const FIELD: &str = "field";

/// The word for a constant of leaves.
pub const CONSTANT: &str = "constant";

/// The word before an attribute or a constant that counts whatever stands below.
pub const OVERRIDE: &str = "override";

/// The word for attributes and constants that have a name together.
pub const STYLE: &str = "style";

/// The words that begin a statement.
const STATEMENTS: [&str; 7] = ["jbt", "iso", "origin", "orientation", "param", "attribute", "let"];

/// Whether a word begins a statement.
pub fn is_statement(word: &str) -> bool {
    STATEMENTS.contains(&word)
}

/// Whether a character may begin a name: a letter of any script.
pub fn begins_name(c: char) -> bool {
    if c.is_ascii() { c.is_ascii_alphabetic() } else { unicode_ident::is_xid_start(c) }
}

/// Marks inside of words that UAX 31 lets identifiers have besides (table 3a): Hebrew geresh and gershayim,
/// the Tibetan tsheg, the hyphenation point. Apostrophes are none of them, nor is what looks like a minus
/// sign.
const IN_WORDS: [char; 4] = ['\u{5f3}', '\u{5f4}', '\u{f0b}', '\u{2027}'];

/// Whether a character may go on with a name: a letter, a mark on one or between two, a digit, an underscore.
pub fn continues_name(c: char) -> bool {
    match c.is_ascii() {
        true => c.is_ascii_alphanumeric() || c == '_',
        false => unicode_ident::is_xid_continue(c) || IN_WORDS.contains(&c),
    }
}

/// Letters of any script, digits and underscores, beginning with a letter, in the normal form C of Unicode.
pub fn is_identifier(name: &str) -> bool {
    name.starts_with(begins_name)
        && name.chars().all(continues_name)
        && matches!(normalized(name), Cow::Borrowed(_))
}

/// A text in the normal form C of Unicode, in which a letter with its marks is one character where there is
/// one: what looks the same is the same name.
pub fn normalized(text: &str) -> Cow<'_, str> {
    if text.is_ascii() || is_nfc(text) { Cow::Borrowed(text) } else { Cow::Owned(text.nfc().collect()) }
}
