//! Points that are evaluated together, and the limit of the work.

use super::error::TraceError;
use super::target::Target;
use crate::error::EvalError;
use crate::prune::Region;

/// The limit of points and boxes that may still be evaluated for some rays.
pub(super) struct WorkLimit {
    pub(super) left: u64,
    pub(super) rays: usize,
}

impl WorkLimit {
    pub(super) fn spend(&mut self, work: u64) -> Result<(), TraceError> {
        self.left = self.left.checked_sub(work).ok_or(TraceError::Work { rays: self.rays })?;
        Ok(())
    }
}

/// Points by coordinates, and the field there.
#[derive(Default)]
pub(super) struct TraceBatch {
    pub(super) points: [Vec<f32>; 3],
    pub(super) field: Vec<f32>,
}

impl TraceBatch {
    pub(super) fn clear(&mut self) {
        self.points.iter_mut().for_each(Vec::clear);
    }

    /// The points by coordinates.
    pub(super) fn planes(&mut self) -> &mut [Vec<f32>; 3] {
        &mut self.points
    }

    pub(super) fn push(&mut self, position: [f32; 3]) {
        for (plane, x) in self.points.iter_mut().zip(position) {
            plane.push(x);
        }
    }

    /// Evaluates the field at all points, which are in the region.
    pub(super) fn ask(&mut self, tracer: &Target, region: &Region) -> Result<(), EvalError> {
        self.field.resize(self.points[0].len(), 0.0);
        tracer.field.eval_region(region, self.points.each_ref().map(Vec::as_slice), &mut [&mut self.field])
    }
}
