//! Rays of the camera that a mesh leads to the surface.
//!
//! ```text
//!  eye ──────────────────────x──────                       x  the ray meets the mesh
//!                           ·│ f, g                        Newton's steps along the ray, by the field and
//!                          · o──                           its gradient, lead to o, where the field is iso
//! ```
//!
//! Rays whose steps do not end near a place of the surface are traced exactly.

use super::cast::{CastHit, Meetings, SurfacePaint, cast, cuts};
use super::color::Rgb;
use super::error::RenderError;
use super::frame::Frame;
use super::guide::Guide;
use super::material::SurfaceMaterial;
use super::raster::MeshMeeting;
use super::settings::Quality;
use super::vector::{Vector, along, cross, dot, scale, sub, unit};
use crate::boxes::{Box3, Divisible as _, MAX_PARTS};
use crate::prune::Region;
use crate::span::span;
use crate::trace::Ray;

/// Rays whose answers are evaluated together, in a region of their own. Neighbours in a list of rays are
/// neighbours in the picture.
const TOGETHER: usize = 64;
/// The longest way from the mesh to the surface, in cells of the mesh.
const FARTHEST: f64 = 2.0;

/// A ray on its way to the surface.
struct Approach {
    cast: usize,
    t: f64,
    /// The way from the mesh, along the ray.
    way: f64,
    /// The triangle that the ray meets.
    triangle: u32,
}

/// Finds the first hits of rays, led by where they meet a mesh. Directions are unit vectors.
pub fn look(
    frame: &Frame<'_>,
    guide: &Guide,
    casts: &[Ray],
    meetings: &[Option<MeshMeeting>],
) -> Result<Meetings, RenderError> {
    span!("look");
    let paint = SurfacePaint::new(frame);
    let mut evaluations = vec![0.0; casts.len()];
    let mut met = if guide.is_cut { cuts(frame, casts, &paint, &mut evaluations)? } else { Vec::new() };
    let mut is_cut = vec![false; casts.len()];
    met.iter().for_each(|met| is_cut[met.cast] = true);
    let mut approaches: Vec<Approach> = Vec::new();
    for (cast, (ray, meeting)) in casts.iter().zip(meetings).enumerate() {
        if let (Some(meeting), false) = (meeting, is_cut[cast]) {
            let t = meeting.distance.clamp(ray.span[0], ray.span[1]);
            approaches.push(Approach { cast, t, way: 0.0, triangle: meeting.triangle });
        }
    }
    let steps = if frame.render.quality == Quality::Draft { 1 } else { 2 };
    let mut lost = Vec::new();
    for step in 1..=steps {
        let sight = Sight { frame, guide, casts, paint: &paint, is_last: step == steps };
        sight.approach(&mut approaches, (&mut met, &mut lost), &mut evaluations)?;
    }
    if !lost.is_empty() {
        let rays: Vec<Ray> = lost.iter().map(|&ray| casts[ray]).collect();
        let found = cast(frame, &rays)?;
        lost.iter().zip(&found.evaluations).for_each(|(&ray, cost)| evaluations[ray] += cost);
        met.extend(found.met.into_iter().map(|hit| CastHit { cast: lost[hit.cast], ..hit }));
    }
    met.sort_by_key(|met| met.cast);
    Ok(Meetings { met, evaluations })
}

/// What a step needs to know.
struct Sight<'a> {
    frame: &'a Frame<'a>,
    guide: &'a Guide,
    casts: &'a [Ray],
    paint: &'a SurfacePaint,
    is_last: bool,
}

impl Sight<'_> {
    /// Takes one step with each ray. After the last one, those that are there have met the surface, and the
    /// others are lost.
    fn approach(
        &self,
        approaches: &mut [Approach],
        (met, lost): (&mut Vec<CastHit>, &mut Vec<usize>),
        evaluations: &mut [f32],
    ) -> Result<(), RenderError> {
        let place = |approach: &Approach| {
            let ray = &self.casts[approach.cast];
            along(ray.origin, approach.t, ray.direction).map(|x| x as f32)
        };
        let points: Vec<[f32; 3]> = approaches.iter().map(place).collect();
        let regions = self.regions(&points)?;
        let evaluator = &self.frame.renderer.evaluator;
        let mut planes = vec![vec![0.0; TOGETHER]; evaluator.layout().names().len()];
        let mut at = [[0.0; TOGETHER]; 3];
        for ((region, points), some) in
            regions.iter().zip(points.chunks(TOGETHER)).zip(approaches.chunks_mut(TOGETHER))
        {
            let count = points.len();
            for (index, point) in points.iter().enumerate() {
                (0..3).for_each(|axis| at[axis][index] = point[axis]);
            }
            let mut answers: Vec<&mut [f32]> = planes.iter_mut().map(|plane| &mut plane[..count]).collect();
            evaluator.eval_region(region, at.each_ref().map(|axis| &axis[..count]), &mut answers)?;
            let each = evaluator.evaluations_in(region) as f32;
            for (index, approach) in some.iter_mut().enumerate() {
                evaluations[approach.cast] += each;
                let gradient = [1, 2, 3].map(|plane| f64::from(planes[plane][index]));
                let is_near = self.step(approach, f64::from(planes[0][index]), gradient);
                if !self.is_last {
                    continue;
                }
                let is_draft = self.frame.render.quality == Quality::Draft;
                if is_near || is_draft {
                    met.push(self.meet(approach, is_near, gradient, self.paint.at(&planes, index)));
                } else {
                    lost.push(approach.cast);
                }
            }
        }
        Ok(())
    }

    /// Newton's step along a ray. Whether it leads to the surface; if not, the ray stays where it is.
    fn step(&self, approach: &mut Approach, field: f64, gradient: Vector) -> bool {
        let ray = &self.casts[approach.cast];
        let slope = dot(gradient, ray.direction);
        let step = (f64::from(self.frame.renderer.tracer.iso()) - field) / slope;
        let way = approach.way + step;
        let longest = if self.is_last && self.frame.render.quality != Quality::Draft {
            self.frame.tolerance
        } else {
            FARTHEST * self.guide.cell
        };
        // A slope of 0 and one that is not finite lead nowhere: comparisons with NaN are false.
        let leads = slope > 0.0 && step.abs() <= longest && way.abs() <= FARTHEST * self.guide.cell;
        if leads {
            approach.t = (approach.t + step).clamp(ray.span[0], ray.span[1]);
            approach.way = way;
        }
        leads
    }

    fn meet(
        &self,
        approach: &Approach,
        is_near: bool,
        gradient: Vector,
        (paint, material): (Rgb, SurfaceMaterial),
    ) -> CastHit {
        let ray = &self.casts[approach.cast];
        let outwards = if is_near { unit(scale(gradient, -1.0)) } else { None };
        CastHit {
            cast: approach.cast,
            position: along(ray.origin, approach.t, ray.direction),
            normal: outwards.unwrap_or_else(|| self.normal(approach)),
            paint,
            material,
        }
    }

    /// The normal of the mesh, where the field has none.
    fn normal(&self, approach: &Approach) -> Vector {
        let mesh = &self.guide.mesh;
        let corners = mesh.triangles[approach.triangle as usize];
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize].map(f64::from));
        let outwards = unit(cross(sub(b, a), sub(c, a)));
        outwards.unwrap_or_else(|| scale(self.casts[approach.cast].direction, -1.0))
    }

    /// The regions of each [`TOGETHER`] points.
    fn regions(&self, points: &[[f32; 3]]) -> Result<Vec<Region>, RenderError> {
        let pruner = &self.frame.renderer.pruner;
        let mut regions = Vec::new();
        let Some(all) = Box3::around(points) else { return Ok(regions) };
        let whole = pruner.region(all)?;
        let boxes: Vec<Box3> = points.chunks(TOGETHER).filter_map(Box3::around).collect();
        for some in boxes.chunks(MAX_PARTS) {
            pruner.narrow(&whole, some, &mut regions)?;
        }
        Ok(regions)
    }
}
