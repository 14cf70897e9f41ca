//! Where the vertices of a brick start: at the means of their sheets' crossings.

use super::super::brick::cell_sides;
use super::super::cell::{default_edges, edges, mean_crossing};
use super::super::pull::{LANES, Lanes};
use super::super::{Field, MAX_BRICK};
use super::room::room;
use super::{Batch, Planes, Source, corners};

/// Along one axis of a brick: the sides of a cell, and between what its vertices stay.
#[derive(Clone, Copy, Default)]
struct Home {
    sides: [f32; 2],
    room: [f32; 2],
}

/// A cell of which vertices are put.
struct Home3 {
    /// By how much the field differs at most among its corners.
    spread: f32,
    axes: [Home; 3],
}

/// What is known of vertices from their cells.
#[derive(Clone, Copy, Default)]
pub(super) struct Group {
    /// The low and the high corners of the boxes in which they stay.
    pub(super) low: [Lanes; 3],
    pub(super) high: [Lanes; 3],
    /// By how much the field rises along the axes, roughly: from the low corners of their cells to the high ones,
    /// or along the edges that their sheets cross.
    pub(super) rise: [Lanes; 3],
    /// By how much the field differs at most among the corners of their cells.
    pub(super) spread: Lanes,
}

/// A group that is being filled, and where its vertices start.
#[derive(Default)]
struct Starting {
    group: Group,
    points: [Lanes; 3],
}

impl Starting {
    /// Puts a vertex at a place that is given in units of its cell. Returns where that is.
    #[inline(always)]
    fn put(&mut self, lane: usize, place: [f32; 3], rise: [f32; 3], home: &Home3) -> [f32; 3] {
        self.group.spread[lane] = home.spread;
        let mut position = [0.0; 3];
        for axis in 0..3 {
            let Home { sides: [first, last], room: [low, high] } = home.axes[axis];
            // Nothing overflows on the way, however large the cell.
            let start = first * (1.0 - place[axis]) + last * place[axis];
            let start = if start < low { low } else { start };
            position[axis] = if start > high { high } else { start };
            self.points[axis][lane] = position[axis];
            self.group.low[axis][lane] = low;
            self.group.high[axis][lane] = high;
            self.group.rise[axis][lane] = rise[axis];
        }
        position
    }
}

impl Batch {
    /// Puts the vertices of a brick where they start.
    pub(super) fn start<F: Field>(&mut self, source: &Source<'_, F>, brick: usize, count: usize) {
        let Source { bricks, options, .. } = source;
        self.table.resize(bricks.table_len(), 0.0);
        source.samples.gather(bricks, brick, &mut self.table);
        self.resize(count);
        let (origin, extent, sides) = (bricks.origin(brick), bricks.extent(brick), bricks.sides(brick));
        let homes = [0, 1, 2].map(|axis| homes(&bricks.axes[axis][origin[axis]..][..extent[axis] + 1]));
        let stride = bricks.stride();
        self.groups.clear();
        self.owners.clear();
        self.doubles.clear();
        self.doubtful.clear();
        let (mut starting, mut next) = (Starting::default(), 0);
        for (index, cell) in (0..).zip(source.crossings.of(brick)) {
            let at = bricks.at(cell.number);
            let (place, corners) = (at.place(), corners(&self.table, at.in_table(), stride));
            let home = Home3 {
                spread: spread(&corners),
                axes: [0, 1, 2].map(|axis| homes[axis][place[axis] % MAX_BRICK]),
            };
            let sides = if sides == 0 { 0 } else { cell_sides(sides, extent, place) };
            let flipped;
            let (sheets, rise) = match (cell.flips, default_edges(cell.signs)) {
                (0, one @ [_]) => (one, Some(rise(&corners))),
                (0, more) => (more, None),
                (flips, _) => {
                    flipped = edges(cell.signs, flips);
                    (&flipped[..], None)
                }
            };
            for (sheet, edges) in (0..).zip(sheets.iter().filter(|edges| edges.have_quad(sides))) {
                let mean = mean_crossing(options.iso, &corners, edges);
                let position = starting.put(next % LANES, mean, rise.unwrap_or(edges.rise), &home);
                self.owners.push((index, sheet));
                if sheet > 0 {
                    self.doubles.push((next, position));
                }
                next += 1;
                if next % LANES == 0 {
                    write(&starting, &mut self.groups, &mut self.points);
                }
            }
        }
        if next % LANES != 0 {
            write(&starting, &mut self.groups, &mut self.points);
        }
    }
}

/// Writes a group behind the others, and where its vertices start.
fn write(starting: &Starting, groups: &mut Vec<Group>, points: &mut Planes) {
    for (plane, lanes) in points.iter_mut().zip(&starting.points) {
        plane[groups.len() * LANES..][..LANES].copy_from_slice(lanes);
    }
    groups.push(starting.group);
}

/// Along one axis of a brick, the cells.
fn homes(axis: &[f32]) -> [Home; MAX_BRICK] {
    let mut homes = [Home::default(); MAX_BRICK];
    for (home, &sides) in homes.iter_mut().zip(axis.array_windows()) {
        *home = Home { sides, room: room(sides) };
    }
    homes
}

/// By how much the field differs among the corners of a cell; infinite if one has no number.
#[inline(always)]
fn spread(corners: &[f32; 8]) -> f32 {
    let (mut low, mut high, mut sum) = ([0.0_f32; 4], [0.0_f32; 4], [0.0_f32; 4]);
    for n in 0..4 {
        let (a, b) = (corners[n], corners[n + 4]);
        (low[n], high[n]) = if a < b { (a, b) } else { (b, a) };
        sum[n] = a + b;
    }
    let least = |a: f32, b: f32| if a < b { a } else { b };
    let most = |a: f32, b: f32| if a > b { a } else { b };
    let spread = most(most(high[0], high[1]), most(high[2], high[3]))
        - least(least(low[0], low[1]), least(low[2], low[3]));
    // An infinite sum is no number if another one of the other sign comes to it.
    let sum = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    if sum.is_nan() { f32::INFINITY } else { spread }
}

/// By how much the field rises along the axes, from the low corners of a cell to the high ones.
#[inline(always)]
fn rise([a, b, c, d, e, f, g, h]: &[f32; 8]) -> [f32; 3] {
    [
        ((b - a) + (d - c)) + ((f - e) + (h - g)),
        ((c - a) + (d - b)) + ((g - e) + (h - f)),
        ((e - a) + (f - b)) + ((g - c) + (h - d)),
    ]
}
