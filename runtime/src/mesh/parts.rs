//! Meshes of several parts: one after the other, and what touches has the same vertices.
//!
//! All parts are meshed over one lattice. Where two of them touch, both surfaces cross the same cells, and
//! each has a vertex there, as far from the other as their fields are off. The later part takes the vertex of
//! the earlier one, so that no crack is between them:
//!
//! ```text
//! vertices of one cell, of two parts, nearer than an eighth of the cell, with normals against each other
//! ```
//!
//! Parts may have millions of vertices, so whoever joins or separates them asks now and then whether to go
//! on.

use std::convert::Infallible;
use std::ops::Range;

use rustc_hash::{FxBuildHasher, FxHashMap as HashMap};

use super::crease::{copied, extended};
use super::indexed::{Attribute, Mesh, MeshPart};
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
        let Ok(piece) = self.piece_asking(piece, &|| Ok::<_, Infallible>(()));
        piece
    }

    /// As [`piece`](Self::piece). Every now and then it is asked whether to go on.
    fn piece_asking<E>(&self, piece: &MeshPiece<'_>, go_on: &dyn Fn() -> Result<(), E>) -> Result<Self, E> {
        let MeshPiece { vertices, triangles, .. } = piece;
        let first = vertices.start as u32;
        let widths: Vec<usize> = self.attributes.iter().map(|attribute| attribute.width).collect();
        let of = |Attribute { name, width, values }: &Attribute| {
            let values = copied(&values[width * vertices.start..width * vertices.end], 0, go_on)?;
            Ok(Attribute { name: name.clone(), width: *width, values })
        };
        let mut own = Vec::with_capacity(triangles.len());
        let among = |triangle: &[u32; 3]| triangle.map(|vertex| vertex - first);
        extended(&mut own, &self.triangles[triangles.clone()], among, go_on)?;
        Ok(Self {
            origin: self.origin,
            orientation: self.orientation,
            positions: copied(&self.positions[vertices.clone()], 0, go_on)?,
            normals: copied(&self.normals[vertices.clone()], 0, go_on)?,
            attributes: self.attributes.iter().map(of).collect::<Result<_, E>>()?,
            triangles: own,
            creases: self.creases.of(vertices.clone(), triangles.clone(), &widths),
            parts: Vec::new(),
        })
    }

    /// The mesh of what becomes of each piece, which keeps its attributes. Every now and then it is asked
    /// whether to go on.
    pub(crate) fn each_piece<E>(
        &self,
        become_of: impl Fn(Self) -> Result<Self, E>,
        go_on: &dyn Fn() -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut all = Self { origin: self.origin, orientation: self.orientation, ..Self::default() };
        for piece in self.pieces() {
            all.append(become_of(self.piece_asking(&piece, go_on)?)?, go_on)?;
            if let Some(name) = piece.name {
                let (vertices, triangles) = (all.positions.len(), all.triangles.len());
                all.parts.push(MeshPart { name: name.to_owned(), vertices, triangles });
            }
        }
        Ok(all)
    }

    /// Adds the vertices and the triangles of another mesh. Both have the same attributes, unless there is
    /// nothing yet. If it is not to go on, some of them are there.
    fn append<E>(&mut self, other: Self, go_on: &dyn Fn() -> Result<(), E>) -> Result<(), E> {
        let (first, triangles) = (self.positions.len() as u32, self.triangles.len());
        if first == 0 {
            let empty = |one: &Attribute| Attribute { values: Vec::new(), ..one.clone() };
            self.attributes = other.attributes.iter().map(empty).collect();
        }
        extended(&mut self.positions, &other.positions, |&position| position, go_on)?;
        extended(&mut self.normals, &other.normals, |&normal| normal, go_on)?;
        for (to, from) in self.attributes.iter_mut().zip(&other.attributes) {
            extended(&mut to.values, &from.values, |&value| value, go_on)?;
        }
        let moved = |triangle: &[u32; 3]| triangle.map(|vertex| vertex + first);
        extended(&mut self.triangles, &other.triangles, moved, go_on)?;
        self.creases.append(other.creases, (first, triangles));
        Ok(())
    }

    /// Adds a mesh as a part. Both are over this lattice, and have the same attributes. Every now and then it
    /// is asked whether to go on; if not, the part is not whole.
    pub(crate) fn add_part<E>(
        &mut self,
        name: &str,
        mut other: Self,
        lattice: &Lattice,
        go_on: &dyn Fn() -> Result<(), E>,
    ) -> Result<(), E> {
        self.meet(&mut other, lattice, go_on)?;
        self.append(other, go_on)?;
        let (vertices, triangles) = (self.positions.len(), self.triangles.len());
        self.parts.push(MeshPart { name: name.to_owned(), vertices, triangles });
        Ok(())
    }

    /// Moves vertices of another part onto those of this mesh that they touch.
    fn meet<E>(
        &self,
        other: &mut Self,
        lattice: &Lattice,
        go_on: &dyn Fn() -> Result<(), E>,
    ) -> Result<(), E> {
        let spacing = lattice.spacing();
        let cell = |position: [f32; 3]| -> [i64; 3] {
            std::array::from_fn(|axis| (f64::from(position[axis]) / spacing).floor() as i64)
        };
        let mut known = NearVertices::of(&self.positions, &other.positions, cell, go_on)?;
        if known.vertices.is_empty() {
            return Ok(());
        }
        for first in (0..other.positions.len()).step_by(VERTICES) {
            go_on()?;
            for vertex in first..other.positions.len().min(first + VERTICES) {
                let (at, normal) = (other.positions[vertex], other.normals[vertex]);
                let apart = |to: [f32; 3]| -> f64 {
                    (0..3).map(|axis| (f64::from(to[axis]) - f64::from(at[axis])).powi(2)).sum::<f64>().sqrt()
                };
                let touches = |found: u32| {
                    let (to, facing) = (self.positions[found as usize], self.normals[found as usize]);
                    let cosine: f32 = (0..3).map(|axis| facing[axis] * normal[axis]).sum();
                    let apart = apart(to);
                    (cosine < AGAINST && apart <= NEAR * spacing).then_some(apart)
                };
                if let Some(found) = known.take_nearest(cell(at), touches) {
                    other.positions[vertex] = self.positions[found as usize];
                }
            }
        }
        Ok(())
    }
}

/// Vertices that are looked at between two questions whether to go on.
const VERTICES: usize = 1 << 12;

/// Vertices of a mesh by their cells: lists of few links each, in one array, because many small ones could
/// not be given back while somebody waits.
struct NearVertices {
    /// The last vertex of each cell.
    last: HashMap<[i64; 3], u32>,
    /// Each with the place of the one before it in its cell. `None` where somebody has taken the vertex.
    vertices: Vec<(Option<u32>, Option<u32>)>,
}

impl NearVertices {
    /// Those of a mesh that are in a box of cells around another one.
    fn of<E>(
        positions: &[[f32; 3]],
        others: &[[f32; 3]],
        cell: impl Fn([f32; 3]) -> [i64; 3],
        go_on: &dyn Fn() -> Result<(), E>,
    ) -> Result<Self, E> {
        let (mut low, mut high) = ([i64::MAX; 3], [i64::MIN; 3]);
        for part in others.chunks(VERTICES) {
            go_on()?;
            for cell in part.iter().map(|&at| cell(at)) {
                for axis in 0..3 {
                    low[axis] = low[axis].min(cell[axis]);
                    high[axis] = high[axis].max(cell[axis]);
                }
            }
        }
        let mut near = Vec::new();
        for (part, first) in positions.chunks(VERTICES).zip((0_u32..).step_by(VERTICES)) {
            go_on()?;
            let cells = (first..).zip(part.iter().map(|&at| cell(at)));
            near.extend(
                cells.filter(|(_, cell)| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&cell[axis]))),
            );
        }
        // With room for all, since a table that grows does so at one go.
        let mut last = HashMap::with_capacity_and_hasher(near.len(), FxBuildHasher);
        let mut vertices = Vec::with_capacity(near.len());
        for (place, (vertex, cell)) in (0..).zip(near) {
            if place % VERTICES as u32 == 0 {
                go_on()?;
            }
            vertices.push((Some(vertex), last.insert(cell, place)));
        }
        Ok(Self { last, vertices })
    }

    /// Takes the vertex of a cell that is nearest of those that are near: nobody else takes it, so two
    /// vertices of one part stay two. Of equally near ones it is the first.
    fn take_nearest(&mut self, cell: [i64; 3], apart: impl Fn(u32) -> Option<f64>) -> Option<u32> {
        let mut nearest: Option<(f64, u32)> = None;
        let mut at = self.last.get(&cell).copied();
        while let Some(place) = at {
            let (vertex, before) = self.vertices[place as usize];
            if let Some(distance) = vertex.and_then(&apart)
                && nearest.is_none_or(|(least, _)| distance <= least)
            {
                nearest = Some((distance, place));
            }
            at = before;
        }
        self.vertices[nearest?.1 as usize].0.take()
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

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::super::indexed::Creases;
    use super::*;

    /// Whether to go on, and work that asks that.
    type Asked<'a> = &'a dyn Fn() -> Result<(), ()>;
    type Work<'a> = &'a dyn Fn(Asked<'_>) -> Result<(), ()>;

    /// So many vertices at random in a box of 6^3 cells that begins at `low`, with normals up or down, each
    /// with a side.
    fn cloud(seed: u64, count: usize, low: f32) -> Mesh {
        let mut rng = fastrand::Rng::with_seed(seed);
        let numbers = 0..count as u32;
        let normals: Vec<[f32; 3]> = (0..count).map(|_| [0.0, 0.0, [1.0, -1.0][rng.usize(..2)]]).collect();
        let heat = |values: Vec<f32>| Attribute { name: "heat".to_owned(), width: 1, values };
        Mesh {
            positions: (0..count).map(|_| std::array::from_fn(|_| low + 6.0 * rng.f32())).collect(),
            attributes: vec![heat((0..count).map(|_| rng.f32()).collect())],
            triangles: numbers.clone().map(|vertex| [vertex, vertex / 2, vertex / 3]).collect(),
            creases: Creases {
                vertices: numbers.clone().collect(),
                normals: normals.clone(),
                attributes: vec![vec![0.5; count]],
                corners: numbers.map(|side| [3 * side, side]).collect(),
            },
            normals,
            ..Mesh::default()
        }
    }

    fn lattice() -> Lattice {
        Lattice::covering([-8.0; 3], [8.0; 3], 1.0).expect("a good lattice")
    }

    fn add(all: &mut Mesh, name: &str, other: Mesh) {
        all.add_part(name, other, &lattice(), &|| Ok::<_, Infallible>(()))
            .unwrap_or_else(|never| match never {});
    }

    #[test]
    fn vertices_that_touch_become_the_nearest_one() {
        let (first, second) = (cloud(1, 4_000, -2.5), cloud(2, 9_000, -1.5));
        let mut all = Mesh::default();
        add(&mut all, "first", first.clone());
        add(&mut all, "second", second.clone());
        // Each in turn takes the nearest of all that are left.
        let (mut taken, mut met) = (vec![false; first.positions.len()], 0);
        for (vertex, &at) in second.positions.iter().enumerate() {
            let apart = |to: [f32; 3]| -> f64 {
                (0..3).map(|axis| (f64::from(to[axis]) - f64::from(at[axis])).powi(2)).sum::<f64>().sqrt()
            };
            let touches = |&other: &usize| {
                let to = first.positions[other];
                !taken[other]
                    && first.normals[other][2] * second.normals[vertex][2] < 0.0
                    && to.map(f32::floor) == at.map(f32::floor)
                    && apart(to) <= NEAR
            };
            let nearest = (0..first.positions.len())
                .filter(touches)
                .min_by(|&a, &b| apart(first.positions[a]).total_cmp(&apart(first.positions[b])));
            let expected = nearest.map_or(at, |other| first.positions[other]);
            assert_eq!(all.positions[first.positions.len() + vertex], expected, "vertex {vertex}");
            if let Some(other) = nearest {
                (taken[other], met) = (true, met + 1);
            }
        }
        assert!(met > 200, "{met} touch");
        assert_eq!(all.pieces().len(), 2);
        assert_eq!(all.piece(&all.pieces()[0]), first);
    }

    #[test]
    fn joining_and_separating_ask_and_stop() {
        let (first, second) = (cloud(3, 70_000, -3.0), cloud(4, 150_000, -3.0));
        let stopped_after = |most: usize, work: Work<'_>| {
            let asked = Cell::new(0);
            let go_on = || {
                asked.set(asked.get() + 1);
                if asked.get() > most { Err(()) } else { Ok(()) }
            };
            (work(&go_on), asked.get())
        };
        let join = |go_on: Asked<'_>| {
            let mut all = first.clone();
            all.add_part("second", second.clone(), &lattice(), go_on)
        };
        let mut both = Mesh::default();
        add(&mut both, "first", first.clone());
        add(&mut both, "second", second.clone());
        let split = |go_on: Asked<'_>| both.split_asking(go_on).map(drop);
        // Of vertices, all are looked at three times where parts meet.
        for (work, least) in [(&join as Work<'_>, 80), (&split, 25)] {
            let (done, asked) = stopped_after(usize::MAX, work);
            assert!(done.is_ok() && asked >= least, "asked {asked} times");
            for most in [0, 1, asked / 2, asked - 1] {
                assert_eq!(stopped_after(most, work), (Err(()), most + 1));
            }
        }
    }
}
