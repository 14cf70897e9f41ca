//! Every build of the library makes the same meshes: with threads or without, with machine code or without.
//! The hashes are in the repository, since one build does not know what another one made.

use jbt::{Compiler, Fineness, Polygonize, Scene};

/// Of each example: vertices, triangles, and the FNV-1a hash of all bits of its mesh.
const MESHES: [(&str, usize, usize, u64); 4] = [
    ("hero", 3636, 7268, 4711613742911972836),
    ("machine", 4566, 9156, 15510853948800377436),
    ("smooth", 3324, 6624, 16814225973841232665),
    ("twist", 8046, 16100, 17356058953892113696),
];

/// FNV-1a over 32-bit words.
fn hash(words: impl Iterator<Item = u32>) -> u64 {
    let bytes = words.flat_map(u32::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn meshes_have_the_bits_of_every_other_build() {
    for expected in MESHES {
        let path = format!("{}/../examples/{}.jbt", env!("CARGO_MANIFEST_DIR"), expected.0);
        let tree = Scene::load(path).expect("it reads").check().expect("it is a good model");
        let settings = Polygonize { fineness: Fineness::Resolution(48), ..Polygonize::default() };
        let mesh = settings.mesh(&Compiler::new(), &tree).run().expect("it has a surface").mesh;
        let reals = mesh.positions.iter().chain(&mesh.normals).flatten();
        let reals = reals.chain(mesh.attributes.iter().flat_map(|attribute| &attribute.values));
        let words = reals.map(|real| real.to_bits()).chain(mesh.triangles.iter().flatten().copied());
        let made = (expected.0, mesh.positions.len(), mesh.triangles.len(), hash(words));
        assert_eq!(made, expected);
    }
}
