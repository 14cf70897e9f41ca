//! Formulas of a printed model.

use std::fmt::Write as _;

use super::numbers::vector;
use crate::words::EXPRESSION;
use jbt_model::expression::{Formula, write as write_formula};

/// The head of a warp that is given by formulas.
pub(super) fn formula_warp(out: &mut String, formula: &Formula, definitions: &str) {
    out.push_str("warp (");
    let definition = |place: usize| format!("{definitions}{}", place + 1);
    // The check refuses those that ask for fields.
    let child = |place: usize| format!("missing{place}");
    let _ = write_formula(out, &formula.form, &formula.numbers, child, definition, false);
    out.push(')');
}

/// A formula with its block. `child` names the trees that it asks for.
pub(super) fn expression(
    out: &mut String,
    formula: &Formula,
    child: impl Fn(usize) -> String,
    definitions: &str,
) {
    let _ = write!(out, "{EXPRESSION} ");
    if let Some(sides) = formula.form.box_numbers(&formula.numbers) {
        let _ = write!(out, "within {} to {} ", vector(&sides[..3]), vector(&sides[3..]));
    }
    out.push_str("{ ");
    let definition = |place: usize| format!("{definitions}{}", place + 1);
    let tuple = formula.form.results.len() > 1;
    let _ = write_formula(out, &formula.form, &formula.numbers, child, definition, tuple);
    out.push_str(" }");
}
