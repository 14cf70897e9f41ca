//! What `jbt contour` takes, and how it is written.

use clap::{Args, ValueEnum};
use jbt::contour::{Plane, PlaneError, Rectangle};

use super::space::{cells, corners};
use super::{OutputArguments, SceneArguments, WorkArguments};
use crate::formats::SliceKind;

/// What `jbt contour` takes.
#[derive(Args, Debug)]
#[command(after_help = "\
OUT.svg is a drawing: the contour as closed loops in units of the scene, outer ones counter-clockwise and holes clockwise. Where the region
cuts the solid, loops follow its border. --quadtree divides down to single cells and draws the squares (those that the contour crosses in
green), and circles where supports of points meet the plane.

OUT.png is an image. Its modes: field (from blue outside over white to red inside), grey, height (a landscape), inside (white in black), attribute
(inside; transparent outside).

In the plane z=C coordinates are x and y, in x=C they are y and z, in y=C x and z. Any other plane is nine numbers: a point, and the
directions of the two coordinates. Without --region the slice covers the support of the model.

Examples:
  jbt contour circles.jbt --region -1.75,-1.75,1.75,1.75 --quadtree -o circles.svg
  jbt contour hero.jbt --plane y=0 --fill attribute -o slice.svg --json
  jbt contour hero.jbt --plane 0,0,0,1,1,0,0,0,1 --mode height -o slice.png
  jbt contour prospero.vm --region -1,-1,1,1 --resolution 1024 --mode inside -o text.png")]
pub struct ContourArguments {
    /// What to cut.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the slice goes.
    #[command(flatten)]
    pub output: OutputArguments<SliceKind>,
    /// The plane: x=C, y=C, z=C, or nine numbers
    #[arg(long, value_name = "PLANE", default_value = "z=0", value_parser = plane, allow_hyphen_values = true)]
    pub plane: Plane,
    /// The part of the plane, in its coordinates [default: the support of the model]
    #[arg(long, value_name = "U0,V0,U1,V1", value_parser = rectangle, allow_hyphen_values = true)]
    pub region: Option<Rectangle>,
    /// Edge of a cell or pixel, in units of the scene
    #[arg(long, value_name = "H", conflicts_with = "resolution", allow_negative_numbers = true)]
    pub cell: Option<f64>,
    /// Cells or pixels along the longer side of the region [default: 256 cells, 512 pixels]
    #[arg(long, value_name = "N", value_parser = cells, allow_negative_numbers = true)]
    pub resolution: Option<usize>,
    /// Lines of a drawing: `none`, a colour as #rrggbb, or `attribute` [default: #000000]
    #[arg(long, value_name = "PAINT", value_parser = paint)]
    pub stroke: Option<PaintName>,
    /// Areas of a drawing: `none`, a colour as #rrggbb, or `attribute` [default: #dde6f0; none with
    /// --quadtree]
    #[arg(long, value_name = "PAINT", value_parser = paint)]
    pub fill: Option<PaintName>,
    /// Divide down to single cells, and draw the squares
    #[arg(long)]
    pub quadtree: bool,
    /// What an image shows [default: field]
    #[arg(long, value_enum)]
    pub mode: Option<ModeName>,
    /// The attribute that `attribute` stands for [default: color]
    #[arg(long, value_name = "NAME")]
    pub attribute: Option<String>,
    /// Points along the side of a pixel, for smooth images inside and of attributes [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub samples: Option<u8>,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// The words for images.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModeName {
    /// White inside, black outside
    Inside,
    /// The field, from blue outside over white to red inside
    Field,
    /// The field, from black to white
    Grey,
    /// The field as a landscape
    Height,
    /// An attribute, inside
    Attribute,
}

/// The words for paints.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PaintName {
    /// Nothing.
    None,
    /// Red, green and blue.
    Color([u8; 3]),
    /// The attribute of the options.
    Attribute,
}

fn plane(text: &str) -> Result<Plane, String> {
    text.parse().map_err(|error: PlaneError| error.to_string())
}

fn rectangle(text: &str) -> Result<Rectangle, String> {
    let [low, high] = corners(text, [["U0", "V0"], ["U1", "V1"]])?;
    Rectangle::new(low, high).map_err(|error| error.to_string())
}

fn paint(text: &str) -> Result<PaintName, String> {
    match text {
        "none" => return Ok(PaintName::None),
        "attribute" => return Ok(PaintName::Attribute),
        _ => {}
    }
    let digits = text
        .strip_prefix('#')
        .filter(|digits| digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
    let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let [_, red, green, blue] =
        number.ok_or("expected `none`, `attribute`, or a colour as #ff8000")?.to_be_bytes();
    Ok(PaintName::Color([red, green, blue]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_rectangles_and_paints() {
        assert!(plane("z=0").is_ok() && plane("w=0").is_err() && plane("z=nan").is_err());
        assert_eq!(rectangle(" -1,0, 1,2 "), Ok(Rectangle::new([-1.0, 0.0], [1.0, 2.0]).unwrap()));
        for bad in ["", "0,0,1", "0,0,1,1,1", "0,0,1,nan", "0,0,0,1", "1,0,0,1", "0,0,1,inf", "0,0,1,x"] {
            assert!(rectangle(bad).is_err(), "{bad}");
        }
        assert_eq!(paint("#ff8000"), Ok(PaintName::Color([255, 128, 0])));
        assert_eq!((paint("none"), paint("attribute")), (Ok(PaintName::None), Ok(PaintName::Attribute)));
        for bad in ["", "red", "#fff", "#ff80000", "#+f8000", "#gg0000"] {
            assert!(paint(bad).is_err(), "{bad}");
        }
    }
}
