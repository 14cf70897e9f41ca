//! The starts of the vertices of a brick: the means of their sheets' crossings.

use super::super::brick::{At, BrickSides, Bricks};
use super::super::cell::{case, default_edges, edges, first_edges};
use super::super::crossing::CrossedCell;
use super::super::field::Field;
use super::super::pull::LANES;
use super::super::sample::corners;
use super::batch::{Shared, VertexBatch, VertexSource};
use super::seed::{Seeds, grow};

impl VertexBatch {
    /// Puts the vertices of a brick at their starts.
    pub(super) fn start<F: Field>(&mut self, source: &VertexSource<'_, F>, brick: usize, count: usize) {
        self.resize(count);
        self.shared.clear();
        self.doubtful.clear();
        self.jumped.clear();
        self.table.resize(source.bricks.table_len(), 0.0);
        source.samples.gather(source.bricks, brick, &mut self.table);
        self.sow(source, brick);
        let points = self.points.each_mut().map(Vec::as_mut_slice);
        grow(source.options.iso, &self.seeds, &mut self.groups, points);
        for shared in &mut self.shared {
            let (group, lane) = (&mut self.groups[shared.vertex / LANES], shared.vertex % LANES);
            shared.start = self.points.each_ref().map(|plane| plane[shared.vertex]);
            group.rise.iter_mut().zip(shared.rise).for_each(|(plane, rise)| plane[lane] = rise);
        }
    }

    /// Collects the seeds of the vertices of a brick. Lanes behind the last vertex keep data of other bricks.
    fn sow<F: Field>(&mut self, source: &VertexSource<'_, F>, brick: usize) {
        let VertexSource { bricks, crossings, .. } = source;
        let seedbed = Seedbed { bricks, brick, cells: crossings.of(brick), table: &self.table };
        let (seeds, shared) = (&mut self.seeds[..], &mut self.shared);
        // In rows of a length that the compiler knows, corners need no checks.
        match bricks.stride() {
            5 => seedbed.sow(5, seeds, shared),
            9 => seedbed.sow(9, seeds, shared),
            17 => seedbed.sow(17, seeds, shared),
            stride => seedbed.sow(stride, seeds, shared),
        }
    }
}

/// A brick whose vertices are sown.
struct Seedbed<'a> {
    bricks: &'a Bricks,
    brick: usize,
    cells: &'a [CrossedCell],
    /// The field at the points of the brick's closed box.
    table: &'a [f32],
}

/// The coordinates of a brick's points along the axes.
type BrickAxes<'a> = [&'a [f32]; 3];

impl Seedbed<'_> {
    #[inline(always)]
    fn sow(&self, stride: usize, seeds: &mut [Seeds], shared: &mut Vec<Shared>) {
        let &Self { bricks, brick, cells, table } = self;
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        let axes = [0, 1, 2].map(|axis| &bricks.axes[axis][origin[axis]..=origin[axis] + extent[axis]]);
        let (sides, places) = (BrickSides::new(bricks, brick), bricks.cells());
        let mut next = 0;
        for cell in cells {
            let at = places[usize::from(cell.number)];
            // Nearly all cells.
            if sides.of(at) == 0 && cell.flips == 0 && case(cell.signs).sheets() == 1 {
                let (seeds, lane) = (&mut seeds[next / LANES], next % LANES);
                seeds.put_corners(lane, &corners(table, at.in_table(), stride));
                seeds.put_home(lane, home(&axes, at), first_edges(cell.signs));
                next += 1;
            } else {
                next = self.sow_sheets((cell, at, sides.of(at)), &axes, next, (seeds, shared));
            }
        }
    }

    /// Sows the vertices of a cell with other than one sheet, or at a side of the lattice, from `first` on.
    /// Returns the number of the vertex after them.
    #[cold]
    fn sow_sheets(
        &self,
        (cell, at, touched): (&CrossedCell, At, u8),
        axes: &BrickAxes<'_>,
        first: usize,
        (seeds, shared): (&mut [Seeds], &mut Vec<Shared>),
    ) -> usize {
        let (corners, home) = (&corners(self.table, at.in_table(), self.bricks.stride()), home(axes, at));
        let flipped;
        let sheets = match cell.flips {
            0 => default_edges(cell.signs),
            flips => {
                flipped = edges(cell.signs, flips);
                &flipped[..]
            }
        };
        let mut next = first;
        for &edges in sheets.iter().filter(|edges| edges.have_quad(touched)) {
            seeds[next / LANES].put(next % LANES, corners, home, edges);
            if sheets.len() > 1 || cell.flips != 0 {
                let (rise, start) = (edges.rise(cell.signs), [0.0; 3]);
                shared.push(Shared { vertex: next, earlier: next - first, start, rise });
            }
            next += 1;
        }
        next
    }
}

/// The low and the high side of a cell along each axis.
#[inline(always)]
fn home(axes: &BrickAxes<'_>, at: At) -> [[f32; 2]; 3] {
    let ([xs, ys, zs], [x, y, z]) = (axes, at.place());
    [[xs[x], xs[x + 1]], [ys[y], ys[y + 1]], [zs[z], zs[z + 1]]]
}
