//! Quads at vertices on edges of the surface: where they fold, and how they are divided.
//!
//! ```text
//!     r-------q        A vertex s on an edge may be beside its cell, and so beyond the line from p to r: the
//!     |   s  /         triangle p r s is folded over the other one. First the other diagonal is tried. If
//!     |  /  /          both ways fold, s goes back towards its place without edges, as far as it has to.
//!     p----'
//! ```
//!
//! Whether a vertex goes back depends on where all others were put at first. So it depends on the cells
//! around its own alone, and all may go at once.

use rustc_hash::FxHashMap;

use jbt_ir::watch;

use crate::parallel::*;
use crate::span::span;

use super::area::area_vector;
use super::brick::{Bricks, NONE, direction};
use super::crossing::Crossings;
use super::surface::{Around, halves};
use super::vertex::side::SharpVertex;

/// How far a vertex goes back to lay a fold flat, in cells: the first of these that leaves fewest folds. Less
/// than half a cell, so it stays at its edge.
const BACK: [f64; 3] = [1.0 / 8.0, 1.0 / 4.0, 7.0 / 16.0];
/// Quads between two questions whether to go on: some hundred microseconds.
const AT_A_TIME: usize = 1 << 12;
/// A triangle with less area, in parts of its longest side's square, has no side to look to.
const FLAT: f64 = 1.0 / 2048.0;

/// A quad at vertices on edges of the surface.
pub(crate) struct SharpQuad {
    /// Its number among all quads.
    quad: u32,
    /// Counter-clockwise as seen from outside.
    vertices: [u32; 4],
    /// For each of them that is on an edge, its place among those, and the side that the quad shows.
    sides: [Option<(u32, u8)>; 4],
}

/// A corner of a triangle that shows a side of a sharp vertex.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct SideCorner {
    /// Three times the triangle plus the corner.
    pub(crate) corner: u32,
    /// The sharp vertex, by its place among them.
    pub(crate) sharp: usize,
    /// Its side.
    pub(crate) side: usize,
}

/// The quads at sharp vertices, which are ascending, of last cells from `first` on in all directions; in
/// ascending order, too. Bricks that have such quads know their neighbours below. Every now and then it is
/// asked whether to go on.
pub(crate) fn sharp_quads<E: Send>(
    (bricks, crossings): (&Bricks, &Crossings),
    sharp: &[SharpVertex],
    first: [usize; 3],
    go_on: impl Fn() -> Result<(), E> + Sync,
) -> Result<Vec<SharpQuad>, E> {
    span!("quads at edges");
    if sharp.is_empty() {
        return Ok(Vec::new());
    }
    watch::take(crossings.vertex_count() * size_of::<u32>());
    let mut places = vec![0_u32; crossings.vertex_count()];
    (1..).zip(sharp).for_each(|(place, sharp)| places[sharp.vertex as usize] = place);
    let is_there = |brick: usize| {
        let range = [0, 1].map(|n| crossings.vertices[brick + n] as u32);
        let from = sharp.partition_point(|sharp| sharp.vertex < range[0]);
        sharp.get(from).is_some_and(|sharp| sharp.vertex < range[1])
    };
    let has_sharp: Vec<bool> = (0..bricks.len()).map(is_there).collect();
    let is_near = |brick: usize| {
        (0..8_u8).any(|below| {
            let steps = [0, 1, 2].map(|axis| -((below >> axis & 1) as i8));
            let other = bricks.neighbours[brick][direction(steps)];
            if below == 0 { has_sharp[brick] } else { other != NONE && has_sharp[other as usize] }
        })
    };
    let group = bricks.group();
    let rooms = Rooms::new(|| Around::new(bricks));
    let of_group = |around: &mut Room<'_, Around>, index: usize| {
        go_on()?;
        let mut found = Vec::new();
        for brick in index * group..bricks.len().min((index + 1) * group) {
            let [start, end] = [crossings.quads[brick], crossings.quads[brick + 1]];
            if start == end || !is_near(brick) {
                continue;
            }
            let (origin, stride) = (bricks.origin(brick), bricks.stride());
            around.visit(bricks, crossings, brick, |quad, at, corners| {
                let cell = [at % stride, at / stride % stride, at / stride.pow(2)];
                if (0..3).any(|axis| origin[axis] + cell[axis] < first[axis]) {
                    return;
                }
                let sides = corners.map(|(vertex, edge)| {
                    let place = places[vertex as usize].checked_sub(1)?;
                    Some((place, sharp[place as usize].side(edge) as u8))
                });
                if sides != [None; 4] {
                    let (quad, vertices) = ((start + quad) as u32, corners.map(|(vertex, _)| vertex));
                    found.push(SharpQuad { quad, vertices, sides });
                }
            });
        }
        Ok(found)
    };
    let groups = 0..bricks.len().div_ceil(group);
    let found: Vec<Result<Vec<SharpQuad>, E>> =
        scatter(|_| in_pieces(groups.into_par_iter()).map_init(|| rooms.take(), of_group).collect());
    let mut quads = Vec::new();
    for found in found {
        quads.extend(found?);
    }
    Ok(quads)
}

impl SharpQuad {
    /// Its number among all quads.
    pub(crate) fn number(&self) -> usize {
        self.quad as usize
    }

    /// Its halves: along the edge of the surface, if two opposite corners are on it, else along the shorter
    /// diagonal; but along the other one if fewer of them are folded then. Also the number of folded ones.
    fn least_folded(
        &self,
        sharp: &[SharpVertex],
        at: impl Fn(u32) -> [f32; 3] + Copy,
    ) -> ([[u32; 3]; 2], usize) {
        let [p, q, r, s] = self.vertices;
        let ways = [[[q, r, p], [p, r, s]], [[p, q, s], [s, q, r]]];
        let usual = match self.sides.map(|side| side.is_some()) {
            [true, false, true, false] => ways[0],
            [false, true, false, true] => ways[1],
            _ => halves(self.vertices, at),
        };
        let is_folded = |triangle: &&[u32; 3]| is_folded(triangle.map(at), self.outward(**triangle, sharp));
        let folded = |halves: &[[u32; 3]; 2]| halves.iter().filter(is_folded).count();
        let count = folded(&usual);
        if count == 0 {
            return (usual, 0);
        }
        let first = usual.iter().all(|triangle| triangle.contains(&p) && triangle.contains(&r));
        let other = ways[usize::from(first)];
        let count_of_other = folded(&other);
        if count_of_other < count { (other, count_of_other) } else { (usual, count) }
    }

    /// The outside of one of its triangles. A triangle may lie in any side of an edge that it has a vertex
    /// on, so all sides count, but not for a triangle without one.
    fn outward(&self, triangle: [u32; 3], sharp: &[SharpVertex]) -> [f64; 3] {
        let (mut outward, mut has_sharp) = ([0.0; 3], false);
        let mut add = |normal: [f32; 3]| {
            outward.iter_mut().zip(normal).for_each(|(sum, c)| *sum += f64::from(c));
        };
        let both = || self.sides.into_iter().zip(self.vertices);
        for (place, _) in both().filter(|(_, vertex)| triangle.contains(vertex)).filter_map(|(side, _)| side)
        {
            has_sharp = true;
            sharp[place as usize].sides.iter().for_each(|side| add(side.normal));
        }
        if !has_sharp {
            for (place, side) in self.sides.into_iter().flatten() {
                add(sharp[place as usize].sides[usize::from(side)].normal);
            }
        }
        outward
    }
}

/// How far a sharp vertex was put from where it would be without edges.
fn way(sharp: &SharpVertex) -> f64 {
    let [from, to] = [sharp.placed, sharp.cut.position];
    (0..3).map(|axis| (f64::from(to[axis]) - f64::from(from[axis])).powi(2)).sum::<f64>().sqrt()
}

/// Whether a triangle looks inwards.
fn is_folded(corners: [[f32; 3]; 3], outward: [f64; 3]) -> bool {
    let area = area_vector(corners);
    let along: f64 = (0..3).map(|axis| area[axis] * outward[axis]).sum();
    if along >= 0.0 {
        return false;
    }
    let square = |a: usize, b: usize| {
        let way = |axis: usize| f64::from(corners[a][axis]) - f64::from(corners[b][axis]);
        (0..3).map(|axis| way(axis).powi(2)).sum::<f64>()
    };
    let longest = square(0, 1).max(square(1, 2)).max(square(2, 0));
    let length = outward.iter().map(|c| c * c).sum::<f64>().sqrt();
    along < -FLAT * longest * length
}

/// Where sharp vertices go back to, so that fewer triangles are folded: their places among the sharp ones,
/// ascending, and positions. `at` is where each vertex was put at first. Every now and then it is asked
/// whether to go on.
pub(crate) fn unfolded<E: Send>(
    quads: &[SharpQuad],
    sharp: &[SharpVertex],
    at: impl Fn(u32) -> [f32; 3] + Copy + Sync,
    go_on: impl Fn() -> Result<(), E> + Sync,
) -> Result<Vec<(u32, [f32; 3])>, E> {
    let is_folded = |quad: &&SharpQuad| quad.least_folded(sharp, at).1 > 0;
    let of_some = |some: &[SharpQuad]| {
        go_on()?;
        let folded = some.iter().filter(is_folded).flat_map(|quad| quad.sides).flatten();
        Ok(folded.map(|(place, _)| place).collect())
    };
    let folded: Vec<Result<Vec<u32>, E>> = scatter(|_| quads.par_chunks(AT_A_TIME).map(of_some).collect());
    let mut around: FxHashMap<u32, Vec<&SharpQuad>> = FxHashMap::default();
    for folded in folded {
        around.extend(folded?.into_iter().map(|place| (place, Vec::new())));
    }
    if around.is_empty() {
        return Ok(Vec::new());
    }
    for some in quads.chunks(AT_A_TIME) {
        go_on()?;
        for quad in some {
            for (place, _) in quad.sides.into_iter().flatten() {
                if let Some(of_vertex) = around.get_mut(&place) {
                    of_vertex.push(quad);
                }
            }
        }
    }
    let mut moved = Vec::new();
    for (place, quads) in around {
        go_on()?;
        moved.extend(less_folded(&sharp[place as usize], &quads, sharp, at).map(|to| (place, to)));
    }
    moved.sort_unstable_by_key(|&(place, _)| place);
    Ok(moved)
}

/// The first place on the way back of a vertex at which fewest of its triangles are folded; `None` if that is
/// where it is.
fn less_folded(
    one: &SharpVertex,
    quads: &[&SharpQuad],
    sharp: &[SharpVertex],
    at: impl Fn(u32) -> [f32; 3] + Copy,
) -> Option<[f32; 3]> {
    let folded = |position: [f32; 3]| {
        let at = |vertex: u32| if vertex == one.vertex { position } else { at(vertex) };
        quads.iter().map(|quad| quad.least_folded(sharp, at).1).sum::<usize>()
    };
    let (mut least, mut best) = (folded(one.placed), None);
    for step in BACK {
        let part = step * f64::from(one.size) / way(one);
        // Not beyond the place without edges; nor if that is where it is, and the part is not a number.
        let part = if part < 1.0 { part } else { 1.0 };
        let position = std::array::from_fn(|axis| {
            let [from, to] = [one.placed, one.cut.position].map(|place| f64::from(place[axis]));
            (from + part * (to - from)) as f32
        });
        let count = folded(position);
        if count < least {
            (least, best) = (count, Some(position));
        }
        if part == 1.0 {
            break;
        }
    }
    best
}

/// Divides the quads at sharp vertices so that few triangles are folded, and tells which corners show which
/// sides. Every now and then it is asked whether to go on.
pub(crate) fn crease<E>(
    quads: &[SharpQuad],
    sharp: &[SharpVertex],
    positions: &[[f32; 3]],
    triangles: &mut [[u32; 3]],
    go_on: impl Fn() -> Result<(), E>,
) -> Result<Vec<SideCorner>, E> {
    let mut corners = Vec::new();
    for (n, one) in quads.iter().enumerate() {
        if n % AT_A_TIME == 0 {
            go_on()?;
        }
        let first = 2 * one.quad as usize;
        let pair = &mut triangles[first..first + 2];
        pair.copy_from_slice(&one.least_folded(sharp, |vertex| positions[vertex as usize]).0);
        for (n, triangle) in pair.iter().enumerate() {
            for (corner, vertex) in triangle.iter().enumerate() {
                let of = one.vertices.iter().position(|other| other == vertex);
                if let Some((sharp, side)) = of.and_then(|of| one.sides[of]) {
                    let corner = (3 * (first + n) + corner) as u32;
                    corners.push(SideCorner { corner, sharp: sharp as usize, side: usize::from(side) });
                }
            }
        }
    }
    Ok(corners)
}
