//! PLY, binary little-endian (Turk 1994).
//!
//! Per vertex `x y z` in f32, or in f64 if the mesh has an origin of its own, `nx ny nz` in f32, `red green
//! blue` in eight bits if there is a colour, `s t` in f32 if there is a uv, and every
//! other attribute in f32: `name` if it is one real, `name_0 name_1 ...` if it is more.

use std::io::Write;

use super::conventions::{ColorEncoding, Colors, Conventions, FarMeshes, FileChoices, Up};
use super::parts::{
    NamedAttribute, WriteError, colors, in_one_line, others, push_reals, push_three, told, uvs, write_items,
};
use crate::mesh::Mesh;
use crate::srgb;

/// The names of the properties that are always what they are.
const RESERVED: [&str; 11] = ["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "s", "t"];

/// What is usual in these files.
pub(super) const CONVENTIONS: Conventions = Conventions {
    extension: "ply",
    title: "Stanford polygons, binary",
    up: Up::Z,
    normals: "`nx ny nz`",
    colors: Some(Colors { place: "`red green blue`, 8 bits", encoding: ColorEncoding::Srgb }),
    uv: Some("`s t`"),
    attributes: Some("properties, 32-bit floats"),
    name: None,
    constants: Some("`comment`"),
    far: FarMeshes::Digits,
    splits: true,
    materials: false,
    unit: None,
};

pub(super) fn write(mesh: &Mesh, choices: FileChoices<'_>, out: &mut impl Write) -> Result<(), WriteError> {
    let FileChoices { up, colors: encoding, .. } = choices;
    let attributes = others(mesh, &RESERVED, spell);
    let (colors, uvs) = (colors(mesh), uvs(mesh));
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment jbt, {up} up")?;
    if colors.is_some() {
        writeln!(out, "comment red, green and blue are {encoding}, clamped to 0..1 and rounded to 8 bits")?;
    }
    for (place, piece) in mesh.pieces().iter().enumerate() {
        let part = piece.name.map_or_else(String::new, |name| format!("{}: ", in_one_line(name)));
        for constant in choices.constants_of(place) {
            writeln!(out, "comment {part}{} {}", in_one_line(&constant.name), told(constant))?;
        }
    }
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    let is_far = !mesh.is_about_world();
    for name in ["x", "y", "z"] {
        writeln!(out, "property {} {name}", if is_far { "double" } else { "float" })?;
    }
    for name in ["nx", "ny", "nz"] {
        writeln!(out, "property float {name}")?;
    }
    if colors.is_some() {
        writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
    }
    if uvs.is_some() {
        writeln!(out, "property float s\nproperty float t")?;
    }
    for name in attributes.iter().flat_map(|attribute| &attribute.names) {
        writeln!(out, "property float {name}")?;
    }
    writeln!(out, "element face {}", mesh.triangles.len())?;
    writeln!(out, "property list uchar uint vertex_indices\nend_header")?;

    write_items(out, mesh.positions.len(), |vertex, bytes| {
        if is_far {
            let place = choices.place(mesh.world(vertex));
            place.iter().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
        } else {
            push_reals(bytes, choices.place(mesh.positions[vertex]));
        }
        push_reals(bytes, choices.place(mesh.normals[vertex]));
        if let Some(colors) = colors {
            bytes.extend_from_slice(&colors[vertex].map(|channel| srgb::byte(encoding.encode(channel))));
        }
        if let Some(uvs) = uvs {
            push_reals(bytes, uvs[2 * vertex..2 * vertex + 2].iter().copied());
        }
        for NamedAttribute { attribute, .. } in &attributes {
            let start = vertex * attribute.width;
            push_reals(bytes, attribute.values[start..start + attribute.width].iter().copied());
        }
        Ok(())
    })?;
    write_items(out, mesh.triangles.len(), |triangle, bytes| {
        bytes.push(3);
        push_three(bytes, mesh.triangles[triangle]);
        Ok(())
    })?;
    Ok(())
}

/// A property for each real of an attribute.
fn spell(stem: &str, width: usize) -> Vec<String> {
    match width {
        1 => vec![stem.to_owned()],
        width => (0..width).map(|component| format!("{stem}_{component}")).collect(),
    }
}
