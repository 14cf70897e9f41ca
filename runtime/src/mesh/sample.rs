//! The field at the points of bricks, once per point: the owner of a point that bricks share, and how the
//! other bricks get it.
//!
//! ```text
//!     +-------+-------+          A point on the sides of bricks touches up to eight of them. Its owner is the first that
//!     |       |       |          is there: the brick above it along every axis; then the others in a fixed order.
//!     |   c   p   d   |
//!     |       |       |          Here p belongs to d; or to c, if d was dropped. So a brick owns all points of its
//!     +-------q-------+          half-open box, and those on its high sides that are nobody else's: its rim.
//!     |       |       |
//!     |   a   |   b   |          q belongs to d, else to c, b, a.
//!     +-------+-------+
//! ```
//!
//! On each axis a point of a brick is low (the first), in the middle, or high (the first of the next brick).
//! That makes 27 *classes* of points; the order of preference of each class is computed at compile time.

mod class;
mod points;
mod window;

use jbt_ir::watch;

use crate::parallel::*;

use super::brick::{Bricks, NONE, starts};
use super::error::MeshError;
use super::field::Field;
use super::fill::{FilledVector, VectorPart, room};
use super::stage::MeshStage;
use crate::progress::Progress;
use crate::span::span;

pub(crate) use window::SampleWindow;

use class::{CLASSES, Class, ClassOwner, FOREIGN, HIGH, SIDES, class_number, span};
use points::BrickPoints;

/// The field at the points of all bricks.
pub(crate) struct BrickSamples {
    /// Brick by brick: its half-open box, x fastest, then y, then z; then the classes of its rim.
    values: Vec<f32>,
    /// Which of them are inside, 1 or 0 each.
    inside: Vec<u8>,
    /// Where the values of each brick begin, and the end.
    starts: Vec<usize>,
    /// For each brick, where the classes of its rim begin, relative to its first value.
    rims: Vec<[u16; 27]>,
}

/// Evaluates the field at every point of every brick, once. With a window, points beyond it are outside,
/// whatever the field is there.
pub(crate) fn sample<F: Field>(
    field: &F,
    (bricks, regions): (&Bricks, &[F::Region]),
    (iso, window): (f32, Option<SampleWindow>),
    progress: &Progress<'_>,
) -> Result<BrickSamples, MeshError<F::Error>> {
    span!("sample");
    // Lists of parts become one list.
    watch::take(2 * bricks.len() * size_of::<([u16; 27], usize)>());
    let (rims, counts): (Vec<[u16; 27]>, Vec<usize>) = scatter(|_| {
        (0..bricks.len()).into_par_iter().with_min_len(64).map(|brick| rim(bricks, brick)).unzip()
    });
    let starts = starts(counts.into_iter());
    let (group, points) = (bricks.group(), starts[bricks.len()]);
    let mut values = FilledVector::in_room(room(wider(points))?, points);
    let mut inside = FilledVector::new(points)?;
    let groups: Vec<_> =
        values.parts(&starts, group, 1).into_iter().zip(inside.parts(&starts, group, 1)).collect();
    let total = groups.len();
    MeshStage::Lattice.begin(progress)?;
    let of_group = |points: &mut BrickPoints, (index, (mut values, mut inside)): (usize, SamplePart<'_>)| {
        span!("samples of some bricks");
        let first = index * group;
        for brick in first..bricks.len().min(first + group) {
            let count = starts[brick + 1] - starts[brick];
            points.collect(bricks, brick, &rims[brick]);
            let (values, inside) = (values.take(count).open(), inside.take(count).open());
            let ask = |[x, y, z]: [&[f32]; 3], values: &mut [f32]| {
                field.field(&regions[brick], x, y, z, values).map_err(MeshError::Field)
            };
            match window.filter(|window| !window.holds(bricks, brick)) {
                None => points.eval(progress, values, ask)?,
                Some(window) => points.eval_some((window, bricks), progress, values, ask)?,
            }
            compare(iso, values, inside);
        }
        progress.add(1.0 / total as f64).map_err(MeshError::from)
    };
    let rooms = Rooms::new(BrickPoints::default);
    scatter(|watches| {
        let groups = in_pieces(groups.into_par_iter().enumerate());
        groups.try_for_each_init(|| rooms.take(), |points, group| watches.hold(|| of_group(points, group)))
    })?;
    Ok(BrickSamples { values: values.finish(), inside: inside.finish(), starts, rims })
}

/// The room that values get, as later the triangles take it over: a third more than they need, as far as that
/// is not much. A crossed cell has two triangles of three numbers as a rule, and where surfaces are densest a
/// brick has few more than four points for each. Nobody touches the pages of what is not used.
fn wider(points: usize) -> usize {
    const MOST: usize = 1 << 22;
    (points + (points / 3).min(MOST)).next_multiple_of(3)
}

/// What some bricks fill.
type SamplePart<'a> = (VectorPart<'a, f32>, VectorPart<'a, u8>);

/// Which values are inside, 1 or 0 each.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn compare(iso: f32, values: &[f32], inside: &mut [u8]) {
    for (bit, value) in inside.iter_mut().zip(values) {
        *bit = u8::from(*value >= iso);
    }
}

/// The field at the corners of the cell at a place of a table.
#[inline(always)]
pub(crate) fn corners(table: &[f32], at: usize, stride: usize) -> [f32; 8] {
    let layer = stride * stride;
    let table = &table[at..][..layer + stride + 2];
    let (next, last) = (layer + 1, layer + stride);
    [
        table[0],
        table[1],
        table[stride],
        table[stride + 1],
        table[layer],
        table[next],
        table[last],
        table[last + 1],
    ]
}

/// Where the classes on the rim that a brick owns begin among its values, and the number of points that it
/// owns.
fn rim(bricks: &Bricks, brick: usize) -> ([u16; 27], usize) {
    let neighbours = &bricks.neighbours[brick];
    let there = neighbours.iter().rev().fold(0_u32, |mask, &other| mask << 1 | u32::from(other != NONE));
    let extent = bricks.extent(brick);
    let box_points: usize = extent.iter().product();
    let (mut rim, mut count) = ([FOREIGN; 27], 0);
    for (direction, classes) in SIDES {
        if there >> direction & 1 == 1 {
            continue;
        }
        for &class in classes {
            if there & CLASSES[class].before == 0 {
                // At most 3 * 33^2, with bricks of the largest edge.
                rim[class] = count as u16;
                let kinds = CLASSES[class].kinds;
                count += (0..3).map(|axis| span(kinds[axis], extent[axis]).1).product::<usize>();
            }
        }
    }
    (rim, box_points + count)
}

/// The place of a box of points in a list of numbers: its first number, and the strides of rows and layers.
#[derive(Clone, Copy)]
struct BlockLayout {
    start: usize,
    row: usize,
    layer: usize,
}

impl BrickSamples {
    /// How many points were sampled.
    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }

    /// The field at all points of a brick's closed box, written to a table (x fastest, then y, then z, in
    /// rows and layers of [`Bricks::stride`]). Where the lattice cuts the brick, the rest of the table is
    /// unchanged.
    pub(crate) fn gather(&self, bricks: &Bricks, brick: usize, table: &mut [f32]) {
        self.gather_from(&self.values, bricks, brick, table);
    }

    /// Which of these points are inside, 1 or 0 each, in such a table.
    pub(crate) fn gather_inside(&self, bricks: &Bricks, brick: usize, table: &mut [u8]) {
        self.gather_from(&self.inside, bricks, brick, table);
    }

    /// The memory of the field, whose values nobody needs any more.
    pub(crate) fn into_room(self) -> Vec<f32> {
        self.values
    }

    /// Forgets which points are inside.
    pub(crate) fn forget_inside(&mut self) {
        self.inside = Vec::new();
    }

    fn gather_from<T: Copy>(&self, source: &[T], bricks: &Bricks, brick: usize, table: &mut [T]) {
        let is_done = match bricks.edge {
            4 => self.gather_whole::<4, T>(source, bricks, brick, table),
            8 => self.gather_whole::<8, T>(source, bricks, brick, table),
            16 => self.gather_whole::<16, T>(source, bricks, brick, table),
            _ => false,
        };
        if is_done {
            return;
        }
        let (extent, stride) = (bricks.extent(brick), bricks.stride());
        let neighbours = &bricks.neighbours[brick];
        let own = self.block(extent, brick, [0; 3]);
        let target = BlockLayout { start: 0, row: stride, layer: stride * stride };
        copy(source, own, table, target, extent);
        for (direction, classes) in SIDES {
            let last = &CLASSES[classes[classes.len() - 1]].kinds;
            let is_high = [0, 1, 2].map(|axis| last[axis] == HIGH);
            if neighbours[direction] != NONE {
                // All of them are in the half-open box of one brick.
                let first = [0, 1, 2].map(|axis| if is_high[axis] { extent[axis] } else { 0 });
                let counts = [0, 1, 2].map(|axis| if is_high[axis] { 1 } else { extent[axis] });
                let other = neighbours[direction] as usize;
                let from = self.block(bricks.extent(other), other, [0; 3]);
                copy(source, from, table, target.at(first), counts);
                continue;
            }
            for &class in classes {
                let kinds = CLASSES[class].kinds;
                let spans = [0, 1, 2].map(|axis| span(kinds[axis], extent[axis]));
                let from = self.class(bricks, brick, class);
                copy(source, from, table, target.at(spans.map(|(first, _)| first)), spans.map(|(_, n)| n));
            }
        }
    }

    /// The same for a brick that the lattice does not cut, nor the bricks above it, which are all there: most
    /// are so, and this takes a third of the time. Returns whether it is such a brick.
    fn gather_whole<const EDGE: usize, T: Copy>(
        &self,
        source: &[T],
        bricks: &Bricks,
        brick: usize,
        table: &mut [T],
    ) -> bool {
        let neighbours = &bricks.neighbours[brick];
        let above = SIDES.map(|(direction, _)| neighbours[direction]);
        // A brick above that is cut has fewer rows, or shorter ones.
        let is_whole = |&brick: &u32| brick != NONE && bricks.extent(brick as usize) == [EDGE; 3];
        if !above.iter().all(is_whole) {
            return false;
        }
        let rows = |brick: usize| source[self.starts[brick]..][..EDGE.pow(3)].as_chunks::<EDGE>().0;
        let [x, y, xy, z, xz, yz, xyz] = above.map(|brick| rows(brick as usize));
        let (own, stride) = (rows(brick), EDGE + 1);
        let mut fill = |layer: usize, of: [&[[T; EDGE]]; 4]| {
            let [own, x, y, xy] = of;
            let table = &mut table[layer * stride * stride..][..stride * stride];
            let (all, last) = table.split_at_mut(EDGE * stride);
            for ((row, own), x) in all.chunks_exact_mut(stride).zip(own).zip(x) {
                row[..EDGE].copy_from_slice(own);
                row[EDGE] = x[0];
            }
            last[..EDGE].copy_from_slice(&y[0]);
            last[EDGE] = xy[0][0];
        };
        for layer in 0..EDGE {
            fill(layer, [own, x, y, xy].map(|rows| &rows[layer * EDGE..][..EDGE]));
        }
        fill(EDGE, [z, xz, yz, xyz].map(|rows| &rows[..EDGE]));
        true
    }

    /// The values of a brick's half-open box from a point on.
    fn block(&self, extent: [usize; 3], brick: usize, first: [usize; 3]) -> BlockLayout {
        BlockLayout { start: self.starts[brick], row: extent[0], layer: extent[0] * extent[1] }.at(first)
    }

    /// The place of the values of a class of a brick's points.
    fn class(&self, bricks: &Bricks, brick: usize, class: usize) -> BlockLayout {
        let Class { candidates, count, .. } = &CLASSES[class];
        let neighbours = &bricks.neighbours[brick];
        let is_there = |candidate: &&ClassOwner| neighbours[usize::from(candidate.direction)] != NONE;
        let owner = candidates[..*count].iter().find(is_there).expect("a brick is there for itself");
        let other = neighbours[usize::from(owner.direction)] as usize;
        let extent = bricks.extent(other);
        let spans = [0, 1, 2].map(|axis| span(owner.kinds[axis], extent[axis]));
        if owner.kinds.iter().all(|&kind| kind != HIGH) {
            return self.block(extent, other, spans.map(|(first, _)| first));
        }
        let box_points: usize = extent.iter().product();
        let start =
            self.starts[other] + box_points + usize::from(self.rims[other][class_number(owner.kinds)]);
        BlockLayout { start, row: spans[0].1, layer: spans[0].1 * spans[1].1 }
    }
}

impl BlockLayout {
    /// The same box from another point on.
    fn at(self, first: [usize; 3]) -> Self {
        Self { start: self.start + first[0] + self.row * first[1] + self.layer * first[2], ..self }
    }
}

/// Copies a box of numbers.
fn copy<T: Copy>(
    source: &[T],
    from: BlockLayout,
    target: &mut [T],
    to: BlockLayout,
    [nx, ny, nz]: [usize; 3],
) {
    // Rows of whole bricks, and columns: their lengths are known, so that no function is called for each.
    match nx {
        1 => copy_rows(source, from, target, to, [ny, nz], |source, target| target[0] = source[0]),
        4 => copy_rows(source, from, target, to, [ny, nz], copy_row::<4, T>),
        8 => copy_rows(source, from, target, to, [ny, nz], copy_row::<8, T>),
        16 => copy_rows(source, from, target, to, [ny, nz], copy_row::<16, T>),
        length => copy_rows(source, from, target, to, [ny, nz], |source, target| {
            target[..length].copy_from_slice(&source[..length]);
        }),
    }
}

/// Copies rows, each from where it begins to where it goes.
#[inline(always)]
fn copy_rows<T: Copy>(
    source: &[T],
    from: BlockLayout,
    target: &mut [T],
    to: BlockLayout,
    [ny, nz]: [usize; 2],
    row: impl Fn(&[T], &mut [T]),
) {
    for z in 0..nz {
        let (mut first, mut place) = (from.start + z * from.layer, to.start + z * to.layer);
        for _ in 0..ny {
            row(&source[first..], &mut target[place..]);
            (first, place) = (first + from.row, place + to.row);
        }
    }
}

#[inline(always)]
fn copy_row<const LENGTH: usize, T: Copy>(source: &[T], target: &mut [T]) {
    target[..LENGTH].copy_from_slice(&source[..LENGTH]);
}
