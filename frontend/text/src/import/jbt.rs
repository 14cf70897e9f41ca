//! The row of our own text format; [`parse`](crate::parse) reads it.

use super::Imported;
use super::format::SceneFormatRow;
use jbt_model::diagnostic::Diagnostics;

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    has_parameters: true,
    ..SceneFormatRow::new(&["jbt"], "a .jbt text", |bytes, options| {
        let model = crate::parse(bytes, options)?;
        Ok(Imported { model, warnings: Diagnostics::default() })
    })
};
