//! Gradients are finite at all points.
//!
//! A program multiplies a factor of 0 with what may have overflowed, far from all skeletons or where a
//! formula is held by a bound, and 0 times an infinity is NaN. No select in it looks out for that. Instead
//! all gradients are looked at when they are there:
//!
//! ```text
//! run the program
//! where a component is NaN, or beyond 2^100:    run the guarded program there, for the gradient alone
//! ```
//!
//! The guarded program has the same ops with guards between them, so it gives the same bits where nothing
//! overflows, and 0 for what is multiplied by 0 ([`jbt_ir::domain::tangent`]). Selects drop what they do not
//! choose, sums and products keep a NaN or an infinity: a gradient that is finite has met none. So a point's
//! answer depends neither on the points beside it nor on rows that are left out. It costs a comparison a
//! component, and nothing a row.

use std::sync::Arc;

use jbt_ir::domain::tangent::LARGEST_SLOPE;
use jbt_ir::memory::probe;
use jbt_ir::pass::GRADIENT_OUTPUTS;
use jbt_ir::{Selection, watch};

use crate::error::EvalError;
use crate::kernel::BoundKernel;

/// Whether components of gradients need no second look.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn are_tame(plane: &[f32]) -> bool {
    plane.chunks(1 << 12).all(|chunk| chunk.iter().fold(true, |all, g| all & (g.abs() <= LARGEST_SLOPE)))
}

impl BoundKernel {
    /// As [`run`](Self::run), for a kernel that answers at points: its gradients are finite, and within
    /// [`LARGEST_SLOPE`].
    pub(crate) fn run_with_finite_gradient(
        &self,
        selection: &Selection,
        points: &[&[f32]; 3],
        answers: &mut [&mut [f32]],
    ) -> Result<usize, EvalError> {
        let lanes = self.run(selection, points, answers)?;
        let outputs = &self.kernel.function.function().outputs;
        if outputs.get(1..4).is_none_or(|names| names != GRADIENT_OUTPUTS) {
            return Ok(lanes);
        }
        let gradient = &mut answers[1..4];
        if gradient.iter().all(|plane| are_tame(plane)) {
            return Ok(lanes);
        }
        // Places and answers of all points, at most. Few points are a rule, and few ask for little.
        probe(points[0].len() * (size_of::<usize>() + 7 * size_of::<f32>()))?;
        let wild = |&index: &usize| gradient.iter().any(|plane| !are_tame(&plane[index..=index]));
        let wild: Vec<usize> = (0..points[0].len()).filter(wild).collect();
        let Some(guarded) = self.guarded()? else {
            for plane in gradient {
                wild.iter().for_each(|&index| plane[index] = saturated(plane[index]));
            }
            return Ok(lanes);
        };
        let places = points.map(|plane| wild.iter().map(|&index| plane[index]).collect::<Vec<f32>>());
        let mut found = vec![vec![0.0; wild.len()]; 4];
        let mut planes: Vec<&mut [f32]> = found.iter_mut().map(Vec::as_mut_slice).collect();
        // It is never straight code, so it has other rows than straight code.
        let selection = if self.kernel.straight.is_some() { guarded.all() } else { selection };
        let more = guarded.run(selection, &places.each_ref().map(Vec::as_slice), &mut planes)?;
        for (plane, found) in gradient.iter_mut().zip(&found[1..]) {
            for (&index, &component) in wild.iter().zip(found) {
                plane[index] = component;
            }
        }
        Ok(lanes + more)
    }

    /// The guarded kernel with these numbers.
    fn guarded(&self) -> Result<Option<&Self>, EvalError> {
        let bind = || self.kernel.guarded().map(|kernel| Box::new(kernel.bind(Arc::clone(&self.lowered))));
        let made = match self.guarded.get() {
            Some(made) => made,
            None => watch::stoppable(|| self.guarded.get_or_init(bind))?,
        };
        Ok(made.as_deref())
    }
}

/// A component of a program that has no room for guards.
fn saturated(component: f32) -> f32 {
    if component.is_nan() { 0.0 } else { component.clamp(-LARGEST_SLOPE, LARGEST_SLOPE) }
}
