//! Formulas of a point: `jbt.Term`.

use jbt_model::builder as build;
use jbt_model::function::Function;
use jbt_model::number::{Binary, Number, Step};
use jbt_model::term::Term;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error::{expected, refused};
use crate::falloff::PyFalloff;
use crate::model::PyModel;
use crate::number::{PyNumber, arithmetic, number};

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

arithmetic! { PyTerm, binary, |term| Self { inner: -term.inner.clone(), models: term.models.clone() }, {
    fn __abs__(&self) -> Self {
        Self { inner: self.inner.abs(), models: self.models.clone() }
    }

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
