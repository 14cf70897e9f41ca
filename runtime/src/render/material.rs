//! What a surface is made of, beside its colour.

/// The material of a surface, from the attributes `rough`, `metal` and `glow` where a model has them.
#[derive(Clone, Copy)]
pub struct SurfaceMaterial {
    /// From 0, a mirror under lacquer, to 1, chalk.
    pub rough: f32,
    /// From 0, paint on plastic, to 1, a metal of this colour.
    pub metal: f32,
    /// The light that the surface gives by itself, as a multiple of its colour; 0 or more.
    pub glow: f32,
}

impl Default for SurfaceMaterial {
    /// A soft sheen on plastic.
    fn default() -> Self {
        Self { rough: 0.43, metal: 0.0, glow: 0.0 }
    }
}
