//! Pictures of models: rays from a camera to the surface, and light that shows its shape.
//!
//! ```text
//! frame:   tight bounds ── a coarse mesh ── the camera that it fills, the ground          (framing, camera)
//! guide:   a mesh with cells of some pixels ── boxes around its triangles          (guide, hierarchy, beam)
//! sheet:   rays that the mesh leads to the surface ── position, normal, attributes        (look)
//!          from each hit: rays to the key light, rays to the sky, against the mesh         (gather)
//!          the mean of light over neighbours that see the same                             (smooth)
//!          what the light makes of the colour; the shadow on the ground                    (shade)
//!          more rays where neighbours differ                                               (sheet)
//! develop: colours, over the background                                                    (develop)
//!
//! best:    every ray exact, tile by tile, in place of guide and sheet                      (tile, cast)
//! ```
//!
//! A picture is the same to the byte on any number of threads: tiles do not depend on threads, and directions
//! come from sequences that each pixel shifts by a function of its place alone.

mod area;
mod beam;
mod boxes;
mod camera;
mod cast;
mod color;
mod develop;
mod error;
mod frame;
mod framing;
mod gather;
mod guide;
mod hierarchy;
mod lights;
mod look;
mod material;
mod noise;
mod pixels;
mod raster;
mod renderer;
mod report;
mod seen;
mod settings;
mod shade;
mod sheet;
mod smooth;
mod surface_field;
mod telling;
mod tile;
mod vector;

pub use camera::{Camera, CameraError, Stance, VIEWS, View};
pub use error::RenderError;
pub use renderer::Renderer;
pub use report::{Notice, Rays, RenderReport, Rendered};
pub use settings::{Background, Quality, Render, RenderMode};

use std::time::{Duration, Instant};

use crate::parallel::*;

use jbt_model::check::CheckedTree;

use crate::compiler::Compiler;
use crate::job::{Hook, Job};

use area::TileArea;
use develop::{Gathered, develop};
use frame::Frame;
use pixels::of_pixels;
use telling::Telling;
use tile::Tile;

/// The number of tiles between two reports of progress.
const STRIDE: usize = 32;

impl Render {
    /// A picture of a model. For several pictures, of an edited model or from several sides, keep a
    /// [`Renderer`] and use [`with`](Self::with).
    ///
    /// Memory: 16 bytes a pixel; 150 more for each pixel of a band of rows, of which there are at most
    /// [`MAX_BAND_PIXELS`](jbt_ir::limits::MAX_BAND_PIXELS), and the mesh that guides rays.
    ///
    /// # Errors
    /// See [`RenderError`].
    pub fn picture<'a>(
        &self,
        compiler: &'a Compiler,
        tree: &'a CheckedTree,
    ) -> Job<'a, Rendered, RenderError> {
        let render = self.clone();
        Job::new(move |hook| render.picture_hooked(compiler, tree, hook))
    }

    /// As [`picture`](Self::picture), of a model that is already compiled.
    ///
    /// # Errors
    /// See [`RenderError`].
    pub fn with<'a>(&self, renderer: &'a Renderer) -> Job<'a, Rendered, RenderError> {
        let render = self.clone();
        Job::new(move |hook| render.with_hooked(renderer, hook))
    }

    fn picture_hooked(
        &self,
        compiler: &Compiler,
        tree: &CheckedTree,
        hook: Hook<'_>,
    ) -> Result<Rendered, RenderError> {
        self.check(tree)?;
        if !hook(0.0) {
            return Err(RenderError::Cancelled);
        }
        let start = Instant::now();
        let renderer = Renderer::new(compiler, tree)?;
        let compile_time = start.elapsed();
        let mut rendered = self.with_hooked(&renderer, hook)?;
        rendered.report.compile_time = compile_time;
        Ok(rendered)
    }

    fn with_hooked(&self, renderer: &Renderer, hook: Hook<'_>) -> Result<Rendered, RenderError> {
        self.check(renderer.tree())?;
        let mut telling = Telling::new(hook)?;
        let start = Instant::now();
        let mut film = self.film()?;
        telling.begin(sheet::BEGIN);
        let frame = Frame::new(self, renderer, &mut telling)?;
        let guide = frame.as_ref().and_then(|frame| frame.guide.as_ref());
        let mesh_time = guide.map_or(Duration::ZERO, |guide| guide.time);
        let frame_time = start.elapsed() - mesh_time;
        let start = Instant::now();
        let done = match &frame {
            Some(frame) => match guide {
                Some(guide) => sheet::expose(frame, guide, &mut film, &mut telling)?,
                None => expose(frame, &mut film, &mut telling)?,
            },
            None => Tile::default(),
        };
        let [trace_time, shade_time] = done.shares(start.elapsed());
        let mesh_evaluations = guide.map_or(0, |guide| guide.evaluations);
        let (picture, range) = develop(&film, self.size, self.meaning(renderer.tree()), self.background());
        let notice = match &frame {
            None => Some(Notice::Empty),
            Some(_) if done.pixels_hit == 0 => Some(Notice::OutOfView),
            Some(_) => None,
        };
        let report = RenderReport {
            camera: frame.as_ref().map(Frame::seen_from),
            pixels_hit: done.pixels_hit,
            tolerance: frame.as_ref().map_or(0.0, |frame| frame.tolerance),
            rays: done.rays,
            evaluations: done.evaluations.round() as u64 + mesh_evaluations,
            triangles: guide.map_or(0, |guide| guide.mesh.triangles.len() as u64),
            range,
            engine: renderer.evaluator.engine(),
            notice,
            compile_time: Duration::ZERO,
            frame_time,
            mesh_time,
            trace_time,
            shade_time,
        };
        Ok(Rendered { picture, report })
    }

    /// An empty film.
    fn film(&self) -> Result<Vec<Gathered>, RenderError> {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        of_pixels(pixels, [0.0; 4])
    }
}

/// Exposes all tiles of a film. Returns their total cost.
fn expose(frame: &Frame<'_>, film: &mut [Gathered], telling: &mut Telling<'_>) -> Result<Tile, RenderError> {
    telling.begin(1.0);
    let width = frame.render.size[0] as usize;
    let places = TileArea::all(frame.render.size, frame.render.antialias);
    let mut all = Tile::default();
    for (done, some) in places.chunks(STRIDE).enumerate() {
        let breath = telling.breath();
        let expose = |place: &TileArea| {
            breath.take()?;
            tile::expose(frame, place)
        };
        let tiles: Vec<Tile> = scatter(|watches| {
            some.par_iter().map(|place| watches.hold(|| expose(place))).collect::<Result<_, _>>()
        })?;
        for (place, tile) in some.iter().zip(tiles) {
            for (row, pixels) in (place.y..).zip(tile.pixels.chunks(place.width as usize)) {
                film[row as usize * width + place.x as usize..][..pixels.len()].copy_from_slice(pixels);
            }
            all.add(&tile);
        }
        let fraction = ((done + 1) * STRIDE).min(places.len()) as f32 / places.len() as f32;
        if !telling.tell(fraction) {
            return Err(RenderError::Cancelled);
        }
    }
    Ok(all)
}
