//! A cube that judges meshes of itself.

use std::collections::BTreeMap;

use glam::{DAffine3, DQuat, DVec3};
use jbt::Polygonized;

/// A cube.
pub(crate) struct Cube {
    half: f64,
    /// From the world to its axes.
    inverse: DAffine3,
}

/// How well a mesh has the edges of a cube. Lengths are in cells.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// Cells whose crossings are on several faces.
    pub(crate) cells: usize,
    /// Of these, those whose vertex is within 1e-2 of an edge.
    pub(crate) good: usize,
    /// The largest distance of such a vertex from an edge.
    pub(crate) worst: f64,
    /// Those that are farther than half a cell from an edge, and farther than without sharp edges.
    pub(crate) worse: usize,
    /// The largest distance of a corner of the cube from a vertex.
    pub(crate) worst_corner: f64,
    /// The number of corners with a vertex within 1e-2, and of those with more than one.
    pub(crate) corners: [usize; 2],
    /// Triangles that look inwards.
    pub(crate) folded: usize,
}

/// The ends of the edges of a cell, as steps of its low corner.
const EDGES: [([usize; 3], usize); 12] = [
    ([0, 0, 0], 0),
    ([0, 1, 0], 0),
    ([0, 0, 1], 0),
    ([0, 1, 1], 0),
    ([0, 0, 0], 1),
    ([1, 0, 0], 1),
    ([0, 0, 1], 1),
    ([1, 0, 1], 1),
    ([0, 0, 0], 2),
    ([1, 0, 0], 2),
    ([0, 1, 0], 2),
    ([1, 1, 0], 2),
];

impl Cube {
    /// A cube along the axes, with its centre as far along each.
    pub(crate) fn along_axes(half: f64, centre: f64) -> Self {
        Self { half, inverse: DAffine3::from_translation(DVec3::splat(-centre)) }
    }

    pub(crate) fn turned(half: f64, axis: [f64; 3], degrees: f64) -> Self {
        let turn = DQuat::from_axis_angle(DVec3::from(axis).normalize(), degrees.to_radians());
        Self { half, inverse: DAffine3::from_quat(turn).inverse() }
    }

    /// How far inside a point is.
    fn depth(&self, p: DVec3) -> f64 {
        self.half - self.inverse.transform_point3(p).abs().max_element()
    }

    /// The face that is nearest to a point of the surface.
    fn face(&self, p: DVec3) -> usize {
        let q = self.inverse.transform_point3(p);
        let axis = (0..3).fold(0, |best, axis| if q[axis].abs() > q[best].abs() { axis } else { best });
        2 * axis + usize::from(q[axis] > 0.0)
    }

    /// The distance of a point from the nearest edge.
    fn edge_distance(&self, p: DVec3) -> f64 {
        let q = self.inverse.transform_point3(p).abs();
        let off = |axis: usize| {
            let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
            DVec3::new((q[axis] - self.half).max(0.0), q[b] - self.half, q[c] - self.half).length()
        };
        (0..3).map(off).fold(f64::INFINITY, f64::min)
    }

    /// Judges a mesh by its vertices at edges. `usual` is the mesh without sharp edges, whose vertices tell
    /// their cells: they are the same ones, and none has left its cell.
    pub(crate) fn judge(&self, made: &Polygonized, usual: &Polygonized) -> Found {
        let (cells, size) = (made.lattice.cells(), made.lattice.spacing());
        let coordinates = |axis: usize| (0..=cells[axis]).map(move |n| made.lattice.coordinate(axis, n));
        let axes = [0, 1, 2].map(|axis| coordinates(axis).collect::<Vec<f32>>());
        let positions: Vec<DVec3> =
            made.mesh.positions.iter().map(|&p| DVec3::from(p.map(f64::from))).collect();
        let at = |index: [usize; 3]| DVec3::from([0, 1, 2].map(|axis| f64::from(axes[axis][index[axis]])));
        assert_eq!(positions.len(), usual.mesh.positions.len(), "each sheet of a cell has a vertex");
        let mut vertices: BTreeMap<[usize; 3], Vec<usize>> = BTreeMap::new();
        for (vertex, position) in usual.mesh.positions.iter().enumerate() {
            let cell = [0, 1, 2].map(|axis| axes[axis].partition_point(|&c| c <= position[axis]) - 1);
            vertices.entry(cell).or_default().push(vertex);
        }
        let all = (0..cells[0])
            .flat_map(|x| (0..cells[1]).flat_map(move |y| (0..cells[2]).map(move |z| [x, y, z])));
        let crossed: Vec<[usize; 3]> =
            all.filter(|&cell| (1..255).contains(&self.signs(cell, &at))).collect();
        assert!(crossed.iter().eq(vertices.keys()), "each crossed cell has a vertex, and no other one has");
        let mut found = Found::default();
        for (cell, vertices) in vertices {
            if sheets(self.signs(cell, &at)) > 1 || self.faces(cell, &at).count_ones() < 2 {
                continue;
            }
            let &[vertex] = &vertices[..] else { panic!("{cell:?} has one sheet: {vertices:?}") };
            let distance = self.edge_distance(positions[vertex]) / size;
            let before = self.edge_distance(DVec3::from(usual.mesh.positions[vertex].map(f64::from))) / size;
            found.worse += usize::from(distance > before.max(0.5));
            found.cells += 1;
            found.good += usize::from(distance < 1e-2);
            found.worst = found.worst.max(distance);
        }
        for corner in 0..8 {
            let corner = DVec3::from(
                [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { self.half } else { -self.half }),
            );
            let corner = self.inverse.inverse().transform_point3(corner);
            let distances = positions.iter().map(|p| p.distance(corner) / size);
            found.worst_corner = found.worst_corner.max(distances.clone().fold(f64::INFINITY, f64::min));
            let near = distances.filter(|&distance| distance < 1e-2).count();
            found.corners[0] += usize::from(near > 0);
            found.corners[1] += usize::from(near > 1);
        }
        for triangle in &made.mesh.triangles {
            let [p, q, r] = triangle.map(|vertex| positions[vertex as usize]);
            let area = (q - p).cross(r - p);
            // Slivers have no side.
            let is_there = area.length() > 1e-3 * size * size;
            found.folded += usize::from(is_there && area.dot(p + q + r) < 0.0);
        }
        found
    }

    /// Which corners of a cell are inside, a bit each.
    fn signs(&self, cell: [usize; 3], at: &dyn Fn([usize; 3]) -> DVec3) -> u8 {
        let corner = |n: usize| at([0, 1, 2].map(|axis| cell[axis] + (n >> axis & 1)));
        (0..8).fold(0, |signs, n| signs | u8::from(self.depth(corner(n)) >= 0.0) << n)
    }

    /// The faces on which the crossings of a cell are, a bit each.
    fn faces(&self, cell: [usize; 3], at: &dyn Fn([usize; 3]) -> DVec3) -> u8 {
        let mut faces = 0;
        for (step, axis) in EDGES {
            let low = [0, 1, 2].map(|n| cell[n] + step[n]);
            let mut high = low;
            high[axis] += 1;
            let (mut outside, mut inside) = (at(low), at(high));
            if (self.depth(outside) >= 0.0) == (self.depth(inside) >= 0.0) {
                continue;
            }
            if self.depth(outside) >= 0.0 {
                (outside, inside) = (inside, outside);
            }
            for _ in 0..40 {
                let middle = 0.5 * (outside + inside);
                if self.depth(middle) >= 0.0 { inside = middle } else { outside = middle }
            }
            // Where a face is in a plane of the lattice, an inner end may be on its edge.
            faces |= 1_u8 << self.face(outside);
        }
        faces
    }
}

/// The sheets of a cell of a convex body: one for each part of its corners inside, or outside.
fn sheets(signs: u8) -> usize {
    let parts = |signs: u8| {
        let (mut left, mut count) = (signs, 0);
        while left != 0 {
            let mut part: u8 = 1 << left.trailing_zeros();
            for n in (0..8).cycle().take(64) {
                if part >> n & 1 == 1 {
                    part |= (0..3).fold(0, |bits, axis| bits | 1 << (n ^ 1 << axis)) & signs;
                }
            }
            left &= !part;
            count += 1;
        }
        count
    };
    parts(signs).max(parts(!signs))
}
