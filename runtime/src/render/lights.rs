//! Where light comes from: the lights of a camera, and the sky.

use super::camera::Camera;
use super::color::Rgb;
use super::vector::{Vector, add, dot, scale, unit};

/// The tangent of the angle that the key light's disc has to half: about 7 degrees.
pub const KEY_SPREAD: f64 = 0.12;

/// The sky at the horizon, and what a unit of height adds.
const HORIZON: Rgb = [0.215, 0.226, 0.245];
const HEIGHT: Rgb = [0.10, 0.118, 0.145];
/// Where light comes from: unit vectors towards it.
#[derive(Clone, Copy)]
pub struct Lights {
    pub key: Vector,
    pub fill: Vector,
}

impl Lights {
    /// The lights of a camera, for what is up in space.
    pub fn new(camera: &Camera, up: Vector) -> Self {
        // From below the lights are those of somebody who looks at a thing in the hand.
        let up = if dot(camera.back, up) < -0.3 { camera.up } else { up };
        let towards = |right: f64, high: f64, near: f64| {
            let sum = add(scale(camera.right, right), add(scale(up, high), scale(camera.back, near)));
            unit(sum).unwrap_or(camera.back)
        };
        Self { key: towards(-0.62, 0.92, 0.45), fill: towards(0.9, 0.15, 0.5) }
    }
}

/// The sky in a direction whose unit vector goes up so far, from -1 to 1.
pub fn sky(height: f64) -> Rgb {
    [0, 1, 2].map(|channel| HORIZON[channel] + HEIGHT[channel] * height as f32)
}

/// The mean of the sky over the hemisphere above a surface whose unit normal goes up so far, weighted with
/// the cosine: that of a linear function is its value at 2/3 of the normal.
pub fn sky_above(height: f64) -> Rgb {
    sky(height * 2.0 / 3.0)
}
