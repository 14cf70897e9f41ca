//! Blocks become one mesh: vertices in the order of blocks, and names become their numbers.

use jbt_ir::memory::{self, NoMemory};
use rustc_hash::FxHashMap;

use super::super::indexed::{Attribute, Creases, Mesh};
use super::{MeshBlock, VertexName};
use crate::error::{Classified, ErrorKind};
use crate::morton::morton;

/// Why blocks are not the parts of one mesh.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BlockError {
    /// A vertex that a block has a triangle of is in no other block.
    #[error("the block {place:?} has a triangle at the cell {cell:?}, which is in none of the other blocks")]
    Missing {
        /// The block that asks.
        place: [u32; 3],
        /// The cell that is missing.
        cell: [u32; 3],
    },
    /// Two blocks are in one place.
    #[error("there are two blocks {place:?}")]
    Twice {
        /// Their place.
        place: [u32; 3],
    },
    /// A block has other attributes, or another origin, than the first one.
    #[error("the block {place:?} is one of another model: its attributes or its origin differ")]
    Model {
        /// Its place.
        place: [u32; 3],
    },
    /// Numbers of a block do not go together: it was not made by a mesher.
    #[error("the block {place:?} is broken: {problem}")]
    Broken {
        /// Its place.
        place: [u32; 3],
        /// What is wrong.
        problem: &'static str,
    },
    /// The memory for the mesh is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// More vertices than a u32 can number.
    #[error("the mesh would have {vertices} vertices, more than can be numbered in 32 bits")]
    TooManyVertices {
        /// How many there would be.
        vertices: u64,
    },
}

impl Classified for BlockError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Missing { .. } | Self::Twice { .. } | Self::Model { .. } | Self::Broken { .. } => {
                ErrorKind::Argument
            }
            Self::TooManyVertices { .. } | Self::Memory(_) => ErrorKind::Limit,
        }
    }
}

impl MeshBlock {
    /// Checks that all numbers of the block go together.
    pub(crate) fn check(&self) -> Result<(), BlockError> {
        let broken = |problem| Err(BlockError::Broken { place: self.place, problem });
        let Mesh { positions, normals, attributes, triangles, .. } = &self.mesh;
        let count = positions.len();
        if normals.len() != count {
            return broken("it needs a normal for each vertex");
        }
        if attributes.iter().any(|one| count.checked_mul(one.width) != Some(one.values.len())) {
            return broken("it needs values of attributes for each vertex");
        }
        let Creases { vertices, normals, attributes: values, corners } = &self.mesh.creases;
        let sides = vertices.len();
        if !vertices.is_sorted() || vertices.last().is_some_and(|&vertex| vertex as usize >= count) {
            return broken("an edge has a vertex that is not there");
        }
        let width = |n: usize| attributes.get(n).map_or(0, |one| one.width);
        let fits = |(n, plane): (usize, &Vec<f32>)| sides.checked_mul(width(n)) == Some(plane.len());
        let fit = sides == 0 && values.iter().all(Vec::is_empty) || values.len() == attributes.len();
        if normals.len() != sides || !fit || !values.iter().enumerate().all(fits) {
            return broken("it needs a normal and values of attributes for each side of an edge");
        }
        let last = self.corners.last().map_or(0, |[corner, _]| *corner as usize / 3);
        if !corners.is_empty() || !self.corners.is_sorted() || last > triangles.len().saturating_sub(1) {
            return broken("a corner is in a triangle that is not there");
        }
        let all = count + self.below.len();
        if triangles.iter().flatten().any(|&vertex| vertex as usize >= all) {
            return broken("a triangle has a vertex that is not there");
        }
        if self.seams.iter().any(|&(_, vertex)| vertex as usize >= count) {
            return broken("a seam has a vertex that is not there");
        }
        if self.place.iter().any(|&index| index >= 1 << 21) {
            return broken("its place is beyond all lattices");
        }
        Ok(())
    }
}

/// The mesh of all blocks of a lattice that the surface crosses, in any order. Blocks without a surface may
/// be left out. If none is left out that has one, the mesh is that of [`extract`](super::super::extract), to
/// the bit.
///
/// # Errors
/// See [`BlockError`].
pub fn join_blocks(blocks: &[MeshBlock]) -> Result<Mesh, BlockError> {
    let mut order: Vec<&MeshBlock> = blocks.iter().collect();
    order.iter().try_for_each(|block| block.check())?;
    order.sort_unstable_by_key(|block| morton(block.place));
    if let Some(pair) = order.windows(2).find(|pair| pair[0].place == pair[1].place) {
        return Err(BlockError::Twice { place: pair[0].place });
    }
    let vertices: u64 = order.iter().map(|block| block.mesh.positions.len() as u64).sum();
    if u32::try_from(vertices).is_err() {
        return Err(BlockError::TooManyVertices { vertices });
    }
    let Some(&model) = order.first() else { return Ok(Mesh::default()) };
    if let Some(other) = order.iter().find(|block| !are_alike(&model.mesh, &block.mesh)) {
        return Err(BlockError::Model { place: other.place });
    }
    memory::probe(order.iter().map(|block| joined_bytes(block)).sum())?;
    let mut names: FxHashMap<VertexName, u32> = FxHashMap::default();
    let mut mesh = begun(&model.mesh, vertices as usize, &order);
    for block in &order {
        let first = mesh.positions.len() as u32;
        names.extend(block.seams.iter().map(|&(name, vertex)| (name, first + vertex)));
        mesh.positions.extend_from_slice(&block.mesh.positions);
        mesh.normals.extend_from_slice(&block.mesh.normals);
        for (to, from) in mesh.attributes.iter_mut().zip(&block.mesh.attributes) {
            to.values.extend_from_slice(&from.values);
        }
        let count = block.mesh.positions.len() as u32;
        let find = |&name: &VertexName| {
            names.get(&name).copied().ok_or(BlockError::Missing { place: block.place, cell: name.cell })
        };
        let below: Vec<u32> = block.below.iter().map(find).collect::<Result<_, _>>()?;
        let number = |vertex: u32| {
            if vertex < count { first + vertex } else { below[(vertex - count) as usize] }
        };
        let triangles = mesh.triangles.len();
        mesh.triangles.extend(block.mesh.triangles.iter().map(|triangle| triangle.map(number)));
        crease(&mut mesh, block, (first, triangles))?;
    }
    Ok(mesh)
}

/// The memory that a block takes in a mesh, and for its names on the way.
fn joined_bytes(block: &MeshBlock) -> usize {
    let MeshBlock { mesh, below, corners, seams, .. } = block;
    let values = |all: &[Attribute]| all.iter().map(|one| size_of_val(&*one.values)).sum::<usize>();
    let Creases { vertices, normals, attributes, .. } = &mesh.creases;
    // Lists of creases grow by doubling, and a map is half empty.
    let sides = size_of_val(&**vertices) + size_of_val(&**normals) + size_of_val(&**corners);
    let sides = sides + attributes.iter().map(|plane| size_of_val(&**plane)).sum::<usize>();
    let lists = size_of_val(&*mesh.positions) + size_of_val(&*mesh.normals) + size_of_val(&*mesh.triangles);
    lists + values(&mesh.attributes) + 3 * sides + 4 * size_of_val(&**seams) + size_of_val(&**below)
}

/// Adds the creases of a block whose vertices and triangles come behind so many. The sides of all vertices
/// that it has are there by then.
fn crease(mesh: &mut Mesh, block: &MeshBlock, before: (u32, usize)) -> Result<(), BlockError> {
    let Mesh { creases, triangles, .. } = mesh;
    creases.append(block.mesh.creases.clone(), before);
    for &[corner, side] in &block.corners {
        let corner = 3 * before.1 as u32 + corner;
        let vertex = triangles[corner as usize / 3][corner as usize % 3];
        let place = creases.vertices.partition_point(|&other| other < vertex) as u64 + u64::from(side);
        if creases.vertices.get(place as usize) != Some(&vertex) {
            return Err(BlockError::Broken {
                place: block.place,
                problem: "a corner has a side that is not there",
            });
        }
        creases.corners.push([corner, place as u32]);
    }
    Ok(())
}

/// An empty mesh like another one, with room.
fn begun(model: &Mesh, vertices: usize, blocks: &[&MeshBlock]) -> Mesh {
    let attribute = |one: &Attribute| Attribute {
        name: one.name.clone(),
        width: one.width,
        values: Vec::with_capacity(vertices * one.width),
    };
    Mesh {
        origin: model.origin,
        orientation: model.orientation,
        positions: Vec::with_capacity(vertices),
        normals: Vec::with_capacity(vertices),
        attributes: model.attributes.iter().map(attribute).collect(),
        triangles: Vec::with_capacity(blocks.iter().map(|block| block.mesh.triangles.len()).sum()),
        creases: Default::default(),
        parts: Vec::new(),
    }
}

fn are_alike(a: &Mesh, b: &Mesh) -> bool {
    let alike = |(a, b): (&Attribute, &Attribute)| a.name == b.name && a.width == b.width;
    a.origin.map(f64::to_bits) == b.origin.map(f64::to_bits)
        && a.orientation == b.orientation
        && a.attributes.len() == b.attributes.len()
        && a.attributes.iter().zip(&b.attributes).all(alike)
}
