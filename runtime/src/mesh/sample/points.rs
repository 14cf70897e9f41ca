//! The points of a brick that are evaluated together.

use std::error::Error;
use std::ops::Range;

use super::super::brick::Bricks;
use super::super::error::MeshError;
use super::class::{CLASSES, FOREIGN, SIDES, span};
use super::window::SampleWindow;
use crate::progress::Progress;

/// The points of a brick.
#[derive(Default)]
pub(super) struct BrickPoints {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Points that take little time: see [`Progress::paced`].
    at_once: usize,
    /// The indices of those that are needed, and the field there.
    chosen: Vec<u32>,
    found: Vec<f32>,
}

impl BrickPoints {
    /// The points that a brick owns, in the order of its values.
    pub(super) fn collect(&mut self, bricks: &Bricks, brick: usize, rim: &[u16; 27]) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        let axes: [&[f32]; 3] =
            [0, 1, 2].map(|axis| &bricks.axes[axis][origin[axis]..=origin[axis] + extent[axis]]);
        self.push([0, 1, 2].map(|axis| &axes[axis][..extent[axis]]));
        for class in SIDES.iter().flat_map(|(_, classes)| *classes).filter(|&&class| rim[class] != FOREIGN) {
            let kinds = CLASSES[*class].kinds;
            self.push([0, 1, 2].map(|axis| {
                let (first, count) = span(kinds[axis], extent[axis]);
                &axes[axis][first..first + count]
            }));
        }
    }

    /// The field at all points.
    pub(super) fn eval<E: Error + 'static>(
        &mut self,
        progress: &Progress<'_>,
        values: &mut [f32],
        ask: impl Fn([&[f32]; 3], &mut [f32]) -> Result<(), MeshError<E>>,
    ) -> Result<(), MeshError<E>> {
        let Self { x, y, z, at_once, .. } = self;
        progress.paced(x.len(), at_once, |some: Range<usize>| {
            ask([&x[some.clone()], &y[some.clone()], &z[some.clone()]], &mut values[some])
        })
    }

    /// The field at the points of a window; the others are outside.
    pub(super) fn eval_some<E: Error + 'static>(
        &mut self,
        (window, bricks): (SampleWindow, &Bricks),
        progress: &Progress<'_>,
        values: &mut [f32],
        ask: impl Fn([&[f32]; 3], &mut [f32]) -> Result<(), MeshError<E>>,
    ) -> Result<(), MeshError<E>> {
        window.choose(bricks, [&mut self.x, &mut self.y, &mut self.z], &mut self.chosen);
        let mut found = std::mem::take(&mut self.found);
        found.resize(self.chosen.len(), 0.0);
        let done = self.eval(progress, &mut found, ask);
        values.fill(f32::NEG_INFINITY);
        for (&index, &value) in self.chosen.iter().zip(&found) {
            values[index as usize] = value;
        }
        self.found = found;
        done
    }

    /// All points with these coordinates, x fastest, then y, then z.
    fn push(&mut self, [xs, ys, zs]: [&[f32]; 3]) {
        let layer = xs.len() * ys.len();
        self.x.extend_from_slice(xs);
        repeat(&mut self.x, xs.len(), ys.len() * zs.len());
        for &y in ys {
            self.y.resize(self.y.len() + xs.len(), y);
        }
        repeat(&mut self.y, layer, zs.len());
        for &z in zs {
            self.z.resize(self.z.len() + layer, z);
        }
    }
}

/// Repeats the last `length` numbers until they are there `times` times.
fn repeat(numbers: &mut Vec<f32>, length: usize, times: usize) {
    if length == 0 || times == 0 {
        numbers.truncate(numbers.len() - length);
        return;
    }
    let start = numbers.len() - length;
    let end = start + length * times;
    while numbers.len() < end {
        let more = (numbers.len() - start).min(end - numbers.len());
        numbers.extend_from_within(start..start + more);
    }
}

#[cfg(test)]
mod tests {
    use super::repeat;

    #[test]
    fn numbers_repeat() {
        let mut numbers = vec![9.0, 1.0, 2.0];
        repeat(&mut numbers, 2, 3);
        assert_eq!(numbers, [9.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0]);
        repeat(&mut numbers, 2, 0);
        assert_eq!(numbers, [9.0, 1.0, 2.0, 1.0, 2.0]);
    }
}
