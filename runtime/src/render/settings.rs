//! What a picture is asked to be.

use jbt_ir::limits::{MAX_ANTIALIAS, MAX_PICTURE_PIXELS, MAX_PICTURE_SIDE};
use jbt_model::attribute::AttributeGroup;
use jbt_model::check::CheckedTree;

use super::camera::View;
use super::color::Rgb;
use super::error::RenderError;
use crate::region::Box3;
use crate::support::{NoBox, around_in_f32};

/// A picture to be made.
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
    /// From where, and how.
    pub view: View,
    /// What is shown of the surface.
    pub mode: Mode,
    /// How much trouble light takes; it matters only where the surface is shaded.
    pub quality: Quality,
    /// A pixel takes so many rays along each of its sides: 1 to [`MAX_ANTIALIAS`].
    pub antialias: u32,
    /// What is seen where nothing is. `None` is the studio for a shaded surface, and nothing for the other
    /// modes.
    pub background: Option<Background>,
    /// Whether the model stands on something that catches its shadow. It is seen from above alone, and only
    /// of a shaded surface; a draft has none.
    pub ground: bool,
    /// The box that is looked at, about the origin of the model; it cuts the model open, and the cut is
    /// shown. `None` is the model's support.
    pub region: Option<Box3>,
}

impl Default for Render {
    /// 800 x 600 pixels, four rays each, of the shaded surface in the studio, in good quality.
    fn default() -> Self {
        Self {
            size: [800, 600],
            view: View::default(),
            mode: Mode::Shaded,
            quality: Quality::Good,
            antialias: 2,
            background: None,
            ground: true,
            region: None,
        }
    }
}

/// What is shown of the surface.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mode {
    /// The surface in light: in the colour of the model, or in that of clay if it has none.
    #[default]
    Shaded,
    /// The unit normal: x, y and z from -1 to 1 as red, green and blue from 0 to 255.
    Normal,
    /// How far the surface is in front of the eye: the nearest place is white, the farthest is dark.
    Depth,
    /// An attribute group: one real as its place between the smallest and the largest one that are seen, on
    /// the map viridis; more reals as red, green and blue of linear light, clamped to 0 .. 1.
    Attribute(String),
    /// The distances to skeletons that the rays of each pixel took: their logarithm, on the map inferno. What
    /// takes the fewest is black, like what takes none.
    Evaluations,
}

/// How much trouble light takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Quality {
    /// No rays but those of the camera: no shadows, no dark corners. For interaction.
    Draft,
    /// Soft shadows and a sky, for looking.
    #[default]
    Good,
    /// The same with less noise, for showing.
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

    /// Tolerances from one place where rays ask at once to the next one. Only time depends on it.
    pub(super) fn stride(self) -> i64 {
        match self {
            Self::Draft => 8,
            Self::Good | Self::Best => 16,
        }
    }

    /// The tolerance of rays to the light and the sky, in pixels: a shadow is softer than a rim, so what is
    /// thinner may cast none.
    pub(super) fn softness(self) -> f64 {
        match self {
            Self::Draft => 16.0,
            Self::Good => 8.0,
            Self::Best => 2.0,
        }
    }

    /// Rays to the key light and rays to the sky, from each hit.
    pub(super) fn rays(self) -> [u32; 2] {
        match self {
            Self::Draft => [0, 0],
            Self::Good => [2, 4],
            Self::Best => [8, 16],
        }
    }
}

/// What is seen where nothing is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Background {
    /// A bright wall, a little darker towards the ground.
    Studio,
    /// One colour: red, green and blue as screens take them.
    Color([u8; 3]),
    /// Nothing: the picture is not opaque there.
    Transparent,
}

/// The wall of the studio at the top and at the bottom of the picture, as screens take it.
const STUDIO: [Rgb; 2] = [[0.965, 0.972, 0.98], [0.845, 0.862, 0.885]];

impl Background {
    /// Its colour at a height of the picture, 0 at the top and 1 at the bottom, as screens take it; `None`
    /// where there is nothing.
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

/// What the numbers of a film mean.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Meaning {
    /// Linear light.
    Light,
    /// Numbers for the screen.
    Screen,
    /// One number, on the map viridis.
    Number,
    /// One number: the smallest one is white, the largest one dark.
    Distance,
    /// One number, its logarithm on the map inferno; 0 is black.
    Cost,
}

impl Render {
    /// Checks what can be checked before anything is compiled.
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
        if let Mode::Attribute(name) = &self.mode
            && width_of(tree, name).is_none()
        {
            let known = tree.attributes().iter().map(|group| group.name.to_string()).collect();
            return Err(RenderError::Attribute { name: name.clone(), known });
        }
        self.looked_at(tree)?;
        Ok(())
    }

    /// The box that is looked at; `None` if the model is empty.
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

    /// What the numbers of the film mean.
    pub(super) fn meaning(&self, tree: &CheckedTree) -> Meaning {
        match &self.mode {
            Mode::Shaded => Meaning::Light,
            Mode::Normal => Meaning::Screen,
            Mode::Depth => Meaning::Distance,
            Mode::Attribute(name) if width_of(tree, name) == Some(1) => Meaning::Number,
            Mode::Attribute(_) => Meaning::Light,
            Mode::Evaluations => Meaning::Cost,
        }
    }

    /// The background that was asked for, or that of the mode.
    pub(super) fn background(&self) -> Background {
        self.background.unwrap_or(match self.mode {
            Mode::Shaded => Background::Studio,
            Mode::Normal | Mode::Depth | Mode::Attribute(_) | Mode::Evaluations => Background::Transparent,
        })
    }
}

/// The reals of an attribute group.
fn width_of(tree: &CheckedTree, name: &str) -> Option<usize> {
    tree.attributes().iter().find(|group| &*group.name == name).map(AttributeGroup::width)
}
