//! Doubtful normals: they are compared with the triangles around their vertices.
//!
//! ```text
//! triangles   a quad at a doubtful vertex: the places of its corners among these, and the areas of its
//!             triangles, while they are in the cache
//! crease      some of these quads are divided anew: their areas, too
//! repair      sums of areas at each doubtful vertex, in the order of the triangles
//! ```

use jbt_ir::watch;

use crate::progress::{Cancelled, Progress};
use crate::span::span;

use super::area::{area_vector, unit};
use super::indexed::Mesh;

/// A set of vertices, which is asked at each triangle: a bit for each vertex.
pub(crate) struct VertexSet {
    /// The first vertex that may be in it.
    first: u32,
    /// The vertices from there on, in ascending bits.
    bits: Vec<u64>,
    /// For each word of bits, how many there are before it.
    before: Vec<u32>,
}

impl VertexSet {
    /// No vertex.
    pub(crate) const NONE: Self = Self { first: 0, bits: Vec::new(), before: Vec::new() };

    /// Some vertices of a range of `count` that begins at `first`, ascending and counted from there.
    pub(crate) fn new(first: u32, count: usize, vertices: impl Iterator<Item = u32>) -> Self {
        let mut vertices = vertices.peekable();
        if vertices.peek().is_none() {
            return Self::NONE;
        }
        let mut bits = vec![0_u64; count.div_ceil(64)];
        vertices.for_each(|vertex| bits[vertex as usize / 64] |= 1 << (vertex % 64));
        let before = bits.iter().scan(0, |sum, word| {
            let before = *sum;
            *sum += word.count_ones();
            Some(before)
        });
        let before = before.collect();
        Self { first, bits, before }
    }

    fn is_empty(&self) -> bool {
        self.bits.is_empty()
    }

    /// How many vertices it has.
    fn len(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Its vertices, ascending.
    fn iter(&self) -> impl Iterator<Item = u32> {
        let of_word = |(word, first): (&u64, u32)| {
            let rest = std::iter::successors(Some(*word), |rest| Some(rest & rest.wrapping_sub(1)));
            rest.take_while(|rest| *rest != 0).map(move |rest| first + rest.trailing_zeros())
        };
        self.bits.iter().zip((self.first..).step_by(64)).flat_map(of_word)
    }

    /// 1 if a vertex is in it, else 0.
    #[inline(always)]
    pub(super) fn has(&self, vertex: u32) -> u64 {
        let vertex = vertex.wrapping_sub(self.first);
        self.bits.get(vertex as usize / 64).map_or(0, |word| word >> (vertex % 64) & 1)
    }

    /// The place of a vertex among those that are in it.
    fn place(&self, vertex: u32) -> Option<u32> {
        let vertex = vertex.wrapping_sub(self.first);
        let word = *self.bits.get(vertex as usize / 64)?;
        let (bit, lower) = (word >> (vertex % 64) & 1, word & ((1 << (vertex % 64)) - 1));
        (bit == 1).then(|| self.before[vertex as usize / 64] + lower.count_ones())
    }

    /// Some quads by their numbers, if they have a vertex of the set.
    pub(crate) fn quads(
        &self,
        quads: impl Iterator<Item = (usize, [[u32; 3]; 2])>,
        positions: &[[f32; 3]],
    ) -> impl Iterator<Item = DoubtfulQuad> {
        // Whatever the diagonal is, these are the four corners: see `halves`.
        let has_any = |[[q, r, _], [_, s, p]]: [[u32; 3]; 2]| {
            self.has(p) | self.has(q) | self.has(r) | self.has(s) == 1
        };
        let found = quads.filter(move |&(_, pair)| has_any(pair));
        found.map(|(quad, pair)| DoubtfulQuad::new(self, quad, pair, positions))
    }
}

/// Quads at doubtful vertices, ascending, by groups of bricks.
pub(crate) type DoubtfulQuads = Vec<Vec<DoubtfulQuad>>;

/// A quad at a doubtful vertex.
pub(crate) struct DoubtfulQuad {
    /// Its number among all quads.
    quad: usize,
    /// For each corner of its triangles, the place among the doubtful vertices.
    places: [[Option<u32>; 3]; 2],
    areas: [[f64; 3]; 2],
}

impl DoubtfulQuad {
    fn new(vertices: &VertexSet, quad: usize, triangles: [[u32; 3]; 2], positions: &[[f32; 3]]) -> Self {
        let area = |triangle: [u32; 3]| area_vector(triangle.map(|vertex| positions[vertex as usize]));
        let places = triangles.map(|triangle| triangle.map(|vertex| vertices.place(vertex)));
        Self { quad, places, areas: triangles.map(area) }
    }
}

/// Repairs the normals of doubtful vertices by their triangles: see [`judged`]. All quads at these vertices
/// are given in ascending order, and so are the numbers of those that have been divided anew since.
pub(crate) fn repair_normals(
    mesh: &mut Mesh,
    vertices: &VertexSet,
    quads: &mut [Vec<DoubtfulQuad>],
    anew: impl Iterator<Item = usize>,
    progress: &Progress<'_>,
) -> Result<(), Cancelled> {
    span!("normals");
    if vertices.is_empty() {
        return Ok(());
    }
    let Mesh { positions, normals, triangles, .. } = mesh;
    let mut anew = anew.peekable();
    for group in &mut *quads {
        let mut rest = &mut group[..];
        while let Some(quad) = anew.next_if(|&quad| rest.last().is_some_and(|last| quad <= last.quad)) {
            let from = rest.partition_point(|one| one.quad < quad);
            rest = &mut rest[from..];
            if let Some(one) = rest.first_mut().filter(|one| one.quad == quad) {
                let triangles = [triangles[2 * quad], triangles[2 * quad + 1]];
                *one = DoubtfulQuad::new(vertices, quad, triangles, positions);
            }
        }
    }
    let mut sums = AreaSums::new(vertices);
    for some in &*quads {
        progress.breathe()?;
        for one in some {
            one.places.iter().zip(&one.areas).for_each(|(places, area)| sums.add_at(places, *area));
        }
    }
    for (vertex, &sum) in vertices.iter().zip(sums.get()) {
        let normal = &mut normals[vertex as usize];
        *normal = judged(*normal, sum);
    }
    Ok(())
}

/// The sums of the areas of the triangles at some vertices.
pub(crate) struct AreaSums<'a> {
    vertices: &'a VertexSet,
    /// For each of them, the sum of the area vectors of its triangles.
    sums: Vec<[f64; 3]>,
}

impl<'a> AreaSums<'a> {
    /// Without triangles.
    pub(crate) fn new(vertices: &'a VertexSet) -> Self {
        watch::take(vertices.len() * size_of::<[f64; 3]>());
        Self { vertices, sums: vec![[0.0; 3]; vertices.len()] }
    }

    /// Adds a triangle. The order counts: sums of the same areas in another order are rounded otherwise.
    pub(crate) fn add(&mut self, triangle: &[u32; 3], area: impl FnOnce() -> [f64; 3]) {
        let places = triangle.map(|vertex| self.vertices.place(vertex));
        if places != [None; 3] {
            self.add_at(&places, area());
        }
    }

    /// The same at places among the vertices.
    fn add_at(&mut self, places: &[Option<u32>; 3], area: [f64; 3]) {
        for &place in places.iter().flatten() {
            self.sums[place as usize].iter_mut().zip(area).for_each(|(sum, area)| *sum += area);
        }
    }

    /// The sums, in the order of the vertices.
    pub(crate) fn get(&self) -> &[[f64; 3]] {
        &self.sums
    }
}

/// The normal of a doubtful vertex, from its first one and the sum of the area vectors of its triangles. A
/// vertex without a normal (its gradient vanishes or is NaN) gets the area-weighted mean of its triangles'
/// normals; or up, if they have no area. So does a vertex whose normal is more than 90 degrees off: where two
/// surfaces are closer than a cell, the gradient may be the other surface's.
pub(crate) fn judged(normal: [f32; 3], sum: [f64; 3]) -> [f32; 3] {
    let along: f64 = (0..3).map(|axis| f64::from(normal[axis]) * sum[axis]).sum();
    if normal == [0.0; 3] {
        unit(sum).unwrap_or([0.0, 0.0, 1.0])
    } else if along < 0.0 {
        unit(sum).unwrap_or(normal)
    } else {
        normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_a_set_have_places() {
        let vertices = [0, 5, 63, 64, 130];
        let set = VertexSet::new(7, 131, vertices.into_iter());
        assert_eq!(set.len(), vertices.len());
        assert!(set.iter().eq(vertices.map(|vertex| 7 + vertex)));
        for vertex in 0..140 {
            let place = vertices.iter().position(|&other| other == vertex).map(|place| place as u32);
            assert_eq!(set.place(7 + vertex), place, "{vertex}");
            assert_eq!(set.has(7 + vertex) == 1, place.is_some(), "{vertex}");
        }
        assert_eq!((set.place(6), set.has(0), VertexSet::NONE.place(0)), (None, 0, None));
    }

    /// A quad that is divided anew counts with its new triangles: folded over itself, the vertex is turned
    /// over by one division alone.
    #[test]
    fn quads_that_are_divided_anew_count_as_they_are() {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.9, 0.2, 0.0]];
        let ways = [[[1, 2, 0], [2, 3, 0]], [[1, 2, 3], [1, 3, 0]]];
        let of = |before: [[u32; 3]; 2], now: [[u32; 3]; 2], anew: &[usize]| {
            let mut mesh = Mesh { positions: positions.clone(), ..Mesh::default() };
            mesh.normals = vec![[0.0; 3], [0.0; 3], [0.0; 3], [0.0, 0.0, -1.0]];
            let set = VertexSet::new(0, 4, [3].into_iter());
            let mut quads = vec![set.quads([(0, before)].into_iter(), &positions).collect()];
            mesh.triangles = now.to_vec();
            let mut hook = |_: f32| true;
            let progress = Progress::new(&mut hook, 1.0);
            repair_normals(&mut mesh, &set, &mut quads, anew.iter().copied(), &progress).unwrap();
            mesh.normals[3][2]
        };
        let [folded, flat] = ways.map(|way| of(way, way, &[]));
        assert_ne!(folded, flat);
        assert_eq!(of(ways[0], ways[1], &[0]), flat);
        assert_eq!(of(ways[1], ways[0], &[0]), folded);
    }
}
