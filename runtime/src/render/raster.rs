//! Where the rays of a picture's samples meet a mesh first, by filling triangles instead of following rays.
//!
//! ```text
//! vertices in the axes of the camera ── triangles in bins, one for each tile          (MeshRaster)
//!
//! a tile:  for each triangle of its bin, in order            edge 1 >= 0 ┐
//!            for each sample in the box around it            edge 2 >= 0 ├ and nearer than what is there
//!              three edges and the nearness: a x + b y + c   edge 3 >= 0 ┘          (MeshTile)
//! ```
//!
//! Through an eye at 0, a sample looks along s = (x, y, 1). The plane of the eye and the edge from a to b has
//! the normal a × b, so s is on one side of it where (a × b) · s >= 0. Without perspective the same holds of
//! the points (x, y, 1). The nearness, 1 over the depth or its negative, is linear too. So no triangle is
//! clipped where it passes the eye (Olano and Greer, Triangle scan conversion using 2D homogeneous
//! coordinates, 1997).
//!
//! Only triangles that show the eye their outer side are filled: a ray that begins outside of a closed
//! surface meets one of them first. Two triangles on an edge have exactly opposite numbers there, and both
//! own the edge: no ray slips through. Of equally near triangles the first one counts. So answers have the
//! same bits for every instruction set and any number of threads.

use super::area::TileArea;
use super::boxes::{EightLanes, WIDE};
use super::camera::Camera;
use super::vector::{Vector, cross, dot, length, scale, sub};
use crate::mesh::Mesh;
use crate::parallel::*;

/// Triangles that one thread puts into bins at a time.
const SOME: usize = 1 << 14;
/// The depth in front of the eye below which nothing is projected, as a part of the largest coordinate.
const NEAREST: f64 = 1e-9;
/// By how much edges may be off by rounding, in samples.
const ROUNDED: f64 = 1e-2;
/// The triangle of a sample that meets none.
const NONE: u32 = u32::MAX;

/// Where a ray meets a mesh first.
#[derive(Clone, Copy)]
pub struct MeshMeeting {
    /// The distance from the origin of the camera's ray.
    pub distance: f64,
    /// The number of the triangle.
    pub triangle: u32,
}

/// A mesh in front of a camera, sorted into the tiles of some rows of a picture.
pub struct MeshRaster<'a> {
    camera: &'a Camera,
    size: [u32; 2],
    triangles: &'a [[u32; 3]],
    /// Right, up and away, divided by `unit`.
    vertices: Vec<Vector>,
    unit: f64,
    /// Where vertices are in the picture, as parts of its width and height; NaN behind the eye.
    places: Vec<[f64; 2]>,
    /// Where the bin of each tile begins in `members`.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// The first triangles at the samples of a tile, row by row.
pub struct MeshTile {
    area: TileArea,
    parts: u32,
    stride: usize,
    /// 1 over the depth; without perspective its negative.
    near: Vec<f32>,
    triangle: Vec<u32>,
}

/// a, b and c of a x + b y + c, for the three edges of a triangle and for its nearness.
type EdgePlanes = [[f32; 3]; 4];

/// A triangle to fill.
struct Patch {
    number: u32,
    planes: EdgePlanes,
    /// Samples: the first ones, and those behind the last ones.
    columns: [usize; 2],
    rows: [usize; 2],
}

impl<'a> MeshRaster<'a> {
    /// Sorts the triangles of a mesh into tiles, which are [`TileArea::of_rows`] without parts.
    pub fn new(camera: &'a Camera, size: [u32; 2], mesh: &'a Mesh, rows: [u32; 2]) -> Self {
        let Mesh { positions, triangles, .. } = mesh;
        let seen = |position: &[f32; 3]| {
            let from = sub(position.map(f64::from), camera.eye);
            [dot(from, camera.right), dot(from, camera.up), -dot(from, camera.back)]
        };
        let vertices: Vec<Vector> = scatter(|_| positions.par_iter().with_min_len(SOME).map(seen).collect());
        let largest = vertices.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let vertices: Vec<Vector> = vertices.into_iter().map(|vertex| scale(vertex, 1.0 / unit)).collect();
        let places = vertices.iter().map(|&vertex| place(camera, unit, vertex)).collect();
        let mut raster =
            Self { camera, size, triangles, vertices, unit, places, starts: Vec::new(), members: Vec::new() };
        raster.sort(rows);
        raster
    }

    /// Fills the bins of the tiles of some rows; a bin has those of its triangles that are seen from outside,
    /// in order.
    fn sort(&mut self, [first, end]: [u32; 2]) {
        let side = f64::from(TileArea::side(1));
        let tiles = [f64::from(self.size[0]), f64::from(end - first)].map(|length| (length / side).ceil());
        let columns = tiles[0] as usize;
        let places = |number: usize| {
            let [low, high] = self.extent(number, self.size.map(f64::from));
            // A cast is the floor of what is positive.
            let tile = |pixel: f64, axis: usize| (pixel / side).clamp(0.0, tiles[axis] - 1.0) as usize;
            let (top, bottom) = (low[1] - f64::from(first), high[1] - f64::from(first));
            let is_out = high[0] < 0.0
                || low[0] > f64::from(self.size[0])
                || bottom < 0.0
                || top > f64::from(end - first);
            let [across, down] = [[low[0], high[0]].map(|x| tile(x, 0)), [top, bottom].map(|y| tile(y, 1))];
            let rows = if is_out { 0..0 } else { down[0]..down[1] + 1 };
            rows.flat_map(move |row| {
                (across[0]..across[1] + 1).map(move |column| (row * columns + column) as u32)
            })
        };
        let of_run = |run: usize| -> Vec<[u32; 2]> {
            let numbers = run * SOME..((run + 1) * SOME).min(self.triangles.len());
            let seen = numbers.filter(|&number| self.is_seen(number));
            seen.flat_map(|number| places(number).map(move |tile| [tile, number as u32])).collect()
        };
        let runs: Vec<Vec<[u32; 2]>> =
            scatter(|_| (0..self.triangles.len().div_ceil(SOME)).into_par_iter().map(of_run).collect());
        let mut starts = vec![0; columns * tiles[1] as usize + 1];
        for &[tile, _] in runs.iter().flatten() {
            starts[tile as usize + 1] += 1;
        }
        for tile in 1..starts.len() {
            starts[tile] += starts[tile - 1];
        }
        let mut next = starts.clone();
        let mut members = vec![0; starts[starts.len() - 1] as usize];
        for &[tile, number] in runs.iter().flatten() {
            let to = &mut next[tile as usize];
            members[*to as usize] = number;
            *to += 1;
        }
        (self.starts, self.members) = (starts, members);
    }

    fn corners(&self, number: usize) -> [Vector; 3] {
        self.triangles[number].map(|vertex| self.vertices[vertex as usize])
    }

    /// The corners for which a sample looks along (x, y, 1): see the beginning of this file.
    fn directions(&self, corners: [Vector; 3]) -> [Vector; 3] {
        if self.camera.orthographic { corners.map(|[x, y, _]| [x, y, 1.0 / self.unit]) } else { corners }
    }

    /// Whether the eye sees the outer side of a triangle.
    fn is_seen(&self, number: usize) -> bool {
        let [a, b, c] = self.directions(self.corners(number));
        dot(a, cross(b, c)) > 0.0
    }

    /// The box around a triangle in a picture of some width and height; without bounds where the triangle
    /// reaches behind the eye.
    fn extent(&self, number: usize, size: [f64; 2]) -> [[f64; 2]; 2] {
        let [a, b, c] = self.triangles[number].map(|vertex| self.places[vertex as usize]);
        if [a, b, c].iter().flatten().any(|x| x.is_nan()) {
            return [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];
        }
        let low = [0, 1].map(|axis| a[axis].min(b[axis]).min(c[axis]) * size[axis]);
        let high = [0, 1].map(|axis| a[axis].max(b[axis]).max(c[axis]) * size[axis]);
        [low, high]
    }

    /// The normals of the planes through the eye and the edges, each with a largest coordinate of 1, and the
    /// coefficients of the nearness; `None` for a triangle that is so thin that they are not finite.
    fn planes(&self, number: usize) -> Option<[Vector; 4]> {
        let corners = self.corners(number);
        let [a, b, c] = self.directions(corners);
        let edges = [cross(b, c), cross(c, a), cross(a, b)];
        let volume = dot(a, edges[0]);
        let nearness = corners.map(|corner| if self.camera.orthographic { -corner[2] } else { 1.0 });
        let near =
            [0, 1, 2].map(|axis| (0..3).map(|edge| edges[edge][axis] * nearness[edge]).sum::<f64>() / volume);
        let [first, second, third] = edges.map(|edge| {
            let largest = edge.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            scale(edge, 1.0 / largest)
        });
        let planes = [first, second, third, near];
        planes.iter().flatten().all(|x| x.is_finite()).then_some(planes)
    }

    /// The direction, of depth 1, of the middle of a sample; without perspective, its place.
    fn direction(&self, parts: u32, [column, row]: [u32; 2]) -> Vector {
        let part = |index: u32, axis: usize| (f64::from(index) + 0.5) / f64::from(self.size[axis] * parts);
        let [x, y] = [2.0 * part(column, 0) - 1.0, 1.0 - 2.0 * part(row, 1)];
        [x * self.camera.half[0], y * self.camera.half[1], 1.0]
    }

    /// Whether no sample of a tile meets a triangle, as its bin is empty.
    pub fn is_bare(&self, number: usize) -> bool {
        self.starts[number] == self.starts[number + 1]
    }

    /// The first triangles at all samples of a tile, by the tile's number; a pixel has `parts` times as many
    /// samples in each direction.
    pub fn tile(&self, number: usize, area: &TileArea, parts: u32) -> MeshTile {
        let [width, height] = [area.width, area.height].map(|side| (side * parts) as usize);
        let stride = width.next_multiple_of(WIDE);
        let farthest = if self.camera.orthographic { f32::NEG_INFINITY } else { 0.0 };
        let mut near = vec![[farthest; WIDE]; stride / WIDE * height];
        let mut triangle = vec![[NONE; WIDE]; stride / WIDE * height];
        let [from, to] = [number, number + 1].map(|tile| self.starts[tile] as usize);
        let members = self.members[from..to].iter();
        let patches: Vec<Patch> = members.filter_map(|&number| self.patch(number, area, parts)).collect();
        fill(&patches, stride / WIDE, &mut near, &mut triangle);
        let (near, triangle) = (near.into_flattened(), triangle.into_flattened());
        MeshTile { area: *area, parts, stride, near, triangle }
    }

    /// A triangle in the samples of a tile.
    fn patch(&self, number: u32, area: &TileArea, parts: u32) -> Option<Patch> {
        let size = self.size.map(|side| f64::from(side * parts));
        let [low, high] = self.extent(number as usize, size);
        let range = |axis: usize, first: u32, count: u32| {
            let [low, high] = [low[axis], high[axis]].map(|place| place - f64::from(first * parts));
            let most = f64::from(count * parts);
            // The middles of samples in it, and those beside it by less than edges are rounded.
            let [low, high] = [low - 0.5 - ROUNDED, high + 0.5 + ROUNDED].map(|place| place.clamp(0.0, most));
            // A cast is the floor of what is positive.
            let floor = low as usize;
            [floor + usize::from(floor as f64 != low), high as usize]
        };
        let (columns, rows) = (range(0, area.x, area.width), range(1, area.y, area.height));
        if columns[0] >= columns[1] || rows[0] >= rows[1] {
            return None;
        }
        let origin = self.direction(parts, [area.x * parts, area.y * parts]);
        let step = [0, 1].map(|axis| 2.0 * self.camera.half[axis] / size[axis]);
        let planes = self.planes(number as usize)?;
        let planes = planes.map(|plane| {
            // Without perspective the third coordinate of places is 1 in the units of the model.
            let scaled = if self.camera.orthographic { 1.0 / self.unit } else { 1.0 };
            let at = [origin[0] * scaled, origin[1] * scaled, scaled];
            [plane[0] * step[0] * scaled, -plane[1] * step[1] * scaled, dot(plane, at)].map(|x| x as f32)
        });
        Some(Patch { number, planes, columns, rows })
    }

    /// Where the ray of a sample meets the mesh, if it does.
    pub fn meeting(&self, tile: &MeshTile, [column, row]: [u32; 2]) -> Option<MeshMeeting> {
        let index = row as usize * tile.stride + column as usize;
        let (triangle, near) = (tile.triangle[index], f64::from(tile.near[index]));
        if triangle == NONE {
            return None;
        }
        let distance = if self.camera.orthographic {
            -near
        } else {
            let at = [tile.area.x * tile.parts + column, tile.area.y * tile.parts + row];
            length(self.direction(tile.parts, at)) / near
        };
        Some(MeshMeeting { distance: distance * self.unit, triangle })
    }
}

/// Where a vertex is in a picture: see [`MeshRaster::places`].
fn place(camera: &Camera, unit: f64, [x, y, z]: Vector) -> [f64; 2] {
    let depth = if camera.orthographic { 1.0 / unit } else { z };
    if depth <= NEAREST && !camera.orthographic {
        return [f64::NAN; 2];
    }
    let half = camera.half.map(|half| half * depth);
    [0.5 + 0.5 * x / half[0], 0.5 - 0.5 * y / half[1]]
}

/// Fills triangles into rows of so many blocks of eight samples.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn fill(patches: &[Patch], blocks: usize, near: &mut [EightLanes], triangle: &mut [[u32; WIDE]]) {
    for patch in patches {
        for row in patch.rows[0]..patch.rows[1] {
            let base = patch.planes.map(|[_, down, base]| base + down * row as f32);
            for block in patch.columns[0] / WIDE..patch.columns[1].div_ceil(WIDE) {
                let at = row * blocks + block;
                let (near, triangle) = (&mut near[at], &mut triangle[at]);
                for lane in 0..WIDE {
                    let column = (block * WIDE + lane) as f32;
                    let value = |plane: usize| base[plane] + patch.planes[plane][0] * column;
                    let nearness = value(3);
                    let is_first =
                        (value(0) >= 0.0) & (value(1) >= 0.0) & (value(2) >= 0.0) & (nearness > near[lane]);
                    near[lane] = if is_first { nearness } else { near[lane] };
                    triangle[lane] = if is_first { patch.number } else { triangle[lane] };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::vector::along;

    const SIZE: [u32; 2] = [70, 50];

    /// The nearest outer side of a triangle on a ray and its distance, by trying all of them, after Möller
    /// and Trumbore (1997). `margin` is how far inside of a triangle a ray has to be.
    fn nearest(mesh: &Mesh, origin: Vector, direction: Vector, margin: f64) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].map(f64::from));
            let (first, second, from) = (sub(b, a), sub(c, a), sub(origin, a));
            let (across, along) = (cross(direction, second), cross(from, first));
            let inverse = 1.0 / dot(first, across);
            let [u, v, t] =
                [dot(from, across), dot(direction, along), dot(second, along)].map(|x| x * inverse);
            let is_met = u >= margin && v >= margin && u + v <= 1.0 - margin && t > 0.0;
            let is_met = is_met && dot(cross(first, second), direction) < 0.0;
            if is_met && best.is_none_or(|(_, least)| t < least) {
                best = Some((number, t));
            }
        }
        best
    }

    /// Triangles at random places, some of them behind the eye.
    fn soup(random: &mut fastrand::Rng, count: u32) -> Mesh {
        let mut number = || random.f32() * 2.0 - 1.0;
        let mut mesh = Mesh::default();
        for index in 0..count {
            let middle = [number(), number(), 1.5 * number()];
            mesh.positions.extend((0..3).map(|_| middle.map(|x| x + 0.4 * number())));
            mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
        }
        mesh
    }

    #[test]
    fn samples_meet_what_rays_meet() {
        let mut random = fastrand::Rng::with_seed(11);
        for orthographic in [false, true] {
            let camera = Camera {
                eye: [0.1, -0.2, if orthographic { 4.0 } else { 1.4 }],
                right: [0.8, 0.6, 0.0],
                up: [-0.6, 0.8, 0.0],
                back: [0.0, 0.0, 1.0],
                half: [1.4, 1.0],
                orthographic,
            };
            let mesh = soup(&mut random, 60);
            let raster = MeshRaster::new(&camera, SIZE, &mesh, [0, SIZE[1]]);
            let mut hits = 0;
            for parts in [1, 3] {
                for (number, area) in TileArea::of_rows(SIZE[0], [0, SIZE[1]], 1).iter().enumerate() {
                    let tile = raster.tile(number, area, parts);
                    for [column, row] in (0..area.height * parts)
                        .flat_map(|row| (0..area.width * parts).map(move |column| [column, row]))
                    {
                        let place = |first: u32, index: u32, side: u32| {
                            (f64::from(first * parts + index) + 0.5) / f64::from(side * parts)
                        };
                        let (x, y) = (place(area.x, column, SIZE[0]), place(area.y, row, SIZE[1]));
                        let (origin, direction) = camera.ray(x, y);
                        let met = raster.meeting(&tile, [column, row]).map(|met| met.distance);
                        let found = nearest(&mesh, origin, direction, -1e-4);
                        let surely = nearest(&mesh, origin, direction, 1e-4);
                        // On an edge either answer will do.
                        if found.map(|(number, _)| number) == surely.map(|(number, _)| number) {
                            assert_eq!(met.is_some(), found.is_some());
                            if let (Some(met), Some((_, t))) = (met, found) {
                                let [a, b] = [met, t].map(|t| along(origin, t, direction));
                                assert!(length(sub(a, b)) < 1e-4 * (1.0 + t), "{met} {t}");
                            }
                        }
                        hits += u32::from(met.is_some());
                    }
                }
            }
            assert!(hits > 2000, "{hits}");
        }
    }

    /// A closed surface has no holes: whatever crosses a fan of thin triangles meets it.
    #[test]
    fn no_ray_slips_through_between_triangles() {
        let camera = Camera {
            eye: [0.0, 0.0, 3.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            back: [0.0, 0.0, 1.0],
            half: [0.3, 0.3],
            orthographic: false,
        };
        let mut mesh = Mesh::default();
        mesh.positions.push([0.013, -0.021, 0.3]);
        mesh.positions.extend((0..400).map(|step| {
            let angle = step as f32 * std::f32::consts::TAU / 400.0;
            [3.0 * angle.cos(), 3.0 * angle.sin(), -0.5]
        }));
        mesh.triangles = (0..400).map(|step| [0, 1 + step, 1 + (step + 1) % 400]).collect();
        let raster = MeshRaster::new(&camera, [64, 64], &mesh, [0, 64]);
        for (number, area) in TileArea::of_rows(64, [0, 64], 1).iter().enumerate() {
            let tile = raster.tile(number, area, 4);
            for sample in 0..area.width * area.height * 16 {
                let at = [sample % (area.width * 4), sample / (area.width * 4)];
                assert!(raster.meeting(&tile, at).is_some(), "{at:?}");
            }
        }
    }
}
