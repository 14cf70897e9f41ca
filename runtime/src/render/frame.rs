//! Data that all tiles of a picture share: the camera, the region, the ground, and the tolerances.

use super::camera::{Camera, View};
use super::guide::Guide;
use super::lights::Lights;
use super::renderer::Renderer;
use super::settings::Render;
use super::vector::{Vector, along, dot, scale, sub, unit};
use crate::boxes::Box3;
use crate::trace::Ray;

/// A picture that can be exposed. All coordinates are relative to the model's origin.
pub struct Frame<'a> {
    pub render: &'a Render,
    pub renderer: &'a Renderer,
    pub view: View,
    pub camera: Camera,
    /// The region of the picture: rays end at its sides.
    pub region: Box3<f64>,
    /// The side of a pixel, at the near side of the model.
    pub pixel: f64,
    /// Parts thinner than this along a camera ray may be missed; hits are accurate to a small fraction of it.
    pub tolerance: f64,
    /// The middle of the model, and half the diagonal of its bounds.
    pub middle: Vector,
    pub radius: f64,
    /// The direction that is up in space.
    pub up: Vector,
    /// The height of the ground along `up`, if there is ground.
    pub ground: Option<f64>,
    pub lights: Lights,
    /// The mesh that light meets, and that leads the eye; `None` where rays are exact.
    pub guide: Option<Guide>,
}

impl Frame<'_> {
    /// The tolerance of rays to the light and the sky.
    pub fn light_tolerance(&self) -> f64 {
        self.render.quality.softness() * self.pixel
    }

    /// The side of a pixel at a point.
    pub fn footprint(&self, point: Vector) -> f64 {
        let distance = if self.camera.orthographic { 1.0 } else { self.camera.depth(point).abs() };
        2.0 * self.camera.half[1] * distance / f64::from(self.render.size[1])
    }

    /// The unit vector from the eye to a point.
    pub fn looking(&self, point: Vector) -> Vector {
        let straight = scale(self.camera.back, -1.0);
        if self.camera.orthographic {
            straight
        } else {
            unit(sub(point, self.camera.eye)).unwrap_or(straight)
        }
    }

    /// The camera in the world.
    pub fn seen_from(&self) -> Camera {
        Camera { eye: self.renderer.tree().origin().world(self.camera.eye), ..self.camera }
    }

    /// The part of a picture point's ray inside the region; `None` if there is none.
    pub fn cast(&self, x: f64, y: f64) -> Option<Ray> {
        let (origin, direction) = self.camera.ray(x, y);
        self.clip(origin, direction)
    }

    /// The part of a ray with a unit direction inside the region; `None` if there is none.
    pub fn clip(&self, origin: Vector, direction: Vector) -> Option<Ray> {
        let mut span = [0.0, f64::MAX];
        for axis in 0..3 {
            let [low, high] = [self.region.low, self.region.high].map(|corner| corner[axis] - origin[axis]);
            if direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let ends = [low / direction[axis], high / direction[axis]];
            span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
        }
        (span[0] < span[1]).then_some(Ray { origin, direction, span })
    }

    /// The outward normal of the region's side that is nearest to a point.
    pub fn side(&self, point: Vector) -> Vector {
        let mut best = (f64::INFINITY, [0.0; 3]);
        for axis in 0..3 {
            for (corner, outwards) in [(self.region.low, -1.0), (self.region.high, 1.0)] {
                let distance = (point[axis] - corner[axis]).abs();
                if distance < best.0 {
                    let mut normal = [0.0; 3];
                    normal[axis] = outwards;
                    best = (distance, normal);
                }
            }
        }
        best.1
    }

    /// The intersection of a camera ray with the ground.
    pub fn on_ground(&self, x: f64, y: f64) -> Option<Vector> {
        let height = self.ground?;
        let (origin, direction) = self.camera.ray(x, y);
        let t = (height - dot(origin, self.up)) / dot(direction, self.up);
        (t > 0.0 && t.is_finite()).then(|| along(origin, t, direction))
    }
}
