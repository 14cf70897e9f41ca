//! Comments of a printed model.

use std::fmt::Write as _;

use jbt_model::diagnostic::escape;
use jbt_model::model::Model;

/// The comment in front of a statement.
pub(super) fn comment(out: &mut String, model: &Model, statement: &str) {
    let lines = model.comments.get(statement).into_iter().flat_map(|text| text.lines());
    for line in lines {
        let line = escape(line);
        // What is no comment would be a statement.
        let mark = if line.is_empty() || line.starts_with('#') { "" } else { "# " };
        let _ = writeln!(out, "{mark}{line}");
    }
}
