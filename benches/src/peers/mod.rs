//! Other people's libraries, given the same blobs (feature `peers`).
//!
//! | module | library | what is comparable |
//! |---|---|---|
//! | [`fidget`] | fidget: JIT of closed-form implicit surfaces | field, gradient and mesh of the same function |
//! | [`splashsurf`] | splashsurf: surfaces of particle fluids | the amount of work for a mesh, not the surface |
//!
//! Whoever reports a time asks [`crate::check`] first, and reports a disagreement instead where there is one.

pub mod fidget;
pub mod splashsurf;

/// What a mesher made.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MeshSize {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
}

/// On how many threads a mesher runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Threads {
    /// One.
    One,
    /// As many as the machine has.
    All,
}

#[cfg(test)]
mod tests;
