//! Ranges of rows by themselves: each row with each box is a lane.

use jbt_ir::{RowFunction, Tables};
use jbt_lower::prune_info::ContestGroup;

use crate::boxes::{Box3, Range};
use crate::compiler::Compiler;
use crate::error::EvalError;
use crate::kernel::{BoundKernel, Purpose};

/// Lanes of a run: their planes stay in the nearest caches.
pub(super) const MOST_LANES: usize = 1024;

/// What gives the ranges of the rows of a table.
pub(super) struct RowRanges {
    kernel: BoundKernel,
    /// Numbers of the rows, plane by plane.
    numbers: Vec<Vec<f32>>,
    /// Distances in the function.
    distances: u64,
}

/// A row in a box.
#[derive(Clone, Copy)]
pub(super) struct RowInBox {
    pub(super) row: u32,
    /// Its place among all active rows of the selection.
    pub(super) place: u32,
    /// The position of the row that owns it.
    pub(super) owner: u32,
    pub(super) part: u8,
    /// Whether it is no row that may go.
    pub(super) stays: bool,
}

/// A row in a box, with its group and its range: that of the negative field, where the smallest wins.
#[derive(Clone, Copy)]
pub(super) struct MetRow {
    pub(super) entry: RowInBox,
    pub(super) group: usize,
    pub(super) low: f32,
    pub(super) high: f32,
}

impl RowRanges {
    /// Of the rows of a group; `None` if no ranges of them can be had.
    pub(super) fn new(compiler: &Compiler, lowered: &BoundKernel, group: &ContestGroup) -> Option<Self> {
        let function = &lowered.kernel.lowered;
        let RowFunction { function, numbers, distances } =
            RowFunction::new(function, lowered.tables(), group.table, group.field)?;
        // What no program can be had for is not left out.
        let kernel = compiler.kernel(function, Purpose::RowRanges, None).ok()?;
        Some(Self { kernel: compiler.bind(&kernel, Tables::default()), numbers, distances })
    }

    /// The distances that the function computes.
    pub(super) fn distances(&self) -> u64 {
        self.distances
    }

    /// The range of each row in its box.
    pub(super) fn find(
        &self,
        entered: &[RowInBox],
        boxes: &[Box3],
        met: &mut dyn FnMut(RowInBox, Range),
    ) -> Result<(), EvalError> {
        let most = MOST_LANES.next_multiple_of(self.kernel.kernel.block());
        let mut planes: Vec<Vec<f32>> = vec![Vec::with_capacity(most); 6 + self.numbers.len()];
        for entered in entered.chunks(most) {
            // Whole blocks run in place.
            let lanes = entered.len().next_multiple_of(self.kernel.kernel.block());
            let (point, numbers) = planes.split_at_mut(6);
            let part = |entry: &RowInBox| &boxes[entry.part as usize];
            for axis in 0..3 {
                fill(&mut point[2 * axis], lanes, entered.iter().map(|entry| part(entry).low[axis]));
                fill(&mut point[2 * axis + 1], lanes, entered.iter().map(|entry| part(entry).high[axis]));
            }
            for (plane, numbers) in numbers.iter_mut().zip(&self.numbers) {
                fill(plane, lanes, entered.iter().map(|entry| numbers[entry.row as usize]));
            }
            let inputs: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
            let (mut low, mut high) = (vec![0.0; lanes], vec![0.0; lanes]);
            self.kernel.run(self.kernel.all(), &inputs, &mut [&mut low, &mut high])?;
            for ((&entry, &low), &high) in entered.iter().zip(&low).zip(&high) {
                met(entry, [low, high]);
            }
        }
        Ok(())
    }
}

/// Fills a plane; lanes behind the last number repeat it.
pub(super) fn fill(plane: &mut Vec<f32>, lanes: usize, numbers: impl Iterator<Item = f32>) {
    plane.clear();
    plane.extend(numbers);
    plane.resize(lanes, plane.last().copied().unwrap_or(0.0));
}
