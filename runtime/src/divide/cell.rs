//! A box as a decider sees it: what is asked for is found then, for all parts of one box at once.

use std::cell::{Cell as Slot, OnceCell};
use std::fmt;

use crate::boxes::{ANYTHING, Box3, Divisible, MAX_PARTS, Range};

/// The parts of one box, and what has been found of them.
pub(super) struct Siblings<'a, F: Divisible> {
    field: &'a F,
    parent: &'a F::Region,
    pub(super) boxes: &'a [Box3],
    ranges: Slot<Option<[Range; MAX_PARTS]>>,
    /// The parts whose ranges were asked for, a bit each.
    asked: Slot<u8>,
    regions: OnceCell<Vec<F::Region>>,
}

impl<'a, F: Divisible> Siblings<'a, F> {
    pub(super) fn new(field: &'a F, parent: &'a F::Region, boxes: &'a [Box3]) -> Self {
        Self { field, parent, boxes, ranges: Slot::new(None), asked: Slot::new(0), regions: OnceCell::new() }
    }

    fn ranges(&self) -> Result<[Range; MAX_PARTS], F::Error> {
        if let Some(ranges) = self.ranges.get() {
            return Ok(ranges);
        }
        let mut ranges = [ANYTHING; MAX_PARTS];
        self.field.ranges(self.parent, self.boxes, &mut ranges[..self.boxes.len()])?;
        self.ranges.set(Some(ranges));
        Ok(ranges)
    }

    /// The range of a part, if the decider has asked for it.
    pub(super) fn known_range(&self, part: usize) -> Option<Range> {
        if self.asked.get() >> part & 1 == 0 { None } else { Some(self.ranges.get()?[part]) }
    }

    fn regions(&self) -> Result<&[F::Region], F::Error> {
        if self.regions.get().is_none() {
            let mut regions = Vec::with_capacity(self.boxes.len());
            self.field.narrow(self.parent, self.boxes, &mut regions)?;
            let _ = self.regions.set(regions);
        }
        Ok(self.regions.get().expect("it has just been set"))
    }

    /// The regions of the wanted parts, in their order.
    pub(super) fn into_regions(mut self, wanted: &[bool]) -> Result<Vec<F::Region>, F::Error> {
        if let Some(regions) = self.regions.take() {
            return Ok(regions.into_iter().zip(wanted).filter_map(|(r, &w)| w.then_some(r)).collect());
        }
        let mut boxes = [Box3::default(); MAX_PARTS];
        let mut count = 0;
        for (bounds, _) in self.boxes.iter().zip(wanted).filter(|(_, wanted)| **wanted) {
            boxes[count] = *bounds;
            count += 1;
        }
        let mut regions = Vec::with_capacity(count);
        if count > 0 {
            self.field.narrow(self.parent, &boxes[..count], &mut regions)?;
        }
        Ok(regions)
    }
}

/// A box, and what a decider may want to know about it.
pub struct Cell<'a, F: Divisible> {
    pub(super) siblings: &'a Siblings<'a, F>,
    pub(super) part: usize,
    pub(super) depth: usize,
}

impl<F: Divisible> fmt::Debug for Cell<'_, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cell")
            .field("bounds", &self.bounds())
            .field("depth", &self.depth)
            .finish_non_exhaustive()
    }
}

impl<F: Divisible> Cell<'_, F> {
    /// The box.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.siblings.boxes[self.part]
    }

    /// How often a box was split to get here.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// A range of the field in the box.
    ///
    /// # Errors
    /// Those of [`Divisible::ranges`].
    pub fn range(&self) -> Result<Range, F::Error> {
        self.siblings.asked.set(self.siblings.asked.get() | 1 << self.part);
        Ok(self.siblings.ranges()?[self.part])
    }

    /// What matters in the box.
    ///
    /// # Errors
    /// Those of [`Divisible::narrow`].
    pub fn region(&self) -> Result<&F::Region, F::Error> {
        Ok(&self.siblings.regions()?[self.part])
    }

    /// What matters in the box around this one: known already, and more than matters here.
    #[must_use]
    pub fn around(&self) -> &F::Region {
        self.siblings.parent
    }
}
