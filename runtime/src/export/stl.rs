//! Binary STL: triangles and nothing else. The normal of a facet follows from its corners, and is zero if it
//! has no area.

use std::io::Write;

use super::conventions::{Conventions, FarMeshes, FileChoices, Up};
use super::parts::{WriteError, push_reals, write_items};
use crate::mesh::{Mesh, area_vector, unit};

/// Readers take a file for text if it begins with "solid"; this does not.
const HEADER: [u8; 80] = {
    let mut header = [b' '; 80];
    let text = b"binary STL by jbt";
    let mut i = 0;
    while i < text.len() {
        header[i] = text[i];
        i += 1;
    }
    header
};

/// What is usual in these files.
pub(super) const CONVENTIONS: Conventions = Conventions {
    extension: "stl",
    title: "stereolithography, binary",
    up: Up::Z,
    normals: "of the triangles",
    colors: None,
    uv: None,
    attributes: None,
    name: None,
    constants: None,
    far: FarMeshes::Rounded,
    splits: false,
    materials: false,
    unit: None,
};

pub(super) fn write(mesh: &Mesh, choices: FileChoices<'_>, out: &mut impl Write) -> Result<(), WriteError> {
    let size = mesh.triangles.len() as u64;
    let Ok(count) = u32::try_from(size) else {
        return Err(WriteError::TooLarge(size));
    };
    out.write_all(&HEADER)?;
    out.write_all(&count.to_le_bytes())?;
    write_items(out, mesh.triangles.len(), |triangle, bytes| {
        let triangle = mesh.triangles[triangle];
        let corners = triangle.map(|vertex| choices.place(mesh.positions[vertex as usize]));
        let normal = unit(area_vector(corners)).unwrap_or([0.0; 3]);
        let rounded = |vertex: u32| choices.place(mesh.world(vertex as usize).map(|x| x as f32));
        push_reals(bytes, normal.into_iter().chain(triangle.map(rounded).into_iter().flatten()));
        // The attribute byte count, which has no agreed meaning.
        bytes.extend_from_slice(&[0, 0]);
        Ok(())
    })?;
    Ok(())
}
