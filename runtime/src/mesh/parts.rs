//! Meshes of several parts: one after the other, and what touches has the same vertices.
//!
//! All parts are meshed over one lattice. Where two of them touch, both surfaces cross the same cells, and
//! each has a vertex there, as far from the other as their fields are off. The later part takes the vertex of
//! the earlier one, so that no crack is between them:
//!
//! ```text
//! vertices of one cell, of two parts, nearer than an eighth of the cell, with normals against each other
//! ```

use std::collections::HashMap;
use std::ops::Range;

use super::indexed::{Mesh, MeshPart};
use super::lattice::Lattice;
use super::report::{MAX_NEAR, MeshReport, ThinReport};

/// How near vertices of two parts have to be to become one, in cells.
const NEAR: f64 = 0.125;
/// The cosine between normals of surfaces that touch.
const AGAINST: f32 = -0.9;

/// Some of a mesh: a part, or all of it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MeshPiece<'a> {
    /// The name of the part; nothing for all of a mesh.
    pub name: Option<&'a str>,
    /// Its vertices.
    pub vertices: Range<usize>,
    /// Its triangles, whose vertices are among those.
    pub triangles: Range<usize>,
}

impl Mesh {
    /// The parts, or the whole mesh as one piece if it has none.
    #[must_use]
    pub fn pieces(&self) -> Vec<MeshPiece<'_>> {
        if self.parts.is_empty() {
            let (vertices, triangles) = (0..self.positions.len(), 0..self.triangles.len());
            return vec![MeshPiece { name: None, vertices, triangles }];
        }
        let mut pieces = Vec::with_capacity(self.parts.len());
        let (mut vertex, mut triangle) = (0, 0);
        for part in &self.parts {
            let (vertices, triangles) = (vertex..part.vertices, triangle..part.triangles);
            (vertex, triangle) = (part.vertices, part.triangles);
            pieces.push(MeshPiece { name: Some(part.name.as_str()), vertices, triangles });
        }
        pieces
    }

    /// A piece as a mesh of its own.
    #[must_use]
    pub fn piece(&self, piece: &MeshPiece<'_>) -> Self {
        let MeshPiece { vertices, triangles, .. } = piece;
        let first = vertices.start as u32;
        let widths: Vec<usize> = self.attributes.iter().map(|attribute| attribute.width).collect();
        let mut attributes = self.attributes.clone();
        for attribute in &mut attributes {
            let width = attribute.width;
            attribute.values = attribute.values[width * vertices.start..width * vertices.end].to_vec();
        }
        Self {
            origin: self.origin,
            orientation: self.orientation,
            positions: self.positions[vertices.clone()].to_vec(),
            normals: self.normals[vertices.clone()].to_vec(),
            attributes,
            triangles: self.triangles[triangles.clone()]
                .iter()
                .map(|triangle| triangle.map(|vertex| vertex - first))
                .collect(),
            creases: self.creases.of(vertices.clone(), triangles.clone(), &widths),
            parts: Vec::new(),
        }
    }

    /// The mesh of what becomes of each piece, which keeps its attributes.
    pub(crate) fn each_piece(&self, become_of: impl Fn(Self) -> Self) -> Self {
        let mut all = Self { origin: self.origin, orientation: self.orientation, ..Self::default() };
        for piece in self.pieces() {
            all.append(become_of(self.piece(&piece)));
            if let Some(name) = piece.name {
                let (vertices, triangles) = (all.positions.len(), all.triangles.len());
                all.parts.push(MeshPart { name: name.to_owned(), vertices, triangles });
            }
        }
        all
    }

    /// Adds the vertices and the triangles of another mesh. Both have the same attributes, unless there is
    /// nothing yet.
    fn append(&mut self, mut other: Self) {
        let (first, triangles) = (self.positions.len() as u32, self.triangles.len());
        if first == 0 {
            let empty = |one: &super::Attribute| super::Attribute { values: Vec::new(), ..one.clone() };
            self.attributes = other.attributes.iter().map(empty).collect();
        }
        self.positions.append(&mut other.positions);
        self.normals.append(&mut other.normals);
        for (to, mut from) in self.attributes.iter_mut().zip(other.attributes) {
            to.values.append(&mut from.values);
        }
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
        self.creases.append(other.creases, (first, triangles));
    }

    /// Adds a mesh as a part. Both are over this lattice, and have the same attributes.
    pub(crate) fn add_part(&mut self, name: &str, mut other: Self, lattice: &Lattice) {
        self.meet(&mut other, lattice);
        self.append(other);
        let (vertices, triangles) = (self.positions.len(), self.triangles.len());
        self.parts.push(MeshPart { name: name.to_owned(), vertices, triangles });
    }

    /// Moves vertices of another part onto those of this mesh that they touch.
    fn meet(&self, other: &mut Self, lattice: &Lattice) {
        let spacing = lattice.spacing();
        let cell = |position: [f32; 3]| -> [i64; 3] {
            std::array::from_fn(|axis| (f64::from(position[axis]) / spacing).floor() as i64)
        };
        if self.positions.is_empty() {
            return;
        }
        let mut known: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        for (vertex, &position) in self.positions.iter().enumerate() {
            known.entry(cell(position)).or_default().push(vertex as u32);
        }
        for vertex in 0..other.positions.len() {
            let (at, normal) = (other.positions[vertex], other.normals[vertex]);
            let Some(near) = known.get_mut(&cell(at)) else { continue };
            let apart = |to: [f32; 3]| -> f64 {
                (0..3).map(|axis| (f64::from(to[axis]) - f64::from(at[axis])).powi(2)).sum::<f64>().sqrt()
            };
            let touches = |&place: &usize| {
                let found = near[place] as usize;
                let cosine: f32 = (0..3).map(|axis| self.normals[found][axis] * normal[axis]).sum();
                cosine < AGAINST && apart(self.positions[found]) <= NEAR * spacing
            };
            let nearest = (0..near.len()).filter(touches).min_by(|&a, &b| {
                let of = |place: usize| apart(self.positions[near[place] as usize]);
                of(a).total_cmp(&of(b))
            });
            if let Some(place) = nearest {
                // Nobody else takes it: two vertices of one part stay two.
                other.positions[vertex] = self.positions[near.swap_remove(place) as usize];
            }
        }
    }
}

impl MeshReport {
    /// The report of two meshes.
    pub(crate) fn add(&mut self, other: Self) {
        self.closed &= other.closed;
        self.cut_sides.add(other.cut_sides);
        self.crowded |= other.crowded;
        let sums = [
            (&mut self.boxes, other.boxes),
            (&mut self.boxes_inside, other.boxes_inside),
            (&mut self.boxes_outside, other.boxes_outside),
            (&mut self.evaluations_spared, other.evaluations_spared),
            (&mut self.bricks, other.bricks),
            (&mut self.field_evaluations, other.field_evaluations),
            (&mut self.gradient_evaluations, other.gradient_evaluations),
            (&mut self.full_evaluations, other.full_evaluations),
            (&mut self.jump_evaluations, other.jump_evaluations),
            (&mut self.jump_vertices, other.jump_vertices),
            (&mut self.crossing_cells, other.crossing_cells),
            (&mut self.flipped_faces, other.flipped_faces),
        ];
        for (sum, more) in sums {
            *sum += more;
        }
        if let Some(more) = other.thin {
            self.thin.get_or_insert_with(ThinReport::default).add(more);
        }
    }
}

impl ThinReport {
    fn add(&mut self, other: Self) {
        self.missed += other.missed;
        self.shredded += other.shredded;
        self.unproven += other.unproven;
        self.places += other.places;
        self.boxes += other.boxes;
        self.near.extend(other.near);
        self.near.truncate(MAX_NEAR);
        self.cell = match (self.cell, other.cell) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
    }
}
