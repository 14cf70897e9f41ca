//! Values of options that are words of a list.

use std::error::Error;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, Str, StyledStr, TypedValueParser};
use jbt::Query;

/// A set of answers, by its word.
pub fn queries() -> impl TypedValueParser<Value = Query> {
    words(Query::EVERY, |query| (query.name(), query.title()))
}

/// One of the members of a list, by its word; `tell` gives the word and a line of help.
pub fn words<T, W: Into<Str>, H: Into<StyledStr>>(
    all: impl IntoIterator<Item = T>,
    tell: fn(T) -> (W, H),
) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Error + Send + Sync> + Clone + Send + Sync + 'static,
{
    let words = all.into_iter().map(tell).map(|(word, help)| PossibleValue::new(word).help(help));
    PossibleValuesParser::new(words).try_map(|word| word.parse())
}
