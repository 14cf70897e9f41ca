//! USDA, the text of Universal Scene Description: one mesh below a transform, which has the origin.
//!
//! Numbers are the shortest that give the same f32 back. Attributes are primvars of each vertex:
//! `displayColor`, which is linear, `st` and `primvars:name` with as many elements as the attribute is
//! wide.

use std::fmt::Display;
use std::fmt::Write as _;
use std::io::Write;

use jbt_model::constant::{ConstantValues, LeafConstant};

use super::conventions::{ColorEncoding, Colors, Conventions, FarMeshes, FileChoices, LengthUnit, Up};
use super::parts::{NamedAttribute, WriteError, colors, finite, others, told, uvs, write_items};
use crate::mesh::{Mesh, MeshPiece};

/// What is usual in these files.
pub(super) const CONVENTIONS: Conventions = Conventions {
    extension: "usda",
    title: "Universal Scene Description, text",
    up: Up::Z,
    normals: "`normals`",
    colors: Some(Colors { place: "`displayColor`, decimals", encoding: ColorEncoding::Linear }),
    uv: Some("`st`"),
    attributes: Some("`primvars`, decimals"),
    name: Some("`displayName`"),
    constants: Some("`customData` of the mesh"),
    far: FarMeshes::Node,
    splits: true,
    materials: false,
    unit: Some(LengthUnit::Metre),
};

/// Names that are always what they are.
const RESERVED: [&str; 2] = ["displayColor", "st"];

pub(super) fn write(mesh: &Mesh, choices: FileChoices<'_>, out: &mut impl Write) -> Result<(), WriteError> {
    let FileChoices { up, unit, .. } = choices;
    let axis = match up {
        Up::Y => "Y",
        Up::Z => "Z",
    };
    writeln!(out, "#usda 1.0\n(\n    defaultPrim = \"model\"\n    doc = \"jbt\"")?;
    writeln!(out, "    metersPerUnit = {}\n    upAxis = \"{axis}\"\n)\n", unit.metres())?;
    writeln!(out, "def Xform \"model\" (\n    kind = \"component\"\n)\n{{")?;
    if !mesh.is_about_world() {
        let [x, y, z] = choices.place(mesh.origin);
        writeln!(out, "    double3 xformOp:translate = ({x}, {y}, {z})")?;
        writeln!(out, "    uniform token[] xformOpOrder = [\"xformOp:translate\"]")?;
    }
    let attributes = others(mesh, &RESERVED, spell);
    for (place, piece) in mesh.pieces().iter().enumerate() {
        write_piece(mesh, choices, (place, piece), &attributes, out)?;
    }
    writeln!(out, "}}")?;
    Ok(())
}

/// A mesh for a piece, with its number.
fn write_piece(
    mesh: &Mesh,
    choices: FileChoices<'_>,
    (place, piece): (usize, &MeshPiece<'_>),
    attributes: &[NamedAttribute<'_>],
    out: &mut impl Write,
) -> Result<(), WriteError> {
    let encoding = choices.colors;
    let prim = if place == 0 { "mesh".to_owned() } else { format!("mesh_{place}") };
    let said = metadata(piece.name.or(choices.name), choices.constants_of(place));
    writeln!(out, "    def Mesh \"{prim}\"{said}\n    {{")?;
    let first = piece.vertices.start;
    let corner = |pick: fn(f32, f32) -> f32| {
        let all = mesh.positions[piece.vertices.clone()].iter().map(|&position| choices.place(position));
        all.reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis]))).unwrap_or_default()
    };
    let tuple = |[x, y, z]: [f32; 3]| format!("({x}, {y}, {z})");
    writeln!(out, "        float3[] extent = [{}, {}]", tuple(corner(f32::min)), tuple(corner(f32::max)))?;
    writeln!(out, "        uniform token subdivisionScheme = \"none\"")?;
    let (vertices, triangles) = (piece.vertices.len(), piece.triangles.len());
    list(out, "int[] faceVertexCounts", triangles, |_| 3, "")?;
    list(
        out,
        "int[] faceVertexIndices",
        triangles,
        |triangle| {
            let [a, b, c] =
                mesh.triangles[piece.triangles.start + triangle].map(|vertex| vertex as usize - first);
            format!("{a}, {b}, {c}")
        },
        "",
    )?;
    list(
        out,
        "point3f[] points",
        vertices,
        |vertex| tuple(choices.place(mesh.positions[first + vertex])),
        "",
    )?;
    list(
        out,
        "normal3f[] normals",
        vertices,
        |vertex| tuple(choices.place(mesh.normals[first + vertex])),
        EACH,
    )?;
    if let Some(colors) = colors(mesh) {
        let color = |vertex: usize| tuple(colors[first + vertex].map(|channel| encoding.encode(channel)));
        list(out, "color3f[] primvars:displayColor", vertices, color, EACH)?;
    }
    if let Some(uvs) = uvs(mesh) {
        let uv = |vertex: usize| {
            format!("({}, {})", finite(uvs[2 * (first + vertex)]), finite(uvs[2 * (first + vertex) + 1]))
        };
        list(out, "texCoord2f[] primvars:st", vertices, uv, EACH)?;
    }
    write_attributes(attributes, piece, out)?;
    writeln!(out, "    }}")?;
    Ok(())
}

/// What is said of a mesh in front of its numbers.
fn metadata(name: Option<&str>, constants: &[ConstantValues]) -> String {
    // Line ends and quotes would end it.
    let quoted = |text: &str| text.replace(['\\', '"'], "_").replace(char::is_control, "_");
    let mut said = String::new();
    if let Some(name) = name {
        let _ = writeln!(said, "        displayName = \"{}\"", quoted(name));
    }
    if !constants.is_empty() {
        said.push_str("        customData = {\n");
        for constant in constants {
            let _ = match &constant.values[..] {
                [LeafConstant::Whole(number)] => {
                    writeln!(said, "            int64 \"{}\" = {number}", quoted(&constant.name))
                }
                _ => {
                    let value = quoted(&told(constant));
                    writeln!(said, "            string \"{}\" = \"{value}\"", quoted(&constant.name))
                }
            };
        }
        said.push_str("        }\n");
    }
    if said.is_empty() { said } else { format!(" (\n{said}    )") }
}

/// The attributes of the vertices of a piece.
fn write_attributes(
    attributes: &[NamedAttribute<'_>],
    piece: &MeshPiece<'_>,
    out: &mut impl Write,
) -> Result<(), WriteError> {
    let (first, vertices) = (piece.vertices.start, piece.vertices.len());
    for NamedAttribute { names, attribute } in attributes {
        let (width, name) = (attribute.width, format!("float[] primvars:{}", names[0]));
        let values = |vertex: usize| {
            let vertex = first + vertex;
            let values = &attribute.values[width * vertex..width * (vertex + 1)];
            values.iter().map(|&value| finite(value).to_string()).collect::<Vec<_>>().join(", ")
        };
        let about = format!(
            " (\n            elementSize = {width}\n            interpolation = \"vertex\"\n        )"
        );
        list(out, &name, vertices, values, if width == 1 { EACH } else { &about })?;
    }
    Ok(())
}

/// What a list has for each vertex.
const EACH: &str = " (\n            interpolation = \"vertex\"\n        )";

/// A list of items.
fn list<T: Display>(
    out: &mut impl Write,
    name: &str,
    count: usize,
    item: impl Fn(usize) -> T + Sync,
    about: &str,
) -> Result<(), WriteError> {
    write!(out, "        {name} = [")?;
    write_items(out, count, |index, bytes| {
        let between = match index {
            0 => "",
            _ if index % 8 == 0 => ",\n            ",
            _ => ", ",
        };
        write!(bytes, "{between}{}", item(index))
    })?;
    writeln!(out, "]{about}")?;
    Ok(())
}

/// One name, which begins with no digit.
fn spell(stem: &str, _: usize) -> Vec<String> {
    let is_number = stem.starts_with(|first: char| first.is_ascii_digit());
    vec![if is_number { format!("_{stem}") } else { stem.to_owned() }]
}
