//! Shading: the lights, and the reflection by surfaces and the ground.
//!
//! All of it is linear. The key light is warm and comes over the viewer's left shoulder, a weak light from
//! the right fills its shadows, and the sky is brighter and bluer the higher it is.

use super::cast::CastHit;
use super::color::{Rgb, shoulder};
use super::error::RenderError;
use super::frame::Frame;
use super::gather::{Cost, Light, RayBudget, Spot, gather, spot, unshadowed};
use super::lights::{sky, sky_above};
use super::material::SurfaceMaterial;
use super::vector::{Vector, add, along, dot, length, scale, sub, unit};

/// The key light on a surface that faces it.
const KEY: Rgb = [0.92, 0.87, 0.79];
/// The fill light.
const FILL: Rgb = [0.06, 0.072, 0.095];
/// The part of the blocked light that reaches a place by reflection from the blocking surface.
const AGAIN: f32 = 0.35;
/// The brightness of the key light's highlight, for each unit of its exponent, and the largest one.
const SHINE: f32 = 0.16 / 58.0;
const BRIGHTEST_SHINE: f32 = 4.0;
/// The least roughness: a smoother surface would have a highlight smaller than a pixel.
const SMOOTHEST: f32 = 0.1;
/// By how many times a metal mirrors more of the key light, and of the sky, than a lacquer.
const METAL_SHINE: f32 = 2.0;
const METAL_SKY: f32 = 0.6;
/// The reflectance at normal incidence, and its increase towards grazing angles (Schlick, 1994).
const MIRROR: [f32; 2] = [0.03, 0.42];
/// The colour of shadows on the ground, and their largest opacity.
const SHADE: Rgb = [0.035, 0.04, 0.055];
const DEEPEST: f32 = 0.88;
/// The distances from the model's middle between which shadows on the ground fade, in radii.
const FADE: [f64; 2] = [1.3, 3.4];

/// The screen values of the hits of a tile: opaque colours. `pixel` and `sample` tell which ray sees a hit.
pub fn surfaces(
    frame: &Frame<'_>,
    met: &[CastHit],
    seen: impl Fn(&CastHit) -> ([u32; 2], u32, Vector),
) -> Result<(Vec<Rgb>, Cost), RenderError> {
    let spots: Vec<Spot> = met
        .iter()
        .map(|met| {
            let (pixel, sample, _) = seen(met);
            spot(frame, met.position, met.normal, pixel, sample)
        })
        .collect();
    let each = frame.render.quality.rays();
    let (lights, cost) = gather(frame, &spots, RayBudget { spot: each, pixel: rays_of_a_pixel(frame) })?;
    let colors = met.iter().zip(lights).map(|(met, light)| surface(frame, met, light, seen(met).2));
    Ok((colors.collect(), cost))
}

/// The screen values of a surface, seen along a unit vector.
pub fn surface(frame: &Frame<'_>, met: &CastHit, light: Light, looking: Vector) -> Rgb {
    let view = scale(looking, -1.0);
    let facing = dot(met.normal, view).clamp(0.0, 1.0);
    let fill = dot(met.normal, frame.lights.fill).max(0.0) as f32 * light.open;
    let half = unit(add(frame.lights.key, view)).map_or(0.0, |half| dot(half, met.normal).max(0.0));
    let SurfaceMaterial { rough, metal, glow } = met.material;
    let (exponent, brightness) = shine(rough);
    let shine = light.key * brightness * (half as f32).powf(exponent) * (1.0 + METAL_SHINE * metal);
    let mirrored = along(scale(met.normal, 2.0 * facing), -1.0, view);
    let grazing = (1.0 - facing).powi(5) as f32;
    let sharp = sky(dot(mirrored, frame.up).clamp(-1.0, 1.0));
    let boxes = soft_boxes(frame, mirrored, rough) * metal;
    let around = sky_above(dot(met.normal, frame.up));
    [0, 1, 2].map(|channel| {
        let paint = met.paint[channel].clamp(0.0, 1.0);
        let again = AGAIN * paint * (1.0 - light.open) * around[channel];
        let falling = KEY[channel] * light.facing + FILL[channel] * fill + light.sky[channel] + again;
        // A metal has no colour below its surface: what it mirrors is tinted instead.
        let plain = MIRROR[0] + MIRROR[1] * grazing;
        let mirror = plain + metal * (paint + (1.0 - paint) * grazing - plain);
        let reflection = (1.0 + METAL_SKY * metal) * sharp[channel] + boxes;
        let tint = 1.0 + metal * (paint - 1.0);
        let lit = paint * falling * (1.0 - metal) + tint * KEY[channel] * shine;
        shoulder(lit + mirror * light.open * reflection + glow * paint)
    })
}

/// The exponent and the brightness of the highlight on a surface of this roughness, after Blinn and Phong:
/// the narrower, the brighter.
fn shine(rough: f32) -> (f32, f32) {
    let exponent = 2.0 / rough.max(SMOOTHEST).powi(4) - 2.0;
    (exponent, (SHINE * (exponent + 2.0)).min(BRIGHTEST_SHINE))
}

/// The light of the studio's lamps that a metal mirrors in a direction: large soft boxes at the key light and
/// at the fill light.
fn soft_boxes(frame: &Frame<'_>, direction: Vector, rough: f32) -> f32 {
    let soft = 0.08 + 0.5 * f64::from(rough);
    let lamp = |towards: Vector, edge: f64| {
        let part = ((dot(direction, towards) - edge + soft) / (2.0 * soft)).clamp(0.0, 1.0);
        (part * part * (3.0 - 2.0 * part)) as f32
    };
    0.9 * lamp(frame.lights.key, 0.8) + 0.35 * lamp(frame.lights.fill, 0.85)
}

/// A place of the ground that a pixel sees.
pub struct GroundSpot {
    pub position: Vector,
    pub pixel: [u32; 2],
    pub sample: u32,
}

/// The shadows on the ground: red, green and blue, premultiplied by the opacity, which comes last.
pub fn shadows(frame: &Frame<'_>, places: &[GroundSpot]) -> Result<(Vec<[f32; 4]>, Cost), RenderError> {
    let spots: Vec<Spot> =
        places.iter().map(|place| spot(frame, place.position, frame.up, place.pixel, place.sample)).collect();
    let all = rays_of_a_pixel(frame);
    let (lights, cost) = gather(frame, &spots, RayBudget { spot: all, pixel: all })?;
    Ok((spots.iter().zip(&lights).map(|(spot, light)| shadow(frame, spot, light)).collect(), cost))
}

/// The numbers of rays of a pixel to the key light and to the sky, where each of its rays is lit on its own.
fn rays_of_a_pixel(frame: &Frame<'_>) -> [u32; 2] {
    let rays = frame.render.antialias * frame.render.antialias;
    frame.render.quality.rays().map(|count| count * rays)
}

/// The shadow at a spot of the ground that this light reaches.
pub fn shadow(frame: &Frame<'_>, spot: &Spot, light: &Light) -> [f32; 4] {
    let strength = |light: &Light| {
        let sum = |channel: usize| KEY[channel] * light.facing + light.sky[channel];
        sum(0) + sum(1) + sum(2)
    };
    let missing = 1.0 - strength(light) / strength(&unshadowed(frame, spot));
    let depth = DEEPEST * missing.clamp(0.0, 1.0) * fade(frame, spot.position);
    [SHADE[0] * depth, SHADE[1] * depth, SHADE[2] * depth, depth]
}

/// The remaining part of a shadow at a place: 1 near the model, 0 far away.
pub fn fade(frame: &Frame<'_>, position: Vector) -> f32 {
    let distance = length(sub(position, frame.middle)) / frame.radius;
    let part = ((FADE[1] - distance) / (FADE[1] - FADE[0])).clamp(0.0, 1.0);
    (part * part * (3.0 - 2.0 * part)) as f32
}
