//! What can be open while a scene is run: directives, blobs, groups, looks.

use glam::DAffine3;
use jbt_model::diagnostic::Span;

use super::amount::Amount;
use super::shape::{Color, PovBlob, PovShapes};

/// A directive that ends with `#end`.
pub(super) enum PovBlock {
    /// A branch that is taken.
    If,
    /// A case that is taken.
    Switch,
    While {
        /// The place of the condition.
        condition: usize,
        /// Whether the condition asked for nothing that can change.
        constant: bool,
    },
    For {
        name: String,
        value: f64,
        last: f64,
        step: f64,
        /// The place behind the head.
        body: usize,
    },
}

/// Something that is open.
pub(super) enum PovFrame {
    /// A declaration that waits for its value.
    Declaration(String),
    Blob(PovBlob),
    Component(ComponentFrame),
    Group(GroupFrame),
    Look(LookFrame),
    Skip(SkipFrame),
    Transform(DAffine3),
}

/// A component of a blob.
pub(super) struct ComponentFrame {
    pub(super) is_sphere: bool,
    pub(super) arguments: Vec<(Amount, Span)>,
    pub(super) map: DAffine3,
    pub(super) color: Option<Color>,
}

/// Shapes that are one object.
pub(super) struct GroupFrame {
    pub(super) word: &'static str,
    /// Whether it is more than the union of its shapes.
    pub(super) is_set_operation: bool,
    pub(super) shapes: PovShapes,
    pub(super) count: usize,
    pub(super) map: DAffine3,
    pub(super) color: Option<Color>,
}

/// A pigment, a texture, a material.
pub(super) struct LookFrame {
    pub(super) depth: usize,
    pub(super) color: Option<Color>,
    /// Whether it gives the colour of what has none.
    pub(super) is_default: bool,
}

/// What is left out; its braces are counted.
pub(super) struct SkipFrame {
    pub(super) word: String,
    pub(super) depth: usize,
}

/// What became of a modifier.
pub(super) enum Modifier {
    Map(DAffine3),
    /// It was read, or its braces are open now.
    Done,
    /// It is none.
    None,
}

/// Shapes that are no blobs.
pub(super) const SHAPES: [&str; 29] = [
    "bicubic_patch",
    "box",
    "cone",
    "cubic",
    "cylinder",
    "disc",
    "height_field",
    "isosurface",
    "julia_fractal",
    "lathe",
    "lemon",
    "mesh",
    "mesh2",
    "ovus",
    "parametric",
    "plane",
    "poly",
    "polygon",
    "polynomial",
    "prism",
    "quadric",
    "quartic",
    "smooth_triangle",
    "sor",
    "sphere",
    "sphere_sweep",
    "superellipsoid",
    "torus",
    "triangle",
];

impl PovFrame {
    /// The look of what has none.
    pub(super) fn default_look() -> Self {
        Self::Look(LookFrame { depth: 1, color: None, is_default: true })
    }

    pub(super) fn skip(word: &str) -> Self {
        Self::Skip(SkipFrame { word: word.to_owned(), depth: 1 })
    }

    /// How messages call it.
    pub(super) fn word(&self) -> &str {
        match self {
            Self::Declaration(_) => "declaration",
            Self::Blob(_) => "blob",
            Self::Component(_) => "component",
            Self::Group(group) => group.word,
            Self::Look(_) => "texture",
            Self::Skip(skip) => &skip.word,
            Self::Transform(_) => "transform",
        }
    }
}
