//! three-js-blobtree: trees in JSON, as the library's `toJSON` writes them (version 2.130).
//!
//! ```text
//! {"type": "RootNode", "iso": 1, "ricci_n": 64, "children": [
//!     {"type": "RicciNode", "ricci_n": 2, "children": [
//!         {"type": "ScalisPoint", "volType": "dist", "density": 1, "materials": [{"color": "#dd4f43"}],
//!          "v": [{"position": {"x": 0, "y": 0, "z": 0}, "thickness": 2}]},
//!         {"type": "ScalisSegment", ..}]}]}
//! ```
//!
//! Where the library itself is defective (boxes that cut, distances from cones, a blend of undefined order),
//! the mathematics of the format is followed. Coordinates are those of the file: y is up.

mod json;
mod leaf;
mod material;
mod node;
mod quadrature;
mod reader;
mod scalis;

use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_model::diagnostic::{Diagnostic, Diagnostics};
use jbt_model::model::Model;
use jbt_model::orientation::Orientation;

use self::json::Json;
use self::reader::TreeReader;
use super::Imported;
use super::format::SceneFormatRow;
use super::tally::LeftOut;

/// An object that soon says its type.
pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    recognizes: |bytes| {
        let begin = &bytes[..bytes.len().min(1 << 12)];
        let first = begin.iter().find(|byte| !byte.is_ascii_whitespace());
        first == Some(&b'{') && begin.windows(6).any(|window| window == b"\"type\"")
    },
    ..SceneFormatRow::new(&["json"], "a three-js-blobtree", |bytes, _| threejs(bytes))
};

/// The model of a tree of three-js-blobtree (`.json`).
///
/// # Errors
///
/// The first error of the file, with its place: what is no JSON, members that are missing or have no meaning,
/// types that are not known, functors that a page has registered, convolutions whose thickness changes by
/// half the length or more.
pub fn threejs(bytes: &[u8]) -> Result<Imported, Diagnostics> {
    Imported::from(bytes, read(bytes))
}

fn read(bytes: &[u8]) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
    if bytes.len() > MAX_SCENE_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_SCENE_BYTES} are read", bytes.len());
        return Err(vec![Diagnostic::limit(None, message)]);
    }
    let json = Json::read(bytes).map_err(|error| vec![error])?;
    let mut reader =
        TreeReader { json, left_out: LeftOut::default(), negative: false, surface: Default::default() };
    reader.find_surface();
    let model = model(&mut reader);
    let warnings = reader.left_out.finish();
    match model {
        Ok(model) => Ok((model, warnings)),
        Err(error) => Err([vec![error], warnings].concat()),
    }
}

fn model(reader: &mut TreeReader<'_>) -> Result<Model, Diagnostic> {
    let iso = match reader.json.member(0, "iso") {
        Some(_) => reader.positive(0, "iso")?,
        None => 1.0,
    };
    let root = reader.tree(0)?;
    let attributes = reader.groups();
    Ok(Model { iso: iso.into(), attributes, orientation: Orientation::Y_RIGHT, ..Model::new(root) })
}
