//! Vertices: where they start, how they are pulled onto the surface, and what they carry. Brick by brick: everything stays at hand, and each
//! evaluation is of all vertices of a brick, in the brick's region.

use std::ops::{Range, RangeInclusive};

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use rayon::prelude::*;

use super::brick::{Bricks, cell_sides, place, split};
use super::cell::{CROSSED_EDGES, EDGE_CORNERS, Edges, default_sheets, mean_crossing, sheets_with_quads};
use super::crossing::Crossings;
use super::progress::{Phase, Progress};
use super::pull::{LANES, Lanes, all, pull_lanes, squares};
use super::sample::Samples;
use super::settle::{Place, Stray, settle, strays};
use super::surface::unit;
use super::{Attribute, Field, Mesh, MeshError, Options};

/// What was done at vertices.
#[derive(Clone, Copy, Default)]
pub(crate) struct Done {
    /// Points at which the gradient was evaluated.
    pub(crate) gradient_evaluations: u64,
    /// Points at which everything was evaluated.
    pub(crate) full_evaluations: u64,
    /// Whether some vertex has no normal yet: its normal is zero.
    pub(crate) lacks_normals: bool,
}

impl Done {
    fn and(self, other: Self) -> Self {
        Self {
            gradient_evaluations: self.gradient_evaluations + other.gradient_evaluations,
            full_evaluations: self.full_evaluations + other.full_evaluations,
            lacks_normals: self.lacks_normals || other.lacks_normals,
        }
    }
}

/// What the vertices of all bricks are made from.
pub(crate) struct Source<'a, F: Field> {
    pub(crate) field: &'a F,
    pub(crate) options: &'a Options,
    pub(crate) bricks: &'a Bricks,
    pub(crate) regions: &'a [F::Region],
    pub(crate) samples: &'a Samples,
    pub(crate) crossings: &'a Crossings,
}

/// Where the answers for some bricks go.
struct Target<'a> {
    positions: &'a mut [[f32; 3]],
    normals: &'a mut [[f32; 3]],
    /// For each attribute, its values.
    attributes: Vec<&'a mut [f32]>,
}

/// Makes one vertex for each sheet of each crossing cell that has quads. A vertex at which the gradient vanishes or is no number has the
/// normal zero.
pub(crate) fn finish<F: Field>(
    source: &Source<'_, F>,
    progress: &Progress<'_>,
) -> Result<(Mesh, Done), MeshError<F::Error>> {
    let count = source.crossings.vertex_count();
    let attributes = source.field.attributes();
    if let Some((name, width)) =
        attributes.iter().find(|(_, width)| !(1..=MAX_ATTRIBUTE_WIDTH).contains(width))
    {
        return Err(MeshError::Width { name: name.clone(), width: *width });
    }
    let widths: Vec<usize> = attributes.iter().map(|(_, width)| *width).collect();
    let attribute =
        |(name, width): (String, usize)| Attribute { name, width, values: vec![0.0; width * count] };
    let mut mesh = Mesh {
        origin: [0.0; 3],
        positions: vec![[0.0; 3]; count],
        normals: vec![[0.0; 3]; count],
        attributes: attributes.into_iter().map(attribute).collect(),
        triangles: Vec::new(),
    };
    let group = source.bricks.group();
    let targets = targets(&mut mesh, &source.crossings.vertices, group);
    let total = targets.len();
    progress.begin(Phase::Vertices)?;
    let work = targets.into_par_iter().enumerate();
    let work = work.map_init(Batch::default, |batch, (index, target)| {
        let first = index * group;
        let bricks = first..source.bricks.len().min(first + group);
        let done = finish_group(source, &widths, bricks, target, batch).map_err(MeshError::Field)?;
        progress.advance(Phase::Vertices, total)?;
        Ok(done)
    });
    let done = work.try_reduce(Done::default, |a, b| Ok(a.and(b)))?;
    Ok((mesh, done))
}

/// Divides a mesh's vertices among groups of bricks.
fn targets<'a>(mesh: &'a mut Mesh, starts: &[usize], group: usize) -> Vec<Target<'a>> {
    let positions = split(&mut mesh.positions, starts, group, 1);
    let normals = split(&mut mesh.normals, starts, group, 1);
    let both = positions.into_iter().zip(normals);
    let mut targets: Vec<Target<'a>> =
        both.map(|(positions, normals)| Target { positions, normals, attributes: Vec::new() }).collect();
    for attribute in &mut mesh.attributes {
        for (target, values) in
            targets.iter_mut().zip(split(&mut attribute.values, starts, group, attribute.width))
        {
            target.attributes.push(values);
        }
    }
    targets
}

fn finish_group<F: Field>(
    source: &Source<'_, F>,
    widths: &[usize],
    bricks: Range<usize>,
    mut target: Target<'_>,
    batch: &mut Batch,
) -> Result<Done, F::Error> {
    let starts = &source.crossings.vertices;
    let (first, mut done) = (starts[bricks.start], Done::default());
    for brick in bricks {
        let range = starts[brick] - first..starts[brick + 1] - first;
        if range.is_empty() {
            continue;
        }
        batch.start(source, brick, range.len());
        done = done.and(batch.evaluate(source, brick, widths.iter().sum())?);
        done.lacks_normals |= batch.write(&mut target, range, widths);
    }
    Ok(done)
}

/// Three planes of numbers.
type Planes = [Vec<f32>; 3];

/// The vertices of one brick, in planes that are filled up to whole [`LANES`].
#[derive(Default)]
struct Batch {
    /// How many there are.
    count: usize,
    /// The field at the points of the brick.
    table: Vec<f32>,
    /// The cell of each, counted in the brick, and its sheet.
    owners: Vec<(u32, u32)>,
    points: Planes,
    /// The corners of their cells.
    low: Planes,
    high: Planes,
    values: Vec<f32>,
    gradient: Planes,
    /// One plane after the other, each for `count` vertices.
    attributes: Vec<f32>,
}

impl Batch {
    /// Puts the vertices of a brick where they start: at the means of their sheets' crossings.
    fn start<F: Field>(&mut self, source: &Source<'_, F>, brick: usize, count: usize) {
        let Source { bricks, options, .. } = source;
        self.table.resize(bricks.table_len(), 0.0);
        source.samples.gather(bricks, brick, &mut self.table);
        self.resize(count);
        let (origin, extent, sides) = (bricks.origin(brick), bricks.extent(brick), bricks.sides(brick));
        let axes: [&[f32]; 3] =
            std::array::from_fn(|axis| &bricks.axes[axis][origin[axis]..][..extent[axis] + 1]);
        let mut next = 0;
        for (index, cell) in (0..).zip(source.crossings.of(brick)) {
            let corners = corners(&self.table, bricks.in_table(cell.number), bricks.stride());
            let place = place(cell.number);
            let low = std::array::from_fn(|axis| axes[axis][place[axis]]);
            let high = std::array::from_fn(|axis| axes[axis][place[axis] + 1]);
            if sides == 0 && cell.flips == 0 && default_sheets(cell.signs).count() == 1 {
                let edges = &CROSSED_EDGES[usize::from(cell.signs)];
                self.put(next, (index, 0), mean_crossing(options.iso, &corners, edges), low, high);
                next += 1;
                continue;
            }
            let sheets = sheets_with_quads(cell.signs, cell.flips, cell_sides(sides, extent, place));
            for sheet in 0..sheets.count() {
                let edges = Edges::new(sheets.edges(sheet));
                self.put(next, (index, sheet), mean_crossing(options.iso, &corners, &edges), low, high);
                next += 1;
            }
        }
    }

    /// Puts a vertex at a place that is given in units of its cell.
    #[inline(always)]
    fn put(&mut self, index: usize, owner: (u32, u32), place: [f32; 3], low: [f32; 3], high: [f32; 3]) {
        self.owners[index] = owner;
        for axis in 0..3 {
            // Nothing overflows on the way, however large the cell.
            let start = low[axis] * (1.0 - place[axis]) + high[axis] * place[axis];
            let start = if start < low[axis] { low[axis] } else { start };
            self.points[axis][index] = if start > high[axis] { high[axis] } else { start };
            self.low[axis][index] = low[axis];
            self.high[axis][index] = high[axis];
        }
    }

    fn resize(&mut self, count: usize) {
        self.count = count;
        let padded = count.next_multiple_of(LANES);
        self.owners.resize(padded, (0, 0));
        let planes = [&mut self.points, &mut self.low, &mut self.high, &mut self.gradient];
        planes.into_iter().flatten().for_each(|plane| plane.resize(padded, 0.0));
        self.values.resize(padded, 0.0);
    }

    /// Pulls the vertices and evaluates everything at them, `width` attributes among it.
    fn evaluate<F: Field>(
        &mut self,
        source: &Source<'_, F>,
        brick: usize,
        width: usize,
    ) -> Result<Done, F::Error> {
        let Source { field, options, regions, .. } = source;
        let (region, count) = (&regions[brick], self.count);
        for _ in 0..options.pulls {
            let [x, y, z] = self.points.each_ref().map(|plane| &plane[..count]);
            let gradient = self.gradient.each_mut().map(|plane| &mut plane[..count]);
            field.gradient(region, x, y, z, &mut self.values[..count], gradient)?;
            self.pull(options.iso);
        }
        let [x, y, z] = self.points.each_ref().map(|plane| &plane[..count]);
        let gradient = self.gradient.each_mut().map(|plane| &mut plane[..count]);
        self.attributes.resize(width * count, 0.0);
        let mut attributes: Vec<&mut [f32]> = self.attributes.chunks_exact_mut(count).collect();
        field.all(region, x, y, z, &mut self.values[..count], gradient, &mut attributes)?;
        let done = Done {
            gradient_evaluations: (options.pulls * count) as u64,
            full_evaluations: count as u64,
            lacks_normals: false,
        };
        if options.pulls == 0 { Ok(done) } else { Ok(done.and(self.settle(source, brick)?)) }
    }

    /// A pull of all vertices.
    fn pull(&mut self, iso: f32) {
        for chunk in 0..self.values.len() / LANES {
            let mut points = lanes(&self.points, chunk);
            let values = &lane(&self.values, chunk);
            let gradient = lanes(&self.gradient, chunk);
            pull_lanes(
                iso,
                &mut points,
                values,
                &gradient,
                &lanes(&self.low, chunk),
                &lanes(&self.high, chunk),
            );
            for (plane, lanes) in self.points.iter_mut().zip(points) {
                plane[chunk * LANES..][..LANES].copy_from_slice(&lanes);
            }
        }
    }

    /// Brings those that a crease has kept off the surface onto it, and evaluates everything at them again.
    fn settle<F: Field>(&mut self, source: &Source<'_, F>, brick: usize) -> Result<Done, F::Error> {
        let Source { field, options, regions, .. } = source;
        let mut strays = self.strays(source, brick);
        if strays.is_empty() {
            return Ok(Done::default());
        }
        let gradient_evaluations = settle(*field, &regions[brick], options.iso, &mut strays)?;
        let count = strays.len();
        let [x, y, z] =
            [0, 1, 2].map(|axis| strays.iter().map(|stray| stray.best()[axis]).collect::<Vec<f32>>());
        let (mut values, mut gradient) = (vec![0.0; count], [0; 3].map(|_| vec![0.0; count]));
        let mut attributes = vec![0.0; self.attributes.len() / self.count * count];
        let mut planes: Vec<&mut [f32]> = attributes.chunks_exact_mut(count).collect();
        let slopes = gradient.each_mut().map(Vec::as_mut_slice);
        field.all(&regions[brick], &x, &y, &z, &mut values, slopes, &mut planes)?;
        for (n, stray) in strays.iter().enumerate() {
            let index = stray.index;
            for (axis, slope) in gradient.iter().enumerate() {
                self.points[axis][index] = stray.best()[axis];
                self.gradient[axis][index] = slope[n];
            }
            self.values[index] = values[n];
            let planes = self.attributes.chunks_exact_mut(self.count).zip(attributes.chunks_exact(count));
            planes.for_each(|(plane, settled)| plane[index] = settled[n]);
        }
        Ok(Done { gradient_evaluations, full_evaluations: count as u64, lacks_normals: false })
    }

    /// The vertices that are off the surface.
    fn strays<F: Field>(&self, source: &Source<'_, F>, brick: usize) -> Vec<Stray> {
        let iso = source.options.iso;
        let mut found = Vec::new();
        for start in (0..self.count).step_by(LANES) {
            let chunk = start / LANES;
            let (values, gradient) = (lane(&self.values, chunk), lanes(&self.gradient, chunk));
            let (low, high) = (lane(&self.low[0], chunk), lane(&self.high[0], chunk));
            let is_stray = strays(iso, [&low, &high], &values, &gradient);
            if is_stray == [0; LANES] {
                continue;
            }
            let indices = (start..self.count).zip(is_stray).filter(|&(_, is_stray)| is_stray == 1);
            found.extend(indices.map(|(index, _)| self.stray(source, brick, index)));
        }
        found
    }

    fn stray<F: Field>(&self, source: &Source<'_, F>, brick: usize, index: usize) -> Stray {
        let (cell, sheet) = self.owners[index];
        let cell = source.crossings.of(brick)[cell as usize];
        let bricks = source.bricks;
        let sides = cell_sides(bricks.sides(brick), bricks.extent(brick), place(cell.number));
        let edges = sheets_with_quads(cell.signs, cell.flips, sides).edges(sheet);
        let mut corners = [0_u8; 2];
        let ends = EDGE_CORNERS.iter().enumerate().filter(|(edge, _)| edges >> edge & 1 == 1);
        for &corner in ends.flat_map(|(_, ends)| ends) {
            corners[usize::from(cell.signs >> corner & 1)] |= 1 << corner;
        }
        let at = |planes: &Planes| planes.each_ref().map(|plane| plane[index]);
        let place = Place { bounds: [at(&self.low), at(&self.high)], corners };
        Stray::new(source.options.iso, index, place, at(&self.points), self.values[index], at(&self.gradient))
    }

    /// Writes the vertices to their range of the target. Returns whether one has no normal.
    fn write(&self, target: &mut Target<'_>, range: Range<usize>, widths: &[usize]) -> bool {
        let [x, y, z] = &self.points;
        for (i, position) in target.positions[range.clone()].iter_mut().enumerate() {
            *position = [x[i], y[i], z[i]];
        }
        let mut lacks_normals = false;
        for (normals, chunk) in target.normals[range.clone()].chunks_mut(LANES).zip(0..) {
            let [x, y, z] = normals_of(&lanes(&self.gradient, chunk));
            for (i, normal) in normals.iter_mut().enumerate() {
                *normal = [x[i], y[i], z[i]];
                lacks_normals |= *normal == [0.0; 3];
            }
        }
        let mut planes = self.attributes.chunks_exact(self.count);
        for (values, &width) in target.attributes.iter_mut().zip(widths) {
            let values = &mut values[range.start * width..range.end * width];
            for (component, plane) in planes.by_ref().take(width).enumerate() {
                for (value, &source) in values[component..].iter_mut().step_by(width).zip(plane) {
                    *value = source;
                }
            }
        }
        lacks_normals
    }
}

/// The field at the corners of the cell at a place of a table.
#[inline(always)]
fn corners(table: &[f32], at: usize, stride: usize) -> [f32; 8] {
    let layer = stride * stride;
    let table = &table[at..at + layer + stride + 2];
    let [p, q, r, s] = [0, stride, layer, layer + stride].map(|at| [table[at], table[at + 1]]);
    [p[0], p[1], q[0], q[1], r[0], r[1], s[0], s[1]]
}

#[inline(always)]
fn lane(plane: &[f32], chunk: usize) -> Lanes {
    *plane[chunk * LANES..].first_chunk().expect("planes are filled up")
}

#[inline(always)]
fn lanes(planes: &Planes, chunk: usize) -> [Lanes; 3] {
    planes.each_ref().map(|plane| lane(plane, chunk))
}

/// The directions away from the inside, or zero where the gradient vanishes or is no number.
#[inline]
fn normals_of(gradient: &[Lanes; 3]) -> [Lanes; 3] {
    /// Squares of lengths whose terms neither overflow nor lose digits.
    const TAME: RangeInclusive<f32> = 1e-24..=1e30;
    let square = squares(gradient);
    let (mut normals, mut is_tame) = (*gradient, [0_u32; LANES]);
    for i in 0..LANES {
        let scale = -1.0 / square[i].sqrt();
        normals.iter_mut().for_each(|plane| plane[i] *= scale);
        is_tame[i] = u32::from(square[i] >= *TAME.start()) & u32::from(square[i] <= *TAME.end());
    }
    if !all(&is_tame) {
        for i in (0..LANES).filter(|&i| is_tame[i] == 0) {
            let slope = gradient.map(|plane| -f64::from(plane[i]));
            let normal = unit(slope).unwrap_or([0.0; 3]);
            normals.iter_mut().zip(normal).for_each(|(plane, component)| plane[i] = component);
        }
    }
    normals
}
