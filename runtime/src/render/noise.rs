//! Directions that fill a cone or a hemisphere evenly: the same for a pixel in every run, others for the next pixel.

use super::vector::{Vector, add, scale, tangents};

/// The steps of the sequence R2: it fills the square evenly, whatever the number of points (Roberts, The Unreasonable Effectiveness of
/// Quasirandom Sequences, 2018). They are 1/p and 1/p^2 with p^3 = p + 1.
const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// Evenly spread points of the unit square for one pixel: a sequence, shifted as a whole by a number that depends on the pixel (Cranley and
/// Patterson, 1976), such that pixels next to each other differ as much as they can (interleaved gradient noise, Jimenez, 2014): then noise is fine.
#[derive(Clone, Copy)]
pub struct Sequence {
    shift: [f64; 2],
}

impl Sequence {
    /// The sequence of a pixel; `stream` tells apart what it is used for.
    pub fn new(pixel: [u32; 2], stream: u32) -> Self {
        // Far enough apart that neither the streams nor the axes look alike.
        let shift = |axis: u32| {
            let [x, y] = pixel.map(|at| f64::from(at) + 5.588_238 * f64::from(2 * stream + axis));
            (52.982_918_9 * (0.067_110_56 * x + 0.005_837_15 * y).fract()).fract()
        };
        Self { shift: [shift(0), shift(1)] }
    }

    /// A point of the unit square; its sides 1 do not belong to it.
    pub fn point(self, index: u32) -> [f64; 2] {
        let at = |axis: usize| (self.shift[axis] + f64::from(index) * STEPS[axis]).fract();
        [at(0), at(1)]
    }
}

/// A unit vector above a surface with this unit normal, as likely as the cosine of the angle to the normal, from a point of the unit square.
pub fn above(normal: Vector, [u, v]: [f64; 2]) -> Vector {
    let (radius, height) = (u.sqrt(), (1.0 - u).sqrt());
    add(across(normal, radius, v), scale(normal, height))
}

/// A vector about as long as this unit axis, within an angle of it whose tangent is `spread`, evenly spread.
pub fn around(axis: Vector, spread: f64, [u, v]: [f64; 2]) -> Vector {
    add(across(axis, spread * u.sqrt(), v), axis)
}

/// A vector of this length at a right angle to an axis; `turn` is the part of a full turn.
fn across(axis: Vector, length: f64, turn: f64) -> Vector {
    let [s, t] = tangents(axis);
    let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
    add(scale(s, length * cosine), scale(t, length * sine))
}

#[cfg(test)]
mod tests {
    use super::super::vector::{dot, length};
    use super::*;

    /// The mean of the cosine over directions weighted by it is 2/3.
    #[test]
    fn directions_above_a_surface() {
        let normal = [0.6, 0.0, -0.8];
        let sequence = Sequence::new([17, 4], 1);
        let count = 1000;
        let mut mean = 0.0;
        for index in 0..count {
            let direction = above(normal, sequence.point(index));
            assert!((length(direction) - 1.0).abs() < 1e-12);
            assert!(dot(direction, normal) > 0.0);
            mean += dot(direction, normal) / f64::from(count);
        }
        assert!((mean - 2.0 / 3.0).abs() < 0.005, "{mean}");
    }

    #[test]
    fn directions_in_a_cone() {
        let axis = [0.0, 1.0, 0.0];
        for index in 0..100 {
            let direction = around(axis, 0.1, Sequence::new([index, 0], 0).point(index));
            assert!((direction[1] - 1.0).abs() < 1e-12);
            assert!(direction[0].hypot(direction[2]) < 0.1);
        }
    }

    #[test]
    fn pixels_and_streams_differ() {
        let first = |pixel, stream| Sequence::new(pixel, stream).point(0);
        assert_ne!(first([0, 0], 0), first([1, 0], 0));
        assert_ne!(first([0, 1], 0), first([1, 0], 0));
        assert_ne!(first([0, 0], 0), first([0, 0], 1));
    }
}
