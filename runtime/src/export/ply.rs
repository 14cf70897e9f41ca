//! PLY, binary little-endian (Turk 1994).
//!
//! Per vertex `x y z nx ny nz` in f32, `red green blue` in eight bits if there is a colour, `s t` in f32 if there is a uv, and every
//! other attribute in f32: `name` if it is one real, `name_0 name_1 ...` if it is more.

use std::io::Write;

use super::{ExportError, Named, clamp_color, colors, others, uvs, write_reals};
use crate::mesh::Mesh;

/// The names of the properties that are always what they are.
const RESERVED: [&str; 11] = ["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "s", "t"];

pub(super) fn write(mesh: &Mesh, out: &mut impl Write) -> Result<(), ExportError> {
    let attributes = others(mesh, &RESERVED, spell);
    let (colors, uvs) = (colors(mesh), uvs(mesh));
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment jbt")?;
    if colors.is_some() {
        writeln!(out, "comment red, green and blue are linear, clamped to 0..1 and rounded to 8 bits")?;
    }
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
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

    for (vertex, (position, normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
        write_reals(out, position.iter().chain(normal).copied())?;
        if let Some(colors) = colors {
            let color = &colors[3 * vertex..3 * vertex + 3];
            // In 0 .. 255 after the clamp.
            out.write_all(&[0, 1, 2].map(|c| (clamp_color(color[c]) * 255.0).round() as u8))?;
        }
        if let Some(uvs) = uvs {
            write_reals(out, uvs[2 * vertex..2 * vertex + 2].iter().copied())?;
        }
        for Named { attribute, .. } in &attributes {
            let start = vertex * attribute.width;
            write_reals(out, attribute.values[start..start + attribute.width].iter().copied())?;
        }
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for vertex in triangle {
            out.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}

/// A property for each real of an attribute.
fn spell(stem: &str, width: usize) -> Vec<String> {
    match width {
        1 => vec![stem.to_owned()],
        width => (0..width).map(|component| format!("{stem}_{component}")).collect(),
    }
}
