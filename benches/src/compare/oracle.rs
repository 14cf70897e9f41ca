//! What the answers of all contestants have to be near to: the f64 oracle at some of the points.

use jbt::walk::{walk, walk_gradient};
use jbt::{CheckedTree, Points};

use crate::check::agree;

/// Points that are looked at.
const LOOKS: usize = 200;
/// Step of the oracle's differences, in f64.
const STEP: f64 = 1e-6;
/// A weaker field than this says nothing certain about the attributes in f32.
const WEAK: f32 = 1e-4;

/// How far answers may be off, relative to `1 + |expected|`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tolerance {
    /// Of the field.
    pub field: f32,
    /// Of the components of the gradient.
    pub gradient: f32,
    /// Of attributes.
    pub attributes: f32,
}

impl Tolerance {
    /// What f32 allows.
    pub const EXACT: Self = Self { field: 1e-4, gradient: 1e-3, attributes: 1e-3 };
    /// For gradients by differences: a step of 1/1024 is off by half of it times the second derivative, which
    /// is 6 / R^2 at most for a blob, so by up to 0.2 for the smallest of the blobs used here, where the
    /// slopes are above 2.
    pub const DIFFERENCES: Self = Self { gradient: 1e-1, ..Self::EXACT };
}

/// Expected answers at some of the points of a set.
pub struct Oracle {
    indices: Vec<usize>,
    /// Field, gradient, attribute channels: a plane each.
    planes: Vec<Vec<f32>>,
}

impl Oracle {
    /// Asks the oracle about some of the points, evenly spread over the list.
    #[must_use]
    pub fn new(tree: &CheckedTree, points: &Points) -> Self {
        let indices: Vec<usize> = (0..points.len()).step_by(points.len().div_ceil(LOOKS).max(1)).collect();
        let mut planes = Vec::new();
        for &index in &indices {
            let p = points.get(index).map(f64::from);
            let at = walk(tree, p);
            let gradient = walk_gradient(tree, p, STEP);
            let answers = [at.field].into_iter().chain(gradient).chain(at.attributes.into_iter().flatten());
            for (plane, answer) in answers.enumerate() {
                if planes.len() == plane {
                    planes.push(Vec::with_capacity(indices.len()));
                }
                planes[plane].push(answer as f32);
            }
        }
        Self { indices, planes }
    }

    /// Compares planes of answers at all points: the field, then perhaps the gradient, then perhaps the
    /// attributes.
    ///
    /// # Errors
    /// What is off first, in words.
    pub fn check(&self, planes: &[&[f32]], tolerance: Tolerance) -> Result<(), String> {
        for (number, (plane, expected)) in planes.iter().zip(&self.planes).enumerate() {
            let (name, tolerance) = match number {
                0 => ("the field", tolerance.field),
                1..=3 => ("the gradient", tolerance.gradient),
                _ => ("an attribute", tolerance.attributes),
            };
            let looked = |at: usize| number < 4 || self.planes[0][at] > WEAK;
            let (values, expected): (Vec<f32>, Vec<f32>) = (self.indices.iter().enumerate())
                .filter(|&(at, _)| looked(at))
                .map(|(at, &index)| (plane.get(index).copied().unwrap_or(f32::NAN), expected[at]))
                .unzip();
            agree(&values, &expected, tolerance).map_err(|error| format!("{name}: {error}"))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{blobs, cube, tree};
    use crate::naive::{Walker, separate};

    #[test]
    fn right_answers_pass_and_wrong_ones_are_named() {
        let (tree, points) = (tree(&blobs(20, 1)), cube(500, 2));
        let oracle = Oracle::new(&tree, &points);
        let mut planes = vec![vec![0.0; points.len()]; 7];
        let mut outs: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        separate(&Walker::new(&tree), points.planes(), &mut outs);
        let views: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
        assert_eq!(oracle.check(&views, Tolerance::DIFFERENCES), Ok(()));
        assert_eq!(oracle.check(&views[..1], Tolerance::EXACT), Ok(()));

        for (plane, name) in [(0, "the field"), (2, "the gradient"), (6, "an attribute")] {
            let mut wrong = planes.clone();
            wrong[plane].fill(17.0);
            let views: Vec<&[f32]> = wrong.iter().map(Vec::as_slice).collect();
            let error = oracle.check(&views, Tolerance::DIFFERENCES).expect_err("17 is wrong");
            assert!(error.starts_with(name), "{error}");
        }
        assert!(oracle.check(&[&planes[0][..10]], Tolerance::EXACT).is_err(), "answers are missing");
    }
}
