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
use std::convert::Infallible;
use std::ops::Range;

use jbt_ir::watch;

use super::indexed::{Attribute, Creases, Mesh};
use super::vertex::side::SharpVertex;

impl Creases {
    /// Adds the creases of a mesh whose vertices and triangles come behind so many.
    pub(crate) fn append(&mut self, other: Self, (vertices, triangles): (u32, usize)) {
        let (sides, corners) = (self.vertices.len() as u32, 3 * triangles as u32);
        self.vertices.extend(other.vertices.iter().map(|vertex| vertices + vertex));
        self.normals.extend(other.normals);
        self.attributes.resize(self.attributes.len().max(other.attributes.len()), Vec::new());
        for (to, from) in self.attributes.iter_mut().zip(other.attributes) {
            to.extend(from);
        }
        self.corners.extend(other.corners.iter().map(|[corner, side]| [corners + corner, sides + side]));
    }

    /// Those of some vertices and triangles of a mesh, whose attributes have these widths.
    pub(crate) fn of(&self, vertices: Range<usize>, triangles: Range<usize>, widths: &[usize]) -> Self {
        let among = |list: &[u32], range: &Range<usize>| {
            let before = |end: usize| list.partition_point(|&index| (index as usize) < end);
            before(range.start)..before(range.end)
        };
        let sides = among(&self.vertices, &vertices);
        let first = self.corners.partition_point(|[corner, _]| (*corner as usize) < 3 * triangles.start);
        let end = self.corners.partition_point(|[corner, _]| (*corner as usize) < 3 * triangles.end);
        let (vertex, corner, side) = (vertices.start as u32, 3 * triangles.start as u32, sides.start as u32);
        let values = |(values, width): (&Vec<f32>, &usize)| {
            values.get(width * sides.start..width * sides.end).unwrap_or_default().to_vec()
        };
        Self {
            vertices: self.vertices[sides.clone()].iter().map(|index| index - vertex).collect(),
            normals: self.normals[sides.clone()].to_vec(),
            attributes: self.attributes.iter().zip(widths).map(values).collect(),
            corners: self.corners[first..end].iter().map(|[a, b]| [a - corner, b - side]).collect(),
        }
    }

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
        let Ok(split) = self.split_asking(&|| Ok::<_, Infallible>(()));
        split
    }

    /// As [`split`](Self::split). Every now and then it is asked whether to go on.
    pub(crate) fn split_asking<E>(&self, go_on: &dyn Fn() -> Result<(), E>) -> Result<Cow<'_, Self>, E> {
        let creases = &self.creases;
        if creases.corners.is_empty() {
            return Ok(Cow::Borrowed(self));
        }
        if !self.parts.is_empty() {
            let split = |piece: Self| Ok(piece.split_asking(go_on)?.into_owned());
            return Ok(Cow::Owned(self.each_piece(split, go_on)?));
        }
        let count = self.positions.len();
        let mut positions = copied(&self.positions, creases.vertices.len(), go_on)?;
        positions.extend(creases.vertices.iter().map(|&vertex| self.positions[vertex as usize]));
        let mut normals = copied(&self.normals, creases.normals.len(), go_on)?;
        normals.extend_from_slice(&creases.normals);
        let mut attributes = Vec::with_capacity(self.attributes.len());
        for (index, Attribute { name, width, values }) in self.attributes.iter().enumerate() {
            let sides = creases.attributes.get(index).map_or(&[][..], Vec::as_slice);
            let mut values = copied(values, sides.len(), go_on)?;
            values.extend_from_slice(sides);
            attributes.push(Attribute { name: name.clone(), width: *width, values });
        }
        let mut triangles = copied(&self.triangles, 0, go_on)?;
        for &[corner, side] in &creases.corners {
            triangles[corner as usize / 3][corner as usize % 3] = (count + side as usize) as u32;
        }
        Ok(Cow::Owned(Self {
            origin: self.origin,
            orientation: self.orientation,
            positions,
            normals,
            attributes,
            triangles,
            parts: Vec::new(),
            creases: Creases::default(),
        }))
    }
}

/// A copy with room for more. Every now and then it is asked whether to go on.
pub(super) fn copied<T: Copy, E>(
    items: &[T],
    more: usize,
    go_on: &dyn Fn() -> Result<(), E>,
) -> Result<Vec<T>, E> {
    watch::take((items.len() + more) * size_of::<T>());
    let mut copy = Vec::with_capacity(items.len() + more);
    extended(&mut copy, items, |&item| item, go_on)?;
    Ok(copy)
}

/// Appends what is made of each item. Every now and then it is asked whether to go on.
pub(super) fn extended<T, U, E>(
    to: &mut Vec<U>,
    items: &[T],
    make: impl Fn(&T) -> U,
    go_on: &dyn Fn() -> Result<(), E>,
) -> Result<(), E> {
    const ITEMS: usize = 1 << 16;
    to.reserve(items.len());
    for part in items.chunks(ITEMS) {
        go_on()?;
        to.extend(part.iter().map(&make));
    }
    Ok(())
}
