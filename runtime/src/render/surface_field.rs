//! The field of a model for a mesh of which nothing but the places of its vertices is asked.

use std::sync::atomic::{AtomicU64, Ordering};

use super::renderer::Renderer;
use crate::error::EvalError;
use crate::mesh::{Field, FieldWork};
use crate::prune::{Pruned, Pruner, Region};

/// The field of a renderer's model.
pub struct SurfaceField<'a> {
    renderer: &'a Renderer,
    evaluations: AtomicU64,
}

impl<'a> SurfaceField<'a> {
    pub fn new(renderer: &'a Renderer) -> Self {
        Self { renderer, evaluations: AtomicU64::new(0) }
    }

    /// The number of distances to skeletons that were evaluated at points.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }
}

impl Pruned for SurfaceField<'_> {
    fn pruner(&self) -> &Pruner {
        &self.renderer.pruner
    }
}

impl Field for SurfaceField<'_> {
    /// None: what is seen of a surface is evaluated where it is seen.
    fn attributes(&self) -> Vec<(String, usize)> {
        Vec::new()
    }

    fn work(&self, region: &Region) -> FieldWork {
        let field = &self.renderer.field;
        FieldWork { evaluations: field.evaluations_in(region), ops: field.ops_in(region) }
    }

    fn field(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
    ) -> Result<(), EvalError> {
        let each = self.renderer.field.evaluations_in(region);
        self.evaluations.fetch_add(each * x.len() as u64, Ordering::Relaxed);
        self.renderer.field.eval_region(region, [x, y, z], &mut [field])
    }

    /// A constant: vertices are not pulled, so nobody asks for gradients but to write normals, which nobody
    /// reads.
    fn gradient(
        &self,
        _region: &Region,
        _x: &[f32],
        _y: &[f32],
        _z: &[f32],
        field: &mut [f32],
        [gx, gy, gz]: [&mut [f32]; 3],
    ) -> Result<(), EvalError> {
        field.fill(self.renderer.tracer.iso());
        gx.fill(1.0);
        gy.fill(0.0);
        gz.fill(0.0);
        Ok(())
    }

    fn all(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        _attributes: &mut [&mut [f32]],
    ) -> Result<(), EvalError> {
        self.gradient(region, x, y, z, field, gradient)
    }
}
