//! Framing: the place of the camera, the tolerances, and the height of the ground.

use crate::parallel::*;

use super::camera::{Stance, View, is_usable};
use super::cast::cast;
use super::error::RenderError;
use super::frame::Frame;
use super::guide::{CoarseMesh, Guide};
use super::lights::Lights;
use super::renderer::Renderer;
use super::settings::{Quality, Render, RenderMode};
use super::telling::Telling;
use super::vector::{Vector, add, dot, length, scale, sub, tangents};
use crate::boxes::Box3;
use crate::solid::TightBounds;
use crate::span::span;
use crate::trace::Ray;

/// The tolerance of the bounds, as a part of the region's longest side: rays refine them.
const COARSE: f32 = 1.0 / 8.0;
/// Intervals between points along a side of a cut.
const CUT_POINTS: u32 = 32;
/// The number of rays along the longer side of the coarse picture that shows how the model fills a view.
const SCOUTS: u32 = 96;
/// Triangles of the mesh of a draft for each pixel of the picture, beyond which its cells are larger, and how
/// much larger at most.
const DRAFT_TRIANGLES: f64 = 0.15;
const DRAFT_COARSER: f64 = 2.0;
/// The nearest distance at which a pixel's size is measured, as a part of the model's radius.
const NEAREST: f64 = 0.02;
/// The resolution of f32, as a part of the size of coordinates.
const FINEST: f64 = 1e-6;

impl<'a> Frame<'a> {
    /// Frames the model. `None` if the model is empty.
    pub fn new(
        render: &'a Render,
        renderer: &'a Renderer,
        telling: &mut Telling<'_>,
    ) -> Result<Option<Self>, RenderError> {
        span!("frame");
        let Some(region) = render.looked_at(renderer.tree())? else { return Ok(None) };
        let tight = renderer.solid.tight_bounds(Some(region), COARSE * region.longest_side())?;
        let Some(bounds) = tight.outer else { return Ok(None) };
        let corners = corners(&bounds);
        let (low, high) = (bounds.low.map(f64::from), bounds.high.map(f64::from));
        let up = render.view.upwards(renderer.tree().orientation());
        let view = render.view.about(renderer.tree().origin());
        let camera = view.camera(render.aspect(), &corners, renderer.tree().orientation())?;
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
            guide: None,
        };
        let is_framed = matches!(render.view.stance, Stance::From(_));
        let coarse = if is_framed || frame.is_guided() || frame.may_have_ground() {
            CoarseMesh::new(renderer, &bounds, &mut |_| telling.tell(0.0))?
        } else {
            None
        };
        let places = coarse.as_ref().map(|coarse| frame.places(coarse, &tight)).transpose()?.flatten();
        if is_framed {
            match &places {
                Some(places) => {
                    frame.camera =
                        frame.view.camera(render.aspect(), places, renderer.tree().orientation())?;
                }
                None => frame.fit(&corners)?,
            }
        }
        // The mesh may be a cell away from the surface.
        let nearest = coarse.as_ref().zip(places.as_ref()).map(|(coarse, places)| {
            let depths = places.iter().map(|&place| frame.camera.depth(place));
            depths.fold(f64::INFINITY, f64::min) - coarse.cell
        });
        frame.set_tolerance(render.size[1], render.view.zoom, nearest)?;
        if let Some(coarse) = coarse.filter(|_| frame.is_guided()) {
            let cell = frame.guide_cell(&coarse);
            let is_lit = render.quality != Quality::Draft && render.mode == RenderMode::Shaded;
            frame.guide =
                Guide::new(renderer, (&bounds, &coarse), cell, (up, is_lit), &mut |part| telling.tell(part))?;
        }
        if frame.may_have_ground() {
            let lowest = match (&frame.guide, &places) {
                (Some(guide), Some(_)) if !guide.is_cut => guide.lowest,
                (_, Some(places)) => places.iter().map(|&place| dot(place, up)).fold(f64::INFINITY, f64::min),
                (_, None) => frame.lowest(&corners)?,
            };
            // The ground is visible only from above.
            frame.ground = Some(lowest).filter(|&height| dot(frame.camera.eye, up) > height);
        }
        frame.check_eye()?;
        Ok(Some(frame))
    }

    /// The edge of the cells of the mesh that guides rays.
    fn guide_cell(&self, coarse: &CoarseMesh) -> f64 {
        let cell = self.render.quality.cell() * self.pixel;
        if self.render.quality != Quality::Draft {
            return cell;
        }
        let pixels = self.render.size.map(f64::from).iter().product::<f64>();
        coarse.cell_for(DRAFT_TRIANGLES * pixels).clamp(cell, DRAFT_COARSER * cell)
    }

    /// Whether a mesh guides the rays of the picture.
    fn is_guided(&self) -> bool {
        match (self.render.quality, &self.render.mode) {
            (Quality::Best, _) | (_, RenderMode::Evaluations) => false,
            (Quality::Good, RenderMode::Shaded) => true,
            (Quality::Good, RenderMode::Normal | RenderMode::Depth | RenderMode::Attribute(_)) => false,
            (
                Quality::Draft,
                RenderMode::Shaded | RenderMode::Normal | RenderMode::Depth | RenderMode::Attribute(_),
            ) => true,
        }
    }

    fn may_have_ground(&self) -> bool {
        let Render { ground, mode, quality, .. } = self.render;
        *ground && *mode == RenderMode::Shaded && *quality != Quality::Draft
    }

    /// Places that reach as far as the model does: the vertices of a coarse mesh and, where the region cuts
    /// the model, points of the cut. `None` if the mesh misses a part that is known to be there.
    fn places(&self, coarse: &CoarseMesh, tight: &TightBounds) -> Result<Option<Vec<Vector>>, RenderError> {
        let mut places: Vec<Vector> =
            coarse.mesh.positions.iter().map(|position| position.map(f64::from)).collect();
        if coarse.is_cut {
            for axis in 0..3 {
                for side in [self.region.low[axis], self.region.high[axis]] {
                    self.push_cut(axis, side, &mut places)?;
                }
            }
        }
        let Some(inner) = tight.inner else { return Ok(Some(places).filter(|places| !places.is_empty())) };
        let reaches = |axis: usize| {
            let along = places.iter().map(|place| place[axis]);
            let [low, high] =
                along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            let margin = 2.0 * coarse.cell;
            low <= f64::from(inner.low[axis]) + margin && high >= f64::from(inner.high[axis]) - margin
        };
        Ok((0..3).all(reaches).then_some(places))
    }

    /// Adds the points of a lattice on a side of the region that are inside.
    fn push_cut(&self, axis: usize, side: f64, places: &mut Vec<Vector>) -> Result<(), RenderError> {
        let [across, along] = [(axis + 1) % 3, (axis + 2) % 3];
        let part = |axis: usize, index: u32| {
            let [low, high] = [self.region.low[axis], self.region.high[axis]];
            low + (high - low) * f64::from(index) / f64::from(CUT_POINTS)
        };
        let points: Vec<[f32; 3]> = (0..=CUT_POINTS)
            .flat_map(|row| (0..=CUT_POINTS).map(move |column| [column, row]))
            .map(|[column, row]| {
                let mut point = [side; 3];
                (point[across], point[along]) = (part(across, column), part(along, row));
                point.map(|x| x as f32)
            })
            .collect();
        let tracer = &self.renderer.tracer;
        if let Some((_, field)) = tracer.fields(&points)? {
            let inside = points.iter().zip(field).filter(|(_, value)| *value >= tracer.iso());
            places.extend(inside.map(|(point, _)| point.map(f64::from)));
        }
        Ok(())
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
        let rows: Vec<f64> = scatter(|watches| {
            (0..SCOUTS).into_par_iter().map(|row| watches.hold(|| scouted(row))).collect::<Result<_, _>>()
        })?;
        let lowest = rows.into_iter().fold(f64::INFINITY, f64::min);
        Ok(if lowest.is_finite() { lowest } else { bottom })
    }

    /// Moves the camera so that the visible part of the model fills the picture, found by a coarse picture of
    /// the whole model.
    fn fit(&mut self, corners: &[Vector]) -> Result<(), RenderError> {
        let view = View { zoom: 1.0, ..self.view };
        self.camera = view.camera(self.render.aspect(), corners, self.renderer.tree().orientation())?;
        self.set_tolerance(SCOUTS, 1.0, None)?;
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
        let seen: Vec<Vec<Vector>> = scatter(|watches| {
            (0..rows).into_par_iter().map(|row| watches.hold(|| scouted(row))).collect::<Result<_, _>>()
        })?;
        let seen = seen.concat();
        let points = if seen.is_empty() { corners } else { &seen };
        self.camera = self.view.camera(aspect, points, self.renderer.tree().orientation())?;
        Ok(())
    }

    /// Sets the size of a pixel at the near side of the model, and the tolerance for it. Where nobody knows
    /// the depth of the near side, it is that of the sphere around the model's bounds.
    fn set_tolerance(&mut self, rows: u32, zoom: f64, nearest: Option<f64>) -> Result<(), RenderError> {
        if !is_usable(&self.camera) {
            return Err(RenderError::Unusable);
        }
        let distance = if self.camera.orthographic {
            1.0
        } else {
            let sphere = self.camera.depth(self.middle) - self.radius;
            nearest.unwrap_or(sphere).max(sphere).max(NEAREST * self.radius / zoom.max(1.0))
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
