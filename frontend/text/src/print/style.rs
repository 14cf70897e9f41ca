//! Styles of a printed model: each is printed once, in front of the nodes.

use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;

use super::comment::comment;
use super::head::head;
use jbt_model::attribute::Precedence;
use jbt_model::model::Model;
use jbt_model::traverse::Visit;
use jbt_model::tree::{StyleUse, Tree};
use jbt_model::word::{STYLE, is_identifier};
use jbt_model::written::{Written, WrittenAttribute, WrittenUv};

/// The styles of a model, by their names. A use that gives something else than the first one of its name, as
/// after an edit, is printed node by node.
pub(crate) struct Styles(BTreeMap<String, Vec<Written>>);

impl Styles {
    /// Those that a tree uses. A use that overrides does not say what of it would do so by itself, so others
    /// are looked at first.
    pub(crate) fn of(model: &Model) -> Self {
        let mut known = BTreeMap::new();
        if model.attributes.iter().any(|group| group.name.as_ref() == STYLE) {
            // The word is the attribute there.
            return Self(known);
        }
        for precedence in [Precedence::Nearest, Precedence::Override] {
            let uses = model.root.prefix(Visit::Nodes).filter_map(Tree::style);
            for style in uses.filter(|style| style.precedence == precedence && is_readable(style)) {
                known.entry(style.name.to_owned()).or_insert_with(|| style.definition());
            }
        }
        Self(known)
    }

    /// The style that a tree begins with.
    pub(crate) fn used<'a>(&self, tree: &'a Tree) -> Option<StyleUse<'a>> {
        tree.style().filter(|style| self.0.get(style.name).is_some_and(|values| style.is_of(values)))
    }

    /// The statements. Names of definitions begin with `definitions`.
    pub(super) fn print(&self, out: &mut String, model: &Model, definitions: &str) {
        for (name, values) in &self.0 {
            comment(out, model, &format!("{STYLE} {name}"));
            let _ = write!(out, "{STYLE} {name} = {{");
            for value in values {
                out.push(' ');
                head(out, value, definitions);
                if is_plain_uv(value) {
                    // Without a block behind it, a word alone would go on.
                    out.push_str(" rotate 0");
                }
            }
            out.push_str(" }\n");
        }
        if !self.0.is_empty() {
            out.push('\n');
        }
    }
}

/// Whether a text can define it: its name is a word, and it gives nothing twice.
fn is_readable(style: &StyleUse<'_>) -> bool {
    let mut given = HashSet::new();
    is_identifier(style.name) && style.values.iter().all(|value| given.insert(value.given()))
}

/// Whether it is a uv as the skeletons have it.
fn is_plain_uv(value: &Written) -> bool {
    let plain = WrittenAttribute::Uv(WrittenUv::default());
    matches!(value, Written::Attribute { value, .. } if *value == plain)
}
