//! Framing: the place of the camera, the tolerances, and the height of the ground.

use crate::parallel::*;

use super::camera::{Stance, View, is_usable};
use super::cast::cast;
use super::error::RenderError;
use super::frame::Frame;
use super::lights::Lights;
use super::renderer::Renderer;
use super::settings::{Quality, Render, RenderMode};
use super::vector::{Vector, add, dot, length, scale, sub, tangents};
use crate::boxes::Box3;
use crate::trace::Ray;

/// The tolerance of the bounds, as a part of the region's longest side: rays refine them.
const COARSE: f32 = 1.0 / 8.0;
/// The number of rays along the longer side of the coarse picture that shows how the model fills a view.
const SCOUTS: u32 = 96;
/// The nearest distance at which a pixel's size is measured, as a part of the model's radius.
const NEAREST: f64 = 0.02;
/// The resolution of f32, as a part of the size of coordinates.
const FINEST: f64 = 1e-6;

impl<'a> Frame<'a> {
    /// Frames the model. `None` if the model is empty.
    pub fn new(render: &'a Render, renderer: &'a Renderer) -> Result<Option<Self>, RenderError> {
        let Some(region) = render.looked_at(renderer.tree())? else { return Ok(None) };
        let tight = renderer.solid.tight_bounds(Some(region), COARSE * region.longest_side())?;
        let Some(bounds) = tight.outer else { return Ok(None) };
        let corners = corners(&bounds);
        let (low, high) = (bounds.low.map(f64::from), bounds.high.map(f64::from));
        let up = render.view.upwards();
        let with_ground =
            render.ground && render.mode == RenderMode::Shaded && render.quality != Quality::Draft;
        let view = render.view.about(renderer.tree().origin());
        let camera = view.camera(render.aspect(), &corners)?;
        let mut frame = Self {
            render,
            renderer,
            view,
            camera,
            region: region.map(|corner| corner.map(f64::from)),
            pixel: 0.0,
            tolerance: 0.0,
            middle: [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])),
            radius: 0.5 * length(sub(high, low)),
            up,
            ground: None,
            lights: Lights::new(&camera, up),
        };
        if let Stance::From(_) = render.view.stance {
            frame.fit(&corners)?;
        }
        frame.set_tolerance(render.size[1], render.view.zoom)?;
        if with_ground {
            // The ground is visible only from above.
            frame.ground = Some(frame.lowest(&corners)?).filter(|&height| dot(frame.camera.eye, up) > height);
        }
        frame.check_eye()?;
        Ok(Some(frame))
    }

    /// The lowest height of the model, found by a coarse picture from below.
    fn lowest(&self, corners: &[Vector]) -> Result<f64, RenderError> {
        let up = self.up;
        let [right, ahead] = tangents(up);
        let range = |axis: Vector| {
            let along = corners.iter().map(|&corner| dot(corner, axis));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let [[x0, x1], [y0, y1], [bottom, _]] = [right, ahead, up].map(range);
        let start = bottom - self.radius;
        let scouted = |row: u32| -> Result<f64, RenderError> {
            let at = |index: u32, low: f64, high: f64| {
                low + (high - low) * (f64::from(index) + 0.5) / f64::from(SCOUTS)
            };
            let rays: Vec<Ray> = (0..SCOUTS)
                .filter_map(|column| {
                    let place = add(scale(right, at(column, x0, x1)), scale(ahead, at(row, y0, y1)));
                    self.clip(add(place, scale(up, start)), up)
                })
                .collect();
            let met = cast(self, &rays)?.met;
            Ok(met.iter().map(|met| dot(met.position, up)).fold(f64::INFINITY, f64::min))
        };
        let rows: Vec<f64> = (0..SCOUTS).into_par_iter().map(scouted).collect::<Result<_, _>>()?;
        let lowest = rows.into_iter().fold(f64::INFINITY, f64::min);
        Ok(if lowest.is_finite() { lowest } else { bottom })
    }

    /// Moves the camera so that the visible part of the model fills the picture, found by a coarse picture of
    /// the whole model.
    fn fit(&mut self, corners: &[Vector]) -> Result<(), RenderError> {
        let view = View { zoom: 1.0, ..self.view };
        self.camera = view.camera(self.render.aspect(), corners)?;
        self.set_tolerance(SCOUTS, 1.0)?;
        let aspect = self.render.aspect();
        let [columns, rows] = [aspect.min(1.0), (1.0 / aspect).min(1.0)]
            .map(|part| ((f64::from(SCOUTS) * part).round() as u32).max(8));
        let scouted = |row: u32| -> Result<Vec<Vector>, RenderError> {
            let rays: Vec<Ray> = (0..columns)
                .filter_map(|column| {
                    let [x, y] = [(column, columns), (row, rows)]
                        .map(|(index, count)| (f64::from(index) + 0.5) / f64::from(count));
                    self.cast(x, y)
                })
                .collect();
            Ok(cast(self, &rays)?.met.iter().map(|met| met.position).collect())
        };
        let seen: Vec<Vec<Vector>> = (0..rows).into_par_iter().map(scouted).collect::<Result<_, _>>()?;
        let seen = seen.concat();
        let points = if seen.is_empty() { corners } else { &seen };
        self.camera = self.view.camera(aspect, points)?;
        Ok(())
    }

    /// Sets the size of a pixel at the near side of the model, and the tolerance for it.
    fn set_tolerance(&mut self, rows: u32, zoom: f64) -> Result<(), RenderError> {
        if !is_usable(&self.camera) {
            return Err(RenderError::Unusable);
        }
        let distance = if self.camera.orthographic {
            1.0
        } else {
            (self.camera.depth(self.middle) - self.radius).max(NEAREST * self.radius / zoom.max(1.0))
        };
        self.pixel = 2.0 * self.camera.half[1] * distance / f64::from(rows);
        let size =
            [self.region.low, self.region.high].iter().flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
        self.pixel = self.pixel.max(FINEST * size);
        // The places on rays must differ in f32.
        self.tolerance = (self.render.quality.fineness() * self.pixel).max(0.25 * FINEST * size);
        if self.tolerance.is_finite() { Ok(()) } else { Err(RenderError::Unusable) }
    }

    /// Whether the camera can see the surface from outside.
    fn check_eye(&self) -> Result<(), RenderError> {
        let eye = self.camera.eye;
        if self.region.contains(eye) {
            let value = self.renderer.evaluator.probe(eye.map(|x| x as f32)).value();
            if value >= self.renderer.tracer.iso() {
                return Err(RenderError::Inside { eye: self.seen_from().eye });
            }
        }
        Ok(())
    }
}

impl Render {
    /// The ratio of width to height.
    fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }
}

fn corners(bounds: &Box3) -> [Vector; 8] {
    std::array::from_fn(|corner| bounds.corner(corner).map(f64::from))
}
