//! A model as rays ask it: what they are aimed at.

use std::sync::Arc;

use jbt_model::origin::ModelOrigin;

use super::ray::Reach;
use crate::buffer::Layout;
use crate::evaluator::Evaluator;
use crate::prune::Pruner;

/// What answers on the way and at hits.
pub(super) struct Target {
    /// The iso-value as kernels compare with it.
    pub(super) iso: f32,
    /// Where positions count from.
    pub(super) origin: ModelOrigin,
    /// Where the field may differ from 0.
    pub(super) reach: Option<Reach>,
    pub(super) pruner: Pruner,
    pub(super) field: Evaluator,
    /// What is told about hits; `None` if it is the field alone.
    pub(super) full: Option<Evaluator>,
    /// Which plane of the samples of hits holds what.
    pub(super) layout: Arc<Layout>,
}

impl Target {
    /// What answers at hits.
    pub(super) fn full(&self) -> &Evaluator {
        self.full.as_ref().unwrap_or(&self.field)
    }
}
