//! Settings of a picture.

use jbt_ir::limits::{MAX_ANTIALIAS, MAX_PICTURE_PIXELS, MAX_PICTURE_SIDE};
use jbt_model::attribute::AttributeGroup;
use jbt_model::check::CheckedTree;
use jbt_model::word::normalized;

use super::camera::View;
use super::color::Rgb;
use super::error::RenderError;
use crate::boxes::Box3;
use crate::support::{NoBox, around_in_f32};

/// The settings of a picture.
///
/// ```
/// use jbt::render::{Render, View};
/// # let tree = jbt::text::parse(b"jbt 1 point { surface_radius 1 }", &Default::default()).unwrap().check().unwrap();
/// let render = Render { size: [32, 24], view: View::named("front").unwrap(), ..Render::default() };
/// let made = render.picture(&jbt::Compiler::new(), &tree).run().unwrap();
/// assert_eq!(made.picture.pixels().len(), 32 * 24);
/// assert!(made.report.pixels_hit > 200);
/// ```
#[derive(Clone, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Render {
    /// Pixels of a row, and rows: 1 to [`MAX_PICTURE_SIDE`] each, and [`MAX_PICTURE_PIXELS`] in all.
    pub size: [u32; 2],
    /// The view.
    pub view: View,
    /// The values that the picture shows.
    pub mode: RenderMode,
    /// The effort for light; it matters only for a shaded surface.
    pub quality: Quality,
    /// The number of rays along each side of a pixel: 1 to [`MAX_ANTIALIAS`]. In draft and good quality only
    /// pixels that differ from a neighbour take more than one, where a mesh guides rays.
    pub antialias: u32,
    /// The picture where the model is not. `None` is the studio for a shaded surface, and transparency for
    /// other modes.
    pub background: Option<Background>,
    /// Whether the model stands on a ground that catches its shadow. The ground is visible only from above
    /// and for a shaded surface, not in a draft.
    pub ground: bool,
    /// The box of the picture, relative to the model's origin. It cuts the model open, and the cut is shown.
    /// `None` is the model's support.
    pub region: Option<Box3>,
}

impl Default for Render {
    /// 800 x 600 pixels with four rays each, of the shaded surface in the studio, in good quality.
    fn default() -> Self {
        Self {
            size: [800, 600],
            view: View::default(),
            mode: RenderMode::Shaded,
            quality: Quality::Good,
            antialias: 2,
            background: None,
            ground: true,
            region: None,
        }
    }
}

/// The values that a picture shows.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RenderMode {
    /// The surface in light: in the colour of the model, or of clay if it has none.
    #[default]
    Shaded,
    /// The unit normal: x, y and z from -1 to 1 as red, green and blue from 0 to 255.
    Normal,
    /// The distance of the surface in front of the eye: the nearest place is white, the farthest is dark.
    Depth,
    /// An attribute group. One real is shown by its place between the smallest and the largest visible one,
    /// on the map viridis; more reals as red, green and blue of linear light, clamped to 0 .. 1.
    Attribute(String),
    /// The number of distances to skeletons for the rays of each pixel: its logarithm, on the map inferno.
    /// The smallest number is black, and so is 0.
    Evaluations,
}

/// The effort for light.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Quality {
    /// No shadows, no dark corners, for interaction: a mesh with cells of eight pixels leads to the surface.
    /// What is thinner than a cell may be missed.
    Draft,
    /// Soft shadows and a sky, for looking. Light meets a mesh with cells of five pixels; the eye sees the
    /// surface itself.
    #[default]
    Good,
    /// Every ray is exact, for showing: dozens of times as long.
    Best,
}

impl Quality {
    /// The tolerance of the camera's rays, in pixels.
    pub(super) fn fineness(self) -> f64 {
        match self {
            Self::Draft => 1.0,
            Self::Good => 0.25,
            Self::Best => 0.125,
        }
    }

    /// The number of tolerances from one coarse place of a ray to the next. Only time depends on it.
    pub(super) fn stride(self) -> i64 {
        match self {
            Self::Draft => 8,
            Self::Good | Self::Best => 16,
        }
    }

    /// The edge of a cell of the mesh that guides rays, in pixels; the best quality has none.
    pub(super) fn cell(self) -> f64 {
        match self {
            Self::Draft => 5.0,
            Self::Good | Self::Best => 3.5,
        }
    }

    /// The tolerance of exact rays to the light and the sky, in pixels: shadows are soft, so thinner
    /// parts may cast none.
    pub(super) fn softness(self) -> f64 {
        match self {
            Self::Draft => 16.0,
            Self::Good => 8.0,
            Self::Best => 2.0,
        }
    }

    /// The numbers of rays to the key light and to the sky, for each hit.
    pub(super) fn rays(self) -> [u32; 2] {
        match self {
            Self::Draft => [0, 0],
            Self::Good => [2, 3],
            Self::Best => [8, 16],
        }
    }
}

/// The picture where the model is not.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Background {
    /// A bright wall, a little darker towards the ground.
    Studio,
    /// One colour: red, green and blue as screen values.
    Color([u8; 3]),
    /// Nothing: the picture is transparent.
    Transparent,
}

/// The wall of the studio at the top and at the bottom of the picture, as screen values.
const STUDIO: [Rgb; 2] = [[0.965, 0.972, 0.98], [0.845, 0.862, 0.885]];

impl Background {
    /// Its colour at a height of the picture, 0 at the top and 1 at the bottom, as screen values; `None` if
    /// it is transparent.
    pub(super) fn at(self, y: f32) -> Option<Rgb> {
        match self {
            Self::Studio => {
                Some([0, 1, 2].map(|channel| STUDIO[0][channel] * (1.0 - y) + STUDIO[1][channel] * y))
            }
            Self::Color(color) => Some(color.map(|channel| f32::from(channel) / 255.0)),
            Self::Transparent => None,
        }
    }
}

/// The meaning of a film's numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FilmMeaning {
    /// Linear light.
    Light,
    /// Screen values.
    Screen,
    /// One number, on the map viridis.
    Number,
    /// One number: the smallest one is white, the largest one dark.
    Distance,
    /// One number, its logarithm on the map inferno; 0 is black.
    Cost,
}

impl Render {
    /// The checks that need no compiled model.
    pub(super) fn check(&self, tree: &CheckedTree) -> Result<(), RenderError> {
        let [width, height] = self.size;
        if width == 0 || height == 0 {
            return Err(RenderError::Empty { width, height });
        }
        let sides = width.max(height) as usize;
        if sides > MAX_PICTURE_SIDE || width as usize * height as usize > MAX_PICTURE_PIXELS {
            return Err(RenderError::TooLarge { width, height });
        }
        if !(1..=MAX_ANTIALIAS).contains(&self.antialias) {
            return Err(RenderError::Antialias { antialias: self.antialias });
        }
        self.view.check()?;
        if let RenderMode::Attribute(name) = &self.mode
            && width_of(tree, name).is_none()
        {
            let known = tree.attributes().iter().map(|group| group.name.to_string()).collect();
            return Err(RenderError::Attribute { name: name.clone(), known });
        }
        self.looked_at(tree)?;
        Ok(())
    }

    /// The box of the picture; `None` if the model is empty.
    pub(super) fn looked_at(&self, tree: &CheckedTree) -> Result<Option<Box3>, RenderError> {
        match self.region {
            Some(region) if region.is_full() => Ok(Some(region)),
            Some(region) => Err(RenderError::Region { region }),
            None => match around_in_f32(tree) {
                Ok(region) => Ok(Some(region)),
                Err(NoBox::Empty) => Ok(None),
                Err(NoBox::Unbounded) => Err(RenderError::Unbounded),
            },
        }
    }

    /// The meaning of the film's numbers.
    pub(super) fn meaning(&self, tree: &CheckedTree) -> FilmMeaning {
        match &self.mode {
            RenderMode::Shaded => FilmMeaning::Light,
            RenderMode::Normal => FilmMeaning::Screen,
            RenderMode::Depth => FilmMeaning::Distance,
            RenderMode::Attribute(name) if width_of(tree, name) == Some(1) => FilmMeaning::Number,
            RenderMode::Attribute(_) => FilmMeaning::Light,
            RenderMode::Evaluations => FilmMeaning::Cost,
        }
    }

    /// The given background, or the mode's default.
    pub(super) fn background(&self) -> Background {
        self.background.unwrap_or(match self.mode {
            RenderMode::Shaded => Background::Studio,
            RenderMode::Normal | RenderMode::Depth | RenderMode::Attribute(_) | RenderMode::Evaluations => {
                Background::Transparent
            }
        })
    }
}

/// The reals of an attribute group.
fn width_of(tree: &CheckedTree, name: &str) -> Option<usize> {
    let name = normalized(name);
    tree.attributes().iter().find(|group| *group.name == *name).map(AttributeGroup::width)
}
