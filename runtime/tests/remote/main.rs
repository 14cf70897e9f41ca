//! Parts of models, and blocks of meshes: what other processes make of them has the bits of the whole.
//!
//! `JBT_REMOTE_SHAPES` sets the number of random models.

mod bytes;
mod joined;
mod parts;

use jbt::mesh::{Lattice, LatticeBlock, Mesh};
use jbt::{Box3, CheckedTree, Fineness, Polygonize};

/// How the tests mesh: as blocks do, without a search for thin parts.
fn settings(region: Option<Box3<f64>>, cells: usize) -> Polygonize {
    let fineness = Fineness::Resolution(cells);
    Polygonize { region, fineness, thin_parts: false, ..Polygonize::default() }
}

/// The lattice of a model, and all blocks of it.
fn blocks(settings: &Polygonize, tree: &CheckedTree, edge: usize) -> (Lattice, Vec<LatticeBlock>) {
    let lattice = settings.lattice(tree).expect("a good lattice");
    let [x, y, z] = lattice.cells().map(|cells| cells.div_ceil(edge) as u32);
    let mut all = Vec::new();
    for place in (0..x * y * z).map(|index| [index % x, index / x % y, index / (x * y)]) {
        all.push(LatticeBlock::new(&lattice, edge, place).expect("the block is there"));
    }
    (lattice, all)
}

/// All numbers of a mesh as bits.
fn bits(mesh: &Mesh) -> Vec<u32> {
    let floats = mesh.positions.iter().chain(&mesh.normals).flatten();
    let floats = floats.chain(mesh.attributes.iter().flat_map(|attribute| &attribute.values));
    floats.map(|number| number.to_bits()).chain(mesh.triangles.iter().flatten().copied()).collect()
}
