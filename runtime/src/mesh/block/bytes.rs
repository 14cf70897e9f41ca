//! Blocks as bytes.

use jbt_ir::limits::{MAX_ATTRIBUTE_WIDTH, MAX_ATTRIBUTES};
use jbt_model::orientation::{Handed, ModelUp, Orientation};

use super::super::indexed::{Attribute, Creases, Mesh};
use super::super::report::Sides;
use super::{MeshBlock, VertexName};
use crate::bytes::{ByteReader, ByteWriter, FormatError};

/// The first bytes, and the version of what follows.
const WORD: &[u8; 8] = b"jbtblock";
const VERSION: u32 = 1;

impl MeshBlock {
    /// The block as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self { place, mesh, below, corners, seams, is_open, cut_sides } = self;
        let mut writer = ByteWriter::new(WORD, VERSION);
        place.iter().for_each(|&index| writer.u32(index));
        mesh.origin.into_iter().for_each(|x| writer.f64(x));
        writer.u8(u8::from(mesh.orientation.up == ModelUp::Z));
        writer.u8(u8::from(mesh.orientation.handed == Handed::Left));
        writer.u8(u8::from(*is_open));
        cut_sides.low.into_iter().chain(cut_sides.high).for_each(|side| writer.u8(u8::from(side)));
        writer.f32s(mesh.positions.as_flattened());
        writer.f32s(mesh.normals.as_flattened());
        writer.count(mesh.attributes.len());
        for Attribute { name, width, values } in &mesh.attributes {
            writer.text(name);
            writer.u32(*width as u32);
            writer.f32s(values);
        }
        writer.u32s(mesh.triangles.as_flattened());
        let name = |name: &VertexName| [name.cell[0], name.cell[1], name.cell[2], name.sheet];
        writer.u32s(below.iter().map(name).collect::<Vec<_>>().as_flattened());
        writer.u32s(seams.iter().map(|(it, _)| name(it)).collect::<Vec<_>>().as_flattened());
        writer.u32s(&seams.iter().map(|(_, vertex)| *vertex).collect::<Vec<_>>());
        writer.u32s(&mesh.creases.vertices);
        writer.f32s(mesh.creases.normals.as_flattened());
        writer.count(mesh.creases.attributes.len());
        mesh.creases.attributes.iter().for_each(|values| writer.f32s(values));
        writer.u32s(corners.as_flattened());
        writer.into_bytes()
    }

    /// Reads a block.
    ///
    /// # Errors
    /// Where the bytes are no block of this version, or its numbers do not go together; want of memory.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        let mut reader = ByteReader::new(bytes, WORD, VERSION)?;
        // Lists, and what is made of them.
        reader.afford(2)?;
        let place = [reader.u32()?, reader.u32()?, reader.u32()?];
        let origin = [reader.f64()?, reader.f64()?, reader.f64()?];
        let up = reader.one_of(&[ModelUp::Y, ModelUp::Z])?;
        let handed = reader.one_of(&[Handed::Right, Handed::Left])?;
        let is_open = reader.flag()?;
        let mut sides = [false; 6];
        for side in &mut sides {
            *side = reader.flag()?;
        }
        let [a, b, c, d, e, f] = sides;
        let (positions, normals) = (reader.f32s()?, reader.f32s()?);
        let mut attributes = Vec::new();
        for _ in 0..reader.count(20)?.min(MAX_ATTRIBUTES + 1) {
            let (name, width) = (reader.text()?.to_owned(), reader.below(MAX_ATTRIBUTE_WIDTH + 1)?);
            attributes.push(Attribute { name, width, values: reader.f32s()? });
        }
        let (triangles, below, seams) = (reader.u32s()?, reader.u32s()?, reader.u32s()?);
        let vertices = reader.u32s()?;
        let (mut creases, normals_of_sides) =
            (Creases { vertices: reader.u32s()?, ..Creases::default() }, reader.f32s()?);
        for _ in 0..reader.count(4)?.min(MAX_ATTRIBUTES + 1) {
            creases.attributes.push(reader.f32s()?);
        }
        creases.normals = normals_of_sides.as_chunks().0.to_vec();
        let corners = reader.u32s()?;
        let name = |&[x, y, z, sheet]: &[u32; 4]| VertexName { cell: [x, y, z], sheet };
        let whole = normals_of_sides.len() % 3 == 0 && corners.len() % 2 == 0;
        let whole = whole && positions.len() % 3 == 0 && normals.len() % 3 == 0 && triangles.len() % 3 == 0;
        if !whole || below.len() % 4 != 0 || seams.len() != 4 * vertices.len() {
            return Err(reader.error("lists of vertices, triangles or names end in the middle of one"));
        }
        let made = Self {
            place,
            mesh: Mesh {
                origin,
                orientation: Orientation { up, handed },
                positions: positions.as_chunks().0.to_vec(),
                normals: normals.as_chunks().0.to_vec(),
                attributes,
                triangles: triangles.as_chunks().0.to_vec(),
                creases,
                parts: Vec::new(),
            },
            corners: corners.as_chunks().0.to_vec(),
            below: below.as_chunks().0.iter().map(name).collect(),
            seams: seams.as_chunks().0.iter().map(name).zip(vertices).collect(),
            is_open,
            cut_sides: Sides { low: [a, b, c], high: [d, e, f] },
        };
        made.check().map_err(|problem| reader.error(problem.to_string()))?;
        reader.end()?;
        Ok(made)
    }
}
