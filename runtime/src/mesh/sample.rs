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

mod window;

use std::error::Error;
use std::ops::Range;

use crate::parallel::*;

use super::brick::{Bricks, NONE, SELF, direction, split, starts};
use super::error::MeshError;
use super::field::Field;
use super::stage::MeshStage;
use crate::progress::Progress;
use crate::span::span;

pub(crate) use window::SampleWindow;

/// Marks a class of points that a brick does not own.
const FOREIGN: u16 = u16::MAX;

/// Low, middle or high along each axis.
type Kinds = [u8; 3];
const LOW: u8 = 0;
const MIDDLE: u8 = 1;
const HIGH: u8 = 2;

/// A brick that may own the points of a class: its direction, and the class of the points in it.
#[derive(Clone, Copy)]
struct ClassOwner {
    direction: u8,
    kinds: Kinds,
}

/// Points of a brick with one kind along each axis.
#[derive(Clone, Copy)]
struct Class {
    kinds: Kinds,
    /// In the order of preference, up to the brick itself.
    candidates: [ClassOwner; 8],
    count: usize,
    /// The directions of all candidates but the brick itself, a bit each.
    before: u32,
}

/// All classes; that of kinds `(a, b, c)` is `a + 3 b + 9 c`.
static CLASSES: [Class; 27] = {
    let itself = ClassOwner { direction: SELF as u8, kinds: [LOW; 3] };
    let empty = Class { kinds: [LOW; 3], candidates: [itself; 8], count: 0, before: 0 };
    let mut classes = [empty; 27];
    let mut number = 0;
    while number < 27 {
        classes[number] = class([(number % 3) as u8, (number / 3 % 3) as u8, (number / 9) as u8], empty);
        number += 1;
    }
    classes
};

const fn class(kinds: Kinds, empty: Class) -> Class {
    let mut class = Class { kinds, ..empty };
    // The brick above along every axis comes first; a bit of `below` takes the one below along an axis
    // instead.
    let mut below = 0;
    while below < 8 {
        let (mut steps, mut seen, mut exists) = ([0_i8; 3], kinds, true);
        let mut axis = 0;
        while axis < 3 {
            let is_below = below >> axis & 1 == 1;
            match kinds[axis] {
                LOW if is_below => (steps[axis], seen[axis]) = (-1, HIGH),
                HIGH if !is_below => (steps[axis], seen[axis]) = (1, LOW),
                MIDDLE if is_below => exists = false,
                _ => {}
            }
            axis += 1;
        }
        if exists {
            let direction = direction(steps);
            class.candidates[class.count] = ClassOwner { direction: direction as u8, kinds: seen };
            class.count += 1;
            if direction == SELF {
                break;
            }
            class.before |= 1 << direction;
        }
        below += 1;
    }
    class
}

const fn class_number(kinds: Kinds) -> usize {
    kinds[0] as usize + 3 * kinds[1] as usize + 9 * kinds[2] as usize
}

/// For each set of axes: the classes that are high on exactly these axes. The brick in that direction owns
/// them, if it exists.
static SIDES: [(usize, &[usize]); 7] = [
    (direction([1, 0, 0]), &[2, 5, 11, 14]),
    (direction([0, 1, 0]), &[6, 7, 15, 16]),
    (direction([1, 1, 0]), &[8, 17]),
    (direction([0, 0, 1]), &[18, 19, 21, 22]),
    (direction([1, 0, 1]), &[20, 23]),
    (direction([0, 1, 1]), &[24, 25]),
    (direction([1, 1, 1]), &[26]),
];

/// The first index of a kind in a brick with this many cells along the axis, and the number of indices.
fn span(kind: u8, cells: usize) -> (usize, usize) {
    match kind {
        LOW => (0, 1),
        MIDDLE => (1, cells - 1),
        _ => (cells, 1),
    }
}

/// The field at the points of all bricks.
pub(crate) struct BrickSamples {
    /// Brick by brick: its half-open box, x fastest, then y, then z; then the classes of its rim.
    values: Vec<f32>,
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
    window: Option<SampleWindow>,
    progress: &Progress<'_>,
) -> Result<BrickSamples, MeshError<F::Error>> {
    span!("sample");
    let (rims, counts): (Vec<[u16; 27]>, Vec<usize>) = scatter(|_| {
        (0..bricks.len()).into_par_iter().with_min_len(64).map(|brick| rim(bricks, brick)).unzip()
    });
    let starts = starts(counts.into_iter());
    let mut values = allocate(starts[bricks.len()])?;
    let group = bricks.group();
    let groups = split(&mut values, &starts, group, 1);
    let total = groups.len();
    MeshStage::Lattice.begin(progress)?;
    let of_group = |points: &mut BrickPoints, (index, values): (usize, &mut [f32])| {
        span!("samples of some bricks");
        let first = index * group;
        for brick in first..bricks.len().min(first + group) {
            let mine = starts[brick] - starts[first]..starts[brick + 1] - starts[first];
            points.collect(bricks, brick, &rims[brick]);
            let values = &mut values[mine];
            let ask = |[x, y, z]: [&[f32]; 3], values: &mut [f32]| {
                field.field(&regions[brick], x, y, z, values).map_err(MeshError::Field)
            };
            match window.filter(|window| !window.holds(bricks, brick)) {
                None => points.eval(progress, values, ask)?,
                Some(window) => points.eval_some((window, bricks), progress, values, ask)?,
            }
        }
        progress.add(1.0 / total as f64).map_err(MeshError::from)
    };
    scatter(|watches| {
        let groups = groups.into_par_iter().enumerate();
        groups
            .try_for_each_init(BrickPoints::default, |points, group| watches.hold(|| of_group(points, group)))
    })?;
    Ok(BrickSamples { values, starts, rims })
}

/// A vector of zeros, or an error where the allocator would abort.
fn allocate<T: Copy + Default, E: Error + 'static>(points: usize) -> Result<Vec<T>, MeshError<E>> {
    // Zeroed memory comes from the system page by page when the threads first touch it, which is faster than
    // filling it here. But only `try_reserve` can fail, so the room is reserved first.
    let mut room = Vec::<T>::new();
    room.try_reserve_exact(points).map_err(|_| MeshError::Memory { points })?;
    drop(room);
    Ok(vec![T::default(); points])
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

/// The points of a brick.
#[derive(Default)]
struct BrickPoints {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Points that take little time: see [`Progress::paced`].
    at_once: usize,
    /// The indices of those that are needed, and the field there.
    chosen: Vec<u32>,
    found: Vec<f32>,
}

impl BrickPoints {
    /// The points that a brick owns, in the order of its values.
    fn collect(&mut self, bricks: &Bricks, brick: usize, rim: &[u16; 27]) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        let axes: [&[f32]; 3] =
            [0, 1, 2].map(|axis| &bricks.axes[axis][origin[axis]..=origin[axis] + extent[axis]]);
        self.push([0, 1, 2].map(|axis| &axes[axis][..extent[axis]]));
        for class in SIDES.iter().flat_map(|(_, classes)| *classes).filter(|&&class| rim[class] != FOREIGN) {
            let kinds = CLASSES[*class].kinds;
            self.push([0, 1, 2].map(|axis| {
                let (first, count) = span(kinds[axis], extent[axis]);
                &axes[axis][first..first + count]
            }));
        }
    }

    /// The field at all points.
    fn eval<E: Error + 'static>(
        &mut self,
        progress: &Progress<'_>,
        values: &mut [f32],
        ask: impl Fn([&[f32]; 3], &mut [f32]) -> Result<(), MeshError<E>>,
    ) -> Result<(), MeshError<E>> {
        let Self { x, y, z, at_once, .. } = self;
        progress.paced(x.len(), at_once, |some: Range<usize>| {
            ask([&x[some.clone()], &y[some.clone()], &z[some.clone()]], &mut values[some])
        })
    }

    /// The field at the points of a window; the others are outside.
    fn eval_some<E: Error + 'static>(
        &mut self,
        (window, bricks): (SampleWindow, &Bricks),
        progress: &Progress<'_>,
        values: &mut [f32],
        ask: impl Fn([&[f32]; 3], &mut [f32]) -> Result<(), MeshError<E>>,
    ) -> Result<(), MeshError<E>> {
        window.choose(bricks, [&mut self.x, &mut self.y, &mut self.z], &mut self.chosen);
        let mut found = std::mem::take(&mut self.found);
        found.resize(self.chosen.len(), 0.0);
        let done = self.eval(progress, &mut found, ask);
        values.fill(f32::NEG_INFINITY);
        for (&index, &value) in self.chosen.iter().zip(&found) {
            values[index as usize] = value;
        }
        self.found = found;
        done
    }

    /// All points with these coordinates, x fastest, then y, then z.
    fn push(&mut self, [xs, ys, zs]: [&[f32]; 3]) {
        let layer = xs.len() * ys.len();
        self.x.extend_from_slice(xs);
        repeat(&mut self.x, xs.len(), ys.len() * zs.len());
        for &y in ys {
            self.y.resize(self.y.len() + xs.len(), y);
        }
        repeat(&mut self.y, layer, zs.len());
        for &z in zs {
            self.z.resize(self.z.len() + layer, z);
        }
    }
}

/// Repeats the last `length` numbers until they are there `times` times.
fn repeat(numbers: &mut Vec<f32>, length: usize, times: usize) {
    if length == 0 || times == 0 {
        numbers.truncate(numbers.len() - length);
        return;
    }
    let start = numbers.len() - length;
    let end = start + length * times;
    while numbers.len() < end {
        let more = (numbers.len() - start).min(end - numbers.len());
        numbers.extend_from_within(start..start + more);
    }
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
        let source = &self.values[..];
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_stand_with_the_axes_that_they_are_high_on() {
        let mut seen = 0_u32;
        for (side, classes) in SIDES {
            for &class in classes {
                let Class { kinds, candidates, count, before } = CLASSES[class];
                let steps = kinds.map(|kind| i8::from(kind == HIGH));
                assert_eq!((direction(steps), class_number(kinds)), (side, class));
                // The half-open owner comes first, the brick itself last.
                assert_eq!(usize::from(candidates[0].direction), side);
                assert_eq!(usize::from(candidates[count - 1].direction), SELF);
                assert_eq!(candidates[count - 1].kinds, kinds);
                assert_eq!(before.count_ones() as usize, count - 1);
                seen |= 1 << class;
            }
        }
        assert_eq!(seen.count_ones(), 27 - 8);
    }

    #[test]
    fn numbers_repeat() {
        let mut numbers = vec![9.0, 1.0, 2.0];
        repeat(&mut numbers, 2, 3);
        assert_eq!(numbers, [9.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0]);
        repeat(&mut numbers, 2, 0);
        assert_eq!(numbers, [9.0, 1.0, 2.0, 1.0, 2.0]);
    }
}
