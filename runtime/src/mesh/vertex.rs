//! Vertices: their start, their pull onto the surface, and their attributes. Brick by brick: the data stays
//! in the cache, and each evaluation takes all vertices of a brick, in the brick's region.

mod again;
pub(super) mod batch;
mod bracket;
mod margin;
mod normal;
mod room;
mod seed;
mod settle;
mod sharp;
mod sheet;
pub(super) mod side;
mod start;
mod suspect;
mod wall;

use std::ops::Range;

use crate::parallel::*;
use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use jbt_ir::memory::NoMemory;
use jbt_model::orientation::Orientation;

use super::error::MeshError;
use super::field::{AttributePlanes, Field};
use super::fill::{FilledVector, VectorPart};
use super::indexed::{Attribute, Mesh};
use super::pull::{LANES, VertexLanes, VertexPlanes, pull_lanes};
use super::stage::MeshStage;
use crate::progress::Progress;
use crate::span::span;

use batch::{Done, VertexBatch, VertexSource, lane, lanes};
use normal::normals_of;
use seed::SeedGroup;

pub(super) use room::is_crowded;

/// Makes one vertex for each sheet of each crossed cell that has quads. A vertex whose gradient vanishes or
/// is NaN has the normal zero.
pub(crate) fn finish<F: Field>(
    source: &VertexSource<'_, F>,
    progress: &Progress<'_>,
) -> Result<(Mesh, Done), MeshError<F::Error>> {
    span!("vertices");
    let count = source.crossings.vertex_count();
    if u32::try_from(count).is_err() {
        return Err(MeshError::TooManyVertices { vertices: count as u64 });
    }
    let attributes = source.field.attributes();
    if let Some((name, width)) =
        attributes.iter().find(|(_, width)| !(1..=MAX_ATTRIBUTE_WIDTH).contains(width))
    {
        return Err(MeshError::Width { name: name.clone(), width: *width });
    }
    let widths: Vec<usize> = attributes.iter().map(|(_, width)| *width).collect();
    let mut vectors = MeshVectors::new(count, &widths)?;
    let group = source.bricks.group();
    let targets = vectors.parts(&source.crossings.vertices, group, &widths);
    let total = targets.len();
    MeshStage::Vertices.begin(progress)?;
    let finish = |batch: &mut VertexBatch, (index, parts)| {
        let first = index * group;
        let bricks = first..source.bricks.len().min(first + group);
        let done = finish_group((source, progress), &widths, bricks, parts, batch)?;
        progress.add(1.0 / total as f64)?;
        Ok::<_, MeshError<F::Error>>(done)
    };
    let rooms = Rooms::new(VertexBatch::default);
    let done = scatter(|watches| {
        let work = in_pieces(targets.into_par_iter().enumerate());
        let work = work.map_init(|| rooms.take(), |batch, target| watches.hold(|| finish(batch, target)));
        work.try_reduce(Done::default, |a, b| Ok(a.and(b)))
    })?;
    let attribute =
        |((name, width), values): (_, FilledVector<f32>)| Attribute { name, width, values: values.finish() };
    let mesh = Mesh {
        origin: [0.0; 3],
        orientation: Orientation::default(),
        positions: vectors.positions.finish(),
        normals: vectors.normals.finish(),
        attributes: attributes.into_iter().zip(vectors.attributes).map(attribute).collect(),
        triangles: Vec::new(),
        parts: Vec::new(),
        creases: Default::default(),
    };
    Ok((mesh, done))
}

/// The vectors of a mesh that are filled at vertices.
struct MeshVectors {
    positions: FilledVector<[f32; 3]>,
    normals: FilledVector<[f32; 3]>,
    attributes: Vec<FilledVector<f32>>,
}

/// The parts of them that some bricks fill.
struct MeshParts<'a> {
    positions: VectorPart<'a, [f32; 3]>,
    normals: VectorPart<'a, [f32; 3]>,
    attributes: Vec<VectorPart<'a, f32>>,
}

impl MeshVectors {
    /// Room for vertices with attributes of these widths.
    fn new(count: usize, widths: &[usize]) -> Result<Self, NoMemory> {
        let attributes =
            widths.iter().map(|width| FilledVector::new(width * count)).collect::<Result<_, _>>()?;
        Ok(Self { positions: FilledVector::new(count)?, normals: FilledVector::new(count)?, attributes })
    }

    /// Divides them among groups of bricks.
    fn parts(&mut self, starts: &[usize], group: usize, widths: &[usize]) -> Vec<MeshParts<'_>> {
        let positions = self.positions.parts(starts, group, 1).into_iter();
        let both = positions.zip(self.normals.parts(starts, group, 1));
        let mut parts: Vec<MeshParts<'_>> = both
            .map(|(positions, normals)| MeshParts { positions, normals, attributes: Vec::new() })
            .collect();
        for (values, &width) in self.attributes.iter_mut().zip(widths) {
            for (part, values) in parts.iter_mut().zip(values.parts(starts, group, width)) {
                part.attributes.push(values);
            }
        }
        parts
    }
}

fn finish_group<F: Field>(
    (source, progress): (&VertexSource<'_, F>, &Progress<'_>),
    widths: &[usize],
    bricks: Range<usize>,
    mut parts: MeshParts<'_>,
    batch: &mut VertexBatch,
) -> Result<Done, MeshError<F::Error>> {
    span!("vertices of some bricks");
    let starts = &source.crossings.vertices;
    let mut done = Done::default();
    for brick in bricks {
        let count = starts[brick + 1] - starts[brick];
        if count == 0 {
            continue;
        }
        batch.start(source, brick, count);
        progress.breathe()?;
        let mut of_brick = batch.evaluate(source, brick, widths.iter().sum()).map_err(MeshError::Field)?;
        of_brick.sharp.iter_mut().for_each(|sharp| sharp.vertex += starts[brick] as u32);
        done = done.and(of_brick);
        batch.write(&mut parts, widths);
        done.doubtful.extend(batch.doubtful.iter().map(|&vertex| (starts[brick] + vertex) as u32));
    }
    Ok(done)
}

impl VertexBatch {
    /// Pulls the vertices and evaluates everything at them, with `width` channels of attributes.
    fn evaluate<F: Field>(
        &mut self,
        source: &VertexSource<'_, F>,
        brick: usize,
        width: usize,
    ) -> Result<Done, F::Error> {
        let VertexSource { field, options, regions, .. } = source;
        let (region, count) = (&regions[brick], self.count);
        for _ in 0..options.pulls {
            let [x, y, z] = self.points.each_ref().map(|plane| &plane[..count]);
            let gradient = self.gradient.each_mut().map(|plane| &mut plane[..count]);
            field.gradient(region, x, y, z, &mut self.values[..count], gradient)?;
            pull_all(options.iso, &self.groups, &mut self.points, &self.values, &self.gradient);
        }
        let [x, y, z] = self.points.each_ref().map(|plane| &plane[..count]);
        let gradient = self.gradient.each_mut().map(|plane| &mut plane[..count]);
        self.attributes.resize(width * count, 0.0);
        let mut attributes: AttributePlanes<'_> = self.attributes.chunks_exact_mut(count).collect();
        field.all(region, x, y, z, &mut self.values[..count], gradient, &mut attributes)?;
        drop(attributes);
        let done = Done {
            gradient_evaluations: (options.pulls * count) as u64,
            full_evaluations: count as u64,
            ..Done::default()
        };
        let again = if options.pulls == 0 { Done::default() } else { self.look_again(source, brick)? };
        self.separate();
        let done = done.and(again);
        let is_sharp = options.sharp && options.pulls > 0 && field.is_sharp();
        if is_sharp { Ok(done.and(self.sharpen(source, brick)?)) } else { Ok(done) }
    }

    /// Writes the vertices to the next places of a mesh, and records vertices without a normal.
    fn write(&mut self, parts: &mut MeshParts<'_>, widths: &[usize]) {
        let normals = parts.normals.take(self.count).open();
        let positions = parts.positions.take(self.count).open();
        if write_places((&self.points, positions), (&self.gradient, normals)) {
            let normals = normals.iter().enumerate();
            self.doubtful
                .extend(normals.filter(|(_, normal)| **normal == [0.0; 3]).map(|(vertex, _)| vertex));
            self.doubtful.sort_unstable();
            self.doubtful.dedup();
        }
        let mut rest = &self.attributes[..];
        for (part, &width) in parts.attributes.iter_mut().zip(widths) {
            let (planes, after) = rest.split_at(width * self.count);
            rest = after;
            let values = part.take(width * self.count).open();
            match width {
                1 => values.copy_from_slice(planes),
                2 => interleave::<2>(planes, values),
                3 => interleave::<3>(planes, values),
                4 => interleave::<4>(planes, values),
                _ => {
                    for (component, plane) in planes.chunks_exact(self.count).enumerate() {
                        let values = values[component..].iter_mut().step_by(width);
                        values.zip(plane).for_each(|(value, &source)| *value = source);
                    }
                }
            }
        }
    }
}

/// Writes positions, and normals opposite to the gradients. Returns whether a normal is missing.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn write_places(
    (points, positions): (&VertexPlanes, &mut [[f32; 3]]),
    (gradient, normals): (&VertexPlanes, &mut [[f32; 3]]),
) -> bool {
    let mut is_missing = false;
    for (chunk, (positions, normals)) in
        positions.chunks_mut(LANES).zip(normals.chunks_mut(LANES)).enumerate()
    {
        let directions = normals_of(&lanes(gradient, chunk));
        weave(&lanes(points, chunk), positions);
        weave(&directions, normals);
        is_missing |= normals.contains(&[0.0; 3]);
    }
    is_missing
}

/// Writes vectors from lanes, as many as `vectors` has room for.
#[inline(always)]
fn weave([x, y, z]: &[VertexLanes; 3], vectors: &mut [[f32; 3]]) {
    if let Some(vectors) = vectors.as_mut_array::<LANES>() {
        for i in 0..LANES {
            vectors[i] = [x[i], y[i], z[i]];
        }
    } else {
        for (vector, ((x, y), z)) in vectors.iter_mut().zip(x.iter().zip(y).zip(z)) {
            *vector = [*x, *y, *z];
        }
    }
}

/// Interleaves consecutive planes into vectors.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn interleave<const WIDTH: usize>(planes: &[f32], vectors: &mut [f32]) {
    let (vectors, count) = (vectors.as_chunks_mut::<WIDTH>().0, planes.len() / WIDTH);
    let planes: [&[f32]; WIDTH] = std::array::from_fn(|n| &planes[n * count..][..count]);
    for (i, vector) in vectors.iter_mut().enumerate().take(count) {
        *vector = std::array::from_fn(|n| planes[n][i]);
    }
}

/// A pull of all vertices.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn pull_all(
    iso: f32,
    groups: &[SeedGroup],
    points: &mut VertexPlanes,
    values: &[f32],
    gradient: &VertexPlanes,
) {
    for (chunk, group) in groups.iter().enumerate() {
        let mut lanes_of = lanes(points, chunk);
        let (values, gradient) = (&lane(values, chunk), lanes(gradient, chunk));
        pull_lanes(iso, &mut lanes_of, values, &gradient, &group.low, &group.high);
        for (plane, lanes) in points.iter_mut().zip(lanes_of) {
            plane[chunk * LANES..][..LANES].copy_from_slice(&lanes);
        }
    }
}
