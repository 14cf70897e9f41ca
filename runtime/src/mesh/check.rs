//! Whether a mesh is closed, and whether it is a manifold.

use rayon::prelude::*;
use thiserror::Error;

/// What keeps a mesh from being a closed manifold.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Defect {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names a vertex that does not exist")]
    Index {
        /// Its index.
        triangle: usize,
    },
    /// An edge does not have exactly one triangle in each direction.
    #[error("the edge {from} -> {to} has {forward} triangles in this direction and {backward} in the other")]
    Edge {
        /// One end.
        from: u32,
        /// The other end.
        to: u32,
        /// Triangles that go around with the edge.
        forward: usize,
        /// Triangles that go around against it.
        backward: usize,
    },
    /// The triangles at a vertex do not form one fan around it.
    #[error("the {triangles} triangles at vertex {vertex} form more than one fan")]
    Fans {
        /// The vertex.
        vertex: u32,
        /// How many triangles it has.
        triangles: usize,
    },
}

/// The edges that leave each vertex, directed as their triangles go around.
struct Edges {
    /// Where those of each vertex begin in `ends`, and where the last ones end.
    starts: Vec<usize>,
    /// For each edge its end, ascending within a vertex, and the third corner of its triangle.
    ends: Vec<(u32, u32)>,
}

impl Edges {
    /// Sorts the edges by where they begin, by counting. Fails with the first triangle that names a missing vertex.
    fn new(vertices: usize, triangles: &[[u32; 3]]) -> Result<Self, usize> {
        let mut starts = vec![0_usize; vertices + 1];
        for (index, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                let count = starts.get_mut(vertex as usize + 1).ok_or(index)?;
                *count += 1;
            }
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut ends = vec![(0, 0); 3 * triangles.len()];
        for &[p, q, r] in triangles {
            for (from, end) in [(p, (q, r)), (q, (r, p)), (r, (p, q))] {
                let place = &mut next[from as usize];
                ends[*place] = end;
                *place += 1;
            }
        }
        for vertex in 0..vertices {
            ends[starts[vertex]..starts[vertex + 1]].sort_unstable();
        }
        Ok(Edges { starts, ends })
    }

    fn of(&self, vertex: u32) -> &[(u32, u32)] {
        &self.ends[self.starts[vertex as usize]..self.starts[vertex as usize + 1]]
    }

    fn vertices(&self) -> u32 {
        // A vertex that has an edge is named by a u32; those beyond have none and need no check.
        u32::try_from(self.starts.len() - 1).unwrap_or(u32::MAX)
    }

    /// How many triangles go around with the edge.
    fn count(&self, from: u32, to: u32) -> usize {
        let edges = self.of(from);
        edges.partition_point(|&(end, _)| end <= to) - edges.partition_point(|&(end, _)| end < to)
    }

    /// An edge of this vertex that does not have one triangle in each direction.
    fn broken_edge(&self, from: u32) -> Option<Defect> {
        self.of(from).iter().find_map(|&(to, _)| {
            let (forward, backward) = (self.count(from, to), self.count(to, from));
            let whole = from != to && forward == 1 && backward == 1;
            (!whole).then_some(Defect::Edge { from, to, forward, backward })
        })
    }

    /// Whether the triangles of a vertex without broken edges form more than one fan.
    fn broken_fan(&self, vertex: u32) -> Option<Defect> {
        let edges = self.of(vertex);
        let &(first, mut at) = edges.first()?;
        let mut triangles = 1;
        // Every edge out of this vertex has a triangle on both sides, so the walk comes back to where it began.
        while at != first {
            let place = edges.partition_point(|&(end, _)| end < at);
            at = edges[place].1;
            triangles += 1;
        }
        (triangles != edges.len()).then_some(Defect::Fans { vertex, triangles: edges.len() })
    }
}

/// Whether every edge of these triangles has exactly two of them, in opposite directions. `vertices` is how many vertices
/// the triangles may name. No triangles are closed; a triangle with an index out of range or a repeated vertex is not.
///
/// Linear in triangles and vertices, as long as no vertex has very many triangles.
pub fn is_closed(vertices: usize, triangles: &[[u32; 3]]) -> bool {
    // The edges are sorted by their smaller ends, by counting; each is its larger end and a bit for the direction.
    let edges = || triangles.iter().flat_map(|&[p, q, r]| [(p, q), (q, r), (r, p)]);
    let mut starts = vec![0_usize; vertices + 1];
    for (from, to) in edges() {
        if from.max(to) as usize >= vertices {
            return false;
        }
        starts[from.min(to) as usize + 1] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut ends = vec![0_u64; 3 * triangles.len()];
    for (from, to) in edges() {
        let place = &mut next[from.min(to) as usize];
        ends[*place] = u64::from(from.max(to)) << 1 | u64::from(from > to);
        *place += 1;
    }
    // Sorted, the two directions of each edge stand side by side, and nothing else does.
    starts
        .par_windows(2)
        .with_min_len(1024)
        .map_init(Vec::new, |sorted: &mut Vec<u64>, range| {
            sorted.clear();
            sorted.extend_from_slice(&ends[range[0]..range[1]]);
            sorted.sort_unstable();
            let (pairs, rest) = sorted.as_chunks::<2>();
            rest.is_empty()
                && pairs.iter().all(|&[forward, backward]| forward & 1 == 0 && backward == forward + 1)
        })
        .all(|closed| closed)
}

/// Checks that triangles form a closed manifold: they are closed as in [`is_closed`], and the triangles at each vertex form
/// one fan. A vertex without triangles is no defect.
///
/// # Errors
/// The first defect, in the order of the vertices; edges before fans.
pub fn check_manifold(vertices: usize, triangles: &[[u32; 3]]) -> Result<(), Defect> {
    let edges = Edges::new(vertices, triangles).map_err(|triangle| Defect::Index { triangle })?;
    let all = 0..edges.vertices();
    let defect = all.clone().into_par_iter().find_map_first(|vertex| edges.broken_edge(vertex));
    let defect = defect.or_else(|| all.into_par_iter().find_map_first(|vertex| edges.broken_fan(vertex)));
    defect.map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_is_closed() {
        assert_eq!(check_manifold(4, &TETRAHEDRON), Ok(()));
        assert!(is_closed(4, &TETRAHEDRON));
        assert!(is_closed(0, &[]));
        assert!(is_closed(9, &TETRAHEDRON));
    }

    #[test]
    fn defects_are_found() {
        assert!(!is_closed(4, &TETRAHEDRON[1..]));
        let mut turned = TETRAHEDRON;
        turned[0].reverse();
        assert_eq!(check_manifold(4, &turned), Err(Defect::Edge { from: 0, to: 1, forward: 2, backward: 0 }));
        assert_eq!(check_manifold(3, &TETRAHEDRON), Err(Defect::Index { triangle: 1 }));
        assert!(!is_closed(3, &TETRAHEDRON));
        assert!(!is_closed(2, &[[0, 0, 1], [0, 1, 0]]));
        let twice = [TETRAHEDRON, TETRAHEDRON].concat();
        assert!(!is_closed(4, &twice));
    }

    #[test]
    fn two_tetrahedra_at_one_vertex_are_closed_but_no_manifold() {
        let other = TETRAHEDRON.map(|triangle| triangle.map(|v| if v == 0 { 0 } else { v + 3 }));
        let both = [TETRAHEDRON, other].concat();
        assert!(is_closed(7, &both));
        assert_eq!(check_manifold(7, &both), Err(Defect::Fans { vertex: 0, triangles: 6 }));
    }
}
