//! GLB: binary glTF 2.0 (Khronos Group 2021).
//!
//! ```text
//!     "glTF" 2 length | length "JSON" text, padded by spaces | length "BIN" positions normals color uv others indices
//! ```
//!
//! One node, which turns the model's z upwards to glTF's y and moves the mesh to its origin, and one mesh of
//! one primitive.
//!
//! Colours are in `COLOR_0`, linear as glTF takes them; uv in `TEXCOORD_0`, as (u, 1 - v), because glTF's v
//! goes down; every other attribute is `_NAME` in capitals, as glTF wants application-specific ones. An
//! accessor has at most four reals, so wider ones are `_NAME_0`, `_NAME_1` and so on, of four reals each but
//! for the last. Accessors must not be empty, so a mesh without triangles is a scene without nodes.
//!
//! A coloured mesh has no material, and so glTF's default, which is white: trimesh gives colours up for any
//! material, and everybody else shows them with none. A mesh without colours has a white, rough, non-metallic
//! one.

use std::f64::consts::FRAC_1_SQRT_2;
use std::io::Write;
use std::ops::Range;

use jbt_model::constant::ConstantValues;
use jbt_model::orientation::ModelUp;
use serde_json::{Map, Value, json};

use super::conventions::{ColorEncoding, Colors, Conventions, FarMeshes, FileChoices, Up};
use super::parts::{
    NamedAttribute, WriteError, colors, constant_json, finite, others, push_reals, push_three, uvs,
    write_items,
};
use crate::boxes::Box3;
use crate::mesh::Mesh;

const HEADER_BYTES: u64 = 12;
const CHUNK_HEADER_BYTES: u64 = 8;

/// A buffer view's target: what a vertex is made of, or which vertices a triangle has.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// An accessor's component type.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
/// The most reals of an accessor's element.
const WIDEST: usize = 4;

/// What is usual in these files.
pub(super) const CONVENTIONS: Conventions = Conventions {
    extension: "glb",
    title: "glTF 2.0, binary",
    up: Up::Y,
    normals: "`NORMAL`",
    colors: Some(Colors { place: "`COLOR_0`, 32-bit floats", encoding: ColorEncoding::Linear }),
    uv: Some("`TEXCOORD_0`, v downwards"),
    attributes: Some("`_NAME`, 32-bit floats"),
    name: Some("node and mesh"),
    constants: Some("`extras` of the node"),
    far: FarMeshes::Node,
    splits: true,
    materials: false,
    unit: None,
};

pub(super) fn write(mesh: &Mesh, choices: FileChoices<'_>, out: &mut impl Write) -> Result<(), WriteError> {
    let attributes = others(mesh, &[], spell);
    let (json, binary) = describe(mesh, choices, &attributes);
    // Printing a JSON value cannot fail.
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunk = |bytes: u64| if bytes == 0 { 0 } else { CHUNK_HEADER_BYTES + bytes };
    let size = HEADER_BYTES + chunk(text.len() as u64) + chunk(binary);
    let Ok(length) = u32::try_from(size) else {
        return Err(WriteError::TooLarge(size));
    };

    // Every length below is smaller than that of the file, which fits.
    out.write_all(b"glTF")?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    if binary > 0 {
        out.write_all(&(binary as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        write_binary(mesh, choices, &attributes, out)?;
    }
    Ok(())
}

/// The names of an attribute's accessors.
fn spell(stem: &str, width: usize) -> Vec<String> {
    let stem = stem.to_ascii_uppercase();
    match width.div_ceil(WIDEST) {
        1 => vec![format!("_{stem}")],
        parts => (0..parts).map(|part| format!("_{stem}_{part}")).collect(),
    }
}

fn write_binary(
    mesh: &Mesh,
    choices: FileChoices<'_>,
    attributes: &[NamedAttribute<'_>],
    out: &mut impl Write,
) -> Result<(), WriteError> {
    let three = |reals: [f32; 3], bytes: &mut Vec<u8>| {
        push_three(bytes, reals.map(f32::to_bits));
        Ok(())
    };
    let count = mesh.positions.len();
    write_items(out, count, |vertex, bytes| three(mesh.positions[vertex], bytes))?;
    write_items(out, count, |vertex, bytes| three(mesh.normals[vertex], bytes))?;
    if let Some(colors) = colors(mesh) {
        let color = |vertex: usize| colors[vertex].map(|channel| choices.colors.encode(channel));
        write_items(out, count, |vertex, bytes| three(color(vertex), bytes))?;
    }
    // glTF forbids infinities and NaN.
    if let Some(uvs) = uvs(mesh) {
        write_items(out, count, |vertex, bytes| {
            push_reals(bytes, [finite(uvs[2 * vertex]), finite(1.0 - uvs[2 * vertex + 1])]);
            Ok(())
        })?;
    }
    for NamedAttribute { names, attribute } in attributes {
        for part in 0..names.len() {
            let reals = WIDEST * part..attribute.width.min(WIDEST * (part + 1));
            write_items(out, count, |vertex, bytes| {
                let values = &attribute.values[attribute.width * vertex..][reals.clone()];
                push_reals(bytes, values.iter().map(|&value| finite(value)));
                Ok(())
            })?;
        }
    }
    let pieces = mesh.pieces();
    write_items(out, mesh.triangles.len(), |triangle, bytes| {
        // Of a piece, whose vertices count from its first one.
        let piece = &pieces[pieces.partition_point(|piece| piece.triangles.end <= triangle)];
        let first = piece.vertices.start as u32;
        push_three(bytes, mesh.triangles[triangle].map(|vertex| vertex - first));
        Ok(())
    })?;
    Ok(())
}

/// The buffer views, one for every plane of numbers, and accessors, one for each of them and each piece, in
/// the order of the bytes.
#[derive(Default)]
struct BufferLayout {
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: u64,
}

/// A plane of numbers: its view, and the width of its elements.
#[derive(Clone, Copy)]
struct BufferPlane {
    view: usize,
    component: u32,
    width: usize,
}

impl BufferLayout {
    /// Adds a view of `count` elements of `width` four-byte numbers.
    fn plane(&mut self, target: u32, component: u32, width: usize, count: usize) -> BufferPlane {
        let length = 4 * width as u64 * count as u64;
        let view = self.views.len();
        self.views
            .push(json!({ "buffer": 0, "byteOffset": self.bytes, "byteLength": length, "target": target }));
        self.bytes += length;
        BufferPlane { view, component, width }
    }

    /// Adds an accessor to some elements of a plane. Returns its index.
    fn accessor(&mut self, plane: BufferPlane, elements: Range<usize>) -> usize {
        let BufferPlane { view, component, width } = plane;
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let count = elements.len();
        let mut accessor =
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
        if elements.start > 0 {
            accessor["byteOffset"] = json!(4 * width as u64 * elements.start as u64);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// The JSON text, and how many bytes the binary chunk has.
fn describe(mesh: &Mesh, choices: FileChoices<'_>, attributes: &[NamedAttribute<'_>]) -> (Value, u64) {
    let asset = json!({ "version": "2.0", "generator": "jbt" });
    if mesh.triangles.is_empty() {
        return (json!({ "asset": asset, "scene": 0, "scenes": [{}] }), 0);
    }
    let count = mesh.positions.len();
    let mut layout = BufferLayout::default();
    let mut planes: Vec<(String, BufferPlane)> = Vec::new();
    let mut plane = |name: &str, width: usize| {
        planes.push((name.to_owned(), layout.plane(ARRAY_BUFFER, FLOAT, width, count)));
    };
    plane("POSITION", 3);
    plane("NORMAL", 3);
    if colors(mesh).is_some() {
        plane("COLOR_0", 3);
    }
    if uvs(mesh).is_some() {
        plane("TEXCOORD_0", 2);
    }
    for NamedAttribute { names, attribute } in attributes {
        for (part, name) in names.iter().enumerate() {
            plane(name, WIDEST.min(attribute.width - WIDEST * part));
        }
    }
    let indices = layout.plane(ELEMENT_ARRAY_BUFFER, UNSIGNED_INT, 1, 3 * mesh.triangles.len());
    let (mut nodes, mut meshes) = (Vec::new(), Vec::new());
    let pieces = mesh.pieces().into_iter().enumerate();
    for (place, piece) in pieces.filter(|(_, piece)| !piece.triangles.is_empty()) {
        let mut vertex = Map::new();
        for (name, plane) in &planes {
            let accessor = layout.accessor(*plane, piece.vertices.clone());
            vertex.insert(name.clone(), json!(accessor));
        }
        // In f64, so that their decimals are those of the same numbers in any parser.
        let bounds = Box3::around(&mesh.positions[piece.vertices.clone()]).unwrap_or_default();
        let Box3 { low, high } = bounds.map(|corner| corner.map(f64::from));
        let positions = &vertex["POSITION"].as_u64().unwrap_or_default();
        layout.accessors[*positions as usize]["min"] = json!(low);
        layout.accessors[*positions as usize]["max"] = json!(high);
        let corners = 3 * piece.triangles.start..3 * piece.triangles.end;
        let indices = layout.accessor(indices, corners);
        let mut primitive = json!({ "attributes": vertex, "indices": indices });
        if colors(mesh).is_none() {
            primitive["material"] = json!(0);
        }
        let (mut node, mut shape) = (node(mesh, choices), json!({ "primitives": [primitive] }));
        node["mesh"] = json!(meshes.len());
        say(&mut node, &mut shape, piece.name.or(choices.name), choices.constants_of(place));
        nodes.push(node);
        meshes.push(shape);
    }
    let mut json = json!({
        "asset": asset,
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": meshes,
        "accessors": layout.accessors,
        "bufferViews": layout.views,
        "buffers": [{ "byteLength": layout.bytes }],
    });
    if colors(mesh).is_none() {
        json["materials"] = json!([{ "pbrMetallicRoughness": {
            "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.7
        } }]);
    }
    (json, layout.bytes)
}

/// Says what a piece is called, and what its leaves are of.
fn say(node: &mut Value, shape: &mut Value, name: Option<&str>, constants: &[ConstantValues]) {
    if let Some(name) = name {
        node["name"] = json!(name);
        shape["name"] = json!(name);
    }
    if let Some(extras) = extras(constants) {
        node["extras"] = extras;
    }
}

/// The constants of a piece: a value, or a list where leaves differ.
fn extras(constants: &[ConstantValues]) -> Option<Value> {
    let entry = |ConstantValues { name, values }: &ConstantValues| {
        let told = match &values[..] {
            [one] => constant_json(one),
            several => several.iter().map(constant_json).collect(),
        };
        (name.clone(), told)
    };
    (!constants.is_empty()).then(|| Value::Object(constants.iter().map(entry).collect()))
}

/// The node that places the mesh. Positions and normals are those of the model; glTF is y-up, and the node
/// turns it there, then moves it to its origin.
fn node(mesh: &Mesh, choices: FileChoices<'_>) -> Value {
    // A quaternion (x, y, z, w): by 90 degrees about x, one way or the other.
    let turned = |x: f64| json!({ "mesh": 0, "rotation": [x, 0.0, 0.0, FRAC_1_SQRT_2] });
    let mut node = match (choices.model, choices.up) {
        (ModelUp::Z, Up::Y) => turned(-FRAC_1_SQRT_2),
        (ModelUp::Y, Up::Z) => turned(FRAC_1_SQRT_2),
        (ModelUp::Z, Up::Z) | (ModelUp::Y, Up::Y) => json!({ "mesh": 0 }),
    };
    if !mesh.is_about_world() {
        node["translation"] = json!(choices.place(mesh.origin));
    }
    node
}
