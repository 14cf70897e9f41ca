//! 3MF: the core specification 1.3 and colour groups of its materials extension, in an archive.
//!
//! Every vertex of a triangle has a colour of the one group, which has each colour of the mesh once, in the
//! order of its bytes. With a palette there are so many base materials instead, and each triangle is of
//! one: borders are crisp, for printers with so many materials. A mesh without triangles is a file without
//! objects, as an object has to have some.

use std::io::Write;

use jbt_ir::watch::{self, Stopped};

use super::conventions::{ColorEncoding, Colors, Conventions, FarMeshes, FileChoices, LengthUnit, Up};
use super::palette;
use super::parts::{WriteError, colors, of_each, told, write_items};
use super::zip::Archive;
use crate::mesh::{Mesh, MeshPiece};
use crate::srgb;

/// What is usual in these files.
pub(super) const CONVENTIONS: Conventions = Conventions {
    extension: "3mf",
    title: "3D Manufacturing Format, XML in an archive",
    up: Up::Z,
    normals: "none",
    colors: Some(Colors { place: "`colorgroup`, 8 bits", encoding: ColorEncoding::Srgb }),
    uv: None,
    attributes: None,
    name: Some("`name` of the object"),
    constants: Some("`metadata` of the object"),
    far: FarMeshes::Node,
    splits: false,
    materials: true,
    unit: Some(LengthUnit::Millimetre),
};

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
const TYPES: &str = "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
const RELATIONS: &str = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
/// That of names of constants.
const NAMESPACE: &str = "urn:jbt:constants";
const MATERIALS: &str = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

pub(super) fn write(
    mesh: &Mesh,
    choices: FileChoices<'_>,
    mut out: &mut impl Write,
) -> Result<(), WriteError> {
    let mut archive = Archive::new(&mut out);
    archive.add("[Content_Types].xml", |out| Ok(write!(out, "{HEAD}{TYPES}")?))?;
    archive.add("_rels/.rels", |out| Ok(write!(out, "{HEAD}{RELATIONS}")?))?;
    archive.add("3D/3dmodel.model", |out| model(mesh, choices, out))?;
    archive.finish()
}

/// The unit as the specification calls it.
const fn unit(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Micrometre => "micron",
        LengthUnit::Millimetre => "millimeter",
        LengthUnit::Centimetre => "centimeter",
        LengthUnit::Inch => "inch",
        LengthUnit::Foot => "foot",
        LengthUnit::Metre => "meter",
    }
}

fn model(mesh: &Mesh, choices: FileChoices<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let FileChoices { colors: encoding, unit: length, .. } = choices;
    write!(out, "{HEAD}<model unit=\"{}\" xml:lang=\"en-US\" xmlns=\"{CORE}\"", unit(length))?;
    if colors(mesh).is_some() && choices.palette.is_none() {
        write!(out, " xmlns:m=\"{MATERIALS}\"")?;
    }
    if choices.constants.iter().any(|constants| !constants.is_empty()) {
        // Names of others than the specification's are in a namespace.
        write!(out, " xmlns:jbt=\"{NAMESPACE}\"")?;
    }
    writeln!(out, ">\n<metadata name=\"Application\">jbt</metadata>\n<resources>")?;
    if mesh.triangles.is_empty() {
        writeln!(out, "</resources>\n<build/>\n</model>")?;
        return Ok(());
    }
    // Positions are shared; corners have the colours of their sides.
    let split = mesh.split_asking(&watch::go_on)?;
    let palette = colors(&split).map(|colors| match choices.palette {
        Some(most) => Palette::of_materials(colors, &split.triangles, (encoding, most.get().into())),
        None => Palette::new(colors, &split.triangles, encoding),
    });
    let palette = palette.transpose()?;
    if let Some(palette) = &palette {
        palette.write(choices.palette.is_some(), out)?;
    }
    let pieces = mesh.pieces().into_iter().enumerate();
    let pieces: Vec<_> = pieces.filter(|(_, piece)| !piece.triangles.is_empty()).collect();
    for (number, piece) in pieces.iter().enumerate() {
        object(mesh, choices, piece, (number + 2, palette.as_ref()), out)?;
    }
    writeln!(out, "</resources>\n<build>")?;
    let [x, y, z] = choices.place(mesh.origin);
    let moved = if mesh.is_about_world() {
        String::new()
    } else {
        format!(" transform=\"1 0 0 0 1 0 0 0 1 {x} {y} {z}\"")
    };
    for place in 0..pieces.len() {
        writeln!(out, "<item objectid=\"{}\"{moved}/>", place + 2)?;
    }
    writeln!(out, "</build>\n</model>")?;
    Ok(())
}

/// The object of a piece, with its number.
fn object(
    mesh: &Mesh,
    choices: FileChoices<'_>,
    (place, piece): &(usize, MeshPiece<'_>),
    (number, palette): (usize, Option<&Palette>),
    mut out: &mut dyn Write,
) -> Result<(), WriteError> {
    let group = if palette.is_some() { " pid=\"1\" pindex=\"0\"" } else { "" };
    let name = piece.name.or(choices.name);
    let name = name.map_or_else(String::new, |name| format!(" name=\"{}\"", in_quotes(name)));
    writeln!(out, "<object id=\"{number}\" type=\"model\"{name}{group}>")?;
    let constants = choices.constants_of(*place);
    if !constants.is_empty() {
        writeln!(out, "<metadatagroup>")?;
        for constant in constants {
            let value = in_quotes(&told(constant));
            writeln!(out, "<metadata name=\"jbt:{}\">{value}</metadata>", in_quotes(&constant.name))?;
        }
        writeln!(out, "</metadatagroup>")?;
    }
    writeln!(out, "<mesh>\n<vertices>")?;
    let first = piece.vertices.start;
    write_items(&mut out, piece.vertices.len(), |vertex, bytes| {
        let [x, y, z] = choices.place(mesh.positions[first + vertex]);
        writeln!(bytes, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
    })?;
    writeln!(out, "</vertices>\n<triangles>")?;
    write_items(&mut out, piece.triangles.len(), |triangle, bytes| {
        let triangle = piece.triangles.start + triangle;
        let [a, b, c] = mesh.triangles[triangle].map(|vertex| vertex as usize - first);
        write!(bytes, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
        match palette.map(|palette| palette.corners[triangle]) {
            // One material for all of it.
            Some([a, ..]) if choices.palette.is_some() => write!(bytes, " pid=\"1\" p1=\"{a}\"")?,
            Some([a, b, c]) => write!(bytes, " pid=\"1\" p1=\"{a}\" p2=\"{b}\" p3=\"{c}\"")?,
            None => {}
        }
        writeln!(bytes, "/>")
    })?;
    writeln!(out, "</triangles>\n</mesh>\n</object>")?;
    Ok(())
}

/// A text as the value of an attribute of XML 1.0, which has no control characters.
fn in_quotes(text: &str) -> String {
    let mut quoted = String::new();
    for char in text.chars() {
        match char {
            '&' => quoted.push_str("&amp;"),
            '<' => quoted.push_str("&lt;"),
            '"' => quoted.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => quoted.push('_'),
            char if char.is_control() => quoted.push('_'),
            char => quoted.push(char),
        }
    }
    quoted
}

/// The colours of a mesh, each once, and the places of those of the corners of each triangle.
struct Palette {
    colors: Vec<[u8; 3]>,
    corners: Vec<[u32; 3]>,
}

impl Palette {
    fn new(linear: &[[f32; 3]], triangles: &[[u32; 3]], encoding: ColorEncoding) -> Result<Self, Stopped> {
        let all = bytes_of(linear, encoding)?;
        let mut colors = all.clone();
        colors.sort_unstable();
        colors.dedup();
        let place = |vertex: u32| colors.binary_search(&all[vertex as usize]).unwrap_or(0) as u32;
        Ok(Self { corners: of_each(triangles, |triangle| triangle.map(place))?, colors })
    }

    /// Of at most so many colours, and one for each triangle: that which is nearest to two of its corners,
    /// or to their mean.
    fn of_materials(
        linear: &[[f32; 3]],
        triangles: &[[u32; 3]],
        (encoding, most): (ColorEncoding, usize),
    ) -> Result<Self, Stopped> {
        let all = bytes_of(linear, encoding)?;
        let colors = palette::reduced(&all, most)?;
        let of_vertex = of_each(&all, |&color| palette::nearest(&colors, color))?;
        let material = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| of_vertex[vertex as usize]);
            let chosen = if b == c {
                b
            } else if a == b || a == c {
                a
            } else {
                let sum =
                    |n: usize| triangle.iter().map(|&vertex| u16::from(all[vertex as usize][n])).sum::<u16>();
                palette::nearest(&colors, [0, 1, 2].map(|n| (sum(n) / 3) as u8))
            };
            [chosen as u32; 3]
        };
        Ok(Self { corners: of_each(triangles, material)?, colors })
    }

    /// The resource that triangles name: base materials, or a group of colours.
    fn write(&self, are_materials: bool, mut out: &mut dyn Write) -> Result<(), WriteError> {
        writeln!(
            out,
            "{}",
            if are_materials { "<basematerials id=\"1\">" } else { "<m:colorgroup id=\"1\">" }
        )?;
        write_items(&mut out, self.colors.len(), |index, bytes| {
            let [r, g, b] = self.colors[index];
            if are_materials {
                let number = index + 1;
                writeln!(bytes, "<base name=\"{number}\" displaycolor=\"#{r:02X}{g:02X}{b:02X}FF\"/>")
            } else {
                writeln!(bytes, "<m:color color=\"#{r:02X}{g:02X}{b:02X}FF\"/>")
            }
        })?;
        writeln!(out, "{}", if are_materials { "</basematerials>" } else { "</m:colorgroup>" })?;
        Ok(())
    }
}

fn bytes_of(linear: &[[f32; 3]], encoding: ColorEncoding) -> Result<Vec<[u8; 3]>, Stopped> {
    of_each(linear, |color| color.map(|channel| srgb::byte(encoding.encode(channel))))
}
