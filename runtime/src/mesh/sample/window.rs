//! Points of bricks that are needed: of bricks beside a block, a few layers.

use crate::mesh::brick::Bricks;

/// The closed box of the points that are needed, by their indices in the lattice.
#[derive(Clone, Copy)]
pub(crate) struct SampleWindow {
    low: [usize; 3],
    high: [usize; 3],
}

impl SampleWindow {
    /// The points of some cells, from the first one to before the second one.
    pub(crate) fn of_cells([low, end]: [[usize; 3]; 2]) -> Self {
        Self { low, high: end }
    }

    /// Whether all points of a brick are needed.
    pub(super) fn holds(&self, bricks: &Bricks, brick: usize) -> bool {
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        (0..3).all(|axis| self.low[axis] <= origin[axis] && origin[axis] + extent[axis] <= self.high[axis])
    }

    /// Leaves out the points that are not needed, and tells the indices of the others.
    pub(super) fn choose(&self, bricks: &Bricks, planes: [&mut Vec<f32>; 3], chosen: &mut Vec<u32>) {
        let ends = [0, 1, 2].map(|axis| {
            let axis_of = &bricks.axes[axis];
            [axis_of[self.low[axis]], axis_of[self.high[axis]]]
        });
        let is_in =
            |index: usize| (0..3).all(|axis| (ends[axis][0]..=ends[axis][1]).contains(&planes[axis][index]));
        let needed = (0..planes[0].len()).filter(|&index| is_in(index));
        chosen.clear();
        chosen.extend(needed.map(|index| index as u32));
        for plane in planes {
            for (place, &index) in chosen.iter().enumerate() {
                plane[place] = plane[index as usize];
            }
            plane.truncate(chosen.len());
        }
    }
}
