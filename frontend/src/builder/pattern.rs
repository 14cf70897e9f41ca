//! Textures in Rust: what [`Tree::textured`](crate::tree::Tree::textured) takes.

use crate::recipe::FieldNumber;
use crate::texture::TextureKind;

/// A texture whose numbers may follow parameters.
#[derive(Clone, PartialEq, Debug)]
pub struct Pattern {
    pub(super) texture: TextureKind,
    pub(super) fields: Vec<FieldNumber>,
}
