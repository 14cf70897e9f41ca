//! The light that reaches a place, from the key light and from the sky.
//!
//! ```text
//!      key light, a disc          each place sends some rays to the disc of the key light,
//!        \ | /      sky           and some into the hemisphere above it, more of them
//!         \|/    \  |  /          upright than flat: those that meet nothing bring light
//!    ──────o────────o──────
//! ```

use super::boxes::RayPart;
use super::cast::start;
use super::color::Rgb;
use super::error::RenderError;
use super::frame::Frame;
use super::lights::{KEY_SPREAD, sky, sky_above};
use super::noise::{Sequence, above, around};
use super::report::Rays;
use super::vector::{Vector, along, dot};
use crate::span::span;
use crate::trace::Ray;

/// A place to be lit.
pub struct Spot {
    /// A little above the surface.
    pub position: Vector,
    /// A unit vector.
    pub normal: Vector,
    /// The pixel that sees it: its column and row.
    pub pixel: [u32; 2],
    /// The index of the pixel's ray that sees it.
    pub sample: u32,
}

/// The light that reaches a spot.
#[derive(Clone, Copy)]
pub struct Light {
    /// The visible share of the key light's disc, from 0 to 1.
    pub key: f32,
    /// The same share, weighted with the cosine to the normal.
    pub facing: f32,
    /// The light of the sky: the mean over the hemisphere, weighted with the cosine.
    pub sky: Rgb,
    /// The visible share of the sky, from 0 to 1, weighted with the cosine.
    pub open: f32,
}

/// The cost of gathering.
#[derive(Default)]
pub struct Cost {
    pub rays: Rays,
    pub evaluations: f64,
}

/// The distance up to which things block the sky, as a part of the model's radius.
const REACH: f64 = 0.7;
/// The height above the surface where rays against a mesh begin, in cells.
const ABOVE: f64 = 0.3;
/// The depth below the mesh at which such a ray may still begin, in cells: the mesh is not quite the surface.
const BURIED: f64 = 0.75;

/// The numbers of rays to the key light and to the sky: of a spot, and of all spots of its pixel.
#[derive(Clone, Copy)]
pub struct RayBudget {
    pub spot: [u32; 2],
    pub pixel: [u32; 2],
}

/// The light that reaches spots.
pub fn gather(
    frame: &Frame<'_>,
    spots: &[Spot],
    budget: RayBudget,
) -> Result<(Vec<Light>, Cost), RenderError> {
    span!("light");
    let [key_rays, sky_rays] = budget.spot;
    let mut cost = Cost::default();
    let mut lights: Vec<Light> = spots.iter().map(|spot| unshadowed(frame, spot)).collect();
    if key_rays > 0 {
        add_key(frame, spots, [key_rays, budget.pixel[0]], &mut lights, &mut cost)?;
    }
    if sky_rays > 0 {
        add_sky(frame, spots, [sky_rays, budget.pixel[1]], &mut lights, &mut cost)?;
    }
    Ok((lights, cost))
}

/// The light of a place without shadows.
pub fn unshadowed(frame: &Frame<'_>, spot: &Spot) -> Light {
    Light {
        key: 1.0,
        facing: dot(spot.normal, frame.lights.key).max(0.0) as f32,
        sky: sky_above(dot(spot.normal, frame.up)),
        open: 1.0,
    }
}

/// A ray of a spot: its direction, and the ray, if anything that matters can block it.
type Sent = (Vector, Option<Ray>);

/// Sends `count` rays from each spot. The light of those that hit nothing arrives. Counts the rays by
/// `number`.
fn send(
    frame: &Frame<'_>,
    (spots, lights): (&[Spot], &mut [Light]),
    count: u32,
    aim: impl Fn(&Spot, u32) -> Sent,
    mut arrive: impl FnMut(&mut Light, &Spot, Vector),
    (evaluations, number): (&mut f64, &mut u64),
) -> Result<(), RenderError> {
    // All together: the more rays there are, the more of them are nearly parallel.
    let all = spots.len() * count as usize;
    let mut directions = Vec::with_capacity(all);
    let (mut rays, mut sent) = (Vec::with_capacity(all), Vec::with_capacity(all));
    for index in 0..count {
        for spot in spots {
            let (direction, ray) = aim(spot, spot.sample * count + index);
            if let Some(ray) = ray {
                sent.push(directions.len());
                rays.push(ray);
            }
            directions.push(direction);
        }
    }
    *number += rays.len() as u64;
    let mut is_blocked = vec![false; all];
    for (&at, blocked) in sent.iter().zip(blocked(frame, &rays, evaluations)?) {
        is_blocked[at] = blocked;
    }
    for (at, direction) in directions.iter().enumerate().filter(|&(at, _)| !is_blocked[at]) {
        let spot = at % spots.len();
        arrive(&mut lights[spot], &spots[spot], *direction);
    }
    Ok(())
}

fn add_key(
    frame: &Frame<'_>,
    spots: &[Spot],
    [count, length]: [u32; 2],
    lights: &mut [Light],
    cost: &mut Cost,
) -> Result<(), RenderError> {
    let each = 1.0 / count as f32;
    lights.iter_mut().for_each(|light| (light.key, light.facing) = (0.0, 0.0));
    let aim = |spot: &Spot, number: u32| {
        let point = Sequence::new(spot.pixel, 0, length).point(number);
        let direction = around(frame.lights.key, KEY_SPREAD, point);
        let faces = dot(spot.normal, direction) > 0.0;
        (direction, faces.then(|| frame.clip(spot.position, direction)).flatten())
    };
    let arrive = |light: &mut Light, spot: &Spot, direction: Vector| {
        let facing = dot(spot.normal, direction);
        if facing > 0.0 {
            light.key += each;
            light.facing += facing as f32 * each;
        }
    };
    send(frame, (spots, lights), count, aim, arrive, (&mut cost.evaluations, &mut cost.rays.shadow))
}

fn add_sky(
    frame: &Frame<'_>,
    spots: &[Spot],
    [count, length]: [u32; 2],
    lights: &mut [Light],
    cost: &mut Cost,
) -> Result<(), RenderError> {
    let each = 1.0 / count as f32;
    lights.iter_mut().for_each(|light| (light.sky, light.open) = ([0.0; 3], 0.0));
    let aim = |spot: &Spot, number: u32| {
        let direction = above(spot.normal, Sequence::new(spot.pixel, 1, length).point(number));
        // Near things darken more than far ones, because some rays are short.
        let [part, _] = Sequence::new(spot.pixel, 2, length).point(number);
        let reach = frame.radius * REACH * (0.1 + 0.9 * part);
        let ray = frame.clip(spot.position, direction).and_then(|mut ray| {
            ray.span[1] = ray.span[1].min(reach);
            (ray.span[0] < ray.span[1]).then_some(ray)
        });
        (direction, ray)
    };
    let arrive = |light: &mut Light, spot: &Spot, direction: Vector| {
        let open = open_ground(frame, spot.position, direction) as f32 * each;
        let color = sky(dot(direction, frame.up));
        light.sky = [0, 1, 2].map(|channel| light.sky[channel] + color[channel] * open);
        light.open += open;
    };
    send(frame, (spots, lights), count, aim, arrive, (&mut cost.evaluations, &mut cost.rays.sky))
}

/// The part of the light from a direction that the ground may block: the nearer the ground, the less.
fn open_ground(frame: &Frame<'_>, position: Vector, direction: Vector) -> f64 {
    let (Some(ground), falls) = (frame.ground, -dot(direction, frame.up)) else { return 1.0 };
    if falls <= 0.0 {
        return 1.0;
    }
    let way = (dot(position, frame.up) - ground).max(0.0) / falls;
    let part = (way / (frame.radius * REACH)).min(1.0);
    0.25 + 0.75 * part * (2.0 - part)
}

/// Directions are sorted by coordinates in steps of 1 / WAYS.
const WAYS: f64 = 4.0;

/// The approximate direction of a ray: rays of one direction stay close to each other, which makes packets
/// cheap.
fn way(ray: &Ray) -> [i8; 3] {
    ray.direction.map(|coordinate| (coordinate * WAYS).floor() as i8)
}

/// Which rays are blocked.
fn blocked(frame: &Frame<'_>, rays: &[Ray], evaluations: &mut f64) -> Result<Vec<bool>, RenderError> {
    let lit = frame.guide.as_ref().and_then(|guide| Some((guide.hierarchy.as_ref()?, guide.cell)));
    let mut blocked = match lit {
        Some((hierarchy, cell)) => {
            let segments: Vec<RayPart> = rays.iter().map(RayPart::of).collect();
            hierarchy.any_of(&segments, (BURIED * cell) as f32)
        }
        None => {
            let mut order: Vec<usize> = (0..rays.len()).collect();
            order.sort_by_key(|&ray| way(&rays[ray]));
            let sorted: Vec<Ray> = order.iter().map(|&ray| rays[ray]).collect();
            let found = frame.renderer.tracer.any_of_local(&sorted, frame.light_tolerance())?;
            *evaluations += found.evaluations.iter().map(|&evaluations| f64::from(evaluations)).sum::<f64>();
            let mut blocked = vec![false; rays.len()];
            order.iter().zip(found.blocked).for_each(|(&ray, is_blocked)| blocked[ray] = is_blocked);
            blocked
        }
    };
    add_cut(frame, rays, &mut blocked, evaluations)?;
    Ok(blocked)
}

/// Adds the rays that begin inside the solid, where the region cuts it: they may hit no surface.
fn add_cut(
    frame: &Frame<'_>,
    rays: &[Ray],
    blocked: &mut [bool],
    evaluations: &mut f64,
) -> Result<(), RenderError> {
    if frame.render.region.is_none() || frame.guide.as_ref().is_some_and(|guide| !guide.is_cut) {
        return Ok(());
    }
    let enter: Vec<usize> = (0..rays.len()).filter(|&ray| rays[ray].span[0] > 0.0).collect();
    let starts: Vec<[f32; 3]> = enter.iter().map(|&ray| start(&rays[ray])).collect();
    let tracer = &frame.renderer.tracer;
    let Some((region, field)) = tracer.fields(&starts)? else { return Ok(()) };
    *evaluations += (starts.len() as u64 * tracer.evaluations_in(&region)) as f64;
    for (&ray, &value) in enter.iter().zip(&field) {
        blocked[ray] |= value >= tracer.iso();
    }
    Ok(())
}

/// A spot a little above a place of the surface, so that its rays do not hit that place.
pub fn spot(frame: &Frame<'_>, position: Vector, normal: Vector, pixel: [u32; 2], sample: u32) -> Spot {
    let above = frame.guide.as_ref().map_or(frame.pixel, |guide| ABOVE * guide.cell);
    Spot { position: along(position, above, normal), normal, pixel, sample }
}
