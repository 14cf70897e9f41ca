//! Parameters of members from what Python gives for them, by their [`FieldKind`].

use jbt::tree::{Field, FieldKind, FieldValue};
use jbt_model::number::Number;
use jbt_model::written::FieldNumber;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::error::{expected, refused};
use crate::number::number;

/// The value of a parameter; `None` is its default.
pub(crate) fn field_value(field: &Field, given: &Bound<'_, PyAny>) -> PyResult<FieldNumber> {
    let name = field.name;
    if given.is_none() {
        let default = field.default.clone();
        return default
            .map(FieldNumber::from)
            .ok_or_else(|| PyTypeError::new_err(format!("{name}: a value is required")));
    }
    match field.kind {
        FieldKind::Real
        | FieldKind::Positive
        | FieldKind::NonNegative
        | FieldKind::Within { .. }
        | FieldKind::Count
        | FieldKind::Whole { .. }
        | FieldKind::Degrees => Ok(FieldNumber::Real(one(name, given)?)),
        FieldKind::Choice(words) => choice(name, words, given),
        FieldKind::Flag => Ok(FieldNumber::Real(if given.is_truthy()? { 1.0 } else { 0.0 }.into())),
        FieldKind::Axis | FieldKind::Direction => match axis(given) {
            Some(unit) => Ok(FieldValue::Vector(unit).into()),
            None => Ok(FieldNumber::Vector(vector(name, given)?)),
        },
        FieldKind::Position | FieldKind::Extents | FieldKind::Stretches => {
            Ok(FieldNumber::Vector(vector(name, given)?))
        }
        FieldKind::Positions => Ok(FieldNumber::Vectors(vectors(name, given)?)),
        FieldKind::Lengths => Ok(FieldNumber::Reals(numbers(name, given)?)),
        FieldKind::Rows => rows(name, given),
    }
}

fn one(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Number> {
    number(given).ok_or_else(|| expected(name, "a number or a jbt.Number", given))
}

/// The unit vector of one of the words x, y, z.
fn axis(given: &Bound<'_, PyAny>) -> Option<[f64; 3]> {
    let word = given.cast::<PyString>().ok()?.to_string();
    let index = ["x", "y", "z"].iter().position(|axis| *axis == word)?;
    Some(std::array::from_fn(|place| f64::from(u8::from(place == index))))
}

fn choice(name: &str, words: &[&str], given: &Bound<'_, PyAny>) -> PyResult<FieldNumber> {
    let what = || format!("one of {}", words.join(", "));
    let word = given.cast::<PyString>().map_err(|_| expected(name, &what(), given))?.to_string();
    let place = words.iter().position(|known| *known == word);
    let place = place.ok_or_else(|| refused(format!("{name}: expected {}, got {word:?}", what())))?;
    Ok(FieldNumber::Real((place as f64).into()))
}

/// Any number of numbers; a single one is a list of one.
pub(crate) fn numbers(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<Number>> {
    if let Some(single) = number(given) {
        return Ok(vec![single]);
    }
    let what = "numbers";
    let items = items(given).ok_or_else(|| expected(name, what, given))?;
    items.iter().map(|item| number(item).ok_or_else(|| expected(name, what, item))).collect()
}

/// What can be iterated over and is no text.
fn items<'py>(given: &Bound<'py, PyAny>) -> Option<Vec<Bound<'py, PyAny>>> {
    if given.is_instance_of::<PyString>() {
        return None;
    }
    given.try_iter().ok()?.collect::<PyResult<_>>().ok()
}

/// Three numbers.
pub(crate) fn vector(name: &str, given: &Bound<'_, PyAny>) -> PyResult<[Number; 3]> {
    let what = "3 numbers";
    let items = items(given).ok_or_else(|| expected(name, what, given))?;
    let numbers: Option<Vec<Number>> = items.iter().map(number).collect();
    numbers
        .and_then(|numbers| <[Number; 3]>::try_from(numbers).ok())
        .ok_or_else(|| expected(name, what, given))
}

/// Any number of vectors.
fn vectors(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<[Number; 3]>> {
    let items = items(given).ok_or_else(|| expected(name, "points of 3 numbers each", given))?;
    items.iter().map(|item| vector(name, item)).collect()
}

/// Three rows of four numbers, twelve numbers, or four rows of which the last one is (0, 0, 0, 1).
fn rows(name: &str, given: &Bound<'_, PyAny>) -> PyResult<FieldNumber> {
    let what = "3 rows of 4 numbers, or 4 rows of which the last one is (0, 0, 0, 1)";
    let wrong = || expected(name, what, given);
    let items = items(given).ok_or_else(wrong)?;
    let mut flat = Vec::new();
    for item in &items {
        flat.extend(numbers(name, item)?);
    }
    let last: Vec<f64> = flat.iter().skip(12).map(Number::value).collect();
    if flat.len() != 12 && !(flat.len() == 16 && last == [0.0, 0.0, 0.0, 1.0]) {
        return Err(wrong());
    }
    flat.truncate(12);
    Ok(FieldNumber::Reals(flat))
}
