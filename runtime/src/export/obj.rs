//! Wavefront OBJ: text, with colours behind the positions as many programs read them. Numbers are the
//! shortest that give the same f32 back (or the same encoded colour, or the same f64 where the mesh has an
//! origin of its own). A uv is `vt`; the format has no place for other attributes.

use std::fmt::Display;
use std::io::Write;
use std::ops::Sub;

use super::conventions::{ColorEncoding, Colors, Conventions, FarMeshes, FileChoices, Up};
use super::parts::{WriteError, colors, finite, in_one_line, told, uvs, write_items};
use crate::mesh::Mesh;

/// What is usual in these files.
pub(super) const CONVENTIONS: Conventions = Conventions {
    extension: "obj",
    title: "Wavefront, text",
    up: Up::Y,
    normals: "`vn`",
    colors: Some(Colors { place: "behind the position, decimals", encoding: ColorEncoding::Srgb }),
    uv: Some("`vt`"),
    attributes: None,
    name: Some("`o`"),
    constants: Some("`#` behind `o`"),
    far: FarMeshes::Digits,
    splits: false,
    materials: false,
    unit: None,
};

pub(super) fn write(mesh: &Mesh, choices: FileChoices<'_>, out: &mut impl Write) -> Result<(), WriteError> {
    let FileChoices { up, colors: encoding, .. } = choices;
    writeln!(out, "# jbt, {up} up")?;
    let object = |name: &str| {
        // A blank would end the name for some readers.
        format!("o {}", name.replace(|c: char| c.is_whitespace() || c.is_control(), "_"))
    };
    if let Some(name) = choices.name.filter(|_| mesh.parts.is_empty()) {
        writeln!(out, "{}", object(name))?;
    }
    if colors(mesh).is_some() {
        writeln!(out, "# v x y z red green blue: {encoding}, clamped to 0..1")?;
    }
    if mesh.is_about_world() {
        write_vertices(mesh, choices, |vertex| mesh.positions[vertex], out)?;
    } else {
        write_vertices(mesh, choices, |vertex| mesh.world(vertex), out)?;
    }
    write_items(out, mesh.normals.len(), |vertex, bytes| {
        let [x, y, z] = choices.place(mesh.normals[vertex]);
        writeln!(bytes, "vn {x} {y} {z}")
    })?;
    // Sides of edges: corners have normals of their own, and positions stay shared.
    write_items(out, mesh.creases.normals.len(), |side, bytes| {
        let [x, y, z] = choices.place(mesh.creases.normals[side]);
        writeln!(bytes, "vn {x} {y} {z}")
    })?;
    let uvs = uvs(mesh);
    if let Some(uvs) = uvs {
        write_items(out, mesh.positions.len(), |vertex, bytes| {
            writeln!(bytes, "vt {} {}", finite(uvs[2 * vertex]), finite(uvs[2 * vertex + 1]))
        })?;
    }
    for (place, piece) in mesh.pieces().into_iter().enumerate() {
        if let Some(name) = piece.name {
            writeln!(out, "{}", object(name))?;
        }
        for constant in choices.constants_of(place) {
            writeln!(out, "# {} {}", in_one_line(&constant.name), told(constant))?;
        }
        let first = piece.triangles.start;
        write_items(out, piece.triangles.len(), |triangle, bytes| {
            let triangle = first + triangle;
            // Counted from 1, which may be one more than a u32 holds.
            let [a, b, c] = mesh.triangles[triangle].map(|vertex| u64::from(vertex) + 1);
            let [i, j, k] = normals_of(mesh, triangle);
            match uvs {
                Some(_) => writeln!(bytes, "f {a}/{a}/{i} {b}/{b}/{j} {c}/{c}/{k}"),
                None => writeln!(bytes, "f {a}//{i} {b}//{j} {c}//{k}"),
            }
        })?;
    }
    Ok(())
}

/// The numbers of a triangle's normals, from 1.
fn normals_of(mesh: &Mesh, triangle: usize) -> [u64; 3] {
    let mut normals = mesh.triangles[triangle].map(|vertex| u64::from(vertex) + 1);
    let corners = &mesh.creases.corners;
    let first = corners.partition_point(|[corner, _]| (*corner as usize) < 3 * triangle);
    for &[corner, side] in corners[first..].iter().take_while(|[corner, _]| *corner as usize / 3 == triangle)
    {
        normals[corner as usize % 3] = mesh.normals.len() as u64 + u64::from(side) + 1;
    }
    normals
}

/// The vertices, at these positions, and their colours.
fn write_vertices<T: Default + Display + Sub<Output = T>>(
    mesh: &Mesh,
    choices: FileChoices<'_>,
    position: impl Fn(usize) -> [T; 3] + Sync,
    out: &mut impl Write,
) -> Result<(), WriteError> {
    let (colors, encoding) = (colors(mesh), choices.colors);
    write_items(out, mesh.positions.len(), |vertex, bytes| {
        let [x, y, z] = choices.place(position(vertex));
        write!(bytes, "v {x} {y} {z}")?;
        if let Some(colors) = colors {
            let [r, g, b] = colors[vertex].map(|channel| encoding.encode(channel));
            write!(bytes, " {r} {g} {b}")?;
        }
        writeln!(bytes)
    })?;
    Ok(())
}
