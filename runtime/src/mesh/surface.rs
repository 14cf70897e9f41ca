//! Quads around the crossed edges of the lattice, and the triangles that they become.

use rayon::prelude::*;

use super::Mesh;
use super::cell::{EDGE_CORNERS, sheets};
use super::crossing::{Cell, Crossings, Layer};
use super::vertex::Vertex;

/// Four vertices around a crossed edge, counter-clockwise when seen from outside.
pub(crate) type Quad = [u32; 4];

/// The quads, in the order of the cell that owns them: of the four cells around an edge, the last.
pub(crate) fn quads(crossings: &Crossings) -> Vec<Quad> {
    let layers = &crossings.layers;
    let of_layer = |z: usize| {
        let mut quads = Vec::new();
        let below = z.checked_sub(1).map(|z| &layers[z]);
        for y in 0..layers[z].rows() {
            row_quads(&layers[z], below, y, &mut quads);
        }
        quads
    };
    (0..layers.len()).into_par_iter().map(of_layer).collect::<Vec<_>>().concat()
}

/// A walk along a row of cells that answers for ascending x.
struct Cursor<'a> {
    row: &'a [Cell],
}

impl<'a> Cursor<'a> {
    /// The row of one y, or an empty one where the lattice has none.
    fn new(layer: Option<&'a Layer>, y: Option<usize>) -> Self {
        Cursor { row: layer.zip(y).map_or(&[], |(layer, y)| layer.row(y)) }
    }

    /// The cell at `x`, if it is crossed. Later calls may go back by one cell, and not further.
    fn at(&mut self, x: u32) -> Option<&'a Cell> {
        while let [first, rest @ ..] = self.row
            && first.x + 1 < x
        {
            self.row = rest;
        }
        self.row.iter().take(2).find(|cell| cell.x == x)
    }
}

/// The quads that the cells of one row own.
fn row_quads(layer: &Layer, below: Option<&Layer>, y: usize, quads: &mut Vec<Quad>) {
    let back = y.checked_sub(1);
    // rows[dy + 2 dz] is that of (y - dy, z - dz).
    let mut rows = [(Some(layer), Some(y)), (Some(layer), back), (below, Some(y)), (below, back)]
        .map(|(layer, y)| Cursor::new(layer, y));
    for cell in layer.row(y) {
        for axis in 0..3 {
            let inside = [0, 1 << axis].map(|corner| cell.signs >> corner & 1 == 1);
            if inside[0] == inside[1] {
                continue;
            }
            // Around the edge, seen from its end: (b, c) goes through (low, low), (high, low), (high, high), (low, high).
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |low_b: bool, low_c: bool| {
                let back = usize::from(low_b) << b | usize::from(low_c) << c;
                // A cell that lies low along an axis has the edge on its high side there.
                let edge = 4 * axis + usize::from(low_b) + 2 * usize::from(low_c);
                (back, edge)
            };
            let around = [corner(true, true), corner(false, true), corner(false, false), corner(true, false)];
            let Some(mut quad) = vertices_at(&mut rows, cell.x, around) else { continue };
            if inside[1] {
                // The inside is at the end, so this quad is seen from the other side.
                quad.reverse();
            }
            quads.push(quad);
        }
    }
}

/// The vertices of four cells, each given by how far it lies back (a bit for each axis) and by its own number of the edge; or
/// nothing where the lattice ends.
fn vertices_at(rows: &mut [Cursor<'_>; 4], x: u32, around: [(usize, usize); 4]) -> Option<Quad> {
    let mut quad = [0; 4];
    for (vertex, (back, edge)) in quad.iter_mut().zip(around) {
        let cell = rows[back >> 1].at(x.checked_sub(back as u32 & 1)?)?;
        *vertex = cell.vertex + sheets(cell.signs, cell.flips).of_edge(edge)?;
    }
    Some(quad)
}

/// Drops the vertices that no quad uses, and renumbers the others in their order.
pub(crate) fn drop_unused(vertices: &mut Vec<Vertex>, quads: &mut [Quad]) {
    const UNUSED: u32 = u32::MAX;
    let mut numbers = vec![UNUSED; vertices.len()];
    for &vertex in quads.iter().flatten() {
        numbers[vertex as usize] = 0;
    }
    for (next, number) in (0..).zip(numbers.iter_mut().filter(|number| **number != UNUSED)) {
        *number = next;
    }
    let mut old = numbers.iter();
    vertices.retain(|_| old.next() != Some(&UNUSED));
    for vertex in quads.iter_mut().flatten() {
        *vertex = numbers[*vertex as usize];
    }
}

/// Splits each quad along its shorter diagonal, or from its first vertex if they are equal.
pub(crate) fn triangles(positions: &[[f32; 3]], quads: &[Quad]) -> Vec<[u32; 3]> {
    let distance = |p: u32, q: u32| {
        let (p, q) = (positions[p as usize], positions[q as usize]);
        (0..3).map(|axis| (f64::from(p[axis]) - f64::from(q[axis])).powi(2)).sum::<f64>()
    };
    let mut triangles = vec![[0; 3]; 2 * quads.len()];
    triangles.par_chunks_exact_mut(2).zip(quads).for_each(|(pair, &[p, q, r, s])| {
        let split =
            if distance(p, r) <= distance(q, s) { [[p, q, r], [p, r, s]] } else { [[q, r, s], [q, s, p]] };
        pair.copy_from_slice(&split);
    });
    triangles
}

/// Gives the vertices without a normal (the gradient vanishes there, or is no number) that of their triangles, weighted by
/// area; or up, if they have no area either.
pub(crate) fn repair_normals(mesh: &mut Mesh) {
    let Mesh { positions, normals, triangles, .. } = mesh;
    if !normals.par_iter().any(|normal| *normal == [0.0; 3]) {
        return;
    }
    let mut sums = vec![[0.0_f64; 3]; normals.len()];
    for triangle in &*triangles {
        let area = area_vector(triangle.map(|vertex| positions[vertex as usize]));
        for &vertex in triangle {
            for axis in 0..3 {
                sums[vertex as usize][axis] += area[axis];
            }
        }
    }
    for (normal, sum) in normals.iter_mut().zip(sums).filter(|(normal, _)| **normal == [0.0; 3]) {
        *normal = unit(sum).unwrap_or([0.0, 0.0, 1.0]);
    }
}

/// The normal of a triangle, counter-clockwise, if it has an area.
pub(crate) fn facet_normal(corners: [[f32; 3]; 3]) -> Option<[f32; 3]> {
    unit(area_vector(corners))
}

/// The vector along the normal of a triangle, as long as twice its area.
fn area_vector(corners: [[f32; 3]; 3]) -> [f64; 3] {
    let [p, q, r] = corners.map(|corner| corner.map(f64::from));
    let [u, v] = [q, r].map(|end| [end[0] - p[0], end[1] - p[1], end[2] - p[2]]);
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// A vector divided by its length, if it has one.
pub(crate) fn unit(vector: [f64; 3]) -> Option<[f32; 3]> {
    let length = vector.iter().map(|c| c * c).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| vector.map(|c| (c / length) as f32))
}

// The numbers of the edges above are those of the cell's table.
const _: () = {
    let mut edge = 0;
    while edge < 12 {
        let (axis, b, c) = (edge / 4, edge & 1, edge >> 1 & 1);
        assert!(EDGE_CORNERS[edge][0] == b << ((axis + 1) % 3) | c << ((axis + 2) % 3));
        edge += 1;
    }
};
