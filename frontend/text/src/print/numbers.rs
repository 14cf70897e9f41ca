//! Numbers of a printed model.

use jbt_model::field::NumberText as _;
use jbt_model::number::Number;

/// Numbers in parentheses.
pub(super) fn vector(numbers: impl IntoIterator<Item = impl Into<Number>>) -> String {
    let numbers: Vec<String> = numbers.into_iter().map(|number| number.into().text()).collect();
    format!("({})", numbers.join(" "))
}

/// The values of an attribute: one number without parentheses.
pub(super) fn group_values<T: Into<Number>>(values: impl IntoIterator<Item = T>) -> String {
    let values: Vec<Number> = values.into_iter().map(Into::into).collect();
    match &values[..] {
        [value] => value.text(),
        values => vector(values),
    }
}
