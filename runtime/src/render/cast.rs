//! Rays of the camera, and their hits.

use super::color::Rgb;
use super::error::RenderError;
use super::frame::Frame;
use super::settings::RenderMode;
use super::vector::{Vector, along, scale, unit};
use crate::buffer::Samples;
use crate::trace::Ray;
use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;

/// A hit of a ray.
pub struct CastHit {
    /// The index of the ray.
    pub cast: usize,
    /// Relative to the model's origin.
    pub position: Vector,
    /// The unit normal, away from the inside.
    pub normal: Vector,
    /// The mode's value at the hit: the colour, or the attribute. Finite.
    pub paint: Rgb,
}

/// The hits of rays, and the cost of each ray.
pub struct Meetings {
    /// In the order of the rays, without the rays that hit nothing.
    pub met: Vec<CastHit>,
    /// For each ray, the number of distances to skeletons that were evaluated.
    pub evaluations: Vec<f32>,
}

/// The source of the surface's colour.
pub enum SurfacePaint {
    /// The same everywhere.
    Plain(Rgb),
    /// Planes of the samples: the first one, and how many, at most three.
    Planes(usize, usize),
}

/// The colour of models without colours: clay, as linear light.
const CLAY: Rgb = [0.60, 0.55, 0.50];

impl SurfacePaint {
    /// The paint of a model in a mode.
    fn new(frame: &Frame<'_>) -> Self {
        let group = match &frame.render.mode {
            RenderMode::Shaded if is_colored(frame.renderer.tree()) => "color",
            RenderMode::Shaded | RenderMode::Normal | RenderMode::Depth | RenderMode::Evaluations => {
                return Self::Plain(CLAY);
            }
            RenderMode::Attribute(name) => name,
        };
        match frame.renderer.evaluator.layout().attribute(group) {
            Some((plane, width)) => Self::Planes(plane, width.min(3)),
            None => Self::Plain(CLAY),
        }
    }

    fn at(&self, samples: &Samples, index: usize) -> Rgb {
        match *self {
            Self::Plain(color) => color,
            Self::Planes(first, count) => [0, 1, 2].map(|channel| {
                let value = if channel < count { samples.planes()[first + channel][index] } else { 0.0 };
                if value.is_finite() { value } else { 0.0 }
            }),
        }
    }
}

/// Whether any part of a model has a colour.
fn is_colored(tree: &CheckedTree) -> bool {
    let is_white = tree.attributes()[0].default.iter().all(|&channel| channel == 1.0);
    let gives = |kind: &NodeKind| matches!(kind, NodeKind::Attribute { name, .. } if &**name == "color");
    !is_white || tree.nodes().iter().any(|node| gives(&node.kind))
}

/// Finds the first hits of rays.
pub fn cast(frame: &Frame<'_>, casts: &[Ray]) -> Result<Meetings, RenderError> {
    let paint = SurfacePaint::new(frame);
    let mut evaluations = vec![0.0; casts.len()];
    let mut met = if frame.render.region.is_some() {
        cuts(frame, casts, &paint, &mut evaluations)?
    } else {
        Vec::new()
    };
    let mut is_cut = vec![false; casts.len()];
    met.iter().for_each(|met| is_cut[met.cast] = true);
    let open: Vec<usize> = (0..casts.len()).filter(|&cast| !is_cut[cast]).collect();
    let rays: Vec<Ray> = open.iter().map(|&cast| casts[cast]).collect();
    let stride = frame.render.quality.stride();
    let hits = frame.renderer.tracer.first_of_local(&rays, frame.tolerance, stride)?;
    for (ray, &cast) in open.iter().enumerate() {
        evaluations[cast] += hits.evaluations[ray];
        let hit = hits.starts[ray] as usize;
        if hit < hits.starts[ray + 1] as usize {
            met.push(CastHit {
                cast,
                position: hits.positions.get(hit).map(f64::from),
                normal: normal(&hits.samples, hit, casts[cast].direction),
                paint: paint.at(&hits.samples, hit),
            });
        }
    }
    met.sort_by_key(|met| met.cast);
    Ok(Meetings { met, evaluations })
}

/// The rays that begin inside of the solid: they hit the cut that the region makes.
fn cuts(
    frame: &Frame<'_>,
    casts: &[Ray],
    paint: &SurfacePaint,
    evaluations: &mut [f32],
) -> Result<Vec<CastHit>, RenderError> {
    let tracer = &frame.renderer.tracer;
    let starts: Vec<[f32; 3]> = casts.iter().map(start).collect();
    let Some((region, field)) = tracer.fields(&starts)? else { return Ok(Vec::new()) };
    evaluations.fill(tracer.evaluations_in(&region) as f32);
    let inside: Vec<usize> = (0..casts.len()).filter(|&cast| field[cast] >= tracer.iso()).collect();
    if inside.is_empty() {
        return Ok(Vec::new());
    }
    let evaluator = &frame.renderer.evaluator;
    let points = [0, 1, 2].map(|axis| inside.iter().map(|&cast| starts[cast][axis]).collect::<Vec<f32>>());
    let mut answers = vec![vec![0.0; inside.len()]; evaluator.layout().names().len()];
    let mut full: Vec<&mut [f32]> = answers.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.eval_region(&region, points.each_ref().map(Vec::as_slice), &mut full)?;
    let each = evaluator.evaluations_in(&region) as f32;
    inside.iter().for_each(|&cast| evaluations[cast] += each);
    let samples = Samples::from_planes(evaluator.layout().clone(), answers);
    let meet = |(index, &cast): (usize, &usize)| {
        let position = starts[cast].map(f64::from);
        CastHit { cast, position, normal: frame.side(position), paint: paint.at(&samples, index) }
    };
    Ok(inside.iter().enumerate().map(meet).collect())
}

/// The start of a ray.
pub fn start(ray: &Ray) -> [f32; 3] {
    along(ray.origin, ray.span[0], ray.direction).map(|x| x as f32)
}

/// The unit normal of a hit; where the gradient vanishes, it is opposite to the ray.
fn normal(samples: &Samples, hit: usize, direction: Vector) -> Vector {
    let gradient = samples.gradient().map(|gradient| gradient.map(|plane| -f64::from(plane[hit])));
    gradient.and_then(unit).unwrap_or_else(|| scale(direction, -1.0))
}
