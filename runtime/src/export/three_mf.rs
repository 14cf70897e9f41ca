//! 3MF: the core specification 1.3 and colour groups of its materials extension, in an archive.
//!
//! Every vertex of a triangle has a colour of the one group, which has each colour of the mesh once, in the
//! order of its bytes. A mesh without triangles is a file without objects, as an object has to have some.

use std::io::Write;

use super::conventions::{ColorEncoding, Colors, Conventions, FarMeshes, FileChoices, LengthUnit, Up};
use super::parts::{WriteError, colors, write_items};
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
    far: FarMeshes::Node,
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

fn model(mesh: &Mesh, choices: FileChoices<'_>, mut out: &mut dyn Write) -> Result<(), WriteError> {
    let FileChoices { colors: encoding, unit: length, .. } = choices;
    write!(out, "{HEAD}<model unit=\"{}\" xml:lang=\"en-US\" xmlns=\"{CORE}\"", unit(length))?;
    if colors(mesh).is_some() {
        write!(out, " xmlns:m=\"{MATERIALS}\"")?;
    }
    writeln!(out, ">\n<metadata name=\"Application\">jbt</metadata>\n<resources>")?;
    if mesh.triangles.is_empty() {
        writeln!(out, "</resources>\n<build/>\n</model>")?;
        return Ok(());
    }
    let palette = colors(mesh).map(|colors| Palette::new(colors, encoding));
    if let Some(palette) = &palette {
        writeln!(out, "<m:colorgroup id=\"1\">")?;
        write_items(&mut out, palette.colors.len(), |index, bytes| {
            let [r, g, b] = palette.colors[index];
            writeln!(bytes, "<m:color color=\"#{r:02X}{g:02X}{b:02X}FF\"/>")
        })?;
        writeln!(out, "</m:colorgroup>")?;
    }
    let pieces: Vec<_> = mesh.pieces().into_iter().filter(|piece| !piece.triangles.is_empty()).collect();
    for (place, piece) in pieces.iter().enumerate() {
        object(mesh, choices, piece, (place + 2, palette.as_ref()), out)?;
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
    piece: &MeshPiece<'_>,
    (number, palette): (usize, Option<&Palette>),
    mut out: &mut dyn Write,
) -> Result<(), WriteError> {
    let group = if palette.is_some() { " pid=\"1\" pindex=\"0\"" } else { "" };
    let name = piece.name.or(choices.name);
    let name = name.map_or_else(String::new, |name| format!(" name=\"{}\"", in_quotes(name)));
    writeln!(out, "<object id=\"{number}\" type=\"model\"{name}{group}>\n<mesh>\n<vertices>")?;
    let first = piece.vertices.start;
    write_items(&mut out, piece.vertices.len(), |vertex, bytes| {
        let [x, y, z] = choices.place(mesh.positions[first + vertex]);
        writeln!(bytes, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
    })?;
    writeln!(out, "</vertices>\n<triangles>")?;
    write_items(&mut out, piece.triangles.len(), |triangle, bytes| {
        let triangle = mesh.triangles[piece.triangles.start + triangle];
        let [a, b, c] = triangle.map(|vertex| vertex as usize - first);
        write!(bytes, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
        if let Some(palette) = palette {
            let [a, b, c] = triangle.map(|vertex| palette.places[vertex as usize]);
            write!(bytes, " pid=\"1\" p1=\"{a}\" p2=\"{b}\" p3=\"{c}\"")?;
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

/// The colours of a mesh, each once, and the place of that of each vertex.
struct Palette {
    colors: Vec<[u8; 3]>,
    places: Vec<u32>,
}

impl Palette {
    fn new(linear: &[[f32; 3]], encoding: ColorEncoding) -> Self {
        let bytes = |color: &[f32; 3]| color.map(|channel| srgb::byte(encoding.encode(channel)));
        let all: Vec<[u8; 3]> = linear.iter().map(bytes).collect();
        let mut colors = all.clone();
        colors.sort_unstable();
        colors.dedup();
        let place = |color: &[u8; 3]| colors.binary_search(color).unwrap_or(0) as u32;
        Self { places: all.iter().map(place).collect(), colors }
    }
}
