//! Tiles: parts of a picture whose rays are traced together.

use std::time::{Duration, Instant};

use super::area::TileArea;
use super::cast::{Meetings, cast};
use super::develop::Gathered;
use super::error::RenderError;
use super::frame::Frame;
use super::report::Rays;
use super::settings::{Quality, RenderMode};
use super::shade::{GroundSpot, fade, shadows, surfaces};
use crate::span::span;
use crate::trace::Ray;

/// An exposed tile, or the sum of several: sums of pixels, and costs.
#[derive(Default)]
pub struct Tile {
    pub pixels: Vec<Gathered>,
    pub pixels_hit: u64,
    pub rays: Rays,
    pub evaluations: f64,
    pub trace: Duration,
    pub shade: Duration,
}

impl Tile {
    /// Adds the costs of another tile.
    pub fn add(&mut self, other: &Self) {
        self.pixels_hit += other.pixels_hit;
        self.rays.camera += other.rays.camera;
        self.rays.shadow += other.rays.shadow;
        self.rays.sky += other.rays.sky;
        self.evaluations += other.evaluations;
        self.trace += other.trace;
        self.shade += other.shade;
    }

    /// Divides a time between tracing and shading, by the times of all threads.
    pub fn shares(&self, time: Duration) -> [Duration; 2] {
        let sum = (self.trace + self.shade).as_secs_f64();
        let trace = if sum > 0.0 { time.mul_f64(self.trace.as_secs_f64() / sum) } else { time };
        [trace, time.saturating_sub(trace)]
    }
}

/// A camera ray: the index of its pixel in the tile, its index in the pixel, and its place in the picture, 0
/// .. 1.
#[derive(Clone, Copy)]
struct Aim {
    pixel: usize,
    sample: u32,
    place: [f64; 2],
    /// The index of its ray into the region, if it has one.
    cast: Option<usize>,
}

/// A tile that is being exposed.
struct Exposure<'a> {
    frame: &'a Frame<'a>,
    place: TileArea,
    aims: Vec<Aim>,
    /// The aim of each ray into the region.
    aim_of: Vec<usize>,
    tile: Tile,
}

/// Exposes a tile.
pub fn expose(frame: &Frame<'_>, place: &TileArea) -> Result<Tile, RenderError> {
    span!("tile");
    let begin = Instant::now();
    let (aims, casts) = aim(frame, place);
    let aim_of = (0..aims.len()).filter(|&aim| aims[aim].cast.is_some()).collect();
    let meetings = cast(frame, &casts)?;
    let mut exposure = Exposure { frame, place: *place, aims, aim_of, tile: Tile::default() };
    exposure.count(casts.len(), &meetings);
    exposure.tile.trace = begin.elapsed();
    let begin = Instant::now();
    match frame.render.mode {
        RenderMode::Shaded => exposure.light(&meetings, &casts)?,
        RenderMode::Normal | RenderMode::Depth | RenderMode::Attribute(_) => exposure.show(&meetings),
        RenderMode::Evaluations => exposure.charge(&meetings),
    }
    let each = 1.0 / (frame.render.antialias * frame.render.antialias) as f32;
    exposure.tile.pixels.iter_mut().for_each(|pixel| *pixel = pixel.map(|sum| sum * each));
    exposure.tile.shade = begin.elapsed();
    Ok(exposure.tile)
}

/// All rays of a tile, pixel by pixel, and those that go into the region.
fn aim(frame: &Frame<'_>, place: &TileArea) -> (Vec<Aim>, Vec<Ray>) {
    let ([width, height], rays) = (frame.render.size, frame.render.antialias);
    let (mut aims, mut casts) = (Vec::new(), Vec::new());
    for pixel in 0..(place.width * place.height) as usize {
        let [x, y] = place.pixel(pixel);
        for sample in 0..rays * rays {
            let at = |pixel: u32, part: u32, of: u32| {
                (f64::from(pixel) + (f64::from(part) + 0.5) / f64::from(rays)) / f64::from(of)
            };
            let place = [at(x, sample % rays, width), at(y, sample / rays, height)];
            let cast = frame.cast(place[0], place[1]);
            aims.push(Aim { pixel, sample, place, cast: cast.is_some().then_some(casts.len()) });
            casts.extend(cast);
        }
    }
    (aims, casts)
}

impl Exposure<'_> {
    /// Makes room for the pixels, and counts the camera's rays.
    fn count(&mut self, rays: usize, meetings: &Meetings) {
        let pixels = (self.place.width * self.place.height) as usize;
        let mut is_hit = vec![false; pixels];
        meetings.met.iter().for_each(|met| is_hit[self.aim(met.cast).pixel] = true);
        self.tile.pixels = vec![[0.0; 4]; pixels];
        self.tile.pixels_hit = is_hit.iter().filter(|&&hit| hit).count() as u64;
        self.tile.rays.camera = rays as u64;
        self.tile.evaluations = meetings.evaluations.iter().map(|&count| f64::from(count)).sum();
    }

    /// The aim of a ray into the region.
    fn aim(&self, cast: usize) -> Aim {
        self.aims[self.aim_of[cast]]
    }

    /// Adds the value of one ray to a pixel.
    fn add(&mut self, pixel: usize, seen: Gathered) {
        for (sum, seen) in self.tile.pixels[pixel].iter_mut().zip(seen) {
            *sum += seen;
        }
    }

    /// Adds the lit surface, and its shadow on the ground.
    fn light(&mut self, meetings: &Meetings, casts: &[Ray]) -> Result<(), RenderError> {
        let (place, frame) = (self.place, self.frame);
        let (colors, cost) = surfaces(frame, &meetings.met, |met| {
            let aim = self.aim(met.cast);
            (place.pixel(aim.pixel), aim.sample, casts[met.cast].direction)
        })?;
        self.tile.rays.shadow += cost.rays.shadow;
        self.tile.rays.sky += cost.rays.sky;
        self.tile.evaluations += cost.evaluations;
        for (met, [red, green, blue]) in meetings.met.iter().zip(colors) {
            self.add(self.aim(met.cast).pixel, [red, green, blue, 1.0]);
        }
        if frame.ground.is_some() && frame.render.quality != Quality::Draft {
            self.ground(meetings)?;
        }
        Ok(())
    }

    /// Adds shadows where there is no surface.
    fn ground(&mut self, meetings: &Meetings) -> Result<(), RenderError> {
        let mut is_met = vec![false; self.aim_of.len()];
        meetings.met.iter().for_each(|met| is_met[met.cast] = true);
        // One place stands for all rays of a pixel: shadows on the ground have no sharp rims.
        let (mut places, mut pixels): (Vec<GroundSpot>, Vec<(usize, f32)>) = (Vec::new(), Vec::new());
        for aim in self.aims.iter().filter(|aim| !aim.cast.is_some_and(|cast| is_met[cast])) {
            let Some(position) = self.frame.on_ground(aim.place[0], aim.place[1]) else { continue };
            if let Some((_, rays)) = pixels.last_mut().filter(|(pixel, _)| *pixel == aim.pixel) {
                *rays += 1.0;
            } else if fade(self.frame, position) > 0.0 {
                places.push(GroundSpot { position, pixel: self.place.pixel(aim.pixel), sample: 0 });
                pixels.push((aim.pixel, 1.0));
            }
        }
        let (shadows, cost) = shadows(self.frame, &places)?;
        self.tile.rays.shadow += cost.rays.shadow;
        self.tile.rays.sky += cost.rays.sky;
        self.tile.evaluations += cost.evaluations;
        for ((pixel, rays), shadow) in pixels.into_iter().zip(shadows) {
            self.add(pixel, shadow.map(|part| part * rays));
        }
        Ok(())
    }

    /// Adds a number or colour of the surface, without light.
    fn show(&mut self, meetings: &Meetings) {
        for met in &meetings.met {
            let [a, b, c] = match &self.frame.render.mode {
                RenderMode::Normal => met.normal.map(|x| (0.5 + 0.5 * x) as f32),
                RenderMode::Depth => [self.frame.camera.depth(met.position) as f32, 0.0, 0.0],
                RenderMode::Shaded | RenderMode::Attribute(_) | RenderMode::Evaluations => met.paint,
            };
            self.add(self.aim(met.cast).pixel, [a, b, c, 1.0]);
        }
    }

    /// Adds the evaluations of the rays: the sum of a pixel, for any number of rays.
    fn charge(&mut self, meetings: &Meetings) {
        let rays = (self.frame.render.antialias * self.frame.render.antialias) as f32;
        for aim in self.aims.clone() {
            let evaluations = aim.cast.map_or(0.0, |cast| meetings.evaluations[cast]);
            self.add(aim.pixel, [evaluations * rays, 0.0, 0.0, 1.0]);
        }
    }
}
