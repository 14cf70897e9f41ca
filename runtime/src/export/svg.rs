//! SVG: contours, and the quadtree that they were found with.
//!
//! Coordinates are those of the plane, in units of the model, to the last digit of f32; one `transform` turns
//! the picture over, because v goes up and the y of SVG goes down. An outer loop is one path with its holes,
//! filled by the even-odd rule.

use std::io::{self, Write};

use crate::contour::{Contour, Fate, Loop};
use crate::mesh::Attribute;
use crate::span::span;

/// What lines or areas are painted with.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Paint {
    /// Nothing.
    None,
    /// Red, green and blue.
    Color([u8; 3]),
    /// An attribute of the contour, 0 to 1 as it is: one channel is grey, two are red and green, of more the
    /// first three are red, green and blue. Areas have the mean over the vertices of their outer loop, lines
    /// change from vertex to vertex.
    Attribute(String),
}

/// How a contour is drawn.
#[derive(Clone, PartialEq, Debug)]
pub struct Style {
    /// The lines of all loops.
    pub stroke: Paint,
    /// How wide they are: parts of the longer side of the rectangle. More than 0.
    pub stroke_width: f64,
    /// The areas.
    pub fill: Paint,
    /// Whether to draw the squares of the division, if the contour has kept them: the deeper, the darker, and
    /// those that the contour crosses in green.
    pub quadtree: bool,
    /// Circles to draw over it: center and radius in coordinates of the plane.
    pub circles: Vec<([f64; 2], f64)>,
    /// Pixels along the longer side, if a viewer wants to know.
    pub pixels: u32,
}

impl Default for Style {
    /// Thin black lines, light areas, 800 pixels.
    fn default() -> Self {
        Self {
            stroke: Paint::Color([0; 3]),
            stroke_width: 1.0 / 400.0,
            fill: Paint::Color([0xDD, 0xE6, 0xF0]),
            quadtree: false,
            circles: Vec::new(),
            pixels: 800,
        }
    }
}

/// Writes a contour.
///
/// # Errors
/// Those of the writer; an attribute that the contour does not have ([`io::ErrorKind::InvalidInput`]), before
/// anything is written.
pub fn write_svg(contour: &Contour, style: &Style, out: &mut dyn Write) -> io::Result<()> {
    span!("bytes");
    let [stroke, fill] = [&style.stroke, &style.fill].map(|paint| resolve(contour, paint));
    let (stroke, fill) = (stroke?, fill?);
    let ([left, low], sides) = (contour.rectangle.low(), contour.rectangle.sides());
    let longest = sides[0].max(sides[1]);
    let pixels = sides.map(|side| (f64::from(style.pixels) * side / longest).ceil().max(1.0));
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{left} {low} {} {}\" width=\"{}\" height=\"{}\">",
        sides[0], sides[1], pixels[0], pixels[1]
    )?;
    // Vertices count from the origin: paths are short, and keep their digits in programs that draw in f32.
    let [right, up] = contour.origin;
    let down = low + contour.rectangle.high()[1] - up;
    writeln!(out, "<g transform=\"matrix(1 0 0 -1 {right} {down})\">")?;
    let line = longest * style.stroke_width;
    if style.quadtree {
        squares(contour, longest / 2400.0, out)?;
    }
    areas(contour, &fill, out)?;
    if style.quadtree {
        crossed(contour, out)?;
    }
    circles(&style.circles, contour.origin, longest / 800.0, out)?;
    lines(contour, &stroke, line, out)?;
    writeln!(out, "</g>\n</svg>")
}

/// A paint whose attribute has been found.
enum Resolved<'a> {
    None,
    Color([u8; 3]),
    Attribute(&'a Attribute),
}

fn resolve<'a>(contour: &'a Contour, paint: &Paint) -> io::Result<Resolved<'a>> {
    match paint {
        Paint::None => Ok(Resolved::None),
        Paint::Color(color) => Ok(Resolved::Color(*color)),
        Paint::Attribute(name) => {
            let found = contour.attributes.iter().find(|attribute| attribute.name == *name);
            let missing = || {
                io::Error::new(io::ErrorKind::InvalidInput, format!("the contour has no attribute `{name}`"))
            };
            found.map(Resolved::Attribute).ok_or_else(missing)
        }
    }
}

/// A colour of an attribute's channels.
fn color(channels: &[f32]) -> [u8; 3] {
    // The cast saturates, and makes 0 of what is no number.
    let byte = |value: f32| (255.0 * value + 0.5) as u8;
    match *channels {
        [] => [0; 3],
        [grey] => [byte(grey); 3],
        [red, green] => [byte(red), byte(green), 0],
        [red, green, blue, ..] => [byte(red), byte(green), byte(blue)],
    }
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The path of a loop.
fn path(contour: &Contour, one: &Loop, out: &mut dyn Write) -> io::Result<()> {
    let mut letter = 'M';
    for [u, v] in &contour.positions[one.start..one.end] {
        write!(out, "{letter}{u} {v}")?;
        letter = 'L';
    }
    write!(out, "Z")
}

/// Outer loops with their holes.
fn areas(contour: &Contour, fill: &Resolved<'_>, out: &mut dyn Write) -> io::Result<()> {
    let mut holes: Vec<(usize, usize)> = contour.loops.iter().enumerate().filter_map(hole).collect();
    holes.sort_unstable();
    for (index, one) in contour.loops.iter().enumerate().filter(|(_, one)| !one.is_hole) {
        let color = match fill {
            Resolved::None => return Ok(()),
            Resolved::Color(color) => *color,
            Resolved::Attribute(attribute) => color(&contour.mean(attribute, one)),
        };
        write!(out, "<path fill=\"{}\" fill-rule=\"evenodd\" d=\"", hex(color))?;
        path(contour, one, out)?;
        let first = holes.partition_point(|(parent, _)| *parent < index);
        for (_, hole) in holes[first..].iter().take_while(|(parent, _)| *parent == index) {
            path(contour, &contour.loops[*hole], out)?;
        }
        writeln!(out, "\"/>")?;
    }
    Ok(())
}

/// A hole's parent and its number.
fn hole((index, one): (usize, &Loop)) -> Option<(usize, usize)> {
    if one.is_hole { one.parent.map(|parent| (parent, index)) } else { None }
}

/// All loops as lines.
fn lines(contour: &Contour, stroke: &Resolved<'_>, width: f64, out: &mut dyn Write) -> io::Result<()> {
    let round =
        format!("fill=\"none\" stroke-width=\"{width}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"");
    match stroke {
        Resolved::None => {}
        Resolved::Color(_) if contour.loops.is_empty() => {}
        Resolved::Color(color) => {
            write!(out, "<path {round} stroke=\"{}\" d=\"", hex(*color))?;
            contour.loops.iter().try_for_each(|one| path(contour, one, out))?;
            writeln!(out, "\"/>")?;
        }
        Resolved::Attribute(attribute) => {
            writeln!(out, "<g {round}>")?;
            contour.loops.iter().try_for_each(|one| coloured(contour, attribute, one, out))?;
            writeln!(out, "</g>")?;
        }
    }
    Ok(())
}

/// A loop in pieces of one colour.
fn coloured(contour: &Contour, attribute: &Attribute, one: &Loop, out: &mut dyn Write) -> io::Result<()> {
    let width = attribute.width;
    let color = |vertex: usize| color(&attribute.values[vertex * width..][..width]);
    let next = |vertex: usize| if vertex + 1 == one.end { one.start } else { vertex + 1 };
    let mut open = None;
    for vertex in one.start..one.end {
        let [u, v] = contour.positions[next(vertex)];
        if open != Some(color(vertex)) {
            if open.is_some() {
                writeln!(out, "\"/>")?;
            }
            let [from_u, from_v] = contour.positions[vertex];
            write!(out, "<path stroke=\"{}\" d=\"M{from_u} {from_v}", hex(color(vertex)))?;
            open = Some(color(vertex));
        }
        write!(out, "L{u} {v}")?;
    }
    writeln!(out, "\"/>")
}

/// The squares of the division that were not divided further, each depth a little darker.
fn squares(contour: &Contour, width: f64, out: &mut dyn Write) -> io::Result<()> {
    let deepest = contour.squares.iter().map(|square| square.depth).max().unwrap_or(0);
    for depth in 0..=deepest {
        let leaves =
            contour.squares.iter().filter(|square| square.depth == depth && square.fate != Fate::Divided);
        let mut leaves = leaves.peekable();
        if leaves.peek().is_none() {
            continue;
        }
        let part = f32::from(depth) / f32::from(deepest.max(1));
        let shade = |light: f32, dark: f32| (light + part * (dark - light)) as u8;
        let fill = hex([shade(255.0, 196.0), shade(252.0, 168.0), shade(240.0, 118.0)]);
        write!(out, "<path fill=\"{fill}\" stroke=\"#8a8172\" stroke-width=\"{width}\" d=\"")?;
        leaves.try_for_each(|square| outline(square.low, square.high, out))?;
        writeln!(out, "\"/>")?;
    }
    Ok(())
}

/// The squares that the contour crosses.
fn crossed(contour: &Contour, out: &mut dyn Write) -> io::Result<()> {
    let mut found = contour.squares.iter().filter(|square| square.fate == Fate::Crossed).peekable();
    if found.peek().is_none() {
        return Ok(());
    }
    write!(out, "<path fill=\"#1a9850\" fill-opacity=\"0.75\" d=\"")?;
    found.try_for_each(|square| outline(square.low, square.high, out))?;
    writeln!(out, "\"/>")
}

fn outline([left, low]: [f32; 2], [right, high]: [f32; 2], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "M{left} {low}H{right}V{high}H{left}Z")
}

fn circles(circles: &[([f64; 2], f64)], origin: [f64; 2], width: f64, out: &mut dyn Write) -> io::Result<()> {
    if circles.is_empty() {
        return Ok(());
    }
    writeln!(out, "<g fill=\"none\" stroke=\"#c6362c\" stroke-width=\"{width}\">")?;
    for ([u, v], radius) in circles {
        let [u, v] = [u - origin[0], v - origin[1]];
        writeln!(out, "<circle cx=\"{u}\" cy=\"{v}\" r=\"{radius}\"/>")?;
    }
    writeln!(out, "</g>")
}
