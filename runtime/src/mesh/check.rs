//! Whether a mesh is closed, and whether it is a manifold.

use std::convert::Infallible;
use std::ops::Range;

use jbt_ir::watch;

use crate::parallel::*;
use crate::span::span;
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
struct DirectedEdges {
    /// Where the edges of each vertex begin in `ends`, and the end.
    starts: Vec<usize>,
    /// For each edge its end vertex, ascending within a start vertex, and the third corner of its triangle.
    ends: Vec<(u32, u32)>,
}

impl DirectedEdges {
    /// Sorts the edges by start vertex, by counting. Fails with the first triangle that names a missing
    /// vertex.
    fn new(vertices: usize, triangles: &[[u32; 3]]) -> Result<Self, usize> {
        watch::take(2 * (vertices + 1) * size_of::<usize>() + 3 * triangles.len() * size_of::<(u32, u32)>());
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
        Ok(DirectedEdges { starts, ends })
    }

    fn of(&self, vertex: u32) -> &[(u32, u32)] {
        &self.ends[self.starts[vertex as usize]..self.starts[vertex as usize + 1]]
    }

    fn vertices(&self) -> u32 {
        // A vertex with an edge is named by a u32; vertices beyond have no edges and need no check.
        u32::try_from(self.starts.len() - 1).unwrap_or(u32::MAX)
    }

    /// The number of triangles that go around with the edge.
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
        // Every edge out of this vertex has a triangle on both sides, so the walk returns to its start.
        while at != first {
            let place = edges.partition_point(|&(end, _)| end < at);
            at = edges[place].1;
            triangles += 1;
        }
        (triangles != edges.len()).then_some(Defect::Fans { vertex, triangles: edges.len() })
    }
}

/// Whether every edge of these triangles has exactly two triangles, in opposite directions. The triangles may
/// name `vertices` vertices. An empty list is closed; a triangle with an index out of range or a repeated
/// vertex is not.
///
/// Linear in triangles and vertices, as long as few vertices have very many triangles.
///
/// Each thread looks at the edges whose lower vertex is in its part of the vertices.
pub fn is_closed(vertices: usize, triangles: &[[u32; 3]]) -> bool {
    let Ok(closed) = are_closed(vertices, triangles, || Ok::<_, Infallible>(()));
    closed
}

/// As [`is_closed`]. Every now and then it is asked whether to go on.
pub(crate) fn are_closed<E: Send>(
    vertices: usize,
    triangles: &[[u32; 3]],
    go_on: impl Fn() -> Result<(), E> + Sync,
) -> Result<bool, E> {
    span!("closed");
    let part = vertices.div_ceil(thread_count().clamp(1, MAX_SPLIT)).max(1);
    let parts: Vec<Range<usize>> =
        (0..vertices.max(1)).step_by(part).map(|first| first..vertices.min(first + part)).collect();
    let paired = |own| are_paired(own, vertices, triangles, &go_on);
    let paired: Result<Vec<bool>, E> = scatter(|_| parts.into_par_iter().map(paired).collect());
    Ok(paired?.into_iter().all(|paired| paired))
}

/// Threads that check a mesh together: each reads all triangles.
const MAX_SPLIT: usize = 16;
/// Triangles that are read between two questions: less than a millisecond of work.
const ASK_AFTER: usize = 1 << 15;

/// Whether the edges whose lower vertex is one of these have two triangles each, in opposite directions, and
/// no triangle names a missing vertex.
fn are_paired<E>(
    own: Range<usize>,
    vertices: usize,
    triangles: &[[u32; 3]],
    go_on: impl Fn() -> Result<(), E>,
) -> Result<bool, E> {
    watch::take(own.len() * size_of::<([u32; SLOTS], [u8; 2])>());
    let mut slots = vec![[NO_END; SLOTS]; own.len()];
    // For each vertex and direction, the slots whose edges have been seen in that direction, a bit each.
    let mut met = vec![[0_u8; 2]; own.len()];
    let mut rest = Vec::new();
    for (index, &[p, q, r]) in triangles.iter().enumerate() {
        if index % ASK_AFTER == 0 {
            go_on()?;
        }
        let last = p.max(q).max(r);
        if last as usize >= vertices || last == NO_END || p == q || q == r || r == p {
            return Ok(false);
        }
        for (from, to) in [(p, q), (q, r), (r, p)] {
            let (low, high) = ((from.min(to) as usize).wrapping_sub(own.start), from.max(to));
            if low >= own.len() {
                continue;
            }
            let Some(slot) = find(&mut slots[low], high) else {
                rest.push((low, high, from > to));
                continue;
            };
            let met = &mut met[low][usize::from(from > to)];
            if *met >> slot & 1 == 1 {
                return Ok(false);
            }
            *met |= 1 << slot;
        }
    }
    // Sorted, the two directions of each edge are neighbours.
    rest.sort_unstable();
    let (pairs, odd) = rest.as_chunks::<2>();
    let is_pair = |&[(a, b, up), (c, d, down)]: &[(usize, u32, bool); 2]| (a, b, up) == (c, d, !down) && !up;
    let paired = met.iter().all(|[up, down]| up == down)
        && odd.is_empty()
        && pairs.iter().all(is_pair)
        && rest.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).all(|edge| edge.len() == 2);
    Ok(paired)
}

/// The edges to larger vertex numbers that are kept with each vertex. Most vertices have three, few have more
/// than eight.
const SLOTS: usize = 8;
/// No edge. A vertex with this number counts as missing, because 32 bits cannot number the next one.
const NO_END: u32 = u32::MAX;

/// The slot of an edge's end, which is entered if it is new; `None` if all slots hold others.
#[inline(always)]
fn find(ends: &mut [u32; SLOTS], end: u32) -> Option<usize> {
    // Multiplication by 2^32 / the golden ratio scatters neighbouring numbers, so the first slot of the
    // search is rarely taken.
    let first = (end.wrapping_mul(0x9e37_79b9) >> 29) as usize;
    for step in 0..SLOTS {
        let slot = (first + step) % SLOTS;
        if ends[slot] == end {
            return Some(slot);
        }
        if ends[slot] == NO_END {
            ends[slot] = end;
            return Some(slot);
        }
    }
    None
}

/// Checks that triangles form a closed manifold: they are closed as in [`is_closed`], and the triangles at
/// each vertex form one fan. A vertex without triangles is no defect.
///
/// # Errors
/// The first defect, in the order of the vertices; edges before fans.
pub fn check_manifold(vertices: usize, triangles: &[[u32; 3]]) -> Result<(), Defect> {
    let edges = DirectedEdges::new(vertices, triangles).map_err(|triangle| Defect::Index { triangle })?;
    let all = 0..edges.vertices();
    let defect = scatter(|_| {
        let defect = all.clone().into_par_iter().find_map_first(|vertex| edges.broken_edge(vertex));
        defect.or_else(|| all.into_par_iter().find_map_first(|vertex| edges.broken_fan(vertex)))
    });
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

    /// Two cones on a ring of vertices, more than there are slots: the first vertex is a tip, with edges to
    /// all others.
    fn cones(ring: u32) -> Vec<[u32; 3]> {
        let at = |n: u32| 1 + n % ring;
        (0..ring).flat_map(|n| [[0, at(n), at(n + 1)], [ring + 1, at(n + 1), at(n)]]).collect()
    }

    #[test]
    fn vertices_with_many_triangles_are_checked() {
        for ring in 3..40 {
            let cones = cones(ring);
            let vertices = ring as usize + 2;
            assert!(is_closed(vertices, &cones));
            assert_eq!(check_manifold(vertices, &cones), Ok(()));
            for triangle in 0..cones.len() {
                let mut other = cones.clone();
                other[triangle].reverse();
                assert!(!is_closed(vertices, &other));
                other.remove(triangle);
                assert!(!is_closed(vertices, &other));
                other.push(other[0]);
                assert!(!is_closed(vertices, &other));
            }
            assert!(!is_closed(vertices, &[&cones[..], &cones].concat()));
        }
    }

    fn edges_of(triangles: &[[u32; 3]]) -> impl Iterator<Item = [u32; 2]> {
        triangles.iter().flat_map(|&[p, q, r]| [[p, q], [q, r], [r, p]])
    }

    /// Compared with a count of every edge.
    #[test]
    fn random_triangles_are_closed_if_their_edges_pair() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut closed = 0;
        for _ in 0..20_000 {
            let mut triangles = TETRAHEDRON.to_vec();
            for _ in 0..random.usize(0..3) {
                let (a, b) = (random.usize(0..4), random.usize(0..3));
                triangles[a][b] = random.u32(0..4);
            }
            if random.bool() {
                triangles
                    .extend_from_slice(&TETRAHEDRON.map(|triangle| triangle.map(|v| v + random.u32(3..5))));
            }
            let count = |edge: [u32; 2]| edges_of(&triangles).filter(|&other| other == edge).count();
            let expected = edges_of(&triangles)
                .all(|[from, to]| from != to && count([from, to]) == 1 && count([to, from]) == 1);
            assert_eq!(is_closed(9, &triangles), expected, "{triangles:?}");
            closed += usize::from(expected);
        }
        assert!((100..19_900).contains(&closed), "{closed}");
    }

    #[test]
    fn two_tetrahedra_at_one_vertex_are_closed_but_no_manifold() {
        let other = TETRAHEDRON.map(|triangle| triangle.map(|v| if v == 0 { 0 } else { v + 3 }));
        let both = [TETRAHEDRON, other].concat();
        assert!(is_closed(7, &both));
        assert_eq!(check_manifold(7, &both), Err(Defect::Fans { vertex: 0, triangles: 6 }));
    }
}
