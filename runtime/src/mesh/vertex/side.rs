//! Vertices on edges and corners, and the smooth parts of the surface that meet there.

/// A vertex on an edge or a corner of the surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SharpVertex {
    /// Its number.
    pub(crate) vertex: u32,
    /// Where it was put: it [goes back](super::super::fold) if triangles are folded there.
    pub(crate) placed: [f32; 3],
    /// The edge of its cell.
    pub(crate) size: f32,
    /// What meets there.
    pub(crate) sides: Vec<SharpSide>,
    /// Where it would be if edges were cut off, and its unit normal there.
    pub(crate) cut: CutVertex,
}

/// A vertex that cuts an edge off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CutVertex {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
}

/// A smooth part of the surface that ends at a vertex.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SharpSide {
    /// The edges of the vertex's cell at which the surface is that of this side, a bit each.
    pub(crate) edges: u16,
    /// The unit normal.
    pub(crate) normal: [f32; 3],
    /// All channels of all attributes.
    pub(crate) attributes: Vec<f32>,
}

impl SharpVertex {
    /// The side at a crossed edge of its cell.
    pub(crate) fn side(&self, edge: u32) -> usize {
        self.sides.iter().position(|side| side.edges >> edge & 1 == 1).unwrap_or(0)
    }
}
