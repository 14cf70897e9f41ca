//! Rays of the camera, and their hits.

use super::color::Rgb;
use super::error::RenderError;
use super::frame::Frame;
use super::material::SurfaceMaterial;
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
    pub material: SurfaceMaterial,
}

/// The hits of rays, and the cost of each ray.
pub struct Meetings {
    /// In the order of the rays, without the rays that hit nothing.
    pub met: Vec<CastHit>,
    /// For each ray, the number of distances to skeletons that were evaluated.
    pub evaluations: Vec<f32>,
}

/// The source of the surface's colour.
enum ColorSource {
    /// The same everywhere.
    Plain(Rgb),
    /// Planes of the samples: the first one, and how many, at most three.
    Planes(usize, usize),
}

/// Where samples have the paint and the material of a surface.
pub struct SurfacePaint {
    color: ColorSource,
    /// The planes of the attributes `rough`, `metal` and `glow`, if they are one real each.
    material: [Option<usize>; 3],
}

/// The largest glow that a picture tells from less.
const BRIGHTEST: f32 = 16.0;
/// The colour of models without colours: clay, as linear light.
const CLAY: Rgb = [0.60, 0.55, 0.50];

impl SurfacePaint {
    /// The paint of a model in a mode.
    pub fn new(frame: &Frame<'_>) -> Self {
        let group = match &frame.render.mode {
            RenderMode::Shaded if is_colored(frame.renderer.tree()) => "color",
            RenderMode::Shaded | RenderMode::Normal | RenderMode::Depth | RenderMode::Evaluations => "",
            RenderMode::Attribute(name) => name,
        };
        let layout = frame.renderer.evaluator.layout();
        let color = match layout.attribute(group) {
            Some((plane, width)) => ColorSource::Planes(plane, width.min(3)),
            None => ColorSource::Plain(CLAY),
        };
        let one = |name| layout.attribute(name).filter(|&(_, width)| width == 1).map(|(plane, _)| plane);
        Self { color, material: ["rough", "metal", "glow"].map(one) }
    }

    /// The paint and the material of a point: planes of answers, and the index of the point in them.
    pub fn at<P: AsRef<[f32]>>(&self, planes: &[P], index: usize) -> (Rgb, SurfaceMaterial) {
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let color = match self.color {
            ColorSource::Plain(color) => color,
            ColorSource::Planes(first, count) => [0, 1, 2].map(|channel| {
                if channel < count { finite(planes[first + channel].as_ref()[index]) } else { 0.0 }
            }),
        };
        let usual = SurfaceMaterial::default();
        let [rough, metal, glow] = [0, 1, 2].map(|part| {
            let usual = [usual.rough, usual.metal, usual.glow][part];
            self.material[part].map_or(usual, |plane| finite(planes[plane].as_ref()[index]))
        });
        let glow = glow.clamp(0.0, BRIGHTEST);
        (color, SurfaceMaterial { rough: rough.clamp(0.0, 1.0), metal: metal.clamp(0.0, 1.0), glow })
    }
}

/// Whether any part of a model has a colour.
fn is_colored(tree: &CheckedTree) -> bool {
    let color = tree.attributes().iter().find(|group| &*group.name == "color");
    let is_white = color.is_none_or(|color| color.default.iter().all(|&channel| channel == 1.0));
    let gives = |kind: &NodeKind| match kind {
        NodeKind::Attribute { name, .. } => &**name == "color",
        NodeKind::Particles(particles) => particles.values_of("color").is_some(),
        NodeKind::Primitive(_)
        | NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Constant { .. } => false,
    };
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
            let (color, material) = paint.at(hits.samples.planes(), hit);
            met.push(CastHit {
                cast,
                position: hits.positions.get(hit).map(f64::from),
                normal: normal(&hits.samples, hit, casts[cast].direction),
                paint: color,
                material,
            });
        }
    }
    met.sort_by_key(|met| met.cast);
    Ok(Meetings { met, evaluations })
}

/// The rays that begin inside of the solid: they hit the cut that the region makes.
pub fn cuts(
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
    let meet = |(index, &cast): (usize, &usize)| {
        let position = starts[cast].map(f64::from);
        let (color, material) = paint.at(&answers, index);
        CastHit { cast, position, normal: frame.side(position), paint: color, material }
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
