//! Constants of leaves: what a leaf is of, and no number that the field mixes.
//!
//! ```text
//! constant material "steel" { constant part 17 { .. } }
//! ```
//!
//! Programs know none of them: the owner of a point answers them, and files of meshes have them.

use std::fmt;

/// The largest whole number of a constant, and the smallest one negated: floats of 64 bits are exact up to
/// here, so any reader of a file gets them as they are.
pub const LARGEST_CONSTANT: i64 = 1 << 53;

/// The value of a constant.
#[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(untagged))]
pub enum LeafConstant {
    /// A whole number, as that of a part.
    Whole(i64),
    /// Text of one line, without double quotes.
    Text(String),
}

impl fmt::Display for LeafConstant {
    /// As the text format has it: text in quotes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "\"{text}\""),
        }
    }
}

impl LeafConstant {
    /// What is wrong with it, and what is expected.
    #[must_use]
    pub fn fault(&self) -> Option<(String, String)> {
        match self {
            Self::Whole(number) if number.unsigned_abs() > LARGEST_CONSTANT.unsigned_abs() => {
                let expected = format!("expected a whole number of at most {LARGEST_CONSTANT} in magnitude");
                Some((format!("is {number}"), expected))
            }
            Self::Text(text) if text.contains(|c: char| c == '"' || c.is_control()) => {
                Some(("has a quote or a line end".to_owned(), "expected text of one line".to_owned()))
            }
            Self::Whole(_) | Self::Text(_) => None,
        }
    }
}

impl From<&str> for LeafConstant {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for LeafConstant {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<i64> for LeafConstant {
    fn from(number: i64) -> Self {
        Self::Whole(number)
    }
}

impl From<i32> for LeafConstant {
    fn from(number: i32) -> Self {
        Self::Whole(number.into())
    }
}

/// The values that leaves have for one constant.
#[derive(Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConstantValues {
    /// The name of the constant.
    pub name: String,
    /// The values, each once, in the order of the model. There is at least one. Leaves without the constant
    /// do not count.
    pub values: Vec<LeafConstant>,
}
