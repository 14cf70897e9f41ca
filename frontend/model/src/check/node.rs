//! The check of one node by itself.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3};
use jbt_ir::limits;

use super::constants::check_constant;
use super::fields::{check_expressed, check_falloff, check_fields};
use super::groups::{check_attribute, check_override};
use super::numbers::{check_choice, check_formula, check_number, check_numbers};
use super::particles::check_particles;
use crate::diagnostic::{Diagnostic, Span};
use crate::kind::{NodeKind, Primitive};
use crate::report::Report;
use crate::warp::Warp;

/// The smallest reciprocal condition number of an affine map's linear part: below it, the map counts as
/// singular.
///
/// It is `1 / (|A| |A^-1|)` in the largest column sum norm, computed in f64: at best 1 for a rotation, 0 for
/// a singular map, and independent of uniform scale. At 1e-12, an f64 inverse is still right to about four
/// digits.
pub const MIN_RECIPROCAL_CONDITION: f64 = 1e-12;

pub(super) fn check_node(
    report: &mut Report,
    kind: &NodeKind,
    count: usize,
    span: Option<Span>,
    groups: &BTreeMap<&str, usize>,
    iso: f64,
) {
    let fits = match kind {
        NodeKind::Primitive(leaf) => {
            check_primitive(report, span, leaf);
            (count == 0, "no children")
        }
        NodeKind::Particles(particles) => {
            check_particles(report, span, particles, groups);
            (count == 0, "no children")
        }
        NodeKind::Combine(combinator) => {
            let kind = combinator.kind();
            let well = check_fields(report, span, kind.name(), kind.fields(), &combinator.to_fields());
            if let Some(fault) = combinator.fault(iso).filter(|_| well) {
                report.add(|| Diagnostic { span, ..fault });
            }
            if kind.takes_one() { (count == 1, "one child") } else { (count >= 1, "at least one child") }
        }
        NodeKind::Expression(expression) => {
            check_expressed(report, span, expression, (1, count));
            (true, "as many children as the formula names")
        }
        NodeKind::Select(which) => {
            check_choice(report, span, *which, count);
            (count >= 1, "at least one child")
        }
        NodeKind::Affine(map) => {
            check_affine(report, span, map);
            (count == 1, "one child")
        }
        NodeKind::Warp(warp) => {
            check_fields(report, span, warp.name(), warp.fields(), &warp.to_fields());
            if let Warp::Formula(warp) = warp {
                check_formula(report, span, "the warp", &warp.form, &warp.numbers);
                for falloff in warp.form.falloffs() {
                    check_falloff(report, span, &falloff);
                }
            }
            if let Some(fault) = warp.fault() {
                report.add(|| Diagnostic::error(span, fault.message).expected(fault.expected));
            }
            (count == 1 || count == 2, "one child, or a second one that gives its weight")
        }
        NodeKind::Attribute { name, value, .. } => {
            check_override(report, span, kind, groups);
            check_attribute(report, span, name, value, groups);
            (count == 1, "one child")
        }
        NodeKind::Constant { name, value, .. } => {
            check_override(report, span, kind, groups);
            check_constant(report, span, (name, value), groups);
            (count == 1, "one child")
        }
    };
    if let (false, expected) = fits {
        let message = format!("{} has {count} children", describe(kind));
        report.add(|| Diagnostic::error(span, message).expected(format!("expected {expected}")));
    }
}

/// A node's kind in words.
fn describe(kind: &NodeKind) -> String {
    match kind {
        NodeKind::Primitive(leaf) => format!("a {}", leaf.skeleton.kind().name()),
        NodeKind::Particles(_) => "a node `particles`".to_owned(),
        NodeKind::Combine(combinator) => format!("a node `{}`", combinator.name()),
        NodeKind::Select(_) => "a node `select`".to_owned(),
        NodeKind::Expression(_) => "a node `expression`".to_owned(),
        NodeKind::Affine(_) => "an affine map".to_owned(),
        NodeKind::Warp(warp) => format!("a {}", warp.name()),
        NodeKind::Attribute { name, .. } => format!("the attribute node `{name}`"),
        NodeKind::Constant { name, .. } => format!("the constant `{name}`"),
    }
}

fn check_primitive(report: &mut Report, span: Option<Span>, leaf: &Primitive) {
    let kind = leaf.skeleton.kind();
    let well = check_fields(report, span, kind.name(), kind.fields(), &leaf.skeleton.to_fields());
    if let Some(fault) = leaf.skeleton.fault().filter(|_| well) {
        report.add(|| Diagnostic { span, ..fault });
    }
    check_falloff(report, span, &leaf.falloff);
    // The support radius. Of a `surface_radius` it is derived, and the message has the derived number.
    check_number(report, span, "the radius", leaf.radius, limits::MIN_LENGTH);
    check_number(report, span, "the strength", leaf.strength, f64::NEG_INFINITY);
}

/// An affine map has to have an inverse, in numbers that f32 can hold.
fn check_affine(report: &mut Report, span: Option<Span>, map: &DAffine3) {
    let numbers = map.to_cols_array();
    if !numbers.iter().all(|x| x.is_finite() && x.abs() <= limits::MAX_NUMBER) {
        check_numbers(report, span, "the affine map (by columns)", &numbers, f64::NEG_INFINITY);
        return;
    }
    let size = largest(map.matrix3);
    let inverse = (map.matrix3 * (1.0 / size)).inverse();
    // A singular matrix has an inverse of infinities and NaNs.
    let condition = if inverse.is_finite() { 1.0 / (norm(map.matrix3) / size * norm(inverse)) } else { 0.0 };
    if condition < MIN_RECIPROCAL_CONDITION {
        let message = format!("the affine map is singular: its reciprocal condition is {condition:.1e}");
        let least = MIN_RECIPROCAL_CONDITION;
        report.add(|| Diagnostic::error(span, message).expected(format!("expected at least {least:e}")));
        return;
    }
    // With |t| <= MAX_NUMBER this bounds the inverse's translation too, at 3e30: finite in f32.
    let least = limits::MIN_LENGTH;
    if largest(inverse) / size > 1.0 / least {
        let message = format!("the affine map shrinks {:.1e} times", largest(inverse) / size);
        report.add(|| {
            Diagnostic::error(span, message).expected(format!("expected a scale of at least {least:e}"))
        });
    }
}

/// The largest magnitude of a matrix's numbers.
fn largest(m: DMat3) -> f64 {
    m.to_cols_array().iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// The largest sum of magnitudes of a column.
fn norm(m: DMat3) -> f64 {
    [m.x_axis, m.y_axis, m.z_axis].iter().map(|column| column.abs().element_sum()).fold(0.0, f64::max)
}
