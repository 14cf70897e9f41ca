//! The lights of a camera, and the sky.

use super::camera::Camera;
use super::color::Rgb;
use super::vector::{Vector, add, dot, scale, unit};

/// The tangent of half the angle of the key light's disc: about 7 degrees.
pub const KEY_SPREAD: f64 = 0.12;

/// The sky at the horizon, and the increase per unit of height.
const HORIZON: Rgb = [0.215, 0.226, 0.245];
const HEIGHT: Rgb = [0.10, 0.118, 0.145];
/// Unit vectors towards the lights.
#[derive(Clone, Copy)]
pub struct Lights {
    pub key: Vector,
    pub fill: Vector,
}

impl Lights {
    /// The lights of a camera, with the direction that is up in space.
    pub fn new(camera: &Camera, up: Vector) -> Self {
        // A camera below the model has lights of its own up, as for a thing held in the hand.
        let up = if dot(camera.back, up) < -0.3 { camera.up } else { up };
        let towards = |right: f64, high: f64, near: f64| {
            let sum = add(scale(camera.right, right), add(scale(up, high), scale(camera.back, near)));
            unit(sum).unwrap_or(camera.back)
        };
        Self { key: towards(-0.62, 0.92, 0.45), fill: towards(0.9, 0.15, 0.5) }
    }
}

/// The sky in a direction; `height` is the unit vector's component along up, from -1 to 1.
pub fn sky(height: f64) -> Rgb {
    [0, 1, 2].map(|channel| HORIZON[channel] + HEIGHT[channel] * height as f32)
}

/// The mean of the sky over the hemisphere above a surface, weighted with the cosine; `height` is the unit
/// normal's component along up. For a linear function the mean is its value at 2/3 of the normal.
pub fn sky_above(height: f64) -> Rgb {
    sky(height * 2.0 / 3.0)
}
