//! What there is to build with, as the lists of Rust have it: names, parameters, ranges, defaults. The
//! package's `_members.py` is made of it, and a test compares the two.

use jbt::tree::{CombinatorKind, FalloffKind, Field, FieldKind, FieldValue, MapKind, SkeletonKind};
use jbt::tree::{TextureKind, WarpKind};
use jbt::{Engine, SceneFormat};
use jbt_model::function::Function;
use jbt_text::COMMON_FIELDS;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A member for Python: its family, the name of its constructor, the word of the text format, whether an
/// operator takes one child, and its parameters.
struct MemberRow {
    family: &'static str,
    name: &'static str,
    word: &'static str,
    takes_one: bool,
    fields: &'static [Field],
}

/// All members, family by family.
fn rows() -> Vec<MemberRow> {
    let mut rows = Vec::new();
    let mut add = |family, name, word, takes_one, fields| {
        rows.push(MemberRow { family, name, word, takes_one, fields });
    };
    for kind in SkeletonKind::ALL {
        add("skeleton", kind.constructor(), kind.name(), false, kind.fields());
    }
    for kind in FalloffKind::ALL {
        add("falloff", kind.constructor(), kind.name(), false, kind.fields());
    }
    for kind in CombinatorKind::ALL {
        add("operator", kind.constructor(), kind.name(), kind.takes_one(), kind.fields());
    }
    for kind in MapKind::ALL {
        add("map", kind.constructor(), kind.name(), true, kind.fields());
    }
    for kind in WarpKind::ALL {
        add("warp", kind.constructor(), kind.name(), true, kind.fields());
    }
    for kind in TextureKind::ALL {
        add("texture", kind.constructor(), kind.name(), false, kind.fields());
    }
    rows
}

/// The kind of a parameter in a word, and the words or numbers that belong to it.
fn kind(kind: FieldKind) -> (&'static str, Vec<String>) {
    let none = Vec::new;
    match kind {
        FieldKind::Real => ("real", none()),
        FieldKind::Positive => ("positive", none()),
        FieldKind::NonNegative => ("non_negative", none()),
        FieldKind::Within { least, most } => ("within", vec![least.to_string(), most.to_string()]),
        FieldKind::Choice(words) => ("choice", words.iter().map(ToString::to_string).collect()),
        FieldKind::Count => ("count", none()),
        FieldKind::Whole { least, most } => ("whole", vec![least.to_string(), most.to_string()]),
        FieldKind::Degrees => ("degrees", none()),
        FieldKind::Position => ("position", none()),
        FieldKind::Extents => ("extents", none()),
        FieldKind::Stretches => ("stretches", none()),
        FieldKind::Direction => ("direction", none()),
        FieldKind::Axis => ("axis", none()),
        FieldKind::Positions => ("positions", none()),
        FieldKind::Lengths => ("lengths", none()),
        FieldKind::Flag => ("flag", none()),
        FieldKind::Rows => ("rows", none()),
    }
}

/// The default of a parameter as an expression of Python's; `None` if it has to be written.
fn default(field: &Field) -> Option<String> {
    let numbers = |numbers: &[f64]| {
        let shown: Vec<String> = numbers.iter().map(f64::to_string).collect();
        format!("({}{})", shown.join(", "), if shown.len() == 1 { "," } else { "" })
    };
    Some(match (field.default.as_ref()?, field.kind) {
        (FieldValue::Real(place), FieldKind::Choice(words)) => format!("{:?}", words[*place as usize]),
        (FieldValue::Real(flag), FieldKind::Flag) => if *flag == 0.0 { "False" } else { "True" }.to_owned(),
        (FieldValue::Vector(axis), FieldKind::Axis) => {
            let place = axis.iter().position(|x| *x == 1.0).unwrap_or(2);
            format!("{:?}", ["x", "y", "z"][place])
        }
        (FieldValue::Real(number), _) => number.to_string(),
        (FieldValue::Vector(vector), _) => numbers(vector),
        (FieldValue::Reals(list), _) => numbers(list),
        (FieldValue::Vectors(list), _) => numbers(list.as_flattened()),
    })
}

/// Every member: dictionaries with `family`, `name`, `word`, `takes_one`, and `fields`, which are tuples of
/// the name, the word of the text format, the kind, the words or ends of the range, and the default.
#[pyfunction]
pub(crate) fn members(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let each = |row: MemberRow| {
        let word = |field: &Field| {
            let common = row.family == "skeleton" && COMMON_FIELDS.contains(&field.name);
            if common { format!("{}_{}", row.word, field.name) } else { field.name.to_owned() }
        };
        let fields: Vec<_> = row
            .fields
            .iter()
            .map(|field| {
                let (kind, words) = kind(field.kind);
                (field.name, word(field), kind, words, default(field))
            })
            .collect();
        let member = PyDict::new(py);
        member.set_item("family", row.family)?;
        member.set_item("name", row.name)?;
        member.set_item("word", row.word)?;
        member.set_item("takes_one", row.takes_one)?;
        member.set_item("fields", fields)?;
        Ok(member)
    };
    rows().into_iter().map(each).collect()
}

/// Every function of formulas, with the least and the largest number of its arguments.
#[pyfunction]
pub(crate) fn functions() -> Vec<(&'static str, usize, usize)> {
    let row = |function: Function| (function.name(), function.arity().0, function.arity().1);
    Function::ALL.into_iter().map(row).collect()
}

/// The endings of scene files.
#[pyfunction]
pub(crate) fn scene_formats() -> Vec<&'static str> {
    SceneFormat::ALL.iter().flat_map(|format| format.extensions()).copied().collect()
}

/// The endings of mesh files.
#[pyfunction]
pub(crate) fn mesh_formats() -> Vec<&'static str> {
    jbt::export::Format::ALL.iter().map(|format| format.extension()).collect()
}

/// The names of engines.
#[pyfunction]
pub(crate) fn engines() -> Vec<&'static str> {
    Engine::ALL.iter().map(|engine| engine.name()).collect()
}

/// The names of views.
#[pyfunction]
pub(crate) fn views() -> Vec<&'static str> {
    jbt::render::VIEWS.iter().map(|(name, _)| *name).collect()
}
