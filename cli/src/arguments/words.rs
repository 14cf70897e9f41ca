//! Values of options that are words of a list.

use std::error::Error;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, Str, StyledStr, TypedValueParser};
use jbt::Query;
use jbt::mesh::Simplify;

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

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// When to stop taking triangles away: `25%` of them, or a length.
pub fn simplify(text: &str) -> Result<Simplify, String> {
    let expected = || "expected a part of the triangles, as 25%, or a length above 0, as 0.01".to_owned();
    match text.strip_suffix('%') {
        Some(percent) => match positive(percent) {
            Ok(percent) if percent <= 100.0 => Ok(Simplify::Ratio(percent / 100.0)),
            _ => Err(expected()),
        },
        None => positive(text).map(Simplify::Tolerance).map_err(|_| expected()),
    }
}

/// Two numbers, the second above the first.
pub type ValueRange = [f64; 2];

/// Two numbers with a comma between them.
pub fn range(text: &str) -> Result<ValueRange, String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [low, high] if low < high && text.split(',').count() == 2 && (high - low).is_finite() => {
            Ok([low, high])
        }
        _ => Err("expected two numbers with a comma, the second above the first".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_lengths_are_told_apart() {
        assert_eq!(simplify("25%"), Ok(Simplify::Ratio(0.25)));
        assert_eq!(simplify("0.01"), Ok(Simplify::Tolerance(0.01)));
        for text in ["0", "-1", "nan", "inf", "101%", "0%", "%", "", "1 %", "a"] {
            assert!(simplify(text).is_err(), "{text}");
        }
    }
}
