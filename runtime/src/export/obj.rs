//! Wavefront OBJ: text, with colours behind the positions as many programs read them. Numbers are the shortest that give
//! the same f32 back. A uv is `vt`; the format has no place for other attributes.

use std::io::Write;

use super::{ExportError, clamp_color, colors, finite, uvs};
use crate::mesh::Mesh;

pub(super) fn write(mesh: &Mesh, out: &mut impl Write) -> Result<(), ExportError> {
    writeln!(out, "# jbt")?;
    match colors(mesh) {
        Some(colors) => {
            writeln!(out, "# v x y z red green blue: linear, clamped to 0..1")?;
            for ([x, y, z], color) in mesh.positions.iter().zip(colors.chunks_exact(3)) {
                let [r, g, b] = [0, 1, 2].map(|c| clamp_color(color[c]));
                writeln!(out, "v {x} {y} {z} {r} {g} {b}")?;
            }
        }
        None => mesh.positions.iter().try_for_each(|[x, y, z]| writeln!(out, "v {x} {y} {z}"))?,
    }
    mesh.normals.iter().try_for_each(|[x, y, z]| writeln!(out, "vn {x} {y} {z}"))?;
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
