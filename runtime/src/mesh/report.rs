//! How a mesh was made, and its properties.

use std::fmt;

/// Some of the six sides of a lattice. Prints as `-x +z`, or `none`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sides {
    /// The low sides, at the first corners along x, y and z.
    pub low: [bool; 3],
    /// The high sides.
    pub high: [bool; 3],
}

impl Sides {
    pub(super) fn add(&mut self, other: Self) {
        for axis in 0..3 {
            self.low[axis] |= other.low[axis];
            self.high[axis] |= other.high[axis];
        }
    }

    /// Whether any side is among them.
    pub fn any(self) -> bool {
        self.low.iter().chain(&self.high).any(|&side| side)
    }
}

impl fmt::Display for Sides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.any() {
            return f.write_str("none");
        }
        let mut separator = "";
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for (sign, side) in [("-", self.low[axis]), ("+", self.high[axis])] {
                if side {
                    write!(f, "{separator}{sign}{name}")?;
                    separator = " ";
                }
            }
        }
        Ok(())
    }
}

/// How a mesh was made, and its properties.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshReport {
    /// Whether every edge has exactly two triangles, in opposite directions. A mesh without triangles is
    /// closed. Every edge is looked at if [`Options::verify`](super::Options::verify) is set; otherwise it
    /// follows from the cells at the sides of the lattice: elsewhere a mesh is closed by construction.
    pub closed: bool,
    /// The sides of the lattice that cut the body: some lattice point on that side is inside. Without any,
    /// the mesh is closed.
    pub cut_sides: Sides,
    /// Boxes whose range was computed, to find the bricks.
    pub boxes: u64,
    /// Boxes that were dropped because they are inside as a whole.
    pub boxes_inside: u64,
    /// Boxes that were dropped because they are outside as a whole.
    pub boxes_outside: u64,
    /// Evaluations of primitives that the points of these boxes would have taken, with the rows that matter
    /// in the box around each.
    pub evaluations_spared: u64,
    /// Bricks that were left and sampled.
    pub bricks: u64,
    /// Points at which the field alone was evaluated: the lattice points of the bricks, once each.
    pub field_evaluations: u64,
    /// Points at which field and gradient were evaluated: once per vertex and pull, and some more for
    /// vertices that a crease keeps off the surface.
    pub gradient_evaluations: u64,
    /// Points at which everything was evaluated: once per vertex, and once more for vertices at a jump or
    /// that a crease kept off the surface.
    pub full_evaluations: u64,
    /// Points at which the field alone was evaluated, beside those of the lattice: on crossed edges of
    /// suspect cells and at walls, to find out where it jumps; and between points inside and outside, for
    /// vertices that a crease kept off the surface.
    pub jump_evaluations: u64,
    /// Vertices at which the field jumps, as at the walls of `within`.
    pub jump_vertices: u64,
    /// Vertices that were put on edges and corners of the surface.
    pub sharp_vertices: u64,
    /// Whether cells are shorter than 16 steps of f32 somewhere in the lattice: then vertices of different
    /// cells may coincide.
    pub crowded: bool,
    /// Cells that the surface crosses.
    pub crossing_cells: u64,
    /// Ambiguous faces that were flipped to keep the mesh manifold.
    pub flipped_faces: u64,
    /// Parts that are thinner than a cell, if [`Options::thin_parts`](super::Options::thin_parts) is set.
    pub thin: Option<ThinReport>,
}

/// The most points of [`ThinReport::near`].
pub const MAX_NEAR: usize = 8;

/// Results of the search for parts that are thinner than a cell.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ThinReport {
    /// Blocks of 4^3 cells that the surface does not cross, but with a point on the other side of the
    /// surface.
    pub missed: u64,
    /// Blocks in which the surface is in shreds: neighbouring points of the lattice are on both of its sides.
    pub shredded: u64,
    /// Blocks whose search ended undecided: no point was found, and ranges could not exclude one. A field
    /// with wide ranges has many, and any of them may hold a thin part.
    pub unproven: u64,
    /// Places with missed or shredded blocks; blocks that touch count as one place.
    pub places: u64,
    /// A point of each place, at most [`MAX_NEAR`]. The points of a [`Polygonized`](crate::Polygonized) are
    /// in world coordinates.
    pub near: Vec<[f64; 3]>,
    /// The edge of cells that would show the thinnest part at these points: half of its thickness.
    pub cell: Option<f64>,
    /// Boxes whose range was computed within blocks.
    pub boxes: u64,
}
