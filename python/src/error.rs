//! Errors of jbt as exceptions of Python.
//!
//! | kind | exception |
//! |---|---|
//! | messages about a model | `jbt.SceneError`, a `ValueError` with `.diagnostics` |
//! | an argument, a model without a box | `ValueError` |
//! | a limit | `jbt.LimitError`, a `ValueError` |
//! | the system | `OSError` with its number |
//! | stopped | what the one who stopped it raised, as a rule `KeyboardInterrupt` |
//! | a defect | `RuntimeError` |

use std::error::Error;
use std::io;

use jbt::diagnostic::Diagnostic;
use jbt::{Classified, Diagnostics, ErrorKind};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

/// Where the classes of Python's side are.
const MODULE: &str = "jbt._errors";

/// An error of jbt as an exception.
pub(crate) fn raised(py: Python<'_>, error: &dyn Classified) -> PyErr {
    if let Some(diagnostics) = error.diagnostics().filter(|diagnostics| diagnostics.io().is_none()) {
        return scene_error(py, diagnostics).unwrap_or_else(|failed| failed);
    }
    match error.kind() {
        ErrorKind::Model | ErrorKind::Argument | ErrorKind::Unbounded => PyValueError::new_err(shown(error)),
        ErrorKind::Limit => limit(py, shown(error)),
        ErrorKind::System => system(error),
        ErrorKind::Cancelled => PyKeyboardInterrupt::new_err(()),
        ErrorKind::Internal => PyRuntimeError::new_err(shown(error)),
    }
}

/// Any error of jbt, for work in which there are several.
pub(crate) struct Refusal(Box<dyn Classified>);

impl<E: Classified> From<E> for Refusal {
    fn from(error: E) -> Self {
        Self(Box::new(error))
    }
}

impl Refusal {
    pub(crate) fn raised(&self, py: Python<'_>) -> PyErr {
        raised(py, &*self.0)
    }
}

/// Messages about a model: `SceneError(text, [(severity, name, line, column, message, hint)])`.
fn scene_error(py: Python<'_>, diagnostics: &Diagnostics) -> PyResult<PyErr> {
    let place = |one: &Diagnostic| -> (Option<String>, Option<usize>, Option<usize>) {
        let Some((source, span)) = diagnostics.source_text().zip(one.span) else { return (None, None, None) };
        let (line, column) = source.source().position(span.start as usize);
        (Some(source.name().to_owned()), Some(line), Some(column))
    };
    let list: Vec<_> = diagnostics
        .iter()
        .map(|one| {
            let (name, line, column) = place(one);
            (one.severity.name(), name, line, column, one.message.clone(), one.help.clone())
        })
        .collect();
    let class = py.import(MODULE)?.getattr("SceneError")?;
    Ok(PyErr::from_value(class.call_method1("_of", (diagnostics.to_string(), list))?))
}

fn limit(py: Python<'_>, text: String) -> PyErr {
    let class = py.import(MODULE).and_then(|module| module.getattr("LimitError"));
    let made = class.and_then(|class| class.call1((text,)));
    made.map_or_else(|failed| failed, PyErr::from_value)
}

/// What the system refused, with its number, so that Python finds the class: `FileNotFoundError`, and so on.
fn system(error: &dyn Classified) -> PyErr {
    let mut cause: Option<&(dyn Error + 'static)> = error.source();
    while let Some(one) = cause {
        if let Some(refused) = one.downcast_ref::<io::Error>() {
            return match refused.raw_os_error() {
                Some(number) => PyOSError::new_err((number, shown(error))),
                None => io::Error::new(refused.kind(), shown(error)).into(),
            };
        }
        cause = one.source();
    }
    PyOSError::new_err(shown(error))
}

/// An error and what it comes from.
fn shown(error: &dyn Classified) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(one) = cause {
        let more = one.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = one.source();
    }
    text
}

/// An argument of the wrong type: `name: expected this, got that`.
pub(crate) fn expected(name: &str, what: &str, got: &Bound<'_, PyAny>) -> PyErr {
    let kind = got.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let shown = got.repr().map_or_else(|_| String::new(), |repr| repr.to_string());
    let short: String = shown.chars().take(60).collect();
    PyTypeError::new_err(format!("{name}: expected {what}, got {short} ({kind})"))
}

/// An argument of the wrong value.
pub(crate) fn refused(text: impl Into<String>) -> PyErr {
    PyValueError::new_err(text.into())
}

/// Results of jbt as those of Python.
pub(crate) trait OrRaise<T> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T, E: Classified> OrRaise<T> for Result<T, E> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| raised(py, &error))
    }
}
