//! Numbers that follow parameters: `jbt.Number`.

use jbt_model::builder::param;
use jbt_model::number::{Binary, Number, Step};
use pyo3::prelude::*;

use crate::error::expected;

/// A number that may depend on named parameters.
#[pyclass(frozen, module = "jbt", name = "Number")]
#[derive(Clone)]
pub(crate) struct PyNumber(pub(crate) Number);

/// A number as anything of Python's that is one; no truth value, no text.
pub(crate) fn number(value: &Bound<'_, PyAny>) -> Option<Number> {
    if let Ok(number) = value.cast::<PyNumber>() {
        return Some(number.get().0.clone());
    }
    if value.is_instance_of::<pyo3::types::PyBool>() || value.is_instance_of::<pyo3::types::PyString>() {
        return None;
    }
    value.extract::<f64>().ok().map(Number::from)
}

/// A number that has to be one.
pub(crate) fn number_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Number> {
    number(value).ok_or_else(|| expected(name, "a number or a jbt.Number", value))
}

/// Two numbers and an operator of Python's; anything else is left to the other side.
fn binary(py: Python<'_>, operator: Binary, sides: [&Bound<'_, PyAny>; 2]) -> PyResult<Py<PyAny>> {
    let [Some(left), Some(right)] = sides.map(number) else { return Ok(py.NotImplemented()) };
    let made = Number::of_step(Step::Binary(operator), &[&left, &right]);
    Ok(Py::new(py, PyNumber(made))?.into_any())
}

/// The operators of Python of a class, from `+` to `**`.
macro_rules! arithmetic {
    ($class:ident, $binary:path, $negated:expr, { $($own:tt)* }) => {
        #[pymethods]
        impl $class {
            $($own)*

            fn __add__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Add, [slf.as_any(), other])
            }

            fn __radd__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Add, [other, slf.as_any()])
            }

            fn __sub__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Subtract, [slf.as_any(), other])
            }

            fn __rsub__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Subtract, [other, slf.as_any()])
            }

            fn __mul__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Multiply, [slf.as_any(), other])
            }

            fn __rmul__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Multiply, [other, slf.as_any()])
            }

            fn __truediv__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Divide, [slf.as_any(), other])
            }

            fn __rtruediv__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                $binary(slf.py(), Binary::Divide, [other, slf.as_any()])
            }

            fn __pow__(
                slf: &Bound<'_, Self>,
                other: &Bound<'_, PyAny>,
                modulo: Option<&Bound<'_, PyAny>>,
            ) -> PyResult<Py<PyAny>> {
                if modulo.is_some() {
                    return Err(pyo3::exceptions::PyTypeError::new_err("pow() of a formula takes no modulus"));
                }
                $binary(slf.py(), Binary::Power, [slf.as_any(), other])
            }

            fn __rpow__(
                slf: &Bound<'_, Self>,
                other: &Bound<'_, PyAny>,
                modulo: Option<&Bound<'_, PyAny>>,
            ) -> PyResult<Py<PyAny>> {
                let _ = modulo;
                $binary(slf.py(), Binary::Power, [other, slf.as_any()])
            }

            fn __neg__(&self) -> Self {
                let negated: fn(&Self) -> Self = $negated;
                negated(self)
            }

            fn __pos__(&self) -> Self {
                self.clone()
            }
        }
    };
}

pub(crate) use arithmetic;

arithmetic! { PyNumber, binary, |number| Self(-&number.0), {
    /// A parameter with this name and default.
    #[staticmethod]
    fn parameter(name: &str, default: f64) -> Self {
        Self(param(name, default))
    }

    /// Its present value.
    #[getter]
    fn value(&self) -> f64 {
        self.0.value()
    }

    fn __abs__(&self) -> Self {
        Self(self.0.abs())
    }

    fn __float__(&self) -> f64 {
        self.0.value()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        number(other).is_some_and(|other| other == self.0)
    }

    fn __hash__(&self) -> u64 {
        self.0.value().to_bits()
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("<jbt.Number {} = {}>", self.0, self.0.value())
    }
} }
