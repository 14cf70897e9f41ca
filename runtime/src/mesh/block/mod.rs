//! One block of a lattice as a part of the mesh, for whoever makes the blocks in other processes.
//!
//! ```text
//!   +---------+---------+      blocks are cubes of 2^n cells, aligned to multiples of their edge
//!   |    +----+----+    |      a block sees the cells around it, as far as its reach
//!   |    |    x----|----x      x  a vertex of another block: the triangle has its name,
//!   +----+----+----+----+         its cell in the whole lattice and its place in that cell
//! ```
//!
//! Blocks follow one another in Morton order, as cells do, so the joined mesh has the bytes of the mesh that
//! is made at once. What a block needs of others it computes by itself:
//!
//! | part of the mesh | cells around the block |
//! |---|---|
//! | flips of faces | along chains of pinched faces: up to the reach, or the block has to be asked again |
//! | triangles, which are split by positions | one below |
//! | vertices on edges, which [go back](super::fold) where triangles are folded | one more on each side |
//! | normals that triangles decide | one above |

mod bytes;
mod cells;
mod chain;
mod join;
mod lattice_block;

pub use join::{BlockError, join_blocks};
pub use lattice_block::LatticeBlock;

use std::collections::BTreeMap;

use super::brick::Bricks;
use super::crossing::{self, Crossings};
use super::divide::{self, BrickDivision, BrickLimits};
use super::doubtful::{VertexSet, repair_normals};
use super::error::{MAX_BRICK, MeshError};
use super::field::Field;
use super::fold::{self, SharpQuad, SideCorner};
use super::indexed::{Attribute, Mesh};
use super::lattice::Lattice;
use super::options::Options;
use super::report::Sides;
use super::sample::{self, SampleWindow};
use super::scope::DivisionScope;
use super::vertex::batch::VertexSource;
use super::vertex::side::SharpVertex;
use super::{surface, vertex};
use crate::job::Hook;
use crate::progress::{EACH, Progress};

use cells::{cell_of, is_in};

/// Cells beyond a block whose vertices are made: those of its triangles, and those that decide whether these
/// go back.
const NEAR: usize = 2;
/// Cells beyond a block that are sampled at first: one more, at which chains of flips are seen.
const SAMPLED: usize = NEAR + 1;

/// A vertex by its cell in the whole lattice, and its place among the vertices of that cell.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct VertexName {
    /// The cell along x, y and z.
    pub cell: [u32; 3],
    /// Its number among the cell's vertices: 0 to 3.
    pub sheet: u32,
}

/// The part of a mesh that belongs to one block of cells.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct MeshBlock {
    /// Where it is, in units of blocks.
    pub place: [u32; 3],
    /// Its vertices and its triangles. An index beyond the vertices is that of a name in
    /// [`below`](Self::below), which follow the vertices.
    pub mesh: Mesh,
    /// Vertices of other blocks that triangles have.
    pub below: Vec<VertexName>,
    /// Corners of triangles that show sides of edges, ascending: three times the triangle plus the corner,
    /// and the number of the side among those of its vertex. The [creases](Mesh::creases) of the block's mesh
    /// have the sides of its vertices and no corners.
    pub corners: Vec<[u32; 2]>,
    /// Vertices that triangles of other blocks may have: those of the last cells along some axis, ascending
    /// by their index.
    pub seams: Vec<(VertexName, u32)>,
    /// Whether the mesh has a rim here, at sides of the lattice.
    pub is_open: bool,
    /// The sides of the lattice with a point inside.
    pub cut_sides: Sides,
}

/// What there is to do in a block.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BlockWork {
    /// Where it is, in units of blocks.
    pub place: [u32; 3],
    /// Boxes of up to 32 cells along an edge that the surface may cross.
    pub boxes: u64,
}

/// The blocks of a lattice that the surface may cross, in Morton order.
pub(crate) fn busy<F: Field>(
    field: &F,
    lattice: &Lattice,
    (options, edge): (&Options, usize),
    hook: Hook<'_>,
) -> Result<Vec<BlockWork>, MeshError<F::Error>> {
    options.check()?;
    let progress = Progress::new(hook, EACH);
    let options = Options { brick: Some(MAX_BRICK), thin_parts: false, ..options.clone() };
    let scope = DivisionScope::Everything;
    let division = divide::divide(field, lattice.axes(), (&options, scope), BrickLimits::PIECES, &progress)?;
    progress.finish()?;
    let mut work: Vec<BlockWork> = Vec::new();
    for place in division.bricks.places {
        let place = place.map(|index| index / (edge / MAX_BRICK).max(1) as u32);
        match work.last_mut().filter(|last| last.place == place) {
            Some(last) => last.boxes += 1,
            None => work.push(BlockWork { place, boxes: 1 }),
        }
    }
    Ok(work)
}

/// Meshes one block. The field has to be known in [`LatticeBlock::bounds`] of this reach.
pub(crate) fn extract<F: Field>(
    field: &F,
    lattice: &Lattice,
    (options, block, reach): (&Options, LatticeBlock, usize),
    hook: Hook<'_>,
) -> Result<MeshBlock, MeshError<F::Error>> {
    options.check()?;
    let progress = Progress::new(hook, EACH);
    let options = Options { brick: None, thin_parts: false, ..options.clone() };
    let own = block.cells(lattice, 0);
    let known = block.cells(lattice, reach);
    let scope = DivisionScope::Cells(known);
    let division = divide::divide(field, lattice.axes(), (&options, scope), BrickLimits::PIECES, &progress)?;
    let BrickDivision { bricks, regions, boxes, chunks: _ } = division;
    let near = block.cells(lattice, NEAR);
    // As few cells as there can be, unless a chain of flips leads through them; rows may reach farther.
    let tries = if reach > LatticeBlock::REACH { &[reach][..] } else { &[SAMPLED, reach] };
    let mut found = None;
    for known in tries.iter().map(|&more| block.cells(lattice, more)) {
        let window = Some(SampleWindow::of_cells(known));
        let samples = sample::sample(field, (&bricks, &regions), (options.iso, window), &progress)?;
        let looked = crossing::look(&bricks, &samples, &progress)?;
        if chain::is_complete(&bricks, &looked, near, known) {
            found = Some((samples, looked));
            break;
        }
    }
    let Some((samples, mut found)) = found else { return Err(MeshError::Reach { reach }) };
    let flips = crossing::flip(&bricks, &found.starts, &mut found.cells, &found.suspects);
    found.keep(&bricks, |brick, cell| is_in(cell_of(&bricks, brick, cell), near));
    let mut crossings = found.numbered(&bricks, &flips, &progress)?;
    let source = VertexSource {
        field,
        options: &options,
        bricks: &bricks,
        regions: &regions,
        samples: &samples,
        crossings: &crossings,
    };
    let (mut mesh, done) = vertex::finish(&source, &progress)?;
    let go_on = || progress.breathe();
    // Quads with all of their corners.
    let first = near[0].map(|low| if low == 0 { 0 } else { low + 1 });
    let quads = fold::sharp_quads((&bricks, &crossings), &done.sharp, first, go_on)?;
    super::go_back(&mut mesh, &quads, &done.sharp, go_on)?;
    leave_quads_out(&bricks, &mut crossings, own);
    let of = (&bricks, &crossings);
    let range = bricks_of(&bricks, own);
    let vertices = crossings.vertices[range.start]..crossings.vertices[range.end];
    let doubtful: Vec<u32> =
        done.doubtful.into_iter().filter(|&vertex| vertices.contains(&(vertex as usize))).collect();
    let marked = VertexSet::new(0, mesh.positions.len(), doubtful.iter().copied());
    let mut around;
    let room = surface::room(&crossings, samples)?;
    (mesh.triangles, around) = surface::triangles(of, room, (&mesh.positions, &marked), go_on)?;
    let quads = fold::sharp_quads(of, &done.sharp, [0; 3], go_on)?;
    let corners = fold::crease(&quads, &done.sharp, &mesh.positions, &mut mesh.triangles, go_on)?;
    repair_normals(&mut mesh, &marked, &mut around, quads.iter().map(SharpQuad::number), &progress)?;
    progress.finish()?;
    let mut cut_sides = crossings.cut;
    cut_sides.add(boxes.cut);
    let mut made = cut_out(&bricks, &crossings, &mesh, range.clone());
    crease(&mut made, &done.sharp, &corners, (vertices, 2 * crossings.quads[range.start]));
    (made.place, made.cut_sides, made.is_open) = (block.place(), cut_sides, crossings.is_open);
    made.seams = seams(&bricks, &crossings, own);
    Ok(made)
}

/// The bricks of a block, which follow one another.
fn bricks_of(bricks: &Bricks, own: [[usize; 3]; 2]) -> std::ops::Range<usize> {
    let mut mine = (0..bricks.len()).filter(|&brick| is_in(bricks.origin(brick), own));
    let Some(first) = mine.next() else { return 0..0 };
    first..first + 1 + mine.count()
}

/// Leaves out the quads of bricks below a block, of which some corners are not there.
fn leave_quads_out(bricks: &Bricks, crossings: &mut Crossings, [low, _]: [[usize; 3]; 2]) {
    let (mut before, mut sum) = (0, 0);
    for brick in 0..bricks.len() {
        let end = crossings.quads[brick + 1];
        let origin = bricks.origin(brick);
        if (0..3).all(|axis| origin[axis] >= low[axis]) {
            sum += end - before;
        }
        before = end;
        crossings.quads[brick + 1] = sum;
    }
}

/// The vertices and triangles of some bricks, with the names of all other vertices.
fn cut_out(bricks: &Bricks, crossings: &Crossings, mesh: &Mesh, range: std::ops::Range<usize>) -> MeshBlock {
    let own = crossings.vertices[range.start]..crossings.vertices[range.end];
    let triangles = 2 * crossings.quads[range.start]..2 * crossings.quads[range.end];
    let mut names: BTreeMap<u32, u32> = BTreeMap::new();
    let is_own = |vertex: u32| own.contains(&(vertex as usize));
    let others = mesh.triangles[triangles.clone()].iter().flatten().filter(|&&vertex| !is_own(vertex));
    names.extend(others.map(|&vertex| (vertex, 0)));
    let mut below = Vec::with_capacity(names.len());
    for (index, (&vertex, name)) in (0..).zip(&mut names) {
        *name = own.len() as u32 + index;
        below.push(name_of(bricks, crossings, vertex as usize));
    }
    let index = |vertex: u32| if is_own(vertex) { vertex - own.start as u32 } else { names[&vertex] };
    let attribute = |attribute: &Attribute| Attribute {
        name: attribute.name.clone(),
        width: attribute.width,
        values: attribute.values[own.start * attribute.width..own.end * attribute.width].to_vec(),
    };
    let mesh = Mesh {
        positions: mesh.positions[own.clone()].to_vec(),
        normals: mesh.normals[own.clone()].to_vec(),
        attributes: mesh.attributes.iter().map(attribute).collect(),
        triangles: mesh.triangles[triangles].iter().map(|triangle| triangle.map(index)).collect(),
        ..Mesh::default()
    };
    MeshBlock { mesh, below, ..MeshBlock::default() }
}

/// Gives a block the sides of its vertices, and the corners of its triangles that show some; `vertices` are
/// its own, and it has so many triangles before it.
fn crease(
    made: &mut MeshBlock,
    sharp: &[SharpVertex],
    corners: &[SideCorner],
    (vertices, triangles): (std::ops::Range<usize>, usize),
) {
    let widths: Vec<usize> = made.mesh.attributes.iter().map(|attribute| attribute.width).collect();
    for one in sharp.iter().filter(|one| vertices.contains(&(one.vertex as usize))) {
        made.mesh.creases.push(one.vertex - vertices.start as u32, one, &widths);
    }
    let own = 3 * triangles..3 * (triangles + made.mesh.triangles.len());
    let of_block = corners.iter().filter(|of| own.contains(&(of.corner as usize)));
    made.corners = of_block.map(|of| [of.corner - own.start as u32, of.side as u32]).collect();
}

/// The name of a vertex.
fn name_of(bricks: &Bricks, crossings: &Crossings, vertex: usize) -> VertexName {
    let brick = crossings.vertices.partition_point(|&first| first <= vertex) - 1;
    let local = (vertex - crossings.vertices[brick]) as u32;
    let cells = crossings.of(brick);
    // A cell without a vertex has the number of the next vertex.
    let cell = &cells[cells.partition_point(|cell| cell.vertex <= local) - 1];
    let place = cell_of(bricks, brick, cell).map(|index| index as u32);
    VertexName { cell: place, sheet: local - cell.vertex }
}

/// The vertices of a block that others may ask for: those of its last cells.
fn seams(bricks: &Bricks, crossings: &Crossings, own: [[usize; 3]; 2]) -> Vec<(VertexName, u32)> {
    let range = bricks_of(bricks, own);
    let first = crossings.vertices[range.start];
    let mut seams = Vec::new();
    for brick in range {
        let cells = crossings.of(brick);
        let count = (crossings.vertices[brick + 1] - crossings.vertices[brick]) as u32;
        for (index, cell) in cells.iter().enumerate() {
            let place = cell_of(bricks, brick, cell);
            if (0..3).all(|axis| place[axis] + 1 < own[1][axis]) {
                continue;
            }
            let end = cells.get(index + 1).map_or(count, |next| next.vertex);
            for vertex in cell.vertex..end {
                let name = VertexName { cell: place.map(|index| index as u32), sheet: vertex - cell.vertex };
                seams.push((name, (crossings.vertices[brick] - first) as u32 + vertex));
            }
        }
    }
    seams
}
