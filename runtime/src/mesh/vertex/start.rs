//! The starts of the vertices of a brick: the means of their sheets' crossings.

use super::super::brick::{At, BrickSides, Bricks};
use super::super::cell::{SheetEdges, case, default_edges, edges, first_edges};
use super::super::crossing::CrossedCell;
use super::super::field::Field;
use super::super::pull::LANES;
use super::super::sample::corners;
use super::batch::{Shared, VertexBatch, VertexSource};
use super::seed::{BED, Bed, SeedGroup, grow};

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
        for shared in &mut self.shared {
            let (group, lane) = (&mut self.groups[shared.vertex / LANES], shared.vertex % LANES);
            shared.start = self.points.each_ref().map(|plane| plane[shared.vertex]);
            group.rise.iter_mut().zip(shared.rise).for_each(|(plane, rise)| plane[lane] = rise);
        }
    }

    /// Sows the vertices of a brick, and grows them. Lanes behind the last vertex have data of others.
    fn sow<F: Field>(&mut self, source: &VertexSource<'_, F>, brick: usize) {
        let VertexSource { bricks, crossings, options, .. } = source;
        let seedbed = Seedbed { bricks, brick, cells: crossings.of(brick), table: &self.table };
        let points = self.points.each_mut().map(Vec::as_mut_slice);
        let sower = Sower { iso: options.iso, bed: &mut self.bed, next: 0, groups: &mut self.groups, points };
        let shared = &mut self.shared;
        // In rows of a length that the compiler knows, corners need no checks.
        match bricks.stride() {
            5 => seedbed.sow(5, sower, shared),
            9 => seedbed.sow(9, sower, shared),
            17 => seedbed.sow(17, sower, shared),
            stride => seedbed.sow(stride, sower, shared),
        }
    }
}

/// Puts vertices into the bed, and grows them when it is full.
struct Sower<'a> {
    iso: f32,
    bed: &'a mut Bed,
    /// The number of the next vertex.
    next: usize,
    groups: &'a mut [SeedGroup],
    points: [&'a mut [f32]; 3],
}

impl Sower<'_> {
    /// Sows a vertex.
    #[inline(always)]
    fn sow(&mut self, corners: &[f32; 8], sides: [[f32; 2]; 3], edges: SheetEdges) {
        let place = self.next % (BED * LANES);
        self.bed[place / LANES].put(place % LANES, corners, sides, edges);
        self.next += 1;
        if place + 1 == BED * LANES {
            self.grow();
        }
    }

    /// Grows what has been sown since it last did.
    fn grow(&mut self) {
        let first = (self.next - 1) / (BED * LANES) * BED;
        let groups = &mut self.groups[first..self.next.div_ceil(LANES)];
        let points = self.points.each_mut().map(|plane| &mut plane[first * LANES..]);
        grow(self.iso, self.bed, groups, points);
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
    fn sow(&self, stride: usize, mut sower: Sower<'_>, shared: &mut Vec<Shared>) {
        let &Self { bricks, brick, cells, table } = self;
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        let axes = [0, 1, 2].map(|axis| &bricks.axes[axis][origin[axis]..=origin[axis] + extent[axis]]);
        let (sides, places) = (BrickSides::new(bricks, brick), bricks.cells());
        for cell in cells {
            let at = places[usize::from(cell.number)];
            // Nearly all cells.
            if sides.of(at) == 0 && cell.flips == 0 && case(cell.signs).sheets() == 1 {
                sower.sow(&corners(table, at.in_table(), stride), home(&axes, at), first_edges(cell.signs));
            } else {
                self.sow_sheets((cell, at, sides.of(at)), &axes, &mut sower, shared);
            }
        }
        if !sower.next.is_multiple_of(BED * LANES) {
            sower.grow();
        }
    }

    /// Sows the vertices of a cell with other than one sheet, or at a side of the lattice.
    #[cold]
    fn sow_sheets(
        &self,
        (cell, at, touched): (&CrossedCell, At, u8),
        axes: &BrickAxes<'_>,
        sower: &mut Sower<'_>,
        shared: &mut Vec<Shared>,
    ) {
        let (corners, home) = (&corners(self.table, at.in_table(), self.bricks.stride()), home(axes, at));
        let flipped;
        let sheets = match cell.flips {
            0 => default_edges(cell.signs),
            flips => {
                flipped = edges(cell.signs, flips);
                &flipped[..]
            }
        };
        let first = sower.next;
        for &edges in sheets.iter().filter(|edges| edges.have_quad(touched)) {
            if sheets.len() > 1 || cell.flips != 0 {
                let (rise, start) = (edges.rise(cell.signs), [0.0; 3]);
                shared.push(Shared { vertex: sower.next, earlier: sower.next - first, start, rise });
            }
            sower.sow(corners, home, edges);
        }
    }
}

/// The low and the high side of a cell along each axis.
#[inline(always)]
fn home(axes: &BrickAxes<'_>, at: At) -> [[f32; 2]; 3] {
    let ([xs, ys, zs], [x, y, z]) = (axes, at.place());
    [[xs[x], xs[x + 1]], [ys[y], ys[y + 1]], [zs[z], zs[z + 1]]]
}
