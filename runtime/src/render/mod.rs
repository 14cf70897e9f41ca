//! Pictures of models: rays from a camera to the surface, and light that shows its shape.
//!
//! ```text
//! frame:   tight bounds ── a coarse picture of who is hit ── the camera that this fills       (unless it stands at a point)
//! tiles:   rays of a tile, a packet ── first hits ── normal, attributes                        (cast)
//!          from each hit: rays to the key light, rays to the sky                               (gather)
//!          what the light makes of the colour; the shadow on the ground where nothing is hit   (shade)
//! develop: means over the rays of each pixel ── colours, over the background                   (picture)
//! ```
//!
//! A picture is the same to the byte on any number of threads: tiles are always the same, and directions come from sequences that each pixel shifts by a
//! number that depends on its place alone.

mod camera;
mod cast;
mod color;
mod develop;
mod frame;
mod gather;
mod noise;
mod renderer;
mod settings;
mod shade;
mod tile;
mod vector;

pub use camera::{Camera, CameraError, Stance, VIEWS, View};
pub use renderer::Renderer;
pub use settings::{Background, Mode, Quality, Render};

use std::time::{Duration, Instant};

use rayon::prelude::*;

use jbt_frontend::check::CheckedTree;
use jbt_ir::limits::{MAX_ANTIALIAS, MAX_PICTURE_PIXELS, MAX_PICTURE_SIDE};

use crate::error::{CompileError, EvalError};
use crate::evaluator::Compiler;
use crate::job::{Hook, Job};
use crate::kernel::Engine;
use crate::picture::Picture;
use crate::region::Box3;
use crate::solid::BoundsError;
use crate::trace::TraceError;

use develop::{Gathered, develop};
use frame::Frame;
use tile::{Place, Tile};

/// A picture, and what it took.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
    /// What it took.
    pub report: Report,
}

/// What a picture took.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Report {
    /// Where the camera stood; `None` if there was nothing to look at.
    pub camera: Option<Camera>,
    /// The pixels in which a ray met the surface.
    pub pixels_hit: u64,
    /// What is thinner along a ray of the camera may be missed, in units of the model: a part of a pixel where the model is nearest, by the quality
    /// (an eighth for the best one, a quarter, half for a draft). 0 if there was nothing to look at.
    pub tolerance: f64,
    /// Rays, by kind.
    pub rays: Rays,
    /// Distances to skeletons that were evaluated for all rays.
    pub evaluations: u64,
    /// What the ends of the scale of colours or greys stand for: distances from the eye, an attribute, evaluations of a pixel that takes any. `None` where colours are colours,
    /// and if nothing is seen.
    pub range: Option<[f32; 2]>,
    /// What ran the kernels.
    pub engine: Engine,
    /// Why the picture is only background, if it is.
    pub notice: Option<Notice>,
    /// Time to lower and compile the model.
    pub compile_time: Duration,
    /// Time to find the bounds of the model and to frame it.
    pub frame_time: Duration,
    /// Time to trace the rays from the camera.
    pub trace_time: Duration,
    /// Time to shade what they hit: further rays and light.
    pub shade_time: Duration,
}

/// Numbers of rays.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rays {
    /// From the camera into the region; those that frame the model are not counted.
    pub camera: u64,
    /// To the key light.
    pub shadow: u64,
    /// To the sky.
    pub sky: u64,
}

impl Rays {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.sky
    }
}

/// Why a picture is only background.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Notice {
    /// The model has no inside in the region.
    Empty,
    /// The camera sees none of it.
    OutOfView,
}

impl Notice {
    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Empty => "the picture is empty: no point of the model is inside",
            Self::OutOfView => "the picture is empty: the camera sees no surface of the model",
        }
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The picture has no pixels.
    #[error("a picture needs at least one pixel along each side, and this one is {width} x {height}")]
    Empty {
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The picture has more pixels than are allowed.
    #[error(
        "a picture may have {MAX_PICTURE_SIDE} pixels along a side and {MAX_PICTURE_PIXELS} in all, and this one is {width} x {height}"
    )]
    TooLarge {
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// No rays for a pixel, or more than are allowed.
    #[error(
        "a pixel takes 1 x 1 to {MAX_ANTIALIAS} x {MAX_ANTIALIAS} rays, and not {antialias} x {antialias}"
    )]
    Antialias {
        /// Rays along each side of a pixel.
        antialias: u32,
    },
    /// The camera is none.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The camera's numbers are beyond those of any model.
    #[error("the camera is too far away, or sees too much or too little, for its numbers")]
    Unusable,
    /// The camera stands inside the solid, from where no surface can be seen from outside.
    #[error(
        "the camera stands inside the solid, at ({}, {}, {}): move it out, or cut the solid open by a region that it is outside of",
        eye[0], eye[1], eye[2]
    )]
    Inside {
        /// Where it stands.
        eye: [f64; 3],
    },
    /// The region is infinite, flat, not a number or not in order.
    #[error(
        "a region has finite corners, each number of the first below that of the second, and this one goes from {:?} to {:?}",
        region.low, region.high
    )]
    Region {
        /// What was given.
        region: Box3,
    },
    /// The model's field may differ from zero arbitrarily far away, and no region was given.
    #[error("the model is unbounded: its picture needs a region")]
    Unbounded,
    /// There is no such attribute.
    #[error("the model has no attribute `{name}`; it has {}", known.join(", "))]
    Attribute {
        /// What was asked for.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// The memory is not to be had.
    #[error("there is no memory for {pixels} pixels")]
    Memory {
        /// Pixels of the picture.
        pixels: usize,
    },
    /// The model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The bounds of the model were not found.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// A ray could not be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// It was told to stop.
    #[error("the picture was cancelled")]
    Cancelled,
}

/// Tiles between two reports of progress.
const STRIDE: usize = 32;

impl Render {
    /// A picture of a model. To make several, of a model that is edited or from other sides, keep a
    /// [`Renderer`] and use [`with`](Self::with).
    ///
    /// Memory: 16 bytes a pixel.
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

    /// As [`picture`](Self::picture), of a model that has been compiled: nothing is compiled here.
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
        let start = Instant::now();
        let renderer = Renderer::new(compiler, tree)?;
        let compile_time = start.elapsed();
        let mut rendered = self.with_hooked(&renderer, hook)?;
        rendered.report.compile_time = compile_time;
        Ok(rendered)
    }

    fn with_hooked(&self, renderer: &Renderer, hook: Hook<'_>) -> Result<Rendered, RenderError> {
        self.check(renderer.tree())?;
        if !hook(0.0) {
            return Err(RenderError::Cancelled);
        }
        let start = Instant::now();
        let mut film = self.film()?;
        let frame = Frame::new(self, renderer)?;
        let frame_time = start.elapsed();
        let start = Instant::now();
        let done = match &frame {
            Some(frame) => expose(frame, &mut film, hook)?,
            None => Tile::default(),
        };
        let [trace_time, shade_time] = done.shares(start.elapsed());
        let (picture, range) = develop(&film, self.size, self.meaning(renderer.tree()), self.background());
        let notice = match &frame {
            None => Some(Notice::Empty),
            Some(_) if done.pixels_hit == 0 => Some(Notice::OutOfView),
            Some(_) => None,
        };
        let report = Report {
            camera: frame.as_ref().map(Frame::seen_from),
            pixels_hit: done.pixels_hit,
            tolerance: frame.as_ref().map_or(0.0, |frame| frame.tolerance),
            rays: done.rays,
            evaluations: done.evaluations.round() as u64,
            range,
            engine: renderer.evaluator.engine(),
            notice,
            compile_time: Duration::ZERO,
            frame_time,
            trace_time,
            shade_time,
        };
        Ok(Rendered { picture, report })
    }

    /// An empty film.
    fn film(&self) -> Result<Vec<Gathered>, RenderError> {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        let mut film = Vec::new();
        film.try_reserve_exact(pixels).map_err(|_| RenderError::Memory { pixels })?;
        film.resize(pixels, [0.0; 4]);
        Ok(film)
    }
}

/// Exposes all tiles of a film. Returns what they took together.
fn expose(frame: &Frame<'_>, film: &mut [Gathered], hook: Hook<'_>) -> Result<Tile, RenderError> {
    let width = frame.render.size[0] as usize;
    let places = Place::all(frame.render.size, frame.render.antialias);
    let mut all = Tile::default();
    for (done, some) in places.chunks(STRIDE).enumerate() {
        let tiles: Vec<Tile> =
            some.par_iter().map(|place| tile::expose(frame, place)).collect::<Result<_, _>>()?;
        for (place, tile) in some.iter().zip(tiles) {
            for (row, pixels) in (place.y..).zip(tile.pixels.chunks(place.width as usize)) {
                film[row as usize * width + place.x as usize..][..pixels.len()].copy_from_slice(pixels);
            }
            all.add(&tile);
        }
        let fraction = ((done + 1) * STRIDE).min(places.len()) as f32 / places.len() as f32;
        if !hook(fraction) {
            return Err(RenderError::Cancelled);
        }
    }
    Ok(all)
}
