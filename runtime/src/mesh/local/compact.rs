//! The kept bricks as one mesh without gaps.

use rustc_hash::FxHashMap;

use super::bricks::{BrickMesh, BrickPlace};
use crate::mesh::indexed::{Attribute, Mesh};

impl BrickMesh {
    /// The mesh that a full run over the lattice makes, to the bit: bricks in Morton order, in each of them
    /// vertices and triangles as they are.
    pub(crate) fn compact(&self) -> Mesh {
        let bricks: Vec<([u32; 3], BrickPlace)> = self.in_order(self.bricks.keys().copied());
        let mut names = vec![0_u32; self.buffers.positions.len()];
        let attribute = |attribute: &Attribute| Attribute {
            name: attribute.name.clone(),
            width: attribute.width,
            values: Vec::new(),
        };
        let mut mesh = Mesh {
            origin: self.buffers.origin,
            orientation: self.buffers.orientation,
            attributes: self.buffers.attributes.iter().map(attribute).collect(),
            ..Mesh::default()
        };
        for (_, place) in &bricks {
            let vertices = self.bricks[place].vertices.range();
            for (name, next) in names[vertices.clone()].iter_mut().zip(mesh.positions.len()..) {
                *name = next as u32;
            }
            mesh.positions.extend_from_slice(&self.buffers.positions[vertices.clone()]);
            mesh.normals.extend_from_slice(&self.buffers.normals[vertices.clone()]);
            for (to, from) in mesh.attributes.iter_mut().zip(&self.buffers.attributes) {
                to.values.extend_from_slice(&from.values[vertices.start * to.width..vertices.end * to.width]);
            }
        }
        let widths: Vec<usize> = mesh.attributes.iter().map(|attribute| attribute.width).collect();
        let mut sides = FxHashMap::default();
        for (_, place) in &bricks {
            let brick = &self.bricks[place];
            for (number, sharp) in brick.sharp.iter().enumerate() {
                sides.insert((*place, number), mesh.creases.vertices.len());
                let vertex = names[brick.vertices.start + sharp.vertex as usize];
                mesh.creases.push(vertex, sharp, &widths);
            }
        }
        for (_, place) in &bricks {
            let first = 3 * mesh.triangles.len() as u32;
            let corners = self.bricks[place].corners.iter();
            let shown = corners.map(|one| [first + one.corner, (sides[&one.of] + one.side) as u32]);
            mesh.creases.corners.extend(shown);
            let triangles = &self.buffers.triangles[self.bricks[place].triangles.range()];
            mesh.triangles
                .extend(triangles.iter().map(|triangle| triangle.map(|vertex| names[vertex as usize])));
        }
        mesh
    }
}
