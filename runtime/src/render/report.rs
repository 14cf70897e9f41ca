//! What a picture took.

use std::time::Duration;

use super::camera::Camera;
use crate::kernel::Engine;
use crate::picture::Picture;

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
    /// What is thinner along a ray of the camera may be missed, in units of the model: a part of a pixel
    /// where the model is nearest, by the quality (an eighth for the best one, a quarter, half for a draft).
    /// 0 if there was nothing to look at.
    pub tolerance: f64,
    /// Rays, by kind.
    pub rays: Rays,
    /// Distances to skeletons that were evaluated for all rays.
    pub evaluations: u64,
    /// What the ends of the scale of colours or greys stand for: distances from the eye, an attribute,
    /// evaluations of a pixel that takes any. `None` where colours are colours, and if nothing is seen.
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
