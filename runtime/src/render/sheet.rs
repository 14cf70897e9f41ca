//! Pictures by way of a mesh: what each pixel sees, the light there, and more rays where neighbours differ.
//!
//! ```text
//! look    one ray a pixel, led by the mesh; some exact rays watch out for what the mesh has missed
//! sharpen exact rays where what is seen breaks off
//! gather  rays from each pixel to the key light and the sky, against the mesh
//! smooth  light of neighbours that see the same surface
//! edges   where neighbours differ, more rays for the pixel; they take the light of the pixels around them
//! ```
//!
//! A large picture is made in bands of rows, with some rows more on both sides than are kept.

use std::time::Instant;

use super::area::TileArea;
use super::cast::{Meetings, cast};
use super::develop::Gathered;
use super::error::RenderError;
use super::frame::Frame;
use super::gather::{Light, RayBudget, Spot, gather, unshadowed};
use super::guide::Guide;
use super::look::look;
use super::pixels::of_pixels;
use super::raster::{MeshMeeting, MeshRaster};
use super::seen::{SeenKind, SeenPoint};
use super::settings::{Quality, RenderMode};
use super::smooth::{SMOOTH_ROWS, smooth};
use super::telling::Telling;
use super::tile::Tile;
use super::vector::{length, sub};
use crate::parallel::*;
use crate::trace::Ray;

use jbt_ir::limits::MAX_BAND_PIXELS;

/// The number of tiles between two reports of progress.
const STRIDE: usize = 32;
/// Pixels from one exact ray to the next one, along rows and columns.
const WATCH: u32 = 4;
/// Pixels around a break that are looked at exactly.
const BESIDE: u32 = 2;
/// The distance from the mesh to an exact hit that proves nothing missed, in cells.
const AGREE: f64 = 4.0;

/// Rows of a picture that are made together, and what they take.
struct PictureSheet<'a> {
    frame: &'a Frame<'a>,
    guide: &'a Guide,
    /// The mesh in the tiles; `None` where it does not lead the eye.
    raster: Option<MeshRaster<'a>>,
    /// The first row, and the row behind the last one.
    rows: [u32; 2],
    tiles: Vec<TileArea>,
    /// For each tile, whether the mesh misses something there: all of its rays are exact.
    is_exact: Vec<bool>,
    seen: Vec<SeenPoint>,
    lights: Vec<Light>,
    cost: Tile,
}

/// Exposes all of a film. Returns the cost.
pub fn expose(
    frame: &Frame<'_>,
    guide: &Guide,
    film: &mut [Gathered],
    telling: &mut Telling<'_>,
) -> Result<Tile, RenderError> {
    let [width, height] = frame.render.size;
    let each = (MAX_BAND_PIXELS as u32 / width).clamp(1, height);
    let bands = height.div_ceil(each);
    let begin = BEGIN;
    let mut cost = Tile::default();
    for (band, kept) in film.chunks_mut((each * width) as usize).enumerate() {
        let (first, count) = (band as u32 * each, kept.len() as u32 / width);
        let beside = if bands > 1 { SMOOTH_ROWS + 1 } else { 0 };
        let rows = [first.saturating_sub(beside), (first + count + beside).min(height)];
        let mut sheet = PictureSheet::new(frame, guide, rows)?;
        let part = |of: f32| begin + (1.0 - begin) * (band as f32 + of) / bands as f32;
        let started = Instant::now();
        sheet.look(telling, part(0.3))?;
        if guide.leads && frame.render.quality != Quality::Draft {
            sheet.sharpen(telling, part(0.4))?;
        }
        sheet.cost.trace += started.elapsed();
        let started = Instant::now();
        if frame.render.mode == RenderMode::Shaded && frame.render.quality != Quality::Draft {
            sheet.light(telling, part(0.8))?;
        }
        sheet.develop((kept, first), telling, part(1.0))?;
        sheet.cost.shade += started.elapsed();
        cost.add(&sheet.cost);
    }
    Ok(cost)
}

/// The part of the work that is done when rays begin.
pub const BEGIN: f32 = 0.2;

/// What some rays through the picture see, how many of them were followed, and how many evaluations they
/// took. `follows` says by its index whether a ray may meet anything; `trace` has the indices of those that
/// may, and the rays.
fn sights(
    frame: &Frame<'_>,
    places: &[[f64; 2]],
    follows: impl Fn(usize) -> bool,
    trace: impl Fn(&[usize], &[Ray]) -> Result<Meetings, RenderError>,
) -> Result<(Vec<SeenPoint>, u64, f64), RenderError> {
    let (mut followed, mut rays) = (Vec::new(), Vec::new());
    for (index, &[x, y]) in places.iter().enumerate() {
        if let Some(ray) = follows(index).then(|| frame.cast(x, y)).flatten() {
            followed.push(index);
            rays.push(ray);
        }
    }
    let meetings = trace(&followed, &rays)?;
    let mut met = meetings.met.iter().peekable();
    let seen = places.iter().enumerate().map(|(index, &place)| {
        let hit = met.next_if(|met| followed[met.cast] == index);
        hit.map_or_else(|| SeenPoint::behind(frame, place), |hit| SeenPoint::surface(frame, hit))
    });
    let seen = seen.collect();
    let evaluations = meetings.evaluations.iter().map(|&count| f64::from(count)).sum();
    Ok((seen, rays.len() as u64, evaluations))
}

/// What some exact rays through the picture see: see [`sights`].
fn exactly(frame: &Frame<'_>, places: &[[f64; 2]]) -> Result<(Vec<SeenPoint>, u64, f64), RenderError> {
    sights(frame, places, |_| true, |_, rays| cast(frame, rays))
}

/// What a tile sees.
struct TileSight {
    /// In the order of [`TileArea::pixels`]; empty where a tile is bare.
    seen: Vec<SeenPoint>,
    is_exact: bool,
    rays: u64,
    evaluations: f64,
}

impl<'a> PictureSheet<'a> {
    fn new(frame: &'a Frame<'a>, guide: &'a Guide, rows: [u32; 2]) -> Result<Self, RenderError> {
        let width = frame.render.size[0];
        let tiles = TileArea::of_rows(width, rows, 1);
        let raster =
            guide.leads.then(|| MeshRaster::new(&frame.camera, frame.render.size, &guide.mesh, rows));
        Ok(Self {
            frame,
            guide,
            raster,
            rows,
            is_exact: Vec::new(),
            tiles,
            seen: of_pixels(((rows[1] - rows[0]) * width) as usize, SeenPoint::NOTHING)?,
            lights: Vec::new(),
            cost: Tile::default(),
        })
    }

    /// Makes a value of each tile, some of them at a time, and has them taken in order: few of them are there
    /// at once.
    fn of_tiles<T: Send>(
        &mut self,
        (telling, end): (&mut Telling<'_>, f32),
        make: impl Fn(&Self, usize, &TileArea) -> Result<T, RenderError> + Sync + Send,
        mut take: impl FnMut(&mut Self, &TileArea, T),
    ) -> Result<(), RenderError> {
        telling.begin(end);
        let count = self.tiles.len();
        for first in (0..count).step_by(STRIDE) {
            let some = first..(first + STRIDE).min(count);
            let breath = telling.breath();
            let sheet = &*self;
            let make = |tile: usize| {
                breath.take()?;
                make(sheet, tile, &sheet.tiles[tile])
            };
            let made: Vec<T> = scatter(|watches| {
                let tiles = some.clone().into_par_iter();
                tiles.map(|tile| watches.hold(|| make(tile))).collect::<Result<_, _>>()
            })?;
            for (tile, value) in some.clone().zip(made) {
                let area = self.tiles[tile];
                take(self, &area, value);
            }
            if !telling.tell(some.end as f32 / count as f32) {
                return Err(RenderError::Cancelled);
            }
        }
        Ok(())
    }

    fn width(&self) -> usize {
        self.frame.render.size[0] as usize
    }

    /// The index of a pixel.
    fn index(&self, [x, y]: [u32; 2]) -> usize {
        (y - self.rows[0]) as usize * self.width() + x as usize
    }

    /// The middle of a pixel, or of one of its parts, as a point of the picture.
    fn place(&self, [x, y]: [u32; 2], [column, row]: [u32; 2], parts: u32) -> [f64; 2] {
        let at = |pixel: u32, part: u32, of: u32| {
            (f64::from(pixel) + (f64::from(part) + 0.5) / f64::from(parts)) / f64::from(of)
        };
        let [width, height] = self.frame.render.size;
        [at(x, column, width), at(y, row, height)]
    }

    /// Finds what each pixel sees.
    fn look(&mut self, telling: &mut Telling<'_>, end: f32) -> Result<(), RenderError> {
        self.of_tiles((telling, end), Self::look_tile, |sheet, area, sight| {
            if !sight.seen.is_empty() {
                sheet.keep(area, &sight.seen);
            }
            let hits = sight.seen.iter().filter(|seen| seen.kind == SeenKind::Surface).count();
            sheet.cost.pixels_hit += hits as u64;
            sheet.is_exact.push(sight.is_exact);
            sheet.cost.rays.camera += sight.rays;
            sheet.cost.evaluations += sight.evaluations;
        })
    }

    /// Keeps what all pixels of a tile see.
    fn keep(&mut self, area: &TileArea, mut seen: &[SeenPoint]) {
        for (first, length) in area.block_rows() {
            let (row, rest) = seen.split_at(length as usize);
            let index = self.index(first);
            self.seen[index..][..row.len()].copy_from_slice(row);
            seen = rest;
        }
    }

    /// Looks exactly where what is seen breaks off: the mesh cuts the corners of sharp edges off, so a
    /// silhouette may be a pixel or two farther out.
    fn sharpen(&mut self, telling: &mut Telling<'_>, end: f32) -> Result<(), RenderError> {
        let width = self.width();
        let breaks = |index: usize| {
            let beside = [(index % width + 1 < width).then_some(index + 1), Some(index + width)];
            let mut beside = beside.into_iter().flatten().filter_map(|other| self.seen.get(other));
            beside.any(|other| self.seen[index].breaks(other))
        };
        let all = 0..self.seen.len();
        let is_break: Vec<bool> = scatter(|_| all.into_par_iter().with_min_len(4096).map(breaks).collect());
        let look = |sheet: &Self, tile: usize, area: &TileArea| {
            let is_near = |&[x, y]: &[u32; 2]| {
                let columns = x.saturating_sub(BESIDE)..(x + BESIDE + 1).min(width as u32);
                let rows = y.saturating_sub(BESIDE).max(sheet.rows[0])..(y + BESIDE + 1).min(sheet.rows[1]);
                rows.into_iter().any(|y| columns.clone().any(|x| is_break[sheet.index([x, y])]))
            };
            let near: Vec<[u32; 2]> =
                area.pixels().into_iter().filter(|pixel| !sheet.is_exact[tile] && is_near(pixel)).collect();
            let places: Vec<[f64; 2]> = near.iter().map(|&pixel| sheet.place(pixel, [0, 0], 1)).collect();
            let sight = exactly(sheet.frame, &places)?;
            Ok((near, sight))
        };
        self.of_tiles((telling, end), look, |sheet, _, (near, (seen, rays, evaluations))| {
            sheet.cost.rays.camera += rays;
            sheet.cost.evaluations += evaluations;
            for (pixel, seen) in near.into_iter().zip(seen) {
                let index = sheet.index(pixel);
                let was = std::mem::replace(&mut sheet.seen[index], seen);
                sheet.cost.pixels_hit += u64::from(seen.kind == SeenKind::Surface);
                sheet.cost.pixels_hit -= u64::from(was.kind == SeenKind::Surface);
            }
        })
    }

    /// Whether no ray of a tile meets anything: its pixels stay what they are at the beginning.
    fn is_bare(&self, tile: usize) -> bool {
        let is_led = self.frame.render.quality == Quality::Draft && !self.guide.is_cut;
        is_led && self.raster.as_ref().is_some_and(|raster| raster.is_bare(tile))
    }

    /// What a tile sees.
    fn look_tile(&self, tile: usize, area: &TileArea) -> Result<TileSight, RenderError> {
        let frame = self.frame;
        if self.is_bare(tile) {
            return Ok(TileSight { seen: Vec::new(), is_exact: false, rays: 0, evaluations: 0.0 });
        }
        let pixels = area.pixels();
        let places: Vec<[f64; 2]> = pixels.iter().map(|&pixel| self.place(pixel, [0, 0], 1)).collect();
        let Some(raster) = &self.raster else {
            let (seen, rays, evaluations) = exactly(frame, &places)?;
            return Ok(TileSight { seen, is_exact: true, rays, evaluations });
        };
        let meshed = raster.tile(tile, area, 1);
        let meets = |[x, y]: [u32; 2]| raster.meeting(&meshed, [x - area.x, y - area.y]);
        let meetings: Vec<_> = pixels.iter().map(|&pixel| meets(pixel)).collect();
        let (mut seen, mut rays, mut evaluations) = self.led(&places, &meetings)?;
        let mut is_exact = false;
        if frame.render.quality != Quality::Draft {
            let is_watched = |&at: &usize| pixels[at].iter().all(|at| at % WATCH == WATCH / 2);
            let watched: Vec<usize> = (0..pixels.len()).filter(is_watched).collect();
            let some: Vec<[f64; 2]> = watched.iter().map(|&at| places[at]).collect();
            let (exact, more, cost) = exactly(frame, &some)?;
            (rays, evaluations) = (rays + more, evaluations + cost);
            let misses = |(&at, exact): (&usize, &SeenPoint)| self.misses(&pixels, &seen, pixels[at], exact);
            is_exact = watched.iter().zip(&exact).any(misses);
            if is_exact {
                let (exact, more, cost) = exactly(frame, &places)?;
                (seen, rays, evaluations) = (exact, rays + more, evaluations + cost);
            }
        }
        Ok(TileSight { seen, is_exact, rays, evaluations })
    }

    /// What some rays see that the mesh leads: see [`sights`].
    fn led(
        &self,
        places: &[[f64; 2]],
        meetings: &[Option<MeshMeeting>],
    ) -> Result<(Vec<SeenPoint>, u64, f64), RenderError> {
        let follows = |index: usize| self.guide.is_cut || meetings[index].is_some();
        sights(self.frame, places, follows, |followed, rays| {
            let meetings: Vec<_> = followed.iter().map(|&index| meetings[index]).collect();
            look(self.frame, self.guide, rays, &meetings)
        })
    }

    /// Whether what an exact ray sees is not seen at its pixel, nor at any pixel beside.
    fn misses(&self, pixels: &[[u32; 2]], seen: &[SeenPoint], pixel: [u32; 2], exact: &SeenPoint) -> bool {
        let agrees = |other: &SeenPoint| match (exact.kind, other.kind) {
            (SeenKind::Surface, SeenKind::Surface) => {
                let [a, b] = [exact, other].map(|seen| seen.position.map(f64::from));
                length(sub(a, b)) <= AGREE * self.guide.cell
            }
            (SeenKind::Surface, SeenKind::Nothing | SeenKind::Ground)
            | (SeenKind::Nothing | SeenKind::Ground, SeenKind::Surface) => false,
            (SeenKind::Nothing | SeenKind::Ground, SeenKind::Nothing | SeenKind::Ground) => true,
        };
        let is_beside = |other: &[u32; 2]| (0..2).all(|axis| other[axis].abs_diff(pixel[axis]) <= 1);
        !pixels.iter().zip(seen).any(|(other, seen)| is_beside(other) && agrees(seen))
    }

    /// Finds the light of each pixel.
    fn light(&mut self, telling: &mut Telling<'_>, end: f32) -> Result<(), RenderError> {
        let budget =
            RayBudget { spot: self.frame.render.quality.rays(), pixel: self.frame.render.quality.rays() };
        let dark = Light { key: 0.0, facing: 0.0, sky: [0.0; 3], open: 0.0 };
        self.lights = of_pixels(self.seen.len(), dark)?;
        let light = |sheet: &Self, _: usize, area: &TileArea| {
            let lit: Vec<[u32; 2]> = area
                .pixels()
                .into_iter()
                .filter(|&pixel| sheet.seen[sheet.index(pixel)].kind != SeenKind::Nothing)
                .collect();
            let spots: Vec<Spot> =
                lit.iter().map(|&pixel| sheet.seen[sheet.index(pixel)].spot(sheet.frame, pixel)).collect();
            let (lights, cost) = gather(sheet.frame, &spots, budget)?;
            Ok((lit, lights, cost))
        };
        self.of_tiles((telling, end), light, |sheet, _, (lit, lights, cost)| {
            for (pixel, light) in lit.into_iter().zip(lights) {
                let index = sheet.index(pixel);
                sheet.lights[index] = light;
            }
            sheet.cost.rays.shadow += cost.rays.shadow;
            sheet.cost.rays.sky += cost.rays.sky;
            sheet.cost.evaluations += cost.evaluations;
        })?;
        self.lights = smooth(&self.seen, std::mem::take(&mut self.lights), self.width());
        for (seen, light) in self.seen.iter().zip(&mut self.lights) {
            light.facing = light.key * seen.facing(self.frame);
        }
        Ok(())
    }

    /// Writes the values of the kept pixels, with more rays where neighbours differ.
    fn develop(
        &mut self,
        (kept, first): (&mut [Gathered], u32),
        telling: &mut Telling<'_>,
        end: f32,
    ) -> Result<(), RenderError> {
        let rows = [first, first + (kept.len() / self.width()) as u32];
        let develop = |sheet: &Self, tile: usize, area: &TileArea| {
            if sheet.is_bare(tile) {
                return Ok((Vec::new(), Vec::new(), 0, 0.0));
            }
            let inner: Vec<[u32; 2]> =
                area.pixels().into_iter().filter(|[_, y]| (rows[0]..rows[1]).contains(y)).collect();
            let (values, rays, evaluations) = sheet.develop_tile((tile, area), &inner)?;
            Ok((inner, values, rays, evaluations))
        };
        self.of_tiles((telling, end), develop, |sheet, _, (pixels, values, rays, evaluations)| {
            for ([x, y], value) in pixels.into_iter().zip(values) {
                kept[(y - first) as usize * sheet.width() + x as usize] = value;
            }
            sheet.cost.rays.camera += rays;
            sheet.cost.evaluations += evaluations;
        })
    }

    /// Whether a pixel differs from one of the four beside it.
    fn is_edge(&self, [x, y]: [u32; 2]) -> bool {
        let here = &self.seen[self.index([x, y])];
        let beside = [
            (x > 0).then(|| [x - 1, y]),
            (x + 1 < self.frame.render.size[0]).then(|| [x + 1, y]),
            (y > self.rows[0]).then(|| [x, y - 1]),
            (y + 1 < self.rows[1]).then(|| [x, y + 1]),
        ];
        beside.into_iter().flatten().any(|pixel| here.differs(&self.seen[self.index(pixel)]))
    }

    /// The values of pixels, and the rays and evaluations that they took.
    fn develop_tile(
        &self,
        (tile, area): (usize, &TileArea),
        pixels: &[[u32; 2]],
    ) -> Result<(Vec<Gathered>, u64, f64), RenderError> {
        let parts = self.frame.render.antialias;
        let is_edge: Vec<bool> = pixels.iter().map(|&pixel| parts > 1 && self.is_edge(pixel)).collect();
        let edges: Vec<[u32; 2]> =
            pixels.iter().zip(&is_edge).filter(|(_, edge)| **edge).map(|(&pixel, _)| pixel).collect();
        let (mut places, mut samples) = (Vec::new(), Vec::new());
        for &[x, y] in &edges {
            for part in (0..parts * parts).map(|part| [part % parts, part / parts]) {
                places.push(self.place([x, y], part, parts));
                samples.push([(x - area.x) * parts + part[0], (y - area.y) * parts + part[1]]);
            }
        }
        let leads = !self.is_exact[tile] && self.frame.render.quality == Quality::Draft;
        let (seen, rays, evaluations) = match &self.raster {
            Some(raster) if leads && !edges.is_empty() => {
                let around = area.around(&edges);
                let meshed = raster.tile(tile, &around, parts);
                let beside = [around.x - area.x, around.y - area.y].map(|pixels| pixels * parts);
                let at = |&[x, y]: &[u32; 2]| raster.meeting(&meshed, [x - beside[0], y - beside[1]]);
                let meetings: Vec<_> = samples.iter().map(at).collect();
                self.led(&places, &meetings)?
            }
            _ => exactly(self.frame, &places)?,
        };
        let each = 1.0 / (parts * parts) as f32;
        let mut seen = seen.chunks((parts * parts) as usize);
        let values = pixels.iter().zip(is_edge).map(|(&pixel, is_edge)| {
            if !is_edge {
                let index = self.index(pixel);
                return self.seen[index].value(self.frame, || self.light_at(index));
            }
            let mut sum = [0.0; 4];
            for seen in seen.next().unwrap_or_default() {
                let value = seen.value(self.frame, || self.light_near(pixel, seen));
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value * each);
            }
            sum
        });
        Ok((values.collect(), rays, evaluations))
    }

    /// The light of a pixel.
    fn light_at(&self, index: usize) -> Light {
        self.lights.get(index).copied().unwrap_or_else(|| {
            let spot = self.seen[index].spot(self.frame, [0, 0]);
            unshadowed(self.frame, &spot)
        })
    }

    /// The light of a ray of a pixel: that of the nine pixels around, as far as they see the same.
    fn light_near(&self, [x, y]: [u32; 2], seen: &SeenPoint) -> Light {
        let mut sum = ([0.0; 5], 0.0);
        let spot = seen.spot(self.frame, [x, y]);
        if self.lights.is_empty() {
            return unshadowed(self.frame, &spot);
        }
        for down in y.saturating_sub(1).max(self.rows[0])..(y + 2).min(self.rows[1]) {
            for across in x.saturating_sub(1)..(x + 2).min(self.frame.render.size[0]) {
                let index = self.index([across, down]);
                // Where nothing is quite the same, what is nearly the same.
                let other = &self.seen[index];
                let same = if other.kind == seen.kind { 1e-4 } else { 0.0 };
                let weight = same + seen.likeness(other, 1.5);
                let light = &self.lights[index];
                let parts = [light.key, light.sky[0], light.sky[1], light.sky[2], light.open];
                sum.0.iter_mut().zip(parts).for_each(|(sum, part)| *sum += weight * part);
                sum.1 += weight;
            }
        }
        if sum.1 == 0.0 {
            return unshadowed(self.frame, &spot);
        }
        let [key, red, green, blue, open] = sum.0.map(|part| part / sum.1);
        Light { key, facing: key * seen.facing(self.frame), sky: [red, green, blue], open }
    }
}
