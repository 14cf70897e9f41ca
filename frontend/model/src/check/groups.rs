//! The check of attribute groups, and of the values of attribute nodes.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use jbt_ir::limits;

use super::fields::{check_expressed, check_fields};
use super::numbers::check_numbers;
use crate::attribute::{AttributeGroup, AttributeValue, Textured};
use crate::diagnostic::{Diagnostic, Span};
use crate::kind::NodeKind;
use crate::report::{Report, clip, nearest};
use crate::word::{OVERRIDE, is_identifier};

/// The groups of a model: `color` first, names that are identifiers and unique, widths and defaults.
pub(super) fn check_groups(report: &mut Report, groups: &[AttributeGroup]) {
    if groups.first().is_none_or(|group| &*group.name != "color" || group.width() != 3) {
        report.add(|| Diagnostic::error(None, "the first attribute is not `color` with 3 reals"));
    }
    if groups.len() > limits::MAX_ATTRIBUTES {
        let message = format!("{} attributes; there may be {}", groups.len(), limits::MAX_ATTRIBUTES);
        report.add(|| Diagnostic::limit(None, message));
    }
    let mut seen = HashSet::new();
    for group in groups {
        let name = &group.name;
        if !is_identifier(name) {
            report.add(|| {
                Diagnostic::error(None, format!("an attribute is called `{name}`"))
                    .expected("expected letters, digits and underscores, beginning with a letter")
            });
        } else if RESERVED.contains(&&**name) {
            let message = format!("an attribute is called `{name}`, like another answer at a point");
            report.add(|| Diagnostic::error(None, message));
        }
        if !seen.insert(name) {
            report.add(|| Diagnostic::error(None, format!("two attributes are called `{name}`")));
        }
        let width = group.width();
        if width == 0 {
            report.add(|| Diagnostic::error(None, format!("the attribute `{name}` has no reals")));
        } else if width > limits::MAX_ATTRIBUTE_WIDTH {
            let most = limits::MAX_ATTRIBUTE_WIDTH;
            report.add(|| {
                Diagnostic::limit(
                    None,
                    format!("the attribute `{name}` has {width} reals; it may have {most}"),
                )
            });
        }
        if group.turns() && width != 3 {
            let message = format!("the direction `{name}` has {width} reals, and a direction has 3");
            report.add(|| Diagnostic::error(None, message));
        }
        let what = format!("the default of `{name}`");
        check_numbers(report, None, &what, &group.default, f64::NEG_INFINITY);
    }
}

/// The names of the other answers in tables of samples.
const RESERVED: [&str; 7] = ["x", "y", "z", "field", "gx", "gy", "gz"];

/// The widths of attribute groups, by name.
pub(super) fn widths(groups: &[AttributeGroup]) -> BTreeMap<&str, usize> {
    groups.iter().map(|group| (&*group.name, group.width())).collect()
}

/// Lets an attribute node share the name of its group, so that a search for the group compares pointers.
pub(super) fn share_name(kind: &mut NodeKind, groups: &[AttributeGroup]) {
    if let NodeKind::Attribute { name, .. } = kind
        && let Some(group) = groups.iter().find(|group| group.name == *name)
    {
        *name = Arc::clone(&group.name);
    }
}

/// The width of a group, or a message that there is none of this name.
pub(super) fn known_width(
    report: &mut Report,
    span: Option<Span>,
    name: &str,
    groups: &BTreeMap<&str, usize>,
) -> Option<usize> {
    let width = groups.get(name).copied();
    if width.is_none() {
        report.add(|| {
            let help = match nearest(name, groups.keys().copied()) {
                Some(other) => format!("perhaps `{other}` was meant"),
                None => "declare it with its default first".to_owned(),
            };
            Diagnostic::error(span, format!("there is no attribute `{}`", clip(name))).expected(help)
        });
    }
    width
}

/// A message about values of another width than their group has.
pub(super) fn another_width(span: Option<Span>, name: &str, width: usize, found: usize) -> Diagnostic {
    let message = format!("the attribute `{name}` has width {width}, not {found}");
    let plural = if width == 1 { "" } else { "s" };
    Diagnostic::error(span, message).expected(format!("expected {width} real{plural}"))
}

/// What overrides is read as that, unless a group has the word's name.
pub(super) fn check_override(
    report: &mut Report,
    span: Option<Span>,
    kind: &NodeKind,
    groups: &BTreeMap<&str, usize>,
) {
    if kind.overrides() && groups.contains_key(OVERRIDE) {
        report.add(|| {
            let message = format!("`{OVERRIDE}` beside an attribute of this name");
            Diagnostic::error(span, message).expected("expected another name of the attribute")
        });
    }
}

/// An attribute node: its group exists, and its value fits the group.
pub(super) fn check_attribute(
    report: &mut Report,
    span: Option<Span>,
    name: &str,
    value: &AttributeValue,
    groups: &BTreeMap<&str, usize>,
) {
    let Some(width) = known_width(report, span, name, groups) else { return };
    let mut fits = |numbers: &[f64]| {
        if numbers.len() != width {
            report.add(|| another_width(span, name, width, numbers.len()));
        }
        check_numbers(report, span, format_args!("the attribute `{name}`"), numbers, f64::NEG_INFINITY);
    };
    match value {
        AttributeValue::Numbers(numbers) => fits(numbers),
        AttributeValue::Textured(Textured { texture, a, b }) => {
            fits(a);
            fits(b);
            let kind = texture.kind();
            check_fields(report, span, kind.name(), kind.fields(), &texture.to_fields());
            if let Some((message, help)) = texture.fault() {
                report.add(|| Diagnostic::error(span, message).expected(help));
            }
        }
        AttributeValue::Expressed(expression) if expression.form().children() > 0 => {
            let message = format!("the formula of the attribute `{name}` asks for a field");
            report.add(|| Diagnostic::error(span, message).expected("expected coordinates and numbers"));
        }
        AttributeValue::Expressed(expression) => check_expressed(report, span, expression, (width, 0)),
        AttributeValue::Uv(map) => {
            if width != 2 {
                let message = format!("the attribute `{name}` has width {width}, and a uv has 2");
                report.add(|| Diagnostic::error(span, message).expected("expected a group of 2 reals"));
            }
            let numbers = [&map.scale[..], &[map.degrees], &map.shift].concat();
            check_numbers(
                report,
                span,
                "the map of the uv (scale, degrees, shift)",
                &numbers,
                f64::NEG_INFINITY,
            );
        }
    }
}
