//! A field for tests of single steps of the mesher.

use std::convert::Infallible;

use super::field::{Field, FieldWork};
use crate::boxes::{Box3, Divisible};

/// A field without attributes, given by its value at a point and its range in a box. Its gradient is 0.
pub(super) struct PlainField {
    pub(super) value: fn([f32; 3]) -> f32,
    pub(super) range: fn(&Box3) -> [f32; 2],
}

impl Divisible for PlainField {
    type Error = Infallible;
    type Region = ();

    fn region(&self, _: Box3) -> Result<(), Infallible> {
        Ok(())
    }

    fn ranges(&self, (): &(), boxes: &[Box3], ranges: &mut [[f32; 2]]) -> Result<(), Infallible> {
        ranges.iter_mut().zip(boxes).for_each(|(range, bounds)| *range = (self.range)(bounds));
        Ok(())
    }

    fn narrow(&self, (): &(), boxes: &[Box3], parts: &mut Vec<()>) -> Result<(), Infallible> {
        parts.resize(parts.len() + boxes.len(), ());
        Ok(())
    }
}

impl Field for PlainField {
    fn attributes(&self) -> Vec<(String, usize)> {
        Vec::new()
    }

    fn work(&self, (): &()) -> FieldWork {
        FieldWork::default()
    }

    fn field(&self, (): &(), x: &[f32], y: &[f32], z: &[f32], field: &mut [f32]) -> Result<(), Infallible> {
        for (n, value) in field.iter_mut().enumerate() {
            *value = (self.value)([x[n], y[n], z[n]]);
        }
        Ok(())
    }

    fn gradient(
        &self,
        region: &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
    ) -> Result<(), Infallible> {
        gradient.into_iter().for_each(|plane| plane.fill(0.0));
        self.field(region, x, y, z, field)
    }

    fn all(
        &self,
        region: &(),
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        gradient: [&mut [f32]; 3],
        _: &mut [&mut [f32]],
    ) -> Result<(), Infallible> {
        self.gradient(region, x, y, z, field, gradient)
    }
}
