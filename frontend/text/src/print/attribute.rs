//! Attributes of a printed model: what stands in front of their blocks.

use std::fmt::Write as _;

use super::formula::expression;
use super::numbers::{group_values, vector};
use crate::words::{EXPRESSION, GROUP_NODE, is_reserved, texture_named};
use jbt_model::attribute::Precedence;
use jbt_model::number::Number;
use jbt_model::word::OVERRIDE;
use jbt_model::written::{WrittenAttribute, WrittenTextured, WrittenUv};

/// What stands before an attribute or a constant.
pub(super) fn before(out: &mut String, precedence: Precedence) {
    match precedence {
        Precedence::Nearest => {}
        Precedence::Override => {
            let _ = write!(out, "{OVERRIDE} ");
        }
    }
}

pub(super) fn attribute(out: &mut String, name: &str, value: &WrittenAttribute, definitions: &str) {
    if is_reserved(name) {
        let _ = write!(out, "{GROUP_NODE} ");
    }
    out.push_str(name);
    match value {
        WrittenAttribute::Numbers(numbers) => {
            let text = group_values(numbers);
            let first = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next();
            // A parameter that is called like what computes.
            let hidden = first.is_some_and(|word| word == EXPRESSION || texture_named(word).is_some());
            let _ = if hidden { write!(out, " ({text})") } else { write!(out, " {text}") };
        }
        WrittenAttribute::Textured(WrittenTextured { texture, fields, a, b }) => {
            let _ = write!(out, " {} {{ a {} b {}", texture.name(), group_values(a), group_values(b));
            for (described, value) in texture.fields().iter().zip(fields) {
                described.write(out, described.name, value);
            }
            out.push_str(" }");
        }
        WrittenAttribute::Uv(map) => uv(out, map),
        WrittenAttribute::Expressed(formula) => {
            out.push(' ');
            expression(out, formula, |place| format!("n{place}"), definitions);
        }
    }
}

/// A map of uv, without the parts that change nothing.
fn uv(out: &mut String, map: &WrittenUv) {
    let identity = WrittenUv::default();
    if !same_numbers(&map.scale, &identity.scale) {
        let _ = write!(out, " scale {}", vector(&map.scale));
    }
    if !same_numbers(std::slice::from_ref(&map.degrees), &[identity.degrees]) {
        let _ = write!(out, " rotate {}", map.degrees);
    }
    if !same_numbers(&map.shift, &identity.shift) {
        let _ = write!(out, " shift {}", vector(&map.shift));
    }
}

/// Whether numbers are plain and have the same bits.
fn same_numbers(a: &[Number], b: &[Number]) -> bool {
    let plain = |number: &Number| (!number.depends_on_parameters()).then(|| number.value().to_bits());
    a.iter().zip(b).all(|(a, b)| plain(a).is_some() && plain(a) == plain(b))
}
