//! A contour that is kept by the smallest squares of its division, of which an edit makes some anew.
//!
//! Segments depend on the field in the closed square of their cells alone, so a square that an edit does not
//! meet has the same ones. Linking them into loops is done anew: it looks at no field.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicU64;

use jbt_ir::watch::Watches;

use super::cells::Segments;
use super::grid::{ContourLattice, Grid, Rectangle};
use super::{Contour, ContourPiece, Contouring, Detail, SliceError, Slicer, link};
use crate::job::Hook;
use crate::progress::{Progress, SOME};
use crate::touched::Touched;

/// The segments of a contour, by the lowest cells of the smallest squares.
pub(crate) struct KeptContour {
    lattice: ContourLattice,
    grid: Grid,
    leaf: u32,
    pieces: BTreeMap<[u32; 2], Segments>,
}

/// Squares that were made anew, before they take the places of old ones.
pub(crate) struct ContourRenewal {
    touched: Option<Touched<2>>,
    pieces: Vec<ContourPiece>,
    outline: Rectangle,
}

impl KeptContour {
    /// Nothing, yet.
    pub(crate) fn new(lattice: &ContourLattice, detail: &Detail) -> Result<Self, SliceError> {
        let grid = Grid::corners(lattice);
        Ok(Self { lattice: lattice.clone(), grid, leaf: detail.leaf()?, pieces: BTreeMap::new() })
    }

    pub(crate) fn lattice(&self) -> &ContourLattice {
        &self.lattice
    }

    /// The same squares in a lattice that [grew](ContourLattice::grown) from this one. A lattice grows by
    /// multiples of 32 cells: larger squares are other ones then, and count as changed.
    pub(crate) fn grown(&self, lattice: &ContourLattice) -> Self {
        let below = lattice.growth(&self.lattice);
        let moved = |place: &[u32; 2]| [0, 1].map(|axis| place[axis] + below[axis]);
        let pieces = self.pieces.iter().map(|(place, piece)| (moved(place), piece.moved(below))).collect();
        Self { lattice: lattice.clone(), grid: Grid::corners(lattice), leaf: self.leaf, pieces }
    }

    /// The squares of a slicer in which rectangles of an edit lie, made anew; all, if there is no edit. What
    /// is kept does not change.
    pub(crate) fn renewal(
        &self,
        slicer: &Slicer,
        (detail, edit): (&Detail, Option<Vec<[[f32; 2]; 2]>>),
        hook: Hook<'_>,
    ) -> Result<ContourRenewal, SliceError> {
        let touched = edit.and_then(|edit| Touched::by(&self.grid.axes, self.leaf as usize, edit));
        let by_leaves = Some(touched.as_ref());
        let vertices =
            AtomicU64::new(self.untouched(touched.as_ref()).map(|piece| piece.list.len() as u64).sum());
        let work = Contouring { slicer, grid: &self.grid, leaf: self.leaf, by_leaves, vertices };
        let progress = Progress::new(hook, SOME);
        let pieces = work.run(detail, &progress)?.pieces;
        progress.finish()?;
        // A commit is not stopped halfway.
        let segments = self.untouched(touched.as_ref()).chain(pieces.iter().map(|(_, piece)| piece));
        link::take_for_links(segments.map(|piece| piece.list.len()).sum(), slicer.planes());
        Ok(ContourRenewal { touched, pieces, outline: slicer.outline(&self.grid)? })
    }

    fn untouched(&self, touched: Option<&Touched<2>>) -> impl Iterator<Item = &Segments> {
        let is_kept =
            move |place: &[u32; 2]| touched.is_some_and(|touched| !self.is_touched(*place, touched));
        self.pieces.iter().filter(move |(place, _)| is_kept(place)).map(|(_, piece)| piece)
    }

    fn is_touched(&self, first: [u32; 2], touched: &Touched<2>) -> bool {
        touched.has_brick(first.map(|cell| cell / self.leaf))
    }

    /// Takes what was made anew. Returns the contour, which knows nothing of the squares by which it was
    /// found, and the squares with other segments than before.
    pub(crate) fn commit(
        &mut self,
        renewal: ContourRenewal,
        slicer: &Slicer,
    ) -> (Contour, Vec<[[f32; 2]; 2]>) {
        // Nothing can fail any more.
        Watches::NONE.hold(|| self.commit_held(renewal, slicer))
    }

    fn commit_held(&mut self, renewal: ContourRenewal, slicer: &Slicer) -> (Contour, Vec<[[f32; 2]; 2]>) {
        let ContourRenewal { touched, pieces, outline } = renewal;
        let mut old = match &touched {
            None => std::mem::take(&mut self.pieces),
            Some(touched) => {
                let places = touched.bricks().map(|place| place.map(|index| index * self.leaf));
                places.filter_map(|first| self.pieces.remove_entry(&first)).collect()
            }
        };
        let mut changed = Vec::new();
        for (first, piece) in pieces {
            if !old.remove(&first).is_some_and(|old| old.is_same(&piece)) {
                changed.push(first);
            }
            self.pieces.insert(first, piece);
        }
        // What is left has no segment any more.
        changed.extend(old.into_keys());
        changed.sort_unstable_by_key(|&[u, v]| [v, u]);
        let contour = slicer.linked(&self.grid, outline, self.pieces.values());
        (contour, changed.into_iter().map(|first| self.bounds(first)).collect())
    }

    fn bounds(&self, first: [u32; 2]) -> [[f32; 2]; 2] {
        let points = self.grid.points();
        let end = [0, 1].map(|axis| (first[axis] + self.leaf).min(points[axis] as u32 - 1));
        self.grid.bounds(first, end)
    }
}
