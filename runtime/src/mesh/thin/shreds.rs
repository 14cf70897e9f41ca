//! Blocks in which the surface is in shreds: it is crossed, but its sides are closer than a cell.
//!
//! ```text
//! scrap:  one point of the lattice alone is on its side of the surface, among all 26 around it        an
//! alarm thin:   a cell below the vertex, against its normal, it is outside again
//! a vote of the vertex
//!             __v________
//!             __|________      a sheet
//!               x
//! ```
//!
//! Vertices are tested only where lone points raise suspicion, so a smooth body costs nothing. Bodies are
//! thin at sharp edges and tips, so many votes are needed, at least half of a block's. Narrow gaps do not
//! count, unless they are scraps: bodies that touch have one between them.

use crate::parallel::*;

use super::alarm::{ALARM, Alarm};
use super::crossed::CrossedBlocks;
use crate::boxes::Box3;
use crate::mesh::brick::Bricks;
use crate::mesh::crossing::Crossings;
use crate::mesh::error::MeshError;
use crate::mesh::field::Field;
use crate::mesh::indexed::Mesh;
use crate::mesh::vertex::side::{CutVertex, SharpVertex};
use crate::morton::morton;
use crate::span::span;

/// Vertices are tested where at least one of this many crossed edges in a block is lone. A sheet of nine
/// tenths of a cell, across a diagonal of the lattice, has twice as many lone edges.
const CROSSED_PER_LONE: u32 = 3;

/// The most vertices of a block in the first test.
const ASKED_FIRST: usize = 8;
/// The part of them that has to vote before all are tested.
const CALLED_FIRST: usize = 4;

/// Whether a field value is inside; false for NaN.
fn is_inside(field: f32, iso: f32) -> bool {
    field >= iso
}

/// Boxes of the division, in Morton order, as regions for evaluation.
pub(super) struct Chunks<'a, R> {
    /// Cells along an edge.
    pub(super) edge: usize,
    pub(super) places: &'a [[u32; 3]],
    pub(super) regions: &'a [R],
}

/// The inputs of the test.
pub(super) struct Looked<'a, F: Field> {
    pub(super) field: &'a F,
    pub(super) iso: f32,
    pub(super) bricks: &'a Bricks,
    pub(super) crossings: &'a Crossings,
    pub(super) crossed: &'a CrossedBlocks<'a>,
    pub(super) chunks: &'a Chunks<'a, F::Region>,
    pub(super) mesh: &'a Mesh,
    /// Its vertices on edges, ascending.
    pub(super) sharp: &'a [SharpVertex],
}

/// A point to evaluate, and the index of its chunk.
#[derive(Clone, Copy)]
struct ShredProbe {
    chunk: usize,
    point: [f32; 3],
}

impl<F: Field> Looked<'_, F> {
    /// The blocks in which the surface is in shreds.
    pub(super) fn shreds(&self) -> Result<Vec<Alarm>, MeshError<F::Error>> {
        span!("shreds");
        scatter(|watches| {
            let blocks = (0..self.crossed.len()).into_par_iter().with_min_len(256);
            blocks.filter_map(|block| watches.hold(|| self.block(block)).transpose()).collect()
        })
    }

    fn block(&self, block: usize) -> Result<Option<Alarm>, MeshError<F::Error>> {
        let found = self.crossed.look(block);
        let Some(first) = found.first else { return Ok(None) };
        let place = self.crossed.place(block);
        let axes = &self.bricks.axes;
        let point = [0, 1, 2].map(|axis| axes[axis][first[axis] as usize]);
        if found.is_scrap {
            return Ok(Some(Alarm { place, point, weight: ALARM }));
        }
        if CROSSED_PER_LONE * found.lone < found.edges {
            return Ok(None);
        }
        let vertices: Vec<usize> = self.crossed.cells(block).flat_map(|cell| self.vertices(cell)).collect();
        // Cells that a side of the lattice cuts may have no vertex.
        if vertices.is_empty() {
            return Ok(None);
        }
        let some: Vec<usize> =
            vertices.iter().copied().step_by(vertices.len().div_ceil(ASKED_FIRST)).collect();
        if CALLED_FIRST * self.votes(&some)? < some.len() {
            return Ok(None);
        }
        let votes = self.votes(&vertices)?;
        Ok((2 * votes >= vertices.len()).then_some(Alarm { place, point, weight: votes as u32 }))
    }

    /// The number of vertices at which the part is thinner than a cell.
    fn votes(&self, vertices: &[usize]) -> Result<usize, MeshError<F::Error>> {
        let probe = |&vertex: &usize| {
            let CutVertex { position, normal } = self.cut(vertex);
            let (chunk, point) = self.place(position, normal.map(|component| -component))?;
            Some(ShredProbe { chunk, point })
        };
        let mut probes: Vec<ShredProbe> = vertices.iter().filter_map(probe).collect();
        probes.sort_by_key(|probe| probe.chunk);
        let mut votes = 0;
        for probes in probes.chunk_by(|a, b| a.chunk == b.chunk) {
            let [x, y, z] =
                [0, 1, 2].map(|axis| probes.iter().map(|probe| probe.point[axis]).collect::<Vec<f32>>());
            let mut values = vec![0.0; probes.len()];
            let region = &self.chunks.regions[probes[0].chunk];
            self.field.field(region, &x, &y, &z, &mut values).map_err(MeshError::Field)?;
            votes += values.iter().filter(|&&value| !is_inside(value, self.iso)).count();
        }
        Ok(votes)
    }

    /// A vertex as it would be without edges. Of a sheet with a rim, one on the rim looks along the sheet.
    fn cut(&self, vertex: usize) -> CutVertex {
        match self.sharp.binary_search_by_key(&(vertex as u32), |sharp| sharp.vertex) {
            Ok(place) => self.sharp[place].cut,
            Err(_) => CutVertex { position: self.mesh.positions[vertex], normal: self.mesh.normals[vertex] },
        }
    }

    /// The vertices of a cell.
    fn vertices(&self, cell: usize) -> std::ops::Range<usize> {
        let Crossings { cells, starts, vertices, .. } = self.crossings;
        let brick = starts.partition_point(|&start| start <= cell) - 1;
        let first = vertices[brick] + cells[cell].vertex as usize;
        let is_last = cell + 1 == starts[brick + 1];
        first..if is_last { vertices[brick + 1] } else { vertices[brick] + cells[cell + 1].vertex as usize }
    }

    /// The point a cell further in a direction, and its chunk. Where no chunk was kept there is no surface:
    /// then the starting point is used instead.
    fn place(&self, from: [f32; 3], direction: [f32; 3]) -> Option<(usize, [f32; 3])> {
        let axes = &self.bricks.axes;
        let cell = axes[0][1] - axes[0][0];
        let end = |axis: usize| axes[axis][axes[axis].len() - 1];
        let point =
            [0, 1, 2].map(|axis| (from[axis] + cell * direction[axis]).clamp(axes[axis][0], end(axis)));
        if let Some(chunk) = self.chunk(point) {
            return Some((chunk, point));
        }
        let chunk = self.chunk(from)?;
        let Box3 { low, high } = self.bounds(chunk);
        Some((chunk, [0, 1, 2].map(|axis| point[axis].clamp(low[axis], high[axis]))))
    }

    /// The chunk of a point.
    fn chunk(&self, point: [f32; 3]) -> Option<usize> {
        let axes = &self.bricks.axes;
        let place = [0, 1, 2].map(|axis| {
            let above = axes[axis].partition_point(|&coordinate| coordinate <= point[axis]);
            (above.saturating_sub(1).min(axes[axis].len() - 2) / self.chunks.edge) as u32
        });
        self.chunks.places.binary_search_by_key(&morton(place), |&place| morton(place)).ok()
    }

    fn bounds(&self, chunk: usize) -> Box3 {
        let first = self.chunks.places[chunk].map(|index| index as usize * self.chunks.edge);
        crate::mesh::brick::box_of(&self.bricks.axes, first, first.map(|index| index + self.chunks.edge))
    }
}
