//! The cells that the surface crosses, and the faces that are flipped to keep the mesh manifold.
//!
//! An ambiguous face on which, in both of its cells, both segments lie on one sheet would give an edge of the mesh with four
//! triangles. Flipping that face re-pairs two segments of one oriented cycle, which always splits the cycle, in both cells.
//! A flip never joins two sheets, so a face that is good stays good, and one pass over the faces that are bad by default
//! ends with all faces good. The pass is sequential and in the order of the lattice; such faces are rare.

use std::collections::HashMap;

use rayon::prelude::*;

use super::cell::sheets;
use super::sample::Grid;

/// A cell that the surface crosses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Its place along x; y and z follow from the row and the layer that it is in.
    pub(crate) x: u32,
    /// The vertex of its first sheet; those of the others follow.
    pub(crate) vertex: u32,
    /// Which corners are inside, a bit each.
    pub(crate) signs: u8,
    /// Which faces are flipped, a bit each.
    pub(crate) flips: u8,
}

/// The crossing cells with one z.
pub(crate) struct Layer {
    /// Where the row of each y begins in `cells`, and where the last one ends.
    starts: Vec<u32>,
    /// In the order of y, then x.
    pub(crate) cells: Vec<Cell>,
    /// How many vertices are in this layer.
    pub(crate) vertices: usize,
}

impl Layer {
    /// The crossing cells of one y, by ascending x.
    pub(crate) fn row(&self, y: usize) -> &[Cell] {
        &self.cells[self.starts[y] as usize..self.starts[y + 1] as usize]
    }

    fn row_mut(&mut self, y: usize) -> &mut [Cell] {
        &mut self.cells[self.starts[y] as usize..self.starts[y + 1] as usize]
    }

    /// The rows, which are as many as there are cells along y.
    pub(crate) fn rows(&self) -> usize {
        self.starts.len() - 1
    }
}

/// All crossing cells.
pub(crate) struct Crossings {
    /// One for each z.
    pub(crate) layers: Vec<Layer>,
    /// The vertices of all layers. Those of a cell are numbered in 32 bits, which is right only if this fits.
    pub(crate) vertex_count: u64,
    /// How many faces are flipped.
    pub(crate) flipped_faces: u64,
}

impl Crossings {
    /// How many cells the surface crosses.
    pub(crate) fn cell_count(&self) -> u64 {
        self.layers.iter().map(|layer| layer.cells.len() as u64).sum()
    }
}

/// A face between two cells: the low face of `cell` along `axis`.
struct Face {
    cell: [usize; 3],
    axis: usize,
}

impl Face {
    /// The cell below the face.
    fn neighbour(&self) -> [usize; 3] {
        let mut cell = self.cell;
        cell[self.axis] -= 1;
        cell
    }

    /// The number of this face in the upper and in the lower cell.
    fn sides(&self) -> [usize; 2] {
        [2 * self.axis, 2 * self.axis + 1]
    }
}

/// Finds the crossing cells, flips faces, and numbers the vertices.
pub(crate) fn find(grid: &Grid) -> Crossings {
    let (mut layers, suspects): (Vec<Layer>, Vec<Vec<Face>>) =
        (0..grid.cells()[2]).into_par_iter().map(|z| find_layer(grid, z)).unzip();
    let (flips, flipped_faces) = flip(grid, suspects.into_iter().flatten());
    for ([x, y, z], mask) in flips {
        let row = layers[z].row_mut(y);
        // A flipped face is crossed, and so are the cells on both of its sides.
        if let Ok(place) = row.binary_search_by_key(&x, |cell| cell.x as usize) {
            row[place].flips = mask;
        }
    }
    let vertex_count = number(&mut layers);
    Crossings { layers, vertex_count, flipped_faces }
}

/// The crossing cells of one layer, and the faces that are bad by default.
fn find_layer(grid: &Grid, z: usize) -> (Layer, Vec<Face>) {
    let [_, ny, _] = grid.cells();
    let mut starts = Vec::with_capacity(ny + 1);
    let (mut cells, mut suspects) = (Vec::new(), Vec::new());
    let mut columns = vec![0_u8; grid.points(0)];
    starts.push(0);
    for y in 0..ny {
        find_columns(grid, y, z, &mut columns);
        for (x, signs) in crossing_signs(&columns) {
            cells.push(Cell { x: x as u32, vertex: 0, signs, flips: 0 });
            let cell = [x, y, z];
            let faces = (0..3).filter(|&axis| cell[axis] > 0).map(|axis| Face { cell, axis });
            suspects.extend(faces.filter(|face| is_bad_by_default(grid, signs, face)));
        }
        // At most MAX_LATTICE_POINTS cells, which is below 2^32.
        starts.push(cells.len() as u32);
    }
    (Layer { starts, cells, vertices: 0 }, suspects)
}

/// The signs of the points (x, y, z), (x, y + 1, z), (x, y, z + 1) and (x, y + 1, z + 1), in the bits 0, 2, 4 and 6: where the
/// corners with the low x of a cell stand.
fn find_columns(grid: &Grid, y: usize, z: usize, columns: &mut [u8]) {
    let iso = grid.iso;
    let near = grid.row(y, z).iter().zip(grid.row(y + 1, z));
    let far = grid.row(y, z + 1).iter().zip(grid.row(y + 1, z + 1));
    for ((column, (p, q)), (r, s)) in columns.iter_mut().zip(near).zip(far) {
        *column = u8::from(*p >= iso)
            | u8::from(*q >= iso) << 2
            | u8::from(*r >= iso) << 4
            | u8::from(*s >= iso) << 6;
    }
}

/// The cells of a row that the surface crosses, each with its x and its signs.
fn crossing_signs(columns: &[u8]) -> impl Iterator<Item = (usize, u8)> {
    /// The signs of a column with all of its points inside.
    const FULL: u8 = 0b0101_0101;
    /// Most of a lattice is far from the surface, and is passed in runs of this many cells.
    const RUN: usize = 16;
    let cells = columns.len() - 1;
    let runs = (0..cells).step_by(RUN).map(move |start| (start, &columns[start..=cells.min(start + RUN)]));
    let mixed = runs.filter(|(_, run)| {
        let (any, all) = run.iter().fold((0, FULL), |(any, all), column| (any | column, all & column));
        any != 0 && all != FULL
    });
    mixed.flat_map(|(start, run)| {
        let signs = run.windows(2).map(|pair| pair[0] | pair[1] << 1).enumerate();
        signs.filter(|&(_, signs)| signs != 0 && signs != u8::MAX).map(move |(x, signs)| (start + x, signs))
    })
}

fn is_bad_by_default(grid: &Grid, signs: u8, face: &Face) -> bool {
    let [upper, lower] = face.sides();
    sheets(signs, 0).pinched(upper) && sheets(grid.signs(face.neighbour()), 0).pinched(lower)
}

/// Flips faces until none is bad. Returns the flipped faces of each cell that has any, and how many faces were flipped.
fn flip(grid: &Grid, suspects: impl Iterator<Item = Face>) -> (HashMap<[usize; 3], u8>, u64) {
    let mut flips = HashMap::<[usize; 3], u8>::new();
    let mut count = 0;
    for face in suspects {
        let both = [face.cell, face.neighbour()].into_iter().zip(face.sides());
        // An earlier flip may have split one of the sheets already.
        let is_bad = both.clone().all(|(cell, side)| {
            sheets(grid.signs(cell), flips.get(&cell).copied().unwrap_or(0)).pinched(side)
        });
        if is_bad {
            for (cell, side) in both {
                *flips.entry(cell).or_insert(0) |= 1 << side;
            }
            count += 1;
        }
    }
    (flips, count)
}

/// Numbers the vertices in the order of the cells. Returns how many there are.
fn number(layers: &mut [Layer]) -> u64 {
    layers.par_iter_mut().for_each(|layer| {
        let counts = layer.cells.iter().map(|cell| sheets(cell.signs, cell.flips).count() as usize);
        layer.vertices = counts.sum();
    });
    let mut firsts = Vec::with_capacity(layers.len());
    let mut total = 0_u64;
    for layer in &*layers {
        firsts.push(total);
        total += layer.vertices as u64;
    }
    layers.par_iter_mut().zip(firsts).for_each(|(layer, first)| {
        // It wraps only if the total does not fit, and then the numbers are not used.
        let mut next = first as u32;
        for cell in &mut layer.cells {
            cell.vertex = next;
            next = next.wrapping_add(sheets(cell.signs, cell.flips).count());
        }
    });
    total
}
