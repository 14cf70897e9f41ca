//! Creases: edges and corners of a mesh, at which triangles that share a vertex have other normals.
//!
//! ```text
//!     ^ n_A                 A vertex on an edge has one position, so the mesh is closed. Each quad is around
//!     |                     one crossed edge of the lattice, and each crossing is on one side of the edge; so
//!   --v.  A                 the corners of its triangles have the normal and the attributes of that side.
//!      \ --> n_B
//!       \ B
//! ```

use std::borrow::Cow;

use super::indexed::{Attribute, Creases, Mesh};
use super::vertex::side::SharpVertex;

impl Creases {
    /// Adds the sides of a vertex of a mesh whose attributes have these widths.
    pub(crate) fn push(&mut self, vertex: u32, sharp: &SharpVertex, widths: &[usize]) {
        self.attributes.resize(widths.len(), Vec::new());
        for side in &sharp.sides {
            self.vertices.push(vertex);
            self.normals.push(side.normal);
            let mut rest = &side.attributes[..];
            for (values, &width) in self.attributes.iter_mut().zip(widths) {
                let (mine, after) = rest.split_at(width);
                values.extend_from_slice(mine);
                rest = after;
            }
        }
    }
}

impl Mesh {
    /// The mesh with a vertex for each side of its [creases](Self::creases), as files and graphics cards want
    /// it: behind the others, at the positions of their vertices. It is closed by positions alone.
    #[must_use]
    pub fn split(&self) -> Cow<'_, Self> {
        let creases = &self.creases;
        if creases.corners.is_empty() {
            return Cow::Borrowed(self);
        }
        let count = self.positions.len();
        let mut split = Self { creases: Creases::default(), ..self.clone() };
        split.positions.extend(creases.vertices.iter().map(|&vertex| self.positions[vertex as usize]));
        split.normals.extend_from_slice(&creases.normals);
        for (attribute, values) in split.attributes.iter_mut().zip(&creases.attributes) {
            let Attribute { values: all, .. } = attribute;
            all.extend_from_slice(values);
        }
        for &[corner, side] in &creases.corners {
            split.triangles[corner as usize / 3][corner as usize % 3] = (count + side as usize) as u32;
        }
        Cow::Owned(split)
    }
}
