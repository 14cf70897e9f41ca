//! POV-Ray: the `blob` of a scene (POV-Ray 3.5 to 3.8).
//!
//! ```text
//! blob {
//!     threshold 0.6
//!     sphere { <0.75, 0, 0>, 1, 1  pigment { color rgb <0.7, 0, 0.05> } }
//!     #declare N = 0;
//!     #while (N < 5)
//!         cylinder { 0, x, 0.3, 0.8  rotate 72*N*z }
//!         #declare N = N + 1;
//!     #end
//!     scale 2
//! }
//! ```
//!
//! The language is a programming language: a scene is run, token by token. What is open (a blob, a group, a
//! pigment) and which directives are open stand on two lists, so nothing here recurses. Steps are counted.
//!
//! The field of a blob is the sum of `S (1 - d^2 / r^2)^2`, which is the falloff `quartic`: the model is the
//! same to the bit of a formula. It is inside where the field is above the threshold, the iso-value here. If
//! blobs of one scene have different thresholds, strengths are divided by them, and the iso-value is 1.
//!
//! `#include` reads files beside the scene, through the resolver of the caller.
//!
//! Coordinates are those of the scene: y is up, and axes are left-handed.

mod amount;
mod blob;
mod colors;
mod directive;
mod expression;
mod frame;
mod group;
mod include;
mod look;
mod modifier;
mod open;
mod scan;
mod scene;
mod script;
mod shape;
mod texts;
mod transform;

use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_model::diagnostic::{Diagnostic, Diagnostics};
use jbt_model::model::Model;

use self::script::Script;
use self::texts::PovTexts;
use super::Imported;
use super::format::SceneFormatRow;
use crate::Options;

/// A directive without a blank behind its `#`, or a block of a scene, comes first.
pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    recognizes: scene::is_scene,
    has_objects: true,
    ..SceneFormatRow::new(&["pov", "inc"], "a POV-Ray scene", pov)
};

/// The model of the blobs of a POV-Ray scene (`.pov`): of all that it places, or of those of the declared
/// object that the options choose.
///
/// # Errors
///
/// The first error of the scene, with its place: what is no text of the language, names without a number
/// where a blob needs one, loops that take too many steps, blobs in set operations with other shapes, a scene
/// that places no blob.
pub fn pov(bytes: &[u8], options: &Options) -> Result<Imported, Diagnostics> {
    let texts = PovTexts::new(bytes, &options.files);
    Imported::of(texts.source(), read(&texts, options))
}

fn read(texts: &PovTexts, options: &Options) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
    if texts.own() > MAX_SCENE_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_SCENE_BYTES} are read", texts.own());
        return Err(vec![Diagnostic::limit(None, message)]);
    }
    let mut script = Script::new(texts);
    let ran = script.run().and_then(|()| scene::model(&mut script, options.object.as_deref()));
    let warnings = script.left_out.finish();
    match ran {
        Ok(model) => Ok((model, warnings)),
        Err(error) => Err([vec![error], warnings].concat()),
    }
}
