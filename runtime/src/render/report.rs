//! How a picture was made.

use std::time::Duration;

use super::camera::Camera;
use crate::kernel::Engine;
use crate::picture::Picture;

/// A picture and its report.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
    /// How it was made.
    pub report: RenderReport,
}

/// How a picture was made.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RenderReport {
    /// The camera; `None` if the model was empty.
    pub camera: Option<Camera>,
    /// The pixels in which a ray met the surface.
    pub pixels_hit: u64,
    /// Parts thinner than this along a camera ray may be missed, in units of the model: an eighth (best
    /// quality), a quarter (good) or half (draft) of a pixel where the model is nearest. 0 if the model was
    /// empty.
    pub tolerance: f64,
    /// Rays, by kind.
    pub rays: Rays,
    /// The number of distances to skeletons that were evaluated for all rays.
    pub evaluations: u64,
    /// Triangles of the mesh that light met, and that led the eye; 0 if every ray was exact.
    pub triangles: u64,
    /// The numbers at the ends of the scale of colours or greys: distances from the eye, an attribute, or
    /// evaluations of a pixel with any. `None` where colours are colours, and if nothing is visible.
    pub range: Option<[f32; 2]>,
    /// The engine that ran the kernels.
    pub engine: Engine,
    /// The reason why the picture is only background, if it is.
    pub notice: Option<Notice>,
    /// Time to lower and compile the model.
    pub compile_time: Duration,
    /// Time to find the bounds of the model, and to frame it.
    pub frame_time: Duration,
    /// Time to mesh the model for its light, and to lead the eye; 0 if every ray was exact.
    pub mesh_time: Duration,
    /// Time to trace the rays from the camera.
    pub trace_time: Duration,
    /// Time to shade the hits: further rays and light.
    pub shade_time: Duration,
}

/// Numbers of rays.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Rays {
    /// From the camera into the region, without rays that frame the model.
    pub camera: u64,
    /// To the key light.
    pub shadow: u64,
    /// To the sky.
    pub sky: u64,
}

impl Rays {
    /// The number of all rays.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.sky
    }
}

/// Why a picture is only background.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Notice {
    /// The model has no inside in the region.
    Empty,
    /// The camera sees no part of the model.
    OutOfView,
}

impl Notice {
    /// The reason in words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Empty => "the picture is empty: no point of the model is inside",
            Self::OutOfView => "the picture is empty: the camera sees no surface of the model",
        }
    }
}
