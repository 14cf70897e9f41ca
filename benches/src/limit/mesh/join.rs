//! The quads around the crossed edges of the lattice, and the mesh of all units.

use std::slice::IterMut;

use rayon::prelude::*;

use super::brick::{Brick, Cell};
use super::cell::sheet_of_edge;
use super::scene::{BRICK, Mesh, Scene};
use super::unit::Unit;

/// Bricks by their place.
struct Grid<'a> {
    scene: &'a Scene,
    /// For each place the number in `bricks`; anything where the surface does not cross the brick.
    numbers: Vec<u32>,
    bricks: Vec<Numbered<'a>>,
}

struct Numbered<'a> {
    brick: &'a Brick,
    /// Its first vertex in the mesh.
    first: u32,
}

impl Grid<'_> {
    /// A crossed cell, and the first vertex of its brick.
    #[inline]
    fn cell(&self, place: [usize; 3]) -> (u32, Cell) {
        let number = self.numbers[self.scene.brick_index(place.map(|index| index / BRICK))];
        let &Numbered { brick, first } = &self.bricks[number as usize];
        let [x, y, z] = place.map(|index| index % BRICK);
        (first, brick.cells[x + BRICK * (y + BRICK * z)])
    }
}

/// Joins units into a mesh.
pub(super) fn join(scene: &Scene, units: &[Unit]) -> Mesh {
    let mut firsts = Vec::with_capacity(units.len());
    let mut count = 0;
    for unit in units {
        firsts.push(count);
        count += unit.vertices.len();
    }
    assert!(u32::try_from(count).is_ok(), "vertices are numbered in 32 bits");
    let mut mesh = Mesh {
        positions: concatenate(count, units, |unit| &unit.vertices.positions),
        normals: concatenate(count, units, |unit| &unit.vertices.normals),
        colors: concatenate(count, units, |unit| &unit.vertices.colors),
        ..Mesh::default()
    };
    let mut grid = Grid { scene, numbers: vec![0; scene.bricks.iter().product()], bricks: Vec::new() };
    for (unit, first) in units.iter().zip(firsts) {
        for brick in &unit.bricks {
            grid.numbers[scene.brick_index(brick.place)] = grid.bricks.len() as u32;
            grid.bricks.push(Numbered { brick, first: first as u32 + brick.first });
        }
    }
    let quads = grid.bricks.iter().map(|numbered| numbered.brick.quads);
    let mut triangles = vec![[[0; 3]; 2]; quads.clone().sum()];
    let mut slices = Vec::with_capacity(grid.bricks.len());
    let mut rest = &mut triangles[..];
    for count in quads {
        let (slice, after) = rest.split_at_mut(count);
        slices.push(slice);
        rest = after;
    }
    grid.bricks.par_iter().zip(slices).with_min_len(CHUNK).for_each(|(numbered, slice)| {
        brick_triangles(&grid, numbered, &mesh.positions, slice);
    });
    mesh.triangles = triangles.into_flattened();
    mesh
}

/// Bricks whose triangles a thread makes at a time, or more.
const CHUNK: usize = 64;

/// One list of all parts' elements.
fn concatenate<P: Sync, T: Copy + Default + Send + Sync, const N: usize>(
    count: usize,
    parts: &[P],
    elements: impl Fn(&P) -> &Vec<[T; N]> + Sync,
) -> Vec<[T; N]> {
    let mut all = vec![[T::default(); N]; count];
    let mut rest = &mut all[..];
    let mut slices = Vec::with_capacity(parts.len());
    for part in parts {
        let (slice, after) = rest.split_at_mut(elements(part).len());
        slices.push(slice);
        rest = after;
    }
    slices.into_par_iter().zip(parts).for_each(|(slice, part)| slice.copy_from_slice(elements(part)));
    all
}

/// The triangles of the quads around the edges at the low corners of a brick's crossed cells.
fn brick_triangles(
    grid: &Grid<'_>,
    numbered: &Numbered<'_>,
    positions: &[[f32; 3]],
    quads: &mut [[[u32; 3]; 2]],
) {
    let mut quads = quads.iter_mut();
    for number in numbered.brick.crossed() {
        edge_triangles::<0>(grid, numbered, number, positions, &mut quads);
        edge_triangles::<1>(grid, numbered, number, positions, &mut quads);
        edge_triangles::<2>(grid, numbered, number, positions, &mut quads);
    }
}

/// The two triangles around the edge along an axis at the low corner of a crossed cell, if the edge is
/// crossed.
#[inline(always)]
fn edge_triangles<const AXIS: usize>(
    grid: &Grid<'_>,
    numbered: &Numbered<'_>,
    number: usize,
    positions: &[[f32; 3]],
    quads: &mut IterMut<'_, [[u32; 3]; 2]>,
) {
    let (first, cells) = (numbered.first, &numbered.brick.cells);
    let signs = cells[number].signs();
    let inside = [signs & 1 == 1, signs >> (1 << AXIS) & 1 == 1];
    if inside[0] == inside[1] {
        return;
    }
    // Around the edge, seen from its end. A cell that lies back along an axis has the edge on its high side
    // there.
    let (b, c) = (const { STRIDE[(AXIS + 1) % 3] }, const { STRIDE[(AXIS + 2) % 3] });
    let quad = if !(number / b).is_multiple_of(BRICK) && !(number / c).is_multiple_of(BRICK) {
        [
            vertex(first, cells[number - b - c], 4 * AXIS + 3),
            vertex(first, cells[number - c], 4 * AXIS + 2),
            vertex(first, cells[number], 4 * AXIS),
            vertex(first, cells[number - b], 4 * AXIS + 1),
        ]
    } else {
        let Some(quad) = quad_across(grid, numbered.brick, number, AXIS) else { return };
        quad
    };
    // Where the inside is at the end, it is seen from the other side.
    let [p, q, r, s] = if inside[1] { [quad[3], quad[2], quad[1], quad[0]] } else { quad };
    let shorter = squared_distance(positions, p, r) <= squared_distance(positions, q, s);
    // Both ways, q r s or p q r comes first: a choice of numbers, and no jump that would be guessed wrong
    // half of the time.
    let (d, e) = if shorter { (p, r) } else { (s, q) };
    if let Some(triangles) = quads.next() {
        *triangles = [[q, r, d], [e, s, p]];
    }
}

/// The distance of the numbers of cells side by side.
const STRIDE: [usize; 3] = [1, BRICK, BRICK * BRICK];

/// The vertex of a cell at one of its crossed edges.
#[inline(always)]
fn vertex(first: u32, cell: Cell, edge: usize) -> u32 {
    first + cell.vertex() + sheet_of_edge(cell.signs(), cell.flips(), edge)
}

/// A quad whose cells may be in several bricks; nothing where the lattice ends.
fn quad_across(grid: &Grid<'_>, brick: &Brick, number: usize, axis: usize) -> Option<[u32; 4]> {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let place: [usize; 3] =
        std::array::from_fn(|axis| brick.place[axis] * BRICK + number / STRIDE[axis] % BRICK);
    let mut quad = [0; 4];
    for (corner, (back_b, back_c)) in quad.iter_mut().zip([(1, 1), (0, 1), (0, 0), (1, 0)]) {
        let mut place = place;
        place[b] = place[b].checked_sub(back_b)?;
        place[c] = place[c].checked_sub(back_c)?;
        let (first, cell) = grid.cell(place);
        *corner = vertex(first, cell, 4 * axis + back_b + 2 * back_c);
    }
    Some(quad)
}

fn squared_distance(positions: &[[f32; 3]], p: u32, q: u32) -> f32 {
    let (p, q) = (positions[p as usize], positions[q as usize]);
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    x * x + y * y + z * z
}
