//! What `jbt render` takes, and how it is written.

use clap::{Args, ValueEnum};
use jbt::Box3;
use jbt::render::{Background, Quality, Stance, VIEWS};

use super::space::region;
use super::{OutputArguments, SceneArguments, WorkArguments};
use crate::formats::PictureKind;

/// What `jbt render` takes.
#[derive(Args, Debug)]
#[command(after_help = HELP)]
pub struct RenderArguments {
    /// What to look at.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the picture goes.
    #[command(flatten)]
    pub output: OutputArguments<PictureKind>,
    /// Pixels: width and height, or one number for both
    #[arg(long, value_name = "WxH|N", default_value = "800x600", value_parser = size)]
    pub size: [u32; 2],
    /// From where to look: three-quarter, iso, front, back, left, right, top, bottom, or a direction
    /// [default: three-quarter]
    #[arg(long, value_name = "NAME|X,Y,Z", value_parser = view, conflicts_with = "eye", allow_hyphen_values = true)]
    pub view: Option<Stance>,
    /// Where the camera stands, instead of --view
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, requires = "target", allow_hyphen_values = true)]
    pub eye: Option<[f64; 3]>,
    /// What a camera with --eye looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, requires = "eye", allow_hyphen_values = true)]
    pub target: Option<[f64; 3]>,
    /// What is up in the picture [default: z; y for views along z]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub up: Option<[f64; 3]>,
    /// The angle from the bottom to the top of the picture
    #[arg(long, value_name = "DEGREES", default_value_t = 28.0, allow_negative_numbers = true)]
    pub lens: f64,
    /// How much larger everything is
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true)]
    pub zoom: f64,
    /// Without perspective
    #[arg(long)]
    pub orthographic: bool,
    /// What to show: shaded, normal, depth, attribute NAME, evaluations
    #[arg(long, value_names = ["MODE", "NAME"], num_args = 1..=2, default_value = "shaded")]
    pub mode: Vec<String>,
    /// How much trouble light takes: none, some, or much
    #[arg(long, value_enum, default_value_t = QualityName::Good)]
    pub quality: QualityName,
    /// Rays for a pixel: N x N; but with --quality best only where neighbours differ
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub antialias: u32,
    /// What is seen where nothing is: studio, transparent, #rrggbb or a name as white or black
    /// [default: studio for shaded, else transparent]
    #[arg(long, value_name = "COLOUR", value_parser = background)]
    pub background: Option<Background>,
    /// What catches the shadow of the model
    #[arg(long, value_enum, default_value_t = GroundName::Shadow)]
    pub ground: GroundName,
    /// The box to look at: its smallest and its largest corner; it cuts the model open [default: the support
    /// of the model]
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = region, allow_hyphen_values = true)]
    pub region: Option<Box3<f64>>,
    #[command(flatten)]
    pub work: WorkArguments,
}

const HELP: &str = "\
A model looks along x, and z is up: `front` sees it from +x, `left` from +y, `top` from +z. A view by name or direction frames
the model; a camera with --eye and --target stands where it is told to.

Modes:
  shaded          in light, in the colour of the model, or in that of clay if it has none; the attributes rough, metal and glow
                  (one real each) are its material
  normal          x, y and z of the unit normal, from -1 to 1, as red, green and blue
  depth           the nearest place is white, the farthest is dark
  owner           a colour of its own for each leaf, where it is the one that decides
  attribute NAME  one real from blue to yellow (viridis) between the smallest and the largest one that are seen; more reals as
                  red, green and blue, linear, clamped to 0..1
  evaluations     distances to skeletons for each pixel, their logarithm from black to yellow (inferno)

Keys of --json:
  width, height, pixels, pixels_hit, rays: {camera, shadow, sky, total}, evaluations (of primitives, for all rays),
  evaluations_per_pixel, triangles (of the mesh that guided rays, 0 without),
  range: [least, most] (what the ends of the colours stand for; null where colours are colours),
  camera: {eye, right, up, back, half, orthographic} (null if the model is empty), tolerance, engine,
  compile_ms, frame_ms, mesh_ms, trace_ms, shade_ms, total_ms, warnings

Examples:
  jbt render hero.jbt -o hero.png
  jbt render hero.jbt -o hero.png --size 1200x800 --view 1,-1,0.3 --quality best --antialias 3 --background transparent
  jbt render hero.jbt -o cost.png --mode evaluations --json
  jbt render monocle.jbt -o material.png --mode attribute material --view top
  jbt render goblet.jbt -o section.png --region -1,0,-1.2,1,1,1.5 --view right";

/// The words for qualities.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum QualityName {
    /// No shadows; a mesh leads to the surface
    Draft,
    /// Soft shadows and a sky, by a mesh; the surface is exact
    Good,
    /// Every ray is exact
    Best,
}

impl QualityName {
    /// The quality.
    pub fn quality(self) -> Quality {
        match self {
            Self::Draft => Quality::Draft,
            Self::Good => Quality::Good,
            Self::Best => Quality::Best,
        }
    }
}

/// The words for grounds.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum GroundName {
    /// The shadow alone is seen
    Shadow,
    /// There is no ground
    None,
}

/// Names of colours, as screens take them.
const COLORS: [(&str, [u8; 3]); 10] = [
    ("white", [255, 255, 255]),
    ("silver", [192, 192, 192]),
    ("gray", [128, 128, 128]),
    ("grey", [128, 128, 128]),
    ("black", [0, 0, 0]),
    ("navy", [0, 0, 128]),
    ("skyblue", [135, 206, 235]),
    ("ivory", [255, 255, 240]),
    ("beige", [245, 245, 220]),
    ("slategray", [112, 128, 144]),
];

fn size(text: &str) -> Result<[u32; 2], String> {
    let number = |word: &str| {
        word.trim().parse::<u32>().map_err(|_| {
            format!("expected WIDTHxHEIGHT or one number, as 800x600, and `{word}` is no number")
        })
    };
    match text.split_once(['x', 'X']) {
        Some((width, height)) => Ok([number(width)?, number(height)?]),
        None => number(text).map(|side| [side; 2]),
    }
}

fn triple(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|word| word.trim().parse().map_err(|_| format!("`{}` is not a number", word.trim())))
        .collect::<Result<_, _>>()?;
    <[f64; 3]>::try_from(numbers).map_err(|_| "expected three numbers, as X,Y,Z".to_owned())
}

fn view(text: &str) -> Result<Stance, String> {
    if let Some((_, from)) = VIEWS.iter().find(|(name, _)| *name == text) {
        return Ok(Stance::From(*from));
    }
    triple(text).map(Stance::From).map_err(|reason| {
        let names = VIEWS.map(|(name, _)| name).join(", ");
        format!("expected one of {names}, or a direction X,Y,Z: {reason}")
    })
}

fn background(text: &str) -> Result<Background, String> {
    match text {
        "studio" => return Ok(Background::Studio),
        "transparent" => return Ok(Background::Transparent),
        _ => {}
    }
    if let Some((_, color)) = COLORS.iter().find(|(name, _)| *name == text) {
        return Ok(Background::Color(*color));
    }
    let digits: Option<Vec<u8>> =
        text.strip_prefix('#').and_then(|hex| hex.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect());
    match digits.as_deref() {
        Some(&[a, b, c, d, e, f]) => Ok(Background::Color([a << 4 | b, c << 4 | d, e << 4 | f])),
        Some(&[r, g, b]) => Ok(Background::Color([r, g, b].map(|digit| digit * 17))),
        Some(_) | None => {
            let names = COLORS.map(|(name, _)| name).join(", ");
            Err(format!("expected studio, transparent, #rrggbb, #rgb or one of {names}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("800x600"), Ok([800, 600]));
        assert_eq!(size("64"), Ok([64, 64]));
        for bad in ["", "x", "3x", "-1x4", "1x2x3", "1.5", "99999999999"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn views() {
        assert_eq!(view("top"), Ok(Stance::From([0.0, 0.0, 1.0])));
        assert_eq!(view("1,-2, 0.5"), Ok(Stance::From([1.0, -2.0, 0.5])));
        assert!(view("above").is_err_and(|message| message.contains("three-quarter, iso, front")));
        assert!(view("1,2").is_err_and(|message| message.contains("three numbers")));
    }

    #[test]
    fn backgrounds() {
        assert_eq!(background("#0aF"), Ok(Background::Color([0, 170, 255])));
        assert_eq!(background("#102030"), Ok(Background::Color([16, 32, 48])));
        assert_eq!(background("white"), Ok(Background::Color([255; 3])));
        assert_eq!(background("transparent"), Ok(Background::Transparent));
        for bad in ["", "#", "#12345", "#gggggg", "mauve", "#1234567"] {
            assert!(background(bad).is_err(), "{bad}");
        }
    }
}
