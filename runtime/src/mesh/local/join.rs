//! Triangles of some bricks, and the normals that triangles decide.

use std::convert::Infallible;

use rustc_hash::FxHashSet;

use super::bricks::{BrickCorner, BrickMesh, BrickPlace, KeptBrick, linked, octet};
use crate::mesh::area::area_vector;
use crate::mesh::brick::{Bricks, place as number_place};
use crate::mesh::crossing::Crossings;
use crate::mesh::doubtful::{AreaSums, VertexSet, judged};
use crate::mesh::fold;
use crate::mesh::report::Sides;
use crate::mesh::surface;
use crate::mesh::vertex::side::SharpVertex;

/// Bricks that get triangles, and those around them whose vertices these have.
pub(super) struct Join {
    /// All of them in Morton order, as places from the lattice's first brick and from its anchor.
    pub(super) bricks: Vec<([u32; 3], BrickPlace)>,
    /// Those that get triangles.
    pub(super) own: FxHashSet<BrickPlace>,
}

/// Old bricks may have gone: nobody stops what puts new ones in their place.
fn always() -> Result<(), Infallible> {
    Ok(())
}

/// Bricks that are kept apart, as the parts of one mesh.
struct JoinedBricks {
    bricks: Bricks,
    crossings: Crossings,
    /// Its vertices in the buffers.
    names: Vec<u32>,
    /// Its sharp vertices, ascending.
    sharp: Vec<SharpVertex>,
    /// For each of them, its brick, and its place among those of the brick.
    homes: Vec<(BrickPlace, usize)>,
}

impl KeptBrick {
    /// The bricks above, by their number in [`octet`], that may have triangles of doubtful vertices: a
    /// triangle is one of the last cell that it touches, at most one further along each axis.
    fn reached_above(&self, edge: usize) -> u8 {
        let mut reached = 1;
        for (vertex, _) in &self.doubtful {
            // A cell without a vertex has the number of the next vertex.
            let cell = self.cells.partition_point(|cell| cell.vertex <= *vertex) - 1;
            let place = number_place(self.cells[cell].number);
            let last = (0..3).fold(0_u8, |axes, axis| axes | u8::from(place[axis] + 1 == edge) << axis);
            reached |= (0..8).filter(|axes| axes & !last == 0).fold(0, |bits, axes| bits | 1 << axes);
        }
        reached
    }
}

impl BrickMesh {
    /// Some bricks as the parts of one mesh.
    fn gathered(&self, join: &Join) -> JoinedBricks {
        let mut crossings = Crossings {
            cells: Vec::new(),
            starts: vec![0],
            vertices: vec![0],
            quads: vec![0],
            flipped_faces: 0,
            cut: Sides::default(),
            is_open: false,
        };
        let (mut names, mut quads) = (Vec::new(), 0);
        let (mut sharp, mut homes) = (Vec::new(), Vec::new());
        for (_, place) in &join.bricks {
            let brick = &self.bricks[place];
            let first = names.len() as u32;
            sharp.extend(
                brick.sharp.iter().map(|one| SharpVertex { vertex: first + one.vertex, ..one.clone() }),
            );
            homes.extend((0..brick.sharp.len()).map(|number| (*place, number)));
            crossings.cells.extend_from_slice(&brick.cells);
            crossings.starts.push(crossings.cells.len());
            names.extend(brick.vertices.range().map(|vertex| vertex as u32));
            crossings.vertices.push(names.len());
            quads += if join.own.contains(place) { brick.quads } else { 0 };
            crossings.quads.push(quads);
        }
        let places = join.bricks.iter().map(|&(place, _)| place).collect();
        let bricks = linked(self.edge, self.lattice.axes(), places);
        JoinedBricks { bricks, crossings, names, sharp, homes }
    }

    /// Where sharp vertices of some bricks belong: where they were put, or back from there, if triangles are
    /// folded. `join` has the quads around them. The vertices are indices of the buffers.
    pub(super) fn sharp_places(
        &self,
        targets: &FxHashSet<BrickPlace>,
        join: &Join,
    ) -> Vec<(BrickPlace, usize, [f32; 3])> {
        let joined = self.gathered(join);
        let JoinedBricks { bricks, crossings, names, sharp, homes } = &joined;
        let mut positions: Vec<[f32; 3]> =
            names.iter().map(|&name| self.buffers.positions[name as usize]).collect();
        sharp.iter().for_each(|one| positions[one.vertex as usize] = one.placed);
        let Ok(quads) = fold::sharp_quads((bricks, crossings), sharp, [0; 3], always);
        let Ok(moved) = fold::unfolded(&quads, sharp, |vertex| positions[vertex as usize], always);
        for (place, position) in moved {
            positions[sharp[place as usize].vertex as usize] = position;
        }
        let all = sharp.iter().zip(homes).filter(|(_, (home, _))| targets.contains(home));
        let at = |vertex: u32| (names[vertex as usize] as usize, positions[vertex as usize]);
        all.map(|(one, &(home, _))| (home, at(one.vertex).0, at(one.vertex).1)).collect()
    }

    /// The triangles of some bricks, as indices of the buffers, and the corners that show sides of vertices.
    pub(super) fn triangles(&self, join: &Join) -> Vec<(BrickPlace, Vec<[u32; 3]>, Vec<BrickCorner>)> {
        if join.own.is_empty() {
            return Vec::new();
        }
        let JoinedBricks { bricks, crossings, names, sharp, homes } = self.gathered(join);
        let positions: Vec<[f32; 3]> =
            names.iter().map(|&name| self.buffers.positions[name as usize]).collect();
        let marked = &VertexSet::NONE;
        let room = surface::room_of_few(&crossings);
        let of = (&bricks, &crossings);
        let Ok((mut triangles, _)) = surface::triangles(of, room, (&positions, marked), always);
        let Ok(quads) = fold::sharp_quads((&bricks, &crossings), &sharp, [0; 3], always);
        let Ok(corners) = fold::crease(&quads, &sharp, &positions, &mut triangles, always);
        let of_brick = |(brick, &(_, place)): (usize, &([u32; 3], BrickPlace))| {
            let mine = &triangles[2 * crossings.quads[brick]..2 * crossings.quads[brick + 1]];
            let first = 6 * crossings.quads[brick] as u32;
            let end = 6 * crossings.quads[brick + 1] as u32;
            let shown = corners.iter().filter(|one| (first..end).contains(&one.corner));
            let shown = shown.map(|one| BrickCorner {
                corner: one.corner - first,
                of: homes[one.sharp],
                side: one.side,
            });
            let mine = mine.iter().map(|triangle| triangle.map(|vertex| names[vertex as usize])).collect();
            (place, mine, shown.collect())
        };
        let own = join.bricks.iter().enumerate().filter(|(_, (_, place))| join.own.contains(place));
        own.map(of_brick).collect()
    }

    /// Judges the doubtful normals of a brick by its triangles and those of the bricks above. Returns whether
    /// a normal has changed.
    pub(super) fn judge_normals(&mut self, place: BrickPlace) -> bool {
        let Some(brick) = self.bricks.get(&place).filter(|brick| !brick.doubtful.is_empty()) else {
            return false;
        };
        let vertices = brick.vertices.range();
        let doubtful = brick.doubtful.iter().map(|&(vertex, _)| vertex);
        let doubtful = VertexSet::new(vertices.start as u32, vertices.len(), doubtful);
        let mut sums = AreaSums::new(&doubtful);
        let reached = brick.reached_above(self.edge);
        let above = octet(place, 1)
            .enumerate()
            .filter(|(axes, place)| reached >> axes & 1 == 1 && self.bricks.contains_key(place));
        let above: Vec<BrickPlace> = above.map(|(_, place)| place).collect();
        for (_, place) in self.in_order(above.into_iter()) {
            for triangle in &self.buffers.triangles[self.bricks[&place].triangles.range()] {
                let corner = |vertex: u32| self.buffers.positions[vertex as usize];
                sums.add(triangle, || area_vector(triangle.map(corner)));
            }
        }
        let mut changed = false;
        for (&(vertex, first), sum) in brick.doubtful.iter().zip(sums.get()) {
            let normal = &mut self.buffers.normals[vertices.start + vertex as usize];
            let now = judged(first, *sum);
            changed |= now.map(f32::to_bits) != normal.map(f32::to_bits);
            *normal = now;
        }
        changed
    }
}
