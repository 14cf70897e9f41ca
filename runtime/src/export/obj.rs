//! Wavefront OBJ: text, with colours behind the positions as many programs read them. Numbers are the shortest that give
//! the same f32 back (or the same encoded colour). A uv is `vt`; the format has no place for other attributes.

use std::io::Write;

use super::{Choices, ExportError, colors, finite, uvs};
use crate::mesh::Mesh;

pub(super) fn write(mesh: &Mesh, choices: Choices, out: &mut impl Write) -> Result<(), ExportError> {
    let Choices { up, colors: encoding } = choices;
    writeln!(out, "# jbt, {up} up")?;
    let mut places = mesh.positions.iter().map(|&position| up.place(position));
    match colors(mesh) {
        Some(colors) => {
            writeln!(out, "# v x y z red green blue: {encoding}, clamped to 0..1")?;
            for ([x, y, z], color) in places.zip(colors) {
                let [r, g, b] = color.map(|channel| encoding.encode(channel));
                writeln!(out, "v {x} {y} {z} {r} {g} {b}")?;
            }
        }
        None => places.try_for_each(|[x, y, z]| writeln!(out, "v {x} {y} {z}"))?,
    }
    for [x, y, z] in mesh.normals.iter().map(|&normal| up.place(normal)) {
        writeln!(out, "vn {x} {y} {z}")?;
    }
    let uvs = uvs(mesh);
    for uv in uvs.into_iter().flat_map(|uvs| uvs.chunks_exact(2)) {
        writeln!(out, "vt {} {}", finite(uv[0]), finite(uv[1]))?;
    }
    for triangle in &mesh.triangles {
        // Counted from 1, which may be one more than a u32 holds.
        let [a, b, c] = triangle.map(|vertex| u64::from(vertex) + 1);
        match uvs {
            Some(_) => writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?,
            None => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?,
        }
    }
    Ok(())
}
