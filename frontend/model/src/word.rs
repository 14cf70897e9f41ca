//! Words that the text format keeps for itself, and what may be a name beside them.

/// The coordinates of a point.
pub const COORDINATES: [&str; 3] = ["x", "y", "z"];
/// The word for the field of a subtree.
pub const FIELD: &str = "field";

/// The words that begin a statement.
const STATEMENTS: [&str; 6] = ["jbt", "iso", "origin", "param", "attribute", "let"];

/// Whether a word begins a statement.
pub fn is_statement(word: &str) -> bool {
    STATEMENTS.contains(&word)
}

/// Letters, digits and underscores, beginning with a letter.
pub fn is_identifier(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
