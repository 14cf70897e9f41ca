//! The cells of a brick that the surface crosses, and where their vertices start.

use std::collections::HashMap;

use super::cell::{CROSSED, SHEETS, Sheets, first_corner, sheets};
use super::finish::Starts;
use super::sample::{CORNERS, Samples};
use super::scene::{BRICK, Scene};

/// The flipped faces of cells that have any, a bit each.
pub(super) type Flips = HashMap<[usize; 3], u8>;

/// A crossed cell, in 32 bits: its first vertex, counted from that of its brick; its signs; its flipped
/// faces. A cell that is not crossed has anything.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cell(u32);

impl Cell {
    fn new(vertex: usize, signs: u8, flips: u8) -> Self {
        Self(vertex as u32 | u32::from(signs) << 16 | u32::from(flips) << 24)
    }

    pub(super) fn vertex(self) -> u32 {
        self.0 & 0xffff
    }

    pub(super) fn signs(self) -> u8 {
        (self.0 >> 16) as u8
    }

    pub(super) fn flips(self) -> u8 {
        (self.0 >> 24) as u8
    }
}

/// A brick that the surface crosses.
pub(super) struct Brick {
    /// Its place among the bricks.
    pub(super) place: [usize; 3],
    /// The first of its vertices, among those of its unit.
    pub(super) first: u32,
    /// How many quads it has: crossed edges of the lattice, at the low corners of its cells and not at the
    /// lattice's low sides.
    pub(super) quads: usize,
    /// For each z: whether the cell `x + 8 y` is crossed, a bit each.
    layers: [u64; BRICK],
    /// All cells, `x + 8 y + 64 z`.
    pub(super) cells: Box<[Cell; BRICK * BRICK * BRICK]>,
}

impl Brick {
    pub(super) fn new(place: [usize; 3], first: u32) -> Self {
        let cells = Box::new([Cell::default(); BRICK * BRICK * BRICK]);
        Self { place, first, quads: 0, layers: [0; BRICK], cells }
    }

    /// The numbers of the crossed cells, ascending.
    pub(super) fn crossed(&self) -> impl Iterator<Item = usize> {
        self.layers.iter().enumerate().flat_map(|(z, &layer)| {
            let mut rest = layer;
            std::iter::from_fn(move || {
                let number = (rest != 0).then(|| z * BRICK * BRICK + rest.trailing_zeros() as usize);
                rest &= rest.wrapping_sub(1);
                number
            })
        })
    }
}

/// The low corners of the cells of a layer, with this many cells along x and y.
fn cells_of_layer(extent: [usize; 3]) -> u128 {
    let row = (1_u128 << extent[0]) - 1;
    (0..extent[1]).fold(0, |mask, y| mask | row << (y * CORNERS))
}

/// Finds the crossed cells of a sampled brick and where their vertices start.
pub(super) fn find(
    scene: &Scene,
    samples: &Samples,
    flips: &Flips,
    brick: &mut Brick,
    starts: &mut Starts,
    suspects: &mut Vec<[usize; 3]>,
) {
    let origin = brick.place.map(|index| index * BRICK);
    let extent = [0, 1, 2].map(|axis| BRICK.min(scene.cells[axis] - origin[axis]));
    let valid = cells_of_layer(extent);
    (brick.layers, brick.quads) = ([0; BRICK], 0);
    for z in 0..extent[2] {
        let (near, far) = (samples.inside[z], samples.inside[z + 1]);
        let (any, all) = (near | far, near & far);
        let (any, all) = (any | any >> CORNERS, all & all >> CORNERS);
        let mut crossed = (any | any >> 1) & !(all & all >> 1) & valid;
        while crossed != 0 {
            let corner = crossed.trailing_zeros() as usize;
            crossed &= crossed - 1;
            let (near, far) = ((near >> corner) as u64, (far >> corner) as u64);
            let signs = near & 3 | (near >> CORNERS & 3) << 2 | (far & 3) << 4 | (far >> CORNERS & 3) << 6;
            let signs = signs as u8;
            let (x, y) = (corner % CORNERS, corner / CORNERS);
            let place = [origin[0] + x, origin[1] + y, origin[2] + z];
            let flips = if flips.is_empty() { 0 } else { flips.get(&place).copied().unwrap_or(0) };
            let number = x + BRICK * (y + BRICK * z);
            brick.quads += quads(place, signs);
            brick.layers[z] |= 1 << (x + BRICK * y);
            brick.cells[number] = Cell::new(starts.len(), signs, flips);
            let sheets = if flips == 0 { &SHEETS[usize::from(signs)] } else { &sheets(signs, flips) };
            // Faces on low sides: each face is the low one of one cell.
            if sheets.pinched & 0b01_0101 != 0 {
                suspects.push(place);
            }
            start(scene, place, signs, sheets, corners(samples, corner, z), starts);
        }
    }
}

/// How many crossed edges at the low corner of a cell have cells all around.
#[inline(always)]
fn quads([x, y, z]: [usize; 3], signs: u8) -> usize {
    let differs = |corner: u8| (signs ^ signs >> corner) & 1 == 1;
    usize::from(differs(1) && y > 0 && z > 0)
        + usize::from(differs(2) && z > 0 && x > 0)
        + usize::from(differs(4) && x > 0 && y > 0)
}

/// The field at the corners of a cell.
fn corners(samples: &Samples, corner: usize, z: usize) -> [f32; 8] {
    let (near, far) = (&samples.values[z][corner..][..11], &samples.values[z + 1][corner..][..11]);
    [near[0], near[1], near[9], near[10], far[0], far[1], far[9], far[10]]
}

/// The vertices of a cell start at the means of the crossings of their sheets, the field being linear along
/// each edge.
#[inline(always)]
fn start(
    scene: &Scene,
    place: [usize; 3],
    signs: u8,
    sheets: &Sheets,
    corners: [f32; 8],
    starts: &mut Starts,
) {
    let low = [scene.axes[0][place[0]], scene.axes[1][place[1]], scene.axes[2][place[2]]];
    let high = [scene.axes[0][place[0] + 1], scene.axes[1][place[1] + 1], scene.axes[2][place[2] + 1]];
    let crossed = CROSSED[usize::from(signs)];
    if sheets.count == 1 {
        starts.push(mean(scene.iso, crossed, corners, low, high), low, high);
        return;
    }
    for sheet in 0..sheets.count {
        let edges =
            (0..12).filter(|&edge| sheets.of_edge[edge] == sheet).fold(0, |mask, edge| mask | 1 << edge);
        starts.push(mean(scene.iso, edges, corners, low, high), low, high);
    }
}

/// The mean of the crossings on some edges (a bit each) of a cell.
#[inline(always)]
fn mean(iso: f32, edges: u16, corners: [f32; 8], low: [f32; 3], high: [f32; 3]) -> [f32; 3] {
    // In one register: the sum of the crossings, and how many there are.
    let (mut sum, mut rest) = ([0.0_f32; 4], edges);
    while rest != 0 {
        let edge = &EDGES[rest.trailing_zeros() as usize % EDGES.len()];
        rest &= rest - 1;
        let (from, to) = (corners[edge.from], corners[edge.to]);
        let t = (iso - from) / (to - from);
        for (sum, (start, axis)) in sum.iter_mut().zip(edge.start.iter().zip(&edge.axis)) {
            *sum += start + t * axis;
        }
    }
    let part = 1.0 / sum[3];
    [
        low[0] + sum[0] * part * (high[0] - low[0]),
        low[1] + sum[1] * part * (high[1] - low[1]),
        low[2] + sum[2] * part * (high[2] - low[2]),
    ]
}

/// An edge of a cell.
#[derive(Clone, Copy)]
struct Edge {
    /// The corners at its ends.
    from: usize,
    to: usize,
    /// The first of them in units of the cell, and 1.
    start: [f32; 4],
    /// From the first to the second, and 0.
    axis: [f32; 4],
}

/// The twelve edges, and four that are none.
static EDGES: [Edge; 16] = {
    let mut edges = [Edge { from: 0, to: 0, start: [0.0; 4], axis: [0.0; 4] }; 16];
    let mut number = 0;
    while number < 12 {
        let (from, axis) = (first_corner(number), number / 4);
        let mut edge = Edge { from, to: from | 1 << axis, start: [0.0; 4], axis: [0.0; 4] };
        edge.start = [(from & 1) as f32, (from >> 1 & 1) as f32, (from >> 2) as f32, 1.0];
        edge.axis[axis] = 1.0;
        edges[number] = edge;
        number += 1;
    }
    edges
};
