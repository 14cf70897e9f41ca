//! Numbers that follow parameters, and formulas of a point: `jbt.Number` and `jbt.Term`.

use jbt_model::builder as build;
use jbt_model::function::Function;
use jbt_model::number::{Binary, Number, Step};
use jbt_model::term::Term;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::build::PyFalloff;
use crate::error::{expected, refused};
use crate::model::PyModel;

/// A number that may depend on named parameters.
#[pyclass(frozen, module = "jbt", name = "Number")]
#[derive(Clone)]
pub(crate) struct PyNumber(pub(crate) Number);

/// A part of the formula of a field.
#[pyclass(frozen, module = "jbt", name = "Term")]
#[derive(Clone)]
pub(crate) struct PyTerm {
    pub(crate) inner: Term,
    /// The models whose fields it asks for, as far as they say more than their trees.
    pub(crate) models: Vec<PyModel>,
}

/// What a formula is made of.
enum FormulaPart {
    Number(Number),
    Term(PyTerm),
}

impl PyTerm {
    /// A formula that asks for no fields.
    pub(crate) fn plain(inner: Term) -> Self {
        Self { inner, models: Vec::new() }
    }

    /// A formula of these.
    fn of(operands: Vec<Self>, make: impl FnOnce(Vec<Term>) -> Term) -> Self {
        let (mut inner, mut models) = (Vec::new(), Vec::<PyModel>::new());
        for operand in operands {
            inner.push(operand.inner);
            for model in operand.models {
                if !models.iter().any(|known| known.is(&model)) {
                    models.push(model);
                }
            }
        }
        Self { inner: make(inner), models }
    }
}

impl FormulaPart {
    fn of(value: &Bound<'_, PyAny>) -> Option<Self> {
        if let Ok(term) = value.cast::<PyTerm>() {
            return Some(Self::Term(term.get().clone()));
        }
        number(value).map(Self::Number)
    }

    fn term(self) -> PyTerm {
        match self {
            Self::Number(number) => PyTerm::plain(number.into()),
            Self::Term(term) => term,
        }
    }

    fn give(self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match self {
            Self::Number(number) => Ok(Py::new(py, PyNumber(number))?.into_any()),
            Self::Term(term) => Ok(Py::new(py, term)?.into_any()),
        }
    }
}

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

/// A formula that has to be one.
pub(crate) fn term_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<PyTerm> {
    let operand = FormulaPart::of(value);
    operand.map(FormulaPart::term).ok_or_else(|| expected(name, "a number or a jbt.Term", value))
}

/// Two operands of an operator of Python's; `None` leaves it to the other side.
fn binary(py: Python<'_>, operator: Binary, sides: [&Bound<'_, PyAny>; 2]) -> PyResult<Py<PyAny>> {
    let [Some(left), Some(right)] = sides.map(FormulaPart::of) else { return Ok(py.NotImplemented()) };
    let made = match (left, right) {
        (FormulaPart::Number(left), FormulaPart::Number(right)) => {
            FormulaPart::Number(Number::of_step(Step::Binary(operator), &[&left, &right]))
        }
        (left, right) => FormulaPart::Term(term_binary(operator, left.term(), right.term())),
    };
    made.give(py)
}

fn term_binary(operator: Binary, left: PyTerm, right: PyTerm) -> PyTerm {
    let made = |mut sides: Vec<Term>| {
        let (right, left) = (sides.remove(1), sides.remove(0));
        match operator {
            Binary::Add => left + right,
            Binary::Subtract => left - right,
            Binary::Multiply => left * right,
            Binary::Divide => left / right,
            Binary::Power => left.powf(right),
        }
    };
    PyTerm::of(vec![left, right], made)
}

/// The operators of Python of a class, from `+` to `**`.
macro_rules! arithmetic {
    ($class:ident, $negated:expr, { $($own:tt)* }) => {
        #[pymethods]
        impl $class {
            $($own)*

            fn __add__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Add, [slf.as_any(), other])
            }

            fn __radd__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Add, [other, slf.as_any()])
            }

            fn __sub__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Subtract, [slf.as_any(), other])
            }

            fn __rsub__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Subtract, [other, slf.as_any()])
            }

            fn __mul__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Multiply, [slf.as_any(), other])
            }

            fn __rmul__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Multiply, [other, slf.as_any()])
            }

            fn __truediv__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Divide, [slf.as_any(), other])
            }

            fn __rtruediv__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                binary(slf.py(), Binary::Divide, [other, slf.as_any()])
            }

            fn __pow__(
                slf: &Bound<'_, Self>,
                other: &Bound<'_, PyAny>,
                modulo: Option<&Bound<'_, PyAny>>,
            ) -> PyResult<Py<PyAny>> {
                if modulo.is_some() {
                    return Err(PyTypeError::new_err("pow() of a formula takes no modulus"));
                }
                binary(slf.py(), Binary::Power, [slf.as_any(), other])
            }

            fn __rpow__(
                slf: &Bound<'_, Self>,
                other: &Bound<'_, PyAny>,
                modulo: Option<&Bound<'_, PyAny>>,
            ) -> PyResult<Py<PyAny>> {
                let _ = modulo;
                binary(slf.py(), Binary::Power, [other, slf.as_any()])
            }

            fn __neg__(&self) -> Self {
                let negated: fn(&Self) -> Self = $negated;
                negated(self)
            }

            fn __pos__(&self) -> Self {
                self.clone()
            }

            fn __abs__(slf: &Bound<'_, Self>) -> PyResult<Py<PyAny>> {
                call(slf.py(), "abs", vec![slf.as_any().clone()])
            }
        }
    };
}

arithmetic! { PyNumber, |number| Self(-&number.0), {
    /// A parameter with this name and default.
    #[staticmethod]
    fn parameter(name: &str, default: f64) -> Self {
        Self(build::param(name, default))
    }

    /// Its present value.
    #[getter]
    fn value(&self) -> f64 {
        self.0.value()
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

arithmetic! { PyTerm, |term| Self { inner: -term.inner.clone(), models: term.models.clone() }, {
    fn __repr__(&self) -> String {
        "<jbt.Term>".to_owned()
    }
} }

/// A coordinate of the point, by the index of its axis.
#[pyfunction]
pub(crate) fn coordinate(axis: usize) -> PyResult<PyTerm> {
    match axis {
        0 => Ok(PyTerm::plain(build::x())),
        1 => Ok(PyTerm::plain(build::y())),
        2 => Ok(PyTerm::plain(build::z())),
        _ => Err(refused(format!("axis: expected 0, 1 or 2, got {axis}"))),
    }
}

/// A function of the list: of numbers a number, of anything else a formula.
#[pyfunction]
pub(crate) fn call(py: Python<'_>, name: &str, arguments: Vec<Bound<'_, PyAny>>) -> PyResult<Py<PyAny>> {
    let function = Function::named(name).ok_or_else(|| refused(format!("no function is called {name:?}")))?;
    let (least, most) = function.arity();
    if !(least..=most).contains(&arguments.len()) {
        let given = arguments.len();
        return Err(PyTypeError::new_err(format!("{name}(): expected {least} or more numbers, got {given}")));
    }
    let operands = arguments
        .iter()
        .map(|argument| {
            let what = "a number, a jbt.Number or a jbt.Term";
            FormulaPart::of(argument).ok_or_else(|| expected(&format!("{name}()"), what, argument))
        })
        .collect::<PyResult<Vec<_>>>()?;
    if operands.iter().any(|operand| matches!(operand, FormulaPart::Term(_))) {
        let terms = operands.into_iter().map(FormulaPart::term).collect();
        return FormulaPart::Term(PyTerm::of(terms, |terms| Term::of_function(function, terms))).give(py);
    }
    let numbers: Vec<Number> = operands
        .into_iter()
        .filter_map(|operand| if let FormulaPart::Number(number) = operand { Some(number) } else { None })
        .collect();
    let step = Step::Call(function, numbers.len() as u32);
    FormulaPart::Number(Number::of_step(step, &numbers.iter().collect::<Vec<_>>())).give(py)
}

/// The falloff of a distance, of which 1 is the end.
#[pyfunction]
pub(crate) fn falloff_of(falloff: &Bound<'_, PyFalloff>, distance: &Bound<'_, PyAny>) -> PyResult<PyTerm> {
    let PyTerm { inner, models } = term_of("distance", distance)?;
    Ok(PyTerm { inner: inner.falloff(falloff.get().0.falloff()), models })
}
