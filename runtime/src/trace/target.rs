//! A model, compiled for rays.

use std::sync::Arc;

use jbt_model::origin::ModelOrigin;

use super::ray::RayReach;
use crate::buffer::Layout;
use crate::evaluator::Evaluator;
use crate::prune::Pruner;

/// The kernels of a tracer.
pub(super) struct Target {
    /// The iso-value in f32, as kernels compare with it.
    pub(super) iso: f32,
    /// The origin of positions.
    pub(super) origin: ModelOrigin,
    /// The box outside of which the field is 0; `None` if it is 0 everywhere.
    pub(super) reach: Option<RayReach>,
    pub(super) pruner: Pruner,
    pub(super) field: Evaluator,
    /// The evaluator for hits; `None` if it is the evaluator of the field.
    pub(super) full: Option<Evaluator>,
    /// The layout of the samples of hits.
    pub(super) layout: Arc<Layout>,
}

impl Target {
    /// The evaluator for hits.
    pub(super) fn full(&self) -> &Evaluator {
        self.full.as_ref().unwrap_or(&self.field)
    }
}
