//! Styles of a printed model: each is printed once, in front of the nodes.

use std::collections::BTreeMap;
use std::fmt::Write as _;

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
    pub(crate) fn of(root: &Tree) -> Self {
        let mut known = BTreeMap::new();
        for precedence in [Precedence::Nearest, Precedence::Override] {
            let uses = root.prefix(Visit::Nodes).filter_map(Tree::style);
            for style in uses.filter(|style| style.precedence == precedence && is_identifier(style.name)) {
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
            super::comment(out, model, &format!("{STYLE} {name}"));
            let _ = write!(out, "{STYLE} {name} = {{");
            for value in values {
                out.push(' ');
                super::head(out, value, definitions);
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

/// Whether it is a uv as the skeletons have it.
fn is_plain_uv(value: &Written) -> bool {
    let plain = WrittenAttribute::Uv(WrittenUv::default());
    matches!(value, Written::Attribute { value, .. } if *value == plain)
}
