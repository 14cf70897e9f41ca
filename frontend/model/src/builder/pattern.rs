//! Textures in Rust: what [`Tree::textured`](crate::tree::Tree::textured) takes.

use crate::texture::TextureKind;
use crate::written::FieldNumber;

/// A texture whose numbers may depend on parameters.
#[derive(Clone, PartialEq, Debug)]
pub struct Pattern {
    pub(super) texture: TextureKind,
    pub(super) fields: Vec<FieldNumber>,
}
