//! The check of members' parameters, and of the functions that formulas call.

use std::fmt;

use jbt_ir::limits;

use super::numbers::{check_count, check_expression, check_list, check_number, check_numbers, check_within};
use crate::diagnostic::{Diagnostic, Span};
use crate::expression::Expression;
use crate::falloff::Falloff;
use crate::field::{Field, FieldKind, FieldValue};
use crate::report::Report;

pub(super) fn check_falloff(report: &mut Report, span: Option<Span>, falloff: &Falloff) {
    let owner = format_args!("{} falloff", falloff.name());
    check_fields(report, span, owner, falloff.kind().fields(), &falloff.to_fields());
}

/// Checks the parameters of a skeleton, a falloff or a warp, each by its kind. Returns whether all are valid.
pub(super) fn check_fields(
    report: &mut Report,
    span: Option<Span>,
    owner: impl fmt::Display,
    fields: &[Field],
    values: &[FieldValue],
) -> bool {
    let before = report.count();
    for (field, value) in fields.iter().zip(values) {
        let what = format_args!("the `{}` of the {owner}", field.name);
        match field.kind {
            FieldKind::Real => {
                check_number(report, span, what, value.real(), f64::NEG_INFINITY);
            }
            FieldKind::Positive => {
                check_number(report, span, what, value.real(), limits::MIN_LENGTH);
            }
            FieldKind::NonNegative => {
                check_number(report, span, what, value.real(), 0.0);
            }
            FieldKind::Within { least, most } => {
                check_within(report, span, what, value.real(), least..=most);
            }
            FieldKind::Choice(words) => {
                check_within(report, span, what, value.real(), 0.0..=words.len() as f64 - 1.0);
            }
            FieldKind::Whole { least, most } => {
                check_within(report, span, what, value.real(), least.into()..=most.into());
            }
            FieldKind::Count => check_count(report, span, what, value.real()),
            FieldKind::Degrees => check_within(report, span, what, value.real(), 0.0..=360.0),
            FieldKind::Extents => check_numbers(report, span, what, &value.vector(), 0.0),
            FieldKind::Stretches => check_numbers(report, span, what, &value.vector(), limits::MIN_LENGTH),
            FieldKind::Position => check_numbers(report, span, what, &value.vector(), f64::NEG_INFINITY),
            FieldKind::Direction | FieldKind::Axis => {
                check_numbers(report, span, what, &value.vector(), f64::NEG_INFINITY);
                if value.vector() == [0.0; 3] {
                    report.add(|| {
                        Diagnostic::error(span, format!("{what} is (0 0 0)")).expected("expected a direction")
                    });
                }
            }
            FieldKind::Positions => {
                let what = |index: usize| format!("number {} of {what}", index + 1);
                check_list(report, span, &what, value.vectors(), f64::NEG_INFINITY);
            }
            FieldKind::Lengths => {
                let what = |index: usize| format!("number {} of {what}", index + 1);
                let (values, _) = value.reals().as_chunks::<1>();
                check_list(report, span, &what, values, 0.0);
            }
            FieldKind::Rows => check_numbers(report, span, what, value.reals(), f64::NEG_INFINITY),
            FieldKind::Flag => {
                check_number(report, span, what, value.real(), 0.0);
            }
        }
    }
    report.count() == before
}

/// Checks a formula with this number of values and children, and its falloffs.
pub(super) fn check_expressed(
    report: &mut Report,
    span: Option<Span>,
    formula: &Expression,
    counts: (usize, usize),
) {
    check_expression(report, span, formula, counts);
    for falloff in formula.form().falloffs() {
        check_falloff(report, span, &falloff);
    }
}
