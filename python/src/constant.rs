//! Constants of leaves as values of Python: text is `str`, a whole number `int`.

use jbt::tree::{ConstantValues, LeafConstant};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::refused;

/// A value of Python as the value of a constant.
pub(crate) fn constant_of(name: &str, given: &Bound<'_, PyAny>) -> PyResult<LeafConstant> {
    if let Ok(number) = given.extract::<i64>() {
        Ok(LeafConstant::Whole(number))
    } else if let Ok(text) = given.extract::<String>() {
        Ok(LeafConstant::Text(text))
    } else {
        Err(refused(format!("{name}: expected text or a whole number, got {}", given.repr()?)))
    }
}

/// Lists of values by name, as the options of a file have them.
pub(crate) fn constants_of(given: Vec<(String, Vec<Bound<'_, PyAny>>)>) -> PyResult<Vec<ConstantValues>> {
    let one = |(name, values): (String, Vec<Bound<'_, PyAny>>)| {
        let values = values.iter().map(|value| constant_of(&name, value)).collect::<PyResult<_>>()?;
        Ok(ConstantValues { name, values })
    };
    given.into_iter().map(one).collect()
}

/// Lists of values by name, as Python has them.
pub(crate) fn constants_dict(py: Python<'_>, constants: Vec<ConstantValues>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for ConstantValues { name, values } in constants {
        let values = values.into_iter().map(|value| object(py, value)).collect::<PyResult<Vec<_>>>()?;
        dict.set_item(name, values)?;
    }
    Ok(dict)
}

/// The value of a constant, as Python has it.
pub(crate) fn object(py: Python<'_>, value: LeafConstant) -> PyResult<Bound<'_, PyAny>> {
    match value {
        LeafConstant::Whole(number) => Ok(number.into_pyobject(py)?.into_any()),
        LeafConstant::Text(text) => Ok(text.into_pyobject(py)?.into_any()),
    }
}
