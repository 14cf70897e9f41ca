//! The starts of the vertices of a brick: the means of their sheets' crossings.

use super::super::brick::BrickSides;
use super::super::cell::{case, default_edges, edges, first_edges};
use super::super::field::Field;
use super::super::pull::LANES;
use super::batch::{Shared, VertexBatch, VertexSource};
use super::seed::grow;

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
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        let lattice_sides = BrickSides::new(bricks, brick);
        let axes = [0, 1, 2].map(|axis| &bricks.axes[axis][origin[axis]..=origin[axis] + extent[axis]]);
        let mut next = 0;
        for cell in crossings.of(brick) {
            let (at, corners) = (bricks.at(cell.number), &self.corners(bricks, cell));
            let (place, touched) = (at.place(), lattice_sides.of(at));
            let home = [0, 1, 2].map(|axis| [axes[axis][place[axis]], axes[axis][place[axis] + 1]]);
            // Nearly all cells.
            if touched == 0 && cell.flips == 0 && case(cell.signs).sheets() == 1 {
                self.seeds[next / LANES].put(next % LANES, corners, home, first_edges(cell.signs));
                next += 1;
                continue;
            }
            let flipped;
            let sheets = match cell.flips {
                0 => default_edges(cell.signs),
                flips => {
                    flipped = edges(cell.signs, flips);
                    &flipped[..]
                }
            };
            let first = next;
            for &edges in sheets.iter().filter(|edges| edges.have_quad(touched)) {
                self.seeds[next / LANES].put(next % LANES, corners, home, edges);
                if sheets.len() > 1 || cell.flips != 0 {
                    let (rise, start) = (edges.rise(cell.signs), [0.0; 3]);
                    self.shared.push(Shared { vertex: next, earlier: next - first, start, rise });
                }
                next += 1;
            }
        }
    }
}
