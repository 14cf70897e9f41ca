//! Field and attributes at the named points are those that were worked out by hand: in the oracle to 1e-12,
//! attributes to 1e-9, because the oracle takes weights of expressions by differences; on every engine to
//! 1e-5, relatively.

use jbt::Points;
use jbt_model::walk::walk;

use super::Verdict;
use crate::common::answers;
use crate::subject::Subject;

/// What the oracle may be off by, and what the engines may, relatively.
const PLAIN: f64 = 1e-12;
const PLAIN_ATTRIBUTES: f64 = 1e-9;
const COMPILED: f64 = 1e-5;
/// Below this a number counts as so large.
const SMALLEST: f64 = 1e-2;

pub fn check(subject: &Subject) -> Verdict {
    if subject.row.fields.is_empty() && subject.row.attributes.is_empty() {
        return Err("the row knows no value".to_owned());
    }
    oracle(subject)?;
    subject.all.iter().try_for_each(|evaluator| {
        let name = evaluator.engine().name();
        let at = |point: [f64; 3]| -> Points { [point.map(|x| x as f32)].into_iter().collect() };
        for &(point, expected) in &subject.row.fields {
            let field = answers(evaluator, &at(point)).field()[0];
            near(&format!("the field by {name} at {point:?}"), f64::from(field), expected, COMPILED)?;
        }
        for known in &subject.row.attributes {
            let samples = answers(evaluator, &at(known.at));
            let channels =
                samples.attribute(known.group).ok_or_else(|| format!("no group {}", known.group))?;
            let values: Vec<f64> = channels.iter().map(|channel| f64::from(channel[0])).collect();
            all_near(
                &format!("{} by {name} at {:?}", known.group, known.at),
                &values,
                &known.values,
                COMPILED,
            )?;
        }
        Ok(())
    })
}

fn oracle(subject: &Subject) -> Verdict {
    for &(point, expected) in &subject.row.fields {
        let field = walk(&subject.tree, point).field;
        near(&format!("the field by the oracle at {point:?}"), field, expected, PLAIN)?;
    }
    for known in &subject.row.attributes {
        let groups = subject.tree.attributes();
        let group = groups.iter().position(|group| &*group.name == known.group);
        let group = group.ok_or_else(|| format!("no group {}", known.group))?;
        let values = &walk(&subject.tree, known.at).attributes[group];
        all_near(
            &format!("{} by the oracle at {:?}", known.group, known.at),
            values,
            &known.values,
            PLAIN_ATTRIBUTES,
        )?;
    }
    Ok(())
}

fn all_near(what: &str, got: &[f64], expected: &[f64], within: f64) -> Verdict {
    if got.len() != expected.len() {
        return Err(format!("{what}: expected {expected:?}, got {got:?}"));
    }
    got.iter().zip(expected).try_for_each(|(&got, &expected)| near(what, got, expected, within))
}

fn near(what: &str, got: f64, expected: f64, within: f64) -> Verdict {
    if (got - expected).abs() <= within * expected.abs().max(SMALLEST) {
        return Ok(());
    }
    Err(format!("{what}: expected {expected:?}, got {got:?}"))
}
