//! What files of each format hold: they are parsed back by hand, by the words of their specifications.

use jbt_model::constant::{ConstantValues, LeafConstant};
use jbt_model::orientation::{Handed, ModelUp, Orientation};

use super::*;
use crate::mesh::MeshPart;

/// A tetrahedron with awkward colours and attributes.
pub(super) fn tetrahedron() -> Mesh {
    let attribute = |name: &str, width, values: &[f32]| Attribute {
        name: name.to_owned(),
        width,
        values: values.to_vec(),
    };
    let third = 1.0_f32 / 3.0;
    Mesh {
        origin: [0.0; 3],
        orientation: Orientation::default(),
        positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [0.0, 1.0, 0.0], [-0.0, third, 1e-7]],
        normals: vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        attributes: vec![
            attribute("wear & tear", 1, &[0.25, -7.0, f32::NAN, 3.0]),
            attribute("color", 3, &[0.0, 0.5, 1.0, -1.0, 2.0, f32::NAN, 0.2, 0.4, 0.6, 1.0, 1.0, 1.0]),
            attribute("wear_&_tear", 2, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]),
            attribute("x", 4, &[0.5; 16]),
            attribute("x", 1, &[0.75; 4]),
            attribute("x_1", 1, &[1.5; 4]),
            attribute("", 1, &[2.5; 4]),
        ],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        parts: Vec::new(),
        creases: Creases::default(),
    }
}

/// The same with an edge at vertex 1: its second triangle shows a side with another normal and colour.
fn creased() -> Mesh {
    let mesh = tetrahedron();
    let widths = mesh.attributes.iter().map(|attribute| vec![0.25; attribute.width]);
    let creases = Creases {
        vertices: vec![1],
        normals: vec![[0.0, -1.0, 0.0]],
        attributes: widths.collect(),
        corners: vec![[4, 0]],
    };
    Mesh { creases, ..mesh }
}

#[test]
fn edges_have_a_vertex_for_each_side_or_a_normal() {
    let mesh = creased();
    let split = mesh.split();
    assert_eq!((split.positions.len(), split.positions[4]), (5, mesh.positions[1]));
    assert_eq!(split.triangles, [[0, 2, 1], [0, 4, 3], [1, 2, 3], [2, 0, 3]]);
    assert!(split.attributes.iter().all(|attribute| attribute.at(4).iter().all(|&value| value == 0.25)));
    for format in [Format::Glb, Format::Ply, Format::Usda] {
        assert_eq!(bytes(&mesh, format), bytes(&split, format), "{format}");
    }
    assert_eq!(bytes(&mesh, Format::Stl), bytes(&tetrahedron(), Format::Stl));
    let obj = String::from_utf8(bytes(&mesh, Format::Obj)).unwrap();
    assert_eq!(obj.lines().filter(|line| line.starts_with("v ")).count(), 4);
    assert!(obj.contains("vn 0 -0 -1\n") || obj.contains("vn 0 0 1\n"), "{obj}");
    assert!(obj.contains("f 1//1 3//3 2//2\nf 1//1 2//5 4//4\nf 2//2 3//3 4//4\n"), "{obj}");
    let text = three_mf_model(&bytes(&mesh, Format::ThreeMf));
    assert_eq!(text.lines().filter(|line| line.starts_with("<vertex ")).count(), 4);
    assert!(text.contains("<m:color color=\"#898989FF\"/>"), "{text}");
    // A mirror turns triangles around, and their corners with them.
    let left = Orientation { up: ModelUp::Z, handed: Handed::Left };
    let mirrored = Mesh { orientation: left, ..creased() };
    let mirrored = mirrored.right_handed();
    assert_eq!((mirrored.triangles[1], &mirrored.creases.corners[..]), ([0, 3, 1], &[[5, 0]][..]));
    let wrong = |change: fn(&mut Mesh)| {
        let mut mesh = creased();
        change(&mut mesh);
        let error = write(&mesh, Format::Glb, &mut Vec::new()).unwrap_err();
        assert!(matches!(error, ExportError::Malformed(_)), "{error}");
    };
    wrong(|mesh| mesh.creases.corners[0] = [5, 0]);
    wrong(|mesh| mesh.creases.corners[0] = [4, 1]);
    wrong(|mesh| mesh.creases.corners[0] = [99, 0]);
    wrong(|mesh| mesh.creases.vertices[0] = 9);
    wrong(|mesh| mesh.creases.normals[0][1] = f32::NAN);
    wrong(|mesh| mesh.creases.normals.clear());
    wrong(|mesh| mesh.creases.attributes[0].clear());
}

#[test]
fn three_mf_with_a_palette_has_a_material_for_each_triangle() {
    let options = ExportOptions { palette: std::num::NonZeroU16::new(2), ..ExportOptions::default() };
    let mut file = Vec::new();
    write_with(&tetrahedron(), Format::ThreeMf, &options, &mut file).unwrap();
    let text = three_mf_model(&file);
    assert!(text.contains("<basematerials id=\"1\">") && !text.contains("xmlns:m"), "{text}");
    assert_eq!(text.matches("<base name=").count(), 2);
    let triangles: Vec<&str> = text.lines().filter(|line| line.starts_with("<triangle ")).collect();
    assert!(triangles.iter().all(|line| line.contains(" p1=") && !line.contains(" p2=")), "{text}");
}

pub(super) fn bytes(mesh: &Mesh, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(mesh, format, &mut bytes).unwrap();
    bytes
}

fn u32_at(bytes: &[u8], place: usize) -> u32 {
    u32::from_le_bytes(bytes[place..place + 4].try_into().unwrap())
}

pub(super) fn reals(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|chunk| f32::from_le_bytes(chunk.try_into().unwrap())).collect()
}

/// The JSON and the binary chunk of a GLB, with all lengths checked.
pub(super) fn parse_glb(bytes: &[u8]) -> (serde_json::Value, &[u8]) {
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!(u32_at(bytes, 4), 2);
    assert_eq!(u32_at(bytes, 8) as usize, bytes.len());
    let text = u32_at(bytes, 12) as usize;
    assert_eq!(text % 4, 0);
    assert_eq!(&bytes[16..20], b"JSON");
    let json = serde_json::from_slice(&bytes[20..20 + text]).unwrap();
    let rest = &bytes[20 + text..];
    if rest.is_empty() {
        return (json, rest);
    }
    assert_eq!(u32_at(rest, 0) as usize, rest.len() - 8);
    assert_eq!(&rest[4..8], b"BIN\0");
    (json, &rest[8..])
}

#[test]
fn glb_says_what_it_holds() {
    let mesh = tetrahedron();
    let file = bytes(&mesh, Format::Glb);
    let (json, binary) = parse_glb(&file);
    assert_eq!(json["asset"]["version"], "2.0");
    assert_eq!(json["asset"]["generator"], "jbt");
    assert_eq!(json["buffers"][0]["byteLength"], binary.len());
    let primitive = &json["meshes"][0]["primitives"][0];
    let read = |accessor: &serde_json::Value, kind: &str, component: u32, target: u32| {
        let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
        assert_eq!(accessor["type"], kind);
        assert_eq!(accessor["componentType"], component);
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        assert_eq!(view["target"], target);
        let start = view["byteOffset"].as_u64().unwrap() as usize;
        let length = view["byteLength"].as_u64().unwrap() as usize;
        assert_eq!(start % 4, 0);
        let width = ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|k| *k == kind).unwrap() + 1;
        assert_eq!(accessor["count"].as_u64().unwrap() as usize * width * 4, length);
        &binary[start..start + length]
    };
    let attributes = primitive["attributes"].as_object().unwrap();
    let plane = |name: &str, kind| reals(read(&attributes[name], kind, 5126, 34962));
    assert_eq!(plane("POSITION", "VEC3"), mesh.positions.concat());
    assert_eq!(plane("NORMAL", "VEC3"), mesh.normals.concat());
    assert_eq!(plane("COLOR_0", "VEC3"), [0.0, 0.5, 1.0, 0.0, 1.0, 0.0, 0.2, 0.4, 0.6, 1.0, 1.0, 1.0]);
    assert_eq!(plane("_WEAR___TEAR", "SCALAR"), [0.25, -7.0, 0.0, 3.0]);
    assert_eq!(plane("_WEAR___TEAR_2", "VEC2"), mesh.attributes[2].values);
    assert_eq!(plane("_X", "VEC4"), [0.5; 16]);
    assert_eq!(plane("_X_2", "SCALAR"), [0.75; 4]);
    assert_eq!(plane("_X_1", "SCALAR"), [1.5; 4]);
    assert_eq!(plane("_ATTRIBUTE", "SCALAR"), [2.5; 4]);
    assert_eq!(attributes.len(), 9);
    let indices = read(&primitive["indices"], "SCALAR", 5125, 34963);
    let indices: Vec<u32> = indices.chunks_exact(4).map(|chunk| u32_at(chunk, 0)).collect();
    assert_eq!(indices, mesh.triangles.concat());
    let position = &json["accessors"][attributes["POSITION"].as_u64().unwrap() as usize];
    assert_eq!(position["max"][2].as_f64().unwrap(), f64::from(0.1_f32));
    assert_eq!(position["min"], serde_json::json!([0.0, 0.0, 0.0]));
}

/// What trimesh takes for the look of a mesh: the material if there is one, whatever the colours are.
#[test]
fn glb_has_colours_or_a_material() {
    let coloured = bytes(&tetrahedron(), Format::Glb);
    let (json, _) = parse_glb(&coloured);
    let primitive = &json["meshes"][0]["primitives"][0];
    assert!(primitive["attributes"]["COLOR_0"].is_u64() && primitive.get("material").is_none());
    assert!(json.get("materials").is_none());
    let plain = bytes(&Mesh { attributes: Vec::new(), ..tetrahedron() }, Format::Glb);
    let (json, _) = parse_glb(&plain);
    assert_eq!(json["meshes"][0]["primitives"][0]["material"], 0);
    assert_eq!(json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], 0.0);
}

#[test]
fn glb_of_an_empty_mesh_is_an_empty_scene() {
    let mut empty = Mesh::default();
    empty.attributes.push(Attribute { name: "color".to_owned(), width: 3, values: Vec::new() });
    let file = bytes(&empty, Format::Glb);
    let (json, binary) = parse_glb(&file);
    assert!(binary.is_empty());
    for part in ["nodes", "meshes", "accessors", "bufferViews", "buffers"] {
        assert!(json.get(part).is_none(), "{part}");
    }
}

#[test]
fn ply_has_the_size_that_its_header_says() {
    let mesh = tetrahedron();
    let file = bytes(&mesh, Format::Ply);
    let end = b"end_header\n";
    let header = file.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let text = std::str::from_utf8(&file[..header]).unwrap();
    assert!(text.starts_with("ply\nformat binary_little_endian 1.0\n"));
    assert!(text.lines().any(|line| line.starts_with("comment") && line.contains("srgb")));
    let properties: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("property ")).collect();
    assert_eq!(
        properties.join(", "),
        "float x, float y, float z, float nx, float ny, float nz, uchar red, uchar green, uchar blue, \
         float wear___tear, float wear___tear_0, float wear___tear_1, \
         float x_0, float x_1, float x_2, float x_3, float x_4, float x_1_2, float attribute, list uchar uint vertex_indices"
    );
    assert!(text.contains("\nelement vertex 4\n") && text.contains("\nelement face 4\n"));
    let vertex = 6 * 4 + 3 + 10 * 4;
    let body = &file[header..];
    assert_eq!(body.len(), 4 * vertex + 4 * 13);
    assert_eq!(reals(&body[vertex..vertex + 24]), [1.0, 0.0, 0.1, 1.0, 0.0, 0.0]);
    assert_eq!(body[24..27], [0, 188, 255]);
    assert_eq!(body[vertex + 24..vertex + 27], [0, 255, 0]);
    assert_eq!(body[2 * vertex + 24..2 * vertex + 27], [124, 170, 203]);
    assert_eq!(reals(&body[27..31]), [0.25]);
    let face = &body[4 * vertex + 13..4 * vertex + 26];
    assert_eq!((face[0], u32_at(face, 1), u32_at(face, 5), u32_at(face, 9)), (3, 0, 1, 3));
}

#[test]
fn obj_gives_every_number_back() {
    let mesh = tetrahedron();
    let text = String::from_utf8(bytes(&mesh, Format::Obj)).unwrap();
    let lines = |word: &str| -> Vec<Vec<String>> {
        let words = text.lines().map(|line| line.split(' ').map(str::to_owned).collect::<Vec<_>>());
        words.filter(|words| words[0] == word).collect()
    };
    let numbers =
        |words: &[String]| words[1..].iter().map(|word| word.parse().unwrap()).collect::<Vec<f32>>();
    for (line, position) in lines("v").iter().zip(&mesh.positions) {
        let parsed = numbers(line);
        assert_eq!(parsed.len(), 6);
        let [x, y, z] = *position;
        assert!(parsed.iter().zip([x, z, 0.0 - y]).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert!(parsed[3..].iter().all(|c| (0.0..=1.0).contains(c)));
    }
    let normals: Vec<f32> = lines("vn").iter().flat_map(|line| numbers(line)).collect();
    assert_eq!(normals, [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0]);
    assert_eq!(lines("f")[1], ["f", "1//1", "2//2", "4//4"]);
    assert_eq!((lines("v").len(), lines("f").len()), (4, 4));

    let plain = Mesh { attributes: Vec::new(), ..mesh };
    assert!(String::from_utf8(bytes(&plain, Format::Obj)).unwrap().contains("\nv 1 0.1 0\n"));
}

/// The tetrahedron with a uv and an attribute of six reals.
fn wide_tetrahedron() -> Mesh {
    let numbers = |count: usize| (0..count).map(|index| index as f32 / 8.0).collect();
    let attributes = vec![
        Attribute { name: "uv".to_owned(), width: 2, values: numbers(8) },
        Attribute { name: "spectrum".to_owned(), width: 6, values: numbers(24) },
    ];
    Mesh { attributes, ..tetrahedron() }
}

#[test]
fn glb_has_texture_coordinates_and_splits_wide_attributes() {
    let file = bytes(&wide_tetrahedron(), Format::Glb);
    let (json, binary) = parse_glb(&file);
    let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object().unwrap();
    let plane = |name: &str, kind: &str| {
        let accessor = &json["accessors"][attributes[name].as_u64().unwrap() as usize];
        assert_eq!(accessor["type"], kind);
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let start = view["byteOffset"].as_u64().unwrap() as usize;
        reals(&binary[start..start + view["byteLength"].as_u64().unwrap() as usize])
    };
    assert_eq!(plane("TEXCOORD_0", "VEC2"), [0.0, 0.875, 0.25, 0.625, 0.5, 0.375, 0.75, 0.125]);
    assert_eq!(plane("_SPECTRUM_0", "VEC4")[4..8], [0.75, 0.875, 1.0, 1.125]);
    assert_eq!(plane("_SPECTRUM_1", "VEC2"), [0.5, 0.625, 1.25, 1.375, 2.0, 2.125, 2.75, 2.875]);
    assert_eq!(attributes.len(), 5);
}

#[test]
fn ply_and_obj_have_texture_coordinates() {
    let mesh = wide_tetrahedron();
    let file = bytes(&mesh, Format::Ply);
    let end = b"end_header\n";
    let header = file.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let text = std::str::from_utf8(&file[..header]).unwrap();
    assert!(
        text.contains("property float nz\nproperty float s\nproperty float t\nproperty float spectrum_0\n")
    );
    let vertex = 4 * (6 + 2 + 6);
    assert_eq!(reals(&file[header + vertex + 24..header + vertex + 36]), [0.25, 0.375, 0.75]);
    let text = String::from_utf8(bytes(&mesh, Format::Obj)).unwrap();
    assert!(text.contains("\nvt 0 0.125\nvt 0.25 0.375\n") && text.contains("\nf 1/1/1 3/3/3 2/2/2\n"));
}

#[test]
fn stl_has_facets_with_normals() {
    let mut mesh = tetrahedron();
    mesh.triangles.push([0, 0, 1]);
    let file = bytes(&mesh, Format::Stl);
    assert_eq!(file.len(), 84 + 50 * 5);
    assert!(!file.starts_with(b"solid"));
    assert_eq!(u32_at(&file, 80), 5);
    let facet = |index: usize| reals(&file[84 + 50 * index..84 + 50 * index + 48]);
    // (0, 0, 0), (0, 1, 0), (1, 0, 0.1), from below.
    let length = 1.01_f64.sqrt();
    let expected = [0.1 / length, 0.0, -1.0 / length];
    assert!(facet(0).iter().zip(expected).all(|(&n, expected)| (f64::from(n) - expected).abs() < 1e-6));
    assert_eq!(facet(0)[3..], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.1]);
    assert_eq!(facet(4)[..3], [0.0; 3]);
}

/// The entries of an archive, by its list, with sizes and checksums compared.
fn unzip(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let word = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let long = |at: usize| u32_at(bytes, at) as usize;
    let end = bytes.len() - 22;
    assert_eq!(&bytes[end..end + 4], b"PK\x05\x06");
    let mut at = long(end + 16);
    assert_eq!(at + long(end + 12), end);
    let mut entries = Vec::new();
    for _ in 0..word(end + 10) {
        assert_eq!(&bytes[at..at + 4], b"PK\x01\x02");
        let (checksum, packed, size, start) =
            (u32_at(bytes, at + 16), long(at + 20), long(at + 24), long(at + 42));
        let length = word(at + 28);
        let name = String::from_utf8(bytes[at + 46..at + 46 + length].to_vec()).unwrap();
        assert_eq!(&bytes[start..start + 4], b"PK\x03\x04");
        let first = start + 30 + length;
        let mut text = Vec::new();
        let mut packer = flate2::read::DeflateDecoder::new(&bytes[first..first + packed]);
        io::Read::read_to_end(&mut packer, &mut text).unwrap();
        assert_eq!((text.len(), crc32fast::hash(&text)), (size, checksum), "{name}");
        assert_eq!(&bytes[first + packed..first + packed + 4], b"PK\x07\x08");
        assert_eq!(u32_at(bytes, first + packed + 4), checksum);
        entries.push((name, text));
        at += 46 + length;
    }
    entries
}

pub(super) fn three_mf_model(bytes: &[u8]) -> String {
    let entries = unzip(bytes);
    let names: Vec<&str> = entries.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]);
    String::from_utf8(entries[2].1.clone()).unwrap()
}

#[test]
fn three_mf_has_each_colour_once() {
    let text = three_mf_model(&bytes(&tetrahedron(), Format::ThreeMf));
    assert!(text.contains("<model unit=\"millimeter\""));
    let colors: Vec<&str> = text.lines().filter(|line| line.starts_with("<m:color ")).collect();
    let hex = ["00BCFF", "00FF00", "7CAACB", "FFFFFF"];
    assert_eq!(colors, hex.map(|hex| format!("<m:color color=\"#{hex}FF\"/>")));
    let triangles: Vec<&str> = text.lines().filter(|line| line.starts_with("<triangle ")).collect();
    assert_eq!(triangles[0], "<triangle v1=\"0\" v2=\"2\" v3=\"1\" pid=\"1\" p1=\"0\" p2=\"2\" p3=\"1\"/>");
    assert!(text.contains("<item objectid=\"2\"/>"));
    let far = Mesh { origin: [1e5, -2.5, 1e-9], attributes: Vec::new(), ..tetrahedron() };
    let options = ExportOptions { unit: Some(LengthUnit::Inch), ..ExportOptions::default() };
    let mut file = Vec::new();
    write_with(&far, Format::ThreeMf, &options, &mut file).unwrap();
    let text = three_mf_model(&file);
    assert!(text.contains("unit=\"inch\"") && !text.contains("colorgroup") && !text.contains("pid"));
    assert!(text.contains("transform=\"1 0 0 0 1 0 0 0 1 100000 -2.5 0.000000001\""));
    let empty = three_mf_model(&bytes(&Mesh::default(), Format::ThreeMf));
    assert!(empty.contains("<resources>\n</resources>\n<build/>"));
}

#[test]
fn usda_has_everything() {
    let text = String::from_utf8(bytes(&tetrahedron(), Format::Usda)).unwrap();
    for part in [
        "metersPerUnit = 1\n",
        "int[] faceVertexCounts = [3, 3, 3, 3]\n",
        "int[] faceVertexIndices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]\n",
        "float3[] extent = [(0, 0, 0), (1, 1, 0.1)]",
        "color3f[] primvars:displayColor = [(0, 0.5, 1), (0, 1, 0), (0.2, 0.4, 0.6), (1, 1, 1)]",
        "float[] primvars:wear___tear = [0.25, -7, 0, 3]",
        "float[] primvars:wear___tear_2 = [0, 1, 2, 3, 4, 5, 6, 7] (\n            elementSize = 2",
        "float[] primvars:x_2 = [0.75, 0.75, 0.75, 0.75]",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    let far = Mesh { origin: [1e5, -2.5, 1e-9], ..tetrahedron() };
    let text = String::from_utf8(bytes(&far, Format::Usda)).unwrap();
    assert!(text.contains("double3 xformOp:translate = (100000, -2.5, 0.000000001)"));
    let empty = String::from_utf8(bytes(&Mesh::default(), Format::Usda)).unwrap();
    assert!(empty.contains("point3f[] points = []"));
}

#[test]
fn empty_meshes_are_written() {
    let empty = Mesh::default();
    assert_eq!(bytes(&empty, Format::Stl).len(), 84);
    assert!(bytes(&empty, Format::Ply).ends_with(b"end_header\n"));
    assert_eq!(bytes(&empty, Format::Obj), b"# jbt, y up\n");
}

#[test]
fn malformed_meshes_are_refused() {
    let refused = |change: fn(&mut Mesh)| {
        let mut mesh = tetrahedron();
        change(&mut mesh);
        for format in Format::ALL {
            let mut out = Vec::new();
            let error = write(&mesh, format, &mut out).unwrap_err();
            assert!(matches!(error, ExportError::Malformed(_)), "{error}");
            assert!(out.is_empty());
        }
    };
    refused(|mesh| mesh.triangles[2][1] = 4);
    refused(|mesh| mesh.normals.truncate(3));
    refused(|mesh| mesh.positions[1][1] = f32::NAN);
    refused(|mesh| mesh.normals[1][1] = f32::INFINITY);
    refused(|mesh| mesh.attributes[0].width = 5);
    refused(|mesh| mesh.attributes[0].width = 0);
    refused(|mesh| mesh.attributes[1].values.truncate(11));
}

#[test]
fn the_extension_is_the_format() {
    for format in Format::ALL {
        assert_eq!(Format::of(&PathBuf::from(format!("a.b/c.{format}"))).unwrap(), format);
    }
    assert_eq!(Format::of(Path::new("A.GLB")).unwrap(), Format::Glb);
    for path in ["a", "glb", ".glb", "a.glbx", "a.glb/b", ""] {
        assert_eq!(Format::of(Path::new(path)), None, "{path}");
    }
}

#[test]
fn files_have_the_constants_of_each_piece() {
    let constant = |name: &str, values: Vec<LeafConstant>| ConstantValues { name: name.to_owned(), values };
    let of_part = vec![constant("material", vec!["a \"<&> b".into()]), constant("part", vec![17.into()])];
    let mesh = Mesh {
        parts: [("none", 0, 0), ("hub", 3, 1), ("rim", 4, 4)]
            .map(|(name, vertices, triangles)| MeshPart { name: name.to_owned(), vertices, triangles })
            .into(),
        triangles: vec![[0, 2, 1], [3, 3, 3], [3, 3, 3], [3, 3, 3]],
        ..tetrahedron()
    };
    let of_rim = vec![constant("part", vec![1.into(), "two".into()])];
    let options = ExportOptions { constants: vec![Vec::new(), of_part, of_rim], ..ExportOptions::default() };
    let bytes_of = |format: Format| {
        let mut file = Vec::new();
        write_with(&mesh, format, &options, &mut file).unwrap();
        file
    };
    let lossy = |format: Format| String::from_utf8_lossy(&bytes_of(format)).into_owned();
    let glb = lossy(Format::Glb);
    let end = glb.find("BIN\0").unwrap() - 4;
    let json: serde_json::Value = serde_json::from_str(&glb[glb.find('{').unwrap()..end]).unwrap();
    let extras: Vec<String> =
        json["nodes"].as_array().unwrap().iter().map(|node| node["extras"].to_string()).collect();
    assert_eq!(extras, [r#"{"material":"a \"<&> b","part":17}"#, r#"{"part":[1,"two"]}"#]);
    let lines = |text: String, part: &str| text.lines().filter(|line| line.contains(part)).count();
    let text = lossy(Format::Ply);
    assert!(text.contains(
        "comment hub: material a \"<&> b\ncomment hub: part 17\ncomment rim: part 1, two\nelement"
    ));
    let text = lossy(Format::Obj);
    assert!(text.contains("\no hub\n# material a \"<&> b\n# part 17\nf "), "{text}");
    let text = three_mf_model(&bytes_of(Format::ThreeMf));
    assert!(text.contains(" xmlns:jbt=\"urn:jbt:constants\">"), "{text}");
    assert!(
        text.contains("<metadatagroup>\n<metadata name=\"jbt:material\">a &quot;&lt;&amp;> b</metadata>\n"),
        "{text}"
    );
    assert_eq!(lines(text, "</metadatagroup>"), 2);
    let text = lossy(Format::Usda);
    assert!(text.contains("customData = {\n            string \"material\" = \"a _<&> b\"\n            int64 \"part\" = 17\n"), "{text}");
    // Whoever has none has the file of before.
    for format in Format::ALL {
        let mut file = Vec::new();
        let none = ExportOptions { constants: vec![Vec::new(); 3], ..ExportOptions::default() };
        write_with(&mesh, format, &none, &mut file).unwrap();
        assert_eq!(file, bytes(&mesh, format), "{format}");
    }
}
